//! Aligned samples as CSV: what was read, where the machine was, and what became of it.

use std::collections::BTreeMap;
use std::io::Write;

use crate::align::{Alignment, Part, Sample};
use crate::error::{Error, Kind, Result};
use crate::identify::{Apart, IdentifiedRun, Record};
use crate::report::text::numbers::fixed;

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
    let by_line: Option<BTreeMap<usize, &Record>> =
        before.map(|before| before.records.iter().map(|r| (r.sample.line, r)).collect());
    let earlier = |record: &Record| {
        by_line.as_ref().map_or_else(String::new, |known| {
            known.get(&record.sample.line).map_or_else(|| ",,".into(), |before| predicted(before))
        })
    };
    let lines = run.records.iter();
    let lines = lines.map(|r| aligned(&run.alignment, &r.sample) + &fitted(r) + &earlier(r));
    let head = if before.is_some() { BEFORE } else { "" };
    write_lines(out, &format!("{ALIGNED}{FITTED}{head}"), lines)
}

/// Writes every reading of a run that was aligned, without what a fit made of them.
pub fn write_aligned(out: &mut impl Write, run: &IdentifiedRun) -> Result<()> {
    let every = run.alignment.every_reading();
    let lines = every.iter().map(|sample| aligned(&run.alignment, sample));
    write_lines(out, ALIGNED, lines)
}

fn write_lines(
    out: &mut impl Write,
    head: &str,
    lines: impl Iterator<Item = String>,
) -> Result<()> {
    std::iter::once(head.to_owned()).chain(lines).try_for_each(|line| {
        writeln!(out, "{line}").map_err(|error| {
            Error::new(Kind::Output, format!("samples cannot be written: {error}"))
        })
    })
}

fn aligned(alignment: &Alignment, sample: &Sample) -> String {
    let (place, arc, angle) = match sample.part {
        Part::Arc(index) => {
            let section = &alignment.sections[index];
            let ball = sample.pose.position_mm - alignment.coincidence_mm();
            let angle_deg = section.circle.angle_rad(&ball).to_degrees();
            ("arc", quoted(&section.name), fixed(angle_deg, 5))
        }
        Part::Ramp => ("ramp", String::new(), String::new()),
        Part::Dwell => ("dwell", String::new(), String::new()),
        Part::Stop => ("stop", String::new(), String::new()),
    };
    let sigma = if sample.time_sigma_s.is_finite() {
        fixed(sample.time_sigma_s * 1e3, 4)
    } else {
        String::new()
    };
    let at = &sample.pose.position_mm;
    let ball = at - alignment.coincidence_mm();
    let sense = &sample.pose.sense;
    [
        sample.line.to_string(),
        fixed(sample.log_s, 6),
        fixed(sample.program_s, 6),
        sigma,
        place.to_owned(),
        arc,
        angle,
        fixed(at.x, 6),
        fixed(at.y, 6),
        fixed(at.z, 6),
        fixed(ball.x, 6),
        fixed(ball.y, 6),
        fixed(ball.z, 6),
        fixed(sense.x, 0),
        fixed(sense.y, 0),
        fixed(sense.z, 0),
        fixed(sample.deviation_mm * 1e3, 4),
    ]
    .join(",")
}

fn predicted(record: &Record) -> String {
    format!(",{},{}", fixed(record.computed_mm * 1e3, 4), fixed(record.residual_mm * 1e3, 4))
}

fn fitted(record: &Record) -> String {
    format!(
        "{},{},{},{},{},{}",
        predicted(record),
        fixed(record.weight, 4),
        u8::from(record.used()),
        u8::from(record.rejected()),
        record.whitened.map_or_else(String::new, |whitened| fixed(whitened, 3)),
        record.apart.map_or("", Apart::word)
    )
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
