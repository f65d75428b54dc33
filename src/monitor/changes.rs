//! What changed from one test to another, beyond the uncertainties of both.

use super::chance::exceeded_by_chance;
use super::circumstances::{Circumstances, distance_mm};
use super::past::{FoundThen, NumberThen, Past};
use super::quantity::{Kind, Quantity};
use super::thresholds::{APART, SAME_PLACE, TOLD};

/// Two tests beside each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What differs in who was tested and how, in sentences.
    pub differences: Vec<String>,
    /// Whether the tests are equal, so that unknowns in common do not count.
    pub equal: bool,
    /// A difference counts as a change beyond so many of its standard deviations.
    pub beyond: f64,
    /// How much of what is plausible has changed at most; 0 where nothing stands out, and of independent tests.
    pub share: f64,
    /// What both tests tell, in the order of the second.
    pub changes: Vec<Change>,
    /// What one has found, or both.
    pub findings: Vec<FindingChange>,
    /// What only one of them tells, or what cannot be compared, each with the reason.
    pub untold: Vec<String>,
}

/// A quantity before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Its name.
    pub name: String,
    /// What it is of.
    pub kind: Kind,
    /// Unit of all that follows.
    pub unit: String,
    /// Before, and its standard deviation by all that is not known; `None` where that is not stated.
    pub before: (f64, Option<f64>),
    /// After.
    pub after: (f64, Option<f64>),
    /// Its standard deviation by the noise of both; `None` where one does not state it.
    pub noise: Option<f64>,
    /// Standard deviation of the difference; `None` where one test does not state enough.
    pub sigma: Option<f64>,
    /// What follows.
    pub judged: Judged,
    /// What would look the same in these tests.
    pub looks_like: Vec<String>,
}

impl Change {
    /// After minus before.
    pub fn difference(&self) -> f64 {
        self.after.0 - self.before.0
    }
}

/// Whether something has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// It has.
    Changed,
    /// It has, or what looks like it has: these tests cannot tell it from something else that has changed.
    WithIt,
    /// No change that could be told.
    Same,
    /// The tests do not state enough.
    Unknown,
}

/// A finding of one test or both.
#[derive(Debug, Clone, PartialEq)]
pub struct FindingChange {
    /// What it is, in words.
    pub title: String,
    /// Where it was found.
    pub found: Found,
    /// What it left in the residual, um rms: before, after.
    pub rms_um: [Option<f64>; 2],
    /// Numbers of both: name, before, after, standard deviation of the difference, whether that is a change.
    pub numbers: Vec<(String, f64, f64, Option<f64>, bool)>,
}

/// Where a finding was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Found {
    /// In both.
    Both,
    /// After, and before it would have been seen.
    New,
    /// Before, and after it would have been seen.
    Gone,
    /// In one, and the other would not have seen what is below so many um rms.
    Below(f64),
    /// In one, and nobody looked in the other.
    NotLooked,
}

impl Found {
    /// Whether something has changed.
    pub fn is_change(self) -> bool {
        matches!(self, Self::New | Self::Gone)
    }
}

impl Comparison {
    /// Compares two tests.
    pub fn of(before: &Past, after: &Past) -> Self {
        let circumstances = Circumstances::of(before, after);
        let mut untold = Vec::new();
        let mut pairs = Vec::new();
        for new in &after.quantities {
            match before.quantity(&new.name) {
                Some(old) => match why_not(old, new, &circumstances) {
                    None => pairs.push((old, new)),
                    Some(why) => untold.push(format!("{}: {why}", new.name)),
                },
                None => untold.push(format!("{}: only after", new.name)),
            }
        }
        for old in &before.quantities {
            if after.quantity(&old.name).is_none() {
                untold.push(format!("{}: only before", old.name));
            }
        }
        let numbers = |past: &Past| {
            let found = past.findings.iter().flatten();
            found.map(|of| of.numbers.len()).sum::<usize>()
        };
        let beyond = exceeded_by_chance(pairs.len() + numbers(before).min(numbers(after)));
        let differences: Vec<Difference> =
            pairs.iter().map(|(old, new)| Difference::of(old, new)).collect();
        let share = if circumstances.equal {
            let most = differences.iter().filter(|of| of.stands_out(beyond) && of.is_told());
            most.filter_map(Difference::share).fold(0.0, f64::max)
        } else {
            0.0
        };
        let changes = pairs.iter().zip(&differences);
        Self {
            changes: changes
                .map(|((old, new), difference)| {
                    difference.judge(old, new, &circumstances, [beyond, share])
                })
                .collect(),
            findings: findings(before, after, beyond),
            differences: circumstances.differences,
            equal: circumstances.equal,
            beyond,
            share,
            untold,
        }
    }
}

/// Why two quantities of one name are not compared; `None` where they are.
fn why_not(old: &Quantity, new: &Quantity, circumstances: &Circumstances) -> Option<&'static str> {
    if old.unit != new.unit {
        return Some("in two units");
    }
    match (new.kind, old.kind) {
        (Kind::Machine, _) => None,
        (Kind::Circular(a, with_bar), Kind::Circular(b, _)) => {
            // Diameter, angle and feed are in its name.
            let near_mm = SAME_PLACE * diameter_mm(&new.name).unwrap_or(0.0) / 2.0;
            if distance_mm(a, b) > near_mm {
                return Some("at another place");
            }
            (with_bar && !circumstances.same_bar).then_some("with another bar")
        }
        _ => (!circumstances.same_place).then_some("a range, at another place or with another bar"),
    }
}

/// As it stands in the name of a circular test.
fn diameter_mm(name: &str) -> Option<f64> {
    name.split(' ').filter_map(|word| word.strip_prefix('d')?.parse().ok()).next_back()
}

/// What is known of a difference.
struct Difference {
    value: f64,
    /// Its variance by the noise.
    noise2: Option<f64>,
    /// What each test leaves open besides, mean of both.
    open2: Option<f64>,
    /// Variance where the tests are independent.
    all2: Option<f64>,
    plausible: Option<f64>,
    /// The share of what is plausible that the test that tells less tells.
    told: Option<f64>,
    /// Whether noise is what tells both apart: what is left of a curve about its line moves with the set-up.
    alike: bool,
}

impl Difference {
    fn of(old: &Quantity, new: &Quantity) -> Self {
        let sum = |a: Option<f64>, b: Option<f64>| Some(a?.powi(2) + b?.powi(2));
        let circular = matches!(new.kind, Kind::Circular(..));
        // By how much noise widens a range is known to no better than by the difference of both.
        let noise2 = sum(old.noise, new.noise).map(|n| n + (new.widened - old.widened).powi(2));
        let all2 = sum(old.all, new.all);
        Self {
            value: new.value - old.value,
            noise2,
            open2: all2.zip(noise2).map(|(all, noise)| (0.5 * (all - noise)).max(0.0)),
            all2: if circular { noise2 } else { all2 },
            plausible: old.plausible.zip(new.plausible).map(|(a, b)| a.min(b)),
            told: old.told().zip(new.told()).map(|(a, b)| a.min(b)),
            alike: new.kind != Kind::Range,
        }
    }

    fn stands_out(&self, beyond: f64) -> bool {
        self.noise2.is_some_and(|noise2| self.value.abs() > beyond * noise2.sqrt())
    }

    fn is_told(&self) -> bool {
        self.alike && self.told.is_some_and(|told| told > TOLD)
    }

    fn share(&self) -> Option<f64> {
        Some(self.value.abs() / self.plausible.filter(|plausible| *plausible > 0.0)?)
    }

    fn judge(
        &self,
        old: &Quantity,
        new: &Quantity,
        circumstances: &Circumstances,
        [beyond, share]: [f64; 2],
    ) -> Change {
        let circular = matches!(new.kind, Kind::Circular(..));
        let out = self.stands_out(beyond);
        let (sigma, judged) = if circular {
            (self.noise2, if out { Judged::Changed } else { Judged::Same })
        } else if let (true, Some(noise2), Some(open2), Some(_)) =
            (circumstances.equal && self.alike, self.noise2, self.open2, self.told)
        {
            let sigma2 = noise2 + share * share * open2;
            let apart = self.value.abs() > APART * sigma2.sqrt();
            let judged = match out {
                true if apart && self.is_told() => Judged::Changed,
                true => Judged::WithIt,
                false => Judged::Same,
            };
            (Some(sigma2), judged)
        } else {
            // Where nothing was taken for plausible, noise is all that is stated.
            let sigma2 =
                self.all2.or(self.noise2.filter(|_| old.all.is_none() && new.all.is_none()));
            let beyond_all = sigma2.map(|sigma2| self.value.abs() > beyond * sigma2.sqrt());
            let judged = match beyond_all {
                Some(true) => Judged::Changed,
                Some(false) => Judged::Same,
                None => Judged::Unknown,
            };
            (sigma2, judged)
        };
        // A quantity without any uncertainty is none that changes could be told of.
        let judged = if sigma.is_some() { judged } else { Judged::Unknown };
        Change {
            name: new.name.clone(),
            kind: new.kind,
            unit: new.unit.clone(),
            before: (old.value, old.all.or(old.noise)),
            after: (new.value, new.all.or(new.noise)),
            noise: self.noise2.map(f64::sqrt),
            sigma: sigma.map(f64::sqrt),
            judged,
            looks_like: new.looks_like.clone(),
        }
    }
}

/// Findings of both, those of the later test first.
fn findings(before: &Past, after: &Past, beyond: f64) -> Vec<FindingChange> {
    let of = |past: &'_ Past| past.findings.clone().unwrap_or_default();
    let (old, new) = (of(before), of(after));
    let alone = |of: &FoundThen, other: &Past, told: Found| match (
        other.findings.is_some(),
        other.smallest_um,
    ) {
        (false, _) => Found::NotLooked,
        (true, Some(least)) if of.rms_um < least => Found::Below(least),
        _ => told,
    };
    let mut changes = Vec::new();
    for one in &new {
        let earlier = old.iter().find(|other| other.key == one.key);
        changes.push(FindingChange {
            title: one.title.clone(),
            found: earlier.map_or_else(|| alone(one, before, Found::New), |_| Found::Both),
            rms_um: [earlier.map(|of| of.rms_um), Some(one.rms_um)],
            numbers: earlier.map_or_else(Vec::new, |earlier| numbers(earlier, one, beyond)),
        });
    }
    for one in old.iter().filter(|one| new.iter().all(|other| other.key != one.key)) {
        changes.push(FindingChange {
            title: one.title.clone(),
            found: alone(one, after, Found::Gone),
            rms_um: [Some(one.rms_um), None],
            numbers: Vec::new(),
        });
    }
    changes
}

fn numbers(
    old: &FoundThen,
    new: &FoundThen,
    beyond: f64,
) -> Vec<(String, f64, f64, Option<f64>, bool)> {
    let pair = |after: &NumberThen| {
        let before = old.numbers.iter().find(|before| before.name == after.name)?;
        let sigma = before.sigma.zip(after.sigma).map(|(a, b)| a.hypot(b));
        let changed =
            sigma.is_some_and(|sigma| (after.value - before.value).abs() > beyond * sigma);
        Some((after.name.clone(), before.value, after.value, sigma, changed))
    };
    new.numbers.iter().filter_map(pair).collect()
}
