//! What speed and acceleration a move and a corner allow.

use nalgebra::Vector3;

use crate::machine::{Axis, Machine};
use crate::nc::{Move, Path};

/// A component of a direction below this is rounding.
const NO_MOTION: f64 = 1e-12;

/// The limits along one move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    /// Highest speed, mm/s.
    pub(super) speed_mm_s: f64,
    /// Acceleration along the path, mm/s².
    pub(super) acceleration_mm_s2: f64,
}

/// The limits of a move of a length.
///
/// A rapid goes as fast as its slowest axis lets it. At feed the programmed feed counts, and where the
/// machine file gives them, what each axis can do, the centripetal acceleration of an arc, and the time
/// that the control needs for a block.
pub(super) fn of(machine: &Machine, motion: &Move, length_mm: f64, feed_override: f64) -> Limits {
    let along = largest_components(motion);
    let slowest = |limit: &dyn Fn(Axis) -> f64| {
        Axis::ALL
            .into_iter()
            .filter(|axis| along[axis.index()] > NO_MOTION)
            .map(|axis| limit(axis) / along[axis.index()])
            .fold(f64::INFINITY, f64::min)
    };
    if motion.rapid {
        return Limits {
            speed_mm_s: slowest(&|axis| machine.slide(axis).rapid_mm_s),
            acceleration_mm_s2: slowest(&|axis| machine.slide(axis).acceleration_mm_s2),
        };
    }
    let controller = machine.controller();
    let acceleration_mm_s2 = controller
        .path_acceleration_mm_s2
        .min(slowest(&|axis| machine.slide(axis).feed_acceleration_mm_s2));
    let mut speed_mm_s =
        (motion.feed_mm_s * feed_override).min(slowest(&|axis| machine.slide(axis).max_feed_mm_s));
    if controller.block_time_s > 0.0 {
        speed_mm_s = speed_mm_s.min(length_mm / controller.block_time_s);
    }
    if let Path::Arc { center_mm, axis, .. } = motion.path {
        let mut arm = motion.start_mm - center_mm;
        arm[axis] = 0.0;
        let across = Axis::ALL
            .into_iter()
            .filter(|across| across.index() != axis)
            .map(|across| machine.slide(across).feed_acceleration_mm_s2)
            .fold(f64::INFINITY, f64::min);
        speed_mm_s = speed_mm_s.min((across * arm.norm()).sqrt());
    }
    Limits { speed_mm_s, acceleration_mm_s2 }
}

/// The largest size of each component of the unit tangent along a move.
fn largest_components(motion: &Move) -> Vector3<f64> {
    let ends = motion.at(0.0).1.abs().sup(&motion.at(1.0).1.abs());
    motion
        .extreme_shares()
        .into_iter()
        .fold(ends, |largest, share| largest.sup(&motion.at(share).1.abs()))
}

/// The speed at the corner between two moves, mm/s: 0 where the machine stops there.
///
/// A corner sharper than `corner_stop_deg` is a stop. Others are taken at full speed, or so fast that
/// the speed of no axis jumps by more than `corner_speed_step_mm_min`, and that the arc which rounds the
/// corner within `corner_tolerance_um` asks for no more than the acceleration `a` of the path: with the
/// angle `c` between the directions and the tolerance `P`, `v² = a P / (1/cos(c/2) - 1)`.
pub(super) fn at_corner(machine: &Machine, before: &Move, after: &Move) -> f64 {
    let (arriving, leaving) = (before.at(1.0).1, after.at(0.0).1);
    let controller = machine.controller();
    let corner_rad = arriving.dot(&leaving).clamp(-1.0, 1.0).acos();
    if before.rapid || after.rapid || before.exact_stop || corner_rad > controller.corner_stop_rad {
        return 0.0;
    }
    let jump = (leaving - arriving).amax();
    if jump <= NO_MOTION {
        return f64::INFINITY;
    }
    let radius_mm = controller.corner_tolerance_mm / (1.0 / (0.5 * corner_rad).cos() - 1.0);
    let rounded_mm_s = (controller.path_acceleration_mm_s2 * radius_mm).sqrt();
    rounded_mm_s.min(controller.corner_speed_step_mm_s / jump)
}
