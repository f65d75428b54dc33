//! The topology string: which slide carries what.

use super::axis::Axis;
use crate::error::{Error, Result};

/// Which side of the machine frame a slide is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Carries the workpiece; moves against the programmed direction in `F`.
    Workpiece,
    /// Carries the tool; moves in the programmed direction in `F`.
    Tool,
}

impl Side {
    /// +1 on the tool side, -1 on the workpiece side: the direction in `F` of a programmed +1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Workpiece => -1.0,
            Self::Tool => 1.0,
        }
    }
}

/// The order of the slides, as `wCBXFZYSt` writes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    text: String,
    workpiece: Vec<Axis>,
    tool: Vec<Axis>,
}

impl Topology {
    /// Reads a topology string.
    ///
    /// It begins with `w` and ends with `t`, names `F`, X, Y and Z once each, and may name the rotary
    /// axes A, B, C and the spindle S. The error's place is left to the caller, who knows the file.
    pub fn parse(text: &str) -> Result<Self> {
        let wrong = |what: String| {
            Error::input(format!("topology `{text}` {what}")).hint(
                "write the chain from workpiece to tool over the machine frame, such as `wCBXFZYSt`",
            )
        };
        let inner =
            text.strip_prefix('w').and_then(|rest| rest.strip_suffix('t')).ok_or_else(|| {
                wrong("must begin with `w` (workpiece) and end with `t` (tool)".into())
            })?;
        if let Some(letter) = inner.chars().find(|&c| !"ABCSFXYZ".contains(c)) {
            return Err(wrong(format!("has the unknown letter `{letter}`")));
        }
        if let Some(letter) = "ABCSFXYZ".chars().find(|&c| inner.matches(c).count() > 1) {
            return Err(wrong(format!("names `{letter}` more than once")));
        }
        if let Some(letter) = "FXYZ".chars().find(|&c| !inner.contains(c)) {
            return Err(wrong(format!("does not name `{letter}`")));
        }
        let (left, right) =
            inner.split_once('F').ok_or_else(|| wrong("does not name `F`".into()))?;
        Ok(Self {
            text: text.to_owned(),
            // From F outwards, the order in which the transforms multiply.
            workpiece: left.chars().rev().filter_map(Axis::from_letter).collect(),
            tool: right.chars().filter_map(Axis::from_letter).collect(),
        })
    }

    /// The slides of one side, from `F` outwards.
    pub fn slides(&self, side: Side) -> &[Axis] {
        match side {
            Side::Workpiece => &self.workpiece,
            Side::Tool => &self.tool,
        }
    }

    /// The side that a slide is on.
    pub fn side(&self, axis: Axis) -> Side {
        if self.tool.contains(&axis) { Side::Tool } else { Side::Workpiece }
    }

    /// The string as it was written.
    pub fn as_str(&self) -> &str {
        &self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_left_of_the_frame_carry_the_workpiece() {
        let hu40t = Topology::parse("wCBXFZYSt").unwrap();
        assert_eq!(hu40t.slides(Side::Workpiece), [Axis::X]);
        assert_eq!(hu40t.slides(Side::Tool), [Axis::Z, Axis::Y]);
        let vertical = Topology::parse("wXYFZSt").unwrap();
        assert_eq!(vertical.slides(Side::Workpiece), [Axis::Y, Axis::X], "Y is next to the frame");
        assert_eq!(vertical.side(Axis::Z), Side::Tool);
    }

    #[test]
    fn a_wrong_string_is_told_by_its_letter() {
        for (text, part) in [
            ("CBXFZYSt", "begin with `w`"),
            ("wXFZYQt", "unknown letter `Q`"),
            ("wXFZYXt", "`X` more than once"),
            ("wXZYt", "does not name `F`"),
            ("wXFZt", "does not name `Y`"),
            ("", "begin with `w`"),
        ] {
            let error = Topology::parse(text).unwrap_err();
            assert!(error.what.contains(part), "{text}: {error}");
        }
    }
}
