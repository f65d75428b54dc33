//! Rules for what stands in the file: characters, lengths, `%`, N and O, size.

use super::findings::Findings;

use crate::machine::Controller;
use crate::nc::grammar::Grammar;
use crate::nc::lex::{Lexer, Piece};
use crate::nc::lines::Line;
use crate::nc::listing::Listing;
use crate::nc::word::{Fault, Word};

/// Longest block, characters: LinuxCNC reads 255, and no control needs more.
const LONGEST_BLOCK: usize = 255;

/// Largest block number of a Fanuc.
const LARGEST_N: usize = 99_999;

pub(super) fn check(listing: &Listing, controller: &Controller, findings: &mut Findings) {
    let grammar = Grammar::of(controller.dialect);
    let fanuc = grammar.increments;
    if fanuc {
        around(listing, findings);
    }
    if let Some(line) = listing.unclosed {
        findings.error("percent", listing.cut_off(line));
    }
    size(listing, controller, findings);
    look_ahead(listing, controller, findings);
    let mut numbers = vec![false; LARGEST_N + 1];
    for (line, text) in listing.lines() {
        let head = head(text, grammar);
        if let Some(Piece::Delete(at)) = head {
            let fault = Fault::span(at..at + 1, "whether this block runs depends on a switch")
                .hint("take the slash or the block out: a test is driven the same every time");
            findings.warning("block-delete", listing.locate(line, fault));
        }
        if let Some(Piece::Word(word)) = head
            && fanuc
        {
            match word.letter {
                b'N' => sequence(listing, line, &word, &mut numbers, findings),
                b'O' => number(listing, line, &word, findings),
                _ => {}
            }
        }
        if text.len() > LONGEST_BLOCK {
            let fault = Fault::line(format!("the block has {} characters", text.len()))
                .hint(format!("a control reads {LONGEST_BLOCK} at most: shorten the comment"));
            findings.error("block-length", listing.locate(line, fault));
        }
        let plain = |byte: &u8| byte.is_ascii() && !byte.is_ascii_lowercase() && *byte != b'(';
        if fanuc && !text.as_bytes().iter().all(plain) {
            characters(listing, line, text, controller, findings);
        }
        if !fanuc && let Some(at) = text.find(char::REPLACEMENT_CHARACTER) {
            let fault = Fault::span(at..at + 3, "a byte that is no character")
                .hint("save the program as ASCII or UTF-8");
            findings.error("characters", listing.locate(line, fault));
        }
    }
}

fn head<'a>(text: &'a str, grammar: &'static Grammar) -> Option<Piece<'a>> {
    // Most blocks of a test begin with X: nothing to look at.
    let first = text.bytes().find(|byte| !byte.is_ascii_whitespace())?;
    if !matches!(first, b'/' | b'N' | b'n' | b'O' | b'o') {
        return None;
    }
    Lexer::new(text, grammar).piece().ok().flatten()
}

/// What stands before, after and instead of the two `%`.
fn around(listing: &Listing, findings: &mut Findings) {
    let (first, last) = listing.between;
    if first == 0 {
        let error = listing.whole("the file does not begin with %");
        findings.warning(
            "percent",
            error.hint(
                "a control skips everything up to the end of the first block: put % into the first line",
            ),
        );
    }
    let outside = |line: &Line| line.number < first || line.number > last;
    if let Some((line, _)) =
        listing.all_lines().find(|(line, text)| outside(line) && !text.trim().is_empty())
    {
        let fault = Fault::line("this stands outside of the two %").hint(
            "a control skips what stands before the first % and after the second: move it between them",
        );
        findings.warning("percent", listing.locate(line, fault));
    }
}

fn size(listing: &Listing, controller: &Controller, findings: &mut Findings) {
    let Some(memory_bytes) = controller.memory_bytes else { return };
    for section in &listing.sections {
        let bytes = listing.bytes_of(section);
        if bytes > memory_bytes {
            let name = section.number.map_or("the program".to_owned(), |n| format!("program O{n}"));
            let kb = |bytes: usize| bytes as f64 / 1024.0;
            let what = format!(
                "{name} has {:.1} KB, the control's memory {:.1} KB",
                kb(bytes),
                kb(memory_bytes)
            );
            let error = listing.whole(what).hint(
                "`ballbar program` divides into subprograms what is larger than `memory_kb`; a larger \
                 sag makes fewer chords",
            );
            findings.error("memory", error);
        }
    }
}

/// The blocks around each arc that the machine file asks for.
fn look_ahead(listing: &Listing, controller: &Controller, findings: &mut Findings) {
    let words = |text: &str| {
        let text = text.split(['(', ';']).next().unwrap_or("");
        let mut words = text.split_ascii_whitespace().peekable();
        words.next_if(|word| word.starts_with(['N', 'n']));
        words.collect::<Vec<_>>().join("").to_uppercase()
    };
    for block in [&controller.look_ahead_on, &controller.look_ahead_off] {
        let wanted = words(block);
        let Some(first) = wanted.bytes().next() else { continue };
        let begins = |text: &str| text.bytes().any(|byte| byte.eq_ignore_ascii_case(&first));
        if !listing.lines().any(|(_, text)| begins(text) && words(text) == wanted) {
            let error =
                listing.whole(format!("no block `{block}`, which the machine file asks for")).hint(
                    "without look-ahead the control slows down at chords; write it around each arc",
                );
            findings.warning("look-ahead", error);
        }
    }
}

fn sequence(
    listing: &Listing,
    line: Line,
    word: &Word,
    numbers: &mut [bool],
    findings: &mut Findings,
) {
    let Some(number) = word.whole() else { return };
    match numbers.get_mut(number as usize) {
        Some(taken) if number > 0 => {
            if std::mem::replace(taken, true) {
                let fault = Fault::word(word, format!("a second block N{number}"))
                    .hint("a search for the number finds the first: number the blocks anew");
                findings.warning("block-number", listing.locate(line, fault));
            }
        }
        _ => {
            let fault = Fault::word(word, format!("N{number} is out of range"))
                .hint("block numbers are 1 to 99999; a block needs none");
            findings.error("block-number", listing.locate(line, fault));
        }
    }
}

fn number(listing: &Listing, line: Line, word: &Word, findings: &mut Findings) {
    let Some(number) = word.whole() else { return };
    let (what, hint) = match number {
        8000..=9999 => (
            "belongs to the machine tool builder",
            "a lock on O8000 to O9999 may refuse it: take a number from 1 to 7999",
        ),
        10_000.. => (
            "has more than four digits",
            "a control without the option of eight digits refuses it: take a number from 1 to 7999",
        ),
        _ => return,
    };
    let fault = Fault::word(word, format!("program number O{number} {what}")).hint(hint);
    findings.warning("program-number", listing.locate(line, fault));
}

/// Lower case, characters that are not ASCII, and what comments may hold.
fn characters(
    listing: &Listing,
    line: Line,
    text: &str,
    controller: &Controller,
    findings: &mut Findings,
) {
    let mut comment = false;
    for (at, c) in text.char_indices() {
        let fault = |what: String| Fault::span(at..at + c.len_utf8(), what);
        match c {
            '(' if !comment => comment = true,
            ')' => comment = false,
            c if !c.is_ascii() => {
                let fault = fault(format!("`{c}` is not an ASCII character"))
                    .hint("a control reads ASCII only: spell it out");
                findings.error("characters", listing.locate(line, fault));
                return;
            }
            c if comment => {
                let allowed = c.is_ascii_uppercase()
                    || c.is_ascii_digit()
                    || controller.comment_characters.contains(c);
                if !allowed {
                    let fault = fault(format!("`{c}` in a comment")).hint(
                        "write comments in upper case, with letters, digits and \
                         `comment_characters` of the machine file",
                    );
                    findings.warning("comment", listing.locate(line, fault));
                    return;
                }
            }
            c if c.is_ascii_lowercase() => {
                let fault = fault(format!("the address `{c}` is in lower case"))
                    .hint("write addresses in upper case");
                findings.error("characters", listing.locate(line, fault));
                return;
            }
            _ => {}
        }
    }
}
