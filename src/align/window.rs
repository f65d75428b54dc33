//! Means of neighbouring readings: of a fast log so many a second that nothing that is looked for gets lost.
//!
//! In a window of 20 ms a slide at 1500 mm/min goes 0.5 mm, a quarter of the shortest period that is looked for, and a
//! mean takes 10 % of such a wave; of a wave of 10 mm it takes 0.4 %. What a mean takes of a wave, a vibration among them, is
//! in the columns of its amplitudes ([`Averaged::share_of_wave`](crate::model::Averaged::share_of_wave)). All work after this does not grow with the rate of the log.

use crate::log::{Log, Reading};

/// The longest window, s.
const LONGEST_S: f64 = 0.02;

/// How many readings of this period make a window.
pub(super) fn readings(period_s: f64) -> usize {
    // Times with four decimals round a period of 1 ms by a part in ten.
    ((LONGEST_S / period_s.max(1e-6)) * (1.0 + 1e-6)).floor().max(1.0) as usize
}

/// How many readings of a log with this period a sample is the mean of, and the period of the samples, s.
pub fn averaged(period_s: f64) -> (usize, f64) {
    let count = readings(period_s);
    (count, count as f64 * period_s)
}

/// Means of so many neighbouring readings, none across a gap and none of less than half of that.
pub(super) fn means(readings: &[Reading], count: usize, period_s: f64) -> Vec<Reading> {
    if count <= 1 {
        return readings.to_vec();
    }
    let longest_s = Log::GAP_PERIODS * period_s;
    let together = |a: &Reading, b: &Reading| b.time_s - a.time_s <= longest_s;
    readings
        .chunk_by(together)
        .flat_map(|stretch| stretch.chunks(count))
        .filter(|window| 2 * window.len() > count)
        .map(mean)
        .collect()
}

fn mean(window: &[Reading]) -> Reading {
    let count = window.len() as f64;
    let line = window.first().map_or(0, |first| first.line);
    let time_s = window.iter().map(|r| r.time_s).sum::<f64>() / count;
    let sum_mm: f64 = window.iter().filter_map(|r| r.deviation_mm).sum();
    Reading { time_s, deviation_mm: Some(sum_mm / count), line }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(times_s: impl Iterator<Item = f64>) -> Vec<Reading> {
        let reading = |(k, time_s)| Reading { time_s, deviation_mm: Some(time_s), line: k + 1 };
        times_s.enumerate().map(reading).collect()
    }

    #[test]
    fn windows_are_as_long_at_every_rate() {
        for (rate_hz, count) in [(10, 1), (49, 1), (50, 1), (100, 2), (250, 5), (1000, 20)] {
            assert_eq!(readings(f64::from(rate_hz).recip()), count, "{rate_hz}");
        }
    }

    #[test]
    fn a_mean_lies_in_the_middle_of_its_readings_and_never_across_a_gap() {
        let times_s = (0..10).chain(20..33).map(|k| f64::from(k) * 1e-3);
        let means = means(&log(times_s), 5, 1e-3);
        // 0 to 4, 5 to 9, then 20 to 24, 25 to 29, and three of 30 to 32.
        let expected = [2e-3, 7e-3, 22e-3, 27e-3, 31e-3];
        assert_eq!(means.len(), expected.len());
        for (mean, at_s) in means.iter().zip(expected) {
            assert!((mean.time_s - at_s).abs() < 1e-12);
            assert!((mean.deviation_mm.unwrap_or(0.0) - at_s).abs() < 1e-12);
        }
        assert_eq!(means[2].line, 11);
    }
}
