//! What speaks against a fit that came out all the same.

use super::record::Record;
use super::result::{Identification, IdentifiedRun, LittleExplained};
use super::unexplained;
use crate::align::{Alignment, Slip};
use crate::machine::{Axis, Machine};
use crate::solve;
use crate::solve::Loss;

/// A step of time that shows beyond the resolution of the chords, s.
const STEP_S: f64 = 0.04;
/// And beyond so many standard deviations of how standstills differ, or of how their times are known.
const PLAUSIBLY: f64 = 3.0;
/// Most that a step can be when the clock's tolerance has absorbed it, s, with some to spare.
const REACH_S: f64 = 0.5;
/// A program may touch the end of the travel, and files are rounded, mm.
const BESIDE_MM: f64 = 1.0;
/// A way on an arc is looked at in so many places: of a whole turn of a 300 mm bar its ends are within 0.4 mm of one, less than
/// [`BESIDE_MM`].
const PLACES: usize = 64;
/// In units of the robust scale.
const FAR_OFF: f64 = 10.0;

impl Identification {
    /// What speaks against the result, each in a sentence with what was found and what may have caused it; none where nothing does.
    /// The machine is that of the model, and far-off readings were weighed by this loss.
    pub fn cautions(&self, machine: &Machine, loss: Loss) -> Vec<String> {
        let runs = &self.runs;
        let of_run = |run: &IdentifiedRun| {
            step(&run.name, &run.alignment).or_else(|| short(&run.name, &run.alignment))
        };
        let mut cautions: Vec<String> = runs.iter().filter_map(of_run).collect();
        cautions.extend(runs.iter().find_map(|run| beyond_travel(run, machine)));
        cautions.extend(runs.iter().flat_map(of_log));
        cautions.extend(runs.iter().flat_map(slipped));
        cautions.extend(runs.iter().flat_map(cut_off));
        cautions.extend(runs.iter().filter_map(other_runs));
        if runs.iter().any(IdentifiedRun::holds_pace) {
            cautions.push("where the fit also looks for the feed it does not settle, or takes one that engagement and release of the bar do not allow, and it was held to one that they do: the machine did something in a run that no chosen term describes, or a log may be of another program".to_owned());
        }
        let far_off = far_off(runs);
        if far_off > 0 && loss == Loss::Off {
            cautions.push(format!(
                "{far_off} reading(s) lie farther off than {FAR_OFF:.0} times what is usual here and pull the fit with all their weight; `loss = \"huber\"` or `\"tukey\"` in `[identify]` takes it from them"
            ));
        }
        cautions.extend(self.leaves_much());
        cautions
    }

    /// That it leaves much, where it does.
    fn leaves_much(&self) -> Option<String> {
        let left_um = 1e3 * self.rms_mm;
        if unexplained::is_much(self.rms_mm) && !self.settled {
            return Some(format!(
                "the fit has not come to rest and leaves {left_um:.2} um rms: a log may be of another program"
            ));
        }
        let times = self.beyond_chance?;
        if self.little_explained.is_empty() {
            return Some(format!(
                "the model leaves {left_um:.2} um rms, which is {times:.0} times what one reading differs from the next by chance: the machine does what no chosen term describes"
            ));
        }
        let of_run = |of: &LittleExplained| {
            let [left_um, by_set_up_um] = [of.left_mm, of.by_set_up_mm].map(|mm| 1e3 * mm);
            format!(
                "{}: the model leaves {left_um:.2} um rms where a set-up alone would leave {by_set_up_um:.2}",
                of.run
            )
        };
        let of_runs: Vec<String> = self.little_explained.iter().map(of_run).collect();
        Some(format!("{}: a log may be of another program or of another test", of_runs.join("; ")))
    }
}

fn step(run: &str, alignment: &Alignment) -> Option<String> {
    let step = alignment.time_step(REACH_S)?;
    if step.lost_s.abs() < STEP_S + PLAUSIBLY * step.sigma_s {
        return None;
    }
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

/// A standstill that is shorter than its program, beyond what is known of the times of its arcs: no control does that.
fn short(run: &str, alignment: &Alignment) -> Option<String> {
    let map = &alignment.time_map;
    let sigma_s = |at: usize| map.offset_sigmas_s[at].hypot(map.offset_sigmas_s[at + 1]);
    let stood = map.breaks().iter().zip(map.stood_s()).enumerate();
    let known = stood.filter(|(_, (at, _))| !at.operator).filter_map(|(k, (at, stood_s))| {
        let stood_s = stood_s?;
        Some((at.program_s, stood_s, stood_s + PLAUSIBLY * sigma_s(k)))
    });
    let (program_s, stood_s, _) =
        known.filter(|of| of.2 < -STEP_S).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let after = alignment.sections.iter().position(|section| section.end_s > program_s)?;
    let before = alignment.sections.get(after.checked_sub(1)?)?;
    Some(format!(
        "{run}: between `{}` and `{}`, {:.2} s are missing from the log",
        before.name, alignment.sections[after].name, -stood_s
    ))
}

/// A place outside of the travel: the program ran, so a file has it wrong.
fn beyond_travel(run: &IdentifiedRun, machine: &Machine) -> Option<String> {
    // Of what is commanded: every run of a program says the same.
    let range_mm = |axis: Axis| {
        let places = run.alignment.sections.iter().flat_map(|arc| {
            let at_s =
                |k: usize| arc.start_s + (arc.end_s - arc.start_s) * k as f64 / PLACES as f64;
            (0..=PLACES).map(at_s)
        });
        let at = places.map(|s| run.alignment.trajectory.at(s).position_mm[axis.index()]);
        at.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)])
    };
    let inside = |[low, high]: [f64; 2], axis: Axis| {
        let [lowest, highest] = machine.slide(axis).travel_mm;
        low >= lowest - BESIDE_MM && high <= highest + BESIDE_MM
    };
    let outside: Vec<Axis> =
        Axis::ALL.into_iter().filter(|&axis| !inside(range_mm(axis), axis)).collect();
    let (&axis, file) = (outside.first()?, machine.file().display());
    let ([low, high], [lowest, highest]) = (range_mm(axis), machine.slide(axis).travel_mm);
    let at = if high - low < BESIDE_MM {
        format!("have {axis} at {low:.1} mm")
    } else {
        format!("take {axis} from {low:.1} to {high:.1} mm")
    };
    let turned = outside.iter().all(|&axis| inside([-range_mm(axis)[1], -range_mm(axis)[0]], axis));
    let advice = if turned {
        let mut at_mm = *run.alignment.coincidence_mm();
        let travels = outside.iter().map(|&axis| {
            at_mm[axis.index()] *= -1.0;
            let [lowest, highest] = machine.slide(axis).travel_mm;
            format!("`travel_mm = [{:?}, {:?}]` for {axis}", -highest + 0.0, -lowest + 0.0)
        });
        let travels = travels.collect::<Vec<_>>().join(" and ");
        format!(
            "one of the two has its zero the other way: write {travels} in {file}, or `coincidence_mm = [{:?}, {:?}, {:?}]` in the test file",
            at_mm.x, at_mm.y, at_mm.z
        )
    } else {
        format!("`travel_mm` in {file} or `coincidence_mm` in the test file is wrong")
    };
    Some(format!(
        "arcs of the program {at} in machine coordinates, and the travel of {axis} is {lowest:.1} to {highest:.1} mm: {advice}"
    ))
}

/// What the reader of its log found by itself.
fn of_log(run: &IdentifiedRun) -> Vec<String> {
    run.alignment.log_notes.iter().map(|note| format!("{}: {note}", run.name)).collect()
}

/// Steps that were taken out.
fn slipped(run: &IdentifiedRun) -> Vec<String> {
    let told = |slip: &Slip| {
        format!(
            "{}: at {:.2} s of the log (line {}) the readings step by {:+.2} um and stay there, in every direction of the bar: it slipped in its clamp, or was touched. The step was taken out of all readings after it; fasten the bar and repeat the run",
            run.name,
            slip.log_s,
            slip.line,
            1e3 * slip.step_mm
        )
    };
    run.alignment.slips.iter().map(told).collect()
}

/// Readings that stand at one value and go no further.
fn cut_off(run: &IdentifiedRun) -> Vec<String> {
    let told = |(at_mm, count): (f64, usize)| {
        format!(
            "{}: {count} readings on arcs are exactly {:.1} um, and none lies beyond: they were cut off there and take no part; what the machine does there is not measured. Look for a limit of the bar, its amplifier or the program that wrote the log",
            run.name,
            1e3 * at_mm
        )
    };
    run.alignment.cut_off().into_iter().map(told).collect()
}

/// Engagements that the program does not make.
fn other_runs(run: &IdentifiedRun) -> Option<String> {
    let times = run.alignment.other_runs_s.iter().take(3);
    let times: Vec<String> = times.map(|[from, to]| format!("{from:.1} to {to:.1} s")).collect();
    let of = run.alignment.marks.first()?.log_s;
    (!times.is_empty()).then(|| {
        format!(
            "{}: the log holds another run as well: the bar is also engaged from {}, by its clock. Only the run that begins at {of:.1} s was taken; cut the log in two to use the other",
            run.name,
            times.join(", ")
        )
    })
}

fn far_off(runs: &[IdentifiedRun]) -> usize {
    let used =
        || runs.iter().flat_map(IdentifiedRun::used).map(|record: &Record| record.residual_mm);
    let Some(scale) = solve::robust_scale(&mut used().collect::<Vec<_>>()) else { return 0 };
    used().filter(|residual| residual.abs() > FAR_OFF * scale).count()
}
