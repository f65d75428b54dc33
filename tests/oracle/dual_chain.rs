//! The exact chain written a second time, straight from the paper's Eq. 1 and 2: products of 4x4
//! homogeneous transforms in numbers that carry their own derivative.
//!
//! Nothing of the room `machine` takes part but the description of the machine: its topology is read
//! from the string here, the place of the workpiece ball is found with transforms.

use ballbar::machine::{Axis, Machine, Mounting, Pivot, Pose};
use ballbar::model::{Ball, Coefficient, Component, Power, SetUp};
use nalgebra::{Matrix4, Vector3, Vector4};
use num_dual::{Dual64, DualNum};

/// What a derivative is taken with respect to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Column {
    /// One of the 90.
    Coefficient(Coefficient),
    /// One of the six.
    SetUp(SetUp),
}

impl Column {
    /// All 96.
    pub(crate) fn all() -> Vec<Self> {
        Coefficient::all().map(Self::Coefficient).chain(SetUp::all().map(Self::SetUp)).collect()
    }
}

/// The 96 numbers, in the order of [`Column::all`].
pub(crate) struct Values(Vec<Dual64>);

impl Values {
    /// Plain numbers.
    pub(crate) fn plain(values: &[f64]) -> Self {
        Self(values.iter().map(|value| Dual64::from(*value)).collect())
    }

    /// Zeros, the one at `index` with the derivative 1.
    pub(crate) fn seeded(index: usize) -> Self {
        Self::seeded_at(&[0.0; 96], index)
    }

    /// These numbers, the one at `index` with the derivative 1.
    pub(crate) fn seeded_at(values: &[f64], index: usize) -> Self {
        let mut all = Self::plain(values);
        all.0[index] = Dual64::from(values[index]).derivative();
        all
    }

    fn coefficient(&self, slide: Axis, component: Component, power: Power) -> Dual64 {
        self.0[slide.index() * 30 + component as usize * 5 + power as usize]
    }

    fn ball(&self, ball: Ball) -> [Dual64; 3] {
        let first = if ball == Ball::Workpiece { 90 } else { 93 };
        [0, 1, 2].map(|i| self.0[first + i])
    }

    /// `E_IH = E_IH0 + E_IH1 h + E_IH2 h² + E_IH3 h³ + b E_IHb` (Eq. 3).
    fn error(&self, slide: Axis, component: Component, pose: &Pose) -> Dual64 {
        let (h, b) = (pose.position_mm[slide.index()], pose.sense[slide.index()]);
        let of = |power| self.coefficient(slide, component, power);
        of(Power::P0)
            + of(Power::P1) * h
            + of(Power::P2) * h.powi(2)
            + of(Power::P3) * h.powi(3)
            + of(Power::B) * b
    }
}

type Transform = Matrix4<Dual64>;

fn translation(by: [Dual64; 3]) -> Transform {
    let mut transform = Transform::identity();
    for (i, value) in by.into_iter().enumerate() {
        transform[(i, 3)] = value;
    }
    transform
}

fn constant(by: &Vector3<f64>) -> Transform {
    translation([by.x, by.y, by.z].map(Dual64::from))
}

/// Rotation about one axis: the other two follow it in cyclic order.
fn rotation(axis: usize, angle: Dual64) -> Transform {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let (sin, cos) = (angle.sin(), angle.cos());
    let mut transform = Transform::identity();
    transform[(j, j)] = cos;
    transform[(k, k)] = cos;
    transform[(j, k)] = -sin;
    transform[(k, j)] = sin;
    transform
}

/// The inverse of a rigid transform: the rotation transposed, the translation turned back.
fn inverse(of: &Transform) -> Transform {
    let mut inverse = Transform::identity();
    for i in 0..3 {
        for j in 0..3 {
            inverse[(i, j)] = of[(j, i)];
        }
        inverse[(i, 3)] = -(0..3).fold(Dual64::from(0.0), |sum, j| sum + of[(j, i)] * of[(j, 3)]);
    }
    inverse
}

/// `T_location · T_motion · T_error`, or with the error before the motion (Eq. 1).
fn slide(machine: &Machine, axis: Axis, sign: f64, pose: &Pose, values: &Values) -> Transform {
    let mut motion = Vector3::zeros();
    motion[axis.index()] = sign * pose.position_mm[axis.index()];
    let error = |component| values.error(axis, component, pose);
    let errors = translation([Component::X, Component::Y, Component::Z].map(error))
        * rotation(2, error(Component::C))
        * rotation(1, error(Component::B))
        * rotation(0, error(Component::A));
    let location = constant(&machine.slide(axis).location_mm);
    match machine.slide(axis).pivot {
        Pivot::Carriage => location * constant(&motion) * errors,
        Pivot::Base => location * errors * constant(&motion),
    }
}

/// The transforms of both branches, from `F` to the last slide: workpiece side, tool side.
fn branches(machine: &Machine, pose: &Pose, values: &Values) -> [Transform; 2] {
    let text = machine.topology().as_str();
    let frame = text.find('F').unwrap();
    let chain = |letters: String, sign: f64| {
        letters
            .chars()
            .filter_map(Axis::from_letter)
            .fold(Transform::identity(), |t, axis| t * slide(machine, axis, sign, pose, values))
    };
    [chain(text[..frame].chars().rev().collect(), -1.0), chain(text[frame..].to_owned(), 1.0)]
}

/// `w_T_t = (F_T_X X_T_w)^-1 (F_T_Z Z_T_Y Y_T_t)` (Eq. 2): where the tool ball is seen from the
/// workpiece ball, mm.
pub(crate) fn tool_from_workpiece(
    machine: &Machine,
    mounting: &Mounting,
    pose: &Pose,
    values: &Values,
) -> [Dual64; 3] {
    // Where both ball centres coincide without errors, the workpiece ball is where the tool ball is.
    let at = Pose { position_mm: mounting.coincidence_mm, sense: Vector3::zeros() };
    let [workpiece, tool] = branches(machine, &at, &Values::plain(&[0.0; 96]));
    let tool_ball = constant(&mounting.tool_ball_mm);
    let workpiece_ball = inverse(&workpiece) * tool * tool_ball;

    let [workpiece, tool] = branches(machine, pose, values);
    let w = workpiece * workpiece_ball * translation(values.ball(Ball::Workpiece));
    let t = tool * tool_ball * translation(values.ball(Ball::Tool));
    let origin = Vector4::new(0.0, 0.0, 0.0, 1.0).map(Dual64::from);
    let seen = inverse(&w) * t * origin;
    [seen[0], seen[1], seen[2]]
}

/// Length between the balls and its derivative, mm.
pub(crate) fn length(
    machine: &Machine,
    mounting: &Mounting,
    pose: &Pose,
    values: &Values,
) -> Dual64 {
    let [x, y, z] = tool_from_workpiece(machine, mounting, pose, values);
    (x * x + y * y + z * z).sqrt()
}
