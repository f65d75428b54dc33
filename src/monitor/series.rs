//! A quantity over time, and its trend.

use jiff::civil::Date;

use super::chance::of_student;
use super::changes::Judged;
use super::thresholds::{APART, LEAST_POINTS, TOLD};
use crate::identify::SEEN;

/// A quantity over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// In the order of the days.
    pub points: Vec<Point>,
    /// `None` where there are too few tests alike, or all on one day.
    pub trend: Option<Trend>,
}

/// A value on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Which test, by its number in the history.
    pub test: usize,
    /// The day.
    pub day: Date,
    /// Which tests are equal to it: those of the same number.
    pub kind: usize,
    /// The value.
    pub value: f64,
    /// Standard deviation by the noise, and at least by the scatter of repeats.
    pub noise: Option<f64>,
    /// Standard deviation by all that is not known.
    pub all: Option<f64>,
    /// Standard deviation of what was plausible beforehand.
    pub plausible: Option<f64>,
}

/// A line through a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Slope, unit a year.
    pub per_year: f64,
    /// Its standard deviation by the noise, and at least by the scatter about the line.
    pub noise: f64,
    /// Its standard deviation: noise, and what may have drifted with it that the tests cannot tell from it.
    pub sigma: f64,
    /// The scatter about the line in units of the noise; 1 where noise is all.
    pub scatter: f64,
    /// The line on the first day and on the last, of the kind of test that has most points.
    pub line: [f64; 2],
    /// Whether it is one.
    pub judged: Judged,
}

/// Days of a year.
const YEAR: f64 = 365.25;

impl Trend {
    /// The line of least squares with one slope, and a height of its own for every kind of test: what a test cannot tell
    /// from other faults is the same in all tests that are equal to it, and moves them all alike.
    ///
    /// `beyond` is what chance exceeds in normal numbers seldom enough.
    pub(super) fn through(points: &[Point], beyond: f64) -> Option<Self> {
        let day = |point: &Point| f64::from(days_between(points[0].day, point.day));
        let weighted: Vec<(usize, f64, f64, f64)> = points
            .iter()
            .filter_map(|point| {
                let noise = point.noise.filter(|noise| *noise > 0.0)?;
                Some((point.kind, day(point), point.value, noise.powi(-2)))
            })
            .collect();
        let mut kinds: Vec<usize> = weighted.iter().map(|(kind, ..)| *kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let middle = |kind: usize| {
            let of = || weighted.iter().filter(move |(k, ..)| *k == kind);
            let weight: f64 = of().map(|(.., w)| w).sum();
            let time = of().map(|(_, t, _, w)| w * t).sum::<f64>() / weight;
            let value = of().map(|(_, _, y, w)| w * y).sum::<f64>() / weight;
            (time, value, of().count())
        };
        let middles: Vec<(f64, f64, usize)> = kinds.iter().map(|kind| middle(*kind)).collect();
        let about = |kind: usize| {
            kinds.iter().position(|k| *k == kind).map_or((0.0, 0.0, 0), |index| middles[index])
        };
        let freedom = weighted.len().checked_sub(kinds.len() + 1)?;
        if weighted.len() < LEAST_POINTS || freedom == 0 {
            return None;
        }
        let mut spread = 0.0;
        let mut product = 0.0;
        for (kind, time, value, weight) in &weighted {
            let (t, y, _) = about(*kind);
            spread += weight * (time - t).powi(2);
            product += weight * (time - t) * (value - y);
        }
        if !(spread > 0.0 && spread.is_finite()) {
            return None;
        }
        let slope = product / spread;
        let squares: f64 = weighted
            .iter()
            .map(|(kind, time, value, weight)| {
                let (t, y, _) = about(*kind);
                weight * (value - y - slope * (time - t)).powi(2)
            })
            .sum();
        let scatter = (squares / freedom as f64).sqrt();
        let sigma = scatter.max(1.0) / spread.sqrt();
        let (t, y, _) = *middles.iter().max_by_key(|(.., count)| *count)?;
        let last = points.last().map_or(0.0, day);
        Some(Self {
            per_year: slope * YEAR,
            noise: sigma * YEAR,
            sigma: sigma * YEAR,
            scatter,
            line: [y - slope * t, y + slope * (last - t)],
            judged: if slope.abs() > of_student(beyond, freedom) * sigma {
                Judged::Changed
            } else {
                Judged::Same
            },
        })
    }
}

impl Series {
    /// The least that a test tells of it, of what is plausible; `None` where one does not say.
    fn told(&self) -> Option<f64> {
        let told = |point: &Point| {
            Some(1.0 - (point.all? / point.plausible.filter(|p| *p > 0.0)?).powi(2))
        };
        self.points.iter().map(told).try_fold(1.0_f64, |least, told| Some(least.min(told?)))
    }

    /// Whether every test tells something of it.
    pub fn is_seen(&self) -> bool {
        self.told().is_none_or(|told| told > SEEN)
    }

    fn plausible(&self) -> Option<f64> {
        self.points.last()?.plausible.filter(|plausible| *plausible > 0.0)
    }

    /// What the last test leaves open besides noise.
    fn open(&self) -> Option<f64> {
        let last = self.points.last()?;
        Some((last.all?.powi(2) - last.noise?.powi(2)).max(0.0).sqrt())
    }

    fn drifting(&self) -> Option<Trend> {
        self.trend.filter(|trend| trend.judged == Judged::Changed)
    }

    /// Judges trends beside each other: where one drifts, what looks like it may drift by the same share of what is
    /// plausible.
    pub(super) fn judge_all(all: &mut [Self]) {
        let told = |of: &&Self| of.told().is_some_and(|told| told > TOLD);
        let shares = all.iter().filter(told);
        let shares = shares.filter_map(|of| Some(of.drifting()?.per_year.abs() / of.plausible()?));
        let share = shares.fold(0.0, f64::max);
        for of in all {
            // Values of circular tests, and named terms, are not taken for anything plausible.
            let (Some(told), Some(open)) = (of.told(), of.open()) else { continue };
            let Some(trend) = &mut of.trend else { continue };
            trend.sigma = trend.noise.hypot(share * open);
            let apart = trend.per_year.abs() > APART * trend.sigma && told > TOLD;
            if trend.judged == Judged::Changed && !apart {
                trend.judged = Judged::WithIt;
            }
        }
    }
}

/// Whole days from one to another.
pub(super) fn days_between(from: Date, to: Date) -> i32 {
    (to - from).get_days()
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;

    fn at(month: i8, kind: usize, value: f64, noise: f64) -> Point {
        Point {
            test: 0,
            day: date(2026, month, 1),
            kind,
            value,
            noise: Some(noise),
            all: None,
            plausible: None,
        }
    }

    #[test]
    fn a_line_has_the_slope_that_was_put_in() {
        let value = |month: i8| {
            3.0 + 0.01 * f64::from(days_between(date(2026, 1, 1), date(2026, month, 1)))
        };
        let points: Vec<Point> = (1..=12).map(|month| at(month, 0, value(month), 0.1)).collect();
        let trend = Trend::through(&points, 3.0).unwrap();
        assert!(
            (trend.per_year - 3.6525).abs() < 1e-9 && trend.judged == Judged::Changed,
            "{trend:?}"
        );
        assert!((trend.line[0] - 3.0).abs() < 1e-9, "{trend:?}");
        assert!((trend.line[1] - value(12)).abs() < 1e-9, "{trend:?}");
        // By the noise alone: 0.1 over the spread of the days.
        let days: Vec<f64> =
            points.iter().map(|p| f64::from(days_between(points[0].day, p.day))).collect();
        let mean = days.iter().sum::<f64>() / 12.0;
        let spread: f64 = days.iter().map(|d| (d - mean).powi(2)).sum();
        assert!((trend.sigma / (0.1 / spread.sqrt() * 365.25) - 1.0).abs() < 1e-9);
    }

    /// Another place has another offset; that is no trend.
    #[test]
    fn tests_of_another_kind_have_a_height_of_their_own() {
        let points: Vec<Point> = (1..=8)
            .map(|m| at(m, usize::from(m > 4), if m > 4 { 50.0 } else { 0.0 }, 0.1))
            .collect();
        let trend = Trend::through(&points, 3.0).unwrap();
        assert!(trend.per_year.abs() < 1e-9 && trend.judged == Judged::Same, "{trend:?}");
        let alone: Vec<Point> = (1..=4).map(|m| at(m, m as usize, f64::from(m), 0.1)).collect();
        assert_eq!(Trend::through(&alone, 3.0), None);
    }

    /// What scatters by more than the noise is no trend for being far apart.
    #[test]
    fn scatter_counts() {
        let values = [0.0, 5.0, -4.0, 6.0, -3.0, 4.0];
        let points: Vec<Point> = (1..=6).map(|m| at(m, 0, values[m as usize - 1], 0.01)).collect();
        let trend = Trend::through(&points, 3.0).unwrap();
        assert!(trend.scatter > 100.0 && trend.judged == Judged::Same, "{trend:?}");
    }

    #[test]
    fn days_on_end_have_no_slope() {
        let points: Vec<Point> =
            (1..=4).map(|m| Point { day: date(2026, 1, 1), ..at(m, 0, 1.0, 0.1) }).collect();
        assert_eq!(Trend::through(&points, 3.0), None);
    }
}
