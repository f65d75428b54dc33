//! The lowest and the highest number that a word may have: what controls take, and more than any test needs.
//!
//! What lies beyond is a slip (a lost point, a doubled digit), and would make paths and times that no computation means.

use super::grammar::Grammar;
use super::word::{Fault, Letters, Word};

/// Coordinates, ways to a centre, radii and tolerances, mm: eight digits, as Fanuc, Siemens and HEIDENHAIN state.
const FARTHEST_MM: f64 = 99_999.999;

/// The slowest feed, mm/min: one increment of a control.
const SLOWEST_MM_MIN: f64 = 0.001;

/// The fastest, mm/min: the highest rapid traverse of a machine file.
const FASTEST_MM_MIN: f64 = 1e6;

/// Speeds of the spindle, tools, and numbers of blocks: eight digits.
const EIGHT_DIGITS: f64 = 99_999_999.0;

/// Repeats of a subprogram on a control of this kind.
const MOST_REPEATS: f64 = 9999.0;

/// Addresses of lengths.
const LENGTHS: Letters = Letters::of(b"XYZIJKR");

/// The bounds of a word of a block that is no dwell, with the length that it is where it is one; the feed has its own.
pub(crate) fn check(word: &Word, length_mm: f64, grammar: &Grammar) -> Result<(), Fault> {
    match word.letter {
        b'P' | b'Q' if grammar.tolerance => within(word, length_mm, [0.0, FARTHEST_MM], " mm"),
        b'S' | b'T' | b'N' => within(word, word.value, [0.0, EIGHT_DIGITS], ""),
        b'L' => within(word, word.value, [1.0, MOST_REPEATS], ""),
        letter if LENGTHS.has(letter) => {
            within(word, length_mm, [-FARTHEST_MM, FARTHEST_MM], " mm")
        }
        _ => Ok(()),
    }
}

/// The bounds of a feed, which may be none.
pub(crate) fn check_feed(word: &Word, mm_min: f64) -> Result<(), Fault> {
    let low = if mm_min == 0.0 { 0.0 } else { SLOWEST_MM_MIN };
    within(word, mm_min, [low, FASTEST_MM_MIN], " mm/min")
}

/// A number of a word in some unit, between a lowest and a highest.
fn within(word: &Word, value: f64, [low, high]: [f64; 2], unit: &str) -> Result<(), Fault> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let value = (value * 1e6).round() / 1e6;
    let what = format!("{} is {value}{unit}, outside of {low} to {high}{unit}", word.name());
    Err(Fault::word(word, what).hint("no control takes it: a point or a digit may be wrong"))
}
