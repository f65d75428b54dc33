//! One line of a program as words and comments.
//!
//! A line is read without copying: a word keeps where it stands, so that whatever is wrong with it later
//! can be shown with a caret.

use super::code::Code;
use super::grammar::{Comments, Form, Grammar};
use super::keyword::Keyword;
use super::word::{Fault, Word};

/// A number may have this many digits; all of them are exact in an `f64`.
const MOST_DIGITS: u32 = 15;

/// Powers of ten that are exact, for the digits after the point.
const POWERS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// What a line is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Piece<'a> {
    /// An address with its number.
    Word(Word),
    /// The text of a comment, without its parentheses and the blanks around it.
    Comment(&'a str),
    /// The slash of a block that can be deleted, with the byte at which it stands.
    Delete(usize),
}

/// Takes a line apart, from left to right.
#[derive(Debug, Clone)]
pub(crate) struct Lexer<'a> {
    line: &'a str,
    at: usize,
    grammar: &'static Grammar,
}

impl<'a> Lexer<'a> {
    /// Begins at the start of a line, which is given without its end of line.
    pub(crate) fn new(line: &'a str, grammar: &'static Grammar) -> Self {
        Self { line, at: 0, grammar }
    }

    /// The number at a byte of a line, as a word of a letter that begins before it, and the byte behind it.
    pub(crate) fn number(
        line: &'a str,
        [start, at]: [usize; 2],
        letter: u8,
        grammar: &'static Grammar,
    ) -> Result<(Word, usize), Fault> {
        let mut lexer = Self { line, at, grammar };
        let word = lexer.word_of(letter, start)?;
        Ok((word, lexer.at))
    }

    /// Goes on behind a fault; false where there is nothing behind it.
    pub(crate) fn resume(&mut self, fault: &Fault) -> bool {
        match &fault.span {
            Some(span) if span.end > span.start && span.end >= self.at => {
                self.at = span.end;
                true
            }
            _ => false,
        }
    }

    /// The next piece, or none at the end of the block.
    pub(crate) fn piece(&mut self) -> Result<Option<Piece<'a>>, Fault> {
        self.skip_blanks();
        let Some(&byte) = self.line.as_bytes().get(self.at) else {
            return Ok(None);
        };
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' if self.grammar.form == Form::Keywords => {
                self.keyword().map(Some)
            }
            b'A'..=b'Z' | b'a'..=b'z' => self.word(byte.to_ascii_uppercase()).map(Some),
            b'(' if self.grammar.comments != Comments::Semicolon => self.comment().map(Some),
            b'/' => self.delete().map(Some),
            b'%' if self.grammar.form == Form::Keywords && self.line.starts_with("%_N_") => {
                // How an archive names the program that follows.
                self.at = self.line.len();
                Ok(Some(Piece::Comment(self.line.trim_end())))
            }
            b';' if self.grammar.comments != Comments::Parentheses => {
                let text = self.line[self.at + 1..].trim();
                self.at = self.line.len();
                Ok((!text.is_empty()).then_some(Piece::Comment(text)))
            }
            b';' => self.end_of_block().map(|()| None),
            _ => Err(self.stray()),
        }
    }

    fn skip_blanks(&mut self) {
        let bytes = self.line.as_bytes();
        while matches!(bytes.get(self.at), Some(b' ' | b'\t')) {
            self.at += 1;
        }
    }

    /// A letter and its number; blanks between them mean nothing to a control.
    fn word(&mut self, letter: u8) -> Result<Piece<'a>, Fault> {
        let start = self.at;
        self.at += 1;
        self.skip_blanks();
        self.word_of(letter, start).map(Piece::Word)
    }

    /// The number at this place, as a word that begins at `start`.
    fn word_of(&mut self, letter: u8, start: usize) -> Result<Word, Fault> {
        let number = self.at;
        let bytes = self.line.as_bytes();
        let (mut digits, mut after_point, mut mantissa) = (0_u32, 0_usize, 0_u64);
        let (mut points, mut signs, mut late_sign) = (0_u32, 0_u32, false);
        while let Some(&byte) = bytes.get(self.at) {
            match byte {
                b'0'..=b'9' => {
                    digits += 1;
                    after_point += usize::from(points > 0);
                    mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                }
                b'.' => points += 1,
                b'+' | b'-' => {
                    signs += 1;
                    late_sign |= self.at > number;
                }
                _ => break,
            }
            self.at += 1;
        }
        let end = if self.at == number { start + 1 } else { self.at };
        let fault = |what: String| {
            Err(Fault::span(start..end, what)
                .hint("an address is followed by one number, such as X-12.345"))
        };
        let name = char::from(letter);
        if signs > 1 {
            return fault(format!("the number after {name} has more than one sign"));
        }
        if late_sign {
            return fault(format!("the sign in the number after {name} is not in front"));
        }
        if points > 1 {
            return fault(format!("the number after {name} has more than one decimal point"));
        }
        if digits == 0 {
            return fault(format!("{name} has no number"));
        }
        if digits > MOST_DIGITS {
            return fault(format!(
                "the number after {name} has {digits} digits, more than {MOST_DIGITS}"
            ));
        }
        let (Ok(place), Ok(width)) = (u32::try_from(start), u32::try_from(end - start)) else {
            return fault("the line is too long".to_owned());
        };
        let size = mantissa as f64 / POWERS.get(after_point).copied().unwrap_or(1.0);
        let minus = bytes.get(number) == Some(&b'-');
        Ok(Word {
            // Minus zero would reach every coordinate and every table as "-0.000".
            value: if minus && size > 0.0 { -size } else { size },
            start: place,
            width,
            letter,
            point: points > 0,
            keyword: None,
        })
    }

    /// A word, or one of more than a letter; `=` may stand before a value.
    fn keyword(&mut self) -> Result<Piece<'a>, Fault> {
        let start = self.at;
        let rest = &self.line[start..];
        let is_name = |c: &u8| c.is_ascii_alphabetic() || *c == b'_';
        let name = &rest[..rest.bytes().take_while(is_name).count()];
        let mut known = Keyword::SIEMENS.into_iter();
        let span = start..start + name.len();
        if let Some(keyword) = known.find(|known| known.name().eq_ignore_ascii_case(name)) {
            self.at = span.end;
            return Ok(Piece::Word(spelled(keyword, span)));
        }
        let radius = name.eq_ignore_ascii_case("CR");
        if name.len() > 1 && !radius {
            return Err(Fault::span(span, format!("{} is not known", name.to_ascii_uppercase()))
                .hint(
                    "nothing is skipped, because it may move the machine: remove it if it does not",
                ));
        }
        let blanks = [' ', '\t'];
        let value = rest[name.len()..].trim_start_matches(blanks);
        let value = if let Some(value) = value.strip_prefix('=') {
            let value = value.trim_start_matches(blanks);
            let end = self.line.len() - value.len();
            if value.starts_with(|c: char| c.is_ascii_alphabetic()) {
                return Err(Fault::span(start..end + 1, "a value that is not a number")
                    .hint("write the number itself, with G90 or G91 for all; I, J and K lead from the start of the arc"));
            }
            value
        } else if radius {
            return Err(
                Fault::span(span, "CR without =").hint("write the radius of an arc as CR=150.")
            );
        } else {
            value
        };
        let letter = if radius { b'R' } else { rest.as_bytes()[0].to_ascii_uppercase() };
        if letter == b'R' && !radius {
            return Err(Fault::span(span, "R parameters are not followed")
                .hint("write the coordinates as numbers, and the radius of an arc as CR="));
        }
        if letter == b'O' {
            return Err(Fault::span(span, "this control has no O numbers")
                .hint("the file has the name of the program"));
        }
        self.at = self.line.len() - value.len();
        let word = self.word_of(letter, start)?;
        let no_offset = letter == b'D' && word.whole() == Some(0);
        let word = if no_offset { spelled(Keyword::D0, start..self.at) } else { word };
        Ok(Piece::Word(word))
    }

    fn comment(&mut self) -> Result<Piece<'a>, Fault> {
        let start = self.at;
        let Some(length) = self.line[start..].find(')') else {
            return Err(Fault::span(start..self.line.len(), "the comment is not closed")
                .hint("a comment ends with ) on its own line"));
        };
        let end = start + length;
        let text = &self.line[start + 1..end];
        // Where a lone carriage return ends a block, the comment would swallow the next one.
        if text.contains(|c: char| c.is_control() && c != '\t') {
            return Err(Fault::span(start..end + 1, "a control character in a comment")
                .hint("save the program as plain text with one block a line"));
        }
        self.at = end + 1;
        Ok(Piece::Comment(text.trim()))
    }

    /// `/` and `/1` are the same switch; `/2` to `/9` are others, of which nothing is known.
    fn delete(&mut self) -> Result<Piece<'a>, Fault> {
        let start = self.at;
        self.at += 1;
        let digits =
            self.line.as_bytes()[self.at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let switch = &self.line[self.at..self.at + digits];
        self.at += digits;
        if switch.is_empty() || switch == "1" {
            return Ok(Piece::Delete(start));
        }
        Err(Fault::span(start..self.at, format!("the block delete switch /{switch} is not known"))
            .hint("only / and /1 are known; remove the block or the slash"))
    }

    fn end_of_block(&mut self) -> Result<(), Fault> {
        let start = self.at + 1;
        let rest = &self.line[start..];
        if rest.trim().is_empty() {
            self.at = self.line.len();
            return Ok(());
        }
        let start = start + rest.len() - rest.trim_start().len();
        Err(Fault::span(
            start..self.line.trim_end().len(),
            "text follows the end of the block",
        )
        .hint("; ends a block on this control: write comments in parentheses and one block a line"))
    }

    /// A character that begins neither a word nor a comment.
    fn stray(&self) -> Fault {
        let rest = &self.line[self.at..];
        let Some(first) = rest.chars().next() else {
            return Fault::line("the line ends too early");
        };
        let fault = |what: &str| Fault::span(self.at..self.at + first.len_utf8(), what);
        match first {
            '0'..='9' | '+' | '-' | '.' => {
                let width = rest
                    .bytes()
                    .take_while(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
                    .count();
                Fault::span(self.at..self.at + width, "a number without an address letter")
                    .hint("write the letter in front of it, such as X-12.345")
            }
            '#' | '[' | ']' | '=' | '*' | '<' | '>' => {
                fault(&format!("`{first}` belongs to a macro, and macros are not followed"))
                    .hint("write the coordinates as numbers")
            }
            ')' => fault("a comment is closed that was not opened")
                .hint("comments do not nest: the first ) ends them"),
            '%' => fault("% stands inside a block")
                .hint("% stands alone, on the first and on the last line of the file"),
            ',' => fault("`,` has no meaning in a block").hint("the decimal sign is a point"),
            ':' => fault("`:` has no meaning in a block").hint("a program number begins with O"),
            c if c.is_control() => fault(&format!("a control character, code {:#04x}", c as u32))
                .hint("save the program as plain text with one block a line"),
            c => fault(&format!("`{c}` has no meaning in a block"))
                .hint("text for the operator stands in parentheses"),
        }
    }
}

/// A keyword as a word of the block.
pub(crate) fn spelled(keyword: Keyword, span: std::ops::Range<usize>) -> Word {
    let (start, width) = (span.start as u32, (span.end - span.start) as u32);
    // Whoever looks for words of machine coordinates finds them by their number.
    let value = if keyword.code() == Code::MachineCoordinates { 53.0 } else { 0.0 };
    Word { value, start, width, letter: b'G', point: false, keyword: Some(keyword) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Dialect;

    fn only_word(line: &str) -> Word {
        match Lexer::new(line, Grammar::of(Dialect::Fanuc)).piece() {
            Ok(Some(Piece::Word(word))) => word,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn every_way_to_write_a_number_is_read_exactly() {
        for (text, value, point) in [
            ("X10", 10.0_f64, false),
            ("X10.", 10.0, true),
            ("X.5", 0.5, true),
            ("X-.5", -0.5, true),
            ("X+3.25", 3.25, true),
            ("X-0.", 0.0, true),
            ("X0", 0.0, false),
            ("X 7.5", 7.5, true),
            ("x1234.5678", 1234.5678, true),
            ("X99999.999", 99_999.999, true),
            ("X000012.300", 12.3, true),
            ("X0.00000000000001", 1e-14, true),
        ] {
            let word = only_word(text);
            assert_eq!((word.letter, word.point), (b'X', point), "{text}");
            assert_eq!(word.value.to_bits(), value.to_bits(), "{text}");
        }
    }

    #[test]
    fn a_number_has_the_bits_that_the_standard_library_gives_it() {
        for thousandths in (-400_000..400_000).step_by(37) {
            let text = format!("{:.3}", f64::from(thousandths) / 1000.0);
            let expected: f64 = text.parse().unwrap();
            assert_eq!(only_word(&format!("Y{text}")).value.to_bits(), expected.to_bits());
        }
    }

    #[test]
    fn a_number_that_is_none_is_refused_with_its_place() {
        for (line, span, what) in [
            ("X", 0..1, "no number"),
            ("G01 X Y1.", 4..5, "no number"),
            ("X.", 0..2, "no number"),
            ("X-", 0..2, "no number"),
            ("X--1.", 0..5, "more than one sign"),
            ("X1.-", 0..4, "not in front"),
            ("X1.0.0", 0..6, "more than one decimal point"),
            ("X1234567890123456", 0..17, "16 digits"),
        ] {
            let mut lexer = Lexer::new(line, Grammar::of(Dialect::Fanuc));
            let fault = loop {
                match lexer.piece() {
                    Ok(Some(_)) => {}
                    Ok(None) => panic!("{line} was read"),
                    Err(fault) => break fault,
                }
            };
            assert_eq!(fault.span, Some(span), "{line}");
            assert!(fault.what.contains(what), "{line}: {}", fault.what);
        }
    }

    #[test]
    fn a_block_is_words_and_comments_up_to_its_end() {
        let mut lexer = Lexer::new("/N10G1(TO THE POLE)x-1.5\tY2 ; ", Grammar::of(Dialect::Fanuc));
        let mut seen = Vec::new();
        while let Some(piece) = lexer.piece().unwrap() {
            seen.push(match piece {
                Piece::Word(word) => word.name(),
                Piece::Comment(text) => format!("({text})"),
                Piece::Delete(at) => format!("/ at {at}"),
            });
        }
        assert_eq!(seen, ["/ at 0", "N10", "G01", "(TO THE POLE)", "X-1.5", "Y2"]);
    }
}
