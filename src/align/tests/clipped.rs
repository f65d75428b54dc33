//! Readings at one limit: cut off, or of a machine that stands.

use nalgebra::Vector3;

use super::*;
use crate::log::Reading;
use crate::model::ErrorFunctions;
use crate::simulate::Noise;

/// The ball stands off towards where the machine dwells between the two ways of the equator: it reads least there, one value
/// in steps of 1 um, for 3 s. Those readings are right, and without them the bar would seem to have been released.
#[test]
fn a_machine_may_stand_at_the_lowest_reading() {
    let bench = Bench::new(ARCS);
    for (seed, rate_hz) in [(1, 50.0), (2, 250.0), (3, 1000.0)] {
        let scenario = Scenario {
            workpiece_ball_mm: Vector3::new(0.2997, 0.0, 0.0),
            errors: ErrorFunctions::default(),
            tool_ball_mm: Vector3::zeros(),
            noise: Noise { white_mm: 2e-5, ..Noise::OFF },
            sample_rate_hz: Some(rate_hz),
            resolution_mm: Some(1e-3),
            ..Scenario::default().with_seed(seed)
        };
        let run = bench.simulated(&scenario);
        let log = log_of(&run.csv());
        let (_, cut) = clipped(&log).unwrap();
        let standing = |readings: &[Reading]| {
            readings.iter().filter(|reading| reading.deviation_mm == Some(-0.3)).count()
        };
        assert!(standing(&cut) as f64 > 2.9 * rate_hz, "seed {seed}");
        let alignment = bench.aligned(&log).unwrap();
        assert_eq!(standing(&alignment.clipped), 0, "seed {seed}");
        assert!(worst_sigmas(&alignment, &run) < 3.0, "seed {seed}");
    }
}
