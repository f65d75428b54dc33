//! What a program does, step by step.

use nalgebra::Vector3;

/// One step of the path. Positions are vectors from the workpiece ball to the tool ball, mm.
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
    /// A straight move at no more than the speed of an approach.
    Slow(Vector3<f64>),
    /// A straight move at the feed of the test.
    Feed(Vector3<f64>),
    /// Chords along an arc, without its first point.
    Chords(Vec<Vector3<f64>>),
    /// Stand still, s.
    Dwell(f64),
    /// Wait for the operator, with what he is asked to do.
    Stop(&'static str),
    /// Wait for the operator, who compares what the control shows with this place.
    Compare(Vector3<f64>),
    /// Look-ahead on (true) or off.
    LookAhead(bool),
}

impl Step {
    /// The points that it names, in order.
    pub fn points(&self) -> &[Vector3<f64>] {
        match self {
            Self::Rapid(point) | Self::Across(point) | Self::Slow(point) | Self::Feed(point) => {
                std::slice::from_ref(point)
            }
            Self::Chords(points) => points,
            _ => &[],
        }
    }
}
