//! One fault in a program, as a slip of a finger, a bad edit or a bad transfer makes it.

use ballbar::machine::Dialect;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::tongue::{Tongue, exchanged};

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

/// A program with one fault in it, and the number of its line counted from 1; none where there is no place for it. Klartext
/// is numbered anew, as the editor of a TNC does.
pub(crate) fn put(
    fault: Fault,
    text: &str,
    dialect: Dialect,
    random: &mut Pcg64Mcg,
) -> Option<(String, usize)> {
    let tongue = Tongue::of(dialect);
    let mut lines: Vec<String> = text.lines().map(|line| tongue.bare(line)).collect();
    let at = line_of(&lines, fault, tongue, random)?;
    match fault {
        Fault::LostBlock => drop(lines.remove(at)),
        Fault::DoubledBlock => lines.insert(at, lines[at].clone()),
        Fault::ExchangedBlocks => {
            let next = (at + 1..lines.len() - 1).find(|&k| tongue.is_block(&lines[k]))?;
            lines.swap(at, next);
        }
        Fault::MovedBlock => {
            let line = lines.remove(at);
            let to = random.random_range(2..lines.len() - 1);
            lines.insert(to, line);
        }
        Fault::WordOfAnother => {
            let other = &lines[line_of(&lines, fault, tongue, random)?];
            let (start, end) = word(other, LENGTHS, tongue, random)?;
            let given = other[start..end].to_owned();
            let (start, end) = word(&lines[at], &given[..1], tongue, random)?;
            lines[at].replace_range(start..end, &given);
        }
        Fault::LostModal => {
            let word = Tongue::one_of(&tongue.modal(&lines[at]), random)?;
            lost(&mut lines, at, word);
        }
        _ => {
            let changed = within(fault, &lines[at], tongue, random)?;
            lines[at] = changed;
        }
    }
    let changed = tongue.text(&lines);
    (changed != text).then_some((changed, at + 1))
}

/// Takes a modal word out: of a line, all blocks of a cycle, or everywhere where every block says it.
fn lost(lines: &mut Vec<String>, at: usize, word: &str) {
    if word.starts_with("CYCL") {
        lines.retain(|line| !line.starts_with(&format!("{word}.")));
    } else if word == "R0" {
        for line in lines.iter_mut() {
            *line = line.replacen(" R0", "", 1);
        }
    } else if let Some(without) = exchanged(&lines[at], word, "") {
        lines[at] = without;
    }
}

/// A line for a fault: every second one is no point of an arc, because there are few of those and more depends on them.
fn line_of(
    lines: &[String],
    fault: Fault,
    tongue: &Tongue,
    random: &mut Pcg64Mcg,
) -> Option<usize> {
    let has = |line: &str, words: &[&str]| words.iter().any(|w| exchanged(line, w, "").is_some());
    let fits = |line: &str| match fault {
        Fault::WrongUnit if tongue.klartext => line.starts_with("BEGIN"),
        Fault::WrongPlane if tongue.klartext => has(line, &tongue.planes),
        _ if !tongue.is_block(line) => false,
        Fault::FeedForRapid => tongue.is_rapid(line),
        Fault::RapidForFeed | Fault::OtherArc => tongue.is_feed(line),
        Fault::WrongPlane | Fault::WrongUnit | Fault::WrongDistance => {
            tongue.is_feed(line) || has(line, &tongue.planes)
        }
        Fault::LostModal => !tongue.modal(line).is_empty(),
        Fault::ChangedFeed => !places(line, "F", tongue).is_empty(),
        _ => true,
    };
    let seldom = random.random_bool(0.5);
    let chosen: Vec<usize> = (0..lines.len())
        .filter(|&k| fits(&lines[k]) && (!seldom || !tongue.is_chord(&lines[k])))
        .collect();
    (!chosen.is_empty()).then(|| chosen[random.random_range(0..chosen.len())])
}

/// Where words with one of these letters and a number stand in a line, before its comment.
fn places(line: &str, letters: &str, tongue: &Tongue) -> Vec<(usize, usize)> {
    let words = line.split(tongue.comment).next().unwrap_or("");
    let of_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let starts = words.match_indices(|c: char| letters.contains(c)).map(|(at, _)| at);
    starts
        .filter_map(|start| {
            let alone = !words[..start].ends_with(|c: char| c.is_ascii_alphabetic());
            let rest = &words[start + 1..];
            let width = rest.find(|c: char| !of_number(c)).unwrap_or(rest.len());
            (alone && width > 0).then_some((start, start + 1 + width))
        })
        .collect()
}

/// One of them.
fn word(
    line: &str,
    letters: &str,
    tongue: &Tongue,
    random: &mut Pcg64Mcg,
) -> Option<(usize, usize)> {
    let places = places(line, letters, tongue);
    (!places.is_empty()).then(|| places[random.random_range(0..places.len())])
}

const LENGTHS: &str = "XYZIJKR";
const ANY: &str = "GMNXYZIJKRFPQL";

/// The line with a fault in it.
fn within(fault: Fault, line: &str, tongue: &Tongue, random: &mut Pcg64Mcg) -> Option<String> {
    let mut changed = line.to_owned();
    match fault {
        Fault::LostSign | Fault::GainedSign => {
            let (start, _) = word(line, LENGTHS, tongue, random)?;
            let sign = line[start + 1..].chars().next();
            match (fault, sign) {
                (Fault::LostSign, Some('-')) => drop(changed.remove(start + 1)),
                (Fault::GainedSign, Some('+')) => changed.replace_range(start + 1..start + 2, "-"),
                (Fault::GainedSign, Some('0'..='9')) => changed.insert(start + 1, '-'),
                _ => return None,
            }
        }
        Fault::LostPoint | Fault::MovedPoint => {
            let (start, end) = word(line, "XYZIJKRFP", tongue, random)?;
            let point = start + line[start..end].find('.')?;
            changed.remove(point);
            if fault == Fault::MovedPoint {
                let to = random.random_range(start + 2..end);
                changed.insert(to, '.');
            }
        }
        Fault::ChangedDigit | Fault::LostDigit | Fault::DoubledDigit => {
            let (start, end) = word(line, ANY, tongue, random)?;
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
            let (start, end) = word(line, ANY, tongue, random)?;
            changed.replace_range(start..end, "");
        }
        Fault::ExchangedLetters => {
            let (first, _) = word(line, LENGTHS, tongue, random)?;
            let (second, _) = word(line, LENGTHS, tongue, random)?;
            let (a, b) = (line[first..=first].to_owned(), line[second..=second].to_owned());
            changed.replace_range(first..=first, &b);
            changed.replace_range(second..=second, &a);
        }
        Fault::ChangedFeed => {
            let (start, end) = word(line, "F", tongue, random)?;
            let feed = ["F5000.", "F50.", "F1.", "F0.", "F15000.", "F501."];
            changed.replace_range(start..end, feed[random.random_range(0..feed.len())]);
        }
        _ if tongue.klartext => return in_klartext(fault, line, tongue, random),
        _ => return in_words(fault, line, tongue, random),
    }
    Some(changed)
}

/// Another function where functions are words of a letter and a number.
fn in_words(fault: Fault, line: &str, tongue: &Tongue, random: &mut Pcg64Mcg) -> Option<String> {
    let Tongue { rapid, line: straight, arcs: [cw, ccw], planes, units: [metric, inch], .. } =
        tongue;
    let exchange = |from: &str, to: &str| exchanged(line, from, to);
    let before = |word: &str| exchange(straight, &format!("{word} {straight}"));
    match fault {
        Fault::RapidForFeed => [straight, cw, ccw].iter().find_map(|word| exchange(word, rapid)),
        Fault::FeedForRapid => exchange(rapid, straight),
        Fault::OtherArc => exchange(cw, ccw)
            .or_else(|| exchange(ccw, cw))
            .or_else(|| exchange(straight, Tongue::one_of(&[cw, ccw], random)?)),
        Fault::WrongPlane => {
            let plane = Tongue::one_of(planes, random)?;
            planes.iter().find_map(|word| exchange(word, plane)).or_else(|| before(plane))
        }
        Fault::WrongUnit => exchange(metric, inch).or_else(|| before(inch)),
        Fault::WrongDistance => exchange("G90", "G91").or_else(|| before("G91")),
        Fault::WrongOffset => {
            let other = format!("G{}", random.random_range(54..60));
            let (start, end) = word(line, "G", tongue, random)?;
            let offset = (54..60).any(|number| line[start..end] == format!("G{number}"));
            let mut changed = line.to_owned();
            if offset {
                changed.replace_range(start..end, &other);
            } else {
                changed.insert_str(start, &format!("{other} "));
            }
            Some(changed)
        }
        _ => None,
    }
}

/// The same in Klartext, which has no work offsets.
fn in_klartext(fault: Fault, line: &str, tongue: &Tongue, random: &mut Pcg64Mcg) -> Option<String> {
    let Tongue { rapid, line: straight, arcs: [cw, ccw], planes, units: [metric, inch], .. } =
        tongue;
    let exchange = |from: &str, to: &str| exchanged(line, from, to);
    match fault {
        Fault::RapidForFeed => Some(format!("{line} {rapid}")),
        Fault::FeedForRapid => exchange(rapid, Tongue::one_of(&["", "F500"], random)?),
        Fault::OtherArc => exchange(cw, ccw).or_else(|| exchange(ccw, cw)).or_else(|| {
            let sense = Tongue::one_of(&[cw, ccw], random)?;
            exchange(straight, "C").map(|arc| format!("{arc} {sense}"))
        }),
        Fault::WrongPlane => {
            let plane = Tongue::one_of(planes, random)?;
            planes.iter().find_map(|word| exchange(word, plane))
        }
        Fault::WrongUnit => exchange(metric, inch),
        Fault::WrongDistance => {
            let (start, _) = word(line, "XYZ", tongue, random)?;
            Some(format!("{}I{}", &line[..start], &line[start..]))
        }
        _ => None,
    }
}
