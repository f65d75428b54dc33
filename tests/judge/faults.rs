//! One fault in a program, as a slip of a finger, a bad edit or a bad transfer makes it.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// What is done to a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    LostSign,
    GainedSign,
    LostPoint,
    MovedPoint,
    ChangedDigit,
    LostDigit,
    DoubledDigit,
    LostWord,
    WordOfAnother,
    ExchangedLetters,
    LostBlock,
    DoubledBlock,
    ExchangedBlocks,
    MovedBlock,
    RapidForFeed,
    FeedForRapid,
    OtherArc,
    WrongPlane,
    WrongUnit,
    WrongDistance,
    WrongOffset,
    LostModal,
    ChangedFeed,
}

impl Fault {
    pub(crate) const ALL: [Self; 23] = [
        Self::LostSign,
        Self::GainedSign,
        Self::LostPoint,
        Self::MovedPoint,
        Self::ChangedDigit,
        Self::LostDigit,
        Self::DoubledDigit,
        Self::LostWord,
        Self::WordOfAnother,
        Self::ExchangedLetters,
        Self::LostBlock,
        Self::DoubledBlock,
        Self::ExchangedBlocks,
        Self::MovedBlock,
        Self::RapidForFeed,
        Self::FeedForRapid,
        Self::OtherArc,
        Self::WrongPlane,
        Self::WrongUnit,
        Self::WrongDistance,
        Self::WrongOffset,
        Self::LostModal,
        Self::ChangedFeed,
    ];
}

/// A program with one fault in it, and the number of its line counted from 1; none where there is no place for it.
pub(crate) fn put(fault: Fault, text: &str, random: &mut Pcg64Mcg) -> Option<(String, usize)> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = line_of(&lines, fault, random)?;
    match fault {
        Fault::LostBlock => drop(lines.remove(at)),
        Fault::DoubledBlock => lines.insert(at, lines[at].clone()),
        Fault::ExchangedBlocks => {
            let next = (at + 1..lines.len() - 1).find(|&k| is_block(&lines[k]))?;
            lines.swap(at, next);
        }
        Fault::MovedBlock => {
            let line = lines.remove(at);
            let to = random.random_range(2..lines.len() - 1);
            lines.insert(to, line);
        }
        Fault::WordOfAnother => {
            let other = &lines[line_of(&lines, fault, random)?];
            let (start, end) = word(other, "XYZIJKR", random)?;
            let given = other[start..end].to_owned();
            let (start, end) = word(&lines[at], &given[..1], random)?;
            lines[at].replace_range(start..end, &given);
        }
        _ => {
            let changed = within(fault, &lines[at], random)?;
            lines[at] = changed;
        }
    }
    let changed = lines.join("\n") + "\n";
    (changed != text).then_some((changed, at + 1))
}

/// A line that has words, not only a comment.
fn is_block(line: &str) -> bool {
    !line.starts_with(['%', '(', 'O']) && !line.is_empty()
}

/// A line for a fault: every second one is no point of an arc, because there are few of those and more depends on them.
fn line_of(lines: &[String], fault: Fault, random: &mut Pcg64Mcg) -> Option<usize> {
    let has = |line: &str, words: &[&str]| words.iter().any(|word| line.contains(word));
    let fits = |line: &str| {
        is_block(line)
            && match fault {
                Fault::FeedForRapid => line.contains("G00"),
                Fault::RapidForFeed | Fault::OtherArc => has(line, &["G01", "G02", "G03"]),
                Fault::WrongPlane | Fault::WrongUnit | Fault::WrongDistance => {
                    has(line, &["G17", "G18", "G19", "G01", "G02", "G03"])
                }
                Fault::LostModal => has(line, &["G21", "G69", "G15", "G50", "G54", "G64", "G17"]),
                Fault::ChangedFeed => line.contains('F'),
                _ => true,
            }
    };
    let seldom = random.random_bool(0.5);
    let chosen: Vec<usize> = (0..lines.len())
        .filter(|&k| fits(&lines[k]) && (!seldom || !lines[k].starts_with('X')))
        .collect();
    (!chosen.is_empty()).then(|| chosen[random.random_range(0..chosen.len())])
}

/// The part of a line before its comment.
fn words_of(line: &str) -> &str {
    line.split('(').next().unwrap_or("")
}

/// Where a word with one of these letters stands in a line.
fn word(line: &str, letters: &str, random: &mut Pcg64Mcg) -> Option<(usize, usize)> {
    let words = words_of(line);
    let starts: Vec<usize> =
        words.match_indices(|c: char| letters.contains(c)).map(|(at, _)| at).collect();
    if starts.is_empty() {
        return None;
    }
    let start = starts[random.random_range(0..starts.len())];
    let rest = &words[start + 1..];
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(rest.len());
    Some((start, start + 1 + end))
}

const LENGTHS: &str = "XYZIJKR";
const ANY: &str = "GMNXYZIJKRFPQL";

/// The line with a fault in it.
fn within(fault: Fault, line: &str, random: &mut Pcg64Mcg) -> Option<String> {
    let mut changed = line.to_owned();
    let replaced = |from: &str, to: &str| line.contains(from).then(|| line.replacen(from, to, 1));
    match fault {
        Fault::LostSign | Fault::GainedSign => {
            let (start, _) = word(line, LENGTHS, random)?;
            let minus = line[start + 1..].starts_with('-');
            match (fault, minus) {
                (Fault::LostSign, true) => drop(changed.remove(start + 1)),
                (Fault::GainedSign, false) => changed.insert(start + 1, '-'),
                _ => return None,
            }
        }
        Fault::LostPoint | Fault::MovedPoint => {
            let (start, end) = word(line, "XYZIJKRFP", random)?;
            let point = start + line[start..end].find('.')?;
            changed.remove(point);
            if fault == Fault::MovedPoint {
                let to = random.random_range(start + 2..end);
                changed.insert(to, '.');
            }
        }
        Fault::ChangedDigit | Fault::LostDigit | Fault::DoubledDigit => {
            let (start, end) = word(line, ANY, random)?;
            let at = random.random_range(start + 1..end);
            let digit = line.as_bytes()[at];
            if !digit.is_ascii_digit() {
                return None;
            }
            match fault {
                Fault::LostDigit => drop(changed.remove(at)),
                Fault::DoubledDigit => changed.insert(at, char::from(digit)),
                _ => {
                    let other = random.random_range(0..10_u8).to_string();
                    changed.replace_range(at..=at, &other);
                }
            }
        }
        Fault::LostWord => {
            let (start, end) = word(line, ANY, random)?;
            changed.replace_range(start..end, "");
        }
        Fault::ExchangedLetters => {
            let (first, _) = word(line, LENGTHS, random)?;
            let (second, _) = word(line, LENGTHS, random)?;
            let (a, b) = (line[first..=first].to_owned(), line[second..=second].to_owned());
            changed.replace_range(first..=first, &b);
            changed.replace_range(second..=second, &a);
        }
        Fault::RapidForFeed => {
            changed = ["G01", "G02", "G03"].iter().find_map(|word| replaced(word, "G00"))?;
        }
        Fault::FeedForRapid => changed = replaced("G00", "G01")?,
        Fault::OtherArc => {
            changed = replaced("G02", "G03")
                .or_else(|| replaced("G03", "G02"))
                .or_else(|| replaced("G01", ["G02", "G03"][random.random_range(0..2)]))?;
        }
        Fault::WrongPlane => {
            let plane = ["G17", "G18", "G19"][random.random_range(0..3)];
            changed = ["G17", "G18", "G19"]
                .iter()
                .find_map(|word| replaced(word, plane))
                .or_else(|| replaced("G01", &format!("{plane} G01")))?;
        }
        Fault::WrongUnit => {
            changed = replaced("G21", "G20").or_else(|| replaced("G01", "G20 G01"))?;
        }
        Fault::WrongDistance => {
            changed = replaced("G90", "G91").or_else(|| replaced("G01", "G91 G01"))?;
        }
        Fault::WrongOffset => {
            let other = format!("G{}", random.random_range(54..60));
            let (start, end) = word(line, "G", random)?;
            let offset = (54..60).any(|number| line[start..end] == format!("G{number}"));
            if offset {
                changed.replace_range(start..end, &other);
            } else {
                changed.insert_str(start, &format!("{other} "));
            }
        }
        Fault::LostModal => {
            let (start, end) = word(line, "G", random)?;
            changed.replace_range(start..end, "");
        }
        Fault::ChangedFeed => {
            let (start, end) = word(line, "F", random)?;
            let feed = ["F5000.", "F50.", "F1.", "F0.", "F15000.", "F501."];
            changed.replace_range(start..end, feed[random.random_range(0..feed.len())]);
        }
        _ => return None,
    }
    Some(changed)
}
