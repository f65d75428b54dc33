//! An analysis as it is, and as it is written and read back.

use nalgebra::Vector3;

use super::{ErrorModel, Field, Row, Stored};
use crate::identify::{Answer, Asked, Campaign, Estimate, Failure, ask};
use crate::machine::{Axis, Machine, Pose};
use crate::plan::Test;

fn planar() -> (Test, Machine, Campaign) {
    let test = Test::read("tests/data/planar250/test.toml".as_ref()).unwrap();
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    (test, machine, campaign)
}

#[test]
fn what_is_read_back_displaces_the_tool_as_what_was_written() {
    let (test, machine, campaign) = planar();
    let errors = ErrorModel::of(&test, &machine, &campaign, None).unwrap();
    let text = serde_json::to_string(&Stored::of(&errors)).unwrap();
    let stored: Stored = serde_json::from_str(&text).unwrap();
    let again = stored.of_machine(machine.clone()).unwrap();
    let tool_mm = errors.mountings[0].1.tool_ball_mm + Vector3::new(0.0, 0.0, -35.0);
    let [field, read] = [&errors, &again].map(|of| Field::new(of, tool_mm).unwrap());
    let beside = Vector3::new(0.4, -0.7, 0.0).component_mul(&errors.frame.reach_mm);
    let pose =
        Pose { position_mm: errors.frame.middle_mm + beside, sense: Vector3::new(1.0, -1.0, 1.0) };
    let (a, b) = (field.displacement(&pose), read.displacement(&pose));
    assert!(a.error_mm.norm() > 1e-4 && (a.error_mm - b.error_mm).norm() < 1e-12);
    for (axis, (a, b)) in Axis::ALL.into_iter().zip(a.rows.iter().zip(&b.rows)) {
        let (a, b) = (field.sigmas(a), read.sigmas(b));
        // Of what is across it the plane says nothing, and so nothing of it scatters.
        assert_eq!(a.noise > 0.0, axis != Axis::Z);
        assert!((a.noise - b.noise).abs() <= 1e-9 * a.noise);
        assert!(a.all > a.noise && (a.all - b.all).abs() < 1e-9 * a.all);
    }
}

#[test]
fn a_reversal_is_as_uncertain_as_where_it_is_asked_for() {
    let (test, machine, campaign) = planar();
    let errors = ErrorModel::of(&test, &machine, &campaign, None).unwrap();
    let field = Field::new(&errors, errors.mountings[0].1.tool_ball_mm).unwrap();
    assert_eq!(campaign.repeats.len(), 2);
    for axis in [Axis::X, Axis::Y] {
        let each = campaign.repeats.iter().enumerate().map(|(k, repeat)| {
            let model = campaign.model(&test, &machine, k).unwrap();
            let values = repeat.values();
            let known = repeat.known(&values);
            ask(&model, &errors.frame, &known, &[Asked::Reversal(axis)]).remove(0)
        });
        let [a, b] = <[Answer; 2]>::try_from(each.collect::<Vec<_>>()).unwrap();
        // Noise is another one every time; what is open is the same.
        let noise = 0.5 * a.noise.hypot(b.noise);
        let open = |of: &Answer| of.all.unwrap().powi(2) - of.noise.powi(2);
        let all = (noise.powi(2) + 0.5 * (open(&a) + open(&b))).sqrt();
        let value = 0.5 * (a.value + b.value);
        let at = |sense: f64| {
            let sense = sense * Vector3::ith(axis.index(), 1.0);
            field.displacement(&Pose { position_mm: errors.frame.middle_mm, sense })
        };
        let (plus, minus) = (at(1.0), at(-1.0));
        let step_mm = (plus.error_mm - minus.error_mm)[axis.index()];
        assert!((step_mm - value).abs() < 1e-6, "{step_mm} {value}");
        let mut row = Row::zero(field.width());
        row.add(&plus.rows[axis.index()], 1.0);
        row.add(&minus.rows[axis.index()], -1.0);
        let sigmas = field.sigmas(&row);
        assert!((sigmas.noise / noise - 1.0).abs() < 0.01, "{sigmas:?} {noise}");
        assert!((sigmas.all / all - 1.0).abs() < 0.01, "{sigmas:?} {all}");
    }
}

/// A reversal that is another one in the second repeat is told, with how far it moved in its noise.
#[test]
fn a_machine_that_changed_between_its_repeats_is_told() {
    let (test, machine, mut campaign) = planar();
    let errors = |campaign: &Campaign| ErrorModel::of(&test, &machine, campaign, None).unwrap();
    assert_eq!(errors(&campaign).changed, None);
    let of_x = |of: &Estimate| of.parameter.name == "TXXb";
    let moved_mm = 0.01;
    let reversal = campaign.repeats[1].estimates.iter_mut().find(|of| of_x(of)).unwrap();
    reversal.value += moved_mm;
    let changed = errors(&campaign);
    let times = changed.changed.unwrap();
    let squares: f64 = campaign
        .repeats
        .iter()
        .map(|repeat| {
            let of = repeat.estimates.iter().find(|of| of_x(of)).unwrap();
            of.sigma.powi(2)
        })
        .sum();
    let expected = moved_mm / 2_f64.sqrt() / (0.5 * squares).sqrt();
    assert!((times / expected - 1.0).abs() < 0.1, "{times} {expected}");
    let text = serde_json::to_string(&Stored::of(&changed)).unwrap();
    let stored: Stored = serde_json::from_str(&text).unwrap();
    assert_eq!(stored.of_machine(machine.clone()).unwrap().changed, Some(times));
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    let (test, machine, campaign) = planar();
    let errors = ErrorModel::of(&test, &machine, &campaign, None).unwrap();
    let good = serde_json::to_value(Stored::of(&errors)).unwrap();
    for (pointer, value, told) in [
        ("/reach_mm/0", serde_json::json!(-5.0), "`middle_mm` and `reach_mm`"),
        ("/parameters/0/name", serde_json::json!("TXX9"), "its parameters"),
        ("/parameters/0/value", serde_json::json!(1e9), "it goes from -1000 to 1000"),
        ("/noise_covariance/0", serde_json::json!(-1.0), "it goes from 0"),
        ("/open_covariance/1", serde_json::json!(1.0), "a correlation beyond 1"),
        ("/noise_covariance", serde_json::json!([1.0]), "no lower triangle"),
        ("/mountings", serde_json::json!([]), "no `mountings`"),
        ("/terms/0", serde_json::json!("gravity"), "gravity"),
        ("/changed", serde_json::json!(-6.0), "`changed` is -6; it goes from 0"),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).unwrap() = value;
        let stored: Stored = serde_json::from_value(bad).unwrap();
        let why = stored.of_machine(machine.clone()).unwrap_err();
        assert!(why.contains(told), "{pointer}: {why}");
    }
}
