//! What one block says: its words by address, its G words in force.

use super::bounds;
use super::code::{Code, Miscellaneous};
use super::grammar::Grammar;
use super::modal::Modal;
use super::word::{Fault, Letters, Word};

/// More words than this are no block.
const MOST_WORDS: usize = 200;

/// The words of a block, sorted.
#[derive(Debug)]
pub(crate) struct Command<'a> {
    words: &'a [Word],
    /// By letter: index of its word, counted from 1; 0 when it is absent.
    places: [u8; 26],
    /// G00 to G03 in this block.
    pub(crate) motion: Option<&'a Word>,
    /// G04, G05, G05.1, G08, G53 or a pole.
    pub(crate) one_shot: Option<(Code, &'a Word)>,
    /// G09.
    pub(crate) exact_stop: bool,
    /// G64 or G61 of a dialect in which they may have a tolerance, P and Q.
    pub(crate) tolerance: bool,
    grammar: &'static Grammar,
    /// The M word.
    pub(crate) miscellaneous: Option<(Miscellaneous, &'a Word)>,
}

impl<'a> Command<'a> {
    /// Sorts the words of a block and puts its G words and its feed in force.
    pub(crate) fn new(
        words: &'a [Word],
        modal: &mut Modal,
        grammar: &'static Grammar,
    ) -> Result<Self, Fault> {
        if let Some(word) = words.get(MOST_WORDS) {
            return Err(Fault::word(word, "the block has too many words"));
        }
        let mut command = Self {
            words,
            places: [0; 26],
            motion: None,
            one_shot: None,
            exact_stop: false,
            tolerance: false,
            grammar,
            miscellaneous: None,
        };
        let mut groups = 0_u32;
        for (index, word) in words.iter().enumerate() {
            match word.letter {
                b'G' => {
                    let code = grammar.code(word)?;
                    let (group, name) = code.group();
                    if groups & (1 << group) != 0 {
                        return Err(Fault::word(
                            word,
                            format!("{} in a block that already sets {name}", word.name()),
                        )
                        .hint("write one word of each group in a block"));
                    }
                    groups |= 1 << group;
                    match code {
                        Code::Motion(_) => command.motion = Some(word),
                        Code::ExactStopMode(_) => {
                            command.tolerance = grammar.tolerance;
                        }
                        Code::ExactStop => command.exact_stop = true,
                        Code::Dwell
                        | Code::MachineCoordinates
                        | Code::Pole
                        | Code::LookAhead(_) => {
                            command.one_shot = Some((code, word));
                        }
                        _ => {}
                    }
                    modal.apply(code);
                }
                letter => {
                    let place = &mut command.places[usize::from(letter - b'A')];
                    if *place > 0 {
                        return Err(Fault::word(
                            word,
                            format!("a second {} in one block", char::from(letter)),
                        )
                        .hint("write every address once in a block"));
                    }
                    *place = index as u8 + 1;
                    if letter == b'M' {
                        command.miscellaneous = Some((grammar.miscellaneous(word)?, word));
                    }
                }
            }
        }
        // Last, because the feed is in the unit of the block, wherever G20 stands in it.
        let times = matches!(command.one_shot, Some((Code::Dwell, _)));
        let of_dwell = |word: &Word| times && grammar.dwell.letters.has(word.letter);
        if let Some(word) = command.word(b'F').filter(|word| !of_dwell(word)) {
            modal.set_feed(word)?;
        }
        for word in words.iter().filter(|word| !of_dwell(word)) {
            bounds::check(word, modal.length_mm(word, grammar.increments), grammar)?;
        }
        Ok(command)
    }

    /// The word of an address.
    pub(crate) fn word(&self, letter: u8) -> Option<&'a Word> {
        let place = self.places[usize::from(letter - b'A')];
        self.words.get(usize::from(place).wrapping_sub(1))
    }

    /// The word of X, Y or Z, by axis 0, 1, 2.
    pub(crate) fn coordinate(&self, axis: usize) -> Option<&'a Word> {
        self.word([b'X', b'Y', b'Z'][axis])
    }

    /// The first word, in the order of the block, that has one of these addresses.
    pub(crate) fn first(&self, letters: Letters) -> Option<&'a Word> {
        self.words.iter().find(|word| letters.has(word.letter))
    }

    /// How many words the block has.
    pub(crate) fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether an M98 or M99 leaves the program here.
    pub(crate) fn jump(&self) -> Option<&'a Word> {
        match self.miscellaneous {
            Some((Miscellaneous::Call | Miscellaneous::Return, word)) => Some(word),
            _ => None,
        }
    }

    /// Every other address would be skipped, and nothing is.
    pub(crate) fn allow_only(&self, letters: Letters) -> Result<(), Fault> {
        match self.words.iter().find(|word| !letters.has(word.letter)) {
            Some(word) => Err(self.grammar.unknown(word)),
            None => Ok(()),
        }
    }
}
