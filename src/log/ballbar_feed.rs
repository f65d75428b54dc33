//! Whether the feed that a file of Ballbar 20 states can be the one that was driven.

use jiff::civil::DateTime;

use super::b5r::BallbarFile;

/// Feeds that differ by less than this share are the same: knobs and feed-ins make some percent.
const SAME_FEED: f64 = 0.05;
/// Moments are written in whole seconds, each cut off, s.
const CUT_OFF_S: f64 = 1.0;

/// What speaks against the programmed feed, each with what to do, for arcs of so many rad and readings at a rate that is stated.
pub(super) fn notes(found: &BallbarFile, arc_rad: f64, rate_hz: Option<f64>) -> Vec<String> {
    let Some(feed_mm_min) = found.feed_mm_min else { return Vec::new() };
    let mut notes = Vec::new();
    let path_mm = found.nominal_length_mm.map(|length_mm| arc_rad * length_mm);
    for (index, run) in found.runs.iter().enumerate() {
        let counted = path_mm
            .zip(rate_hz)
            .map(|(path_mm, hz)| 60.0 * path_mm * hz / run.readings.len() as f64);
        let computed = run.feature("AF_CALCULATED_FEEDRATE", "UT_FEEDRATE");
        let of = [
            (counted, "its readings over the arc at the rate of `sample_rate_hz` make it"),
            (computed, "Ballbar 20 computes it"),
        ];
        for (driven_mm_min, by) in of {
            let differs = |driven: &f64| (driven / feed_mm_min - 1.0).abs() > SAME_FEED;
            if let Some(driven) = driven_mm_min.filter(differs) {
                notes.push(format!(
                    "run {} went at {driven:.0} mm/min as {by}, and was programmed with {feed_mm_min:.0}: where the knob stood there, write `feed_override_percent = {:.0}` in the run; else the file is not of this program",
                    index + 1,
                    100.0 * driven / feed_mm_min
                ));
            }
        }
    }
    let moment = |written: &Option<String>| moment(written.as_deref()?);
    if let (Some(began), Some(ended), Some(path_mm)) =
        (moment(&found.started), moment(&found.completed), path_mm)
    {
        let lasted_s = ended.duration_since(began).as_secs_f64();
        let arcs_s = 60.0 * path_mm * found.runs.len() as f64 / feed_mm_min;
        if lasted_s >= 0.0 && lasted_s + CUT_OFF_S < (1.0 - SAME_FEED) * arcs_s {
            notes.push(format!(
                "the test lasted {lasted_s:.0} s as the file says, and its arcs alone take {arcs_s:.0} s at {feed_mm_min:.0} mm/min: is that the feed of the program, and is the arc one of {:.0} degrees (`data_arc_deg` under `[log]` in the test file)?",
                arc_rad.to_degrees()
            ));
        }
    }
    notes
}

/// A moment as Ballbar 20 writes it, `20251218-194332`.
fn moment(written: &str) -> Option<DateTime> {
    let written = written.trim();
    let part = |range: std::ops::Range<usize>| written.get(range)?.parse::<i16>().ok();
    let small = |range| part(range).and_then(|value| i8::try_from(value).ok());
    if written.len() != 15 || written.as_bytes().get(8) != Some(&b'-') {
        return None;
    }
    let [month, day, hour, minute, second] =
        [small(4..6)?, small(6..8)?, small(9..11)?, small(11..13)?, small(13..15)?];
    DateTime::new(part(0..4)?, month, day, hour, minute, second, 0).ok()
}

#[cfg(test)]
mod tests {
    use super::super::b5r::{BarRun, Feature};
    use super::*;
    use std::f64::consts::TAU;

    /// Two circles of 150 mm at 1000 mm/min: 56.5 s each.
    fn file(readings: usize, calculated: Option<f64>, completed: &str) -> BallbarFile {
        let features = calculated.map(|value| Feature {
            name: "AF_CALCULATED_FEEDRATE".into(),
            unit: "UT_FEEDRATE".into(),
            value,
        });
        let run = BarRun {
            readings: vec![Some(0.0); readings],
            features: features.into_iter().collect(),
            ..BarRun::default()
        };
        BallbarFile {
            feed_mm_min: Some(1000.0),
            nominal_length_mm: Some(150.0),
            started: Some("20251218-235930".into()),
            completed: Some(completed.into()),
            runs: vec![run.clone(), run],
            ..BallbarFile::default()
        }
    }

    #[test]
    fn a_feed_that_agrees_says_nothing_and_another_says_what_to_write() {
        let next_day = "20251219-000140";
        for (readings, calculated, completed, rate_hz, told) in [
            (1414, Some(998.0), next_day, Some(25.0), &[][..]),
            (1414, None, "", None, &[]),
            (1414, Some(800.0), next_day, None, &["`feed_override_percent = 80`", "run 2"]),
            (707, None, next_day, Some(25.0), &["went at 2000 mm/min", "`sample_rate_hz`"]),
            (1414, None, "20251219-000030", None, &["lasted 60 s", "take 113 s at 1000"]),
        ] {
            let notes = notes(&file(readings, calculated, completed), TAU, rate_hz).join("\n");
            assert_eq!(notes.is_empty(), told.is_empty(), "{notes}");
            assert!(told.iter().all(|part| notes.contains(part)), "{told:?}\n{notes}");
        }
    }

    #[test]
    fn what_is_no_moment_is_none() {
        for written in ["20251218-194332", " 20251218-000000 "] {
            assert!(moment(written).is_some(), "{written}");
        }
        for written in
            ["", "20251318-194332", "20251218 194332", "20251218-1943", "2025\u{e4}218-19433"]
        {
            assert!(moment(written).is_none(), "{written}");
        }
    }
}
