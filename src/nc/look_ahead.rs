//! Blocks that switch the look-ahead.

use super::code::LookAhead;
use super::command::Command;
use super::word::{Fault, Letters, Word};

/// A block that switches the look-ahead.
pub(super) fn look_ahead(
    command: &Command,
    function: LookAhead,
    word: &Word,
) -> std::result::Result<(), Fault> {
    let (letter, on) = (char::from(function.letter), function.on);
    let name = word.name();
    let hint = format!(
        "{name} {letter}{on} switches the look-ahead on, {name} {letter}0 off, each alone in a block"
    );
    match command.word(function.letter) {
        None => Err(Fault::word(word, format!("{name} without {letter}")).hint(hint)),
        Some(argument) if !matches!(argument.whole(), Some(n) if n == 0 || n == on) => {
            Err(Fault::word(argument, format!("{name} {} is not known", argument.name()))
                .hint(hint))
        }
        Some(_) if command.len() > 2 => {
            command.allow_only(Letters::of(&[b'G', function.letter]))?;
            Err(Fault::word(word, format!("{name} is not alone in its block")).hint(hint))
        }
        Some(_) => Ok(()),
    }
}
