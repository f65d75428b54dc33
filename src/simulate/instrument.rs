//! The instrument: from a deviation to what it writes down.

use super::noise::NoiseSource;
use super::random::{Purpose, Stream};
use super::scenario::{Dropouts, Scenario};

/// Most decimals of a micrometre that a log is written with.
const MOST_DECIMALS: u8 = 9;

/// What the instrument makes of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    /// A row with a deviation, mm, or with none because the bar is out of range or does not answer.
    Row(Option<f64>),
    /// No row at all.
    Missing,
}

/// Steps, range, noise and dropouts.
#[derive(Debug)]
pub(super) struct Instrument {
    range_mm: f64,
    steps: Steps,
    noise: NoiseSource,
    gaps: Option<Gaps>,
}

impl Instrument {
    pub(super) fn new(scenario: &Scenario, of: Reads, period_s: f64) -> Self {
        Self {
            range_mm: of.range_mm,
            steps: Steps::new(of.resolution_mm),
            noise: NoiseSource::new(scenario.noise, period_s, scenario.seed),
            gaps: scenario.dropouts.map(|of| Gaps::new(of, period_s, scenario.seed)),
        }
    }

    /// The next sample, whose exact deviation is `exact_mm`.
    pub(super) fn sample(&mut self, exact_mm: f64) -> Outcome {
        // Noise and gaps are drawn in range and out of it: what one sample shows does not depend on
        // how many came before it in range.
        let read_mm = self.steps.round_mm(exact_mm + self.noise.next_mm());
        if let Some(gaps) = &mut self.gaps
            && gaps.next()
        {
            return if gaps.of.missing_rows { Outcome::Missing } else { Outcome::Row(None) };
        }
        Outcome::Row((read_mm.abs() <= self.range_mm).then_some(read_mm))
    }
}

/// What the instrument can read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reads {
    /// Either way, mm.
    pub(super) range_mm: f64,
    /// Smallest step, mm.
    pub(super) resolution_mm: f64,
}

/// Quantisation, to the doubles that a log of so many decimals reads back as.
#[derive(Debug, Clone, Copy)]
struct Steps {
    resolution_um: f64,
    per_um: f64,
}

impl Steps {
    fn new(resolution_mm: f64) -> Self {
        let resolution_um = resolution_mm * 1e3;
        Self { resolution_um, per_um: 10.0_f64.powi(decimals(resolution_mm).into()) }
    }

    fn round_mm(self, value_mm: f64) -> f64 {
        let stepped_um = (value_mm * 1e3 / self.resolution_um).round() * self.resolution_um;
        // Adding zero turns -0 into 0.
        (stepped_um * self.per_um).round() / self.per_um / 1e3 + 0.0
    }
}

/// Decimals of a micrometre that hold every multiple of a resolution, at least one.
pub(super) fn decimals(resolution_mm: f64) -> u8 {
    let whole = |decimals: &u8| {
        let steps = resolution_mm * 1e3 * 10.0_f64.powi((*decimals).into());
        steps >= 0.5 && (steps - steps.round()).abs() < 1e-6 * steps
    };
    (1..MOST_DECIMALS).find(whole).unwrap_or(MOST_DECIMALS)
}

/// Stretches in which the radio does not reach the computer.
#[derive(Debug)]
struct Gaps {
    of: Dropouts,
    period_s: f64,
    stream: Stream,
    /// Time left until the next gap begins or, inside one, until it ends, s.
    until_s: f64,
    inside: bool,
}

impl Gaps {
    fn new(of: Dropouts, period_s: f64, seed: u64) -> Self {
        let mut stream = Stream::new(seed, Purpose::Dropouts);
        let until_s = stream.exponential() / of.per_s;
        Self { of, period_s, stream, until_s, inside: false }
    }

    /// Whether the next sample is lost.
    fn next(&mut self) -> bool {
        while self.until_s <= 0.0 {
            self.inside = !self.inside;
            let mean_s = if self.inside { self.of.mean_s } else { self.of.per_s.recip() };
            self.until_s += self.stream.exponential() * mean_s;
        }
        self.until_s -= self.period_s;
        self.inside
    }
}
