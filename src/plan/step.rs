//! What a program does, step by step.

use nalgebra::Vector3;

use super::plane::Plane;

/// One step of the path. Positions are vectors from the workpiece ball to the tool ball, mm; feeds are in mm/s.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A comment in the program.
    Comment(String),
    /// Positioning at rapid traverse.
    Rapid(Vector3<f64>),
    /// Z alone at rapid traverse to this machine coordinate, mm, from wherever the machine stands.
    Retract(f64),
    /// Positioning at rapid traverse in machine coordinates, whatever the work offset holds, X and Y alone.
    Across(Vector3<f64>),
    /// A straight move at a feed.
    Feed(Vector3<f64>, f64),
    /// Chords along an arc, without its first point, at a feed.
    Chords(Vec<Vector3<f64>>, f64),
    /// A circular arc at a feed.
    Circular(Circular, f64),
    /// Stand still, s.
    Dwell(f64),
    /// Wait for the operator, with what he is asked to do.
    Stop(&'static str),
    /// Wait for the operator, who compares what the control shows with this place.
    Compare(Vector3<f64>),
    /// Look-ahead on (true) or off.
    LookAhead(bool),
}

/// A circular arc of one block, at most a whole turn, about the axis of its plane through the workpiece ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Circular {
    /// The plane that it is parallel to.
    pub plane: Plane,
    /// Angle from start to end, CCW in its plane, rad: G03 positive, G02 negative.
    pub sweep_rad: f64,
    /// Points on the way, as near to each other as the travel and what stands around ask for; the last one is its end, mm.
    pub points: Vec<Vector3<f64>>,
}

impl Step {
    /// The points that it leads through, in order; those of an arc are some of many.
    pub fn points(&self) -> &[Vector3<f64>] {
        match self {
            Self::Rapid(point) | Self::Across(point) | Self::Feed(point, _) => {
                std::slice::from_ref(point)
            }
            Self::Chords(points, _) | Self::Circular(Circular { points, .. }, _) => points,
            _ => &[],
        }
    }

    /// The points that blocks of the program end at, in order.
    pub fn ends(&self) -> &[Vector3<f64>] {
        match self {
            Self::Circular(arc, _) => &arc.points[arc.points.len().saturating_sub(1)..],
            _ => self.points(),
        }
    }
}
