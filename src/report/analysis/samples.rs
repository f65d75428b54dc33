//! Aligned samples as CSV: what was read, where the machine was, and what became of it.

use std::io::Write;

use rayon::prelude::*;

use crate::align::{Alignment, Part, Sample};
use crate::error::{Error, Kind, Result};
use crate::identify::{Apart, IdentifiedRun, Record};
use crate::report::text::numbers::push_fixed;

/// Columns of every sample.
const ALIGNED: &str = "log_line,log_time_s,program_time_s,time_sigma_ms,place,arc,angle_deg,\
x_mm,y_mm,z_mm,ball_x_mm,ball_y_mm,ball_z_mm,sense_x,sense_y,sense_z,deviation_um";
/// Columns that come with a fit.
const FITTED: &str = ",predicted_um,residual_um,weight,used,rejected,whitened,not_used_because";

/// Columns that come with what was found.
const BEFORE: &str = ",predicted_before_um,residual_before_um";

/// Writes the samples of an identified run, and what the model said of them `before` anything was found.
///
/// `x_mm y_mm z_mm` are machine coordinates, `ball_*_mm` the tool ball relative to the workpiece ball,
/// both as commanded; `angle_deg` is the angle on the sample's circle. A time that nothing tells has an
/// empty `time_sigma_ms`. `whitened` is what the readings before it do not foretell of a residual, in standard
/// deviations; a reading that took no part has none, and says why.
pub fn write_samples(
    out: &mut impl Write,
    run: &IdentifiedRun,
    before: Option<&IdentifiedRun>,
) -> Result<()> {
    let mut by_line: Option<Vec<&Record>> = before.map(|before| before.records.iter().collect());
    if let Some(by_line) = &mut by_line {
        by_line.sort_by_key(|record| record.sample.line);
    }
    let line = |text: &mut String, record: &Record| {
        aligned(text, &run.alignment, &record.sample);
        fitted(text, record);
        if let Some(by_line) = &by_line {
            match by_line.binary_search_by_key(&record.sample.line, |before| before.sample.line) {
                Ok(known) => predicted(text, by_line[known]),
                Err(_) => text.push_str(",,"),
            }
        }
    };
    let head = if before.is_some() { BEFORE } else { "" };
    write_lines(out, &format!("{ALIGNED}{FITTED}{head}"), &run.records, &line)
}

/// Writes every reading of a run that was aligned, without what a fit made of them.
pub fn write_aligned(out: &mut impl Write, run: &IdentifiedRun) -> Result<()> {
    let line = |text: &mut String, sample: &Sample| aligned(text, &run.alignment, sample);
    write_lines(out, ALIGNED, &run.alignment.every_reading(), &line)
}

/// So many lines are one piece of work.
const PIECE: usize = 2048;
/// And so many pieces are in memory at a time.
const PIECES: usize = 32;

fn write_lines<T: Sync>(
    out: &mut impl Write,
    head: &str,
    of: &[T],
    line: &(dyn Fn(&mut String, &T) + Sync),
) -> Result<()> {
    let text = |piece: &[T]| {
        let mut text = String::new();
        for of in piece {
            line(&mut text, of);
            text.push('\n');
        }
        text
    };
    let mut write = |text: &str| {
        out.write_all(text.as_bytes()).map_err(|error| {
            Error::new(Kind::Output, format!("samples cannot be written: {error}"))
        })
    };
    write(&format!("{head}\n"))?;
    for pieces in of.chunks(PIECES * PIECE) {
        let texts: Vec<String> = pieces.par_chunks(PIECE).map(text).collect();
        texts.iter().try_for_each(|text| write(text))?;
    }
    Ok(())
}

fn aligned(text: &mut String, alignment: &Alignment, sample: &Sample) {
    let ball = sample.pose.position_mm - alignment.coincidence_mm();
    text.push_str(&sample.line.to_string());
    number(text, sample.log_s, 6);
    number(text, sample.program_s, 6);
    if sample.time_sigma_s.is_finite() {
        number(text, sample.time_sigma_s * 1e3, 4);
    } else {
        text.push(',');
    }
    match sample.part {
        Part::Arc(index) => {
            let section = &alignment.sections[index];
            text.push_str(",arc,");
            text.push_str(&quoted(&section.name));
            number(text, section.circle.angle_rad(&ball).to_degrees(), 5);
        }
        Part::Ramp => text.push_str(",ramp,,"),
        Part::Dwell => text.push_str(",dwell,,"),
        Part::Stop => text.push_str(",stop,,"),
    }
    for mm in sample.pose.position_mm.iter().chain(ball.iter()) {
        number(text, *mm, 6);
    }
    for sense in &sample.pose.sense {
        number(text, *sense, 0);
    }
    number(text, sample.deviation_mm * 1e3, 4);
}

fn predicted(text: &mut String, record: &Record) {
    number(text, record.computed_mm * 1e3, 4);
    number(text, record.residual_mm * 1e3, 4);
}

fn fitted(text: &mut String, record: &Record) {
    predicted(text, record);
    number(text, record.weight, 4);
    for so in [record.used(), record.rejected()] {
        text.push_str(if so { ",1" } else { ",0" });
    }
    match record.whitened {
        Some(whitened) => number(text, whitened, 3),
        None => text.push(','),
    }
    text.push(',');
    text.push_str(record.apart.map_or("", Apart::word));
}

/// A further field.
fn number(text: &mut String, value: f64, decimals: usize) {
    text.push(',');
    push_fixed(text, value, decimals);
}

/// A field of CSV; the comments of a program may hold commas.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn every_sample_is_a_line_with_every_column() {
        let fixture = fixture::identified("hu40t-stops");
        let run = &fixture.identifications[0].runs[0];
        let mut bytes = Vec::new();
        write_samples(&mut bytes, run, None).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text.lines().count(), run.records.len() + 1);
        let columns = text.lines().next().unwrap().split(',').count();
        for line in text.lines() {
            assert_eq!(line.split(',').count(), columns, "{line}");
            for field in line.split(',') {
                let zero = field.starts_with("-0") && field[1..].parse() == Ok(0.0_f64);
                assert!(!zero, "{line}");
            }
        }
        let used =
            text.lines().filter(|line| line.contains(",1,0,") && line.ends_with(',')).count();
        assert_eq!(used, run.used().count());
        for why in ["ramp", "reversal", "pause"] {
            assert!(text.lines().any(|line| line.ends_with(&format!(",0,0,,{why}"))), "{why}");
        }
        for place in [",arc,", ",ramp,", ",stop,"] {
            assert!(text.contains(place), "{place}");
        }
    }

    #[test]
    fn alignment_alone_has_no_prediction() {
        let fixture = fixture::identified("hu40t-stops");
        let mut bytes = Vec::new();
        write_aligned(&mut bytes, &fixture.identifications[0].runs[0]).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text.lines().next().unwrap(), ALIGNED);
    }

    #[test]
    fn a_comma_in_a_comment_is_quoted() {
        assert_eq!(quoted("ARC 1"), "ARC 1");
        assert_eq!(quoted("ARC 1, UP"), "\"ARC 1, UP\"");
    }
}
