//! The exact kinematic chain: from slide errors to the length between the two balls.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::axis::Axis;
use super::file::{Machine, Pivot};
use super::topology::Side;

/// Where every slide stands and from which sense it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Machine coordinates of X, Y, Z, mm.
    pub position_mm: Vector3<f64>,
    /// Sense of the last motion of X, Y, Z: +1, -1, or 0 where no motion has yet been seen.
    pub sense: Vector3<f64>,
}

/// An angle of less than this, rad, has its sine and cosine from four terms of their series to the last bit.
const SMALL_RAD: f64 = 0.01;

/// Sine and cosine. The angles of slides are some 10 urad, and these are most of what the exact chain takes.
fn sin_cos(angle_rad: f64) -> (f64, f64) {
    if angle_rad.abs() > SMALL_RAD {
        return angle_rad.sin_cos();
    }
    let square = angle_rad * angle_rad;
    let sine = angle_rad * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)));
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
    (sine, cosine)
}

/// The six errors of one slide at one pose, in directions of `F`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlideError {
    /// `EXH, EYH, EZH`, mm.
    pub translation_mm: Vector3<f64>,
    /// `EAH, EBH, ECH`, rad: `R = Rz(ECH) Ry(EBH) Rx(EAH)`.
    pub rotation_rad: Vector3<f64>,
}

impl SlideError {
    /// No error.
    pub fn zero() -> Self {
        Self { translation_mm: Vector3::zeros(), rotation_rad: Vector3::zeros() }
    }

    /// `Rz(ECH) Ry(EBH) Rx(EAH)`, multiplied out.
    fn rotation(&self) -> Rotation3<f64> {
        let [(sa, ca), (sb, cb), (sc, cc)] = <[f64; 3]>::from(self.rotation_rad).map(sin_cos);
        Rotation3::from_matrix_unchecked(Matrix3::new(
            cb * cc,
            sa * sb * cc - ca * sc,
            ca * sb * cc + sa * sc,
            cb * sc,
            sa * sb * sc + ca * cc,
            ca * sb * sc - sa * cc,
            -sb,
            sa * cb,
            ca * cb,
        ))
    }

    /// The axes about which a little more of `EAH, EBH, ECH` turns: `Rz Ry x, Rz y, z`.
    fn axes(&self) -> Matrix3<f64> {
        let [_, (sb, cb), (sc, cc)] = <[f64; 3]>::from(self.rotation_rad).map(sin_cos);
        Matrix3::new(cb * cc, -sc, 0.0, cb * sc, cc, 0.0, -sb, 0.0, 1.0)
    }
}

/// Everything that bends the chain at one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainErrors {
    /// The errors of the X, Y and Z slides.
    pub slides: [SlideError; 3],
    /// Set-up error of the workpiece ball in its slide's frame, `EXw EYw EZw`, mm.
    pub workpiece_ball_mm: Vector3<f64>,
    /// Set-up error of the tool ball in its slide's frame, `EXt EYt EZt`, mm.
    pub tool_ball_mm: Vector3<f64>,
}

impl ChainErrors {
    /// A perfect machine.
    pub fn zero() -> Self {
        Self {
            slides: [SlideError::zero(); 3],
            workpiece_ball_mm: Vector3::zeros(),
            tool_ball_mm: Vector3::zeros(),
        }
    }
}

/// How a further small error of a slide displaces the ball at the end of its side: `turn · (e + (axes · eps) × lever)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lever {
    /// What carries the slide is turned so.
    pub turn: Rotation3<f64>,
    /// About what the slide turns with `EAH, EBH, ECH`, each as the column that the rotations after it have left of it.
    pub axes: Matrix3<f64>,
    /// From the slide's pivot to the ball, in the frame of what carries the slide, mm.
    pub lever_mm: Vector3<f64>,
}

/// Where the two balls are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting {
    /// Machine coordinates at which both ball centres coincide: the zero of the work offset, mm.
    pub coincidence_mm: Vector3<f64>,
    /// Centre of the tool ball in the frame of the last slide on the tool side, mm.
    pub tool_ball_mm: Vector3<f64>,
}

impl Machine {
    /// `T_location` of a slide and its nominal motion in `F`, mm: where its frame stands on its neighbour.
    fn step_mm(&self, axis: Axis, position_mm: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let mut motion = Vector3::zeros();
        motion[axis.index()] = self.topology().side(axis).sign() * position_mm[axis.index()];
        (self.slide(axis).location_mm, motion)
    }

    /// Origin of the last slide's frame of one side at a pose without errors, in `F`, mm.
    fn last_frame_mm(&self, side: Side, position_mm: &Vector3<f64>) -> Vector3<f64> {
        self.topology().slides(side).iter().fold(Vector3::zeros(), |origin, &axis| {
            let (location, motion) = self.step_mm(axis, position_mm);
            origin + location + motion
        })
    }

    /// Centre of the workpiece ball in the frame of the last slide on the workpiece side, mm.
    pub fn workpiece_ball_mm(&self, mounting: &Mounting) -> Vector3<f64> {
        let at = &mounting.coincidence_mm;
        self.last_frame_mm(Side::Tool, at) + mounting.tool_ball_mm
            - self.last_frame_mm(Side::Workpiece, at)
    }

    /// A point of the outermost frame of one side in `F`, through the exact chain, mm:
    /// `p_F = prod(T_location · T_motion · T_error) p` with the pivot on the carriage,
    /// `T_location · T_error · T_motion` with the pivot on the base (DESIGN.md section 3).
    fn point_mm(
        &self,
        side: Side,
        position_mm: &Vector3<f64>,
        errors: &ChainErrors,
        point_mm: Vector3<f64>,
    ) -> Vector3<f64> {
        // The transforms act from the outermost frame inwards.
        self.topology().slides(side).iter().rev().fold(point_mm, |point, &axis| {
            let [from_mm, lever_mm] = self.about_pivot_mm(axis, position_mm, errors, point);
            from_mm + lever_mm
        })
    }

    /// A point that a slide carries, seen by what carries the slide, mm: the slide's pivot, and the turned way from
    /// there.
    fn about_pivot_mm(
        &self,
        axis: Axis,
        position_mm: &Vector3<f64>,
        errors: &ChainErrors,
        point_mm: Vector3<f64>,
    ) -> [Vector3<f64>; 2] {
        let (location, motion) = self.step_mm(axis, position_mm);
        let error = &errors.slides[axis.index()];
        let rotation = error.rotation();
        match self.slide(axis).pivot {
            Pivot::Carriage => [location + motion + error.translation_mm, rotation * point_mm],
            Pivot::Base => [location + error.translation_mm, rotation * (motion + point_mm)],
        }
    }

    /// The levers of the X, Y and Z slides in a chain that is bent already.
    pub fn levers(
        &self,
        mounting: &Mounting,
        position_mm: &Vector3<f64>,
        errors: &ChainErrors,
    ) -> [Lever; 3] {
        let mut levers = errors.slides.map(|slide| Lever {
            turn: Rotation3::identity(),
            axes: slide.axes(),
            lever_mm: Vector3::zeros(),
        });
        for side in [Side::Tool, Side::Workpiece] {
            let mut point_mm = match side {
                Side::Tool => mounting.tool_ball_mm + errors.tool_ball_mm,
                Side::Workpiece => self.workpiece_ball_mm(mounting) + errors.workpiece_ball_mm,
            };
            for &axis in self.topology().slides(side).iter().rev() {
                let [from_mm, lever_mm] = self.about_pivot_mm(axis, position_mm, errors, point_mm);
                levers[axis.index()].lever_mm = lever_mm;
                point_mm = from_mm + lever_mm;
            }
            let mut turn = Rotation3::identity();
            for &axis in self.topology().slides(side) {
                levers[axis.index()].turn = turn;
                turn *= errors.slides[axis.index()].rotation();
            }
        }
        levers
    }

    /// Vector from the workpiece ball to the tool ball in `F`, mm, through the exact chain.
    ///
    /// Its length is that of `w_T_t` (paper, Eq. 2): the rotation of the workpiece frame drops out.
    pub fn ball_vector_mm(
        &self,
        mounting: &Mounting,
        position_mm: &Vector3<f64>,
        errors: &ChainErrors,
    ) -> Vector3<f64> {
        let tool = mounting.tool_ball_mm + errors.tool_ball_mm;
        let workpiece = self.workpiece_ball_mm(mounting) + errors.workpiece_ball_mm;
        self.point_mm(Side::Tool, position_mm, errors, tool)
            - self.point_mm(Side::Workpiece, position_mm, errors, workpiece)
    }

    /// Lever of a slide: from its pivot to the tool ball at a pose without errors, in `F`, mm.
    pub fn lever_mm(
        &self,
        axis: Axis,
        mounting: &Mounting,
        position_mm: &Vector3<f64>,
    ) -> Vector3<f64> {
        self.levers_mm(mounting, position_mm)[axis.index()]
    }

    /// The levers of the X, Y and Z slides at a pose without errors, in `F`, mm: one walk along each side.
    pub fn levers_mm(&self, mounting: &Mounting, position_mm: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let tool_ball = self.last_frame_mm(Side::Tool, position_mm) + mounting.tool_ball_mm;
        let mut levers = [tool_ball; 3];
        for side in [Side::Tool, Side::Workpiece] {
            let mut origin = Vector3::zeros();
            for &slide in self.topology().slides(side) {
                let (location, motion) = self.step_mm(slide, position_mm);
                let base = origin + location;
                origin = base + motion;
                levers[slide.index()] -= match self.slide(slide).pivot {
                    Pivot::Carriage => origin,
                    Pivot::Base => base,
                };
            }
        }
        levers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_those_of_their_angles_small_or_not() {
        for size_rad in [0.0, 1e-9, 3e-5, 0.999 * SMALL_RAD, 1.001 * SMALL_RAD, 0.4] {
            let rotation_rad = size_rad * Vector3::new(1.0, -0.7, 0.3);
            let error = SlideError { rotation_rad, ..SlideError::zero() };
            let [a, b, c] = rotation_rad.into();
            let independent = Rotation3::from_euler_angles(a, b, c);
            let apart = (error.rotation().matrix() - independent.matrix()).amax();
            assert!(apart < 3e-16, "{size_rad}: {apart:e}");
        }
    }
}
