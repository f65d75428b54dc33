//! How the control drove, as far as the log tells.

use serde::Serialize;

use crate::align::Alignment;
use crate::identify::Estimate;
use crate::machine::Axis;
use crate::model::HeldEffect;
use crate::report::text::numbers::finite;

/// How the control drove, as far as the log tells.
#[allow(clippy::struct_field_names)] // The unit belongs to the names of the file's keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ControlResult {
    /// Time constant with which all slides followed the program alike, ms.
    pub following_ms: f64,
    /// Its standard deviation, ms.
    pub following_sigma_ms: Option<f64>,
    /// By which share the control rounded the corners of chords out, and its standard deviation, %; `None` where there are none.
    pub rounded_percent: Option<[f64; 2]>,
    /// How much later than the mean of those that moved X, Y and Z followed, ms.
    pub later_ms: [f64; 3],
    /// Standard deviations of that, ms.
    pub later_sigma_ms: [f64; 3],
    /// What a standstill between two arcs took beyond its dwell, on average, ms; `None` where there was none.
    pub standstill_longer_ms: Option<f64>,
    /// The longest of them, ms.
    pub standstill_longest_ms: Option<f64>,
}

impl ControlResult {
    /// From the time map of a run and the following errors that were found or are terms of the model: what these took over
    /// the map has no more.
    pub(super) fn of(
        alignment: &Alignment,
        estimates: &[Estimate],
        held: &[HeldEffect],
        run: usize,
    ) -> Self {
        let map = &alignment.time_map;
        let found: Vec<&HeldEffect> = held.iter().filter(|effect| effect.is_in(run)).collect();
        let of = |axis: Option<Axis>| -> f64 {
            let found_s = found.iter().filter_map(|of| of.follows_later_s(axis));
            let named =
                estimates.iter().filter(|e| axis.is_some() && e.parameter.id.delays() == axis);
            found_s.chain(named.map(|estimate| estimate.value)).fold(0.0, |sum, s| sum + s)
        };
        let moving = alignment.moving;
        let own_s = Axis::ALL.map(|axis| if moving[axis.index()] { of(Some(axis)) } else { 0.0 });
        let count = moving.iter().filter(|moves| **moves).count().max(1) as f64;
        let mean_own_s = own_s.iter().sum::<f64>() / count;
        let later_s = Axis::ALL.map(|axis| {
            let k = axis.index();
            map.delays_s[k] + if moving[k] { own_s[k] - mean_own_s } else { 0.0 }
        });
        // What is not known of a term of the model, each against the mean.
        let sigma_s = Axis::ALL.map(|axis| {
            let named = estimates.iter().filter_map(|e| Some((e.parameter.id.delays()?, e.sigma)));
            let moved = named.filter(|(of, _)| moving[of.index()] && moving[axis.index()]);
            let share = |of: Axis| f64::from(u8::from(of == axis)) - 1.0 / count;
            let own_s = moved.fold(0.0_f64, |sum_s, (of, s)| sum_s.hypot(share(of) * s));
            map.delay_sigmas_s[axis.index()].hypot(own_s)
        });
        let stood = map.breaks().iter().zip(map.stood_s()).filter(|(at, _)| !at.operator);
        let stood_s: Vec<f64> = stood.filter_map(|(_, stood_s)| stood_s).collect();
        let mean_s = stood_s.iter().sum::<f64>() / stood_s.len().max(1) as f64;
        // Of times that do not tell chords nothing is known of their corners.
        let rounded = alignment.rounds_chords() && map.rounded_sigma > 0.0;
        let ms = |s: f64| s * 1e3 + 0.0;
        Self {
            following_ms: ms(map.following_s + of(None)),
            following_sigma_ms: finite(ms(map.following_sigma_s)),
            rounded_percent: rounded
                .then(|| [map.rounded, map.rounded_sigma].map(|share| 100.0 * share)),
            later_ms: later_s.map(ms),
            later_sigma_ms: sigma_s.map(ms),
            standstill_longer_ms: (!stood_s.is_empty()).then(|| ms(mean_s)),
            standstill_longest_ms: stood_s.iter().copied().reduce(f64::max).map(ms),
        }
    }
}
