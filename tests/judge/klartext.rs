//! What stands in a program in HEIDENHAIN Klartext: numbered blocks of plain words, and cycles of several blocks.

use crate::modal::Motion;
use crate::words::{Block, Part, Refused, Spoken, Word, figures, refuse};

/// What is read so far.
#[derive(Default)]
struct Reader {
    blocks: Vec<Block>,
    /// Where CC put the centre of arcs, in the coordinates of the program.
    pole: [Option<Word>; 3],
    /// The cycle that is not complete: its number and that of its next block.
    cycle: Option<(u32, u32)>,
    /// The last comment that is a line: what the operator reads at a stop, as long as nothing has moved since.
    above: String,
}

/// The file is the program, from BEGIN PGM to END PGM.
pub(crate) fn parts(text: &str) -> Result<Vec<Part>, Refused> {
    let mut reader = Reader::default();
    let count = text.lines().count();
    for (index, line) in text.lines().enumerate() {
        let at = index + 1;
        let (code, comment) = line.split_once(';').unwrap_or((line, ""));
        let mut tokens = code.split_whitespace();
        if tokens.next().and_then(|number| number.parse().ok()) != Some(index) {
            return refuse(at, "blocks are numbered one by one, from 0");
        }
        let tokens: Vec<&str> = tokens.collect();
        match (&tokens[..], at == 1, at == count) {
            (["BEGIN", "PGM", _, unit @ ("MM" | "INCH")], true, false) => {
                let mut block = Block::new(at);
                block.spoken.push(Spoken::Unit(*unit == "INCH"));
                reader.blocks.push(block);
            }
            (["END", "PGM", ..], false, true) => {}
            (_, true, _) | (_, _, true) | (["BEGIN" | "END", ..], ..) => {
                return refuse(at, "a program stands between BEGIN PGM and END PGM");
            }
            _ => reader.block(&tokens, comment.trim(), at)?,
        }
    }
    Ok(vec![Part { number: None, blocks: reader.blocks }])
}

impl Reader {
    fn block(&mut self, tokens: &[&str], comment: &str, line: usize) -> Result<(), Refused> {
        let mut block = Block::new(line);
        let moves_or_stops = matches!(tokens, ["L" | "C" | "STOP", ..]);
        let above = if moves_or_stops { std::mem::take(&mut self.above) } else { String::new() };
        comment.clone_into(&mut block.comment);
        if self.cycle.is_some() && !tokens.is_empty() && !tokens.starts_with(&["CYCL", "DEF"]) {
            return refuse(line, "a cycle that is not complete");
        }
        match tokens {
            [] => comment.clone_into(&mut self.above),
            ["L", words @ ..] => {
                let rapid = words.contains(&"FMAX");
                block.spoken.push(Spoken::Motion(if rapid { Motion::Rapid } else { Motion::Line }));
                add(&mut block, words)?;
            }
            ["C", words @ ..] => {
                let senses: Vec<i8> = words.iter().filter_map(|word| sense(word)).collect();
                let &[sense] = &senses[..] else { return refuse(line, "an arc of no one sense") };
                block.spoken.push(Spoken::Motion(Motion::Arc(sense)));
                let others: Vec<&str> =
                    words.iter().copied().filter(|word| !word.starts_with("DR")).collect();
                add(&mut block, &others)?;
                block.pole = Some(self.pole);
            }
            ["CC", words @ ..] => {
                let mut stated = Block::new(line);
                add(&mut stated, words)?;
                let only = stated.words.iter().all(|word| "XYZ".contains(word.letter));
                if !only || stated.words.is_empty() || !stated.spoken.is_empty() {
                    return refuse(line, "a pole of something else than coordinates");
                }
                self.pole = ['X', 'Y', 'Z']
                    .map(|letter| stated.words.iter().find(|w| w.letter == letter).copied());
            }
            ["STOP"] => {
                if block.comment.is_empty() {
                    block.comment = above;
                }
                block.words.push(Word { letter: 'M', value: 0.0, point: false });
            }
            ["TOOL", "CALL", axis, words @ ..] => {
                let Some(normal) = ["X", "Y", "Z"].iter().position(|name| name == axis) else {
                    return refuse(line, "another tool");
                };
                block.spoken.push(Spoken::Plane(normal));
                add(&mut block, words)?;
            }
            ["CYCL", "DEF", part, words @ ..] => self.cycle(&mut block, part, &words.concat())?,
            ["PLANE", "RESET", "STAY"] => block.spoken.push(Spoken::Dynamics(0)),
            [word, ..] if word.starts_with('M') => add(&mut block, tokens)?,
            [word, ..] => return refuse(line, format!("`{word}` is not known")),
        }
        if !block.is_empty() {
            self.blocks.push(block);
        }
        Ok(())
    }

    /// A block of a cycle: a dwell, or the way back to nothing.
    fn cycle(&mut self, block: &mut Block, part: &str, says: &str) -> Result<(), Refused> {
        let line = block.line;
        let numbers = part.split_once('.').map(|(cycle, part)| (cycle.parse(), part.parse()));
        let Some((Ok(cycle), Ok(part))) = numbers else { return refuse(line, "no cycle") };
        let due = self.cycle.take();
        if due.unwrap_or((cycle, 0)) != (cycle, part) {
            return refuse(line, "a cycle that is not complete");
        }
        let is = |name: &str, wanted: f64| {
            says.strip_prefix(name).and_then(|number| number.parse().ok()) == Some(wanted)
        };
        let (last, right) = match (cycle, part) {
            (7..=11, 0) => (false, true),
            (7, 1) => (false, is("X", 0.0)),
            (7, 2) => (false, is("Y", 0.0)),
            (7, 3) => (true, is("Z", 0.0)),
            (8, 1) => (true, says.is_empty()),
            (10, 1) => (true, is("ROT", 0.0)),
            (11, 1) => (true, is("SCL", 1.0)),
            (9, 1) => {
                let (value, point, behind) =
                    figures(says.strip_prefix("DWELL").unwrap_or(""), line)?;
                block.words.push(Word { letter: 'P', value, point });
                (true, behind.is_empty())
            }
            _ => return refuse(line, "a cycle that is not known"),
        };
        if !right {
            return refuse(line, "a cycle that moves the path");
        }
        if !last {
            self.cycle = Some((cycle, part + 1));
            return Ok(());
        }
        block.spoken.push(match cycle {
            7 => Spoken::NoShift,
            8 => Spoken::NoMirror,
            9 => Spoken::Dwell,
            10 => Spoken::NoRotation,
            _ => Spoken::NoScaling,
        });
        Ok(())
    }
}

fn sense(word: &str) -> Option<i8> {
    match word {
        "DR+" => Some(1),
        "DR-" => Some(-1),
        _ => None,
    }
}

/// Coordinates, feeds and functions of a block.
fn add(block: &mut Block, tokens: &[&str]) -> Result<(), Refused> {
    for token in tokens {
        match *token {
            "FMAX" => {}
            "R0" => block.spoken.push(Spoken::NoRadius),
            "M91" => block.spoken.push(Spoken::MachineCoordinates),
            "M129" => block.spoken.push(Spoken::NoTransformation),
            _ => {
                let letter = token.chars().next().unwrap_or(' ');
                let known = "XYZFSM".contains(letter);
                let (value, point, behind) = figures(token.get(1..).unwrap_or(""), block.line)?;
                if !known || !behind.is_empty() {
                    return refuse(block.line, format!("`{token}` is not known"));
                }
                block.words.push(Word { letter, value, point });
            }
        }
    }
    Ok(())
}
