//! What can be followed over time: answers at the place of a test, and values of circular tests.

/// What a quantity is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A property of the machine about the place: scale, squareness, reversal, lateral play.
    Machine,
    /// A range over the test: straightness, positioning, angles; of another place or bar it is of something else.
    Range,
    /// A value of a circular test about this centre, mm; the second says whether the length of the bar is in it.
    Circular([f64; 3], bool),
}

/// A number of a test with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Such as `squareness XY` or `G(b) XY plane F1000`.
    pub name: String,
    /// Unit of all its numbers: `um/m`, `um` or `urad`.
    pub unit: String,
    /// What it is of.
    pub kind: Kind,
    /// The value, mean over the repeats.
    pub value: f64,
    /// Standard deviation of that by the noise, and at least by the scatter of the repeats; `None` where it is not stated.
    pub noise: Option<f64>,
    /// Standard deviation by the noise and by what the test cannot tell from other plausible faults, or does not know of the
    /// bar; `None` where it is not stated.
    pub all: Option<f64>,
    /// Standard deviation of what was plausible beforehand; `None` where that is not stated.
    pub plausible: Option<f64>,
    /// By how much noise widens it; the same in every test with the same noise.
    pub widened: f64,
    /// What would look the same.
    pub looks_like: Vec<String>,
}

impl Quantity {
    /// The share of what was plausible that the test tells, 0 to 1; `None` where that is not stated.
    pub fn told(&self) -> Option<f64> {
        let (all, plausible) = (self.all?, self.plausible?);
        Some((1.0 - (all / plausible.max(f64::MIN_POSITIVE)).powi(2)).clamp(0.0, 1.0))
    }
}

/// Mean of values of repeats, its standard deviation by their own noise, and at least by their scatter.
pub(super) fn mean(values: &[(f64, f64)]) -> (f64, f64) {
    let count = values.len().max(1) as f64;
    let mean = values.iter().map(|(value, _)| value).sum::<f64>() / count;
    let noise = values.iter().map(|(_, noise)| noise * noise).sum::<f64>().sqrt() / count;
    let squares: f64 = values.iter().map(|(value, _)| (value - mean).powi(2)).sum();
    let scatter = if values.len() > 1 { (squares / (count - 1.0) / count).sqrt() } else { 0.0 };
    (mean, noise.max(scatter))
}

#[cfg(test)]
mod tests {
    use super::mean;

    #[test]
    fn noise_is_at_least_the_scatter() {
        let (value, noise) = mean(&[(1.0, 0.1), (3.0, 0.1)]);
        assert!((value - 2.0).abs() < 1e-12 && (noise - 1.0).abs() < 1e-12, "{noise}");
        let (_, noise) = mean(&[(1.0, 0.3), (1.0, 0.4)]);
        assert!((noise - 0.25).abs() < 1e-12, "{noise}");
        assert!((mean(&[(5.0, 0.2)]).1 - 0.2).abs() < 1e-12);
    }
}
