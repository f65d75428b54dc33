//! What stands behind the balls, as cylinders along the axes of the machine, and whether two of them overlap.
//!
//! Tool and spindle nose stand upright, so that a cut at one height is a disc of each; of the support it is a disc or a
//! rectangle. They overlap where the cuts do at the height at which the support is widest.

use ballbar::machine::{Cylinder, Machine};

use crate::path::{Point, between, distance_mm};

/// A path is looked at in steps of this length, mm, and where the bodies are as near in finer ones.
const LOOK_MM: f64 = 1.0;
const FINE_MM: f64 = 0.05;
/// Bodies that overlap by less, or are as near, may be judged either way, mm.
const DOUBT_MM: f64 = 0.15;

/// Upright, between two heights above the tool ball.
#[derive(Debug, Clone, Copy)]
struct Upright {
    heights_mm: [f64; 2],
    radius_mm: f64,
}

/// The support: along an axis of the machine, from the workpiece ball.
#[derive(Debug, Clone, Copy)]
struct Post {
    axis: usize,
    sign: f64,
    length_mm: f64,
    radius_mm: f64,
}

/// The bodies that the machine file states.
#[derive(Debug, Clone)]
pub(crate) struct Bodies {
    upright: Vec<Upright>,
    post: Post,
}

/// What a path does to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Near {
    Apart,
    /// So near that two would say different things.
    Doubtful,
    Overlap,
}

impl Bodies {
    pub(crate) fn of(machine: &Machine) -> Option<Self> {
        let stated = machine.clearance();
        let upright = |body: &Cylinder| Upright {
            heights_mm: [body.start_mm.z, body.start_mm.z + body.length_mm],
            radius_mm: body.radius_mm,
        };
        let upright: Vec<Upright> =
            [&stated.tool, &stated.spindle_nose].into_iter().flatten().map(upright).collect();
        let support = stated.support.filter(|_| !upright.is_empty())?;
        let axis = (0..3).find(|k| support.axis[*k].abs() > 0.5).expect("an axis of the machine");
        let sign = support.axis[axis].signum();
        let post = Post { axis, sign, length_mm: support.length_mm, radius_mm: support.radius_mm };
        Some(Self { upright, post })
    }

    /// The worst on a path of straight pieces around the workpiece ball.
    pub(crate) fn along(&self, corners: &[Point], centre_mm: Point) -> Near {
        let mut worst = Near::Apart;
        for pair in corners.windows(2) {
            let length_mm = distance_mm(pair[0], pair[1]);
            let from_ball = |along_mm: f64| -> Point {
                let share = if length_mm > 0.0 { (along_mm / length_mm).min(1.0) } else { 0.0 };
                let at = between(pair[0], pair[1], share);
                std::array::from_fn(|k| at[k] - centre_mm[k])
            };
            for look in 0..=(length_mm / LOOK_MM) as usize {
                let along_mm = look as f64 * LOOK_MM;
                if !self.overlap(from_ball(along_mm), LOOK_MM) {
                    continue;
                }
                for fine in 0..=(LOOK_MM / FINE_MM) as usize {
                    let ball = from_ball(along_mm + fine as f64 * FINE_MM);
                    worst = worst.max(match () {
                        () if self.overlap(ball, -DOUBT_MM) => Near::Overlap,
                        () if self.overlap(ball, DOUBT_MM) => Near::Doubtful,
                        () => Near::Apart,
                    });
                }
            }
        }
        worst
    }

    /// Whether any two overlap with the tool ball there, from the workpiece ball, and the support wider by this.
    fn overlap(&self, ball: Point, wider_mm: f64) -> bool {
        self.upright.iter().any(|part| self.overlaps(part, ball, wider_mm))
    }

    /// With the support wider and longer by this everywhere.
    fn overlaps(&self, part: &Upright, ball: Point, wider_mm: f64) -> bool {
        let [low, high] = part.heights_mm.map(|height_mm| ball[2] + height_mm);
        let Post { axis, sign, length_mm, radius_mm } = self.post;
        let (from, to) = (-wider_mm, length_mm + wider_mm);
        let [from, to] = if sign > 0.0 { [from, to] } else { [-to, -from] };
        let radius_mm = radius_mm + wider_mm;
        if axis == 2 {
            return low < to && from < high && ball[0].hypot(ball[1]) < part.radius_mm + radius_mm;
        }
        let height_mm = 0.0_f64.clamp(low, high);
        if height_mm.abs() >= radius_mm {
            return false;
        }
        let half_mm = (radius_mm.powi(2) - height_mm.powi(2)).sqrt();
        let (along, across) = (ball[axis], ball[1 - axis]);
        let beside = along - along.clamp(from, to);
        let aside = across - across.clamp(-half_mm, half_mm);
        beside.hypot(aside) < part.radius_mm
    }
}
