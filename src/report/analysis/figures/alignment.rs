//! How the log was laid over the program: the whole log as a strip, and both ends of the engagement.

use super::figure::Figure;
use crate::align::{Mark, MarkKind};
use crate::identify::{Identification, IdentifiedRun};
use crate::report::analysis::facts::{Analysis, BallBarFacts};
use crate::report::analysis::run_facts::RunResult;
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::{Anchor, Drawing, text_width, thinned};
use crate::report::draw::ticks::ticks;
use crate::report::text::numbers::fixed;

/// Width of the strip, pixels, and the room beside it.
const WIDTH: f64 = 980.0;
const SIDE: f64 = 24.0;
/// Where the strip begins and ends, pixels from above.
const TOP: f64 = 24.0;
const BOTTOM: f64 = 58.0;
/// So many samples are drawn at an end of the engagement.
const MOST_DOTS: usize = 300;

/// The pictures of one run.
#[derive(Debug)]
pub(in crate::report) struct RunPicture {
    /// The run, and of which mounting.
    pub(in crate::report) name: String,
    /// The whole log.
    pub(in crate::report) strip: String,
    /// The first engagement and the last release.
    pub(in crate::report) ends: Vec<Figure>,
}

/// The pictures of all runs, in order.
pub(in crate::report) fn runs(
    analysis: &Analysis,
    identifications: &[Identification],
) -> Vec<RunPicture> {
    let runs = identifications.iter().flat_map(|identification| &identification.runs);
    runs.zip(analysis.runs())
        .map(|(run, result)| RunPicture {
            name: analysis.in_mounting(&run.name, run.mounting),
            strip: strip(run, result),
            ends: ends(run, analysis),
        })
        .collect()
}

/// The log as a strip of time: arcs, pauses, marks.
fn strip(run: &IdentifiedRun, result: &RunResult) -> String {
    let alignment = &run.alignment;
    let map = &alignment.time_map;
    let (first_s, last_s) = match (run.records.first(), run.records.last()) {
        (Some(first), Some(last)) => (first.sample.log_s, last.sample.log_s),
        _ => (0.0, 1.0),
    };
    let margin_s = 0.015 * (last_s - first_s).max(1.0);
    let (low_s, high_s) = (first_s - margin_s, last_s + margin_s);
    let at = |log_s: f64| SIDE + (log_s - low_s) / (high_s - low_s) * (WIDTH - 2.0 * SIDE);
    let (top, bottom) = (TOP, BOTTOM);
    let mut drawing = Drawing::new(WIDTH, 96.0);
    drawing.rectangle((SIDE, top), WIDTH - 2.0 * SIDE, bottom - top, "field");
    sections(&mut drawing, run, &at);
    for (stop, pause) in result.pauses.iter().enumerate() {
        let Some(length_s) = pause.length_s.filter(|length| *length > 0.0) else { continue };
        let from = map.log_time_s(pause.program_s, stop);
        drawing.rectangle((at(from), top), at(from + length_s) - at(from), bottom - top, "pause");
    }
    marks(&mut drawing, run, &at);
    let axis = ticks(low_s, high_s, 12);
    for value in &axis.values {
        let x = at(*value);
        drawing.line((x, bottom), (x, bottom + 4.0), "tick-line");
        let label = fixed(*value, axis.decimals);
        drawing.text((x, bottom + 16.0), Anchor::Middle, "tick", &label);
    }
    drawing.text((0.5 * WIDTH, 93.0), Anchor::Middle, "axis", "time on the instrument's clock, s");
    drawing.finish(&format!("{}: the log over time", run.name))
}

/// The arcs that have a place on the log, each circle in its colour.
fn sections(drawing: &mut Drawing, run: &IdentifiedRun, at: &dyn Fn(f64) -> f64) {
    let map = &run.alignment.time_map;
    let mut circles: Vec<String> = Vec::new();
    for section in &run.alignment.sections {
        let leg = map.leg_of(0.5 * (section.start_s + section.end_s));
        if map.offset_sigmas_s.get(leg).is_none_or(|sigma| sigma.is_infinite()) {
            continue;
        }
        let (from, to) =
            (at(map.log_time_s(section.start_s, leg)), at(map.log_time_s(section.end_s, leg)));
        let name = section.circle.name();
        let index = circles.iter().position(|c| *c == name).unwrap_or_else(|| {
            circles.push(name.clone());
            circles.len() - 1
        });
        let class = if section.transit {
            "arc transit".to_owned()
        } else {
            let direction = if section.forward { "forward" } else { "backward" };
            format!("arc c{} {direction}", index % 8)
        };
        drawing.rectangle((from, TOP), to - from, BOTTOM - TOP, &class);
        if section.transit {
            continue;
        }
        let arrow = if section.forward { "→" } else { "←" };
        let short = name.replace("Meridian ", "M ");
        let last = name.rsplit(' ').next().unwrap_or("");
        let texts = [format!("{short} {arrow}"), format!("{last} {arrow}"), arrow.into()];
        if let Some(text) = texts.iter().find(|text| text_width(text) < to - from - 4.0) {
            drawing.text((0.5 * (from + to), 45.0), Anchor::Middle, "arc-name", text);
        }
    }
}

/// Where the bar engages and releases.
fn marks(drawing: &mut Drawing, run: &IdentifiedRun, at: &dyn Fn(f64) -> f64) {
    for mark in &run.alignment.marks {
        let x = at(mark.log_s);
        if matches!(mark.kind, MarkKind::Standstill | MarkKind::Angle) {
            continue;
        }
        let points = [(x - 5.0, TOP - 9.0), (x + 5.0, TOP - 9.0), (x, TOP - 1.0)];
        drawing.polygon(&points, "mark");
        let (anchor, name, by) = match mark.kind {
            MarkKind::Engagement => (Anchor::Start, "engages", 8.0),
            _ => (Anchor::End, "releases", -8.0),
        };
        drawing.text((x + by, TOP - 3.0), anchor, "tick", name);
    }
}

/// Reading and commanded ramp at the first engagement and at the last release.
fn ends(run: &IdentifiedRun, analysis: &Analysis) -> Vec<Figure> {
    let marks = &run.alignment.marks;
    let engagement = marks.iter().find(|mark| mark.kind == MarkKind::Engagement);
    let release = marks.iter().rev().find(|mark| mark.kind == MarkKind::Release);
    [engagement, release]
        .into_iter()
        .flatten()
        .map(|mark| Figure {
            svg: End::new(run, mark).drawn(&analysis.ball_bar),
            caption: String::new(),
            tall: false,
        })
        .collect()
}

/// One end of the engagement: where the bar begins to read, or ceases to.
struct End<'a> {
    run: &'a IdentifiedRun,
    mark: &'a Mark,
    /// The leg of the time map that the mark lies on.
    leg: usize,
    /// 1 where what is inside of the engagement comes after the mark, -1 where it comes before.
    inwards: f64,
}

impl<'a> End<'a> {
    fn new(run: &'a IdentifiedRun, mark: &'a Mark) -> Self {
        let leg = run.alignment.time_map.leg_of(mark.program_s);
        let inwards = if mark.kind == MarkKind::Engagement { 1.0 } else { -1.0 };
        Self { run, mark, leg, inwards }
    }

    fn title(&self) -> &'static str {
        if self.mark.kind == MarkKind::Engagement { "engagement" } else { "release" }
    }

    /// Commanded deviation from the nominal length at a moment of the log, mm.
    fn commanded_mm(&self, log_s: f64) -> f64 {
        let alignment = &self.run.alignment;
        let program_s = alignment.time_map.on_leg_s(log_s, self.leg);
        let position_mm = alignment.trajectory.at(program_s).position_mm;
        (position_mm - alignment.coincidence_mm()).norm() - self.run.nominal_mm
    }

    /// From the mark to where the ramp meets the sphere, s; a slow feed-in takes longer than a fast one.
    fn ramp_s(&self, range_mm: f64) -> f64 {
        let mut ramp_s = 0.0;
        while ramp_s < 30.0
            && self.commanded_mm(self.mark.log_s + self.inwards * ramp_s).abs() > 1e-2 * range_mm
        {
            ramp_s += 0.01;
        }
        ramp_s
    }

    /// The stretch of the log that is shown, s.
    fn stretch_s(&self, ramp_s: f64) -> (f64, f64) {
        let mark_s = self.mark.log_s;
        let reach_s = (3.0 * ramp_s).max(8.0 * self.run.alignment.sample_period_s).max(0.2);
        if self.inwards > 0.0 {
            (mark_s - 0.6 * reach_s, mark_s + reach_s)
        } else {
            (mark_s - reach_s, mark_s + 0.6 * reach_s)
        }
    }

    /// What stands in the picture.
    fn words(&self) -> [String; 3] {
        [
            self.title().to_owned(),
            match self.mark.samples {
                0 => "edge of the range only".to_owned(),
                1 => "1 sample on the ramp".to_owned(),
                n => format!("{n} samples on the ramp"),
            },
            format!("± {} ms", fixed(self.mark.sigma_s * 1e3, 2)),
        ]
    }

    fn drawn(&self, bar: &BallBarFacts) -> String {
        let (alignment, mark_s) = (&self.run.alignment, self.mark.log_s);
        let ramp_s = self.ramp_s(bar.range_mm);
        let (from, to) = self.stretch_s(ramp_s);
        let samples = self.run.records.iter().map(|record| &record.sample);
        let near: Vec<(f64, f64)> = samples
            .filter(|sample| (from..=to).contains(&sample.log_s))
            .map(|sample| (sample.log_s - mark_s, sample.deviation_mm * 1e3))
            .collect();
        // The reading settles at the machine's error there, not at zero; the ramp is shown through it.
        let settled: Vec<f64> = near
            .iter()
            .filter(|(time_s, _)| self.inwards * time_s > ramp_s + alignment.sample_period_s)
            .map(|(_, reading_um)| *reading_um)
            .collect();
        let offset_um = settled.iter().sum::<f64>() / settled.len().max(1) as f64;
        let limit_um = 1.2 * bar.range_mm * 1e3;
        let curve: Vec<(f64, f64)> = (0..=400)
            .map(|k| from + (to - from) * f64::from(k) / 400.0)
            .map(|log_s| (log_s - mark_s, self.commanded_mm(log_s) * 1e3 + offset_um))
            .filter(|(_, value_um)| value_um.abs() <= limit_um)
            .collect();
        // The sphere is at zero: words stand on the other side of it than the ramp.
        let outwards = curve.iter().map(|(_, value)| *value).sum::<f64>() >= 0.0;
        let (low, high) =
            if outwards { (-0.15 * limit_um, limit_um) } else { (-limit_um, 0.15 * limit_um) };
        let time = format!("time from the mark ({} s on the log), s", fixed(mark_s, 4));
        let mut chart = Chart::new(
            480.0,
            180.0,
            Axis::new(&time, (from - mark_s, to - mark_s)),
            Axis::new("reading, µm", (low, high)),
        );
        chart.upright(0.0, "mark-line");
        chart.line(&curve, "commanded");
        chart.dots(&thinned(&near, MOST_DOTS), "reading");
        // On the side where the bar reads nothing there is room for words.
        let (x, aside, anchor) = if self.inwards > 0.0 {
            (to - mark_s, -8.0, Anchor::End)
        } else {
            (from - mark_s, 8.0, Anchor::Start)
        };
        let (y, first) = if outwards { (high, 16.0) } else { (low, -38.0) };
        for (k, line) in self.words().iter().enumerate() {
            chart.note((x, y), (aside, first + 14.0 * k as f64), anchor, line);
        }
        chart.finish(&format!("{}: {}", self.run.name, self.title()))
    }
}
