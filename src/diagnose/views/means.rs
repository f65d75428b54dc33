//! The residual against everything that an effect may hang on, as means over stretches.

use rayon::prelude::*;

use super::sample::Shown;
use super::view::{Bin, Subject, View, ViewKind};
use crate::machine::Axis;
use crate::model::Variable;

/// Bins of the closest look; halved as long as that foretells more.
const BINS: usize = 512;
/// Fewer than this are never taken.
const FEWEST: usize = 32;
/// A bin is shown if it weighs this much of the heaviest.
const WORTH_SHOWING: f64 = 0.02;

/// How a sample counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Weight {
    One,
    Sense(Axis),
    Along(Axis),
    AlongSense(Axis, Axis),
    Way,
}

impl Weight {
    fn of(self, shown: &Shown) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Sense(axis) => shown.sense[axis.index()],
            Self::Along(axis) => shown.direction[axis.index()],
            Self::AlongSense(along, of) => shown.direction[along.index()] * shown.sense[of.index()],
            Self::Way => shown.way,
        }
    }

    fn name(self) -> String {
        match self {
            Self::One => String::new(),
            Self::Sense(axis) => format!("by the sense of {axis}"),
            Self::Along(axis) => format!("along {axis}"),
            Self::AlongSense(along, of) => format!("along {along} by the sense of {of}"),
            Self::Way => "half the difference of both ways".into(),
        }
    }
}

/// What a view is against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    Position(Axis),
    Velocity(Axis),
    SinceReversal(Axis),
    Elapsed,
    Azimuth,
    Polar,
    Feed,
    /// The angle on a circle; its index.
    Circle(usize),
}

impl Against {
    /// `None` where a sample has no place in the view.
    fn of(self, shown: &Shown) -> Option<f64> {
        match self {
            Self::Position(axis) => Some(shown.position_mm[axis.index()]),
            Self::Velocity(axis) => Some(shown.velocity_mm_s[axis.index()]),
            Self::SinceReversal(axis) => shown.since_reversal_s[axis.index()],
            Self::Elapsed => Some(shown.elapsed_s),
            Self::Azimuth => Some(shown.azimuth_deg),
            Self::Polar => Some(shown.polar_deg),
            Self::Feed => Some(shown.feed_mm_min),
            Self::Circle(circle) => (shown.circle == circle).then_some(shown.on_circle_deg),
        }
    }

    fn name(self, circles: &[String]) -> String {
        match self {
            Self::Position(axis) => Variable::Position(axis).to_string(),
            Self::Velocity(axis) => Variable::Velocity(axis).to_string(),
            Self::SinceReversal(axis) => Variable::SinceReversal(axis).to_string(),
            Self::Elapsed => Variable::Elapsed.to_string(),
            Self::Azimuth => "azimuth of the bar".to_owned(),
            Self::Polar => "polar angle of the bar".to_owned(),
            Self::Feed => "feed".to_owned(),
            Self::Circle(circle) => format!("angle on {}", circles[circle]),
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Position(_) => "mm",
            Self::Velocity(_) => "mm/s",
            Self::SinceReversal(_) | Self::Elapsed => "s",
            Self::Azimuth | Self::Polar | Self::Circle(_) => "deg",
            Self::Feed => "mm/min",
        }
    }

    fn subject(self) -> Subject {
        match self {
            Self::Position(_) => Subject::Position,
            Self::Velocity(_) => Subject::Velocity,
            Self::SinceReversal(axis) => Subject::SinceReversal(axis),
            Self::Elapsed => Subject::Elapsed,
            Self::Azimuth => Subject::Azimuth,
            Self::Polar => Subject::PolarAngle,
            Self::Feed => Subject::Feed,
            Self::Circle(_) => Subject::Circle,
        }
    }
}

/// What is looked at, in fixed order.
fn wanted(circles: usize) -> Vec<(Against, Weight)> {
    let mut wanted = Vec::new();
    for axis in Axis::ALL {
        let mut weights = vec![Weight::One, Weight::Sense(axis)];
        weights.extend(Axis::ALL.map(Weight::Along));
        weights.extend(Axis::ALL.map(|along| Weight::AlongSense(along, axis)));
        wanted.extend(weights.into_iter().map(|w| (Against::Position(axis), w)));
        let weights = [Weight::One, Weight::Along(axis)];
        wanted.extend(weights.map(|w| (Against::Velocity(axis), w)));
        let weights = [Weight::Sense(axis), Weight::AlongSense(axis, axis)];
        wanted.extend(weights.map(|w| (Against::SinceReversal(axis), w)));
    }
    let weights = [Weight::One].into_iter().chain(Axis::ALL.map(Weight::Along));
    wanted.extend(weights.map(|w| (Against::Elapsed, w)));
    wanted.extend([Against::Azimuth, Against::Polar, Against::Feed].map(|a| (a, Weight::One)));
    for circle in 0..circles {
        wanted.extend([Weight::One, Weight::Way].map(|w| (Against::Circle(circle), w)));
    }
    wanted
}

/// All views as means, in fixed order.
pub(crate) fn views(all: &[Shown], circles: &[String], long_run_mm2: f64) -> Vec<View> {
    wanted(circles.len())
        .into_par_iter()
        .filter_map(|(against, weight)| {
            let counted = match (against, weight) {
                (Against::Circle(_), Weight::One) => "mean of both ways".into(),
                _ => weight.name(),
            };
            let sums = Sums::new(all, |shown| (against.of(shown), weight.of(shown)))?;
            let (width, share_before, share_after) = sums.best();
            Some(View {
                subject: against.subject(),
                variable: against.name(circles),
                counted,
                unit: against.unit(),
                kind: ViewKind::Means,
                bins: sums.bins(width, long_run_mm2),
                share_before,
                share_after,
            })
        })
        .collect()
}

/// Sums of one bin of one fold.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    /// `sum w e` before and after.
    before: f64,
    after: f64,
    /// `sum w²`.
    weight: f64,
    place: f64,
    count: f64,
}

impl Sum {
    fn add(&mut self, other: &Self) {
        self.before += other.before;
        self.after += other.after;
        self.weight += other.weight;
        self.place += other.place;
        self.count += other.count;
    }
}

/// Sums over the finest bins, fold after fold.
struct Sums {
    folds: Vec<Vec<Sum>>,
    squares_before: f64,
    squares_after: f64,
}

impl Sums {
    /// `None` where nothing varies.
    fn new(all: &[Shown], of: impl Fn(&Shown) -> (Option<f64>, f64)) -> Option<Self> {
        let finite = all.iter().filter_map(|shown| of(shown).0);
        let (low, high) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if high - low <= 1e-9 * high.abs() || !(high - low).is_finite() {
            return None;
        }
        let folds = all.iter().map(|shown| shown.fold + 1).max()?;
        let mut sums = Self {
            folds: vec![vec![Sum::default(); BINS]; folds],
            squares_before: 0.0,
            squares_after: 0.0,
        };
        let scale = BINS as f64 / (high - low);
        for shown in all {
            sums.squares_before += shown.before_mm * shown.before_mm;
            sums.squares_after += shown.after_mm * shown.after_mm;
            let (Some(x), w) = of(shown) else { continue };
            let bin = (((x - low) * scale) as usize).min(BINS - 1);
            let sum = &mut sums.folds[shown.fold][bin];
            sum.before += w * shown.before_mm;
            sum.after += w * shown.after_mm;
            sum.weight += w * w;
            sum.place += x;
            sum.count += 1.0;
        }
        Some(sums)
    }

    /// Bins of so many of the finest each, of one fold.
    fn merged(&self, fold: usize, width: usize) -> Vec<Sum> {
        let merge = |sums: &[Sum]| {
            let mut all = Sum::default();
            for sum in sums {
                all.add(sum);
            }
            all
        };
        self.folds[fold].chunks(width).map(merge).collect()
    }

    /// The width that foretells most, and the shares before and after with it.
    fn best(&self) -> (usize, f64, f64) {
        let mut best = (BINS / FEWEST, f64::NEG_INFINITY, 0.0);
        let mut width = BINS / FEWEST;
        while width >= 1 {
            let (before, after) = self.shares(width);
            if before.max(after) > best.1.max(best.2) + 1e-3 || best.1 == f64::NEG_INFINITY {
                best = (width, before, after);
            }
            width /= 2;
        }
        best
    }

    /// Shares of the variance that each fold's others foretell.
    fn shares(&self, width: usize) -> (f64, f64) {
        let folds: Vec<Vec<Sum>> =
            (0..self.folds.len()).map(|fold| self.merged(fold, width)).collect();
        let (mut before, mut after) = (0.0, 0.0);
        for bin in 0..BINS / width {
            let mut all = Sum::default();
            for fold in &folds {
                all.add(&fold[bin]);
            }
            for fold in &folds {
                let own = &fold[bin];
                let weight = all.weight - own.weight;
                // Next to nothing in the others: nothing is foretold.
                if weight < 1e-3 * all.weight || weight <= 0.0 {
                    continue;
                }
                let gain = |all: f64, own: f64, own_weight: f64| {
                    let mean = (all - own) / weight;
                    mean * (2.0 * own - mean * own_weight)
                };
                before += gain(all.before, own.before, own.weight);
                after += gain(all.after, own.after, own.weight);
            }
        }
        let of = |gain: f64, squares: f64| if squares > 0.0 { gain / squares } else { 0.0 };
        (of(before, self.squares_before), of(after, self.squares_after))
    }

    fn bins(&self, width: usize, long_run_mm2: f64) -> Vec<Bin> {
        let mut all = vec![Sum::default(); BINS / width];
        for fold in 0..self.folds.len() {
            for (all, sum) in all.iter_mut().zip(self.merged(fold, width)) {
                all.add(&sum);
            }
        }
        let heaviest = all.iter().map(|sum| sum.weight).fold(0.0, f64::max);
        all.iter()
            .filter(|sum| sum.count > 0.0 && sum.weight > WORTH_SHOWING * heaviest)
            .map(|sum| Bin {
                center: sum.place / sum.count,
                before_mm: sum.before / sum.weight,
                after_mm: sum.after / sum.weight,
                sigma_mm: (long_run_mm2 / sum.weight).sqrt(),
                count: sum.count as usize,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of five runs with noise of one, and a wave along X of some amplitude.
    fn samples(amplitude_mm: f64) -> Vec<Shown> {
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        (0..20_000)
            .map(|k| {
                let x_mm = f64::from(k % 4000) * 0.075;
                let wave = amplitude_mm * (x_mm / 10.0 * std::f64::consts::TAU).sin();
                let before_mm = wave + noise();
                Shown {
                    run: (k / 4000) as usize,
                    fold: (k / 4000) as usize,
                    before_mm,
                    after_mm: before_mm - wave,
                    direction: [1.0, 0.0, 0.0],
                    sense: [1.0; 3],
                    way: 1.0,
                    position_mm: [x_mm, 0.0, 0.0],
                    ..Shown::default()
                }
            })
            .collect()
    }

    #[test]
    fn noise_scores_nothing_and_a_wave_its_variance() {
        let of = |shown: &[Shown]| {
            let views = views(shown, &[], 1.0 / 12.0);
            let view = views.into_iter().find(|view| view.name() == "position of X");
            view.map_or((f64::NAN, f64::NAN), |view| (view.share_before, view.share_after))
        };
        let (before, after) = of(&samples(0.0));
        assert!(before.abs() < 0.01 && after.abs() < 0.01, "{before} {after}");
        // Variance of the wave 0.5, of the noise 1/12; each of 512 bins takes 5e-5 of noise for structure.
        let (before, after) = of(&samples(1.0));
        let expected = 0.5 / (0.5 + 1.0 / 12.0);
        assert!((before - expected).abs() < 0.03, "{before}");
        assert!((-0.05..0.01).contains(&after), "{after}");
    }
}
