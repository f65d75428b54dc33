//! What stands in a program of a Siemens control: letters, longer words, and values behind `=`.

use crate::words::{Block, Part, Refused, Spoken, Word, figures, refuse};

/// Words that are more than a letter and a number.
const SPOKEN: [(&str, Spoken); 9] = [
    ("SUPA", Spoken::MachineCoordinates),
    ("MCALL", Spoken::NoCycle),
    ("TRANS", Spoken::NoShift),
    ("TRAFOOF", Spoken::NoTransformation),
    ("COMPOF", Spoken::Dynamics(0)),
    ("FFWON", Spoken::Dynamics(1)),
    ("FFWOF", Spoken::Dynamics(1)),
    ("SOFT", Spoken::Dynamics(2)),
    ("BRISK", Spoken::Dynamics(2)),
];

/// The file is the program.
pub(crate) fn parts(text: &str) -> Result<Vec<Part>, Refused> {
    let mut blocks = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.starts_with("%_N_") {
            continue;
        }
        let block = block(line, index + 1)?;
        if !block.is_empty() {
            blocks.push(block);
        }
    }
    if blocks.is_empty() {
        return refuse(1, "no program");
    }
    Ok(vec![Part { number: None, blocks }])
}

fn block(text: &str, line: usize) -> Result<Block, Refused> {
    let mut block = Block::new(line);
    let (mut rest, comment) = text.split_once(';').unwrap_or((text, ""));
    comment.trim().clone_into(&mut block.comment);
    rest = rest.trim();
    let mut head = true;
    while !rest.is_empty() {
        let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        let name = name.to_ascii_uppercase();
        if let Some((_, spoken)) = SPOKEN.iter().find(|(known, _)| *known == name) {
            block.spoken.push(*spoken);
            (rest, head) = (after.trim_start(), false);
            continue;
        }
        let after = after.trim_start();
        let (given, after) = match after.strip_prefix('=') {
            Some(after) => (true, after.trim_start()),
            None => (false, after),
        };
        let (value, point, behind) = figures(after, line)?;
        let letter = match name.as_str() {
            "CR" if given => 'R',
            "R" | "O" | "CR" => return refuse(line, format!("{name} is no address here")),
            _ if name.len() == 1 => name.chars().next().unwrap_or(' '),
            _ => return refuse(line, format!("`{name}` is not known")),
        };
        match letter {
            'N' if head && !point && (0.0..=99_999_999.0).contains(&value) => {}
            'N' => return refuse(line, "a block number that is none, or not at the head"),
            'D' if !point && value == 0.0 => block.spoken.push(Spoken::NoLength),
            _ => block.words.push(Word { letter, value, point }),
        }
        (rest, head) = (behind.trim_start(), false);
    }
    Ok(block)
}
