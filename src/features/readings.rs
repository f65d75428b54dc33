//! The readings of a circular test, each with where the machine was while it was taken.

use super::scene::{Column, Scene};
use crate::align::Sample;
use crate::circular::{CircularTest, WayPath, Ways};
use crate::error::Result;
use crate::identify::Apart;
use crate::model::Situation;

/// A mean of readings across a reversal is seen at so many moments: each is a millisecond of 20.
const MOMENTS: u32 = 20;

/// The readings of one way.
struct Way {
    run: usize,
    angle_rad: Vec<f64>,
    read_mm: Vec<f64>,
    /// How far the program's own chords and rounding lie off the sphere there.
    commanded_mm: Vec<f64>,
    /// What the model does not explain of each.
    residual_mm: Vec<f64>,
    /// Where each was taken; where an axis turned round meanwhile, at several moments.
    seen: Vec<Vec<Situation>>,
}

/// The readings whose place is known. Where an axis turned round, that is a mean which reaches farther than what is not known of
/// its time: else nothing says which way the axis went.
pub(super) struct Readings {
    ways: Vec<Way>,
    on: Ways,
}

impl Readings {
    pub(super) fn of(scene: &Scene, test: &CircularTest) -> Self {
        let ways: Vec<Way> = test.ways.iter().map(|of| way(scene, &of.path)).collect();
        let on = Ways::of(ways.iter().map(|way| &way.angle_rad[..]), test.radius_mm);
        Self { ways, on }
    }

    /// What a feature adds to each reading, mm, way after way.
    pub(super) fn adds_mm(&self, column: &Column) -> Vec<f64> {
        let of_way = |way: &Way| -> Vec<f64> {
            let mean = |seen: &Vec<Situation>| {
                seen.iter().map(|at| column(at, way.run)).sum::<f64>() / seen.len().max(1) as f64
            };
            way.seen.iter().map(mean).collect()
        };
        self.ways.iter().flat_map(of_way).collect()
    }

    /// Readings, of all ways.
    pub(super) fn count(&self) -> usize {
        self.ways.iter().map(|way| way.read_mm.len()).sum()
    }

    /// How far the commanded places of all readings lie off the sphere, mm.
    pub(super) fn commanded_mm(&self) -> Vec<f64> {
        self.ways.iter().flat_map(|way| way.commanded_mm.iter().copied()).collect()
    }

    /// What the model does not explain of all readings, mm.
    pub(super) fn residual_mm(&self) -> Vec<f64> {
        self.ways.iter().flat_map(|way| way.residual_mm.iter().copied()).collect()
    }

    /// G(b), of one way G, with so many times what a feature adds taken off, mm.
    pub(super) fn deviation_without_mm(&self, adds_mm: &[f64], times: f64) -> Result<f64> {
        let read_mm = self.ways.iter().flat_map(|way| &way.read_mm);
        let without: Vec<f64> =
            read_mm.zip(adds_mm).map(|(read, add)| read - times * add).collect();
        self.deviation_mm(&without)
    }

    /// G(b), of one way G, if this had been read, mm.
    pub(super) fn deviation_mm(&self, read_mm: &[f64]) -> Result<f64> {
        self.on.deviation_mm(read_mm)
    }
}

fn way(scene: &Scene, path: &WayPath) -> Way {
    let run = &scene.identification.runs[path.run];
    let alignment = &run.alignment;
    let half_s = if alignment.averaged > 1 { 0.5 * alignment.sample_period_s } else { 0.0 };
    let mut way = Way {
        run: path.run,
        angle_rad: Vec::new(),
        read_mm: Vec::new(),
        commanded_mm: Vec::new(),
        residual_mm: Vec::new(),
        seen: Vec::new(),
    };
    let following = alignment.following(0.0);
    for ((number, angle_rad), read_mm) in
        path.records.iter().zip(&path.angle_rad).zip(&path.read_mm)
    {
        let record = &run.records[*number];
        let sample = &record.sample;
        let turns = record.apart == Some(Apart::Reversal);
        if turns && half_s < 3.0 * sample.time_sigma_s.max(f64::MIN_POSITIVE) {
            continue;
        }
        way.angle_rad.push(*angle_rad);
        way.read_mm.push(*read_mm);
        let ball_mm = sample.pose.position_mm - alignment.coincidence_mm();
        way.commanded_mm.push(ball_mm.norm() - run.nominal_mm);
        let during: Vec<Sample> = if turns {
            let share = |k: u32| (2.0 * f64::from(k) + 1.0) / f64::from(MOMENTS) - 1.0;
            (0..MOMENTS).map(|k| alignment.later(&following, sample, share(k) * half_s)).collect()
        } else {
            vec![*sample]
        };
        // The fit computed it for the middle alone, where each slide goes one way.
        let beyond_mm = |at: &Sample| {
            let ball_mm = at.pose.position_mm - alignment.coincidence_mm();
            scene.model.length_mm(scene.values, &at.pose, &at.motion, run.mounting) - ball_mm.norm()
        };
        let in_the_mean_mm = if turns {
            during.iter().map(beyond_mm).sum::<f64>() / during.len() as f64 - beyond_mm(sample)
        } else {
            0.0
        };
        way.residual_mm.push(record.residual_mm - in_the_mean_mm);
        let situation = |at: &Sample| scene.model.situation(&at.pose, &at.motion, run.mounting);
        way.seen.push(during.iter().map(situation).collect());
    }
    way
}
