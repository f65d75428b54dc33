//! Findings: collected, and those of one kind folded.

use std::collections::BTreeMap;
use std::fmt;

use crate::error::Error;
use crate::nc::listing::{Listing, MOST_FAULTS};

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The program must not run like this.
    Error,
    /// Worth a look.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// One thing that is wrong with a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The rule, such as `decimal-point`; `reading` for what the reader cannot follow.
    pub rule: &'static str,
    /// What is wrong, where, and what to do.
    pub error: Error,
    /// So many further blocks have the same.
    pub more: usize,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.severity.name(), self.error)?;
        match self.more {
            0 => Ok(()),
            1 => write!(f, "\nand the same in one more block"),
            more => write!(f, "\nand the same in {more} more blocks"),
        }
    }
}

/// So many findings of one kind are told each by itself: the first ones show the pattern.
const TOLD: usize = 3;

/// Findings while they are collected.
#[derive(Debug, Default)]
pub(super) struct Findings {
    list: Vec<Finding>,
    /// By rule and wording without figures.
    kinds: BTreeMap<&'static str, BTreeMap<String, Kind>>,
    /// Room for a wording without figures.
    wording: String,
    /// Errors, told or counted.
    errors: usize,
}

/// Findings that differ in figures at the most.
#[derive(Debug, Default)]
struct Kind {
    count: usize,
    /// Where the last that is told stands in the list.
    last: usize,
}

impl Findings {
    pub(super) fn error(&mut self, rule: &'static str, error: Error) {
        self.errors += 1;
        if self.is_told(rule, &error.what) {
            self.push(Severity::Error, rule, error);
        }
    }

    /// The same, where many blocks may have it: of what is only counted, no error is made.
    pub(super) fn error_of(
        &mut self,
        rule: &'static str,
        what: String,
        error: impl FnOnce(String) -> Error,
    ) {
        self.errors += 1;
        if self.is_told(rule, &what) {
            self.push(Severity::Error, rule, error(what));
        }
    }

    pub(super) fn warning(&mut self, rule: &'static str, error: Error) {
        if self.is_told(rule, &error.what) {
            self.push(Severity::Warning, rule, error);
        }
    }

    /// Whether there are so many errors that more of them tell nothing.
    pub(super) fn are_too_many(&self) -> bool {
        self.errors > MOST_FAULTS
    }

    /// Counts a finding, and says whether it is one of those that are told each by itself.
    fn is_told(&mut self, rule: &'static str, what: &str) -> bool {
        let figure = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
        self.wording.clear();
        self.wording.extend(what.split(figure));
        let kinds = self.kinds.entry(rule).or_default();
        let kind = match kinds.get_mut(&self.wording) {
            Some(kind) => kind,
            None => kinds.entry(self.wording.clone()).or_default(),
        };
        kind.count += 1;
        let told = kind.count <= TOLD;
        if told {
            kind.last = self.list.len();
        } else {
            self.list[kind.last].more += 1;
        }
        told
    }

    fn push(&mut self, severity: Severity, rule: &'static str, error: Error) {
        self.list.push(Finding { severity, rule, error, more: 0 });
    }

    /// In the order of the file; what concerns the whole file comes last.
    pub(super) fn sorted(mut self, listing: &Listing) -> Vec<Finding> {
        if self.are_too_many() {
            let what =
                format!("more than {MOST_FAULTS} errors: not all of the program was looked at");
            self.error(
                "errors",
                listing.whole(what).hint("correct the first ones and check again"),
            );
        }
        self.list.sort_by_key(|finding| match &finding.error.place {
            Some(place) if place.line > 0 => (place.line, place.column),
            _ => (usize::MAX, 0),
        });
        self.list
    }
}
