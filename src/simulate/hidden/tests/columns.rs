//! The simulator's formulas against the columns of the terms that look for them: two authors of one table.

use super::*;
use crate::machine::Pose;
use crate::model::{AMPLITUDE, Cause, Law, Model, Motion, PHASE, Seat, Shape, Start, Term};
use crate::motion::{Reversals, Trajectory};
use crate::simulate::hidden::of_run;

const RATE_HZ: f64 = 2.0;
/// The largest displacement along the bar, mm. Across it an angle moves a ball a hundred times as far; of second order
/// that is some 1e-11 mm.
const LARGEST_MM: f64 = 1e-6;

/// What a cause may act on: what it is looked for on, and the workpiece ball.
fn seats(cause: &Cause) -> Vec<Seat> {
    let all =
        [cause.seats(), ["EXw", "EYw", "EZw"].map(|ball| Seat::parse(ball).unwrap()).to_vec()];
    all.concat().into_iter().filter(|seat| seat.fits(cause.seat)).collect()
}

/// Inner numbers over the whole range of their key.
fn inners(cause: &Cause, seat: Seat) -> Vec<Option<f64>> {
    let Some((inner, key)) = cause.inner(seat) else { return vec![None] };
    if inner.start == Start::Whole {
        return key.whole_numbers().map(Some).collect();
    }
    let [low, high] = key.limits_si(seat);
    let low = if low > 0.0 { low } else { 1e-6 * high };
    // Beside round numbers, on which waves and samples beat.
    (0..9).map(|k| Some(low * (high / low).powf((f64::from(k) + 0.37) / 9.0))).collect()
}

/// Where the samples of a perfect machine are, as the terms see it.
fn situations<'a>(
    bench: &'a Bench,
    model: &'a Model,
) -> impl Iterator<Item = crate::model::Situation> + 'a {
    let trajectory = Trajectory::new(&bench.program, &bench.machine, 1.0);
    let reversals = Reversals::of(&trajectory);
    let clean = bench.run(&Scenario { sample_rate_hz: Some(RATE_HZ), ..perfect() });
    clean.truth.into_iter().enumerate().map(move |(k, TruePoint { state, moment, .. })| {
        let turned_by_s = moment.program_s - if moment.in_pause { 1e-6 } else { 0.0 };
        let motion = Motion {
            velocity_mm_s: state.velocity_mm_s,
            elapsed_s: elapsed_s(k, RATE_HZ),
            program_s: moment.program_s,
            reversals: reversals.last(turned_by_s, &state.position_mm, 0.0),
            ..Motion::REST
        };
        let pose = Pose { position_mm: state.position_mm, sense: state.sense };
        model.situation(&pose, &motion, 0)
    })
}

#[test]
fn every_cause_does_what_its_columns_say_over_its_whole_range() {
    for machine in ["hu40t.toml", "vertical.toml"] {
        let bench = bench(machine);
        let model = Model::new(&bench.machine, vec![bench.mounting], Vec::new());
        let situations: Vec<_> = situations(&bench, &model).collect();
        let mut seen = 0;
        for cause in CAUSES.iter().filter(|cause| cause.law.is_term()) {
            for seat in seats(cause) {
                // The simulator's axes stand where they were commanded to be a delay ago: of a delay that all have
                // only the time of the log is left. See below.
                if matches!(cause.law(seat), Law::Corner(_)) {
                    continue;
                }
                for inner in inners(cause, seat) {
                    seen += usize::from(agrees(&bench, &situations, &Shape { cause, seat, inner }));
                }
            }
        }
        // Some have ended before the machine starts, or begin after it has ended.
        assert!(seen > 500, "{machine}: {seen}");
    }
}

/// Whether an effect does anything; what it does must be what its columns say.
fn agrees(bench: &Bench, situations: &[crate::model::Situation], shape: &Shape) -> bool {
    let count = shape.amplitudes();
    let columns = |at| {
        let mut row = vec![0.0; count];
        shape.columns(at, &mut row);
        row
    };
    let rows: Vec<Vec<f64>> = situations.iter().map(columns).collect();
    let most = rows.iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    if most < 1e-9 {
        return false;
    }
    let amplitudes: Vec<f64> =
        (0..count).map(|k| LARGEST_MM / most * if k % 2 == 0 { 0.7 } else { -0.4 }).collect();
    let clean = Scenario { sample_rate_hz: Some(RATE_HZ), ..perfect() };
    let mut scenario = clean.clone().with_run_number(1);
    for effect in shape.effects(&amplitudes) {
        scenario.hide(effect).unwrap();
    }
    let amplitudes = match shape.law() {
        // What the run has made of the phase.
        Law::Wave(..) => {
            let drawn = &of_run(&scenario)[0];
            let (sine, cosine) = drawn.get(PHASE).sin_cos();
            vec![drawn.get(AMPLITUDE) * cosine, drawn.get(AMPLITUDE) * sine]
        }
        _ => amplitudes,
    };
    let (clean, bent) = (bench.run(&clean), bench.run(&scenario));
    for (k, row) in rows.iter().enumerate() {
        let added = bent.truth[k].exact_mm - clean.truth[k].exact_mm;
        let expected: f64 = row.iter().zip(&amplitudes).map(|(c, a)| c * a).sum();
        assert!(
            (added - expected).abs() < 1e-4 * LARGEST_MM,
            "{} at {:?}: {added} is not {expected}",
            shape.name(),
            bent.truth[k].moment
        );
    }
    true
}

/// A control whose axes all err by `-delay v`: against where they were a delay ago, which is what the time of the
/// log makes of it, the corners of the chords are left.
#[test]
fn a_delay_in_common_is_one_of_the_log_but_for_the_corners() {
    let bench = bench("hu40t.toml");
    let model = Model::new(&bench.machine, vec![bench.mounting], Vec::new());
    let trajectory = Trajectory::new(&bench.program, &bench.machine, 1.0);
    let servo = Cause::named("servo").unwrap();
    let length_mm = |place: nalgebra::Vector3<f64>| (place - bench.mounting.coincidence_mm).norm();
    for delay_s in [1e-3, 5e-3, 40e-3] {
        let shape = Shape { cause: servo, seat: Seat::Whole, inner: Some(delay_s) };
        let mut corners = 0;
        for k in 0..20_000 {
            let t = 10.0 + 0.007 * f64::from(k);
            let (now, then) = (trajectory.at(t), trajectory.at(t - delay_s));
            let feed = |v: nalgebra::Vector3<f64>| (v.norm() - 500.0 / 60.0).abs() < 1e-9;
            if !feed(now.velocity_mm_s) || !feed(then.velocity_mm_s) {
                continue;
            }
            let corner = trajectory.corner(t - delay_s, then.block);
            let motion = Motion { velocity_mm_s: then.velocity_mm_s, corner, ..Motion::REST };
            let pose = Pose { position_mm: then.position_mm, sense: then.sense };
            let mut column = [0.0];
            shape.columns(&model.situation(&pose, &motion, 0), &mut column);
            let errs = length_mm(now.position_mm - delay_s * now.velocity_mm_s);
            let added = errs - length_mm(then.position_mm);
            // Across the bar a corner moves the ball, too: of second order.
            let aside_mm = corner.ahead_s.min(delay_s) * corner.jump_mm_s.norm();
            let across_mm = aside_mm * aside_mm / (2.0 * bench.bar.length_mm);
            assert!((added - column[0]).abs() < 1e-12 + 2.0 * across_mm, "{t} {added} {column:?}");
            corners += usize::from(column[0].abs() > 1e-3 * delay_s);
        }
        assert!(corners > 20, "{delay_s}: {corners}");
    }
}
