//! TOML with a comment on every key.

use std::fmt::Write as _;

use super::reference::Reference;

/// Comments begin in this column, and end before that.
const COMMENT: usize = 38;
const END: usize = 120;

/// A file that is being written; what its keys mean is looked up in a section of the reference.
pub(super) struct Commented {
    text: String,
    /// The section of the reference, such as `Test file`.
    file: &'static str,
    /// The table that keys belong to, such as `[plan]`; empty before the first.
    table: String,
}

impl Commented {
    pub(super) fn new(file: &'static str) -> Self {
        Self { text: String::new(), file, table: String::new() }
    }

    /// Lines for the reader.
    pub(super) fn note(&mut self, text: &str) {
        for line in folded(text, END - 2) {
            let _ = writeln!(self.text, "# {line}");
        }
    }

    /// A table, such as `[axes.X]`, whose keys the reference has under another, such as that of all axes.
    pub(super) fn table(&mut self, header: &str, of_reference: &str) {
        self.text.push('\n');
        let bare = header.trim_start_matches("# ");
        let entry = Reference::get().key(self.file, "", bare);
        let meaning = entry.map_or(String::new(), |entry| plain(entry.cell("meaning")));
        self.line(header, &meaning);
        of_reference.clone_into(&mut self.table);
    }

    /// The same for one that the reader may want to add.
    pub(super) fn table_off(&mut self, header: &str, of_reference: &str) {
        self.table(&format!("# {header}"), of_reference);
    }

    /// A key with its value and what it means.
    pub(super) fn key(&mut self, key: &str, value: &str) {
        let meaning = self.meaning(key);
        self.line(&format!("{key} = {value}"), &meaning);
    }

    /// A key that may be left out, with an example.
    pub(super) fn off(&mut self, key: &str, example: &str) {
        let meaning = self.meaning(key);
        self.line(&format!("# {key} = {example}"), &meaning);
    }

    /// One or the other.
    pub(super) fn maybe(&mut self, key: &str, value: Option<f64>, example: &str) {
        match value {
            Some(value) => self.key(key, &number(value)),
            None => self.off(key, example),
        }
    }

    fn line(&mut self, line: &str, meaning: &str) {
        let folded = folded(meaning, END - COMMENT - 2);
        let mut comments = folded.iter();
        if meaning.is_empty() {
            let _ = writeln!(self.text, "{line}");
        } else if line.len() < COMMENT {
            let first = comments.next().map_or("", String::as_str);
            let _ = writeln!(self.text, "{line:COMMENT$}# {first}");
        } else {
            let _ = writeln!(self.text, "{line}");
        }
        for comment in comments {
            let _ = writeln!(self.text, "{:COMMENT$}# {comment}", "");
        }
    }

    fn meaning(&self, key: &str) -> String {
        let entry = Reference::get().key(self.file, &self.table, key);
        entry.map_or(String::new(), |entry| plain(entry.cell("meaning")))
    }

    pub(super) fn finish(self) -> String {
        self.text
    }
}

/// A sentence of the reference in ASCII: editors of controls do not know more.
fn plain(meaning: &str) -> String {
    meaning
        .replace('`', "")
        .replace(" (µm)", "")
        .replace('±', "+-")
        .replace('²', "2")
        .replace('°', "deg ")
}

/// A number as TOML has it: with a decimal point.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A list of numbers.
pub(super) fn numbers(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", "))
}

/// Text in quotes.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// Lines of words, none longer than so many characters unless a word is.
fn folded(text: &str, longest: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= longest => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
