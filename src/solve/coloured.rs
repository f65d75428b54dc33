//! Which noise makes what is left of readings likeliest, where fits have taken out most of what hangs together.
//!
//! With the directions `X` that they have taken out of readings `y`, nobody knows what was along them. Of noise with the covariance
//! `s V` the likelihood of all that is across them is (Patterson and Thompson, "Recovery of inter-block information when block sizes
//! are unequal", Biometrika 58, 1971), the scale `s` at its best,
//!
//! ```text
//! -2 ln L = (n - p) ln Q + ln |V| + ln |X^T V^-1 X|,      Q = min_b (e - X b)^T V^-1 (e - X b),      s = Q / (n - p)
//! ```
//!
//! which needs no more of `y` than what is left, `e`. `V` is that of white noise with noise whose correlation falls as
//! `exp(-t / tau)`, over means of neighbouring readings; other arcs are independent. Of a grid of shares and times every noise counts
//! by its likelihood, so that one that is as likely and hangs together for longer is not forgotten.

use std::ops::Range;

use rayon::prelude::*;

use super::matrix::Matrix;
use super::svd::Decomposition;

/// Times over which noise hangs together, s.
const TIMES_S: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.4, 2.0];
/// Its share of the variance of a mean.
const SHARES: [f64; 6] = [0.2, 0.4, 0.6, 0.8, 0.95, 1.0];
/// A direction of which means tell less than this, of its square, has its number from what was known beforehand: it took out as little.
const FOLLOWED: f64 = 0.5;
/// Of a direction that others span less than this is left, of its square.
const SPANNED: f64 = 1e-6;

/// One arc, in means of neighbouring readings, each times the root of their number: white noise is as large in them as in a
/// reading.
#[derive(Debug, Clone)]
pub struct ArcOfMeans {
    /// Its means.
    pub means: Range<usize>,
    /// From one to the next, s.
    pub every_s: f64,
}

/// Readings that were fitted together, in means.
#[derive(Debug, Clone)]
pub struct Means {
    /// Arcs, one after the other.
    pub arcs: Vec<ArcOfMeans>,
    /// Rows of `X^T`, those of its own first and those that it shares with others then, and last what is left; a column a mean.
    pub rows: Matrix,
    /// How many rows are its own.
    pub own: usize,
}

impl Means {
    /// Those of one fit. Of its orthonormal directions, a row each of `q` with a column a mean, those count that means tell: of all
    /// their combinations the eigenvectors of `Q Q^T` whose eigenvalue is above a half.
    ///
    /// # Panics
    /// If there is not one number left for each mean.
    pub fn of_fit(arcs: Vec<ArcOfMeans>, q: &Matrix, left: &[f64]) -> Self {
        assert_eq!(q.columns(), left.len(), "one number left for each mean");
        let gram = q.times_own_transpose();
        let directions = if let Ok(told) = Decomposition::of(&gram) {
            let own = told.singular_values.iter().filter(|told| **told > FOLLOWED).count();
            Matrix::from_fn(own, q.rows(), |i, k| told.u[(k, i)]).times(q)
        } else {
            // Where the library goes in circles, the directions as they are.
            let own: Vec<usize> = (0..q.rows()).filter(|k| gram[(*k, *k)] > FOLLOWED).collect();
            Matrix::from_fn(own.len(), q.columns(), |i, k| q[(own[i], k)])
        };
        let own = directions.rows();
        let rows = Matrix::from_fn(own + 1, left.len(), |i, k| {
            if i < own { directions[(i, k)] } else { left[k] }
        });
        Self { arcs, rows, own }
    }
}

/// White noise of variance `1 - share` on means of noise that hangs together, of variance `share`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour {
    /// Time in which its correlation falls to 1/e, s.
    pub time_s: f64,
    /// Of the variance of a mean, 0 to 1.
    pub share: f64,
}

/// A noise that may have left what is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Likely {
    /// Its colour.
    pub colour: Colour,
    /// Of all that were tried, by likelihood; together 1.
    pub weight: f64,
    /// Variance of a mean, in the square of the unit of what is left.
    pub variance: f64,
}

/// Noises that may have left what is left of all of these and hang together for so long at most, s, each by its likelihood; none
/// where nothing is left to know them from.
///
/// # Panics
/// If they do not share as many rows.
pub fn likely(all: &[Means], longest_s: f64) -> Vec<Likely> {
    let hanging = TIMES_S
        .iter()
        .filter(|time_s| **time_s <= longest_s)
        .flat_map(|time_s| SHARES.iter().map(|share| Colour { time_s: *time_s, share: *share }));
    let white = Colour { time_s: TIMES_S[0], share: 0.0 };
    let colours: Vec<Colour> = std::iter::once(white).chain(hanging).collect();
    let told = colours
        .par_iter()
        .map_init(Matrix::default, |white, colour| Some((*colour, Told::of(all, *colour, white)?)));
    let told: Vec<(Colour, Told)> = told.flatten_iter().collect();
    let best = told.iter().map(|(_, told)| told.minus_two_ln).min_by(f64::total_cmp);
    let weigh = |told: &Told| best.map_or(0.0, |best| (0.5 * (best - told.minus_two_ln)).exp());
    let weights: f64 = told.iter().map(|(_, told)| weigh(told)).sum();
    let noise = |(colour, told): &(Colour, Told)| Likely {
        colour: *colour,
        weight: weigh(told) / weights,
        variance: told.variance,
    };
    told.iter().map(noise).collect()
}

/// What is left told by one noise.
struct Told {
    minus_two_ln: f64,
    variance: f64,
}

impl Told {
    /// `white` is room for whitened rows.
    fn of(all: &[Means], colour: Colour, white: &mut Matrix) -> Option<Self> {
        let (mut means, mut taken, mut ln) = (0, 0, 0.0);
        let mut shared: Option<Matrix> = None;
        for one in all {
            white.clone_from(&one.rows);
            for arc in &one.arcs {
                ln += colour.whiten(white, arc);
                means += arc.means.len();
            }
            let mut gram = white.times_own_transpose();
            let (count, of_own) = eliminate(&mut gram, one.own);
            (taken, ln) = (taken + count, ln + of_own);
            let rest = gram.rows() - one.own;
            let rest = Matrix::from_fn(rest, rest, |i, k| gram[(one.own + i, one.own + k)]);
            shared = Some(match shared {
                None => rest,
                Some(so_far) => {
                    Matrix::from_fn(rest.rows(), rest.rows(), |i, k| so_far[(i, k)] + rest[(i, k)])
                }
            });
        }
        let mut shared = shared?;
        let effects = shared.rows() - 1;
        let (count, of_effects) = eliminate(&mut shared, effects);
        let free = means.checked_sub(taken + count).filter(|free| *free > 0)? as f64;
        let square = shared[(effects, effects)];
        let minus_two_ln = free * square.ln() + ln + of_effects;
        minus_two_ln.is_finite().then_some(Self { minus_two_ln, variance: square / free })
    }
}

impl Colour {
    /// Correlation of what hangs together from one mean to the next.
    pub fn next(self, every_s: f64) -> f64 {
        (-every_s / self.time_s).exp()
    }

    /// Long-run variance over that of a mean.
    pub fn long_run(self, every_s: f64) -> f64 {
        let next = self.next(every_s);
        1.0 - self.share + self.share * (1.0 + next) / (1.0 - next)
    }

    /// Makes this noise white, of variance 1, in an arc of every row (Kalman); what that adds to `ln |V|`.
    fn whiten(self, rows: &mut Matrix, arc: &ArcOfMeans) -> f64 {
        let next = self.next(arc.every_s);
        // What is expected next is `keep` of what was expected and `take` of what came; and one over the deviation of a surprise.
        let (mut steps, mut ln) = (Vec::with_capacity(arc.means.len()), 0.0);
        let mut variance = self.share;
        for _ in arc.means.clone() {
            let whole = variance + 1.0 - self.share;
            let gain = variance / whole;
            steps.push((next * (1.0 - gain), next * gain, whole.sqrt().recip()));
            ln += whole.ln();
            variance = next * next * variance * (1.0 - gain) + (1.0 - next * next) * self.share;
        }
        for row in 0..rows.rows() {
            let mut expected = 0.0;
            let values = &mut rows.row_mut(row)[arc.means.clone()];
            for (value, (keep, take, over_sigma)) in values.iter_mut().zip(&steps) {
                let came = *value;
                *value = (came - expected) * over_sigma;
                expected = keep * expected + take * came;
            }
        }
        ln
    }
}

/// Takes the first so many unknowns out of a symmetric matrix, in place: how many there are that others do not span, and the
/// logarithm of the determinant of their part.
fn eliminate(a: &mut Matrix, unknowns: usize) -> (usize, f64) {
    let whole = a.diagonal();
    let (mut taken, mut ln) = (0, 0.0);
    for k in 0..unknowns {
        let row = a.row(k).to_vec();
        let pivot = row[k];
        if pivot <= SPANNED * whole[k] {
            continue;
        }
        (taken, ln) = (taken + 1, ln + pivot.ln());
        for i in k + 1..a.rows() {
            let factor = row[i] / pivot;
            a.row_mut(i)[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(x, y)| *x -= factor * y);
        }
    }
    (taken, ln)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_span_is_no_unknown() {
        let rows = [[1.0, 2.0, 0.5], [2.0, 4.0, 1.0], [0.0, 1.0, 3.0], [1.0, 1.0, 2.0]];
        let mut gram =
            Matrix::from_fn(4, 4, |i, k| rows[i].iter().zip(&rows[k]).map(|(a, b)| a * b).sum());
        let (taken, ln) = eliminate(&mut gram, 3);
        assert_eq!(taken, 2);
        // 5.25 * 10 - 3.5 * 3.5
        assert!((ln - 40.25_f64.ln()).abs() < 1e-12, "{ln}");
    }
}
