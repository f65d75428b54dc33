//! Machines that are in the program: to look at, to begin with, to copy.

use super::file::Machine;
use crate::error::{Error, Result};

/// A machine file that every user has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// What a command line calls it.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

impl Builtin {
    /// All, the commonest kind first.
    pub const ALL: [Self; 3] = [
        Self { name: "vertical", text: include_str!("../../machines/vertical.toml") },
        Self { name: "horizontal", text: include_str!("../../machines/horizontal.toml") },
        Self { name: "hu40t", text: include_str!("../../machines/hu40t.toml") },
    ];

    /// The machine of a name.
    pub fn named(name: &str) -> Result<Self> {
        let known = Self::ALL.into_iter().find(|machine| machine.name.eq_ignore_ascii_case(name));
        known.ok_or_else(|| {
            let names = Self::ALL.map(|machine| machine.name).join("`, `");
            Error::input(format!("there is no built-in machine `{name}`"))
                .hint(format!("the built-in machines are `{names}`"))
        })
    }

    /// The machine that the text describes.
    pub fn machine(&self) -> Result<Machine> {
        Machine::parse(self.text, format!("{}.toml", self.name).as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_machine_can_be_read_and_has_a_name_of_its_own() {
        let mut names: Vec<String> =
            Builtin::ALL.iter().map(|b| b.machine().unwrap().name().to_owned()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), Builtin::ALL.len());
        assert_eq!(Builtin::named("VERTICAL").unwrap(), Builtin::ALL[0]);
        let error = Builtin::named("lathe").unwrap_err();
        assert!(error.hint.unwrap().contains("`vertical`, `horizontal`, `hu40t`"));
    }
}
