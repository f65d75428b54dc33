//! Machines, poses and runs that the tests share.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use ballbar::machine::{Axis, Machine, Mounting, Pivot, Pose};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// A path inside the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The two machine files of the repository.
pub(crate) fn written_machines() -> Vec<Machine> {
    ["machines/hu40t.toml", "machines/vertical.toml"]
        .iter()
        .map(|file| Machine::read(&repository(file)).unwrap())
        .collect()
}

/// Topologies of no file: every slide on one side, and orders that neither machine has.
const OTHER_TOPOLOGIES: [&str; 7] =
    ["wFXYZSt", "wFZXYt", "wZYXFSt", "wYXZFt", "wYFZXSt", "wCZFYXt", "wAZXFYSt"];

/// The written machines and one for every other topology, the latter with slides that do not stand on
/// their neighbours' origins.
pub(crate) fn machines() -> Vec<Machine> {
    let mut machines = written_machines();
    for (k, topology) in OTHER_TOPOLOGIES.iter().enumerate() {
        let mut text = format!("name = \"Machine {topology}\"\ntopology = \"{topology}\"\n");
        for (i, axis) in Axis::ALL.into_iter().enumerate() {
            let at = |j: usize| ((17 * k + 7 * i + 3 * j) % 11) as f64 * 40.0 - 200.0;
            writeln!(
                text,
                "[axes.{axis}]\ntravel_mm = [-400.0, 400.0]\nrapid_mm_min = 15000.0\n\
                 acceleration_mm_s2 = 500.0\nlocation_mm = [{:.1}, {:.1}, {:.1}]",
                at(0),
                at(1),
                at(2)
            )
            .unwrap();
        }
        machines.push(Machine::parse(&text, Path::new(topology)).unwrap());
    }
    machines
}

/// A machine with all eight choices of its three pivots.
pub(crate) fn pivots(machine: &Machine) -> Vec<Machine> {
    let of = |bit: usize| if bit == 0 { Pivot::Carriage } else { Pivot::Base };
    (0..8)
        .map(|choice| {
            Axis::ALL.into_iter().fold(machine.clone(), |machine, axis| {
                machine.with_pivot(axis, of((choice >> axis.index()) & 1))
            })
        })
        .collect()
}

/// Machine coordinates anywhere in the travel, mm.
pub(crate) fn random_position_mm(machine: &Machine, random: &mut Pcg64Mcg) -> Vector3<f64> {
    Vector3::from(Axis::ALL.map(|axis| {
        let [low, high] = machine.slide(axis).travel_mm;
        random.random_range(low..high)
    }))
}

/// A pose anywhere in the travel, every slide come from either side, or not yet moved.
pub(crate) fn random_pose(machine: &Machine, random: &mut Pcg64Mcg) -> Pose {
    Pose {
        position_mm: random_position_mm(machine, random),
        sense: Vector3::from_fn(|_, _| f64::from(random.random_range(-1..=1_i32))),
    }
}

/// A mounting anywhere in the travel, with a tool ball anywhere below the spindle.
pub(crate) fn random_mounting(machine: &Machine, random: &mut Pcg64Mcg) -> Mounting {
    Mounting {
        coincidence_mm: random_position_mm(machine, random),
        tool_ball_mm: Vector3::from(
            [60.0, 60.0, 300.0].map(|reach| random.random_range(-reach..reach)),
        ),
    }
}
