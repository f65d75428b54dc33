//! The circular tests that runs hold: which ways belong together, and their values.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::draw;
use super::found::{Found, Way, WayPath};
use super::passes::{Filter, Pass};
use super::thresholds::{DRAWS, SAME_FEED, SAME_SPAN_RAD};
use super::values::{OF_BOTH, OF_WAY, Ways, row};
use crate::align::Circle;
use crate::error::Result;
use crate::identify::{Identification, Record};
use crate::solve::{Spectrum, Tsqr};

/// A circular test: an arc that was driven both ways, or one way of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CircularTest {
    /// Index of the mounting.
    pub mounting: usize,
    /// The circle.
    pub circle: Circle,
    /// Nominal radius, mm.
    pub radius_mm: f64,
    /// Its feed, mm/s.
    pub feed_mm_s: f64,
    /// Angle of the data arc, rad.
    pub sweep_rad: f64,
    /// Whether it goes round, with readings all the way.
    pub whole: bool,
    /// Condition number of centre and radius: 1 of a whole circle.
    pub centre_condition: f64,
    /// What was done to the readings.
    pub filter: Filter,
    /// The ways: one, or forward and back.
    pub ways: Vec<Way>,
    /// Of both ways: G(b) by minimum zone, and the range about the least-squares circle.
    pub bidirectional: Option<[Found; 2]>,
    /// D; `None` on a part of a circle, and of one way.
    pub mean_radial: Option<Found>,
    /// H; `None` of one way.
    pub hysteresis: Option<Found>,
}

impl CircularTest {
    /// G(b) of both ways, of one way G, as it was read.
    pub fn deviation(&self) -> Option<Found> {
        let of_way = || self.ways.first().map(|way| way.circular);
        self.bidirectional.map(|[zone, _]| zone).or_else(of_way)
    }
}

/// An arc without values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Untold {
    /// Which one.
    pub arc: String,
    /// Why, as the end of a sentence about it.
    pub why: String,
}

/// The circular tests of runs that were identified together.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// In the order in which they were driven.
    pub tests: Vec<CircularTest>,
    /// Arcs that have no values or no way back.
    pub untold: Vec<Untold>,
}

/// The circular tests of runs that were identified together.
///
/// # Errors
/// When readings cannot be fitted: numbers that are not finite.
pub fn of(identification: &Identification) -> Result<Driven> {
    let mut passes: Vec<Pass> = Vec::new();
    let mut untold = Vec::new();
    for (number, run) in identification.runs.iter().enumerate() {
        let mut on: Vec<Vec<(usize, &Record)>> = vec![Vec::new(); run.alignment.sections.len()];
        for (number, record) in run.records.iter().enumerate() {
            if let Some(on) = record.section().and_then(|section| on.get_mut(section)) {
                on.push((number, record));
            }
        }
        for (index, section) in run.alignment.sections.iter().enumerate() {
            if section.transit {
                continue;
            }
            match Pass::of((number, run), index, &on[index]) {
                Ok(pass) => passes.push(pass),
                Err(why) => untold.push(Untold {
                    arc: format!("{} of {}", section.name, run.name),
                    why: why.to_owned(),
                }),
            }
        }
    }
    let mut driven = Vec::new();
    let mut taken = vec![false; passes.len()];
    for index in 0..passes.len() {
        if taken[index] {
            continue;
        }
        let pass = &passes[index];
        let free = || (index + 1..passes.len()).filter(|other| !taken[*other]);
        let back = free().find(|other| is_back(pass, &passes[*other], true));
        if let Some(other) = back {
            taken[other] = true;
        } else {
            let slower = (0..passes.len()).find(|other| is_back(pass, &passes[*other], false));
            let why = match slower.map(|other| &passes[other]) {
                Some(other) if (other.feed_mm_s / pass.feed_mm_s - 1.0).abs() > SAME_FEED => {
                    format!(
                        "was driven the other way at {:.0} instead of {:.0} mm/min only: G(b), D and H need one feed",
                        other.feed_mm_s * 60.0,
                        pass.feed_mm_s * 60.0
                    )
                }
                _ => "was not driven the other way: no G(b), D and H".to_owned(),
            };
            untold.push(Untold { arc: pass.words(), why });
        }
        let mut ways = vec![pass];
        ways.extend(back.map(|other| &passes[other]));
        ways.sort_by_key(|way| !way.forward);
        driven.push(ways);
    }
    let tests: Result<_> = driven.par_iter().map(|ways| test(ways, identification)).collect();
    Ok(Driven { tests: tests?, untold })
}

/// Whether a way is the way back over another one, with or without the same feed.
fn is_back(one: &Pass, other: &Pass, same_feed: bool) -> bool {
    let turned = (one.middle_rad - other.middle_rad + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
    let whole = one.is_whole() && other.is_whole();
    let same_span = (one.sweep_rad - other.sweep_rad).abs() < SAME_SPAN_RAD
        && (whole || turned.abs() < SAME_SPAN_RAD);
    one.forward != other.forward
        && one.mounting == other.mounting
        && one.circle.is_same(&other.circle)
        && (one.nominal_mm - other.nominal_mm).abs() < 1e-6
        && same_span
        && (!same_feed || (other.feed_mm_s / one.feed_mm_s - 1.0).abs() <= SAME_FEED)
}

fn test(ways: &[&Pass], identification: &Identification) -> Result<CircularTest> {
    let first = ways[0];
    let whole = ways.iter().all(|way| way.is_whole());
    let found = found(ways, identification)?;
    let way = |(way, found): (&&Pass, &[Found])| Way {
        run: way.run.clone(),
        arc: way.name.clone(),
        direction: way.direction,
        start_rad: way.start_rad,
        points: way.read_mm.len(),
        rejected: way.rejected,
        gap_rad: way.gap_rad,
        circular: found[0],
        circular_by_squares: found[1],
        radial: whole.then(|| [found[2], found[3]]),
        path: WayPath {
            run: way.run_index,
            records: way.records.clone(),
            angle_rad: way.angle_rad.clone(),
            read_mm: way.read_mm.clone(),
        },
    };
    let of_both = found.get(2 * OF_WAY..).filter(|both| both.len() == OF_BOTH);
    Ok(CircularTest {
        mounting: first.mounting,
        circle: first.circle,
        radius_mm: first.nominal_mm,
        feed_mm_s: first.feed_mm_s,
        sweep_rad: first.sweep_rad,
        whole,
        centre_condition: condition(ways)?,
        filter: first.filter,
        ways: ways.iter().zip(found.chunks(OF_WAY)).map(way).collect(),
        bidirectional: of_both.map(|both| [both[0], both[1]]),
        mean_radial: of_both.filter(|_| whole).map(|both| both[2]),
        hysteresis: of_both.map(|both| both[3]),
    })
}

/// The values as they were read, with what noise does to them where the fit has the path.
fn found(ways: &[&Pass], identification: &Identification) -> Result<Vec<Found>> {
    let on = Ways::of(ways.iter().map(|way| &way.angle_rad[..]), ways[0].nominal_mm);
    let read_mm: Vec<f64> = ways.iter().flat_map(|way| &way.read_mm).copied().collect();
    let computed_mm: Vec<f64> = ways.iter().flat_map(|way| &way.computed_mm).copied().collect();
    let (values, quiet) = (on.values_mm(&read_mm)?, on.values_mm(&computed_mm)?);
    let mut sums = vec![[0.0; 2]; values.len()];
    for number in 0..DRAWS {
        let noise_mm = (0..).zip(ways).flat_map(|(way, pass)| {
            draw::noise_mm(&identification.noise, pass.computed_mm.len(), 2 * number + way)
        });
        let noisy: Vec<f64> = computed_mm.iter().zip(noise_mm).map(|(mm, e)| mm + e).collect();
        for ((sum, noisy), quiet) in sums.iter_mut().zip(on.values_mm(&noisy)?).zip(&quiet) {
            sum[0] += noisy - quiet;
            sum[1] += (noisy - quiet).powi(2);
        }
    }
    let found = |(value_mm, [sum, squares]): (f64, [f64; 2])| {
        let widened_mm = sum / DRAWS as f64;
        let left = squares - sum * widened_mm;
        Found { value_mm, noise_mm: (left.max(0.0) / (DRAWS - 1) as f64).sqrt(), widened_mm }
    };
    Ok(values.into_iter().zip(sums).map(found).collect())
}

fn condition(ways: &[&Pass]) -> Result<f64> {
    let mut rows = Tsqr::new(3);
    for angle in ways.iter().flat_map(|way| &way.angle_rad) {
        rows.push(&row(*angle), 0.0);
    }
    Ok(Spectrum::of(&rows.finish()?)?.condition())
}
