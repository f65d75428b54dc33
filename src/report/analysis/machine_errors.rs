//! What the coefficients say about the machine, in the words and units of its maintenance.

use serde::Serialize;

use super::means::MeanResult;
use crate::machine::{Axis, Machine};
use crate::model::{Coefficient, Component, Power};

/// Squareness, scale and reversal errors; only what was estimated.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MachineErrors {
    /// Squareness of the axes to each other.
    pub squareness: Vec<Squareness>,
    /// Scale errors of the axes.
    pub scale: Vec<Scale>,
    /// Hysteresis of displacements: backlash where the direction is the slide's own, lateral play
    /// where it is another.
    pub reversal: Vec<Reversal>,
    /// Hysteresis of rotations.
    pub angular_hysteresis: Vec<Hysteresis>,
}

/// Squareness of two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Squareness {
    /// The coefficient that models it.
    pub name: String,
    /// What the paper calls it, such as `EA(0Z)Y`.
    pub symbol: &'static str,
    /// Which axes.
    pub axes: &'static str,
    /// Angle between the positive directions of the two axes minus 90 degrees, um/m (urad).
    pub angle_minus_90_um_m: f64,
    /// The same, arcsec.
    pub angle_minus_90_arcsec: f64,
    /// Standard deviation for one repeat, um/m.
    pub sigma_um_m: Option<f64>,
    /// Standard deviation over the repeats, um/m.
    pub deviation_um_m: Option<f64>,
    /// How much of it the data determine, 0 to 1.
    pub observed: f64,
}

/// Scale error of an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scale {
    /// The coefficient.
    pub name: String,
    /// Its value, um/m.
    pub value_um_m: f64,
    /// Standard deviation for one repeat, um/m.
    pub sigma_um_m: Option<f64>,
    /// Standard deviation over the repeats, um/m.
    pub deviation_um_m: Option<f64>,
    /// How much of it the data determine, 0 to 1.
    pub observed: f64,
}

/// Hysteresis of a displacement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reversal {
    /// The coefficient.
    pub name: String,
    /// `backlash` along the slide's own axis, `lateral play` across it.
    pub kind: &'static str,
    /// The coefficient, um: half of the step at a reversal.
    pub coefficient_um: f64,
    /// The step at a reversal from negative to positive motion, um: twice the coefficient.
    pub step_um: f64,
    /// Standard deviation of the coefficient for one repeat, um.
    pub sigma_um: Option<f64>,
    /// Standard deviation of the coefficient over the repeats, um.
    pub deviation_um: Option<f64>,
    /// How much of it the data determine, 0 to 1.
    pub observed: f64,
}

/// Hysteresis of a rotation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hysteresis {
    /// The coefficient.
    pub name: String,
    /// The coefficient, urad: half of the step at a reversal.
    pub coefficient_urad: f64,
    /// The step at a reversal from negative to positive motion, urad: twice the coefficient.
    pub step_urad: f64,
    /// Standard deviation of the coefficient for one repeat, urad.
    pub sigma_urad: Option<f64>,
    /// Standard deviation of the coefficient over the repeats, urad.
    pub deviation_urad: Option<f64>,
    /// How much of it the data determine, 0 to 1.
    pub observed: f64,
}

pub(in crate::report) const ARCSEC_PER_RAD: f64 = 180.0 * 3600.0 / std::f64::consts::PI;

impl MachineErrors {
    /// Squareness of this name, um/m.
    pub(super) fn angle_um_m(&self, name: &str) -> Option<f64> {
        self.squareness.iter().find(|s| s.name == name).map(|s| s.angle_minus_90_um_m)
    }

    /// Scale error of this name, um/m.
    pub(super) fn scale_um_m(&self, name: &str) -> Option<f64> {
        self.scale.iter().find(|s| s.name == name).map(|s| s.value_um_m)
    }

    /// Step at a reversal of this name, um.
    pub(super) fn step_um(&self, name: &str) -> Option<f64> {
        self.reversal.iter().find(|r| r.name == name).map(|r| r.step_um)
    }

    /// Step of a rotation at a reversal of this name, urad.
    pub(super) fn step_urad(&self, name: &str) -> Option<f64> {
        self.angular_hysteresis.iter().find(|h| h.name == name).map(|h| h.step_urad)
    }

    /// Reads them out of the means over the repeats.
    pub(in crate::report) fn new(machine: &Machine, means: &[MeanResult]) -> Self {
        let mut errors = Self::default();
        errors.squareness.extend(squareness(machine, means));
        for mean in means {
            let Some(coefficient) = Coefficient::parse(&mean.name) else { continue };
            let own_axis = coefficient.component.direction() == coefficient.slide.index();
            let angular = coefficient.component.is_angular();
            let scaled = |value: Option<f64>, factor: f64| value.map(|v| v * factor);
            match coefficient.power {
                Power::P1 if own_axis && !angular => errors.scale.push(Scale {
                    name: mean.name.clone(),
                    value_um_m: mean.mean * 1e6,
                    sigma_um_m: scaled(mean.sigma, 1e6),
                    deviation_um_m: scaled(mean.deviation, 1e6),
                    observed: mean.observed,
                }),
                Power::B if angular => errors.angular_hysteresis.push(Hysteresis {
                    name: mean.name.clone(),
                    coefficient_urad: mean.mean * 1e6,
                    step_urad: 2.0 * mean.mean * 1e6,
                    sigma_urad: scaled(mean.sigma, 1e6),
                    deviation_urad: scaled(mean.deviation, 1e6),
                    observed: mean.observed,
                }),
                Power::B => errors.reversal.push(Reversal {
                    name: mean.name.clone(),
                    kind: if own_axis { "backlash" } else { "lateral play" },
                    coefficient_um: mean.mean * 1e3,
                    step_um: 2.0 * mean.mean * 1e3,
                    sigma_um: scaled(mean.sigma, 1e3),
                    deviation_um: scaled(mean.deviation, 1e3),
                    observed: mean.observed,
                }),
                _ => {}
            }
        }
        errors
    }
}

/// The three squarenesses, as far as their coefficients were estimated and mean that on this machine.
fn squareness(machine: &Machine, means: &[MeanResult]) -> Vec<Squareness> {
    let topology = machine.topology();
    // A constant tilt of Z is a squareness of Y only where Z carries Y; otherwise it tilts the tool alone.
    let z_carries_y = {
        let slides = topology.slides(topology.side(Axis::Z));
        let place = |axis: Axis| slides.iter().position(|slide| *slide == axis);
        matches!((place(Axis::Z), place(Axis::Y)), (Some(z), Some(y)) if z < y)
    };
    // A slide under the workpiece that leans one way makes the tool lean the other way over the workpiece.
    let z_side = topology.side(Axis::Z).sign();
    let constant = |component| Coefficient { slide: Axis::Z, component, power: Power::P0 };
    let slope = Coefficient { slide: Axis::Z, component: Component::X, power: Power::P1 };
    // Turned by +EAZ0 about X, +Y leans towards +Z; turned by +ECZ0 about Z, +Y leans away from +X.
    [
        (constant(Component::A), "EA(0Z)Y", "Y to Z", -1.0, z_carries_y),
        (constant(Component::C), "EC(0X)Y", "Y to X", 1.0, z_carries_y),
        (slope, "EB(0X)Z", "Z to X", -z_side, true),
    ]
    .into_iter()
    .filter(|(.., holds)| *holds)
    .filter_map(|(coefficient, symbol, axes, sign, _)| {
        let name = coefficient.to_string();
        let mean = means.iter().find(|mean| mean.name == name)?;
        let angle_rad = sign * mean.mean;
        Some(Squareness {
            name,
            symbol,
            axes,
            angle_minus_90_um_m: angle_rad * 1e6,
            angle_minus_90_arcsec: angle_rad * ARCSEC_PER_RAD,
            sigma_um_m: mean.sigma.map(|s| s * 1e6),
            deviation_um_m: mean.deviation.map(|s| s * 1e6),
            observed: mean.observed,
        })
    })
    .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::machine::{ChainErrors, Mounting};
    use nalgebra::Vector3;
    use std::path::Path;

    fn mean(name: &str, unit: &'static str, mean: f64) -> MeanResult {
        MeanResult {
            name: name.into(),
            unit,
            mean,
            deviation: None,
            sigma: Some(1e-6),
            observed: 1.0,
        }
    }

    #[test]
    fn lost_motion_is_twice_the_coefficient() {
        let machine = Machine::read(Path::new("machines/hu40t.toml")).unwrap();
        let means = [mean("EYYb", "mm", -0.003), mean("EYXb", "mm", 0.001)];
        let errors = MachineErrors::new(&machine, &means);
        assert_eq!(errors.reversal.len(), 2);
        assert_eq!(errors.reversal[0].kind, "backlash");
        assert!((errors.reversal[0].step_um + 6.0).abs() < 1e-12);
        assert_eq!(errors.reversal[1].kind, "lateral play");
    }

    /// Angle between the ways of the tool over the workpiece along two axes, minus 90 degrees, rad, by
    /// the exact chain.
    fn driven(machine: &Machine, name: &str, value: f64, axes: [Axis; 2]) -> f64 {
        let coefficient = Coefficient::parse(name).unwrap();
        let mounting = Mounting {
            coincidence_mm: Vector3::zeros(),
            tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
        };
        let at = |position_mm: Vector3<f64>| {
            let mut errors = ChainErrors::zero();
            let slide = &mut errors.slides[coefficient.slide.index()];
            let along = position_mm[coefficient.slide.index()];
            let error = if coefficient.power == Power::P1 { value * along } else { value };
            let direction = coefficient.component.direction();
            if coefficient.component.is_angular() {
                slide.rotation_rad[direction] = error;
            } else {
                slide.translation_mm[direction] = error;
            }
            machine.ball_vector_mm(&mounting, &position_mm, &errors)
        };
        let [a, b] = axes.map(|axis| {
            let end = Vector3::ith(axis.index(), 100.0);
            at(end) - at(-end)
        });
        a.angle(&b) - std::f64::consts::FRAC_PI_2
    }

    #[test]
    fn squareness_has_the_sign_that_the_chain_drives() {
        for file in ["machines/hu40t.toml", "machines/vertical.toml"] {
            let machine = Machine::read(Path::new(file)).unwrap();
            let means =
                [mean("EAZ0", "rad", 1e-5), mean("ECZ0", "rad", 2e-5), mean("EXZ1", "mm/mm", 3e-5)];
            for squareness in MachineErrors::new(&machine, &means).squareness {
                let axes = match squareness.axes {
                    "Y to Z" => [Axis::Y, Axis::Z],
                    "Y to X" => [Axis::Y, Axis::X],
                    _ => [Axis::Z, Axis::X],
                };
                let value = means.iter().find(|m| m.name == squareness.name).unwrap().mean;
                let angle_rad = driven(&machine, &squareness.name, value, axes);
                let told_rad = squareness.angle_minus_90_um_m * 1e-6;
                assert!((angle_rad - told_rad).abs() < 1e-8, "{file} {}", squareness.name);
            }
        }
    }

    #[test]
    fn a_tilt_of_z_is_a_squareness_only_where_z_carries_y() {
        let means = [mean("EAZ0", "rad", 1e-5), mean("EXZ1", "mm/mm", 2e-5)];
        let horizontal = Machine::read(Path::new("machines/hu40t.toml")).unwrap();
        let both = MachineErrors::new(&horizontal, &means).squareness;
        assert_eq!(both.len(), 2);
        assert!((both[0].angle_minus_90_um_m + 10.0).abs() < 1e-9);
        assert!((both[1].angle_minus_90_arcsec + 4.1253).abs() < 1e-4);
        let vertical = Machine::read(Path::new("machines/vertical.toml")).unwrap();
        let one = MachineErrors::new(&vertical, &means).squareness;
        assert_eq!(one.len(), 1, "{one:?}");
        assert_eq!(one[0].name, "EXZ1");
    }
}
