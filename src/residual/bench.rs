//! Residuals of an equator that is driven there and back, with effects and noise put in, for tests.

use std::sync::OnceLock;

use nalgebra::Vector3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::column::Column;
use super::element::Element;
use super::residuals::{Repeat, Residuals, Run, Sample};
use crate::machine::{Machine, Mounting, Pose};
use crate::model::{Effect, Motion, Shape, Situation};
use crate::solve::{Basis, Matrix};

/// Radius of the equator, mm.
const BAR_MM: f64 = 150.0;
/// 500 mm/min.
const FEED_MM_S: f64 = 500.0 / 60.0;
/// Ten readings a second.
const PERIOD_S: f64 = 0.1;
/// An operator's pause between the two arcs, s.
const BETWEEN_S: f64 = 5.0;

/// White noise of this standard deviation, always the same for a seed.
pub(crate) fn white(seed: u64, sigma_mm: f64) -> impl FnMut() -> f64 {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    move || {
        let normal: f64 = StandardNormal.sample(&mut random);
        sigma_mm * normal
    }
}

/// An effect such as `cyclic:on=EXX,period_mm=10` that is the same in all runs.
pub(crate) fn element(term: &str) -> Element {
    Element::shared(Shape::parse(term).unwrap())
}

/// The element of an effect with its amplitudes, and the effect itself.
pub(crate) fn effect(text: &str) -> (Element, Effect) {
    let effect = Effect::parse(text).unwrap();
    (Element::shared(Shape::of(&effect).unwrap()), effect)
}

/// Residuals of so many repeats of one run each, whose model follows the set-up errors of the tool ball and the
/// scales of X and Y; `noise` is asked for every reading, arc after arc.
pub(crate) fn residuals(repeats: usize, mut noise: impl FnMut() -> f64) -> Residuals {
    let machine = Machine::read("machines/hu40t.toml".as_ref()).unwrap();
    let mounting = Mounting {
        coincidence_mm: Vector3::new(10.0, -20.0, 30.0),
        tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
    };
    let mut model_mm = Vec::new();
    let repeats: Vec<Repeat> = (0..repeats)
        .map(|repeat| {
            let samples: Vec<Sample> = [true, false]
                .into_iter()
                .enumerate()
                .flat_map(|(arc, forward)| samples(&machine, &mounting, 2 * repeat + arc, forward))
                .collect();
            let followed = |sample: &Sample| {
                let (u, h) = (&sample.situation.direction, &sample.situation.pose.position_mm);
                [u.x, u.y, u.z, u.x * h.x, u.y * h.y]
            };
            let basis = orthonormal(&samples.iter().map(followed).collect::<Vec<_>>());
            let raw: Vec<f64> = samples.iter().map(|_| noise()).collect();
            model_mm.push(basis.outside(&raw));
            let run = Run {
                name: format!("run{}", repeat + 1),
                samples: 0..samples.len(),
                program: 0,
                began_sigma_s: 0.0,
            };
            let factor = Matrix::zeros(5, basis.rank());
            Repeat { samples, basis, factor, deviations: vec![1.0; 5], runs: vec![run] }
        })
        .collect();
    let arcs = 2 * repeats.len();
    Residuals {
        repeats,
        model_mm: Column::from(model_mm),
        way_mm: [2.0 * BAR_MM, 2.0 * BAR_MM, 0.0],
        middle_mm: [0.0; 3],
        fastest_mm_s: [FEED_MM_S, FEED_MM_S, 0.0],
        arcs,
        held: true,
        taken_out: OnceLock::new(),
    }
}

/// The readings of one turn.
fn samples(machine: &Machine, mounting: &Mounting, arc: usize, forward: bool) -> Vec<Sample> {
    let turn_s = std::f64::consts::TAU * BAR_MM / FEED_MM_S;
    let sense = if forward { 1.0 } else { -1.0 };
    let began_s = if forward { 0.0 } else { turn_s + BETWEEN_S };
    let count = (turn_s / PERIOD_S) as usize;
    let at = |k: usize| {
        let time_s = (k as f64 + 0.5) * PERIOD_S;
        let (sin, cos) = (sense * time_s * FEED_MM_S / BAR_MM).sin_cos();
        let velocity_mm_s = sense * FEED_MM_S * Vector3::new(-sin, cos, 0.0);
        let pose = Pose {
            position_mm: mounting.coincidence_mm + BAR_MM * Vector3::new(cos, sin, 0.0),
            sense: velocity_mm_s.map(f64::signum),
        };
        let elapsed_s = began_s + time_s;
        let motion = Motion { velocity_mm_s, elapsed_s, program_s: elapsed_s, ..Motion::REST };
        let situation = Situation::new(machine, mounting, 0, &pose).unwrap();
        Sample {
            // A block a turn.
            blocks: (if forward { 0.0 } else { 1.0 }) + time_s / turn_s,
            run: 0,
            arc,
            section: usize::from(!forward),
            reading: k,
            log_s: elapsed_s,
            situation: Situation { motion, ..situation },
            left_mm: 0.0,
            root_weight: 1.0,
        }
    };
    (0..count).map(at).collect()
}

/// Rows of orthonormal columns that span these; what depends on others is dropped.
fn orthonormal(rows: &[[f64; 5]]) -> Basis {
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for k in 0..5 {
        let mut column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
        let whole: f64 = column.iter().map(|c| c * c).sum();
        for _ in 0..2 {
            for unit in &columns {
                let along: f64 = unit.iter().zip(&column).map(|(u, c)| u * c).sum();
                column.iter_mut().zip(unit).for_each(|(c, u)| *c -= along * u);
            }
        }
        let square: f64 = column.iter().map(|c| c * c).sum();
        if square > 1e-9 * whole && whole > 0.0 {
            columns.push(column.into_iter().map(|c| c / square.sqrt()).collect());
        }
    }
    let mut basis = Basis::with_room(columns.len(), rows.len());
    for k in 0..rows.len() {
        basis.push(&columns.iter().map(|column| column[k]).collect::<Vec<_>>());
    }
    basis
}
