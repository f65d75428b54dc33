//! What an operator reads before he runs a program: its title, and what to mount where.

use super::spelling::Spelling;
use crate::machine::Machine;
use crate::plan::{NamedMounting, Path, PathPlan, Step, Test};

/// Such as `BALL-BAR XY R150 F1000`.
pub(super) fn title(plan: &PathPlan, mounting: &NamedMounting) -> String {
    let feeds: Vec<String> = plan.feeds_mm_s.iter().map(|feed| short(feed * 60.0)).collect();
    let length = short(mounting.bar_length_mm);
    format!("BALL-BAR {} R{length} F{}", plan.strategy_name(), feeds.join(" F"))
}

/// Machine, test, both balls, the bar, and what the control must show at the second stop.
pub(super) fn lines(
    test: &Test,
    machine: &Machine,
    path: &Path,
    spelling: &Spelling,
) -> Vec<String> {
    let mounting = &test.mountings()[path.mounting];
    let offset_mm = &mounting.mounting.coincidence_mm;
    let zero = spelling.zero(mounting.work_offset);
    let mut lines = vec![
        format!("MACHINE {}", machine.name()),
        format!("TEST {}", test.name()),
        format!("SHA256 {}", &test.hash()[..16]),
        format!("MOUNTING {} - {zero} ZERO IS THE WORKPIECE BALL", mounting.name),
        format!("MACHINE COORDINATES X{:.3} Y{:.3} Z{:.3}", offset_mm.x, offset_mm.y, offset_mm.z),
        spelling.tool.to_owned(),
        format!("BALL-BAR OF {:.3} MM - OFF UNTIL THE THIRD STOP", mounting.bar_length_mm),
    ];
    let compared = path.steps.iter().find_map(|step| match step {
        Step::Compare(place_mm) => Some(place_mm),
        _ => None,
    });
    lines.extend(compared.map(|at_mm| {
        // Zero has no sign.
        let [x, y, z] = [at_mm.x, at_mm.y, at_mm.z].map(|mm| (mm * 1e3).round() / 1e3 + 0.0);
        format!("COMPARE AT THE SECOND STOP - {zero} X{x:.3} Y{y:.3} Z{z:.3}")
    }));
    lines.push("AFTER A RESET TAKE THE BALL-BAR OFF AND START FROM THE TOP".to_owned());
    lines
}

/// A number without digits and a point that it does not need.
fn short(value: f64) -> String {
    format!("{value:.3}").trim_end_matches('0').trim_end_matches('.').to_owned()
}
