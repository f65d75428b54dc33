//! What a look over bins and moments finds, against the columns themselves.

use super::channel::{Channel, Worths};
use super::screen::{gathered, of_channel};
use super::{curves, knock, vibration};
use crate::diagnose::thresholds::threshold_mm2;
use crate::machine::Axis;
use crate::model::{Averaged, CAUSES, Reversal, Seat, Shape, Start, Variable};
use crate::residual::bench::{element, residuals, white};
use crate::residual::{Beside, Element, Owner, Residuals, System, Tuning, fit};

const NOISE_MM: f64 = 1.5e-4;

/// Residuals of three repeats with one of an element's columns put in.
fn with(element: &Element, amplitude_mm: f64) -> Residuals {
    let residuals = residuals(3, white(11, NOISE_MM));
    let mut sum = residuals.zeros();
    sum.add(amplitude_mm, &element.columns(&residuals)[0]);
    residuals.plus(&sum)
}

/// What the columns of an element explain.
fn gain_mm2(system: System, element: &Element, beside: &Beside) -> f64 {
    let columns = element.columns(beside.residuals);
    system.into_anywhere().gain_mm2(&columns, beside).unwrap()
}

#[test]
fn a_channel_explains_what_the_columns_explain() {
    let other = element("drift:on=EYt,time_constant_s=100");
    for period_mm in [12.0, 25.0, 60.0] {
        let wave = element(&format!("cyclic:on=EXX,period_mm={period_mm}"));
        let residuals = with(&wave, 5e-4);
        let position = Variable::Position(Axis::X);
        let seat = Seat::parse("EXX").unwrap();
        let worths = Worths::of(&residuals, [seat].into());
        let channels = Channel::gather(&worths, position, false, &[seat]);
        for beside in [residuals.alone(), residuals.beside(&other.columns(&residuals))] {
            let look = channels[0].beside(&beside);
            let turn = |at: f64| at / period_mm * std::f64::consts::TAU;
            let sine = look.centers.iter().map(|at| turn(*at).sin()).collect();
            let cosine = look.centers.iter().map(|at| turn(*at).cos()).collect();
            let binned = look.explained(&[sine, cosine], 1e-6).unwrap();
            let exact = System::of(&beside, &wave);
            assert!((binned.share_outside / exact.share_outside() - 1.0).abs() < 0.02);
            // Half a millimetre of a bin is a fraction of a wave: sinc² of it.
            let gain_mm2 = gain_mm2(exact, &wave, &beside);
            let most = (0.25 * std::f64::consts::TAU / period_mm).powi(2);
            assert!((binned.gain_mm2 / gain_mm2 - 1.0).abs() < most + 1e-3, "{period_mm} mm");
        }
    }
}

/// Before a slide has ever reversed an effect is what it is long after. A channel that left these samples out explained a thirtieth of a
/// pre-sliding of which the fits follow nearly all.
#[test]
fn an_effect_is_looked_for_before_its_slide_has_reversed_too() {
    let pre_sliding = element("pre-sliding:on=EYX,distance_mm=12");
    let mut residuals = residuals(1, white(5, NOISE_MM));
    let repeat = &mut residuals.repeats[0];
    let reverses = repeat.samples.len() / 4;
    for (k, sample) in repeat.samples.iter_mut().enumerate().skip(reverses) {
        let ago = (k - reverses) as f64;
        sample.situation.motion.reversals[0] =
            Some(Reversal { ago_s: 0.1 * ago, ago_mm: 0.5 * ago });
    }
    let put_in = pre_sliding.columns(&residuals);
    let mut effect = residuals.zeros();
    effect.add(5e-3, &put_in[0]);
    let residuals = residuals.plus(&effect);
    let alone = residuals.alone();
    let (seat, variable) = (Seat::parse("EYX").unwrap(), Variable::WaySinceReversal(Axis::X));
    let channels = Channel::gather(&Worths::of(&residuals, [seat].into()), variable, true, &[seat]);
    let found = of_channel(&channels[0].beside(&alone), &residuals.middle_mm);
    let [only] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(only.element.shape().unwrap().cause, pre_sliding.shape().unwrap().cause);
    let exact = gain_mm2(System::of(&alone, &only.element), &only.element, &alone);
    assert!((only.gain_mm2 / exact - 1.0).abs() < 0.02, "{} of {exact}", only.gain_mm2);
}

/// Also where a run has a second left.
#[test]
fn a_knock_is_found_in_its_run_at_its_moment() {
    let ends_s = residuals(1, || 0.0).repeats[0].samples.last().unwrap().elapsed_s();
    for (moment_s, size_mm) in [(70.0, 2e-3), (ends_s - 0.95, 10e-3)] {
        let mut step = element(&format!("knock:on=EXt,moment_s={moment_s}"));
        step.owner = Owner::One { repeat: 1, run: 0 };
        let residuals = with(&step, size_mm);
        let alone = residuals.alone();
        let cause = step.shape().unwrap().cause;
        let found = knock::candidates(cause, &alone);
        let best = found.iter().max_by(|a, b| a.gain_mm2.total_cmp(&b.gain_mm2)).unwrap();
        assert_eq!(best.element.owner, step.owner);
        let shape = best.element.shape().unwrap();
        assert_eq!(shape.seat, Seat::parse("EXt").unwrap());
        assert!((shape.inner.unwrap() - moment_s).abs() < 0.11, "{moment_s}: {shape:?}");
        // The sums back from the end of the run are those of the column.
        let exact = fit(&alone, vec![best.element.clone()]).unwrap();
        assert!((best.gain_mm2 / exact.gain_mm2 - 1.0).abs() < 1e-4);
        let sigma_mm = NOISE_MM * exact.inverse[(0, 0)].sqrt();
        assert!((exact.amplitudes[0][0] - size_mm).abs() < 4.0 * sigma_mm);
    }
}

/// Of a ball that stood off for twenty seconds neither step shows by itself; of one that was knocked once there is no second one.
#[test]
fn moves_there_and_back_are_found_together() {
    let step = |moment_s: f64| {
        let mut step = element(&format!("knock:on=EXt,moment_s={moment_s}"));
        step.owner = Owner::One { repeat: 1, run: 0 };
        step
    };
    let mut residuals = with(&step(70.0), 8e-3);
    let mut back = residuals.zeros();
    back.add(-8e-3, &step(90.0).columns(&residuals)[0]);
    let cause = step(70.0).shape().unwrap().cause;
    let once = knock::pair(cause, &residuals.alone(), threshold_mm2(&residuals.alone()));
    assert!(once.is_none(), "{once:?}");
    residuals = residuals.plus(&back);
    let alone = residuals.alone();
    let both = knock::pair(cause, &alone, threshold_mm2(&alone)).unwrap();
    for (found, moment_s) in both.elements.iter().zip([90.0, 70.0]) {
        let shape = found.shape().unwrap();
        assert_eq!((found.owner, shape.seat), (step(0.0).owner, Seat::parse("EXt").unwrap()));
        assert!((shape.inner.unwrap() - moment_s).abs() < 0.11, "{moment_s}: {shape:?}");
    }
    for (k, size_mm) in [-8e-3, 8e-3].into_iter().enumerate() {
        let sigma_mm = NOISE_MM * both.inverse[(k, k)].sqrt();
        assert!((both.amplitudes[k][0] - size_mm).abs() < 4.0 * sigma_mm);
    }
}

/// Of means of five readings a slow vibration gains as much as its aliases, of which the means have nothing.
#[test]
fn a_vibration_is_looked_for_where_means_have_it() {
    let vibration = element("vibration:on=EXt,frequency_hz=0.37");
    let mut residuals = residuals(2, white(7, NOISE_MM));
    for sample in residuals.repeats.iter_mut().flat_map(|repeat| &mut repeat.samples) {
        sample.situation.motion.averaged = Averaged { readings: 5.0, period_s: 0.02 };
    }
    let mut effect = residuals.zeros();
    effect.add(1e-3, &vibration.columns(&residuals)[0]);
    let residuals = residuals.plus(&effect);
    let cause = vibration.shape().unwrap().cause;
    let found = vibration::candidates(cause, &residuals.alone(), &Tuning::default(), 0.0);
    assert!(found.iter().all(|found| found.element.possible(&residuals)), "{found:?}");
    let shape = found[0].element.shape().unwrap();
    assert_eq!(shape.seat, Seat::parse("EXt").unwrap());
    assert!((shape.inner.unwrap() - 0.37).abs() < 2e-3, "{shape:?}");
}

#[test]
fn a_curve_follows_what_no_cause_describes() {
    // A wave this long is a smooth curve, too.
    let wave = element("cyclic:on=EXX,period_mm=90");
    let residuals = with(&wave, 1e-3);
    let alone = residuals.alone();
    let seats = [Seat::parse("EXX").unwrap(), Seat::parse("EYY").unwrap()];
    let worths = Worths::of(&residuals, seats.into());
    let channels: Vec<Channel> = [Axis::X, Axis::Y]
        .into_iter()
        .flat_map(|axis| Channel::gather(&worths, Variable::Position(axis), false, &seats))
        .collect();
    let looks: Vec<_> = channels.iter().map(|channel| channel.beside(&alone)).collect();
    let best = curves::best(&alone, &looks, 0.0, &|_| true).unwrap();
    let curve = best.fitted.elements[0].curve().unwrap();
    assert_eq!((curve.seat, curve.variable), (seats[0], Variable::Position(Axis::X)));
    let whole = gain_mm2(System::of(&alone, &wave), &wave, &alone);
    assert!(best.score_mm2 > 0.98 * whole, "{} of {whole}", best.score_mm2);
}

#[test]
fn every_cause_over_a_variable_is_looked_for_on_all_its_seats() {
    let gathered = gathered();
    for cause in CAUSES.iter().filter(|cause| cause.law.is_term()) {
        for seat in cause.seats() {
            let inner = cause.inner(seat);
            assert_eq!(
                inner.is_some(),
                cause.law(seat).inner().is_some(),
                "{} has no such key",
                cause.id
            );
            let over_bins = match inner {
                Some((inner, _)) => !matches!(inner.start, Start::Lines | Start::Moments),
                None => true,
            };
            if let Some(of) =
                (Shape { cause, seat, inner: None }).dependence().filter(|_| over_bins)
            {
                let found = gathered.iter().any(|(variable, with_sense, seats)| {
                    (*variable, *with_sense) == (of.variable, of.with_sense)
                        && seats.contains(&seat)
                });
                assert!(found, "{} on {seat}", cause.id);
            }
        }
    }
}
