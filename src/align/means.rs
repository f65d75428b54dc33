//! The path of each leg in its mean over a while, as an alignment has it: where chords are not told, legs are laid on it.

use std::sync::Arc;

use nalgebra::Vector3;

use super::following::Following;
use super::mean_path::MeanPath;
use super::samples::Alignment;
use super::section::Section;
use super::time_map::Moment;

impl Alignment {
    /// Looks up the path of every leg, for its mean: see [`Self::mean_mm`].
    pub fn look_up_means(&mut self) {
        let map = &self.time_map;
        let of_leg = |leg: usize| {
            let arcs = self.sections.iter().filter(|arc| map.leg_of(arc.start_s) == leg);
            let arcs: Vec<Section> = arcs.cloned().collect();
            let chord_s = map.chords[leg].lasts_s;
            MeanPath::of(&self.trajectory, &arcs, &self.coincidence_mm, self.radius_mm, chord_s)
        };
        self.means = (0..map.offsets_s.len()).map(of_leg).map(Arc::new).collect();
    }

    /// Commanded length minus radius at a program time of a leg, in its mean over a while, mm, its steps at reversals as they are; 0
    /// before it was looked up.
    pub fn mean_mm(&self, leg: usize, program_s: f64, over_s: f64) -> f64 {
        self.mean_stepped_mm(leg, program_s, over_s, program_s)
    }

    /// The same with the steps until another time.
    pub fn mean_stepped_mm(&self, leg: usize, program_s: f64, over_s: f64, until_s: f64) -> f64 {
        let mean_mm =
            |path: &MeanPath| path.smooth_mm(program_s, over_s) + path.stepped_mm(until_s);
        self.path(leg).map_or(0.0, mean_mm)
    }

    /// Whether the path of a leg steps where slides turn.
    pub fn steps(&self, leg: usize) -> bool {
        self.path(leg).is_some_and(MeanPath::steps)
    }

    /// Whether it does within so long of a program time, and the leg counts by its mean, which has no ramp for it.
    pub fn steps_at(&self, leg: usize, program_s: f64, within_s: f64) -> bool {
        let in_mean = self.time_map.chords[leg].blur_s > 0.0;
        in_mean && self.path(leg).is_some_and(|path| path.step_at(program_s, within_s).is_some())
    }

    /// By how much the path of a leg has stepped until a program time, mm.
    pub fn stepped_mm(&self, leg: usize, until_s: f64) -> f64 {
        self.path(leg).map_or(0.0, |path| path.stepped_mm(until_s))
    }

    /// The path of a leg, where it was looked up.
    fn path(&self, leg: usize) -> Option<&MeanPath> {
        self.means.get(leg).and_then(|path| path.as_ref().as_ref())
    }

    /// From the path onto its mean over so long, at a speed at which slides follow, mm.
    pub(super) fn onto_mean_mm(
        &self,
        path_mm: &Vector3<f64>,
        moment: &Moment,
        over_s: f64,
        following: &Following,
        speed_mm_s: f64,
    ) -> Vector3<f64> {
        let ball_mm = path_mm - self.coincidence_mm;
        let along = self.along(path_mm);
        let mean_mm = self.mean_mm(moment.leg, moment.program_s, over_s);
        let [inside_mm, _] = following.inside_mm(&along, speed_mm_s, self.radius_mm);
        along * (self.radius_mm + mean_mm - inside_mm.sum() - ball_mm.norm())
    }
}
