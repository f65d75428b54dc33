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

/// A slide that comes to stand on a short chord and goes back on the next turns where that begins as long as nothing tells that corners
/// are rounded out, and half of the short chord sooner where it is told, whatever the share.
#[test]
fn a_share_that_is_not_told_turns_no_slide_sooner() {
    // A short chord across the pole does not move Z.
    let bench = Bench::fed(2750, "strategy = \"3d6\"\n");
    let run = bench.simulated(&Scenario::default());
    let mut alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    let turned_ago_s = |alignment: &Alignment| -> Vec<Option<f64>> {
        let samples = alignment.samples();
        samples.iter().map(|sample| Some(sample.motion.reversals[2]?.ago_s)).collect()
    };
    let planned_s = turned_ago_s(&alignment);
    let most_s = |rounded: &[Option<f64>]| {
        let sooner =
            rounded.iter().zip(&planned_s).filter_map(|(now, planned)| Some((*now)? - (*planned)?));
        sooner.fold(0.0, f64::max)
    };
    for (more, sigma, told) in [(1e-3, 0.1, false), (0.2, 0.1, false), (0.2, 0.02, true)] {
        alignment.time_map.rounded = 0.0;
        alignment.time_map.round_out(more, sigma);
        let sooner_s = most_s(&turned_ago_s(&alignment));
        assert_eq!(sooner_s > 5e-3, told, "{more} {sigma}: {sooner_s}");
        assert!(told || sooner_s.abs() <= 0.0, "{more} {sigma}: {sooner_s}");
    }
}
