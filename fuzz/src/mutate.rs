//! What can be done to an input so that it still looks like one.

use std::io::Write as _;
use std::ops::Range;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::choices::Choices;

/// No mutated input is longer, bytes: a reader's time for a long one is tested by the corpus.
const LONGEST: usize = 1 << 17;

/// Numbers that a formula or an allocation may not survive.
const NUMBERS: [&str; 44] = [
    "0",
    "-0",
    "0.0",
    "-0.0",
    "1",
    "-1",
    "1e300",
    "-1e300",
    "1e308",
    "1e309",
    "1e-300",
    "-1e-300",
    "5e-324",
    "1e15",
    "1e12",
    "1e9",
    "1e6",
    "1e5",
    "1e-5",
    "1e-9",
    "1e-12",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "NaN",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999",
    "0.1",
    "0.30000000000000004",
    "9999",
    "1000",
    "1.7976931348623157e308",
    "٣",
    "1_000",
    "0x10",
];

/// Texts that are no numbers and that a reader or a terminal may take amiss.
const TEXTS: [&[u8]; 26] = [
    b"\0",
    b"\x1b[2J\x1b[31m",
    b"\x1b]0;title\x07",
    b"\r",
    b"\r\n",
    b"\n",
    b"\n\n\n",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\xff",
    b"\xc3",
    "\u{2028}".as_bytes(),
    "\u{202e}".as_bytes(),
    "é".as_bytes(),
    "µ".as_bytes(),
    "𝟙".as_bytes(),
    b"(",
    b")",
    b"[",
    b"]",
    b"{",
    b"\"",
    b"'''",
    b"=",
    b"#",
    b"%",
];

/// An input, while it is changed.
#[derive(Debug)]
pub struct Mutation<'a> {
    /// What it is now.
    bytes: Vec<u8>,
    choices: &'a mut Choices,
    /// Words of the language.
    words: &'a [&'a str],
    /// Other inputs, to take lines from.
    others: &'a [Vec<u8>],
}

/// Changes one of the seeds in one to eight ways.
pub fn mutated(choices: &mut Choices, seeds: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let bytes = choices.one(seeds).cloned().unwrap_or_default();
    let times = 1 + choices.below(4) * choices.below(3);
    let mut mutation = Mutation { bytes, choices, words, others: seeds };
    for _ in 0..times {
        mutation.change();
        mutation.bytes.truncate(LONGEST);
    }
    if mutation.choices.once_in(64) {
        mutation.whole();
    }
    mutation.bytes
}

impl Mutation<'_> {
    fn change(&mut self) {
        match self.choices.below(16) {
            0..=4 => self.number(),
            5 | 6 => self.word(),
            7 | 8 => self.line(),
            9 => self.line_of_another(),
            10 => self.text(),
            11 => self.piece(),
            12 => self.list(),
            13 => self.repeated(),
            _ => self.byte(),
        }
    }

    /// Bytes from somewhere on that satisfy a condition.
    fn run_of(&mut self, is: impl Fn(u8) -> bool) -> Option<Range<usize>> {
        let from = self.choices.below(self.bytes.len());
        let start = from + self.bytes.get(from..)?.iter().position(|byte| is(*byte))?;
        let length = self.bytes[start..].iter().take_while(|byte| is(**byte)).count();
        // The run may have begun before.
        let before = self.bytes[..start].iter().rev().take_while(|byte| is(**byte)).count();
        Some(start - before..start + length)
    }

    fn replace(&mut self, range: Range<usize>, by: &[u8]) {
        self.bytes.splice(range, by.iter().copied());
    }

    /// Another number, or the same one changed.
    fn number(&mut self) {
        let digit = |byte: u8| byte.is_ascii_digit() || byte == b'.';
        let Some(range) = self.run_of(digit) else { return };
        let old = String::from_utf8_lossy(&self.bytes[range.clone()]).into_owned();
        let new = match self.choices.below(12) {
            0..=3 => {
                self.choices.one(&NUMBERS).map_or(String::new(), |number| (*number).to_owned())
            }
            4 => format!("-{old}"),
            5 => old.replace('.', ""),
            6 => format!("{old}{}", self.choices.below(10)),
            7 => old[..old.len() - 1].to_owned(),
            8 => format!("{old}e{}", self.choices.below(40) as i64 - 20),
            9 => String::new(),
            10 => format!("{}.{}", self.choices.below(1000), self.choices.below(1000)),
            _ => {
                let value: f64 = old.parse().unwrap_or(1.0);
                let factor = [0.5, 2.0, 10.0, 0.1, 1.001, -1.0][self.choices.below(6)];
                format!("{:?}", value * factor)
            }
        };
        self.replace(range, new.as_bytes());
    }

    /// Another word, of the language or of the same text.
    fn word(&mut self) {
        let letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-';
        let Some(range) = self.run_of(letter) else { return };
        let by = if self.choices.once_in(3) {
            let other = self.run_of(letter).unwrap_or(0..0);
            self.bytes[other].to_vec()
        } else {
            self.choices.one(self.words).map_or(Vec::new(), |word| word.as_bytes().to_vec())
        };
        let by = if self.choices.once_in(6) { Vec::new() } else { by };
        let range = if self.choices.once_in(4) { range.end..range.end } else { range };
        self.replace(range, &by);
    }

    fn lines(&self) -> Vec<Vec<u8>> {
        self.bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
    }

    /// A line is lost, doubled, exchanged with another or moved.
    fn line(&mut self) {
        let mut lines = self.lines();
        if lines.is_empty() {
            return;
        }
        let (a, b) = (self.choices.below(lines.len()), self.choices.below(lines.len()));
        match self.choices.below(4) {
            0 => drop(lines.remove(a)),
            1 => lines.insert(b, lines[a].clone()),
            2 => lines.swap(a, b),
            _ => {
                let line = lines.remove(a);
                lines.insert(b.min(lines.len()), line);
            }
        }
        self.bytes = lines.concat();
    }

    /// A line of another input comes in.
    fn line_of_another(&mut self) {
        let Some(other) = self.choices.one(self.others) else { return };
        let theirs: Vec<&[u8]> = other.split_inclusive(|byte| *byte == b'\n').collect();
        let Some(line) = self.choices.one(&theirs) else { return };
        let mut lines = self.lines();
        let at = self.choices.below(lines.len() + 1);
        lines.insert(at, line.to_vec());
        self.bytes = lines.concat();
    }

    /// Something comes in that is hard to read.
    fn text(&mut self) {
        let at = self.choices.below(self.bytes.len() + 1);
        let text = self.choices.one(&TEXTS).map_or(&b""[..], |text| text);
        let text = text.repeat(if self.choices.once_in(8) { 300 } else { 1 });
        self.replace(at..at, &text);
    }

    /// A piece is lost, doubled or moved.
    fn piece(&mut self) {
        let start = self.choices.below(self.bytes.len());
        let most = 1 << (1 + self.choices.below(9));
        let length = 1 + self.choices.below(most);
        let piece = start..(start + length).min(self.bytes.len());
        let held = self.bytes[piece.clone()].to_vec();
        if !self.choices.once_in(3) {
            self.replace(piece, b"");
        }
        if !self.choices.once_in(3) {
            let at = self.choices.below(self.bytes.len() + 1);
            self.replace(at..at, &held);
        }
    }

    /// A list in brackets is emptied, shortened, lengthened or nested.
    fn list(&mut self) {
        let from = self.choices.below(self.bytes.len());
        let Some(open) = self.bytes[from..].iter().position(|byte| *byte == b'[') else { return };
        let open = from + open;
        let Some(length) = self.bytes[open..].iter().position(|byte| *byte == b']') else { return };
        let inside = self.bytes[open + 1..open + length].to_vec();
        let first = inside.split(|byte| *byte == b',').next().unwrap_or(b"").to_vec();
        let new: Vec<u8> = match self.choices.below(5) {
            0 => Vec::new(),
            1 => first,
            2 => [&inside[..], b",", &first].concat(),
            3 => [b"[", &inside[..], b"]"].concat(),
            _ => [&first[..], b","].concat().repeat(1 << self.choices.below(12)),
        };
        self.replace(open + 1..open + length, &new);
    }

    /// A line or a piece comes many times over.
    fn repeated(&mut self) {
        let mut lines = self.lines();
        if lines.is_empty() {
            return;
        }
        let at = self.choices.below(lines.len());
        let most = LONGEST / (4 * lines[at].len().max(1));
        let limit = (1 << self.choices.below(12)).min(most.max(1));
        let times = 1 + self.choices.below(limit);
        lines[at] = lines[at].repeat(times);
        self.bytes = lines.concat();
    }

    fn byte(&mut self) {
        let at = self.choices.below(self.bytes.len());
        let byte = self.choices.below(256) as u8;
        match self.choices.below(4) {
            0 => self.bytes.insert(at, byte),
            1 => self.bytes.truncate(at),
            2 if !self.bytes.is_empty() => drop(self.bytes.remove(at)),
            _ if !self.bytes.is_empty() => self.bytes[at] ^= 1 << (byte % 8),
            _ => {}
        }
    }

    /// The file as a whole is packed, encoded or ended otherwise.
    fn whole(&mut self) {
        self.bytes = match self.choices.below(6) {
            0 => gzipped(&self.bytes),
            1 => gzipped(&gzipped(&self.bytes)),
            2 => {
                let mut packed = gzipped(&self.bytes);
                packed.truncate(self.choices.below(packed.len()));
                packed
            }
            3 => String::from_utf8_lossy(&self.bytes)
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect(),
            4 => String::from_utf8_lossy(&self.bytes).replace('\n', "\r\n").into_bytes(),
            _ => String::from_utf8_lossy(&self.bytes).replace('\n', "\r").into_bytes(),
        };
    }
}

/// Packs as `gzip` does.
pub fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    let written = packer.write_all(bytes);
    debug_assert!(written.is_ok(), "memory takes whatever is written");
    packer.finish().unwrap_or_default()
}
