//! Readings along chords.

use nalgebra::Vector3;

use super::*;
use crate::motion::Times;

/// What a sample that is the mean of many readings is laid on, is the mean of what each of them would be laid on.
#[test]
fn the_mean_of_readings_along_chords_is_that_of_each() {
    let bench = Bench::new("strategy = \"3d6\"\nchord_sag_um = 0.6\n");
    let run = bench.simulated(&Scenario::default());
    let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    let trajectory = &alignment.trajectory;
    let middle_s = alignment.sections[0].start_s + 2.0;
    for (common_s, longer) in [(0.0, 0.0), (0.006, 0.0), (0.024, 0.1)] {
        let longer = Vector3::new(longer, 0.0, -longer);
        let following = Following::new(trajectory, common_s, &longer, true);
        for (count, period_s) in [(2, 0.01), (5, 0.004), (8, 0.0025), (20, 0.001), (40, 0.0005)] {
            for step in 0..100 {
                let times = Times::about(middle_s + 0.0137 * f64::from(step), period_s, count);
                let near = trajectory.block_at(times.middle_s());
                let [mean_mm, grows_mm_s] = following.mean(trajectory, &times, near);
                let each = |k: usize| following.at(trajectory, times.at_s(k as f64), near);
                let all = (0..count)
                    .map(each)
                    .fold([Vector3::zeros(); 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
                let [expected_mm, expected_mm_s] = all.map(|sum| sum / count as f64);
                let off_um = 1e3 * (mean_mm - expected_mm).norm();
                assert!(off_um < 0.01, "{common_s} {count}: {off_um} um");
                let off_mm_s = (grows_mm_s - expected_mm_s).norm();
                assert!(off_mm_s < 0.05, "{common_s} {count}: {off_mm_s} mm/s");
            }
        }
    }
}
