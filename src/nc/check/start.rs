//! Rules of the start: from wherever the machine stands, and again from where the program ended.

use nalgebra::Vector3;

use super::bar::Walk;
use crate::machine::Axis;
use crate::nc::program::{Action, Move, Path};
use crate::nc::run::{Opening, Ran};

/// The travel of an axis whose place is not known is looked at in so many parts.
const PARTS: usize = 6;

impl Walk<'_, '_> {
    /// The first positionings, from anywhere and from the end of the program.
    pub(super) fn starts(&mut self, ran: &Ran) {
        let moves = || {
            ran.steps.iter().filter_map(|step| match &step.action {
                Action::Move(motion) => Some(motion),
                _ => None,
            })
        };
        let (Some(first), Some(last)) = (moves().next(), moves().next_back()) else { return };
        self.anywhere(&ran.openings, first);
        let asked = ran.steps.iter().position(|step| step.action == Action::Stop);
        let mut at_mm = last.end_mm;
        for opening in &ran.openings {
            let to_mm = Vector3::from_fn(|axis, _| opening.to_mm[axis].unwrap_or(at_mm[axis]));
            let fitted = self.fitted && asked.is_none_or(|stop| stop >= opening.step);
            self.again(opening, at_mm, to_mm, first, fitted);
            at_mm = to_mm;
        }
    }

    /// The first positionings, from the places of the travel from which they pass nearest to the workpiece ball.
    ///
    /// Where the tool stands it came along +Z, and that way it can go back from anywhere; every other way may lead through
    /// the ball as long as one coordinate is not known. Of several positionings the first is told.
    fn anywhere(&mut self, openings: &[Opening], first: &Move) {
        let mut known_mm = [None; 3];
        for opening in openings {
            if let Some((start_mm, told)) = self.nearest(known_mm, opening, first) {
                let [x, y, z] = start_mm.into();
                let what = format!("started from X{x:.3} Y{y:.3} Z{z:.3} of the machine, {told}");
                let hint = "the machine may stand anywhere, below the workpiece ball too: write G00 G53 Z.. before X and Y, to a place above the reach of the bar (`retract_mm` in the machine file)";
                self.error(opening.line.number, "start", what, hint);
                return;
            }
            known_mm = opening.to_mm;
        }
    }

    /// From where one of the first positionings passes within the reach of the bar, and what there is to tell.
    fn nearest(
        &mut self,
        known_mm: [Option<f64>; 3],
        opening: &Opening,
        first: &Move,
    ) -> Option<(Vector3<f64>, String)> {
        let places = Axis::ALL.map(|axis| self.places(axis, known_mm[axis.index()]));
        let [xs, ys, zs] = &places;
        let along_z = known_mm[..2] == opening.to_mm[..2];
        let starts = xs.iter().flat_map(|x| ys.iter().map(move |y| (*x, *y)));
        let mut starts = starts.flat_map(|(x, y)| zs.iter().map(move |z| Vector3::new(x, y, *z)));
        starts.find_map(|start_mm| {
            let end_mm = Vector3::from_fn(|axis, _| opening.to_mm[axis].unwrap_or(start_mm[axis]));
            let goes_back = along_z && end_mm.z >= start_mm.z;
            let motion = Move { rapid: true, path: Path::Line, start_mm, end_mm, ..*first };
            if goes_back {
                return None;
            }
            let told = self.in_the_way(&motion);
            told.map(|told| (start_mm, told))
        })
    }

    /// What stands in the way of a positioning: the bar, or the post.
    fn in_the_way(&mut self, motion: &Move) -> Option<String> {
        let reached = self.rapid_in_reach(motion);
        reached.or_else(|| Some(self.bodies.as_mut()?.on(motion)?.told("")))
    }

    /// Where an axis may stand, machine coordinates in mm: where it is known to stand, or at the workpiece ball, at the
    /// ends of its travel and between.
    fn places(&self, axis: Axis, known_mm: Option<f64>) -> Vec<f64> {
        if let Some(known_mm) = known_mm {
            return vec![known_mm];
        }
        let [low_mm, high_mm] = self.machine.slide(axis).travel_mm;
        let ball_mm = self.sphere.centre_mm[axis.index()].clamp(low_mm, high_mm);
        let parts = (0..=PARTS).map(|k| low_mm + (high_mm - low_mm) * k as f64 / PARTS as f64);
        std::iter::once(ball_mm).chain(parts).collect()
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
        } else if let Some(told) = self.in_the_way(&motion) {
            let what = format!("started again from its end, {told}");
            let hint =
                "retract Z before M30, and write G00 G53 Z.. before X and Y at the beginning";
            self.error(opening.line.number, "second-start", what, hint);
        }
    }
}
