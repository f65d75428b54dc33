//! Residuals without what each foretells of the next.

use super::noise::NoiseModel;

impl NoiseModel {
    /// `w = L^-1 e` of one contiguous segment, where `L L^T` is the covariance of the noise: what the values
    /// before it do not foretell of each, in standard deviations of that. Of noise as this model has it, `w` is
    /// white with an rms of 1.
    ///
    /// ```text
    /// w_t = (e_t - sum_k phi_k e_(t-k)) / sigma_i      for t >= p
    /// C w = e                                          for t <  p, C as in `covariance_root`
    /// ```
    pub fn whitened(&self, segment: &[f64]) -> Vec<f64> {
        let phi = self.phi();
        let first = phi.len().min(segment.len());
        let root = self.covariance_root(first);
        let mut white: Vec<f64> = Vec::with_capacity(segment.len());
        for t in 0..first {
            let known: f64 = (0..t).map(|i| root[(t, i)] * white[i]).sum();
            white.push((segment[t] - known) / root[(t, t)]);
        }
        for t in first..segment.len() {
            let foretold: f64 =
                phi.iter().enumerate().map(|(k, phi)| phi * segment[t - 1 - k]).sum();
            white.push((segment[t] - foretold) / self.innovation_sigma());
        }
        white
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_undoes_the_covariance_root() {
        let noise = NoiseModel::autoregressive(vec![0.6, -0.2, 0.1], 0.3).unwrap();
        let white = [1.0, -0.5, 0.25, 2.0, 0.0, -1.5, 0.75];
        let root = noise.covariance_root(white.len());
        let of = |t: usize| (0..=t).map(|i| root[(t, i)] * white[i]).sum::<f64>();
        let coloured: Vec<f64> = (0..white.len()).map(of).collect();
        for (w, back) in white.iter().zip(noise.whitened(&coloured)) {
            assert!((w - back).abs() < 1e-12, "{w} {back}");
        }
        assert_eq!(noise.whitened(&[0.5]).len(), 1, "shorter than its order");
    }
}
