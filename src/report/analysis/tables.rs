//! Tables of the machine: what people ask, single coefficients, and what they are.

use super::cautions::DETERMINED;
use super::facts::Analysis;
use super::means::MeanResult;
use super::{place, terminal};
use crate::report::text::numbers::{fixed, signed, typeset};
use crate::report::text::units::{engineering, row_decimals};
use crate::report::text::words::fine;

/// A row of the table of coefficients.
pub(super) struct CoefficientRow {
    pub(super) name: String,
    pub(super) mean: String,
    pub(super) sigma: String,
    pub(super) deviation: String,
    pub(super) before: String,
    pub(super) unit: &'static str,
    pub(super) observed: String,
    pub(super) determined: bool,
}

pub(super) fn shown(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".into(), |value| typeset(&fixed(value, decimals)))
}

/// Two columns of the page, the first with the odd row.
pub(super) fn coefficients(analysis: &Analysis) -> Vec<Vec<CoefficientRow>> {
    let half = analysis.over_repeats.len().div_ceil(2).max(1);
    let halves = analysis.over_repeats.chunks(half);
    let row = |mean| coefficient(mean, analysis.mean_before(&mean.name));
    halves.map(|means| means.iter().map(row).collect()).collect()
}

fn coefficient(mean: &MeanResult, before: Option<&MeanResult>) -> CoefficientRow {
    let unit = engineering(mean.unit);
    let determined = mean.observed >= DETERMINED;
    let value = mean.mean * unit.factor;
    let sigma = mean.sigma.filter(|_| determined).map(|s| s * unit.factor);
    let decimals = row_decimals(value, sigma);
    CoefficientRow {
        name: mean.name.clone(),
        mean: shown(Some(value), decimals),
        sigma: shown(sigma, decimals),
        deviation: shown(mean.deviation.map(|d| d * unit.factor), decimals),
        before: shown(before.map(|before| before.mean * unit.factor), decimals),
        unit: unit.fine,
        observed: terminal::observed(mean.observed),
        determined,
    }
}

/// A value that the data do not determine is told as such instead of with a sigma.
fn spread(value: Option<f64>, decimals: usize, observed: f64) -> String {
    if observed < DETERMINED {
        return format!("only {} observed", terminal::observed(observed));
    }
    shown(value, decimals)
}

/// What people ask, with both uncertainties, where the machine was described where it was measured.
pub(super) fn at_the_place(analysis: &Analysis) -> Vec<[String; 7]> {
    let (seen, _) = place::seen(&analysis.at_the_place);
    seen.into_iter()
        .filter(|_| analysis.is_local())
        .map(|result| {
            let places = place::decimals(result.noise.unwrap_or(0.0));
            [
                result.quantity.clone(),
                typeset(&signed(result.value, places)),
                shown(result.noise, places),
                shown(result.all, places),
                shown(result.deviation, places),
                fine(&format!(" {}", result.unit)).trim().to_owned(),
                earlier(analysis.place_before(&result.quantity).map(|b| b.value), places),
            ]
        })
        .collect()
}

/// A signed value as it was before anything was found.
fn earlier(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".into(), |value| typeset(&signed(value, decimals)))
}

pub(super) fn squareness(analysis: &Analysis) -> Vec<[String; 6]> {
    let before = analysis.errors_before();
    let rows = analysis.machine_errors.squareness.iter();
    rows.map(|s| {
        [
            format!("{} ({}, {})", s.axes, s.name, s.symbol),
            typeset(&signed(s.angle_minus_90_um_m, 2)),
            typeset(&signed(s.angle_minus_90_arcsec, 2)),
            spread(s.sigma_um_m, 2, s.observed),
            shown(s.deviation_um_m, 2),
            earlier(before.and_then(|b| b.angle_um_m(&s.name)), 2),
        ]
    })
    .collect()
}

pub(super) fn scale(analysis: &Analysis) -> Vec<[String; 5]> {
    let before = analysis.errors_before();
    let rows = analysis.machine_errors.scale.iter();
    rows.map(|s| {
        [
            s.name.clone(),
            typeset(&signed(s.value_um_m, 2)),
            spread(s.sigma_um_m, 2, s.observed),
            shown(s.deviation_um_m, 2),
            earlier(before.and_then(|b| b.scale_um_m(&s.name)), 2),
        ]
    })
    .collect()
}

pub(super) fn reversal(analysis: &Analysis) -> Vec<[String; 6]> {
    let errors = &analysis.machine_errors;
    let before = analysis.errors_before();
    let displacements = errors.reversal.iter().map(|r| {
        [
            format!("{}, {}", r.name, r.kind),
            format!("{} µm", typeset(&signed(r.step_um, 3))),
            format!("{} µm", typeset(&signed(r.coefficient_um, 3))),
            spread(r.sigma_um, 3, r.observed),
            shown(r.deviation_um, 3),
            earlier(before.and_then(|b| b.step_um(&r.name)), 3),
        ]
    });
    let rotations = errors.angular_hysteresis.iter().map(|h| {
        [
            format!("{}, angular", h.name),
            format!("{} µrad", typeset(&signed(h.step_urad, 2))),
            format!("{} µrad", typeset(&signed(h.coefficient_urad, 2))),
            spread(h.sigma_urad, 2, h.observed),
            shown(h.deviation_urad, 2),
            earlier(before.and_then(|b| b.step_urad(&h.name)), 2),
        ]
    });
    displacements.chain(rotations).collect()
}
