//! Truth put in, truth got back within the stated sigma, on an equator with known noise.

use super::bench::{effect, element, residuals, white};
use super::element::Earlier;
use super::*;
use crate::model::{AMPLITUDE, Averaged};
use crate::solve::{Basis, Cholesky, dot};

/// Noise of a reading, mm.
const NOISE_MM: f64 = 1.5e-4;

/// Residuals with an effect put in by its columns, sine and cosine where it is a wave.
fn with(seed: u64, truth: &Element, amplitudes: &[f64]) -> Residuals {
    let residuals = residuals(3, white(seed, NOISE_MM));
    let mut sum = residuals.zeros();
    for (amplitude, column) in amplitudes.iter().zip(truth.columns(&residuals)) {
        sum.add(*amplitude, &column);
    }
    residuals.plus(&sum)
}

#[test]
fn what_a_model_follows_is_never_left() {
    let residuals = residuals(2, white(1, NOISE_MM));
    let scale = element("drift:on=EXX1,time_constant_s=1e6").columns(&residuals).remove(0);
    let set_up: Column = residuals
        .repeats
        .iter()
        .map(|repeat| repeat.samples.iter().map(|s| s.situation.direction.x).collect())
        .collect();
    // To the seven digits that a basis is held to.
    assert!(residuals.outside(&set_up).square() < 1e-13 * set_up.square());
    // A scale that warms is not the scale itself.
    assert!(residuals.outside(&scale).square() > 1e-3 * scale.square());
}

#[test]
fn beside_an_effect_nothing_of_it_is_left_and_twice_is_once() {
    let (truth, _) = effect("cyclic:on=EXX,amplitude_um=1,period_mm=10");
    let residuals = with(2, &truth, &[8e-4, 6e-4]);
    let columns = truth.columns(&residuals);
    let once = residuals.beside(&columns);
    for column in &columns {
        let along = residuals.outside(column).product(&once.left_mm);
        assert!(along.abs() < 1e-9 * column.square().sqrt(), "{along}");
    }
    let twice = residuals.beside(&[columns.clone(), columns].concat());
    assert_eq!(twice.span.len(), once.span.len(), "what is accepted already adds nothing");
    assert!((twice.left_mm2() - once.left_mm2()).abs() < 1e-12 * once.left_mm2());
    assert!(once.left_mm2() < 0.2 * residuals.alone().left_mm2());
}

/// A fit that holds its numbers to what is plausible of them follows a column only in part: what two effects explain together is what
/// one does, and then the other beside it.
#[test]
fn what_two_effects_explain_is_what_one_does_and_the_other_beside_it() {
    let mut residuals = residuals(2, white(4, NOISE_MM));
    for (repeat, left_mm) in residuals.repeats.iter_mut().zip(residuals.model_mm.iter_mut()) {
        let mut held = Basis::with_room(repeat.basis.rank(), repeat.samples.len());
        for sample in 0..repeat.samples.len() {
            let row: Vec<f64> = repeat.basis.row(sample).map(|q| 0.8 * q).collect();
            held.push(&row);
        }
        repeat.basis = held;
        *left_mm = repeat.basis.outside(left_mm);
    }
    let (first, second) =
        (element("drift:on=EXt,time_constant_s=20"), element("drift:on=EXX1,time_constant_s=40"));
    let alone = residuals.alone();
    let gain_mm2 = |beside: &Beside, elements: &[&Element]| {
        let mut system = System::default();
        for element in elements {
            system.push_element(beside, element, element.columns(&residuals));
        }
        let (normal, common) = system.part(elements.len());
        dot(&Cholesky::of(&normal).unwrap().solve(common), common)
    };
    let both_mm2 = gain_mm2(&alone, &[&first, &second]);
    let beside = residuals.beside(&first.columns(&residuals));
    let then_mm2 = gain_mm2(&alone, &[&first]) + gain_mm2(&beside, &[&second]);
    assert!((then_mm2 / both_mm2 - 1.0).abs() < 1e-4, "{then_mm2} {both_mm2}");
    // Where the span were unit columns of what is left, a drift would be left over where it is accepted.
    let again = System::of(&beside, &first).share_outside();
    assert!(again.abs() < 1e-6, "{again}");
}

#[test]
fn a_fit_finds_amplitudes_and_the_number_inside() {
    let (truth, of) = effect("cyclic:on=EXX,amplitude_um=1.2,period_mm=10,phase_rad=0.7");
    let amplitude = of.get(AMPLITUDE);
    let sine_cosine = [amplitude * 0.7_f64.cos(), amplitude * 0.7_f64.sin()];
    let residuals = with(3, &truth, &sine_cosine);
    let alone = residuals.alone();
    let fitted = fit(&alone, vec![element("cyclic:on=EXX,period_mm=10.06")]).unwrap();
    let variance = NOISE_MM * NOISE_MM;
    for (k, truth) in sine_cosine.into_iter().enumerate() {
        let sigma = (variance * fitted.inverse[(k, k)]).sqrt();
        let error = fitted.amplitudes[0][k] - truth;
        assert!(error.abs() < 4.0 * sigma, "{error} of {sigma}");
    }
    let inner = fitted.inner_index(0).unwrap();
    let sigma = (variance * fitted.inverse[(inner, inner)]).sqrt();
    let period_mm = fitted.elements[0].shape().unwrap().inner.unwrap();
    let sigma_mm = fitted.elements[0].inner_sigma(sigma).unwrap();
    assert!((period_mm - 10.0).abs() < 4.0 * sigma_mm, "{period_mm} +- {sigma_mm}");
    assert!(sigma_mm < 1e-3, "{sigma_mm}");
    // The gain is what the sum of squares really falls by.
    let fall = alone.left_mm2() - fitted.left_mm(&alone).square();
    assert!((fall / fitted.gain_mm2 - 1.0).abs() < 1e-5, "{fall} {}", fitted.gain_mm2);
}

#[test]
fn the_stated_covariance_is_the_scatter() {
    const DRAWS: u64 = 200;
    let (truth, _) = effect("cyclic:on=EYY,amplitude_um=0.5,period_mm=12");
    let at_truth = truth.free().unwrap();
    let mut squares = [0.0; 3];
    for seed in 0..DRAWS {
        let residuals = with(100 + seed, &truth, &[5e-4, 0.0]);
        let fitted = fit(&residuals.alone(), vec![truth.clone()]).unwrap();
        let errors = [
            fitted.amplitudes[0][0] - 5e-4,
            fitted.amplitudes[0][1],
            fitted.elements[0].free().unwrap() - at_truth,
        ];
        for (k, (sum, error)) in squares.iter_mut().zip(errors).enumerate() {
            *sum += error * error / (NOISE_MM * NOISE_MM * fitted.inverse[(k, k)]);
        }
    }
    for sum in squares {
        // The root of a mean of 200 squares is uncertain by 5 %.
        let ratio = (sum / DRAWS as f64).sqrt();
        assert!((ratio - 1.0).abs() < 0.2, "{squares:?}");
    }
}

#[test]
fn what_columns_explain_is_what_their_fit_gains() {
    let (truth, _) = effect("cyclic:on=EXX,amplitude_um=1,period_mm=10");
    let residuals = with(4, &truth, &[1e-3, 0.0]);
    let alone = residuals.alone();
    for term in ["drift:on=EYt,time_constant_s=100", "growing-backlash:on=EXX"] {
        let element = element(term);
        let (columns, anywhere) =
            (element.columns(&residuals), System::of(&alone, &element).into_anywhere());
        let beside = residuals.beside(&truth.columns(&residuals));
        for ground in [&alone, &beside] {
            let system = System::of(ground, &element);
            let (normal, common) = system.part(columns.len());
            let direct = dot(&Cholesky::of(&normal).unwrap().solve(common), common);
            let later = anywhere.gain_mm2(&columns, ground).unwrap();
            assert!((direct - later).abs() < 1e-9 * direct.max(1e-12), "{term}: {direct} {later}");
        }
    }
}

/// What is nearly straight up to the highest speed is a reversal and a servo mismatch.
#[test]
fn friction_that_ends_beyond_the_speeds_driven_is_none() {
    let residuals = residuals(2, white(5, NOISE_MM));
    let half_mm_min = 0.5 * 60.0 * residuals.fastest_mm_s[0];
    let stick_slip =
        |on: &str, mm_min: f64| element(&format!("stick-slip:on={on},speed_mm_min={mm_min}"));
    assert!(stick_slip("X", 0.9 * half_mm_min).possible(&residuals));
    assert!(!stick_slip("X", 1.1 * half_mm_min).possible(&residuals));
    assert!(!stick_slip("Z", 1.0).possible(&residuals), "Z stands still");
}

/// Of 20 readings in 20 ms a wave of 50 Hz is left a two hundredth of: half a millimetre in each reading for 3 um in the means.
#[test]
fn a_vibration_that_means_take_away_is_none() {
    let mut residuals = residuals(1, white(1, NOISE_MM));
    let vibration = |hz: f64| element(&format!("vibration:on=bar,frequency_hz={hz}"));
    assert!(vibration(50.25).possible(&residuals), "of single readings nothing is taken away");
    for sample in &mut residuals.repeats[0].samples {
        sample.situation.motion.averaged = Averaged { readings: 20.0, period_s: 1e-3 };
    }
    assert!(!vibration(50.25).possible(&residuals) && !vibration(99.9).possible(&residuals));
    assert!(vibration(25.25).possible(&residuals) && vibration(75.0).possible(&residuals));
}

#[test]
fn white_noise_has_one_variance() {
    let residuals = residuals(4, white(5, NOISE_MM));
    let noise = *residuals.alone().noise();
    let variance = NOISE_MM * NOISE_MM;
    // Of some 9000 readings, Bartlett's window over 20 of them: uncertain by some 6 %.
    assert!((noise.variance_mm2 / variance - 1.0).abs() < 0.05, "{noise:?}");
    assert!((noise.neighbours_mm2 / variance - 1.0).abs() < 0.05, "{noise:?}");
    assert!((noise.long_run_mm2 / variance - 1.0).abs() < 0.25, "{noise:?}");
    assert!((noise.by_chance_mm2(3) / (6.0 * noise.long_run_mm2) - 1.0).abs() < 1e-12);
}

#[test]
fn correlated_noise_gains_more_by_chance_than_its_neighbours_tell() {
    // First order, correlation 0.6 from one reading to the next: long-run variance (1 + r) / (1 - r) = 4 times.
    let (mut draw, mut state, correlation) = (white(6, 1.0), 0.0, 0.6_f64);
    let residuals = residuals(4, move || {
        state = correlation * state + (1.0 - correlation * correlation).sqrt() * draw();
        NOISE_MM * state
    });
    let noise = *residuals.alone().noise();
    let variance = NOISE_MM * NOISE_MM;
    assert!((noise.variance_mm2 / variance - 1.0).abs() < 0.1, "{noise:?}");
    assert!((noise.neighbours_mm2 / (0.4 * variance) - 1.0).abs() < 0.1, "{noise:?}");
    assert!((noise.long_run_mm2 / (4.0 * variance) - 1.0).abs() < 0.35, "{noise:?}");
}

/// Noise that hangs together over a second, of which a window of two sees little more than half, and the fits have taken out a
/// part of what is slow: what it really gains by chance is seen where it is alone.
#[test]
fn noise_that_hangs_together_for_long_is_seen_whole_where_it_is_alone() {
    let long_run = 19.0; // (1 + r) / (1 - r)
    let ratios: Vec<[f64; 2]> = (0..8)
        .map(|seed| {
            let (mut draw, mut state, correlation) = (white(40 + seed, 1.0), 0.0, 0.9_f64);
            let residuals = residuals(4, move || {
                state = correlation * state + (1.0 - correlation * correlation).sqrt() * draw();
                NOISE_MM * state
            });
            let alone = residuals.alone();
            let true_mm2 = long_run * NOISE_MM * NOISE_MM;
            [alone.noise().long_run_mm2 / true_mm2, alone.noise_alone().long_run_mm2 / true_mm2]
        })
        .collect();
    let mean = |k: usize| ratios.iter().map(|ratio| ratio[k]).sum::<f64>() / ratios.len() as f64;
    assert!(mean(0) < 0.65, "{ratios:?}");
    assert!((mean(1) - 0.85).abs() < 0.2, "{ratios:?}");
}

#[test]
fn what_repeats_is_told_from_what_does_not() {
    let (truth, _) = effect("cyclic:on=EXX,amplitude_um=0.3,period_mm=10");
    let residuals = with(7, &truth, &[3e-4, 0.0]);
    let shared = structure(&residuals, &residuals.model_mm, |_| true).unwrap();
    let put_in = residuals.outside(&truth.columns(&residuals)[0]).square() * 9e-8;
    let mean_mm2 = put_in / residuals.samples() as f64;
    let aside = (shared.variance_mm2 - mean_mm2).abs();
    assert!(aside < 4.0 * shared.sigma_mm2, "{shared:?} {mean_mm2}");
    let beside = residuals.beside(&truth.columns(&residuals));
    let left = structure(&residuals, &beside.left_mm, |_| true).unwrap();
    assert!(left.variance_mm2.abs() < 4.0 * left.sigma_mm2, "{left:?}");
    assert!(structure(&residuals, &residuals.model_mm, |_| false).is_none());
}

/// How a vibration differs from run to run was once kept with the residuals, and what was tuned while a setting
/// was tried stayed tuned in the main search.
#[test]
fn a_tuned_vibration_tunes_no_other() {
    let residuals = residuals(3, white(12, NOISE_MM));
    let vibration = element("vibration:on=EXt,frequency_hz=2.3");
    let plain = Element { owner: Owner::EachRun, ..vibration };
    let before = plain.columns(&residuals);
    let tuning = Tuning::of(vec![vec![1.0004], vec![0.9997], vec![1.0]]);
    let tuned = Element { tuning, ..plain.clone() };
    let fitted = fit(&residuals.alone(), vec![tuned.clone()]).unwrap();
    assert_eq!(fitted.elements[0].tuning, tuned.tuning);
    assert_eq!(plain.columns(&residuals), before);
    // Sine and cosine of each run: those of the third, which is not tuned, are the same.
    let of_tuned = tuned.columns(&residuals);
    assert_ne!(of_tuned[..4], before[..4]);
    assert_eq!(of_tuned[4..], before[4..]);
}

/// A ball that drifts while the second of three programs began twenty seconds earlier than its log tells: with a pause that hides it
/// that is found, and the time constant stays what it is.
#[test]
fn a_drift_tells_when_a_program_began() {
    const EARLIER_S: f64 = 20.0;
    let truth = element("drift:on=EYt,time_constant_s=300");
    let began = Earlier::of(vec![vec![0.0], vec![EARLIER_S], vec![0.0]]);
    let late = Element { earlier: began, ..truth.clone() };
    let put_in = |hidden_s: f64| {
        let mut noise = residuals(3, white(4, NOISE_MM));
        for repeat in &mut noise.repeats {
            repeat.runs[0].began_sigma_s = hidden_s;
        }
        let moved = late.columns(&noise)[0].clone().times(0.1);
        noise.plus(&moved)
    };
    let off = |fitted: &Fitted| {
        let inner = fitted.inner_index(0).unwrap();
        let sigma = NOISE_MM * fitted.inverse[(inner, inner)].sqrt();
        (fitted.elements[0].free().unwrap() - truth.free().unwrap()) / sigma
    };
    let hidden = put_in(10.0);
    let told = fit(&hidden.alone(), vec![truth.clone()]).unwrap();
    let found_s = |told: &Fitted| {
        let earlier = &told.elements[0].earlier;
        earlier.in_s(1, 0) - 0.5 * (earlier.in_s(0, 0) + earlier.in_s(2, 0))
    };
    assert!((found_s(&told) - EARLIER_S).abs() < 1.0, "{}", found_s(&told));
    assert!(off(&told).abs() < 3.0, "{}", off(&told));
    // Without the last one it stays where it was among them.
    let without = fit_to(&hidden.alone(), told.elements.clone(), &[true, true, false]).unwrap();
    assert!((found_s(&without) - EARLIER_S).abs() < 1.0, "{}", found_s(&without));
    // A program whose beginning is known did not begin otherwise.
    let known = put_in(0.0);
    let known = fit(&known.alone(), vec![truth.clone()]).unwrap();
    assert!(!known.elements[0].earlier.tells());
}
