//! What speaks against a fit that came out all the same.

use super::record::Record;
use super::result::IdentifiedRun;
use crate::align::Alignment;
use crate::solve::Loss;
use crate::solve::{self, NoiseModel};

/// A step of time that shows beyond the resolution of the chords, s.
const STEP_S: f64 = 0.04;
/// Most that a step can be when the clock's tolerance has absorbed it, s, with some to spare.
const REACH_S: f64 = 0.5;
/// Residuals that are this many times what neighbouring readings cannot foretell of each other are
/// nearly all pattern ...
const PATTERN: f64 = 5.0;
/// ... and worth a word when they are larger than this, mm.
const UNEXPLAINED_MM: f64 = 1e-3;
/// In units of the robust scale.
const FAR_OFF: f64 = 10.0;

/// Sentences, each with what was found and what may have caused it; none where nothing was.
pub(super) fn cautions(
    runs: &[IdentifiedRun],
    rms_mm: f64,
    noise: &NoiseModel,
    loss: Loss,
) -> Vec<String> {
    let mut cautions: Vec<String> =
        runs.iter().filter_map(|run| step(&run.name, &run.alignment)).collect();
    let far_off = far_off(runs);
    if far_off > 0 && loss == Loss::Off {
        cautions.push(format!(
            "{far_off} reading(s) lie farther off than {FAR_OFF:.0} times what is usual here and pull the fit with all their weight; `loss = \"huber\"` or `\"tukey\"` in `[identify]` takes it from them"
        ));
    }
    if rms_mm > UNEXPLAINED_MM && rms_mm > PATTERN * noise.innovation_sigma() {
        cautions.push(format!(
            "the model leaves {:.2} um rms, which is {:.0} times what one reading differs from the next by chance: a log may be of another program, or the machine does what no chosen term describes",
            1e3 * rms_mm,
            rms_mm / noise.innovation_sigma()
        ));
    }
    cautions
}

fn step(run: &str, alignment: &Alignment) -> Option<String> {
    let step = alignment.time_step(REACH_S).filter(|step| step.lost_s.abs() > STEP_S)?;
    let name = |index: usize| &alignment.sections[index].name;
    let what =
        if step.lost_s > 0.0 { "are missing from the log" } else { "too many are in the log" };
    Some(format!(
        "{run}: between the middle of `{}` and that of `{}`, {:.2} s {what}; the times of all other arcs are wrong by a part of it",
        name(step.before),
        name(step.after),
        step.lost_s.abs()
    ))
}

fn far_off(runs: &[IdentifiedRun]) -> usize {
    let used =
        || runs.iter().flat_map(IdentifiedRun::used).map(|record: &Record| record.residual_mm);
    let Some(scale) = solve::robust_scale(&mut used().collect::<Vec<_>>()) else { return 0 };
    used().filter(|residual| residual.abs() > FAR_OFF * scale).count()
}
