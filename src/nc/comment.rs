//! Comments of a program: what a control shows its operator, and must not take for anything else.

use super::spelling::Spelling;
use crate::machine::{Controller, Machine};

/// A control shows some tens of characters and reads blocks of 255.
const LONGEST: usize = 200;

/// A text as a comment: upper case, only characters that the machine file allows, and nothing that a control obeys.
pub(super) fn of(controller: &Controller, text: &str) -> String {
    let allowed = &controller.comment_characters;
    let shown: String = text.to_uppercase().chars().flat_map(in_ascii).collect();
    let shown = shown.chars().filter(|c| {
        c.is_ascii_alphanumeric() || (allowed.contains(*c) && !"()%;~\n\r".contains(*c))
    });
    let shown: String = shown.take(LONGEST).collect();
    let begins = shown.trim_start();
    let active = Spelling::of(controller.dialect).active;
    if active.iter().any(|command| begins.starts_with(command)) {
        return format!("NAMED {begins}");
    }
    shown
}

/// Letters that a control does not know, as people write them without: those of German and its neighbours with an E,
/// others without their marks.
const LETTERS: [(&str, &str); 18] = [
    ("ÄÆ", "AE"),
    ("ÖØŒ", "OE"),
    ("Ü", "UE"),
    ("ẞ", "SS"),
    ("ÀÁÂÃÅĄ", "A"),
    ("ÇĆČ", "C"),
    ("ĎÐ", "D"),
    ("ÈÉÊËĘĚ", "E"),
    ("ÌÍÎÏİ", "I"),
    ("Ł", "L"),
    ("ÑŃŇ", "N"),
    ("ÒÓÔÕŐ", "O"),
    ("Ř", "R"),
    ("ŚŠŞ", "S"),
    ("ŤŢ", "T"),
    ("ÙÚÛŮŰ", "U"),
    ("Ý", "Y"),
    ("ŹŻŽ", "Z"),
];

/// A letter in ASCII where it has a usual form there.
fn in_ascii(letter: char) -> impl Iterator<Item = char> {
    let known = LETTERS.iter().find(|(letters, _)| letters.contains(letter));
    let ascii = known.map_or("", |(_, ascii)| ascii);
    ascii.chars().chain(Some(letter).filter(|_| ascii.is_empty()))
}

/// A program with warnings behind its title.
pub fn with_warnings<'a>(
    program: &str,
    machine: &Machine,
    warnings: impl Iterator<Item = &'a str>,
) -> String {
    let spelling = Spelling::of(machine.controller().dialect);
    let [open, close] = spelling.comment;
    let told = |text: &str| of(machine.controller(), &format!("NOT SAFE - {text}"));
    let lines: Vec<String> =
        warnings.map(|text| format!("{open}{}{close}\n", told(text))).collect();
    spelling.with(program, &lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(dialect: &str) -> Machine {
        let source = std::fs::read_to_string("machines/hu40t.toml").unwrap();
        let source = source.replace("\"fanuc\"", &format!("\"{dialect}\""));
        Machine::parse(&source, "m.toml".as_ref()).unwrap()
    }

    #[test]
    fn a_name_is_never_a_command() {
        let machine = machine("linuxcnc");
        for name in ["msg, hi", " LOGOPEN,TMPX", "py,import os", "probeopen x", "Print,#1"] {
            let comment = of(machine.controller(), name);
            assert!(comment.starts_with("NAMED "), "{comment}");
        }
        assert_eq!(of(machine.controller(), "Equator cw"), "EQUATOR CW");
    }

    #[test]
    fn letters_that_a_control_does_not_know_are_written_without_their_marks() {
        let told = of(machine("fanuc").controller(), "Fräse Grün ß (Halle 3), Łódź, Čapek, 図");
        assert_eq!(told, "FRAESE GRUEN SS HALLE 3, LODZ, CAPEK, ");
    }

    #[test]
    fn a_name_makes_no_block_too_long_and_closes_nothing() {
        let comment = of(machine("fanuc").controller(), &"a)(%;\n".repeat(400));
        assert_eq!(comment, "A".repeat(LONGEST));
    }

    #[test]
    fn warnings_stand_behind_the_title() {
        let told =
            with_warnings("%\nO1 (T)\nN10 G21\n", &machine("fanuc"), ["Z hits (1.0)"].into_iter());
        assert_eq!(told, "%\nO1 (T)\n(NOT SAFE - Z HITS 1.0)\nN10 G21\n");
    }
}
