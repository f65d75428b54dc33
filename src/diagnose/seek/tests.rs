//! What a look over bins and moments finds, against the columns themselves.

use super::channel::{Channel, Worths};
use super::screen::gathered;
use super::{curves, knock};
use crate::machine::Axis;
use crate::model::{CAUSES, Seat, Shape, Start, Variable};
use crate::residual::bench::{element, residuals, white};
use crate::residual::{Beside, Element, Owner, Residuals, System, fit};

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
