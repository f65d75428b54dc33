//! From a [`Diagnosis`] to what is told of it.

use std::collections::BTreeSet;

use super::facts::{
    DiagnosisFacts, FeatureFacts, FindingFacts, LeftOutFacts, MovedFacts, NumberFacts,
    OffTimeFacts, ProgramGainFacts, RivalFacts, RunGainFacts, StructureFacts, WrongSettingFacts,
};
use super::{verdict, views, words};
use crate::diagnose::{Diagnosis, Feature, Finding, Owner, Picture, Rival, Structure, Told};
use crate::identify::Identification;
use crate::machine::Machine;
use crate::model::{Kind, Seat};
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
        let said = &diagnosis.verdict;
        let mut facts = Self {
            verdict: Vec::new(),
            nothing_found: diagnosis.nothing_found(),
            before_um: said.before_mm * UM,
            after_um: said.after_mm * UM,
            structure_before: said.structure_before.map(structure),
            structure_after: said.structure_after.map(structure),
            neighbours_um: said.neighbours_mm * UM,
            effective_samples: said.effective_samples,
            samples: diagnosis.samples,
            explained: said.explained,
            explained_interval: said.explained_interval,
            smallest_um: said.smallest_mm * UM,
            findings: diagnosis
                .findings
                .iter()
                .enumerate()
                .map(|(k, f)| {
                    let picture = diagnosis.pictures.get(k).and_then(Option::as_ref);
                    finding(f, picture, said.after_mm, machine, identifications)
                })
                .collect(),
            runs: diagnosis
                .runs
                .iter()
                .map(|run| RunGainFacts {
                    run: run.run.clone(),
                    samples: run.samples,
                    before_um: run.before_mm * UM,
                    after_um: run.after_mm * UM,
                    floor_um: run.floor_mm * UM,
                    explained: run.explained,
                })
                .collect(),
            programs: diagnosis
                .programs
                .iter()
                .map(|program| ProgramGainFacts {
                    runs: program.runs.clone(),
                    feed_mm_min: program.feed_mm_min,
                    before_um: program.before_mm * UM,
                    after_um: program.after_mm * UM,
                })
                .collect(),
            moved: diagnosis
                .moved
                .iter()
                // What the amplitudes do not know may hide the whole move.
                .filter(|moved| (moved.after - moved.before).abs() > moved.sigma_after)
                .map(|moved| MovedFacts {
                    name: moved.name.clone(),
                    unit: moved.unit,
                    before: moved.before,
                    after: moved.after,
                    sigma_before: moved.sigma_before,
                    sigma_after: moved.sigma_after,
                })
                .collect(),
            views: views::of(&diagnosis.views),
            arcs: views::arcs(&diagnosis.arcs),
            unseen: diagnosis
                .unseen
                .iter()
                .cloned()
                .chain(unseen(diagnosis, identifications))
                .collect(),
            wrong_settings: diagnosis
                .wrong_settings
                .iter()
                .map(|wrong| WrongSettingFacts {
                    cause: wrong.effect.cause.id,
                    effect: wrong.effect.to_string(),
                    on: wrong.effect.seat.to_string(),
                    told: words::setting(wrong, machine),
                    before_um: wrong.before_mm * UM,
                    after_um: wrong.after_mm * UM,
                })
                .collect(),
            off_times: diagnosis
                .off_times
                .iter()
                .map(|off| OffTimeFacts {
                    run: off.run.clone(),
                    stated_percent: off.stated_percent,
                    percent: off.percent,
                    sigma_percent: off.sigma_percent,
                    clock_ppm: off.clock_ppm,
                    cause: if off.is_feed() { "feed-override" } else { "clock" },
                })
                .collect(),
            left_out: diagnosis
                .left_out
                .iter()
                .map(|out| LeftOutFacts {
                    run: out.runs.clone(),
                    reason: out.reason.clone(),
                    hint: out.hint.clone(),
                })
                .collect(),
        };
        facts.verdict = verdict::of(&facts);
        facts
    }
}

fn structure(of: Structure) -> StructureFacts {
    StructureFacts {
        rms_um: of.rms_mm() * UM,
        variance_um2: of.variance_mm2 * UM * UM,
        sigma_um2: of.sigma_mm2 * UM * UM,
    }
}

fn finding(
    of: &Finding,
    picture: Option<&Picture>,
    after_mm: f64,
    machine: &Machine,
    identifications: &[Identification],
) -> FindingFacts {
    let numbers: Vec<NumberFacts> = of
        .numbers
        .iter()
        .map(|n| NumberFacts { name: n.name.clone(), value: n.value, sigma: n.sigma })
        .collect();
    let feature =
        Feature::of(&of.element, &of.amplitudes).map(|feature| feature_facts(of, feature));
    let shape = of.element.shape();
    let cause = shape.map(|shape| shape.cause);
    let on = seat(of);
    let in_words = on.map_or_else(String::new, words::seat);
    let what = cause.map_or_else(|| "unexplained".into(), |cause| cause.title.to_owned());
    let title = [capital(&what), in_words];
    let title = title.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
    let told = match &feature {
        Some(feature) => described(of, feature),
        None => words::numbers(&numbers),
    };
    FindingFacts {
        title,
        cause: cause.map(|cause| cause.id),
        on: on.map_or_else(String::new, |on| on.to_string()),
        named: of.named(),
        owner: owner(of.owner(), identifications),
        effects: of.effects.iter().map(ToString::to_string).collect(),
        told,
        remarks: of
            .effects
            .first()
            .map_or_else(Vec::new, |effect| words::remarks(effect, &numbers, machine))
            .into_iter()
            .chain(in_the_log(of, identifications))
            .chain(aliases(of, identifications))
            .collect(),
        numbers,
        rms_um: of.rms_mm * UM,
        without_um: after_mm.hypot(of.rms_mm) * UM,
        equation: cause.map_or("", |cause| cause.equation),
        source: cause.map_or("", |cause| cause.source),
        remedy: cause.map_or("", |cause| cause.remedy),
        taken_for: cause.map_or("", |cause| cause.taken_for),
        rivals: rivals(&of.rivals),
        picture: picture.map(|picture| views::picture(picture, feature.as_ref())),
        feature,
    }
}

/// What a finding acts on.
fn seat(of: &Finding) -> Option<Seat> {
    of.element.shape().map(|shape| shape.seat).or_else(|| of.element.curve().map(|c| c.seat))
}

fn owner(of: Owner, identifications: &[Identification]) -> String {
    match of {
        Owner::All => "all runs".into(),
        Owner::EachRun => "every run, each with its own".into(),
        Owner::One { repeat, run } => identifications
            .get(repeat)
            .and_then(|identification| identification.runs.get(run))
            .map_or_else(|| "one run".into(), |run| format!("{} only", run.name)),
    }
}

/// What else a vibration may be.
fn aliases(of: &Finding, identifications: &[Identification]) -> Option<String> {
    let effect = of.effects.first().filter(|effect| effect.cause.kind == Kind::Vibration)?;
    let runs = identifications.iter().flat_map(|identification| &identification.runs);
    let rates: Vec<f64> = runs.map(|run| run.alignment.sample_period_s.recip()).collect();
    words::aliases(effect.get("frequency_hz"), &rates)
}

/// The moment of a knock on the clock of its log, whenever the program began.
fn in_the_log(of: &Finding, identifications: &[Identification]) -> Option<String> {
    let Owner::One { repeat, run } = of.owner() else { return None };
    let moment_s = of.effects.first()?.get("moment_s");
    let run = identifications.get(repeat)?.runs.get(run)?;
    let log_s = run.alignment.began_log_s + moment_s / (1.0 + run.alignment.time_map.rate);
    log_s.is_finite().then(|| format!("In the log of {}: at {} s.", run.name, fixed(log_s, 1)))
}

/// `near x = 42 mm` of a curve that nothing explains.
fn described(of: &Finding, feature: &FeatureFacts) -> String {
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

fn feature_facts(of: &Finding, feature: Feature) -> FeatureFacts {
    let curve = of.element.curve();
    let angular = curve.is_some_and(
        |curve| matches!(curve.seat, Seat::Function(_, component) if component.is_angular()),
    );
    let (unit, factor) = if angular { ("urad", 1e6) } else { ("um", UM) };
    FeatureFacts {
        variable: curve.map_or_else(String::new, |curve| curve.variable.to_string()),
        variable_unit: curve.map_or("", |curve| curve.variable.unit()),
        unit,
        at: feature.at,
        height: feature.height * factor,
        width: feature.width,
        knots: feature.knots,
        values: feature.values.iter().map(|value| value * factor).collect(),
    }
}

/// What cannot be told apart first, and of each name once.
fn rivals(of: &[Rival]) -> Vec<RivalFacts> {
    let order = |rival: &Rival| match rival.told {
        Told::Same => 0,
        Told::Undecided => 1,
        Told::Apart => 2,
    };
    let mut sorted: Vec<&Rival> = of.iter().collect();
    sorted.sort_by(|a, b| order(a).cmp(&order(b)).then(b.share.total_cmp(&a.share)));
    let mut names = BTreeSet::new();
    sorted
        .into_iter()
        .filter_map(|rival| {
            let name = rival.element.shape()?.name();
            names.insert(name.clone()).then_some(RivalFacts {
                name,
                share: rival.share,
                told: match rival.told {
                    Told::Same => "same",
                    Told::Undecided => "undecided",
                    Told::Apart => "apart",
                },
            })
        })
        .take(MOST_RIVALS)
        .collect()
}

/// What the number of runs, feeds and mountings alone hides.
fn unseen(diagnosis: &Diagnosis, identifications: &[Identification]) -> Vec<String> {
    let mut told = Vec::new();
    if identifications.len() == 1 {
        told.push(
            "One repeat only: an effect of this repeat cannot be told from one of every repeat, and the gain is that of the fit itself, not on a run that took no part.".to_owned(),
        );
    }
    if diagnosis.verdict.structure_before.is_none() {
        told.push(
            "No program ran twice: structure cannot be told from slow noise, and the floor is what the fit leaves.".to_owned(),
        );
    }
    let feeds: BTreeSet<i64> = identifications
        .iter()
        .flat_map(|identification| &identification.runs)
        .flat_map(|run| &run.alignment.sections)
        .filter(|section| !section.transit)
        .map(|section| section.feed_mm_s.round() as i64)
        .collect();
    if feeds.len() == 1 {
        told.push(
            "All arcs have one feed: what hangs on time or speed (following error, reversal spikes, vibration) is told from what hangs on place by its shape alone; a second feed would tell them apart."
                .to_owned(),
        );
    }
    let mountings: BTreeSet<usize> = identifications
        .iter()
        .flat_map(|identification| &identification.runs)
        .map(|run| run.mounting)
        .collect();
    if mountings.len() == 1 {
        told.push(
            "One mounting only: an angular error of a slide and a straightness or positioning error that it causes at the balls are told apart by the levers within the sphere alone; another tool length or place would."
                .to_owned(),
        );
    }
    told
}
