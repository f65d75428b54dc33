//! How the noise of neighbouring samples hangs together.
//!
//! ```text
//! e_t = phi_1 e_(t-1) + .. + phi_p e_(t-p) + sigma_i w_t,      w white, unit variance, mean zero
//! ```
//!
//! The residuals of a contiguous segment (an arc) are taken for a stationary autoregression; different
//! segments for independent of each other. The order is chosen by Akaike's information criterion
//! `N ln(sigma_i^2) + 2 p` from autocovariances pooled over all segments, and the coefficients by
//! the Levinson-Durbin recursion (Yule-Walker equations).
//!
//! Akaike's and not the Bayesian criterion, because white and correlated noise together are an
//! autoregression of no finite order: what counts is their variance at long distances, and the order
//! that `p ln(N)` chooses (3 on 8000 samples of 0.12 um white and 0.10 um of 0.3 s, at 10 Hz) falls
//! 6 % short of its root, an order that is a little too high by nothing.
//!
//! Not modelled: noise whose size changes along the way, and noise that repeats from run to run.

use super::matrix::Matrix;
use super::vector::dot;
use crate::error::Kind;
use crate::{Error, Result};

/// How often an interval from 0 to 1 is halved: to a millionth.
const HALVINGS: usize = 20;

/// Sums of products of residuals at equal distances, pooled over segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Autocovariances {
    sums: Vec<f64>,
    pairs: Vec<usize>,
}

impl Autocovariances {
    /// Empty sums for the distances `0 ..= max_lag` samples.
    pub fn new(max_lag: usize) -> Self {
        Self { sums: vec![0.0; max_lag + 1], pairs: vec![0; max_lag + 1] }
    }

    /// Adds the residuals of one contiguous, evenly sampled segment.
    ///
    /// Their mean is *not* taken off: a fit that leaves an offset in an arc has an error there, and one
    /// that all its samples share.
    pub fn push_segment(&mut self, residuals: &[f64]) {
        for lag in 0..self.sums.len().min(residuals.len()) {
            self.sums[lag] += dot(&residuals[lag..], residuals);
            self.pairs[lag] += residuals.len() - lag;
        }
    }

    /// The same with what a fit of `parameters` parameters has taken out of its residuals given back.
    ///
    /// With `P` the projection on the columns, the residuals have the covariance `(1 - P) Sigma (1 - P)`.
    /// Columns that change little over the correlation of the noise see its `long_run_variance` `v`
    /// only, `P Sigma = v P`, and then a sum over `n` pairs of `N` samples has lost `v n parameters / N`
    /// at every distance alike. Where that is more than what is left, the columns do change: so much of a variance is in no
    /// few directions, and no more is given back than is left.
    #[must_use]
    pub fn with_fitted(&self, parameters: usize, long_run_variance: f64) -> Self {
        let samples = self.samples().max(1) as f64;
        let each = (long_run_variance * parameters as f64 / samples).min(self.sums[0] / samples);
        let sums = self.sums.iter().zip(&self.pairs).map(|(sum, n)| sum + each * *n as f64);
        Self { sums: sums.collect(), pairs: self.pairs.clone() }
    }

    /// Number of samples pushed.
    pub fn samples(&self) -> usize {
        self.pairs[0]
    }

    /// The autocovariances, each divided by its own number of pairs, in the unit of the residuals,
    /// squared; they end before the first distance that no segment contains.
    ///
    /// Dividing by the number of samples instead would shrink a distance `k` by `k` samples in every
    /// segment, which on short arcs is much.
    pub fn unbiased(&self) -> Vec<f64> {
        let with_pairs = self.sums.iter().zip(&self.pairs).take_while(|(_, n)| **n > 0);
        with_pairs.map(|(sum, n)| sum / *n as f64).collect()
    }

    /// The autocovariances divided by the number of samples: too small, but always those of a process.
    fn biased(&self) -> Vec<f64> {
        let samples = self.samples().max(1) as f64;
        self.sums.iter().map(|sum| sum / samples).collect()
    }
}

/// Stationary autoregressive noise of evenly sampled, contiguous segments.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseModel {
    sigma: f64,
    phi: Vec<f64>,
    innovation_sigma: f64,
}

impl NoiseModel {
    /// Independent samples of standard deviation `sigma`.
    pub fn white(sigma: f64) -> Self {
        Self { sigma, phi: Vec::new(), innovation_sigma: sigma }
    }

    /// The autoregression with the coefficients `phi_1 .. phi_p` and the standard deviation of what is
    /// new in every sample.
    ///
    /// It is refused if it is not stationary.
    pub fn autoregressive(phi: Vec<f64>, innovation_sigma: f64) -> Result<Self> {
        let left: f64 = step_down(&phi)
            .ok_or_else(|| {
                Error::new(
                    Kind::Undetermined,
                    format!("the noise model with the coefficients {phi:?} grows without bound"),
                )
            })?
            .iter()
            .map(|k| 1.0 - k * k)
            .product();
        Ok(Self { sigma: innovation_sigma / left.sqrt(), phi, innovation_sigma })
    }

    /// Fits the order `0 ..= max_order` and the coefficients to residuals.
    ///
    /// If the unbiased autocovariances are not those of any process, which happens on few samples,
    /// the biased ones are used from the order on at which that shows.
    pub fn fit(autocovariances: &Autocovariances, max_order: usize) -> Result<Self> {
        let samples = autocovariances.samples();
        let variance = autocovariances.biased()[0];
        if samples == 0 || !variance.is_finite() {
            return Err(Error::new(
                Kind::Undetermined,
                format!("{samples} finite residuals do not determine a noise model"),
            ));
        }
        if variance == 0.0 {
            return Ok(Self::white(0.0));
        }
        let unbiased = levinson(&autocovariances.unbiased(), max_order);
        let mut orders = levinson(&autocovariances.biased(), max_order);
        for (order, better) in orders.iter_mut().zip(unbiased) {
            *order = better;
        }
        let n = samples as f64;
        let criterion =
            |(phi, variance): &(Vec<f64>, f64)| n * variance.ln() + 2.0 * phi.len() as f64;
        let best = orders.into_iter().min_by(|a, b| criterion(a).total_cmp(&criterion(b)));
        Ok(best.map_or_else(
            || Self::white(variance.sqrt()),
            |(phi, innovation)| Self {
                sigma: variance.sqrt(),
                phi,
                innovation_sigma: innovation.sqrt(),
            },
        ))
    }

    /// The autoregression that has these autocovariances, at the distances 0, 1, .. in samples; of as
    /// high an order as they are those of a process.
    pub fn of_autocovariances(autocovariances: &[f64]) -> Self {
        let sigma = autocovariances.first().map_or(0.0, |variance| variance.max(0.0).sqrt());
        if sigma == 0.0 {
            return Self::white(0.0);
        }
        levinson(autocovariances, autocovariances.len()).pop().map_or_else(
            || Self::white(sigma),
            |(phi, innovation)| Self { sigma, phi, innovation_sigma: innovation.sqrt() },
        )
    }

    /// Standard deviation of a single sample, in the unit of the residuals.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// `phi_1 .. phi_p`; empty for white noise.
    pub fn phi(&self) -> &[f64] {
        &self.phi
    }

    /// `sigma_i`: standard deviation of what is new in every sample, in the unit of the residuals.
    pub fn innovation_sigma(&self) -> f64 {
        self.innovation_sigma
    }

    /// What the variance of the mean of `n` contiguous samples times `n` tends to:
    /// `(sigma_i / (1 - sum phi))^2`, in the unit of the residuals, squared.
    pub fn long_run_variance(&self) -> f64 {
        (self.innovation_sigma / (1.0 - self.phi.iter().sum::<f64>())).powi(2)
    }

    /// The same where its mean over many samples scatters by no more than `most` times what that of independent ones
    /// would: else with the correlations `rho_k g^k`, `g` below 1, that do.
    ///
    /// What a fit leaves of something that is no noise changes so little from sample to sample that an autoregression
    /// takes it for a correlation without end.
    #[must_use]
    pub fn within(&self, most: f64) -> Self {
        let damped = |g: f64| {
            let powers = std::iter::successors(Some(g), |power| Some(power * g));
            let phi = self.phi.iter().zip(powers).map(|(phi, power)| phi * power).collect();
            Self::autoregressive(phi, 1.0).ok()
        };
        let ratio = |noise: &Self| noise.long_run_variance() / noise.sigma.powi(2);
        if self.sigma == 0.0 || ratio(self) <= most {
            return self.clone();
        }
        let (mut enough, mut too_much) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let g = 0.5 * (enough + too_much);
            let within = damped(g).is_some_and(|noise| ratio(&noise) <= most);
            *(if within { &mut enough } else { &mut too_much }) = g;
        }
        damped(enough)
            .map_or_else(|| Self::white(self.sigma), |of| of.scaled(self.sigma / of.sigma))
    }

    /// The same correlations with every standard deviation multiplied by `factor`, for residuals that
    /// had weights or whose degrees of freedom are to be counted.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            sigma: self.sigma * factor,
            phi: self.phi.clone(),
            innovation_sigma: self.innovation_sigma * factor,
        }
    }

    /// Correlations of samples `0 .. lags` apart; the first is 1.
    pub fn autocorrelation(&self, lags: usize) -> Vec<f64> {
        // Within the order from the reflection coefficients, beyond it by the recursion of the process.
        let reflections = step_down(&self.phi).unwrap_or_default();
        let mut rho = vec![1.0];
        let (mut shorter, mut left) = (Vec::new(), 1.0);
        for &k in &reflections {
            rho.push(predict(&shorter, &rho) + k * left);
            left *= 1.0 - k * k;
            shorter = step_up(&shorter, k);
        }
        while rho.len() < lags {
            rho.push(predict(&self.phi, &rho));
        }
        rho.truncate(lags);
        rho
    }

    /// How many independent samples tell as much about a constant as `n` contiguous ones of this noise:
    /// `n / (1 + 2 sum_k (1 - k/n) rho_k)`, `k = 1 .. n-1`.
    pub fn effective_samples(&self, n: usize) -> f64 {
        let total = n as f64;
        let weigh = |(k, rho): (usize, f64)| (1.0 - k as f64 / total) * rho;
        let sum: f64 = self.autocorrelation(n).into_iter().enumerate().skip(1).map(weigh).sum();
        total / (1.0 + 2.0 * sum)
    }

    /// The lower triangular `C` with `C C^T` the covariance of `n` contiguous samples, in the unit of
    /// the residuals. It costs `n^3`: meant for the few samples at the start of a segment.
    pub(super) fn covariance_root(&self, n: usize) -> Matrix {
        let rho = self.autocorrelation(n);
        let mut c = Matrix::zeros(n, n);
        for i in 0..n {
            for k in 0..=i {
                let left = rho[i - k] - dot(&c.row(i)[..k], &c.row(k)[..k]);
                c[(i, k)] = if i == k { left.max(0.0).sqrt() } else { left / c[(k, k)] };
            }
        }
        Matrix::from_fn(n, n, |i, k| self.sigma * c[(i, k)])
    }
}

/// What the coefficients expect of the next value, the last of `past` being the most recent.
fn predict(phi: &[f64], past: &[f64]) -> f64 {
    phi.iter().zip(past.iter().rev()).map(|(p, x)| p * x).sum()
}

/// Coefficients and innovation variance of every order `0 ..= max_order` that the autocovariances allow.
fn levinson(covariances: &[f64], max_order: usize) -> Vec<(Vec<f64>, f64)> {
    let Some(&variance) = covariances.first() else {
        return Vec::new();
    };
    let mut orders = vec![(Vec::new(), variance)];
    let (mut phi, mut left) = (Vec::new(), variance);
    for order in 1..=max_order.min(covariances.len() - 1) {
        let reflection = (covariances[order] - predict(&phi, &covariances[..order])) / left;
        // Written so that a reflection that is not a number ends the recursion, too.
        let stationary = reflection.abs() < 1.0;
        if !stationary {
            break;
        }
        phi = step_up(&phi, reflection);
        left *= 1.0 - reflection * reflection;
        orders.push((phi.clone(), left));
    }
    orders
}

/// The coefficients of the next order from those of this one and the next reflection coefficient.
fn step_up(phi: &[f64], reflection: f64) -> Vec<f64> {
    let reversed = phi.iter().rev();
    let shorter = phi.iter().zip(reversed).map(|(p, r)| p - reflection * r);
    shorter.chain(std::iter::once(reflection)).collect()
}

/// The reflection coefficients, first order first; nothing if the process is not stationary.
fn step_down(phi: &[f64]) -> Option<Vec<f64>> {
    let mut phi = phi.to_vec();
    let mut reflections = Vec::with_capacity(phi.len());
    while let Some(k) = phi.pop() {
        let stationary = k.abs() < 1.0;
        if !stationary {
            return None;
        }
        reflections.push(k);
        let reversed = phi.iter().rev();
        let shorter = phi.iter().zip(reversed);
        phi = shorter.map(|(p, r)| (p + k * r) / (1.0 - k * k)).collect();
    }
    reflections.reverse();
    Some(reflections)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    fn segments(
        noise: &NoiseModel,
        count: usize,
        length: usize,
        max_lag: usize,
    ) -> Autocovariances {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let mut all = Autocovariances::new(max_lag);
        for _ in 0..count {
            // Long enough a lead to forget that it began with silence.
            let mut e: Vec<f64> = Vec::new();
            for _ in 0..length + 500 {
                let w: f64 = StandardNormal.sample(&mut rng);
                e.push(predict(noise.phi(), &e) + noise.innovation_sigma() * w);
            }
            all.push_segment(&e[500..]);
        }
        all
    }

    #[test]
    fn first_order_correlations_are_powers() {
        let noise = NoiseModel::autoregressive(vec![0.8], 0.6).unwrap();
        assert!((noise.sigma() - 1.0).abs() < 1e-15);
        let expected: Vec<f64> = (0..20).map(|k| 0.8_f64.powi(k)).collect();
        assert!(close(&noise.autocorrelation(20), &expected, 1e-15));
        // The classical limit n (1 - phi) / (1 + phi).
        assert!((noise.effective_samples(100_000) / 100_000.0 - 0.2 / 1.8).abs() < 1e-5);
        assert!((NoiseModel::white(3.0).effective_samples(17) - 17.0).abs() < 1e-12);
    }

    #[test]
    fn correlations_fulfil_the_yule_walker_equations() {
        let noise = NoiseModel::autoregressive(vec![0.9, -0.5, 0.2], 2.0).unwrap();
        let rho = noise.autocorrelation(30);
        for t in 1..30_usize {
            let expected: f64 = (1..=3).map(|k| noise.phi()[k - 1] * rho[t.abs_diff(k)]).sum();
            assert!((rho[t] - expected).abs() < 1e-14, "{t}");
        }
        let explained: f64 = (1..=3).map(|k| noise.phi()[k - 1] * rho[k]).sum();
        assert!((noise.sigma().powi(2) * (1.0 - explained) - 4.0).abs() < 1e-13);
    }

    #[test]
    fn what_grows_is_refused() {
        for phi in [vec![1.0], vec![0.5, 0.6], vec![f64::NAN]] {
            let error = NoiseModel::autoregressive(phi, 1.0).unwrap_err();
            assert_eq!(error.kind, Kind::Undetermined);
        }
    }

    #[test]
    fn order_and_coefficients_are_found_again() {
        for phi in [vec![], vec![0.9], vec![1.2, -0.5]] {
            let truth = NoiseModel::autoregressive(phi.clone(), 0.3).unwrap();
            let found = NoiseModel::fit(&segments(&truth, 40, 500, 12), 12).unwrap();
            assert!(close(found.phi(), &phi, 0.03), "{phi:?} {found:?}");
            assert!((found.innovation_sigma() / 0.3 - 1.0).abs() < 0.02);
            assert!((found.sigma() / truth.sigma() - 1.0).abs() < 0.06);
        }
    }

    #[test]
    fn short_segments_do_not_shrink_the_correlation() {
        let truth = NoiseModel::autoregressive(vec![0.9], 1.0).unwrap();
        let found = NoiseModel::fit(&segments(&truth, 4000, 10, 1), 1).unwrap();
        // Divided by the number of samples, 0.9 would come out as 0.81.
        assert!((found.phi()[0] - 0.9).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn what_a_fit_has_taken_out_is_given_back() {
        let truth = NoiseModel::autoregressive(vec![0.9], 1.0).unwrap();
        assert!((truth.long_run_variance() - 100.0).abs() < 1e-9);
        let (count, length) = (2000, 200_usize);
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let mut all = Autocovariances::new(3);
        for _ in 0..count {
            let mut e: Vec<f64> = Vec::new();
            for _ in 0..length + 200 {
                let w: f64 = StandardNormal.sample(&mut rng);
                e.push(predict(truth.phi(), &e) + w);
            }
            // A fit of one constant to every segment.
            let mean = e[200..].iter().sum::<f64>() / length as f64;
            let residuals: Vec<f64> = e[200..].iter().map(|e| e - mean).collect();
            all.push_segment(&residuals);
        }
        let variance = truth.sigma().powi(2);
        assert!(all.unbiased()[0] / variance < 0.93);
        let whole = all.with_fitted(count, truth.long_run_variance()).unbiased();
        for (lag, covariance) in whole.iter().enumerate() {
            let expected = variance * 0.9_f64.powf(lag as f64);
            assert!((covariance / expected - 1.0).abs() < 0.02, "{lag}: {covariance} {expected}");
        }
    }

    #[test]
    fn what_lasts_is_damped_to_as_many_readings_as_are_plausible() {
        let noise = NoiseModel::autoregressive(vec![1.2, -0.202], 0.1).unwrap();
        let most = 21.0;
        assert!(noise.long_run_variance() > 1000.0 * most * noise.sigma().powi(2) / 100.0);
        let within = noise.within(most);
        assert!((within.sigma() / noise.sigma() - 1.0).abs() < 1e-12);
        let ratio = within.long_run_variance() / within.sigma().powi(2);
        assert!(ratio <= most && ratio > 0.999 * most, "{ratio}");
        // What is plausible stays as it is.
        let plausible = NoiseModel::autoregressive(vec![0.8], 0.6).unwrap();
        assert_eq!(plausible.within(most), plausible);
        assert_eq!(NoiseModel::white(0.0).within(most), NoiseModel::white(0.0));
    }

    #[test]
    fn never_more_is_given_back_than_was_left() {
        let mut all = Autocovariances::new(1);
        all.push_segment(&[1.0; 10]);
        assert_eq!(all.with_fitted(40, 100.0).unbiased(), [2.0, 2.0]);
    }

    #[test]
    fn few_samples_end_in_a_process_all_the_same() {
        let mut all = Autocovariances::new(8);
        all.push_segment(&[1.0, 2.0, 3.0]);
        let found = NoiseModel::fit(&all, 8).unwrap();
        assert!(step_down(found.phi()).is_some() && found.innovation_sigma() > 0.0);
        let mut zero = Autocovariances::new(2);
        zero.push_segment(&[0.0; 5]);
        assert_eq!(NoiseModel::fit(&zero, 2).unwrap(), NoiseModel::white(0.0));
        assert!(NoiseModel::fit(&Autocovariances::new(2), 2).is_err());
        let mut bad = Autocovariances::new(2);
        bad.push_segment(&[0.0, f64::NAN]);
        assert!(NoiseModel::fit(&bad, 2).is_err());
    }
}
