//! A whole file as blocks: what stands between the two `%`, divided into programs.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::bounds;
use super::grammar::{Form, Grammar};
use super::klartext;
use super::language;
use super::lex::{Lexer, Piece};
use super::lines::{Line, lines, text};
use super::reading::Reading;
use super::word::{Fault, Word};
use crate::error::{Error, Place, Result};

/// What becomes of an error: the reader stops at it, the checker keeps it and goes on.
pub(crate) type Refuse<'a> = dyn FnMut(Error) -> Result<()> + 'a;

/// A line that says something.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Where it stands.
    pub(crate) line: Line,
    /// Its words, without the block number and the program number.
    words: Range<usize>,
    /// Its last comment as an index into [`Listing::labels`]; 0 when it has none.
    pub(crate) label: usize,
    /// A part of it could not be read and is not among its words.
    pub(crate) faulty: bool,
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
    /// The file, for messages.
    pub(crate) file: &'a Path,
    source: &'a str,
    words: Vec<Word>,
    /// All blocks, in the order of the file.
    pub(crate) blocks: Vec<Block>,
    /// All comments, in the order of the file; entry 0 is empty.
    pub(crate) labels: Vec<String>,
    /// The main program and after it the subprograms.
    pub(crate) sections: Vec<Section>,
    by_number: BTreeMap<u32, usize>,
    /// Numbers of the lines of the two `%`: 0 and the largest number where there are none.
    pub(crate) between: (usize, usize),
    /// The last line of a file that begins with `%` and does not end with it.
    pub(crate) unclosed: Option<Line>,
    grammar: &'static Grammar,
    /// What is open from block to block of Klartext.
    open: klartext::Open,
}

/// A larger program is refused before it is taken apart, which takes ten times the memory.
const LARGEST_BYTES: usize = 64 << 20;
/// A program with more faults than this is wrong as a whole: it is read, or checked, no further.
pub(crate) const MOST_FAULTS: usize = 100_000;

impl<'a> Listing<'a> {
    /// Takes a file apart. Blocks with a slash vanish when block delete is on.
    pub(crate) fn new(
        source: &'a str,
        file: &'a Path,
        reading: &Reading,
        refuse: &mut Refuse<'_>,
    ) -> Result<Self> {
        // Windows editors put this mark in front of a text; it is not part of it.
        let source = source.strip_prefix('\u{feff}').unwrap_or(source);
        if source.trim().is_empty() {
            return Err(Error::input("the program file is empty").at(Place::file(file)));
        }
        if source.len() > LARGEST_BYTES {
            return Err(Error::input("the program has more than 64 MiB")
                .at(Place::file(file))
                .hint("this is no program of a ball-bar test: a million chords have half of it"));
        }
        let grammar = Grammar::of(reading.dialect);
        language::check(source, file, grammar.form)?;
        let mut listing = Self {
            file,
            source,
            words: Vec::with_capacity(source.len() / 8),
            blocks: Vec::with_capacity(source.len() / 24),
            labels: vec![String::new()],
            sections: Vec::new(),
            by_number: BTreeMap::new(),
            between: (0, usize::MAX),
            unclosed: None,
            grammar,
            open: klartext::Open::default(),
        };
        let marks = listing.percent_lines(refuse)?;
        let number = |k: usize, none| marks.get(k).map_or(none, |mark| mark.number);
        let (first, last) = (number(0, 0), number(1, usize::MAX));
        listing.between = (first, last);
        let mut faults = 0;
        for (line, text) in lines(source).skip(first).take_while(|(line, _)| line.number < last) {
            faults += usize::from(listing.line(line, text, reading, refuse)?);
            if faults > MOST_FAULTS {
                let fault = Fault::line(format!("more than {MOST_FAULTS} lines cannot be read"))
                    .hint("is this a program, and is `dialect` of the machine file that of its control?");
                return Err(listing.locate(line, fault));
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
        if marks.len() == 1 || (listing.grammar.form == Form::Klartext && !listing.open.ended) {
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

    /// The lines between the two `%`, or all where there are none.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (Line, &'a str)> {
        let (first, last) = self.between;
        lines(self.source).skip(first).take_while(move |(line, _)| line.number < last)
    }

    /// All lines of the file.
    pub(crate) fn all_lines(&self) -> impl Iterator<Item = (Line, &'a str)> {
        lines(self.source)
    }

    /// How many bytes a program of the file takes.
    pub(crate) fn bytes_of(&self, section: &Section) -> usize {
        let blocks = &self.blocks[section.blocks.clone()];
        let start = blocks.first().map_or(section.last.start, |block| block.line.start);
        let last = section.last;
        (last.start + text(self.source, last).len() + 1).saturating_sub(start)
    }

    /// The error of a file whose end is not there.
    pub(crate) fn cut_off(&self, last: Line) -> Error {
        let (begins, ends) = if self.grammar.form == Form::Klartext {
            ("BEGIN PGM", "END PGM, the name and MM")
        } else {
            ("%", "a line %")
        };
        let fault = Fault::line(format!("the file begins with {begins} and does not end with it"))
            .hint(format!("the file may have been cut off; end it with {ends}"));
        self.locate(last, fault)
    }

    /// An error of the file as a whole.
    pub(crate) fn whole(&self, what: impl Into<String>) -> Error {
        Error::input(what).at(Place::file(self.file))
    }

    /// The block that stands in a line.
    pub(crate) fn block_of(&self, line: usize) -> Option<&Block> {
        let index = self.blocks.partition_point(|block| block.line.number < line);
        self.blocks.get(index).filter(|block| block.line.number == line)
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
    fn percent_lines(&self, refuse: &mut Refuse<'_>) -> Result<Vec<Line>> {
        if self.grammar.form != Form::Numbered {
            return Ok(Vec::new());
        }
        let is_mark = |text: &str| text.trim_start().starts_with('%');
        let marks = lines(self.source).filter_map(|(line, text)| is_mark(text).then_some(line));
        let marks: Vec<Line> = marks.take(2).collect();
        if let [mark] = marks[..] {
            let after = self.source[mark.start..].split_once('\n');
            let last = after.is_none_or(|(_, rest)| rest.trim().is_empty());
            if last && !self.source[..mark.start].trim().is_empty() {
                let fault = Fault::line("the only % of the file stands at its end").hint(
                    "a control skips everything before the first %: begin the file with a line %",
                );
                refuse(self.locate(mark, fault))?;
                return Ok(Vec::new());
            }
        }
        Ok(marks)
    }

    /// Takes one line apart, and says whether it is faulty; of such a one the words that could be read are kept.
    fn line(
        &mut self,
        line: Line,
        text: &'a str,
        reading: &Reading,
        refuse: &mut Refuse<'_>,
    ) -> Result<bool> {
        if text.trim_start().is_empty() {
            return Ok(false);
        }
        let (words, labels) = (self.words.len(), self.labels.len());
        let mut number = None;
        let mut faulty = false;
        match self.pieces(text, reading, &mut number) {
            Ok(true) => {}
            Ok(false) => {
                self.words.truncate(words);
                self.labels.truncate(labels);
                return Ok(false);
            }
            Err(fault) => {
                refuse(self.locate(line, fault))?;
                faulty = true;
            }
        }
        if let Err(fault) = self.open_section(line, number) {
            refuse(self.locate(line, fault))?;
        }
        let label = if self.labels.len() > labels { self.labels.len() - 1 } else { 0 };
        if self.words.len() > words || label > 0 || faulty {
            self.blocks.push(Block { line, words: words..self.words.len(), label, faulty });
        }
        Ok(faulty)
    }

    /// Adds the words and comments of a line; false when block delete skips it. What stands behind a
    /// fault is read too: of several faults the first is told.
    fn pieces(
        &mut self,
        text: &'a str,
        reading: &Reading,
        number: &mut Option<Word>,
    ) -> std::result::Result<bool, Fault> {
        let words = self.words.len();
        let (mut numbered, mut first) = (false, None);
        if self.grammar.form == Form::Klartext {
            return self.klartext(text);
        }
        let mut lexer = Lexer::new(text, self.grammar);
        loop {
            let fault = match lexer.piece() {
                Ok(None) => break,
                Ok(Some(Piece::Delete(_)))
                    if self.words.len() == words && number.is_none() && reading.block_delete =>
                {
                    return Ok(false);
                }
                Ok(Some(piece)) => match self.piece(piece, words, &mut numbered, number) {
                    Ok(()) => continue,
                    Err(fault) => fault,
                },
                Err(fault) => fault,
            };
            let goes_on = lexer.resume(&fault);
            first.get_or_insert(fault);
            if !goes_on {
                break;
            }
        }
        first.map_or(Ok(true), Err)
    }

    /// The same of a block of Klartext.
    fn klartext(&mut self, text: &'a str) -> std::result::Result<bool, Fault> {
        let mut block = klartext::Block::new(text, self.grammar);
        let mut read = block.read(&mut self.open);
        let (words, mut numbered, mut program) = (self.words.len(), false, None);
        for piece in block.pieces {
            let added = self.piece(piece, words, &mut numbered, &mut program);
            read = read.and(added);
        }
        read.map(|()| true)
    }

    /// Adds a word or a comment of the block whose words begin at index `words`.
    fn piece(
        &mut self,
        piece: Piece<'_>,
        words: usize,
        numbered: &mut bool,
        number: &mut Option<Word>,
    ) -> std::result::Result<(), Fault> {
        let fresh = self.words.len() == words;
        match piece {
            Piece::Comment(text) => self.labels.push(text.to_owned()),
            Piece::Delete(at) => {
                if !fresh || number.is_some() {
                    return Err(Fault::span(at..at + 1, "a slash stands in the middle of a block")
                        .hint("block delete stands at the head of the block"));
                }
            }
            Piece::Word(word) if word.letter == b'O' => {
                if !fresh || *numbered || number.is_some() {
                    return Err(Fault::word(&word, "a program number stands inside a block")
                        .hint("O is the first word of a program"));
                }
                *number = Some(word);
            }
            Piece::Word(word) if word.letter == b'N' => {
                if !fresh || *numbered {
                    return Err(Fault::word(&word, "a block number stands inside a block")
                        .hint("N is the first word of a block, and the only one of its kind"));
                }
                if word.whole().is_none() {
                    return Err(Fault::word(
                        &word,
                        format!("{} is not a block number", word.name()),
                    )
                    .hint("block numbers are whole numbers from 1 to 99999"));
                }
                bounds::check(&word, 0.0, self.grammar)?;
                *numbered = true;
            }
            Piece::Word(word) => self.words.push(word),
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
