//! What people ask of the machine, at the place of the test, over the repeats.

use rayon::prelude::*;
use serde::Serialize;

use crate::identify::{
    self, Answer, Asked, Campaign, IMPLAUSIBLE, Identification, OPEN, SEEN, Suspect,
};
use crate::machine::{Axis, Machine};
use crate::model::{Local, LocalShape, ParameterId};
use crate::plan::{Record, Test, Warmth};
use crate::report::text::numbers::{finite, fixed};
use crate::report::text::words::{capital, list};

/// An answer over the repeats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceResult {
    /// What was asked, such as `squareness XY`.
    pub quantity: String,
    /// Unit of the numbers that follow: `um/m`, `um` or `urad`.
    pub unit: &'static str,
    /// Mean over the repeats.
    pub value: f64,
    /// Standard deviation of the mean by the noise, and at least by the scatter of repeats of one test.
    pub noise: Option<f64>,
    /// Standard deviation of the mean by that and by what the test cannot tell from other plausible faults; `None`
    /// where nothing was taken for plausible.
    pub all: Option<f64>,
    /// Standard deviation of what was plausible for it before anything was measured; `None` as above, and at 20 degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plausible: Option<f64>,
    /// Standard deviation between the repeats; `None` for one.
    pub deviation: Option<f64>,
    /// That over what the noise of one repeat makes; `None` as above, and where they are not of one test.
    #[serde(skip)]
    pub over_noise: Option<f64>,
    /// Where `all` is more than three times `noise`: the plausible faults that look the same in this test, the gravest
    /// first.
    pub looks_like: Vec<String>,
}

impl PlaceResult {
    /// Whether these runs tell nothing of it: all but [`SEEN`] of what is stated was plausible beforehand, and the value is within it.
    pub(super) fn is_unseen(&self) -> bool {
        let (Some(all), Some(plausible)) = (self.all, self.plausible) else { return false };
        1.0 - (all / plausible.max(f64::MIN_POSITIVE)).powi(2) < SEEN && self.value.abs() < all
    }

    /// With what is not known of the bar in *all* of a scale.
    fn beside_bar(mut self, bar_um_m: Option<f64>) -> Self {
        if self.is_scale() {
            (self.all, self.looks_like) =
                beside_bar(bar_um_m, self.noise.unwrap_or(0.0), self.all, self.looks_like);
        }
        self
    }

    /// Whether it is the scale of an axis.
    pub(in crate::report) fn is_scale(&self) -> bool {
        self.quantity.starts_with("scale ")
    }

    /// What a reader should know of it, where the test leaves much more open than noise does.
    pub(super) fn caution(&self) -> Option<String> {
        // Of angles one set-up shows little: that is told once, and not of each.
        let asked_for = self.unit != "urad" && !self.is_unseen();
        let all = self.all.filter(|_| asked_for && !self.looks_like.is_empty())?;
        Some(format!(
            "{} is known to {} {} only: {} would look the same in this test.",
            capital(&self.quantity),
            fixed(all, decimals(all)),
            self.unit,
            list(self.looks_like.iter().map(String::as_str))
        ))
    }
}

/// The quantities that these runs tell something of, and the names of the others.
pub(super) fn seen(results: &[PlaceResult]) -> (Vec<&PlaceResult>, Vec<&str>) {
    let (unseen, seen): (Vec<_>, Vec<_>) = results.iter().partition(|result| result.is_unseen());
    (seen, unseen.into_iter().map(|result| result.quantity.as_str()).collect())
}

/// Two digits of an uncertainty.
pub(in crate::report) fn decimals(uncertainty: f64) -> usize {
    match uncertainty {
        u if u >= 9.95 => 0,
        u if u >= 0.995 => 1,
        u if u >= 0.0995 => 2,
        _ => 3,
    }
}

/// All that was asked, over the repeats of a campaign.
pub(super) fn of(test: &Test, machine: &Machine, campaign: &Campaign) -> Vec<PlaceResult> {
    let Some(frame) = &campaign.frame else { return Vec::new() };
    let each: Vec<Vec<Answer>> = campaign
        .repeats
        .par_iter()
        .enumerate()
        .filter_map(|(index, repeat)| {
            let model = campaign.model(test, machine, index).ok()?;
            Some(identify::answers(&model, frame, &repeat.known(&repeat.values())))
        })
        .collect();
    let asked = each.first().map_or(0, Vec::len);
    let with_temperature = |result: PlaceResult| {
        let reduced = at_20_c(test.record(), &result);
        std::iter::once(result).chain(reduced)
    };
    let of_one_test = identify::of_one_test(&campaign.repeats);
    let bar_um_m = bar_um_m(test);
    (0..asked)
        .map(|k| over_repeats(&each, k, of_one_test).beside_bar(bar_um_m))
        .flat_map(with_temperature)
        .collect()
}

/// *All* of a scale with what is not known of the length of the bar, um/m, and what looks the same: a bar that is longer than it is called
/// reads as a smaller scale of every axis.
pub(in crate::report) fn beside_bar(
    bar_um_m: Option<f64>,
    noise: f64,
    all: Option<f64>,
    mut looks_like: Vec<String>,
) -> (Option<f64>, Vec<String>) {
    let Some(bar_um_m) = bar_um_m else { return (all, looks_like) };
    if bar_um_m > OPEN * noise {
        looks_like.insert(0, "a bar of another length".to_owned());
    }
    (all.map(|all| all.hypot(bar_um_m)), looks_like)
}

/// What is not known of the length of the bar, as a scale of all axes; of several bars, of the shortest. `None` where it is not stated.
pub(in crate::report) fn bar_um_m(test: &Test) -> Option<f64> {
    let sigma_mm = test.ball_bar().length_sigma_mm?;
    let shortest_mm = test.mountings().iter().map(|mounting| mounting.bar_length_mm);
    Some(1e6 * sigma_mm / shortest_mm.fold(f64::INFINITY, f64::min))
}

/// A scale as it is at 20 degrees, where the record says how warm machine and bar were.
///
/// A bar that is longer than it is called reads too little by that, all around: to the fit this is a smaller scale of every
/// axis alike. The machine's scales have grown with their temperature.
fn at_20_c(record: &Record, of: &PlaceResult) -> Option<PlaceResult> {
    let axis = of.quantity.strip_prefix("scale ").filter(|_| !of.is_unseen())?;
    if record.machine.is_none() && record.bar.is_none() {
        return None;
    }
    let longer = |of: Option<Warmth>| of.map_or([0.0, 0.0], |of| of.longer_um_m());
    let ([bar, bar_sigma], [machine, machine_sigma]) = (longer(record.bar), longer(record.machine));
    let sigma = bar_sigma.hypot(machine_sigma);
    Some(PlaceResult {
        quantity: format!("scale {axis} at 20 C"),
        value: of.value + bar - machine,
        all: of.all.or(of.noise).map(|all| all.hypot(sigma)),
        plausible: None,
        over_noise: None,
        looks_like: Vec::new(),
        ..of.clone()
    })
}

fn over_repeats(each: &[Vec<Answer>], k: usize, of_one_test: bool) -> PlaceResult {
    let answers = || each.iter().filter_map(|answers| answers.get(k));
    let count = each.len() as f64;
    let values: Vec<f64> = answers().map(|a| a.value).collect();
    let mean = values.iter().sum::<f64>() / count;
    // Noise is another one every time; what a test leaves open is the same, and what is not known of effects.
    let square = |of: &[f64]| of.iter().map(|c| c * c).sum::<f64>();
    let own = answers().map(|a| a.noise.powi(2) - square(&a.in_common)).sum::<f64>();
    let numbers = answers().map(|a| a.in_common.len()).max().unwrap_or(0);
    let mean_of = |k: usize| answers().filter_map(|a| a.in_common.get(k)).sum::<f64>() / count;
    let in_common: Vec<f64> = (0..numbers).map(mean_of).collect();
    let own = (own.max(0.0) / count).sqrt();
    let deviation = identify::deviation(&values);
    // Repeats do not scatter by less than they do.
    let scatter = deviation.filter(|_| of_one_test);
    let own_of_mean = own.max(scatter.unwrap_or(0.0)) / count.sqrt();
    let noise = own_of_mean.hypot(square(&in_common).sqrt());
    let open = |a: &Answer| Some(a.all?.powi(2) - a.noise.powi(2));
    let open: Option<f64> = answers().map(open).sum();
    // The ends of a range may be others in every repeat.
    let before: Option<f64> =
        answers().map(|a| a.plausible.map(|plausible| plausible.powi(2))).sum();
    let before = before.map(|before| (before / count).sqrt());
    let all = open.map(|open| noise.hypot((open.max(0.0) / count).sqrt()));
    let asked = answers().next().map_or(Asked::Scale(Axis::X), |a| a.asked);
    let (unit, factor) = asked.unit();
    PlaceResult {
        quantity: asked.name(),
        unit,
        value: mean * factor + 0.0,
        noise: finite(noise * factor),
        all: all.and_then(|all| finite(all * factor)),
        plausible: before.and_then(|before| finite(before * factor)),
        deviation: deviation.and_then(|deviation| finite(deviation * factor)),
        over_noise: scatter.and_then(|deviation| finite(deviation / own)),
        // What scatters more than that is not told by what looks the same.
        looks_like: answers()
            .next()
            .filter(|_| all.is_some_and(|all| all > OPEN * noise))
            .map_or_else(Vec::new, looks_like),
    }
}

/// The faults that would look the same, where they leave much more open than noise does.
pub(in crate::report) fn looks_like(answer: &Answer) -> Vec<String> {
    let suspects = answer.alike.iter().filter(|_| answer.is_open());
    let words = suspects.map(|suspect| match suspect {
        Suspect::Fault(of) => fault(*of),
        Suspect::Control => "a control that drives otherwise than planned".to_owned(),
        Suspect::Unexplained => "a part of the effect that is not explained".to_owned(),
    });
    let mut words: Vec<String> = words.collect();
    words.dedup();
    words
}

/// What came out beyond three of its plausible deviations, in words; `None` where nothing did.
pub(super) fn implausible(of: &Identification) -> Option<String> {
    let beyond = of.estimates.iter().filter(|estimate| {
        let plausible = estimate.parameter.plausible.unwrap_or(f64::INFINITY);
        estimate.value.abs() > IMPLAUSIBLE * plausible
    });
    let faults: Vec<String> = beyond.map(|estimate| fault(estimate.parameter.id)).collect();
    (!faults.is_empty()).then(|| {
        format!(
            "More than plausible: {}. Either the machine is so, and `[plausible]` in its file should say it, or the log, the balls or the machine file are not what the test file says.",
            list(faults)
        )
    })
}

/// A fault of a machine in words.
fn fault(id: ParameterId) -> String {
    match id {
        ParameterId::Local(Local { slide, component, shape }) => {
            let along = Axis::ALL[component.direction()];
            if component.is_angular() {
                let name = format!("E{}{slide}", component.letter());
                return match shape {
                    LocalShape::P1 => format!("a turn {name}"),
                    LocalShape::P2 => format!("a bend of {name}"),
                    LocalShape::P3 => format!("an S of {name}"),
                    LocalShape::Sense => format!("a tip of {name} at reversals"),
                };
            }
            match (shape, along == slide) {
                (LocalShape::P1, true) => format!("the scale of {slide}"),
                (LocalShape::P1, false) => format!("a slope of {slide} in {along}"),
                (LocalShape::P2, true) => format!("a bow in the positioning of {slide}"),
                (LocalShape::P2, false) => {
                    format!("a bow in the straightness of {slide} in {along}")
                }
                (LocalShape::P3, true) => format!("an S in the positioning of {slide}"),
                (LocalShape::P3, false) => {
                    format!("an S in the straightness of {slide} in {along}")
                }
                (LocalShape::Sense, true) => format!("a reversal of {slide}"),
                (LocalShape::Sense, false) => format!("a lateral play of {slide} in {along}"),
            }
        }
        ParameterId::SetUp(of, _) => format!("the set-up error {of}"),
        ParameterId::Coefficient(of) => of.to_string(),
        ParameterId::Amplitude | ParameterId::Delay(_) => "an effect".to_owned(),
    }
}
