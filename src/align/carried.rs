//! What slides that follow late still have to catch up where an arc begins.
//!
//! A feed-in at the speed `v` leaves slides of the time constant `T` behind by `v T`, and without a dwell they bring that onto the
//! arc: the bar reads `v T exp(-t / T)` too much or too little, 45 um at the first reading and none a third of a second
//! later. It tells of nothing but of the lag, and takes from a fit that does not know it what belongs to others.

use super::run::Rig;
use crate::motion::Trajectory;

/// Within which time constant slides plausibly follow, s.
pub const FOLLOWING_S: f64 = 0.02;
/// And no later than this, two of those.
const LATEST_S: f64 = 2.0 * FOLLOWING_S;
/// What came before is looked at in such steps, s.
const STEP_S: f64 = 1e-3;
/// And so many time constants back: of a millimetre no reading sees a part in a million.
const CONSTANTS: f64 = 14.0;
/// What is less than this does little to one reading beside its noise, mm.
const SEEN_MM: f64 = 1e-4;

/// For how long after the begin of an arc the bar may read what slides had to catch up there, s. Its mean delay of a time
/// constant is in the time of a reading already.
pub(super) fn carried_s(trajectory: &Trajectory, rig: &Rig, start_s: f64) -> f64 {
    let deviation_mm =
        |before_s: f64| rig.commanded_deviation_mm(&trajectory.at(start_s - before_s).position_mm);
    let most = (CONSTANTS * LATEST_S).min(start_s) / STEP_S;
    let steps_s = (0..most as usize).map(|k| k as f64 * STEP_S);
    let behind = steps_s.map(|before_s| {
        let went_mm = deviation_mm(before_s) - deviation_mm(before_s + STEP_S);
        went_mm * (-(before_s + 0.5 * STEP_S) / LATEST_S).exp()
    });
    let behind_mm = behind.sum::<f64>().abs();
    (LATEST_S * ((behind_mm / SEEN_MM).ln() - 1.0)).max(0.0)
}
