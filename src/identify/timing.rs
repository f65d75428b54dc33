//! How a sample's time enters the fit.

use super::fit::RunInput;
use crate::align::{Place, Sample};
use crate::machine::Pose;
use crate::model::Model;

/// Offsets that are known to this, s, are inside the catch of the facets: a chord of a usual program
/// takes some 80 ms, and rounding gives every one its own height.
pub(super) const FACET_S: f64 = 0.02;
/// Farther than this from the smooth fit no facet is looked for, s.
const FARTHEST_S: f64 = 0.5;
/// Step of the search, s.
const SEARCH_STEP_S: f64 = 0.01;

/// What of the path a residual is taken against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// The commanded path with its chords and its rounding.
    Full,
    /// The sphere: chords and rounding count as noise, because a wrong time would misread them.
    Smooth,
}

/// So many samples of a run bring its offsets within reach of the facets; more only take longer.
const ENOUGH: usize = 20_000;

/// Every how many samples one is looked at.
pub(super) fn stride(detail: Detail, samples: usize) -> usize {
    match detail {
        Detail::Full => 1,
        Detail::Smooth => samples.div_ceil(ENOUGH).max(1),
    }
}

/// A sample as the fit sees it.
pub(super) struct View {
    /// Measured minus predicted, mm.
    pub(super) residual_mm: f64,
    /// Change of the predicted deviation with time, mm/s.
    pub(super) speed_mm_s: f64,
}

/// Residual and speed of a sample.
///
/// The speed is taken with the senses held: the step at a reversal is no slope.
pub(super) fn view(
    model: &Model,
    values: &[f64],
    run: &RunInput,
    sample: &Sample,
    detail: Detail,
    nominal_mm: f64,
) -> View {
    let coincidence_mm = run.alignment.coincidence_mm();
    let predicted = |pose: &Pose| {
        let length_mm = model.length_mm(values, pose, run.mounting);
        match detail {
            Detail::Full => length_mm - nominal_mm,
            Detail::Smooth => length_mm - (pose.position_mm - coincidence_mm).norm(),
        }
    };
    // Where facets do not count, long enough to see over them; where they do, short against one, but not
    // so short that a vertex between this step's time and the next turns the slope at once.
    let step_s = match detail {
        Detail::Full => 2e-3,
        Detail::Smooth => 0.2,
    };
    let beside = |sign: f64| {
        let state = run.alignment.trajectory.at(sample.program_s + sign * step_s);
        predicted(&Pose { position_mm: state.position_mm, sense: sample.pose.sense })
    };
    View {
        residual_mm: sample.deviation_mm - predicted(&sample.pose),
        speed_mm_s: (beside(1.0) - beside(-1.0)) / (2.0 * step_s),
    }
}

/// Moves the offset of every coarsely known leg to where the facets of the commanded path fit best.
pub(super) fn find_facets(model: &Model, values: &[f64], run: &mut RunInput, nominal_mm: f64) {
    let stride = stride(Detail::Smooth, run.alignment.samples.len());
    for leg in run.alignment.legs() {
        let sigma_s = run.alignment.time_map.offset_sigmas_s[leg];
        if sigma_s < 0.1 * FACET_S {
            continue;
        }
        let readings: Vec<(f64, f64)> = run
            .alignment
            .samples
            .iter()
            .step_by(stride)
            .filter(|s| s.leg == leg && matches!(s.place, Place::Arc(_)))
            .map(|sample| (sample.program_s, sample.deviation_mm))
            .collect();
        let trajectory = &run.alignment.trajectory;
        // Looked up whole, with the senses: the step at a reversal tells the time better than any facet.
        let misfit = |shift_s: f64| {
            readings
                .iter()
                .map(|&(program_s, deviation_mm)| {
                    let state = trajectory.at(program_s + shift_s);
                    let pose = Pose { position_mm: state.position_mm, sense: state.sense };
                    let length_mm = model.length_mm(values, &pose, run.mounting);
                    (deviation_mm - (length_mm - nominal_mm)).powi(2)
                })
                .sum::<f64>()
        };
        let reach = ((6.0 * sigma_s).clamp(0.1, FARTHEST_S) / SEARCH_STEP_S).ceil() as i32;
        let best = (-reach..=reach)
            .map(|k| f64::from(k) * SEARCH_STEP_S)
            .map(|shift_s| (shift_s, misfit(shift_s)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0.0, |(shift_s, _)| shift_s);
        run.alignment.time_map.offsets_s[leg] -= best;
        run.alignment.time_map.offset_sigmas_s[leg] = SEARCH_STEP_S;
    }
}
