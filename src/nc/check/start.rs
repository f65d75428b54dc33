//! Rules of the start: from wherever the machine stands, and again from where the program ended.

use nalgebra::Vector3;

use super::bar::Walk;
use crate::nc::program::{Action, Move, Path};
use crate::nc::run::{Opening, Ran};

impl Walk<'_, '_> {
    /// The first positionings, from anywhere and from the end of the program.
    pub(super) fn starts(&mut self, ran: &Ran) {
        self.retracts_first(&ran.openings);
        let moves = || {
            ran.steps.iter().filter_map(|step| match &step.action {
                Action::Move(motion) => Some(motion),
                _ => None,
            })
        };
        let (Some(first), Some(last)) = (moves().next(), moves().next_back()) else { return };
        let asked = ran.steps.iter().position(|step| step.action == Action::Stop);
        let mut at_mm = last.end_mm;
        for opening in &ran.openings {
            let to_mm = Vector3::from_fn(|axis, _| opening.to_mm[axis].unwrap_or(at_mm[axis]));
            let fitted = self.fitted && asked.is_none_or(|stop| stop >= opening.step);
            self.again(opening, at_mm, to_mm, first, fitted);
            at_mm = to_mm;
        }
    }

    /// Nobody knows what lies between: the tool leaves the workpiece before it goes anywhere else.
    fn retracts_first(&mut self, openings: &[Opening]) {
        if let Some(Opening { to_mm: [x, y, _], line, .. }) = openings.first()
            && (x.is_some() || y.is_some())
        {
            let what = "the first motion is not the retract of Z alone".to_owned();
            let hint = "the machine may stand anywhere, below the workpiece ball too: write G00 G53 Z.. before X and Y";
            self.warning(line.number, "start", what, hint);
        }
    }

    /// One positioning of a second start.
    fn again(
        &mut self,
        opening: &Opening,
        start_mm: Vector3<f64>,
        end_mm: Vector3<f64>,
        first: &Move,
        fitted: bool,
    ) {
        if (end_mm - start_mm).norm() < 1e-9 {
            return;
        }
        let motion = Move { rapid: true, path: Path::Line, start_mm, end_mm, ..*first };
        if fitted {
            let what =
                "started again from its end, the program positions with the bar fitted".to_owned();
            let hint = "write M00 after the release, so that the bar is taken off, and Z away from the ball before M30";
            self.error(opening.line.number, "second-start", what, hint);
        } else if let Some(told) = self.rapid_in_reach(&motion) {
            let what = format!("started again from its end, {told}");
            let hint =
                "retract Z before M30, and write G00 G53 Z.. before X and Y at the beginning";
            self.error(opening.line.number, "second-start", what, hint);
        }
    }
}
