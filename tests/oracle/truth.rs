//! Scoring against what was put into the logs of `tests/data`: times, residuals, coefficients.

use std::f64::consts::TAU;

use ballbar::align::{Part, Sample, TimeMap};
use ballbar::identify::Identification;

use ballbar::nc::{self, Action, Move, Program, Step};
use nalgebra::{Rotation3, Unit, Vector3};

use crate::chain::{Set, Truth, truths};

/// The sets whose truth holds times.
const TIMED: [&str; 3] = ["hu40t", "case-d", "hu40t-stops"];

struct Scored {
    sets: Vec<(Set, Vec<Identification>)>,
    /// How long the approach took before the first place that the programs name, s.
    approach_s: f64,
}

fn on_arcs(identification: &Identification) -> impl Iterator<Item = &Sample> {
    let samples = identification.runs[0].records.iter().map(|record| &record.sample);
    samples.filter(|sample| matches!(sample.part, Part::Arc(_)))
}

/// Program time found minus program time put in, s, without the approach.
fn error_s(sample: &Sample, map: &TimeMap, truth: &Truth<'_>) -> f64 {
    sample.program_s - truth.program_s(sample.log_s, map.pauses_before(sample.leg))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Identifies every run of every set and takes the approach, one number, as the median over all runs of
/// the mean difference of times.
fn scored() -> Scored {
    let sets: Vec<(Set, Vec<Identification>)> = TIMED
        .map(|name| {
            let set = Set::read(name);
            let repeats = set.repeats();
            (set, repeats)
        })
        .into();
    let mut means: Vec<f64> = Vec::new();
    for (set, repeats) in &sets {
        for (truth, found) in truths(set).iter().zip(repeats) {
            means.push(mean(
                &on_arcs(found)
                    .map(|s| error_s(s, &found.runs[0].alignment.time_map, truth))
                    .collect::<Vec<_>>(),
            ));
        }
    }
    means.sort_by(f64::total_cmp);
    Scored { approach_s: -means[means.len() / 2], sets }
}

#[test]
fn what_was_put_in_comes_out() {
    let scored = scored();
    let mut wrong: Vec<String> = Vec::new();
    let mut hold = |what: &str, value: f64, limit: f64| {
        if value.is_nan() || value > limit {
            wrong.push(format!("{what}: {value:.4} above {limit}"));
        }
    };
    println!("approach {:.4} s", scored.approach_s);
    hold("approach, s from 1.2245", (scored.approach_s - 1.2245).abs(), 5e-4);

    println!(
        "\nrun               time: rms ms  worst ms | clock error ppm (sigma) | residual um  / floor"
    );
    for (set, repeats) in &scored.sets {
        let stops = set.name == "hu40t-stops";
        for (truth, found) in truths(set).iter().zip(repeats) {
            let run = format!("{} {}", set.name, found.runs[0].name);
            let errors: Vec<f64> = on_arcs(found)
                .map(|s| {
                    1e3 * (error_s(s, &found.runs[0].alignment.time_map, truth) + scored.approach_s)
                })
                .collect();
            let worst = errors.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
            let map = &found.runs[0].alignment.time_map;
            let clock_ppm = 1e6 * map.rate - truth.number("clock_ppm");
            let ratio = 1e3 * found.rms_mm / truth.number("floor_um");
            println!(
                "{run:<17} {:12.3} {worst:9.3} | {clock_ppm:10.2} {:12.2} | {:11.4} {ratio:8.4}",
                rms(&errors),
                1e6 * map.rate_sigma,
                1e3 * found.rms_mm
            );
            let cautions = set.cautions(found);
            hold(&format!("{run}: rms of time, ms"), rms(&errors), if stops { 0.7 } else { 1.0 });
            hold(&format!("{run}: worst time, ms"), worst, 3.0);
            hold(&format!("{run}: cautions {cautions:?}"), cautions.len() as f64, 0.0);
            hold(&format!("{run}: clock, sigma"), clock_ppm.abs() / (1e6 * map.rate_sigma), 4.0);
            hold(&format!("{run}: residual over floor"), ratio, 1.005);
        }
    }
    arc_starts(&scored, &mut hold);
    coefficients(&scored, &mut hold);
    whitened(&scored, &mut hold);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The noise model is right where what is left is white: an rms of 1, and nothing that neighbours foretell.
fn whitened(scored: &Scored, hold: &mut impl FnMut(&str, f64, f64)) {
    for (set, repeats) in &scored.sets {
        for found in repeats {
            let white: Vec<Option<f64>> =
                found.runs.iter().flat_map(|run| &run.records).map(|r| r.whitened).collect();
            let of: Vec<f64> = white.iter().flatten().copied().collect();
            let pairs: Vec<f64> =
                white.windows(2).filter_map(|two| Some(two[0]? * two[1]?)).collect();
            // Five standard deviations of an rms, and of a correlation, of so many independent values.
            let bound = 5.0 / (of.len() as f64).sqrt();
            hold(
                &format!("{}: rms of the whitened residual", set.name),
                (rms(&of) - 1.0).abs(),
                bound,
            );
            hold(&format!("{}: correlation of neighbours", set.name), mean(&pairs).abs(), bound);
        }
    }
}

/// Every arc of the runs with pauses starts when the map says, within what the map says of itself.
fn arc_starts(scored: &Scored, hold: &mut impl FnMut(&str, f64, f64)) {
    println!("\nrun               arc                  start off ms  sigma ms  in sigma");
    for (set, repeats) in scored.sets.iter().filter(|(set, _)| set.name == "hu40t-stops") {
        for (truth, found) in truths(set).iter().zip(repeats) {
            let alignment = &found.runs[0].alignment;
            let map = &alignment.time_map;
            for section in &alignment.sections {
                let leg = map.leg_of(section.start_s);
                let log_s = map.log_time_s(section.start_s, leg);
                let off_s = section.start_s + scored.approach_s
                    - truth.program_s(log_s, map.pauses_before(leg));
                let sigma_s = map.sigma_s(log_s, leg);
                let run = format!("{} {}", set.name, found.runs[0].name);
                let share = off_s / sigma_s;
                println!(
                    "{run:<17} {:<20} {:12.3} {:9.3} {share:9.2}",
                    section.name,
                    1e3 * off_s,
                    1e3 * sigma_s
                );
                hold(&format!("{run} {}: start, sigma", section.name), share.abs(), 3.0);
            }
        }
    }
}

/// Coefficients and set-up errors in units of their stated sigma.
fn coefficients(scored: &Scored, hold: &mut impl FnMut(&str, f64, f64)) {
    let mut all: Vec<f64> = Vec::new();
    println!("\nrun               columns  rms of error/sigma  beyond 3  beyond 4  worst");
    for (set, repeats) in &scored.sets {
        for (truth, found) in truths(set).iter().zip(repeats) {
            let shares: Vec<(f64, &str)> = found
                .estimates
                .iter()
                .map(|estimate| {
                    let name = estimate.parameter.name.as_str();
                    ((estimate.value - truth.coefficient(name)) / estimate.sigma, name)
                })
                .collect();
            let values: Vec<f64> = shares.iter().map(|(share, _)| *share).collect();
            let (worst, name) =
                shares.into_iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap();
            let beyond = |limit: f64| values.iter().filter(|v| v.abs() > limit).count();
            let run = format!("{} {}", set.name, found.runs[0].name);
            println!(
                "{run:<17} {:7} {:19.2} {:9} {:9}  {worst:.2} ({name})",
                values.len(),
                rms(&values),
                beyond(3.0),
                beyond(4.0)
            );
            hold(&format!("{run} {name}: sigma"), worst.abs(), 4.0);
            all.extend(values);
        }
    }
    let share = |limit: f64| {
        100.0 * all.iter().filter(|v| v.abs() > limit).count() as f64 / all.len() as f64
    };
    println!(
        "all {}: rms {:.3}, beyond 2: {:.1} %, 3: {:.2} %, 4: {:.2} %",
        all.len(),
        rms(&all),
        share(2.0),
        share(3.0),
        share(4.0)
    );
}

/// What three planes say, held against what was put in.
struct Planes {
    residual_um: f64,
    /// Deviation predicted with the found values minus that with the true ones, over all samples.
    off_mean_um: f64,
    off_rms_um: f64,
    /// How far inside of their arcs slides were found to bring the ball because they lag.
    inside_mean_um: f64,
    /// Worst error of a coefficient that the planes determine by itself, in sigma.
    worst_share: f64,
}

/// Of 38 columns the planes see 32, so most coefficients have no truth of their own; what they predict
/// has.
fn planes(what: &str, edit: impl Fn(Program) -> Program) -> Planes {
    let set = Set::read("planar");
    let runs = set.test.runs().unwrap();
    let inputs = runs.iter().map(|run| {
        let log = set.log(&run.log, str::to_owned).unwrap();
        let alignment = set.align(&log, &edit(set.program(&run.program))).unwrap();
        set.input(run, alignment)
    });
    let found = set.identify(inputs.collect()).unwrap();
    let model = set.model();
    let truth = Truth(&set.truth);
    let values = found.values();
    let true_values: Vec<f64> =
        model.parameters().iter().map(|p| truth.coefficient(&p.name)).collect();
    let mut off_um = Vec::new();
    let mut inside_um = Vec::new();
    for run in &found.runs {
        let (following, radius_mm) = (run.alignment.following(0.0), run.alignment.radius_mm);
        let middle_mm = *run.alignment.coincidence_mm();
        inside_um.extend(run.used().map(|record| &record.sample).map(|s| {
            let along = (s.pose.position_mm - middle_mm).normalize();
            let speed_mm_s = s.motion.velocity_mm_s.norm();
            1e3 * following.inside_mm(&along, speed_mm_s, radius_mm)[0].sum()
        }));
        let length_mm =
            |values: &[f64], s: &Sample| model.length_mm(values, &s.pose, &s.motion, run.mounting);
        let used = run.used().map(|record| &record.sample);
        let of_run: Vec<f64> =
            used.map(|s| 1e3 * (length_mm(&values, s) - length_mm(&true_values, s))).collect();
        println!(
            "{what} {}: residual {:.4} um; predicted minus true: mean {:.4}, rms {:.4} um",
            run.name,
            1e3 * ballbar::identify::rms_mm(run),
            mean(&of_run),
            rms(&of_run)
        );
        off_um.extend(of_run);
    }
    let pairs = found.estimates.iter().zip(&true_values);
    let shares: Vec<f64> = pairs
        .filter(|(estimate, _)| estimate.observed > 0.999)
        .map(|(estimate, value)| (estimate.value - value) / estimate.sigma)
        .collect();
    let worst_share = shares.iter().fold(0.0, |worst: f64, share| worst.max(share.abs()));
    println!(
        "{what} all: residual {:.4} um, rank {} of {}; {} coefficients determined by themselves, \
         rms of error/sigma {:.2}, worst {worst_share:.2}",
        1e3 * found.rms_mm,
        found.rank,
        values.len(),
        shares.len(),
        rms(&shares)
    );
    assert_eq!(found.rank, 32, "observable35 on three planes");
    Planes {
        residual_um: 1e3 * found.rms_mm,
        off_mean_um: mean(&off_um),
        inside_mean_um: mean(&inside_um),
        off_rms_um: rms(&off_um),
        worst_share,
    }
}

/// The chords that the README of the data tells of, in a turn.
const CHORDS: usize = 1924;

/// The program with every arc as chords.
fn chorded(mut program: Program) -> Program {
    let mut steps = Vec::new();
    for step in &program.steps {
        let Action::Move(arc @ Move { path: nc::Path::Arc { center_mm, axis, sweep_rad }, .. }) =
            step.action
        else {
            steps.push(*step);
            continue;
        };
        let count = (CHORDS as f64 * sweep_rad.abs() / TAU).round() as usize;
        let point_mm = |k: usize| {
            let angle = sweep_rad * k as f64 / count as f64;
            let turn =
                Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::ith(axis, 1.0)), angle);
            center_mm + turn * (arc.start_mm - center_mm)
        };
        for k in 0..count {
            let chord = Move {
                path: nc::Path::Line,
                start_mm: point_mm(k),
                end_mm: point_mm(k + 1),
                ..arc
            };
            steps.push(Step { action: Action::Move(chord), ..*step });
        }
    }
    program.steps = steps;
    program
}

/// Over the path that was really driven everything comes out.
#[test]
fn what_three_planes_can_see_comes_out() {
    let found = planes("chords", chorded);
    // The noise put in is 0.15 um and a resolution of 0.1 um.
    assert!(found.residual_um < 1.01 * 0.153, "residual {:.4} um", found.residual_um);
    assert!(found.off_rms_um < 0.01, "prediction off by {:.4} um", found.off_rms_um);
    assert!(found.worst_share < 3.0, "a coefficient is off by {:.2} sigma", found.worst_share);
}

/// Over the circles that the programs command, the chords inside the machine are an error of the radius: two thirds of their
/// sagitta. A scale of all slides does it, and a lag that all share; of programs without chords nothing tells one from the other.
#[test]
fn chords_that_the_program_does_not_show_are_found_as_a_smaller_radius() {
    let found = planes("circles", |program| program);
    let sag_um = 1e3 * 150.0 * (1.0 - (std::f64::consts::PI / CHORDS as f64).cos());
    assert!(found.residual_um < 1.1 * 0.15, "residual {:.4} um", found.residual_um);
    let smaller_um = found.inside_mean_um - found.off_mean_um;
    let rest_um = 2.0 / 3.0 * sag_um - smaller_um;
    println!("circles: two thirds of the sagitta {:.4} um, rest {rest_um:.4} um", sag_um / 1.5);
    assert!(rest_um.abs() < 0.02, "smaller by {smaller_um:.4} um");
    let scatter_um = (found.off_rms_um.powi(2) - found.off_mean_um.powi(2)).sqrt();
    assert!(scatter_um < 0.02, "prediction off by {scatter_um:.4} um");
}
