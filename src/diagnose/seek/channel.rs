//! Residuals gathered over a variable: every effect `s · f(v)` of one seat `s` and one variable `v` at once.
//!
//! With samples sorted into bins of `v`, an effect is a vector of `f` over the bins. Of it,
//!
//! ```text
//! c · e   = sum_bins f g,   g = sum of s e            what it has in common with the residual
//! c' · c' = sum_bins f² d - |M^T f|² - |X^T f|²       its square outside of fits (M) and accepted (X)
//! ```
//!
//! with `d = sum of s²`, `M = sum of s Q`, `X = sum of s` times the accepted columns. So a thousand periods
//! or time constants cost no pass over the samples.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;
use std::sync::Arc;

use rayon::prelude::*;

use crate::model::{Dependence, Seat, Variable};
use crate::residual::{Beside, Residuals, Sample};
use crate::solve::{Cholesky, Matrix, add_rows, dot};

/// Bins of a variable.
#[derive(Debug, Clone)]
struct Bins {
    low: f64,
    width: f64,
    count: usize,
    /// Bins are even in the logarithm of the value over this, plus one; 0 for even bins.
    logarithm_over: f64,
}

impl Bins {
    /// Bins for the values that the data have.
    fn of(residuals: &Residuals, variable: Variable) -> Self {
        let (logarithm_over, finest) = match variable {
            Variable::Position(_) => (0.0, 0.5),
            Variable::Velocity(_) => (0.0, 0.0),
            Variable::Elapsed | Variable::Program => (0.0, 1.0),
            Variable::SinceReversal(_) => (0.05, 0.0),
            Variable::WaySinceReversal(_) => (0.01, 0.0),
        };
        let most = match variable {
            Variable::Position(_) => 800,
            Variable::Elapsed | Variable::Program => 400,
            Variable::Velocity(_) => 160,
            _ => 120,
        };
        let mut bins = Self { low: 0.0, width: 1.0, count: 1, logarithm_over };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in residuals.repeats.iter().flat_map(|repeat| &repeat.samples) {
            let at = &sample.situation;
            if let Some(value) = variable.value(&at.pose, &at.motion) {
                let scaled = bins.scaled(value);
                (low, high) = (low.min(scaled), high.max(scaled));
            }
        }
        if low < high {
            bins.width = ((high - low) / f64::from(most)).max(finest);
            bins.count = ((high - low) / bins.width).floor() as usize + 1;
            bins.low = low;
        }
        bins
    }

    fn scaled(&self, value: f64) -> f64 {
        if self.logarithm_over > 0.0 { (value / self.logarithm_over).ln_1p() } else { value }
    }

    fn index(&self, value: f64) -> usize {
        (((self.scaled(value) - self.low) / self.width) as usize).min(self.count - 1)
    }
}

/// What one repeat has in the bins, whatever is accepted.
#[derive(Debug)]
struct Gathered {
    /// `sum s²`.
    squares: Vec<f64>,
    /// `sum s Q`, bin after bin.
    followed: Vec<f64>,
    rank: usize,
    /// Where each sample lies: the same for all seats over a variable.
    places: Arc<[Place]>,
    /// What each sample is worth, `s`: the same for a seat over all variables.
    worths: Arc<[f64]>,
}

/// Where a sample lies, and with which sign it counts there; nowhere with none.
#[derive(Debug, Clone, Copy)]
struct Place {
    bin: u16,
    sign: i8,
}

impl Place {
    fn worth(self, worth: f64) -> f64 {
        f64::from(self.sign) * worth
    }
}

/// What samples of each repeat are worth to each seat: what one of its effects does to the length, by the root of the weight.
#[derive(Debug)]
pub(crate) struct Worths<'a> {
    residuals: &'a Residuals,
    of: BTreeMap<Seat, Vec<Arc<[f64]>>>,
}

impl<'a> Worths<'a> {
    pub(crate) fn of(residuals: &'a Residuals, seats: BTreeSet<Seat>) -> Self {
        let in_repeats = |seat: Seat| {
            let worth = |sample: &Sample| seat.sensitivity(&sample.situation) * sample.root_weight;
            let repeats = residuals.repeats.iter();
            (seat, repeats.map(|repeat| repeat.samples.iter().map(worth).collect()).collect())
        };
        Self { residuals, of: seats.into_par_iter().map(in_repeats).collect() }
    }
}

impl Gathered {
    /// `sum s x` of a column, bin after bin.
    fn sums(&self, bins: usize, column: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; bins];
        for ((place, worth), x) in self.places.iter().zip(&*self.worths).zip(column) {
            sums[usize::from(place.bin)] += place.worth(*worth) * x;
        }
        sums
    }
}

/// A seat over a variable, gathered.
#[derive(Debug)]
pub(crate) struct Channel {
    pub(crate) of: Dependence,
    /// Mean value of the samples in each bin, weighted by what they are worth; of the one bin more that a slide is in before it has
    /// ever reversed there is none.
    pub(crate) centers: Vec<f64>,
    repeats: Vec<Gathered>,
}

/// A channel beside what is accepted: what it has in common with what is left.
#[derive(Debug)]
pub(crate) struct Look<'a> {
    channel: &'a Channel,
    /// `sum s e` of each repeat.
    common: Vec<Vec<f64>>,
    /// `sum s x` of each repeat, for each accepted column.
    accepted: Vec<Vec<Vec<f64>>>,
}

impl Deref for Look<'_> {
    type Target = Channel;

    fn deref(&self) -> &Channel {
        self.channel
    }
}

/// What an effect explains.
#[derive(Debug, Clone)]
pub(crate) struct Explained {
    /// By how much it lowers the sum of squares, mm².
    pub(crate) gain_mm2: f64,
    /// Which part of its square lies outside of what is followed, 0 to 1.
    pub(crate) share_outside: f64,
    /// One a shape, mm and rad.
    pub(crate) amplitudes: Vec<f64>,
    /// Factor of the normal matrix.
    pub(crate) cholesky: Cholesky,
}

impl Channel {
    /// Channels of those of some seats that have worths over one variable.
    pub(crate) fn gather(
        worths: &Worths,
        variable: Variable,
        with_sense: bool,
        seats: &[Seat],
    ) -> Vec<Self> {
        let residuals = worths.residuals;
        let bins = Bins::of(residuals, variable);
        let (mut channels, worths): (Vec<Self>, Vec<_>) = seats
            .iter()
            .filter_map(|seat| Some((*seat, worths.of.get(seat)?)))
            .map(|(seat, worths)| {
                let of = Dependence { seat, variable, with_sense };
                (Self { of, centers: vec![0.0; bins.count], repeats: Vec::new() }, worths)
            })
            .unzip();
        let mut weights = vec![vec![0.0; bins.count]; channels.len()];
        for (index, repeat) in residuals.repeats.iter().enumerate() {
            let rank = repeat.basis.rank();
            // That of any seat.
            let of = Dependence { seat: Seat::Bar, variable, with_sense };
            let value =
                |sample: &Sample| variable.value(&sample.situation.pose, &sample.situation.motion);
            let values: Vec<Option<f64>> = repeat.samples.iter().map(value).collect();
            let place = |(sample, value): (&Sample, &Option<f64>)| {
                let bin = value.map_or(bins.count, |value| bins.index(value));
                Place { bin: bin as u16, sign: of.sense(&sample.situation.pose) as i8 }
            };
            let places: Arc<[Place]> = repeat.samples.iter().zip(&values).map(place).collect();
            for ((channel, weights), worths) in channels.iter_mut().zip(&mut weights).zip(&worths) {
                let mut gathered = Gathered {
                    squares: vec![0.0; bins.count + 1],
                    followed: vec![0.0; (bins.count + 1) * rank],
                    rank,
                    places: Arc::clone(&places),
                    worths: Arc::clone(&worths[index]),
                };
                for (k, (value, place)) in values.iter().zip(&*places).enumerate() {
                    let (bin, worth) = (usize::from(place.bin), place.worth(worths[index][k]));
                    if let Some(value) = value {
                        weights[bin] += worth * worth;
                        channel.centers[bin] += worth * worth * value;
                    }
                    gathered.squares[bin] += worth * worth;
                }
                let worths = places.iter().zip(&*worths[index]);
                let worths = worths.map(|(at, worth)| (usize::from(at.bin), at.worth(*worth)));
                repeat.basis.add_to_sums(worths, &mut gathered.followed);
                channel.repeats.push(gathered);
            }
        }
        for (channel, weights) in channels.iter_mut().zip(&weights) {
            for (center, weight) in channel.centers.iter_mut().zip(weights) {
                *center = if *weight > 0.0 { *center / weight } else { 0.0 };
            }
        }
        channels
    }

    /// The channel beside what has been accepted.
    pub(crate) fn beside(&self, beside: &Beside) -> Look<'_> {
        let count = self.centers.len() + 1;
        let of_column = |column: &[Vec<f64>]| -> Vec<Vec<f64>> {
            self.repeats.iter().zip(column).map(|(of, column)| of.sums(count, column)).collect()
        };
        let by_column: Vec<Vec<Vec<f64>>> =
            beside.span.iter().map(|unit| of_column(unit)).collect();
        let accepted = (0..self.repeats.len())
            .map(|repeat| by_column.iter().map(|column| column[repeat].clone()).collect())
            .collect();
        Look { channel: self, common: of_column(&beside.left_mm), accepted }
    }

    /// `sum s²` of every bin over all repeats.
    pub(crate) fn squares(&self) -> Vec<f64> {
        total(self.centers.len(), self.repeats.iter().map(|gathered| &gathered.squares))
    }

    /// From where to where its variable went: of bins in which there is anything.
    pub(crate) fn range(&self) -> [f64; 2] {
        let filled = self.centers.iter().zip(self.squares()).filter(|(_, square)| *square > 0.0);
        filled.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (center, _)| {
            [least.min(*center), most.max(*center)]
        })
    }
}

/// The sum of rows, one after the other.
fn total<'a>(count: usize, rows: impl Iterator<Item = &'a Vec<f64>>) -> Vec<f64> {
    let mut total = vec![0.0; count];
    for row in rows {
        total.iter_mut().zip(row).for_each(|(t, c)| *t += c);
    }
    total
}

impl Look<'_> {
    /// Sums over all repeats.
    pub(crate) fn sums(&self) -> Sums {
        let common = total(self.centers.len(), self.common.iter());
        Sums { squares: self.squares(), common }
    }

    /// What shapes over the bins explain together, each with one amplitude for all repeats; `ridge` keeps
    /// shapes apart that hardly differ, as a share of their squares. A shape may say what there is before a slide has reversed.
    pub(crate) fn explained(&self, shapes: &[Vec<f64>], ridge: f64) -> Option<Explained> {
        let n = shapes.len();
        // Hats of a curve are zero nearly everywhere.
        let ranges: Vec<std::ops::Range<usize>> = shapes
            .iter()
            .map(|shape| {
                let first = shape.iter().position(|f| *f != 0.0).unwrap_or(0);
                first..shape.iter().rposition(|f| *f != 0.0).map_or(first, |last| last + 1)
            })
            .collect();
        let both = |i: usize, k: usize| {
            let first = ranges[i].start.max(ranges[k].start);
            first..ranges[i].end.min(ranges[k].end).max(first)
        };
        let mut gram = Matrix::zeros(n, n);
        let mut common = vec![0.0; n];
        let mut raw = vec![0.0; n];
        let mut accepted = vec![vec![0.0; n]; self.accepted.first()?.len()];
        for (index, gathered) in self.repeats.iter().enumerate() {
            let rank = gathered.rank;
            let mut followed = Matrix::zeros(n, rank);
            for (i, shape) in shapes.iter().enumerate() {
                let range = ranges[i].clone();
                let shape = &shape[range.clone()];
                add_rows(1.0, shape, &gathered.followed[range.start * rank..], followed.row_mut(i));
                common[i] += dot(shape, &self.common[index][range.clone()]);
                for (total, x) in accepted.iter_mut().zip(&self.accepted[index]) {
                    total[i] += dot(shape, &x[range.clone()]);
                }
            }
            for i in 0..n {
                for k in 0..=i {
                    let product = both(i, k)
                        .map(|bin| shapes[i][bin] * shapes[k][bin] * gathered.squares[bin])
                        .sum::<f64>();
                    gram[(i, k)] += product - dot(followed.row(i), followed.row(k));
                    if i == k {
                        raw[i] += product;
                    }
                }
            }
        }
        for of in &accepted {
            for i in 0..n {
                for k in 0..=i {
                    gram[(i, k)] -= of[i] * of[k];
                }
            }
        }
        let share_outside =
            (0..n).map(|i| gram[(i, i)] / raw[i].max(f64::MIN_POSITIVE)).fold(0.0, f64::max);
        for i in 0..n {
            gram[(i, i)] += ridge * raw[i] + f64::MIN_POSITIVE;
        }
        let cholesky = Cholesky::of(&gram)?;
        let amplitudes = cholesky.solve(&common);
        let gain_mm2 = dot(&amplitudes, &common);
        Some(Explained { gain_mm2, share_outside, amplitudes, cholesky })
    }
}

/// A channel's sums over all blocks.
#[derive(Debug)]
pub(crate) struct Sums {
    squares: Vec<f64>,
    common: Vec<f64>,
}

impl Sums {
    /// What a wave over the bins explains, mm², without regard to what is followed: right for shapes that wave so
    /// fast that the cubics do not follow.
    pub(crate) fn explained(&self, sine: &[f64], cosine: &[f64]) -> f64 {
        let (ss, cc, sc) = self.products(sine, cosine);
        let (se, ce) = (dot(sine, &self.common), dot(cosine, &self.common));
        let determinant = ss * cc - sc * sc;
        if determinant <= 1e-9 * ss * cc {
            return 0.0;
        }
        (cc * se * se - 2.0 * sc * se * ce + ss * ce * ce) / determinant
    }

    fn products(&self, sine: &[f64], cosine: &[f64]) -> (f64, f64, f64) {
        let (mut ss, mut cc, mut sc) = (0.0, 0.0, 0.0);
        for ((s, c), d) in sine.iter().zip(cosine).zip(&self.squares) {
            ss += s * s * d;
            cc += c * c * d;
            sc += s * c * d;
        }
        (ss, cc, sc)
    }
}
