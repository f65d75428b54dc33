//! From a [`Diagnosis`] to what is told of it.

use std::collections::BTreeSet;

use super::facts::{DiagnosisFacts, FindingFacts};
use super::owner::OwnerFacts;
use super::settings::WrongSettingFacts;
use super::verdict::VerdictFacts;
use super::{views, words};
use crate::diagnose::{Diagnosis, Feature, Finding, Owner, Picture, Rival, Separation};
use crate::identify::Identification;
use crate::machine::Machine;
use crate::model::{Averaged, Seat};
use crate::report::text::numbers::fixed;
use crate::report::text::words::capital;

/// So many other explanations are told.
const MOST_RIVALS: usize = 12;

const UM: f64 = 1e3;

impl DiagnosisFacts {
    /// Gathers what is told; the identifications are those that were diagnosed.
    pub fn new(
        machine: &Machine,
        identifications: &[Identification],
        diagnosis: &Diagnosis,
    ) -> Self {
        let pictures = diagnosis.pictures.iter().map(Option::as_ref).chain(std::iter::repeat(None));
        let findings = diagnosis.findings.iter().zip(pictures).map(|(of, picture)| {
            finding(of, picture, diagnosis.verdict.after_mm, machine, identifications)
        });
        // What the amplitudes do not know may hide the whole move.
        let moved = diagnosis
            .moved
            .iter()
            .filter(|moved| (moved.after - moved.before).abs() > moved.sigma_after);
        let wrong_settings: Vec<WrongSettingFacts> = diagnosis
            .wrong_settings
            .iter()
            .map(|wrong| WrongSettingFacts::new(wrong, machine))
            .collect();
        Self {
            verdict: VerdictFacts::new(diagnosis, &wrong_settings, identifications),
            foretold: identifications.len() > 1,
            nothing_found: diagnosis.nothing_found(),
            of_all: diagnosis.verdict,
            findings: findings.collect(),
            runs: diagnosis.runs.clone(),
            programs: diagnosis.programs.clone(),
            moved: moved.cloned().collect(),
            views: views::told(&diagnosis.views),
            arcs: diagnosis.arcs.clone(),
            unseen: diagnosis.unseen.clone(),
            wrong_settings,
            off_times: diagnosis.off_times.clone(),
            left_out: diagnosis.left_out.clone(),
        }
    }
}

fn finding(
    of: &Finding,
    picture: Option<&Picture>,
    after_mm: f64,
    machine: &Machine,
    identifications: &[Identification],
) -> FindingFacts {
    let feature = Feature::of(&of.element, &of.amplitudes);
    let cause = of.element.shape().map(|shape| shape.cause);
    let on = seat(of);
    FindingFacts {
        title: title(of, on),
        cause: cause.map(|cause| cause.id),
        on: on.map_or_else(String::new, |on| on.to_string()),
        named: of.named(),
        owner: OwnerFacts::new(of.owner(), identifications),
        effects: of.effects.clone(),
        in_words: match &feature {
            Some(feature) => described(of, feature),
            None => words::numbers(&of.numbers),
        },
        remarks: remarks(of, machine, identifications),
        numbers: of.numbers.clone(),
        rms_mm: of.rms_mm,
        without_mm: after_mm.hypot(of.rms_mm),
        equation: cause.map_or("", |cause| cause.equation),
        source: cause.map_or("", |cause| cause.source),
        remedy: cause.map_or("", |cause| cause.remedy),
        taken_for: cause.map_or("", |cause| cause.taken_for),
        rivals: rivals(&of.rivals),
        picture: picture.cloned(),
        feature,
    }
}

/// `Cyclic error of a screw, EXX (positioning of X)`.
fn title(of: &Finding, on: Option<Seat>) -> String {
    if of.element.is_common_delay() {
        return "Following error that all axes share".into();
    }
    let what = of.element.shape().map_or("unexplained", |shape| shape.cause.title);
    match on.map(words::seat) {
        Some(on) if !on.is_empty() => format!("{}, {on}", capital(what)),
        _ => capital(what),
    }
}

/// What follows from the numbers of a finding, in sentences.
fn remarks(of: &Finding, machine: &Machine, identifications: &[Identification]) -> Vec<String> {
    let of_numbers = of.effects.first().map(|effect| words::remarks(effect, &of.numbers, machine));
    of_numbers
        .into_iter()
        .flatten()
        .chain(in_the_log(of, identifications))
        .chain(aliases(of, identifications))
        .chain(in_means(of, identifications))
        .collect()
}

/// What a finding acts on.
fn seat(of: &Finding) -> Option<Seat> {
    of.element.shape().map(|shape| shape.seat).or_else(|| of.element.curve().map(|c| c.seat))
}

/// What else a vibration may be.
fn aliases(of: &Finding, identifications: &[Identification]) -> Option<String> {
    let effect = of.effects.first().filter(|effect| effect.cause.id == "vibration")?;
    let runs = identifications.iter().flat_map(|identification| &identification.runs);
    let windows: Vec<Averaged> = runs.map(|run| run.alignment.window()).collect();
    words::aliases(effect.get("frequency"), &windows)
}

/// How much of a vibration is in what a fast log counts as.
fn in_means(of: &Finding, identifications: &[Identification]) -> Option<String> {
    let effect = of.effects.first().filter(|effect| effect.cause.id == "vibration")?;
    let runs = identifications.iter().flat_map(|identification| &identification.runs);
    let held = runs.map(|run| {
        let window = run.alignment.window();
        (window.share_of_wave(effect.get("frequency") * window.lasts_s()).abs(), window.lasts_s())
    });
    let (share, lasts_s) = held.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let percent = fixed(100.0 * share, 0);
    (percent != "100").then(|| {
        format!(
            "Readings count as means over {} ms, which hold {percent} % of it: so much of it is in the residual and in the deviations of the circles.",
            fixed(1e3 * lasts_s, 0)
        )
    })
}

/// The moment of a knock on the clock of its log, whenever the program began.
fn in_the_log(of: &Finding, identifications: &[Identification]) -> Option<String> {
    let Owner::One { repeat, run } = of.owner() else { return None };
    let moment_s = of.effects.first()?.get("moment");
    let run = identifications.get(repeat)?.runs.get(run)?;
    let log_s = run.alignment.began_log_s + moment_s;
    log_s.is_finite().then(|| format!("In the log of {}: at {} s.", run.name, fixed(log_s, 1)))
}

/// `near x = 42 mm` of a curve that nothing explains.
fn described(of: &Finding, feature: &Feature) -> String {
    let places = usize::from(feature.width < 5.0);
    format!(
        "{} um rms along the {}{}; largest near {} {}, {} {} there, {} {} wide at half height",
        fixed(of.rms_mm * UM, 3),
        feature.variable,
        if of.element.curve().is_some_and(|curve| curve.with_sense) {
            ", by direction"
        } else {
            ""
        },
        fixed(feature.at, places),
        feature.variable_unit,
        fixed(feature.height, 2),
        feature.unit,
        fixed(feature.width, places),
        feature.variable_unit
    )
}

/// What cannot be told apart first, and of each name once.
fn rivals(of: &[Rival]) -> Vec<Rival> {
    let order = |rival: &Rival| match rival.separation {
        Separation::Same => 0,
        Separation::Undecided => 1,
        Separation::Apart => 2,
    };
    let mut sorted: Vec<&Rival> = of.iter().collect();
    sorted.sort_by(|a, b| order(a).cmp(&order(b)).then(b.share.total_cmp(&a.share)));
    let mut names = BTreeSet::new();
    sorted.retain(|rival| names.insert(rival.name()));
    sorted.into_iter().take(MOST_RIVALS).cloned().collect()
}
