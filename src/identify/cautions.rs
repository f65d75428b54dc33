//! What speaks against a fit that came out all the same.

use super::input::Options;
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
    options: &Options,
    settled: bool,
) -> Vec<String> {
    let of_run = |run: &IdentifiedRun| {
        step(&run.name, &run.alignment).or_else(|| short(&run.name, &run.alignment))
    };
    let mut cautions: Vec<String> = runs.iter().filter_map(of_run).collect();
    let far_off = far_off(runs);
    if far_off > 0 && options.loss == Loss::Off {
        cautions.push(format!(
            "{far_off} reading(s) lie farther off than {FAR_OFF:.0} times what is usual here and pull the fit with all their weight; `loss = \"huber\"` or `\"tukey\"` in `[identify]` takes it from them"
        ));
    }
    // Where times are wrong altogether, neighbours differ by more than chance too.
    let chance_mm = noise.innovation_sigma().min(options.noise_mm);
    if rms_mm > UNEXPLAINED_MM && !settled {
        cautions.push(format!(
            "the fit has not come to rest and leaves {:.2} um rms: a log may be of another program",
            1e3 * rms_mm
        ));
    } else if rms_mm > UNEXPLAINED_MM && rms_mm > PATTERN * chance_mm {
        cautions.push(format!(
            "the model leaves {:.2} um rms, which is {:.0} times what one reading differs from the next by chance: a log may be of another program, or the machine does what no chosen term describes",
            1e3 * rms_mm,
            rms_mm / chance_mm
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

/// A standstill that seems shorter than its program: no control does that.
fn short(run: &str, alignment: &Alignment) -> Option<String> {
    let map = &alignment.time_map;
    let stood = map.breaks().iter().zip(map.stood_s()).filter(|(at, _)| !at.operator);
    let known = stood.filter_map(|(at, stood_s)| Some((at.program_s, stood_s?)));
    let (program_s, stood_s) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let after = alignment.sections.iter().position(|section| section.end_s > program_s)?;
    let before = alignment.sections.get(after.checked_sub(1)?)?;
    (stood_s < -STEP_S).then(|| {
        format!(
            "{run}: between `{}` and `{}`, {:.1} s are missing from the log",
            before.name, alignment.sections[after].name, -stood_s
        )
    })
}

fn far_off(runs: &[IdentifiedRun]) -> usize {
    let used =
        || runs.iter().flat_map(IdentifiedRun::used).map(|record: &Record| record.residual_mm);
    let Some(scale) = solve::robust_scale(&mut used().collect::<Vec<_>>()) else { return 0 };
    used().filter(|residual| residual.abs() > FAR_OFF * scale).count()
}
