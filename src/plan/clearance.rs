//! How near the bodies behind the two balls come to each other on a path.

use std::fmt;

use nalgebra::Vector3;

use super::path::Path;
use super::step::Step;
use crate::machine::{Cylinder, Machine};

/// What comes near to the support of the workpiece ball.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The holder of the tool ball.
    Tool,
    /// The spindle nose.
    SpindleNose,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tool => "tool",
            Self::SpindleNose => "spindle nose",
        })
    }
}

/// Where the bodies come nearest to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastClearance {
    /// Between the part and the support of the workpiece ball, mm; 0 where they touch.
    pub clearance_mm: f64,
    /// Which part.
    pub part: Part,
    /// The comment in the program before it, such as `APPROACH` or the name of an arc.
    pub section: String,
    /// Vector from the workpiece ball to the tool ball there, mm.
    pub ball_mm: Vector3<f64>,
}

/// A path is looked at in steps of this length, mm.
const STEP_MM: f64 = 1.0;

impl Path {
    /// The least clearance between {tool, spindle nose} and {support} of the machine file; `None` where
    /// the file does not name the support and one of the other two.
    ///
    /// The clearance changes by no more than the balls move, so a step of 1 mm finds the least to within
    /// 1 mm. Not considered: the bar itself and its two ball sockets, workpiece, fixture and machine
    /// beside these three bodies, and the way from wherever the machine stands to the first point.
    pub fn least_clearance(&self, machine: &Machine) -> Option<LeastClearance> {
        let bodies = machine.clearance();
        let support = bodies.support?;
        let parts = [(Part::Tool, bodies.tool), (Part::SpindleNose, bodies.spindle_nose)];
        let parts: Vec<(Part, Cylinder)> =
            parts.into_iter().filter_map(|(part, body)| Some((part, body?))).collect();
        let mut least: Option<LeastClearance> = None;
        let mut section = "";
        let mut from: Option<&Vector3<f64>> = None;
        // What is still to be driven before anything can be nearer.
        let mut spare_mm = 0.0;
        for step in &self.steps {
            if let Step::Comment(text) = step {
                section = text;
            }
            for to in step.points() {
                let start = from.unwrap_or(to);
                let length_mm = (to - start).norm();
                let mut along_mm = spare_mm;
                while along_mm <= length_mm {
                    let share = if length_mm > 0.0 { along_mm / length_mm } else { 0.0 };
                    let ball_mm = start.lerp(to, share);
                    let (part, clearance_mm) = parts
                        .iter()
                        .map(|(part, body)| (*part, support.distance_mm(body, &ball_mm)))
                        .min_by(|a, b| a.1.total_cmp(&b.1))?;
                    let before_mm = least.as_ref().map_or(f64::INFINITY, |l| l.clearance_mm);
                    if clearance_mm < before_mm {
                        let section = section.to_owned();
                        least = Some(LeastClearance { clearance_mm, part, section, ball_mm });
                    }
                    along_mm += (clearance_mm - before_mm).max(STEP_MM);
                }
                spare_mm = along_mm - length_mm;
                from = Some(to);
            }
        }
        least
    }
}
