//! The minimum zone held against a linear program, against its own proof, and against shapes that are known.
#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use ballbar::solve::minimax;
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Row = [f64; 3];

fn row(angle_rad: f64) -> Row {
    [1.0, angle_rad.cos(), angle_rad.sin()]
}

/// A circle as a bar reads it: rows, and readings in mm.
struct Circle {
    rows: Vec<Row>,
    read_mm: Vec<f64>,
    kind: usize,
}

/// Whole circles and arcs, both ways with the same angles, rounded readings, perfect ellipses, single spikes.
fn circle(trial: u64) -> Circle {
    let mut rng = Pcg64Mcg::seed_from_u64(trial);
    let kind = trial as usize % 5;
    let count = (3.0 * (5000.0_f64 / 3.0).powf(rng.random::<f64>())).round() as usize;
    let from_rad = TAU * rng.random::<f64>();
    let span_rad = if kind == 1 { 0.5 + 3.3 * rng.random::<f64>() } else { TAU };
    let centre_mm = [0.1, 0.1].map(|most: f64| most * (2.0 * rng.random::<f64>() - 1.0));
    let lobes: Vec<[f64; 2]> =
        (2..7).map(|_| [0.005, TAU].map(|m| m * rng.random::<f64>())).collect();
    let mut circle = Circle { rows: Vec::new(), read_mm: Vec::new(), kind };
    for k in 0..count {
        let way = if kind == 2 { k % (count / 2 + 1) } else { k };
        let angle_rad = from_rad + span_rad * way as f64 / count as f64;
        let form_mm: f64 = (2..)
            .zip(&lobes)
            .map(|(k, [a, phase])| a * (f64::from(k) * angle_rad + phase).cos())
            .sum();
        let noise_mm = if kind == 3 { 0.0 } else { 5e-4 * (rng.random::<f64>() - 0.5) };
        let spike_mm = if kind == 4 && k == count / 3 { 0.05 } else { 0.0 };
        let mut read_mm = form_mm + noise_mm + spike_mm;
        if kind == 0 {
            read_mm = (read_mm * 1e4).round() * 1e-4;
        }
        circle.rows.push(row(angle_rad));
        circle
            .read_mm
            .push(read_mm + centre_mm[0] * angle_rad.cos() + centre_mm[1] * angle_rad.sin());
    }
    circle
}

/// The program holds its constraints to 1e-8; so many times finer by larger numbers.
const FINER: f64 = 1e3;

/// Half of the zone by the dual linear program, nm.
fn by_linear_program(of: &Circle, about: &Row) -> f64 {
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let mut sums: [Vec<(microlp::Variable, f64)>; 4] = Default::default();
    for (row, read_mm) in of.rows.iter().zip(&of.read_mm) {
        let centre_mm: f64 = row.iter().zip(about).map(|(a, x)| a * x).sum();
        for sign in [1.0, -1.0] {
            let weight = problem.add_var(sign * (read_mm - centre_mm) * 1e6, (0.0, f64::INFINITY));
            sums[3].push((weight, FINER));
            for (sum, a) in sums.iter_mut().zip(row) {
                sum.push((weight, FINER * sign * a));
            }
        }
    }
    for (sum, is) in sums.iter().zip([0.0, 0.0, 0.0, FINER]) {
        problem.add_constraint(sum, ComparisonOp::Eq, is);
    }
    let SolveOutcome::Solution(solution) = problem.solve().unwrap() else { unreachable!() };
    solution.objective()
}

#[test]
fn a_thousand_circles_as_the_linear_program_has_them() {
    for trial in 0..1000 {
        let circle = circle(trial);
        let fit = minimax(&circle.rows, &circle.read_mm).unwrap();
        let half_mm = by_linear_program(&circle, &fit.least_squares) * 1e-6;
        let off_mm = (fit.deviation - half_mm).abs();
        let (kind, count) = (circle.kind, circle.rows.len());
        assert!(off_mm < 1e-9, "{trial}, kind {kind}, {count} points: {} {half_mm}", fit.deviation);
    }
}

/// Weights that balance and level: no centre and no radius can leave less than they prove.
#[test]
fn each_fit_brings_the_proof_that_none_is_better() {
    for trial in 0..1000 {
        let circle = circle(trial);
        let fit = minimax(&circle.rows, &circle.read_mm).unwrap();
        let weights = || fit.reference.iter();
        let sum =
            |of: &dyn Fn(usize) -> f64| -> f64 { weights().map(|(row, w)| w * of(*row)).sum() };
        if circle.rows.len() > 3 {
            let all: f64 = weights().map(|(_, w)| w.abs()).sum();
            assert!((all - 1.0).abs() < 1e-12, "{trial}: {all}");
            for column in 0..3 {
                assert!(sum(&|row| circle.rows[row][column]).abs() < 1e-11, "{trial}");
            }
            assert!((sum(&|row| circle.read_mm[row]) - fit.bound).abs() < 1e-12, "{trial}");
        }
        let left = |(row, read_mm): (&Row, &f64)| -> f64 {
            read_mm - row.iter().zip(&fit.coefficients).map(|(a, x)| a * x).sum::<f64>()
        };
        let largest =
            circle.rows.iter().zip(&circle.read_mm).map(|of| left(of).abs()).fold(0.0, f64::max);
        assert!((largest - fit.deviation).abs() < 1e-13, "{trial}: {largest} {}", fit.deviation);
        assert!(fit.deviation - fit.bound < 1e-13, "{trial}: {} {}", fit.deviation, fit.bound);
    }
}

#[test]
fn known_shapes() {
    let angles: Vec<f64> = (0..720).map(|k| TAU * f64::from(k) / 720.0).collect();
    let rows: Vec<Row> = angles.iter().map(|angle| row(*angle)).collect();
    let zone = |form: &dyn Fn(f64) -> f64| {
        let read: Vec<f64> = angles.iter().map(|angle| form(*angle)).collect();
        2.0 * minimax(&rows, &read).unwrap().deviation
    };
    // A circle that is larger and beside; an ellipse; a triangle between whose points the extremes lie.
    assert!(zone(&|a| 3.0 + 0.2 * a.cos() - 0.4 * a.sin()) < 1e-14);
    assert!((zone(&|a| 0.01 * (2.0 * a).sin()) - 0.02).abs() < 1e-14);
    assert!((zone(&|a| 0.01 * (3.0 * a + 0.3).cos()) - 0.02).abs() < 2e-6);
}

/// Rows that leave a column without a meaning, fewer rows than columns, equal rows, nothing at all.
#[test]
fn what_is_degenerate_has_a_fit_too() {
    let two = minimax(&[row(0.0), row(1.0)], &[3.0, 4.0]).unwrap();
    assert!(two.deviation < 1e-14);
    // All at one angle: only the sum of radius and centre is there, and half of the range is left.
    let same = minimax(&[row(0.3); 5], &[1.0, 2.0, 5.0, 4.0, 3.0]).unwrap();
    assert!((same.deviation - 2.0).abs() < 1e-14 && (same.bound - 2.0).abs() < 1e-14);
    // Two angles, each with two values.
    let pairs = minimax(&[row(0.0), row(0.0), row(2.0), row(2.0)], &[0.0, 1.0, 0.0, 3.0]).unwrap();
    assert!((pairs.deviation - 1.5).abs() < 1e-14);
    let flat = minimax(&[[1.0, 0.0, 0.0]; 4], &[1.0; 4]).unwrap();
    assert!(flat.deviation < 1e-15 && (flat.coefficients[0] - 1.0).abs() < 1e-15);
    let large = [1e300, -1e300, 1e300, 0.0].map(|y| y * 1e-150);
    assert!(
        minimax(&[row(0.0), row(1.0), row(2.0), row(3.0)], &large).unwrap().deviation.is_finite()
    );
    assert!(minimax::<3>(&[], &[]).is_err());
    assert!(minimax(&[row(0.0)], &[f64::NAN]).is_err());
    assert!(minimax(&[row(0.0)], &[1.0, 2.0]).is_err());
}

/// A sphere has its centre in three directions.
#[test]
fn the_basis_is_the_callers() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let rows: Vec<[f64; 4]> = (0..500)
        .map(|_| {
            let [x, y, z] = [(); 3].map(|()| rng.random::<f64>() - 0.5);
            let length = (x * x + y * y + z * z).sqrt();
            [1.0, x / length, y / length, z / length]
        })
        .collect();
    let read: Vec<f64> =
        rows.iter().map(|r| 1.0 + 0.1 * r[1] - 0.2 * r[3] + 0.01 * r[1] * r[2]).collect();
    let fit = minimax(&rows, &read).unwrap();
    assert!(fit.deviation - fit.bound < 1e-14 && fit.deviation < 0.005_1);
    assert!(fit.reference.len() == 5);
}
