//! From a ball position to axis positions and back through the exact chain.

use ballbar::error::Kind;
use ballbar::machine::{Axis, ChainErrors, Mounting};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::common::{machines, pivots, random_mounting, written_machines};

#[test]
fn forward_after_inverse_comes_back_to_the_ball() {
    for (seed, machine) in machines().iter().enumerate() {
        let variants = pivots(machine);
        let mut random = Pcg64Mcg::seed_from_u64(seed as u64);
        let (mut worst_mm, mut inside): (f64, usize) = (0.0, 0);
        for k in 0..4000 {
            let variant = &variants[k % variants.len()];
            let mounting = random_mounting(variant, &mut random);
            let ball_mm = Vector3::from_fn(|_, _| random.random_range(-300.0..300.0));
            let Ok(position) = variant.axis_positions_mm(&mounting, &ball_mm) else { continue };
            let forward = variant.ball_vector_mm(&mounting, &position, &ChainErrors::zero());
            worst_mm = worst_mm.max((forward - ball_mm).norm());
            inside += 1;
        }
        println!("{:<10} {inside} poses, worst {worst_mm:.1e} mm", machine.topology().as_str());
        assert!(inside > 400, "only {inside} poses were inside the travel");
        assert!(worst_mm < 1e-9, "{}: off by {worst_mm:.2e} mm", machine.name());
    }
}

/// ISO 841: the programmed sense is that of the tool relative to the workpiece, whichever of the two
/// the slide carries.
#[test]
fn a_programmed_plus_moves_the_tool_that_way_relative_to_the_workpiece() {
    for machine in machines() {
        let mounting = Mounting {
            coincidence_mm: Vector3::zeros(),
            tool_ball_mm: Vector3::new(1.0, 2.0, -90.0),
        };
        for axis in Axis::ALL {
            let mut ball_mm = Vector3::zeros();
            ball_mm[axis.index()] = 10.0;
            let position = machine.axis_positions_mm(&mounting, &ball_mm).unwrap();
            assert!(position[axis.index()] > 0.0);
            let forward = machine.ball_vector_mm(&mounting, &position, &ChainErrors::zero());
            assert!((forward - ball_mm).norm() < 1e-12, "{} {axis}", machine.name());
        }
    }
}

#[test]
fn a_pose_beyond_the_travel_names_the_axis_and_by_how_much() {
    for machine in written_machines() {
        for axis in Axis::ALL {
            let i = axis.index();
            let [low, high] = machine.slide(axis).travel_mm;
            for (at_mm, beyond) in [(high + 12.345, "12.345"), (low - 0.5, "0.500")] {
                let mounting = Mounting {
                    coincidence_mm: Vector3::zeros(),
                    tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
                };
                let mut ball_mm = Vector3::zeros();
                ball_mm[i] = at_mm;
                let error = machine.axis_positions_mm(&mounting, &ball_mm).unwrap_err();
                assert_eq!(error.kind, Kind::Input);
                for part in [
                    format!("axis {axis}"),
                    format!("{at_mm:.3} mm"),
                    format!("{beyond} mm beyond"),
                    format!("{low} to {high} mm"),
                ] {
                    assert!(error.what.contains(&part), "`{part}` is not in `{}`", error.what);
                }
                assert!(error.hint.is_some_and(|hint| hint.contains(axis.letter())));
                // The limit itself is still inside.
                ball_mm[i] = if at_mm > high { high } else { low };
                assert!(machine.axis_positions_mm(&mounting, &ball_mm).is_ok());
            }
        }
    }
}
