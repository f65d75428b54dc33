//! Which effects there are: forward selection with replacement.

use rayon::prelude::*;

use super::data::Data;
use super::element::Element;
use super::joint::{self, Fitted};
use super::noise::Noise;
use super::screen::{Candidate, Screen};

/// More effects than this are not looked for at once.
const MOST_EFFECTS: usize = 5;
/// Candidates that are looked at closely.
const CLOSELY: usize = 10;
/// And only those that explain at least this share of what the best one does.
const WORTH_A_LOOK: f64 = 0.3;
/// An effect must gain this many times what chance gives an amplitude: five sigma, and the search.
const BEYOND_CHANCE: f64 = 60.0;
/// And be this large against the noise of a reading, rms: what is smaller nobody misses.
const WORTH_NAMING: f64 = 0.1;

/// A candidate after a closer look.
#[derive(Debug, Clone)]
pub(super) struct Tried {
    pub(super) fitted: Fitted,
    /// Gain less what its numbers gain by chance, mm².
    pub(super) score_mm2: f64,
}

pub(super) fn closely(data: &Data, candidates: Vec<Candidate>, noise: &Noise) -> Vec<Tried> {
    let mut candidates = candidates;
    candidates.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
    let best = candidates.first().map_or(0.0, |c| c.gain_mm2);
    candidates.retain(|c| c.gain_mm2 > WORTH_A_LOOK * best);
    candidates.truncate(CLOSELY);
    let mut tried: Vec<Tried> = candidates
        .into_par_iter()
        .filter_map(|candidate| {
            let fitted = joint::fit(data, vec![candidate.element])?;
            let numbers = fitted.columns.len() as f64;
            let score_mm2 = fitted.gain_mm2 - 2.0 * numbers * noise.long_run_mm2;
            Some(Tried { fitted, score_mm2 })
        })
        .collect();
    tried.sort_by(|a, b| b.score_mm2.total_cmp(&a.score_mm2));
    tried
}

/// The smallest score that counts, mm².
pub(super) fn threshold_mm2(data: &Data, noise: &Noise) -> f64 {
    let chance = BEYOND_CHANCE * noise.long_run_mm2;
    chance.max(WORTH_NAMING * WORTH_NAMING * noise.variance_mm2 * data.samples() as f64)
}

/// Effects, one after the other, until none passes.
pub(super) fn forward(data: &mut Data, screen: &mut Screen) -> Option<Fitted> {
    let mut chosen: Option<Fitted> = None;
    for _ in 0..MOST_EFFECTS {
        let start = std::time::Instant::now();
        let noise = Noise::of(data);
        let candidates = screen.candidates(data);
        let t1 = start.elapsed();
        let tried = closely(data, candidates, &noise);
        let n = data.samples() as f64;
        eprintln!("screen {:?} closely {:?}; left {:.4} um, noise lr {:.4} um", t1, start.elapsed(), 1e3*(data.squares_mm2()/n).sqrt(), 1e3*noise.long_run_mm2.sqrt());
        for t in tried.iter().take(6) {
            eprintln!("   {} gain {:.4} um seen {:.4} a {:?}", t.fitted.elements[0].shape().map_or(String::new(), |s| s.name()), 1e3*(t.fitted.gain_mm2.max(0.0)/n).sqrt(), t.fitted.seen, t.fitted.amplitudes);
        }
        let Some(best) = tried.into_iter().next() else { break };
        if best.score_mm2 < threshold_mm2(data, &noise) {
            break;
        }
        let elements: Vec<Element> = chosen
            .iter()
            .flat_map(|fitted| fitted.elements.clone())
            .chain(best.fitted.elements)
            .collect();
        data.accept(&[]);
        let Some(all) = joint::fit(data, elements) else { break };
        data.accept(&all.columns);
        screen.renew(data);
        chosen = Some(all);
    }
    chosen
}
