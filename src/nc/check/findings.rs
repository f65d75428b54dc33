//! Findings: collected, and those of one kind folded.

use std::collections::BTreeMap;
use std::fmt;

use crate::error::Error;

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
    /// By rule and wording without figures: how many there were, and where the last told one stands.
    kinds: BTreeMap<(&'static str, String), (usize, usize)>,
}

impl Findings {
    pub(super) fn error(&mut self, rule: &'static str, error: Error) {
        self.add(Severity::Error, rule, error);
    }

    pub(super) fn warning(&mut self, rule: &'static str, error: Error) {
        self.add(Severity::Warning, rule, error);
    }

    fn add(&mut self, severity: Severity, rule: &'static str, error: Error) {
        let figure = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
        let wording: String = error.what.chars().filter(|c| !figure(*c)).collect();
        let (count, last) = self.kinds.entry((rule, wording)).or_insert((0, 0));
        *count += 1;
        if *count > TOLD {
            self.list[*last].more += 1;
        } else {
            *last = self.list.len();
            self.list.push(Finding { severity, rule, error, more: 0 });
        }
    }

    /// In the order of the file; what concerns the whole file comes last.
    pub(super) fn sorted(mut self) -> Vec<Finding> {
        self.list.sort_by_key(|finding| match &finding.error.place {
            Some(place) if place.line > 0 => (place.line, place.column),
            _ => (usize::MAX, 0),
        });
        self.list
    }
}
