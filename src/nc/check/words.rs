//! Rules for single words: decimal points, decimals, dwells, spindle; and blocks that never run.

use super::findings::Findings;
use crate::machine::Controller;
use crate::nc::grammar::{Form, Grammar};
use crate::nc::listing::Listing;
use crate::nc::run::Ran;
use crate::nc::word::{Fault, Word};

/// A dwell by P that is shorter was probably meant in seconds, ms.
const SHORT_DWELL_MS: f64 = 50.0;

/// A feed beyond this is none, mm/min.
const LARGEST_FEED_MM_MIN: f64 = 240_000.0;

pub(super) fn check(
    listing: &Listing,
    ran: &Ran,
    controller: &Controller,
    findings: &mut Findings,
) {
    let grammar = Grammar::of(controller.dialect);
    let mut inch = false;
    for block in &listing.blocks {
        if findings.are_too_many() {
            return;
        }
        let words = listing.words(block);
        let g =
            |code: u32| words.iter().any(|word| word.letter == b'G' && word.whole() == Some(code));
        inch = (inch || g(20)) && !g(21);
        let dwell = g(4);
        let rounds = g(64) && grammar.tolerance;
        if let Some(fault) = rounds.then(|| merges(words)).flatten() {
            findings.warning("merged", listing.locate(block.line, fault));
        }
        for word in words {
            let found = match word.letter {
                b'X' | b'U' if dwell => point_of_dwell(word),
                b'X'..=b'Z' | b'I' | b'J' | b'K' | b'R' => {
                    let decimals = controller.decimals + usize::from(inch);
                    length(word, inch, decimals)
                }
                b'P' if dwell && !word.point && word.value > 0.0 && word.value < SHORT_DWELL_MS => {
                    let what = format!("a dwell of {} ms", word.value);
                    let hint =
                        format!("P counts milliseconds: P{}000 for as many seconds", word.value);
                    Some(("dwell", false, Fault::word(word, what).hint(hint)))
                }
                _ => None,
            };
            if let Some((rule, error, fault)) = found.filter(|_| grammar.increments) {
                let error_text = listing.locate(block.line, fault);
                if error {
                    findings.error(rule, error_text);
                } else {
                    findings.warning(rule, error_text);
                }
            }
            match (word.letter, word.whole()) {
                (b'M', Some(3 | 4)) => {
                    let fault = Fault::word(word, format!("{} turns the spindle", word.name()))
                        .hint("the bar hangs in the spindle: take the block out, and lock the spindle");
                    findings.error("spindle", listing.locate(block.line, fault));
                }
                (b'G', Some(71)) if grammar.form == Form::Keywords => {
                    let fault = Fault::word(word, "G71 leaves the unit of F to the control")
                        .hint("where its own unit is the inch, F is one of inches: write G710");
                    findings.warning("feed-unit", listing.locate(block.line, fault));
                }
                (b'M', Some(8)) => {
                    let fault = Fault::word(word, "M08 turns the coolant on")
                        .hint("the bar is an electronic instrument: take the block out");
                    findings.warning("coolant", listing.locate(block.line, fault));
                }
                (b'F', _) if word.value > LARGEST_FEED_MM_MIN => {
                    let fault = Fault::word(word, format!("a feed of {}", word.value))
                        .hint("F is in mm/min, with or without a decimal point");
                    findings.error("feed", listing.locate(block.line, fault));
                }
                _ => {}
            }
        }
    }
    unreached(listing, ran, findings);
}

type Found = Option<(&'static str, bool, Fault)>;

fn point_of_dwell(word: &Word) -> Found {
    if word.point || word.value == 0.0 {
        return None;
    }
    let what = format!("{} has no decimal point: the control waits {} ms", word.name(), word.value);
    let hint = format!("for seconds write {}.", word.name());
    Some(("decimal-point", true, Fault::word(word, what).hint(hint)))
}

fn length(word: &Word, inch: bool, decimals: usize) -> Found {
    let (unit, increments) = if inch { ("inch", 1e4) } else { ("mm", 1e3) };
    if !word.point && word.value != 0.0 {
        let length = word.value / increments;
        let places = if inch { 4 } else { 3 };
        let what = format!(
            "{} has no decimal point: the control reads {length:.places$} {unit}",
            word.name()
        );
        let letter = char::from(word.letter);
        let hint = format!(
            "write {letter}{length:.places$} for that, or {}. for {} {unit}",
            word.name(),
            word.value
        );
        return Some(("decimal-point", true, Fault::word(word, what).hint(hint)));
    }
    let unit = 10_f64.powi(decimals as i32);
    let finest = word.value * unit;
    if (finest - finest.round()).abs() > 1e-6 {
        let what = format!("{} has more than {decimals} decimals", word.name());
        let hint = "the control drops what is finer than its least increment: round it";
        return Some(("decimals", false, Fault::word(word, what).hint(hint)));
    }
    None
}

/// LinuxCNC puts chords together that are within Q of a line, and within P where there is no Q.
fn merges(words: &[Word]) -> Option<Fault> {
    let word = |letter| words.iter().find(|word| word.letter == letter);
    let with = match (word(b'Q'), word(b'P')) {
        (Some(q), _) if q.value > 0.0 => format!("with {}", q.name()),
        (None, Some(p)) if p.value > 0.0 => "without Q0".to_owned(),
        _ => return None,
    };
    let what = format!("G64 {with} lets the control put chords together: the path is another one");
    let hint = "write Q0, and P for the corners: G64 P0.01 Q0";
    Some(Fault::line(what).hint(hint))
}

/// Blocks that nothing leads to: behind M30, or in a subprogram that nobody calls.
fn unreached(listing: &Listing, ran: &Ran, findings: &mut Findings) {
    for section in &listing.sections {
        let never = section.blocks.clone().find(|index| {
            !ran.reached[*index] && !listing.words(&listing.blocks[*index]).is_empty()
        });
        if let Some(index) = never {
            let whole = index == section.blocks.start;
            let what = match section.number {
                Some(number) if whole => format!("nothing calls O{number}"),
                _ => "nothing leads to this block".to_owned(),
            };
            let fault = Fault::line(what).hint("take out what never runs, or call it");
            findings.warning("unreached", listing.locate(listing.blocks[index].line, fault));
        }
    }
}
