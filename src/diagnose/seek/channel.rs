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

use crate::identify::LinearSample;
use crate::model::{Seat, Variable};
use crate::residual::data::{Data, dot};
use crate::solve::{Cholesky, Matrix};

/// A seat over a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    pub(crate) seat: Seat,
    pub(crate) variable: Variable,
    /// Whether the effect changes its sign with the sense of the variable's slide.
    pub(crate) with_sense: bool,
}

impl Place {
    /// What a sample is worth, and where it lies; `None` where the variable has no value.
    pub(crate) fn of(self, sample: &LinearSample) -> Option<(f64, f64)> {
        let at = &sample.situation;
        let value = self.variable.value(&at.pose, &at.motion)?;
        let sense = match self.variable.slide() {
            Some(slide) if self.with_sense => at.pose.sense[slide.index()],
            _ => 1.0,
        };
        Some((self.seat.sensitivity(at) * sense * sample.root_weight, value))
    }
}

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
    fn of(data: &Data, variable: Variable) -> Self {
        let (logarithm_over, finest) = match variable {
            Variable::Position(_) => (0.0, 0.5),
            Variable::Velocity(_) => (0.0, 0.0),
            Variable::Elapsed => (0.0, 1.0),
            Variable::SinceReversal(_) => (0.05, 0.0),
            Variable::WaySinceReversal(_) => (0.01, 0.0),
        };
        let most = match variable {
            Variable::Position(_) => 800,
            Variable::Elapsed => 400,
            Variable::Velocity(_) => 160,
            _ => 120,
        };
        let mut bins = Self { low: 0.0, width: 1.0, count: 1, logarithm_over };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in data.blocks.iter().flat_map(|block| &block.samples) {
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

/// What one repeat has in the bins.
#[derive(Debug)]
struct Gathered {
    /// `sum s²`.
    squares: Vec<f64>,
    /// `sum s e`.
    common: Vec<f64>,
    /// `sum s Q`, bin after bin.
    spanned: Vec<f64>,
    /// `sum s x`, for each accepted column.
    accepted: Vec<Vec<f64>>,
}

/// A seat over a variable, gathered.
#[derive(Debug)]
pub(crate) struct Channel {
    pub(crate) place: Place,
    /// Mean value of the samples in each bin, weighted by what they are worth.
    pub(crate) centers: Vec<f64>,
    blocks: Vec<Gathered>,
    ranks: Vec<usize>,
    /// In which bin each sample of each block lies, and what it is worth there.
    samples: Vec<Vec<(u32, f64)>>,
}

/// What an effect explains.
#[derive(Debug, Clone)]
pub(crate) struct Explained {
    /// By how much it lowers the sum of squares, mm².
    pub(crate) gain_mm2: f64,
    /// Which part of its square lies outside of what is spanned, 0 to 1.
    pub(crate) seen: f64,
    /// One a shape, mm and rad.
    pub(crate) amplitudes: Vec<f64>,
    /// Factor of the normal matrix.
    pub(crate) cholesky: Cholesky,
}

impl Channel {
    /// Channels of several seats over one variable, in one pass over the samples.
    pub(crate) fn gather(
        data: &Data,
        variable: Variable,
        with_sense: bool,
        seats: &[Seat],
    ) -> Vec<Self> {
        let bins = Bins::of(data, variable);
        let mut channels: Vec<Self> = seats
            .iter()
            .map(|&seat| Self {
                place: Place { seat, variable, with_sense },
                centers: vec![0.0; bins.count],
                blocks: Vec::new(),
                ranks: data.blocks.iter().map(|block| block.rank).collect(),
                samples: Vec::new(),
            })
            .collect();
        let mut weights = vec![vec![0.0; bins.count]; seats.len()];
        for block in &data.blocks {
            for channel in &mut channels {
                channel.samples.push(Vec::with_capacity(block.samples.len()));
                channel.blocks.push(Gathered {
                    squares: vec![0.0; bins.count],
                    common: Vec::new(),
                    spanned: vec![0.0; bins.count * block.rank],
                    accepted: Vec::new(),
                });
            }
            for (sample, row) in block.samples.iter().zip(block.q.chunks_exact(block.rank.max(1))) {
                let at = &sample.situation;
                let bin = variable.value(&at.pose, &at.motion).map(|value| bins.index(value));
                for (channel, weights) in channels.iter_mut().zip(&mut weights) {
                    let placed = channel.place.of(sample).zip(bin);
                    let Some(((worth, value), bin)) = placed else {
                        if let Some(samples) = channel.samples.last_mut() {
                            samples.push((0, 0.0));
                        }
                        continue;
                    };
                    if let Some(samples) = channel.samples.last_mut() {
                        samples.push((bin as u32, worth));
                    }
                    weights[bin] += worth * worth;
                    channel.centers[bin] += worth * worth * value;
                    if let Some(gathered) = channel.blocks.last_mut() {
                        gathered.squares[bin] += worth * worth;
                        let spanned = &mut gathered.spanned[bin * block.rank..][..block.rank];
                        for (m, q) in spanned.iter_mut().zip(row) {
                            *m += worth * q;
                        }
                    }
                }
            }
        }
        for (channel, weights) in channels.iter_mut().zip(&weights) {
            for (center, weight) in channel.centers.iter_mut().zip(weights) {
                *center = if *weight > 0.0 { *center / weight } else { 0.0 };
            }
            channel.renew(data);
        }
        channels
    }

    /// Gathers anew what hangs on what has been accepted.
    pub(crate) fn renew(&mut self, data: &Data) {
        let count = self.centers.len();
        for (index, gathered) in self.blocks.iter_mut().enumerate() {
            let samples = &self.samples[index];
            gathered.common = vec![0.0; count];
            for ((bin, worth), left_mm) in samples.iter().zip(&data.left_mm[index]) {
                gathered.common[*bin as usize] += worth * left_mm;
            }
            gathered.accepted = data
                .span
                .iter()
                .map(|unit| {
                    let mut sums = vec![0.0; count];
                    for ((bin, worth), u) in samples.iter().zip(&unit[index]) {
                        sums[*bin as usize] += worth * u;
                    }
                    sums
                })
                .collect();
        }
    }

    /// `sum s²` of every bin over all blocks.
    pub(crate) fn squares(&self) -> Vec<f64> {
        let mut total = vec![0.0; self.centers.len()];
        for gathered in &self.blocks {
            for (t, s) in total.iter_mut().zip(&gathered.squares) {
                *t += s;
            }
        }
        total
    }

    /// Sums over all blocks.
    pub(crate) fn sums(&self) -> Sums {
        let mut common = vec![0.0; self.centers.len()];
        for gathered in &self.blocks {
            for (t, c) in common.iter_mut().zip(&gathered.common) {
                *t += c;
            }
        }
        Sums { squares: self.squares(), common }
    }

    /// What shapes over the bins explain together, each with one amplitude for all repeats; `ridge` keeps
    /// shapes apart that hardly differ, as a share of their squares.
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
        let mut accepted = vec![vec![0.0; n]; self.blocks.first()?.accepted.len()];
        for (gathered, &rank) in self.blocks.iter().zip(&self.ranks) {
            let mut spanned = Matrix::zeros(n, rank);
            for (i, shape) in shapes.iter().enumerate() {
                let out = spanned.row_mut(i);
                let range = ranges[i].clone();
                for bin in range.clone() {
                    for (o, m) in out.iter_mut().zip(&gathered.spanned[bin * rank..][..rank]) {
                        *o += shape[bin] * m;
                    }
                }
                let shape = &shape[range.clone()];
                common[i] += dot(shape, &gathered.common[range.clone()]);
                for (total, x) in accepted.iter_mut().zip(&gathered.accepted) {
                    total[i] += dot(shape, &x[range.clone()]);
                }
            }
            for i in 0..n {
                for k in 0..=i {
                    let product = both(i, k)
                        .map(|bin| shapes[i][bin] * shapes[k][bin] * gathered.squares[bin])
                        .sum::<f64>();
                    gram[(i, k)] += product - dot(spanned.row(i), spanned.row(k));
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
        let seen = (0..n).map(|i| gram[(i, i)] / raw[i].max(f64::MIN_POSITIVE)).fold(0.0, f64::max);
        for i in 0..n {
            gram[(i, i)] += ridge * raw[i] + f64::MIN_POSITIVE;
        }
        let cholesky = Cholesky::of(&gram)?;
        let amplitudes = cholesky.solve(&common);
        let gain_mm2 = dot(&amplitudes, &common);
        Some(Explained { gain_mm2, seen, amplitudes, cholesky })
    }
}

/// A channel's sums over all blocks.
#[derive(Debug)]
pub(crate) struct Sums {
    squares: Vec<f64>,
    common: Vec<f64>,
}

impl Sums {
    /// What a wave over the bins explains, mm², without regard to what is spanned: right for shapes that wave so
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
