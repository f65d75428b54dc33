//! What a fit leaves of its readings, held against chance and against what the machine does.

use super::input::Options;
use super::result::{IdentifiedRun, LittleExplained};
use crate::solve::{self, NoiseModel, Truncation, Tsqr};

/// Residuals that are this many times what neighbouring readings cannot foretell of each other are
/// nearly all pattern ...
const PATTERN: f64 = 5.0;
/// ... and worth a word when they are larger than this, mm.
const UNEXPLAINED_MM: f64 = 1e-3;
/// Two logs of which one is wrong contradict each other, and the least squares leave half of each. An effect that no term
/// describes leaves less: other errors of the machine stand beside it.
const LITTLE: f64 = 0.5;
/// An axis that moves by less than this share of its position stands.
const DEPENDENT: f64 = 1e-9;

/// Whether a fit leaves more than is worth a word.
pub(super) fn is_much(rms_mm: f64) -> bool {
    rms_mm > UNEXPLAINED_MM
}

/// What a fit does not explain.
pub(super) struct Unexplained {
    /// How many times chance it leaves; `None` where that is little more than chance.
    pub(super) beyond_chance: Option<f64>,
    /// The runs of which it explains little, the least first; none where what it leaves is little more than chance.
    pub(super) little: Vec<LittleExplained>,
}

impl Unexplained {
    pub(super) fn of(
        runs: &[IdentifiedRun],
        rms_mm: f64,
        noise: &NoiseModel,
        options: &Options,
    ) -> Self {
        // Where times are wrong altogether, neighbours differ by more than chance too.
        let chance_mm = noise.innovation_sigma().min(options.noise_mm);
        let beyond = is_much(rms_mm) && rms_mm > PATTERN * chance_mm;
        let mut little: Vec<LittleExplained> =
            runs.iter().filter(|_| beyond).filter_map(little_explained).collect();
        // A wrong log spoils the others, too, but less.
        let share = |of: &LittleExplained| of.left_mm / of.by_set_up_mm;
        little.sort_by(|a, b| share(b).total_cmp(&share(a)));
        Self { beyond_chance: beyond.then(|| rms_mm / chance_mm), little }
    }
}

/// Where the balls stand and how long the bar is changes a reading by a number and by another one along each axis, whatever the
/// machine does: `delta = a + b . p` with the position `p` of the slides. What the machine does is what that leaves.
fn little_explained(run: &IdentifiedRun) -> Option<LittleExplained> {
    let mut rows = Tsqr::new(4);
    let mut left_mm2 = 0.0;
    for record in run.used() {
        let at = record.sample.pose.position_mm;
        rows.push(&[1.0, at.x, at.y, at.z], record.sample.deviation_mm);
        left_mm2 += record.residual_mm.powi(2);
    }
    let count = rows.rows() as f64;
    // A plane has no third axis.
    let by_set_up = solve::solve(&rows.finish().ok()?, Truncation::Relative(DEPENDENT)).ok()?;
    let [left_mm, by_set_up_mm] =
        [left_mm2, by_set_up.residual_norm().powi(2)].map(|mm2| (mm2 / count.max(1.0)).sqrt());
    let little = is_much(left_mm) && left_mm > LITTLE * by_set_up_mm;
    little.then(|| LittleExplained { run: run.name.clone(), left_mm, by_set_up_mm })
}
