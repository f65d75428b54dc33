//! Balls that move and bars that read otherwise.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::*;
use crate::simulate::hidden::harmonics::harmonic;

/// A displacement (mm) of the time since the program began (s).
type Equation<'a> = &'a dyn Fn(f64) -> f64;

#[test]
fn a_ball_that_warms_and_one_that_is_knocked() {
    let bench = bench("hu40t.toml");
    let warm = |t: f64| 6e-3 * (1.0 - (-t / 80.0).exp());
    let knocked = |t: f64| if t > 60.0 { 5e-3 } else { 0.0 };
    let cases: [(&str, Equation<'_>, Vector3<f64>); 4] = [
        ("drift:on=EZt,amplitude_um=6,time_constant_s=80", &warm, Vector3::z()),
        ("drift:on=EYw,amplitude_um=6,time_constant_s=80", &warm, -Vector3::y()),
        ("knock:on=EXt,step_um=5,moment_s=60", &knocked, Vector3::x()),
        ("knock:on=EXw,step_um=5,moment_s=60,run=1", &knocked, -Vector3::x()),
    ];
    for (text, equation, direction) in cases {
        for (k, (at, added)) in bench.added(&[text], 10.0).iter().enumerate() {
            let expected = equation(elapsed_s(k, 10.0)) * direction.dot(&bench.bar_direction(at));
            assert!((added - expected).abs() < 2e-7, "{text} {added} {expected}");
        }
    }
}

#[test]
fn a_knock_is_in_its_run_only() {
    let bench = bench("hu40t.toml");
    let scenario = hiding(perfect(), &["knock:on=EXt,step_um=5,moment_s=60,run=3"]);
    let clean = bench.run(&perfect());
    for (number, hit) in [(1, false), (2, false), (3, true), (4, false)] {
        let run = bench.run(&scenario.clone().with_run_number(number));
        assert_eq!(run.readings != clean.readings, hit, "run {number}");
    }
}

#[test]
fn a_bar_reads_longer_by_what_is_hidden_in_it() {
    let bench = bench("hu40t.toml");
    let text = ["bar-length:amplitude_um=3", "drift:on=bar,amplitude_um=-2,time_constant_s=90"];
    for (k, (_, added)) in bench.added(&text, 10.0).iter().enumerate() {
        let expected = 3e-3 - 2e-3 * (1.0 - (-elapsed_s(k, 10.0) / 90.0).exp());
        assert!((added - expected).abs() < 1e-12);
    }
}

#[test]
fn a_vibration_has_its_frequency_and_another_phase_in_every_run() {
    let bench = bench("hu40t.toml");
    // Above half the sample rate: what is seen is its alias, in steady phase over the whole run.
    let shaken = |seed: u64, phase_rad: f64| {
        let text =
            format!("vibration:on=bar,amplitude_um=1,frequency_hz=7.3,phase_rad={phase_rad}");
        let bent = bench.run(&hiding(perfect().with_seed(seed), &[&text]));
        let clean = bench.run(&perfect().with_seed(seed));
        let wave = clean.truth.iter().zip(&bent.truth).enumerate();
        let started = wave.filter(|(_, (clean, _))| clean.moment.program_s > 0.0);
        let (mut sine, mut cosine, mut count, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
        let mut left = Vec::new();
        for (k, (clean, bent)) in started {
            let (s, c) = (TAU * 7.3 * elapsed_s(k, 10.0)).sin_cos();
            let added = bent.exact_mm - clean.exact_mm;
            (sine, cosine, count) = (sine + added * s, cosine + added * c, count + 1.0);
            largest = largest.max(added.abs());
            left.push((added, s, c));
        }
        let (sine, cosine) = (2.0 * sine / count, 2.0 * cosine / count);
        let amplitude = f64::hypot(sine, cosine);
        assert!((amplitude - 1e-3).abs() < 1e-5 && largest < 1.0001e-3, "{amplitude} {largest}");
        let phase = cosine.atan2(sine);
        for (added, s, c) in left {
            assert!((added - 1e-3 * (phase.cos() * s + phase.sin() * c)).abs() < 1e-5);
        }
        phase
    };
    let apart = |a: f64, b: f64| (a - b).rem_euclid(TAU);
    assert!((apart(shaken(1, 0.7), shaken(1, 0.0)) - 0.7).abs() < 0.02);
    let drawn: Vec<f64> = (1..5).map(|seed| shaken(seed, 0.0)).collect();
    for pair in drawn.windows(2) {
        assert!((0.01..TAU - 0.01).contains(&apart(pair[0], pair[1])), "{drawn:?}");
    }
}

#[test]
fn a_tool_that_vibrates_is_seen_along_the_bar() {
    let bench = bench("hu40t.toml");
    let on = |seat: &str| format!("vibration:on={seat},amplitude_um=1,frequency_hz=0.7");
    let bar = bench.added(&[&on("bar")], 10.0);
    for (seat, k) in [("EXt", 0), ("EYt", 1), ("EZt", 2)] {
        for ((at, added), (_, whole)) in bench.added(&[&on(seat)], 10.0).iter().zip(&bar) {
            assert!((added - whole * bench.bar_direction(at)[k]).abs() < 1e-8);
        }
    }
}

#[test]
fn roundness_is_seen_in_the_direction_of_the_bar() {
    let bench = bench("hu40t.toml");
    for (at, added) in bench.added(&["roundness:amplitude_um=0.3,degree=3,order=-2"], 10.0) {
        let u = bench.bar_direction(&at);
        // sqrt(105) x y z, as tables have it for the rms of 1.
        assert!((added - 0.3e-3 * 105_f64.sqrt() * u.x * u.y * u.z).abs() < 1e-12);
    }
}

#[test]
fn harmonics_are_those_of_the_tables() {
    let (polar, azimuth) = (0.7_f64, 2.1_f64);
    let (s, z) = polar.sin_cos();
    let (x, y) = (s * azimuth.cos(), s * azimuth.sin());
    for (degree, order, expected) in [
        (2, 0, 5_f64.sqrt() * (1.5 * z * z - 0.5)),
        (2, 1, 15_f64.sqrt() * x * z),
        (2, -1, 15_f64.sqrt() * y * z),
        (2, 2, 15_f64.sqrt() / 2.0 * (x * x - y * y)),
        (3, 0, 7_f64.sqrt() * (2.5 * z * z - 1.5) * z),
        (3, -3, (35_f64 / 8.0).sqrt() * s.powi(3) * (3.0 * azimuth).sin()),
        (4, 0, (3.0 / 8.0) * (35.0 * z.powi(4) - 30.0 * z * z + 3.0)),
    ] {
        let value = harmonic(degree, order, &Vector3::new(x, y, z));
        assert!((value - expected).abs() < 1e-14, "{degree} {order}: {value} {expected}");
    }
}

#[test]
fn harmonics_have_an_rms_of_1_and_do_not_know_each_other() {
    // Midpoints in the height, which has equal areas; the azimuth sums are exact.
    let (heights, azimuths) = (4000, 20);
    let mut all: Vec<(u32, i32)> = Vec::new();
    for degree in 0..=8 {
        all.extend((-degree..=degree).map(|order| (degree as u32, order)));
    }
    let mut products = vec![0.0; all.len() * all.len()];
    for i in 0..heights {
        let z: f64 = (2.0 * f64::from(i) + 1.0) / f64::from(heights) - 1.0;
        for j in 0..azimuths {
            let (sin, cos) = (TAU * (f64::from(j) + 0.3) / f64::from(azimuths)).sin_cos();
            let s = (1.0 - z * z).sqrt();
            let u = Vector3::new(s * cos, s * sin, z);
            let values: Vec<f64> = all.iter().map(|(n, m)| harmonic(*n, *m, &u)).collect();
            for (a, first) in values.iter().enumerate() {
                for (b, second) in values.iter().enumerate() {
                    products[a * all.len() + b] += first * second;
                }
            }
        }
    }
    for (a, first) in all.iter().enumerate() {
        for (b, second) in all.iter().enumerate() {
            let mean = products[a * all.len() + b] / f64::from(heights * azimuths);
            let expected = if a == b { 1.0 } else { 0.0 };
            assert!((mean - expected).abs() < 1e-4, "{first:?} {second:?}: {mean}");
        }
    }
}
