//! What is special in how a logger writes its text.

use encoding_rs::Encoding;

/// How the text of a log is coded, by one of the names of the WHATWG Encoding Standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextEncoding(&'static Encoding);

impl TextEncoding {
    /// The encoding of a name such as `utf-16le` or `windows-1252`.
    pub fn parse(name: &str) -> Option<Self> {
        Encoding::for_label(name.as_bytes()).map(Self)
    }

    pub(crate) fn get(self) -> &'static Encoding {
        self.0
    }
}

/// What a logger writes where the bar is out of range, besides nothing and the words that are known anyhow.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OutOfRange {
    /// Words, in whatever case.
    pub words: Vec<String>,
    /// Numbers, in the unit of the column.
    pub numbers: Vec<f64>,
}

impl OutOfRange {
    pub(crate) fn has_word(&self, written: &str) -> bool {
        self.words.iter().any(|word| word.to_lowercase() == written.to_lowercase())
    }

    pub(crate) fn has_number(&self, value: f64) -> bool {
        self.numbers.contains(&value)
    }
}

/// The mark before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalMark {
    /// `6.3`
    Point,
    /// `6,3`
    Comma,
}

impl DecimalMark {
    /// The mark as the files have it.
    pub fn parse(written: &str) -> Option<Self> {
        match written {
            "." => Some(Self::Point),
            "," => Some(Self::Comma),
            _ => None,
        }
    }

    pub(crate) fn char(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }
}
