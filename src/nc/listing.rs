//! A whole file as blocks: what stands between the two `%`, divided into programs.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::lex::{Fault, Lexer, Piece, Word};
use crate::error::{Error, Place, Result};

/// A line of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Counted from 1.
    pub(crate) number: usize,
    /// Byte of the source at which it begins.
    start: usize,
}

/// A line that says something.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Where it stands.
    pub(crate) line: Line,
    /// Its words, without the block number and the program number.
    words: Range<usize>,
    /// Its last comment as an index into [`Listing::labels`]; 0 when it has none.
    pub(crate) label: usize,
}

/// One program of the file: from its O number to the next.
#[derive(Debug, Clone)]
pub(crate) struct Section {
    /// Its O number; only the first program of a file can do without.
    pub(crate) number: Option<u32>,
    /// Its blocks.
    pub(crate) blocks: Range<usize>,
    /// The last line that belongs to it.
    pub(crate) last: Line,
}

/// A file taken apart, before anything is obeyed.
#[derive(Debug)]
pub(crate) struct Listing<'a> {
    file: &'a Path,
    source: &'a str,
    words: Vec<Word>,
    /// All blocks, in the order of the file.
    pub(crate) blocks: Vec<Block>,
    /// All comments, in the order of the file; entry 0 is empty.
    pub(crate) labels: Vec<String>,
    /// The main program and after it the subprograms.
    pub(crate) sections: Vec<Section>,
    by_number: BTreeMap<u32, usize>,
    /// The last line of a file that begins with `%` and does not end with it.
    pub(crate) unclosed: Option<Line>,
}

impl<'a> Listing<'a> {
    /// Takes a file apart. Blocks with a slash vanish when block delete is on.
    pub(crate) fn new(source: &'a str, file: &'a Path, block_delete: bool) -> Result<Self> {
        // Windows editors put this mark in front of a text; it is not part of it.
        let source = source.strip_prefix('\u{feff}').unwrap_or(source);
        if source.trim().is_empty() {
            return Err(Error::input("the program file is empty").at(Place::file(file)));
        }
        let mut listing = Self {
            file,
            source,
            words: Vec::with_capacity(source.len() / 8),
            blocks: Vec::with_capacity(source.len() / 24),
            labels: vec![String::new()],
            sections: Vec::new(),
            by_number: BTreeMap::new(),
            unclosed: None,
        };
        let marks = listing.percent_lines()?;
        let first = marks.first().map_or(0, |mark| mark.number);
        let last = marks.get(1).map_or(usize::MAX, |mark| mark.number);
        for line in lines(source) {
            if line.number > first && line.number < last {
                listing.line(line, block_delete)?;
            }
        }
        if listing.sections.is_empty() {
            return Err(Error::input("the file holds no program")
                .at(Place::file(file))
                .hint("a program stands between a line % and another line %"));
        }
        if let Some(section) = listing.sections.last_mut() {
            section.blocks.end = listing.blocks.len();
        }
        if marks.len() == 1 {
            listing.unclosed = listing.sections.last().map(|section| section.last);
        }
        Ok(listing)
    }

    /// The words of a block.
    pub(crate) fn words(&self, block: &Block) -> &[Word] {
        &self.words[block.words.clone()]
    }

    /// The program with this O number.
    pub(crate) fn section(&self, number: u32) -> Option<usize> {
        self.by_number.get(&number).copied()
    }

    /// A fault with the line in which it is.
    pub(crate) fn locate(&self, line: Line, fault: Fault) -> Error {
        let text = text(self.source, line);
        let place = match fault.span {
            None => Place::line(self.file, line.number, text),
            Some(span) => {
                let before = text.get(..span.start).unwrap_or("");
                let within = text.get(span).unwrap_or("");
                let (column, width) = (before.chars().count() + 1, within.chars().count());
                Place::span(self.file, line.number, column, width.max(1), text)
            }
        };
        let error = Error::input(fault.what).at(place);
        match fault.hint {
            Some(hint) => error.hint(hint),
            None => error,
        }
    }

    /// The lines of the first two `%`. What stands before the first is the header of the file, what stands
    /// after the second is none of the control's business.
    fn percent_lines(&self) -> Result<Vec<Line>> {
        let is_mark = |line: &Line| text(self.source, *line).trim_start().starts_with('%');
        let marks: Vec<Line> = lines(self.source).filter(is_mark).take(2).collect();
        if let [mark] = marks[..] {
            let after = self.source[mark.start..].split_once('\n');
            let last = after.is_none_or(|(_, rest)| rest.trim().is_empty());
            if last && !self.source[..mark.start].trim().is_empty() {
                let fault = Fault::line("the only % of the file stands at its end").hint(
                    "a control skips everything before the first %: begin the file with a line %",
                );
                return Err(self.locate(mark, fault));
            }
        }
        Ok(marks)
    }

    /// Takes one line apart.
    fn line(&mut self, line: Line, block_delete: bool) -> Result<()> {
        let text = text(self.source, line);
        if text.trim().is_empty() {
            return Ok(());
        }
        let (words, labels) = (self.words.len(), self.labels.len());
        let mut number = None;
        let mut numbered = false;
        let mut lexer = Lexer::new(text);
        loop {
            let piece = lexer.piece().map_err(|fault| self.locate(line, fault))?;
            let fresh = self.words.len() == words;
            match piece {
                None => break,
                Some(Piece::Comment(text)) => self.labels.push(text.to_owned()),
                Some(Piece::Delete(at)) => {
                    if !fresh || number.is_some() {
                        let fault =
                            Fault::span(at..at + 1, "a slash stands in the middle of a block")
                                .hint("block delete stands at the head of the block");
                        return Err(self.locate(line, fault));
                    }
                    if block_delete {
                        self.labels.truncate(labels);
                        return Ok(());
                    }
                }
                Some(Piece::Word(word)) if word.letter == b'O' => {
                    if !fresh || numbered || number.is_some() {
                        let fault = Fault::word(&word, "a program number stands inside a block")
                            .hint("O is the first word of a program");
                        return Err(self.locate(line, fault));
                    }
                    number = Some(word);
                }
                Some(Piece::Word(word)) if word.letter == b'N' => {
                    if !fresh || numbered {
                        let fault = Fault::word(&word, "a block number stands inside a block")
                            .hint("N is the first word of a block, and the only one of its kind");
                        return Err(self.locate(line, fault));
                    }
                    if word.whole().is_none() {
                        let fault =
                            Fault::word(&word, format!("{} is not a block number", word.name()))
                                .hint("block numbers are whole numbers from 1 to 99999");
                        return Err(self.locate(line, fault));
                    }
                    numbered = true;
                }
                Some(Piece::Word(word)) => self.words.push(word),
            }
        }
        self.open_section(line, number).map_err(|fault| self.locate(line, fault))?;
        let label = if self.labels.len() > labels { self.labels.len() - 1 } else { 0 };
        if self.words.len() > words || label > 0 {
            self.blocks.push(Block { line, words: words..self.words.len(), label });
        }
        Ok(())
    }

    /// The line belongs to the current program, or begins one when it has an O number.
    fn open_section(&mut self, line: Line, number: Option<Word>) -> std::result::Result<(), Fault> {
        let start = self.blocks.len();
        let section = match (self.sections.last_mut(), number) {
            (Some(section), None) => {
                section.last = line;
                return Ok(());
            }
            // Comments in front of the first O number belong to its program.
            (Some(section), Some(_))
                if section.number.is_none()
                    && self.blocks.iter().all(|block| block.words.is_empty()) =>
            {
                section
            }
            (Some(section), Some(_)) => {
                section.blocks.end = start;
                self.sections.push(Section::new(line, start));
                let last = self.sections.len() - 1;
                &mut self.sections[last]
            }
            (None, _) => {
                self.sections.push(Section::new(line, start));
                &mut self.sections[0]
            }
        };
        section.last = line;
        if let Some(word) = number {
            let Some(number) = word.whole().filter(|n| (1..=99_999_999).contains(n)) else {
                return Err(Fault::word(&word, format!("{} is not a program number", word.name()))
                    .hint("program numbers are whole numbers from 1 to 99999999"));
            };
            section.number = Some(number);
            if self.by_number.insert(number, self.sections.len() - 1).is_some() {
                return Err(Fault::word(&word, format!("the file has two programs O{number}"))
                    .hint("a call could mean either: renumber one of them"));
            }
        }
        Ok(())
    }
}

impl Section {
    fn new(line: Line, start: usize) -> Self {
        Self { number: None, blocks: start..start, last: line }
    }
}

/// All lines of a text. A block ends with LF, CR LF or LF CR CR, so that carriage returns can stand at
/// both ends of a line.
fn lines(source: &str) -> impl Iterator<Item = Line> {
    let mut start = 0;
    source.split('\n').enumerate().map(move |(index, text)| {
        let blanks = text.len() - text.trim_start_matches('\r').len();
        let line = Line { number: index + 1, start: start + blanks };
        start += text.len() + 1;
        line
    })
}

/// The text of a line without its end.
fn text(source: &str, line: Line) -> &str {
    let rest = source.get(line.start..).unwrap_or("");
    rest.split('\n').next().unwrap_or("").trim_end_matches('\r')
}
