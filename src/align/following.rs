//! Slides that follow the program with a lag of the first order.
//!
//! `T dx/dt = c - x` with the commanded `c` has the solution `x(t) = ∫ c(t - T s) exp(-s) ds`, a mean over what was
//! commanded before. Its mean delay is `T`, which an offset of the time takes in; what is left is
//!
//! `x(t + T) = ∫ c(t + T (1 - s)) exp(-s) ds`,
//!
//! the path with its corners rounded, and on a circle of radius R at the speed v a radius smaller by `(v T)² / 2 R`.
//!
//! Slides that follow unlike have `T_k = T (1 + r_k)`.

use nalgebra::Vector3;

use crate::motion::{Followed, Times, Trajectory};

/// Abscissas and weights of Gauss and Laguerre for six points (Abramowitz and Stegun, Table 25.9): exact for
/// polynomials of degree 11. The last one weighs less than a part in a million and is left out.
const POINTS: [(f64, f64); 5] = [
    (0.222_846_604_179, 0.458_964_673_950),
    (1.188_932_101_673, 0.417_000_830_772),
    (2.992_736_326_059, 0.113_373_382_074),
    (5.775_143_569_105, 0.010_399_197_453),
    (9.837_467_418_383, 0.000_261_017_203),
];
/// A lag that moves no corner by more than rounding of the program, s.
const NONE_S: f64 = 1e-5;

/// A slide that is asked where it goes is looked at so long before and after, s.
pub(super) const HAIR_S: f64 = 1e-4;
/// A slide has turned within so many doublings of its time constant: one that leaves a corner a hundred times slower than it came
/// takes five time constants.
const DOUBLINGS: i32 = 6;
/// The time of a turn is halved so often, from some tenths of a second to nanoseconds.
const HALVINGS: usize = 30;

/// So few readings do not fill a window evenly.
const FEW: usize = 6;

/// Where slides are that follow a program.
#[derive(Debug, Clone)]
pub struct Following {
    /// The time constant that they share, s: its delay is not counted.
    common_s: f64,
    /// The time constant of each, s.
    constants_s: Vector3<f64>,
    /// Whether arcs are made of chords.
    chords: bool,
    /// `None` where they follow at once, and of a motion that was recorded.
    blocks: Option<Followed>,
}

impl Following {
    /// With the time constant that slides share and by which share that of each is longer, along arcs that are `chords` or not.
    /// Of a motion that was recorded nobody knows how it goes on from row to row: there it is a mean over what was commanded.
    pub(super) fn new(
        trajectory: &Trajectory,
        common_s: f64,
        longer: &Vector3<f64>,
        chords: bool,
    ) -> Self {
        let constants_s = constants_s(common_s, longer);
        let blocks = if common_s < NONE_S { None } else { Followed::new(trajectory, constants_s) };
        Self { common_s, constants_s, chords, blocks }
    }

    /// Whether it is that with these time constants.
    pub(super) fn has(&self, common_s: f64, longer: &Vector3<f64>) -> bool {
        self.common_s.total_cmp(&common_s).is_eq()
            && self.constants_s == constants_s(common_s, longer)
    }

    /// Whether slides are where they are commanded to be.
    pub fn at_once(&self) -> bool {
        self.common_s < NONE_S
    }

    /// Where the slides are (mm), and by how much more of its time constant moves each (mm/s; 0 where they follow at once).
    /// The delay of what they share is not counted; that of each counts as what it differs by. The time is near that of a
    /// block, by its index.
    pub fn at(&self, trajectory: &Trajectory, program_s: f64, near: usize) -> [Vector3<f64>; 2] {
        if self.at_once() {
            return [trajectory.position_near_mm(program_s, near), Vector3::zeros()];
        }
        match &self.blocks {
            Some(followed) => followed.at(trajectory, program_s + self.common_s, near),
            None => {
                self.in_the_mean(|later_s| trajectory.position_near_mm(program_s + later_s, near))
            }
        }
    }

    /// The mean over so many times of [`Self::at`] on an arc, and of what it grows by.
    pub fn mean(&self, trajectory: &Trajectory, times: &Times, near: usize) -> [Vector3<f64>; 2] {
        if !self.chords {
            // A curve of third degree.
            let node_s = times.node_s();
            let three = [-node_s, 0.0, node_s]
                .map(|aside_s| self.at(trajectory, times.middle_s() + aside_s, near));
            return [0, 1].map(|k| three.iter().map(|of| of[k]).sum::<Vector3<f64>>() / 3.0);
        }
        let mean_mm = |later_s: f64| trajectory.mean_position_mm(&times.later(later_s), near);
        if self.at_once() {
            return [mean_mm(0.0), Vector3::zeros()];
        }
        if let Some(followed) = &self.blocks {
            let late = times.later(self.common_s);
            if times.count <= FEW {
                let each =
                    (0..times.count).map(|k| followed.at(trajectory, late.at_s(k as f64), near));
                let sum =
                    each.fold([Vector3::zeros(); 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
                return sum.map(|sum| sum / times.count.max(1) as f64);
            }
            // A box of the same variance; with that the equation of the lag itself has the mean.
            let window_s = (12.0 * late.variance_s2()).sqrt();
            let [before, after] = [-0.5, 0.5]
                .map(|share| followed.at(trajectory, late.middle_s() + share * window_s, near));
            let [rise, of_rise] = [0, 1].map(|k| (after[k] - before[k]) / window_s);
            let mean_mm = mean_mm(self.common_s) - self.constants_s.component_mul(&rise);
            return [mean_mm, -rise - self.constants_s.component_mul(&of_rise)];
        }
        self.in_the_mean(mean_mm)
    }

    /// How far inside of an arc of this radius each slide brings the ball that it moves at a speed, mm, and by how much more of its
    /// time constant, mm/s: the mean over chords of what [`Self::at`] has of them. The bar points from its middle along a unit vector.
    ///
    /// The lag `s T_k` of a slide, the mean delay `T` of all taken off, has the mean square `T_k² + (T_k - T)²`, and `d²c/dt²` is
    /// `v² / R` towards the middle: `n_k² (T_k² + (T_k - T)²) v² / 2 R`.
    pub fn inside_mm(
        &self,
        along: &Vector3<f64>,
        speed_mm_s: f64,
        radius_mm: f64,
    ) -> [Vector3<f64>; 2] {
        let bends_mm_s2 = along.component_mul(along) * (speed_mm_s.powi(2) / radius_mm);
        let later_s = self.constants_s.add_scalar(-self.common_s);
        let squares_s2 =
            self.constants_s.component_mul(&self.constants_s) + later_s.component_mul(&later_s);
        [squares_s2 * 0.5, self.constants_s + later_s].map(|of| bends_mm_s2.component_mul(&of))
    }

    /// When slides turn round, s: each while from the program's turn to that of the slide, whichever is first. Of an
    /// even curve both are at once; a slide that leaves a corner slower than it came turns later, one that comes to it slowly
    /// sooner, by up to its time constant.
    pub(super) fn turns_s(&self, trajectory: &Trajectory) -> Vec<[f64; 2]> {
        let planned = trajectory.reversals_s().into_iter().map(|planned_s| {
            let [before, after] =
                [-HAIR_S, HAIR_S].map(|aside_s| trajectory.at(planned_s + aside_s).sense);
            let turns =
                |slide: &usize| self.blocks.is_some() && (after - before)[*slide].abs() > 0.5;
            let each = (0..3).filter(turns);
            each.filter_map(|slide| self.turned_s(trajectory, planned_s, slide, after[slide]))
                .fold([planned_s; 2], |[from_s, to_s], s| [from_s.min(s), to_s.max(s)])
        });
        planned.collect()
    }

    /// When a slide begins to go in another sense that the program turns to at a time, s; `None` where it does not get there.
    fn turned_s(
        &self,
        trajectory: &Trajectory,
        planned_s: f64,
        slide: usize,
        sense: f64,
    ) -> Option<f64> {
        let goes = |at_s: &f64| {
            let near = trajectory.block_at(*at_s);
            let [before, after] =
                [-HAIR_S, HAIR_S].map(|aside_s| self.at(trajectory, at_s + aside_s, near)[0]);
            sense * (after[slide] - before[slide]) > 0.0
        };
        // No sooner than it is commanded to.
        let mut not_yet_s = planned_s - self.common_s - HAIR_S;
        let later_s = |k: i32| not_yet_s + self.constants_s[slide] * 2_f64.powi(k);
        let mut has_s = (0..DOUBLINGS).map(later_s).find(goes)?;
        for _ in 0..HALVINGS {
            let middle_s = 0.5 * (not_yet_s + has_s);
            *(if goes(&middle_s) { &mut has_s } else { &mut not_yet_s }) = middle_s;
        }
        Some(has_s)
    }

    /// With `s = x / T` the mean has the weights `exp(-s) exp(s (1 - T / T_k))`.
    fn in_the_mean(&self, at_mm: impl Fn(f64) -> Vector3<f64>) -> [Vector3<f64>; 2] {
        let (mut sum, mut all) = (Vector3::zeros(), Vector3::zeros());
        let (mut slope, mut of_all) = (Vector3::zeros(), Vector3::zeros());
        for (s, weight) in &POINTS {
            let position_mm = at_mm(self.common_s * (1.0 - s));
            for k in 0..3 {
                let constant_s = self.constants_s[k];
                let by = weight * (s * (1.0 - self.common_s / constant_s)).exp();
                // `d ln(by) / d T_k`
                let grows = s * self.common_s / constant_s.powi(2);
                sum[k] += by * position_mm[k];
                all[k] += by;
                slope[k] += by * grows * position_mm[k];
                of_all[k] += by * grows;
            }
        }
        let mean: Vector3<f64> = sum.component_div(&all);
        let slope = slope.component_div(&all) - mean.component_mul(&of_all.component_div(&all));
        [mean, slope]
    }
}

/// The time constant of each slide, s, by which share each is longer than what they share.
fn constants_s(common_s: f64, longer: &Vector3<f64>) -> Vector3<f64> {
    longer.map(|longer| common_s * (1.0 + longer))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    #[test]
    fn the_mean_delay_is_one_and_a_parabola_is_bent_by_its_second_moment() {
        let mean =
            |f: &dyn Fn(f64) -> f64| POINTS.iter().map(|(s, weight)| weight * f(*s)).sum::<f64>();
        assert!((mean(&|_| 1.0) - 1.0).abs() < 1e-6);
        assert!((mean(&|s| s) - 1.0).abs() < 2e-5);
        // c = t²: x(t + T) = t² + T².
        assert!((mean(&|s| (1.0 - s).powi(2)) - 1.0).abs() < 3e-4);
    }

    /// The mean of the path over chords lies as far inside as the chords' own mean and [`Following::inside_mm`] say.
    #[test]
    fn slides_that_follow_bring_the_ball_inside_the_arc() {
        let machine = crate::machine::Machine::read("machines/hu40t.toml".as_ref()).unwrap();
        let mut reading = crate::nc::Reading::of(&machine);
        reading.work_offsets_mm.insert(54, Vector3::zeros());
        let (radius_mm, chords) = (50.0, 800);
        let mut program = "%\nO1\nG21 G17 G90 G94 G64\nG54\nG00 X50. Y0. Z0.\n".to_owned();
        for k in 1..=chords {
            let angle_rad = std::f64::consts::PI * f64::from(k) / f64::from(chords);
            let (y, x) = angle_rad.sin_cos();
            let feed = if k == 1 { " F1000." } else { "" };
            writeln!(program, "G01 X{:.4} Y{:.4}{feed}", radius_mm * x, radius_mm * y).unwrap();
        }
        program += "M30\n%\n";
        let program = crate::nc::read(&program, "O1.nc".as_ref(), &reading).unwrap();
        let trajectory = Trajectory::new(&program, &machine, 1.0);
        let chord_s = std::f64::consts::PI * radius_mm / f64::from(chords) / (1000.0 / 60.0);
        for longer in [Vector3::zeros(), Vector3::new(0.2, -0.2, 0.0)] {
            let [at_once, late] =
                [0.0, 0.025].map(|time_s| Following::new(&trajectory, time_s, &longer, true));
            for from_s in [2.0, 3.0, 4.0] {
                let (mut inside_mm, mut told_mm) = (0.0, 0.0);
                for step in 0..320 {
                    let at_s = from_s + chord_s * f64::from(step) / 16.0;
                    let near = trajectory.block_at(at_s);
                    let [commanded_mm, followed_mm] =
                        [&at_once, &late].map(|of| of.at(&trajectory, at_s, near)[0]);
                    let along = commanded_mm.normalize();
                    let state = trajectory.at(at_s);
                    // That slides follow unlike late is no part of it.
                    let unlike_mm = (0.025 * longer).component_mul(&state.velocity_mm_s);
                    inside_mm += along.dot(&(commanded_mm - followed_mm - unlike_mm));
                    let speed_mm_s = state.velocity_mm_s.norm();
                    told_mm += late.inside_mm(&along, speed_mm_s, radius_mm)[0].sum();
                }
                assert!(told_mm > 320.0 * 1e-3, "{from_s}: {told_mm}");
                assert!(
                    (inside_mm / told_mm - 1.0).abs() < 0.01,
                    "{longer:?} {from_s}: {inside_mm} {told_mm}"
                );
            }
        }
    }

    /// A slide that has all but met its command on a chord that does not move it turns with the next one, a time constant before one
    /// that is in the middle of an even curve.
    #[test]
    fn a_slide_turns_when_it_meets_its_command() {
        let machine = crate::machine::Machine::read("machines/hu40t.toml".as_ref()).unwrap();
        let mut reading = crate::nc::Reading::of(&machine);
        reading.work_offsets_mm.insert(54, Vector3::new(20.0, -35.0, 40.0));
        for (flat_mm, after) in [(0.6, 1.0), (0.1, 1.0), (1e-3, 1.0), (1e-3, 0.02)] {
            let program = format!(
                "%\nO1\nG21 G17 G90 G94 G64\nG54\nG00 X-100. Y0. Z0.\nG01 X-100.1 Y10. F500.\n\
                 Y{}\nX{} Y{}\nM30\n%\n",
                10.0 + flat_mm,
                0.1 * after - 100.1,
                20.0 + flat_mm
            );
            let program = crate::nc::read(&program, "O1.nc".as_ref(), &reading).unwrap();
            let trajectory = Trajectory::new(&program, &machine, 1.0);
            let time_s = 0.02;
            let following = Following::new(&trajectory, time_s, &Vector3::zeros(), true);
            let planned_s = trajectory.reversals_s().pop().unwrap();
            // The lag itself, in steps: the slide turns when it meets its command.
            let (step_s, mut lag_mm, mut before_mm) = (1e-5, 0.0, -80.0);
            let mut met_s = f64::NAN;
            for step in 0..(trajectory.end_s() / step_s) as usize {
                let at_s = step as f64 * step_s;
                let now_mm = trajectory.at(at_s).position_mm.x;
                let follows_mm = lag_mm * (-step_s / time_s).exp() + (now_mm - before_mm);
                before_mm = now_mm;
                if lag_mm < 0.0 && follows_mm >= 0.0 {
                    met_s = at_s;
                }
                lag_mm = follows_mm;
            }
            let turned_s = met_s - time_s - planned_s;
            let [from_s, to_s] = following.turns_s(&trajectory).pop().unwrap();
            let told = [from_s - planned_s, to_s - planned_s, turned_s];
            assert!((told[0] - turned_s.min(0.0)).abs() < 1e-4, "{flat_mm} {after} {told:?}");
            assert!((told[1] - turned_s.max(0.0)).abs() < 1e-4, "{flat_mm} {after} {told:?}");
        }
    }
}
