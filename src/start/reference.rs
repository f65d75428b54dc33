//! The reference, which is in the program: what every key means, with unit and bounds.

use std::sync::LazyLock;

/// Its text.
pub const REFERENCE: &str = include_str!("../../docs/reference.md");

static PARSED: LazyLock<Reference> = LazyLock::new(|| Reference::parse(REFERENCE));

/// The rows of the tables of the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    entries: Vec<Entry>,
    /// Headings and what stands below each.
    sections: Vec<(String, String)>,
}

/// A row: a key, a cause, a column, an option, something that a check finds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The heading that it stands under, such as `Test file`.
    pub section: String,
    /// The table of its file that a key belongs to, such as `[plan]`; empty for others.
    pub table: String,
    /// What it is called; more than one where they are told together.
    pub names: Vec<String>,
    /// The other cells by their headings; none of them empty.
    pub cells: Vec<(String, String)>,
}

impl Entry {
    /// The cell below a heading, empty if there is none.
    pub fn cell(&self, heading: &str) -> &str {
        self.cells.iter().find(|(name, _)| name == heading).map_or("", |(_, cell)| cell)
    }

    /// Whether it is called so; brackets and capitals do not matter, and the table may stand before it: `plan.dwell_s`.
    fn is(&self, name: &str) -> bool {
        let bare = |text: &str| text.trim_matches(['[', ']']).to_lowercase();
        let name = bare(name);
        self.names.iter().any(|own| {
            let own = bare(own);
            own == name
                || (!self.table.is_empty() && format!("{}.{own}", bare(&self.table)) == name)
        })
    }
}

impl Reference {
    /// That of this program.
    pub fn get() -> &'static Self {
        &PARSED
    }

    fn parse(text: &str) -> Self {
        let mut parsed = Self { entries: Vec::new(), sections: Vec::new() };
        let mut table = String::new();
        let mut headings: Vec<String> = Vec::new();
        let mut lines = text.lines().peekable();
        while let Some(line) = lines.next() {
            if let Some(heading) = line.strip_prefix("## ").or(line.strip_prefix("### ")) {
                parsed.sections.push((heading.to_owned(), String::new()));
                table.clear();
                continue;
            }
            let Some((section, below)) = parsed.sections.last_mut() else { continue };
            below.push_str(line);
            below.push('\n');
            let Some(cells) = cells(line) else { continue };
            if cells.iter().all(|cell| cell.starts_with("---")) {
                continue;
            }
            if lines.peek().is_some_and(|next| next.starts_with("| ---")) {
                headings = cells;
                table.clear();
                continue;
            }
            let names = in_backticks(&cells[0]);
            if let Some(header) = names.first().filter(|name| name.starts_with('[')) {
                header.clone_into(&mut table);
            }
            let own = if names.first() == Some(&table) { String::new() } else { table.clone() };
            let named = headings.iter().cloned().zip(cells).skip(1);
            parsed.entries.push(Entry {
                section: section.clone(),
                table: own,
                names,
                cells: named.filter(|(_, cell)| !cell.is_empty()).collect(),
            });
        }
        parsed.entries.retain(|entry| !entry.names.is_empty());
        parsed
    }

    /// All rows in their order.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// All that are called so.
    pub fn named(&self, name: &str) -> Vec<&Entry> {
        self.entries.iter().filter(|entry| entry.is(name)).collect()
    }

    /// A key of a table of a file.
    pub fn key(&self, section: &str, table: &str, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| {
            entry.section == section
                && entry.table == table
                && entry.names.iter().any(|name| name == key)
        })
    }

    /// Headings.
    pub fn headings(&self) -> impl Iterator<Item = &str> {
        self.sections.iter().map(|(heading, _)| heading.as_str())
    }

    /// What stands below a heading; its first word is enough.
    pub fn section(&self, name: &str) -> Option<(&str, &str)> {
        let name = name.to_lowercase();
        let begins = |heading: &str| heading.split(' ').next() == Some(&name);
        self.sections
            .iter()
            .find(|(heading, _)| heading.to_lowercase() == name || begins(&heading.to_lowercase()))
            .map(|(heading, text)| (heading.as_str(), text.trim()))
    }
}

/// The cells of a row of a table.
fn cells(line: &str) -> Option<Vec<String>> {
    let inner = line.strip_prefix('|')?.trim_end().strip_suffix('|')?;
    Some(inner.split('|').map(|cell| cell.trim().to_owned()).collect())
}

/// What stands between backticks.
fn in_backticks(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_by_its_name_its_table_and_its_file() {
        let reference = Reference::get();
        let lengths = reference.named("length_mm");
        let of_bar = lengths.iter().find(|entry| entry.table == "[ball_bar]").unwrap();
        assert_eq!((of_bar.section.as_str(), of_bar.cell("unit")), ("Test file", "mm"));
        assert!(lengths.len() > 1, "the cylinders have one, too");
        assert_eq!(reference.named("ball_bar.length_mm"), [*of_bar]);
        assert_eq!(reference.named("TIME_UNIT")[0].names, ["time_column", "time_unit"]);
        assert_eq!(reference.named("plan.arc")[0].names, ["[[plan.arc]]"]);
        let budget = reference.named("budget_min")[0];
        assert_eq!((budget.table.as_str(), budget.cell("unit")), ("[design]", "min"));
        assert!(reference.named("cyclic")[0].cell("does").contains("sin"));
        assert!(reference.named("dwell_S").len() == 1 && reference.named("nothing").is_empty());
        assert!(reference.section("causes").unwrap().1.starts_with("What a machine"));
        assert_eq!(reference.section("test").unwrap().0, "Test file");
    }
}
