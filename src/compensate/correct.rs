//! A program made right beforehand: every move leads where the machine, as it errs, ends up where the program meant.
//!
//! **Points.** The control is sent to `q` with `q + e(q, s) - e0 = p`, `p` the point of the program, `s` the senses in which the
//! slides come there, and `e0` the displacement at the zero of the work offset, mean of both senses: the operator has set
//! the zero on this machine. Beyond what was measured `e` keeps the value that it has at the end.
//!
//! **Senses.** A slide that stands in the program moves by what the others need. It keeps its sense where the correction leads on, and
//! turns where it leads back by more than what the reversal itself changes; between, it stands.
//!
//! **Parts.** Lines are divided until the correction bends by no more than the tolerance between two points; arcs become lines whose
//! sagitta is no more, divided where a slide turns. Rapids keep their one point.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::field::Field;
use super::near::Measured;
use crate::error::Result;
use crate::machine::{Axis, Pose};
use crate::nc::{Driven, Move, Path, Rewriting};

/// How a program is corrected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correcting {
    /// How far the correction and the path of an arc may be off between two points, mm.
    pub tolerance_mm: f64,
    /// A larger correction is refused, mm.
    pub limit_mm: f64,
}

/// A program that was corrected.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected {
    /// Its text.
    pub text: String,
    /// Moves that were corrected, and those in machine coordinates, which were not.
    pub moves: usize,
    /// As above.
    pub left: usize,
    /// Lines that they have become.
    pub points: usize,
    /// Length of the largest correction, mm.
    pub largest_mm: f64,
    /// Its line in the program as it was.
    pub largest_line: usize,
    /// Root mean square of the length of the corrections, mm.
    pub rms_mm: f64,
    /// Points where nothing was measured near, and how far the farthest is from what was, mm.
    pub far: (usize, f64),
}

/// The control and the slides while a program is corrected.
struct Corrector<'a> {
    field: &'a Field<'a>,
    correcting: Correcting,
    ends_mm: [Vector3<f64>; 2],
    /// The longest part of a line, mm.
    longest_mm: f64,
    at_mm: [f64; 3],
    sense: Vector3<f64>,
}

/// Parts of a line without effects of short waves, and with them, mm.
const LONGEST_MM: [f64; 2] = [20.0, 0.5];
/// More moves no program is followed over: a million, and the ways to and from them.
const MOST_POINTS: usize = 1_040_000;

/// Corrects a program.
///
/// # Errors
/// When a correction is beyond the limit, or leads beyond the travel; with the block.
pub fn correct(program: &Rewriting, field: &Field, correcting: &Correcting) -> Result<Corrected> {
    let measured = Measured::by(field.errors());
    let short = usize::from(!field.errors().held.is_empty());
    let mut corrector = Corrector {
        field,
        correcting: *correcting,
        ends_mm: measured.range_mm(),
        longest_mm: LONGEST_MM[short],
        at_mm: program.moves().first().map_or([0.0; 3], |of| of.motion.start_mm.into()),
        sense: Vector3::zeros(),
    };
    // Most moves of a long program are short and stay whole; nothing else of a correction is free of the moves before it.
    let is_whole = |of: &Driven| of.zero_mm.is_some() && corrector.stays_whole(&of.motion);
    let whole: Vec<bool> = program.moves().par_iter().map(is_whole).collect();
    let mut lines: BTreeMap<usize, String> = BTreeMap::new();
    let mut told = Corrected {
        text: String::new(),
        moves: 0,
        left: 0,
        points: 0,
        largest_mm: 0.0,
        largest_line: 0,
        rms_mm: 0.0,
        far: (0, 0.0),
    };
    let mut corrected = 0_usize;
    let mut driven = Vec::with_capacity(program.moves().len());
    // Where the program was at last: what it did not tell as a move took the machine elsewhere uncorrected.
    let mut meant_mm: Option<Vector3<f64>> = None;
    let mut reference: Option<[Vector3<f64>; 2]> = None;
    for (of, whole) in program.moves().iter().zip(whole) {
        if meant_mm != Some(of.motion.start_mm) {
            corrector.at_mm = of.motion.start_mm.into();
        }
        meant_mm = Some(of.motion.end_mm);
        let Some(zero_mm) = of.zero_mm else {
            // Slides that it does not name stay where they were sent.
            let motion = &of.motion;
            let to = [0, 1, 2].map(|k| {
                let moves = (motion.end_mm[k] - motion.start_mm[k]).abs() > NO_WAY_MM;
                if moves { motion.end_mm[k] } else { corrector.at_mm[k] }
            });
            corrector.goes(to);
            driven.push(to);
            told.left += 1;
            continue;
        };
        let parts = if whole { vec![of.motion.end_mm] } else { corrector.parts(&of.motion) };
        refuse_parts(program, of, &parts, driven.len())?;
        let from = corrector.at_mm;
        // The same from move to move.
        let known = reference.filter(|[at_mm, _]| *at_mm == zero_mm);
        let [_, reference_mm] =
            known.unwrap_or_else(|| [zero_mm, corrector.error_mm(&zero_mm, &Vector3::zeros())]);
        reference = Some([zero_mm, reference_mm]);
        let mut points = Vec::with_capacity(parts.len());
        for meant in parts {
            let to = corrector.sent(program, of, &meant, &reference_mm);
            let apart_mm = (Vector3::from(to) - meant).norm();
            corrected += 1;
            refuse_far(program, of, corrector.field, &to, apart_mm, correcting.limit_mm)?;
            if apart_mm > told.largest_mm {
                (told.largest_mm, told.largest_line) = (apart_mm, of.line);
            }
            told.rms_mm += apart_mm.powi(2);
            let beyond_mm = measured.beyond_mm(&meant);
            if !measured.is_near(&meant) {
                told.far = (told.far.0 + 1, told.far.1.max(beyond_mm));
            }
            corrector.goes(to);
            // A point that the control is at already is no block of its own.
            let last: &[f64; 3] = points.last().unwrap_or(&from);
            if (0..3).any(|k| (last[k] - to[k]).abs() > NO_WAY_MM) {
                points.push(to);
            }
        }
        if points.is_empty() {
            points.push(corrector.at_mm);
        } else {
            driven.extend(&points);
        }
        told.moves += 1;
        told.points += points.len();
        let text = program.lines(of, &from, &points);
        match lines.get(&of.line) {
            Some(before) if *before != text => {
                return Err(program.refused(
                    of,
                    "this block is driven more than once, and would need another correction each time".into(),
                    "write the calls of its subprogram out, block by block",
                ));
            }
            _ => drop(lines.insert(of.line, text)),
        }
    }
    told.rms_mm = (told.rms_mm / corrected.max(1) as f64).sqrt();
    told.text = program.with(&lines);
    drop(lines);
    program.verify(&told.text, &driven)?;
    Ok(told)
}

/// Refuses a move whose parts the control would stop at, or that are too many after so many before.
fn refuse_parts(
    program: &Rewriting,
    of: &Driven,
    parts: &[Vector3<f64>],
    before: usize,
) -> Result<()> {
    if parts.len() > 1 && of.stops_between() {
        let what = "the control would stop at each of the parts that this move is divided into: G61 is in force";
        let hint = "write G64 before it, or correct with a larger tolerance";
        return Err(program.refused(of, what.into(), hint));
    }
    if before + parts.len() > MOST_POINTS {
        let what = format!("the corrected program would have more than {MOST_POINTS} moves");
        let hint = "divide the program, or correct with a larger tolerance";
        return Err(program.refused(of, what, hint));
    }
    Ok(())
}

/// A correction beyond the limit, or beyond the travel, is no correction.
fn refuse_far(
    program: &Rewriting,
    of: &Driven,
    field: &Field,
    to: &[f64; 3],
    apart_mm: f64,
    limit_mm: f64,
) -> Result<()> {
    if apart_mm.is_nan() || apart_mm > limit_mm {
        let what = format!(
            "this block would be corrected by {:.1} um, and the limit is {:.1} um",
            1e3 * apart_mm,
            1e3 * limit_mm
        );
        return Err(program.refused(of, what, "look for what is wrong with analysis, tool or work offset; `--limit` takes another limit"));
    }
    for axis in Axis::ALL {
        let [low, high] = field.errors().machine.slide(axis).travel_mm;
        let at = to[axis.index()];
        if !(low..=high).contains(&at) {
            let what = format!(
                "this block would go to {axis} {at:.4} mm, beyond the travel of {low} to {high} mm"
            );
            return Err(program.refused(
                of,
                what,
                "move the work offset away from the end of the travel",
            ));
        }
    }
    Ok(())
}

impl Corrector<'_> {
    /// Displacement at machine coordinates, beyond what was measured that of its end, mm.
    fn error_mm(&self, position_mm: &Vector3<f64>, sense: &Vector3<f64>) -> Vector3<f64> {
        let [low, high] = self.ends_mm;
        let position_mm = position_mm.sup(&low).inf(&high);
        self.field.error_mm(&Pose { position_mm, sense: *sense })
    }

    /// Where the control is sent for a point that is meant, as its numbers are written.
    fn sent(
        &self,
        program: &Rewriting,
        of: &Driven,
        meant_mm: &Vector3<f64>,
        reference_mm: &Vector3<f64>,
    ) -> [f64; 3] {
        let step_mm = 0.25 * program.step_mm(of);
        let leads = |k: usize, to_mm: f64| match to_mm - self.at_mm[k] {
            way if way > step_mm => 1.0,
            way if way < -step_mm => -1.0,
            _ => 0.0,
        };
        let target = |sense: &Vector3<f64>| {
            // The correction at the place to which it leads, not at the one that is meant.
            let mut sent_mm = *meant_mm;
            for _ in 0..2 {
                sent_mm = meant_mm - (self.error_mm(&sent_mm, sense) - reference_mm);
            }
            [0, 1, 2].map(|k| program.rounded_mm(of, sent_mm[k], k, &self.at_mm))
        };
        // As the program moves it; what stands keeps its sense.
        let mut sense = Vector3::from_fn(|k, _| match leads(k, meant_mm[k]) {
            way if way != 0.0 && (meant_mm[k] - self.at_mm[k]).abs() > SMALL_MM => way,
            _ => self.sense[k],
        });
        let mut stands = [false; 3];
        let mut turned = [false; 3];
        // Each round settles one slide at the least: it has its sense, has turned, or stands.
        for _ in 0..6 {
            let to = target(&sense);
            let astray = (0..3).find(|&k| {
                let way = leads(k, to[k]);
                !stands[k] && way != 0.0 && way * sense[k] <= 0.0
            });
            let Some(k) = astray else {
                return [0, 1, 2].map(|k| if stands[k] { self.at_mm[k] } else { to[k] });
            };
            if turned[k] {
                stands[k] = true;
                sense[k] = self.sense[k];
            } else {
                turned[k] = true;
                sense[k] = leads(k, to[k]);
            }
        }
        let to = target(&sense);
        [0, 1, 2].map(|k| if stands[k] { self.at_mm[k] } else { to[k] })
    }

    /// The machine goes there.
    fn goes(&mut self, to: [f64; 3]) {
        for (k, to_mm) in to.iter().enumerate() {
            let way = to_mm - self.at_mm[k];
            if way.abs() > NO_WAY_MM {
                self.sense[k] = way.signum();
            }
        }
        self.at_mm = to;
    }

    /// Whether a move is not divided: a rapid one, or a short line on which the correction is straight enough.
    fn stays_whole(&self, motion: &Move) -> bool {
        let is_short =
            || matches!(motion.path, Path::Line) && motion.length_mm() <= self.longest_mm;
        motion.rapid || is_short() && !self.bends(motion, [0.0, 1.0])
    }

    /// Whether the correction bends on a part by more than half of the tolerance.
    fn bends(&self, motion: &Move, ends: [f64; 2]) -> bool {
        // Senses are none of it: they change at ends of parts only.
        let at = |share: f64| self.error_mm(&motion.position_mm(share), &Vector3::zeros());
        let bent = at(0.5 * (ends[0] + ends[1])) - 0.5 * (at(ends[0]) + at(ends[1]));
        bent.norm() > 0.5 * self.correcting.tolerance_mm
    }

    /// The points that a move is divided into, its end the last.
    fn parts(&self, motion: &Move) -> Vec<Vector3<f64>> {
        let mut shares = vec![0.0];
        shares.extend(motion.extreme_shares());
        shares.push(1.0);
        let mut parts = Vec::new();
        for ends in shares.windows(2) {
            let length_mm = motion.length_mm() * (ends[1] - ends[0]);
            let by_length = (length_mm / self.longest_mm).ceil();
            let by_arc = match motion.path {
                Path::Line => 1.0,
                Path::Arc { center_mm, axis, sweep_rad } => {
                    let mut arm = motion.start_mm - center_mm;
                    arm[axis] = 0.0;
                    // Half of the tolerance is the arc's own: R (1 - cos(a / 2)) for parts of the angle a.
                    let most = (1.0
                        - 0.5 * self.correcting.tolerance_mm
                            / arm.norm().max(self.correcting.tolerance_mm))
                    .acos()
                        * 2.0;
                    (sweep_rad.abs() * (ends[1] - ends[0]) / most).ceil()
                }
            };
            let count = by_length.max(by_arc).clamp(1.0, MOST_POINTS as f64 + 1.0);
            let at = |k: f64| ends[0] + (ends[1] - ends[0]) * k / count;
            let mut k = 0.0;
            while k < count && parts.len() <= MOST_POINTS {
                self.divide(motion, [at(k), at(k + 1.0)], 0, &mut parts);
                k += 1.0;
            }
        }
        parts
    }

    /// Divides a part until the correction is straight enough on it, and tells the end of each.
    fn divide(&self, motion: &Move, ends: [f64; 2], depth: u32, parts: &mut Vec<Vector3<f64>>) {
        let middle = 0.5 * (ends[0] + ends[1]);
        if depth < DEEPEST && self.bends(motion, ends) {
            self.divide(motion, [ends[0], middle], depth + 1, parts);
            self.divide(motion, [middle, ends[1]], depth + 1, parts);
        } else {
            parts.push(if ends[1] >= 1.0 { motion.end_mm } else { motion.position_mm(ends[1]) });
        }
    }
}

/// A part is halved so often at the most.
const DEEPEST: u32 = 10;
/// What a slide moves by less than this may be its correction alone, mm.
const SMALL_MM: f64 = 0.1;
/// Less is no way but rounding, mm.
const NO_WAY_MM: f64 = 1e-7;
