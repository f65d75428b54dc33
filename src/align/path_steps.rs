//! Where the commanded path steps: a program that was corrected takes the lost motion back where a slide turns round.

use crate::motion::Trajectory;
use crate::solve::{Truncation, Tsqr, solve};

/// A step is looked for in so many chords either side of it.
const CHORDS: f64 = 10.0;
/// Fewer do not tell it: steps that are nearer to each other are one.
const FEWEST_CHORDS: f64 = 3.0;
/// Points of a chord at which the path is looked at.
const POINTS_A_CHORD: f64 = 8.0;
/// Slides that turn nearer than this to the begin of a block turn there, s.
const HAIR_S: f64 = 1e-6;

/// A step of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathStep {
    /// Where the slide turns, s of program time.
    pub(super) turns_s: f64,
    /// From where to where the blocks lead that step, s.
    pub(super) over_s: [f64; 2],
    /// By how much the path lies farther out after it, mm.
    pub(super) by_mm: f64,
}

/// The steps of an arc of chords that take so long between two program times, over the two blocks between which a slide turns: outwards a slide may turn after the
/// step that is for its turning.
///
/// About these blocks the path is `a + b t + c t² + step`, by least squares without them; where the arc begins with the turn,
/// `a + b t + c t²` after its first block, from where the machine stood. What is less than chords and rounding make of this, from the highest to
/// the lowest point, is none.
pub(super) fn path_steps(
    trajectory: &Trajectory,
    reversals_s: &[f64],
    [start_s, end_s]: [f64; 2],
    chord_s: f64,
    beyond_mm: &dyn Fn(f64) -> f64,
) -> Vec<PathStep> {
    let (reach_s, enough_s) = (CHORDS * chord_s, FEWEST_CHORDS * chord_s);
    let on_arc = |s: &f64| start_s - HAIR_S < *s && *s < end_s;
    // Where a slide turns, and from where to where two blocks lead there.
    let turns = reversals_s.iter().copied().filter(on_arc).filter_map(|turns_s| {
        let index = trajectory.block_at(turns_s + HAIR_S);
        let (all, after) = (trajectory.blocks(), trajectory.blocks().get(index)?);
        let before_s = index.checked_sub(1).map_or(start_s, |before| all[before].start_s);
        let begins = (after.start_s - turns_s).abs() < HAIR_S;
        begins.then_some((turns_s, [before_s.max(start_s), turns_s + after.duration_s]))
    });
    let mut places: Vec<(f64, [f64; 2])> = Vec::new();
    for (turns_s, over_s) in turns {
        match places.last_mut() {
            Some((_, last_s)) if over_s[0] - last_s[1] < enough_s => last_s[1] = over_s[1],
            _ => places.push((turns_s, over_s)),
        }
    }
    let of_place = |(index, &(turns_s, over_s)): (usize, &(f64, [f64; 2]))| {
        let before_s = index.checked_sub(1).map_or(start_s, |k| places[k].1[1]);
        let after_s = places.get(index + 1).map_or(end_s, |next| next.1[0]);
        let (low_s, high_s) = (before_s.max(over_s[0] - reach_s), after_s.min(over_s[1] + reach_s));
        let begins = turns_s - start_s < HAIR_S;
        if chord_s <= 0.0
            || high_s - over_s[1] < enough_s
            || !begins && over_s[0] - low_s < enough_s
        {
            return None;
        }
        let every_s = chord_s / POINTS_A_CHORD;
        let points = |from_s: f64, to_s: f64| {
            let count = ((to_s - from_s) / every_s) as usize;
            (0..count).map(move |k| from_s + (k as f64 + 0.5) * every_s)
        };
        let row = |at_s: f64| {
            let reaches = (at_s - turns_s) / reach_s;
            [1.0, reaches, reaches * reaches, f64::from(u8::from(at_s > turns_s))]
        };
        let rows: Vec<([f64; 4], f64)> = points(low_s, over_s[0])
            .chain(points(over_s[1], high_s))
            .map(|at_s| (row(at_s), beyond_mm(at_s)))
            .collect();
        let mut fit = Tsqr::new(4);
        for (row, is_mm) in &rows {
            fit.push_weighted(row, *is_mm, 1.0);
        }
        if begins {
            fit.push_weighted(&[1.0, 0.0, 0.0, 0.0], beyond_mm(turns_s), 1.0);
        }
        let solution = solve(&fit.finish().ok()?, Truncation::Relative(f64::EPSILON)).ok()?;
        let is = solution.x();
        let by_mm = is[3];
        let rough_mm = rows.iter().map(|(row, is_mm)| {
            let smooth_mm: f64 = row.iter().zip(is).map(|(at, by)| at * by).sum();
            is_mm - smooth_mm
        });
        let [low_mm, high_mm] =
            rough_mm.fold([0.0_f64; 2], |[low, high], off_mm| [low.min(off_mm), high.max(off_mm)]);
        let stands_out = by_mm.abs() > high_mm - low_mm;
        stands_out.then_some(PathStep { turns_s, over_s, by_mm })
    };
    places.iter().enumerate().filter_map(of_place).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tests {
    use std::fmt::Write as _;

    use nalgebra::Vector3;

    use super::*;
    use crate::machine::Machine;
    use crate::nc::{self, Reading};

    /// Chords of 1 mm about a circle of 100 mm from 60 to 120 degrees, where Y turns in the middle, with the end of each rounded to 1 um;
    /// farther out by so much after Y has turned.
    fn steps_of(by_mm: f64) -> Vec<PathStep> {
        let axes = ["X", "Y", "Z"].map(|axis| {
            format!("[axes.{axis}]\ntravel_mm = [-500, 500]\nrapid_mm_min = 9000\nacceleration_mm_s2 = 500\n")
        });
        let text = format!("name = \"M\"\ntopology = \"wFXYZt\"\n{}", axes.concat());
        let machine = Machine::parse(&text, "m.toml".as_ref()).unwrap();
        let mut reading = Reading::of(&machine);
        reading.work_offsets_mm.insert(54, Vector3::zeros());
        let mut source = "G90 G00 X50. Y86.603 Z0.\n".to_owned();
        for k in 1..=106 {
            let angle_rad = (60.0 + f64::from(k) * 60.0 / 106.0_f64).to_radians();
            let radius_mm = if k > 53 { 100.0 + by_mm } else { 100.0 };
            let (y, x) = (radius_mm * angle_rad.sin(), radius_mm * angle_rad.cos());
            writeln!(source, "G01 X{x:.3} Y{y:.3} F1000.").unwrap();
        }
        source.push_str("M30\n");
        let program = nc::read(&source, "p.nc".as_ref(), &reading).unwrap();
        let trajectory = Trajectory::new(&program, &machine, 1.0);
        let begins_s = trajectory.blocks()[1].start_s;
        let beyond_mm = |at_s: f64| trajectory.at(at_s).position_mm.norm() - 100.0;
        path_steps(
            &trajectory,
            &trajectory.reversals_s(),
            [begins_s, trajectory.end_s()],
            0.06,
            &beyond_mm,
        )
    }

    #[test]
    fn a_step_where_a_slide_turns_is_told_from_chords() {
        for by_mm in [0.008, -0.008, -0.003] {
            let [step] = steps_of(by_mm)[..] else { panic!("{:?}", steps_of(by_mm)) };
            assert!((step.by_mm - by_mm).abs() < 5e-4, "{step:?}");
        }
        assert!(steps_of(0.0).is_empty(), "{:?}", steps_of(0.0));
    }
}
