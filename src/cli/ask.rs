//! Questions on a terminal.

use std::io::{BufRead, Write};

use crate::error::{Error, Kind, Result};

/// Somebody who can be asked.
pub(super) struct Ask<'a> {
    /// His answers.
    pub(super) input: &'a mut dyn BufRead,
    /// Where he reads the questions.
    pub(super) output: &'a mut dyn Write,
}

impl Ask<'_> {
    /// Asks until the answer can be used; nothing but the Enter key, or the end of all answers, is the default.
    pub(super) fn ask<T>(
        &mut self,
        question: &str,
        default: &str,
        parse: impl Fn(&str) -> Result<T>,
    ) -> Result<T> {
        let failed = |error: std::io::Error| {
            Error::new(Kind::Input, format!("cannot ask: {error}"))
                .hint("give what is asked for as options")
        };
        loop {
            write!(self.output, "{question} [{default}]: ").map_err(failed)?;
            self.output.flush().map_err(failed)?;
            let mut line = String::new();
            let ended = self.input.read_line(&mut line).map_err(failed)? == 0;
            let answer = line.trim();
            let parsed = parse(if answer.is_empty() { default } else { answer });
            match parsed {
                // Who has no more answers cannot correct one.
                Err(error) if !ended => {
                    let hint = error.hint.map_or(String::new(), |hint| format!("; {hint}"));
                    writeln!(self.output, "  {}{hint}", error.what).map_err(failed)?;
                }
                done => return done,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_answer_is_told_and_asked_again_and_enter_takes_the_default() {
        let (mut answers, mut asked) = (&b"much\n 7 \n\n"[..], Vec::new());
        let mut ask = Ask { input: &mut answers, output: &mut asked };
        let whole = |text: &str| {
            text.parse::<u32>()
                .map_err(|_| Error::input(format!("`{text}` is no number")).hint("write 3"))
        };
        assert_eq!(ask.ask("How many", "3", whole).unwrap(), 7);
        assert_eq!(ask.ask("How many", "3", whole).unwrap(), 3);
        assert_eq!(ask.ask("How many", "4", whole).unwrap(), 4, "no more answers");
        let asked = String::from_utf8(asked).unwrap();
        let again = "How many [3]:   `much` is no number; write 3\nHow many [3]: How many [3]: ";
        assert!(asked.starts_with(again), "{asked}");
    }
}
