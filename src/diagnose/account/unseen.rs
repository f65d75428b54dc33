//! What these runs cannot see, whatever is there.

use std::collections::BTreeSet;

use crate::identify::Campaign;
use crate::model::{CAUSES, Cause, Inner, Key, Seat, Shape, Start};
use crate::residual::{Beside, Element, System};

/// An effect of which less than this part of its square is left outside of the model is not seen: of 10 um less than 0.2 um, as
/// large as the noise. What is many times larger may be found all the same.
const SEEN: f64 = 4e-4;
/// Names in one sentence; more are counted.
const MOST_NAMES: usize = 12;

/// Sentences about what these runs cannot see; `ran_twice` says whether any program did, `found` whether any effect was
/// found.
pub(crate) fn unseen(
    alone: &Beside,
    campaign: &Campaign,
    ran_twice: bool,
    found: bool,
) -> Vec<String> {
    [by_the_fit(alone, campaign), by_the_runs_alone(campaign, ran_twice, found)].concat()
}

/// Causes of which the fit of the model leaves nothing.
fn by_the_fit(alone: &Beside, campaign: &Campaign) -> Vec<String> {
    let seen = |cause: &'static Cause, seat: Seat| {
        let middle = |(inner, _): (&Inner, &Key)| {
            let axis = seat.axis().filter(|_| inner.start == Start::Middle)?;
            Some(alone.residuals.middle_mm[axis.index()])
        };
        let shape = Shape { cause, seat, inner: cause.inner(seat).and_then(middle) };
        System::of(alone, &Element::shared(shape)).share_outside() > SEEN
    };
    let mut sentences = Vec::new();
    for cause in CAUSES.iter().filter(|cause| !cause.unseen.is_empty()) {
        let hidden: Vec<String> = cause
            .seats()
            .into_iter()
            .filter(|seat| !matches!(seat, Seat::Coefficient(of) if campaign.estimates(&of.to_string())))
            .filter(|seat| !seen(cause, *seat))
            .map(|seat| seat.to_string())
            .collect();
        if !hidden.is_empty() {
            sentences.push(cause.unseen.replace("{}", &named(&hidden)));
        }
    }
    sentences.push(
        "A radius that shrinks with the square of the feed is a scale of all axes in each run; compare the scales of runs at two feeds."
            .to_owned(),
    );
    let runs = campaign.repeats.iter().flat_map(|repeat| &repeat.runs);
    if runs.map(|run| run.mounting).all(|mounting| mounting == 0) {
        sentences.push(
            "A wrong position of the balls in the test file or a wrong pivot in the machine file changes coefficients, and in one mounting leaves next to nothing in the residuals."
                .to_owned(),
        );
    }
    sentences
}

/// What the number of runs, feeds and mountings alone hides.
fn by_the_runs_alone(campaign: &Campaign, ran_twice: bool, found: bool) -> Vec<String> {
    let mut sentences = Vec::new();
    if campaign.repeats.len() == 1 {
        sentences.push(
            "Only one repeat: an effect of this repeat alone cannot be distinguished from a lasting one. The gain is that of the fit itself, not of a run that was not fitted.".to_owned(),
        );
    }
    if !ran_twice {
        sentences.push(
            "No program ran twice: the repeatable part of the residual cannot be distinguished from slow noise."
                .to_owned()
                + if found { "" } else { " The part that is not repeatable is taken from the fit." },
        );
    }
    let feeds: BTreeSet<i64> = campaign
        .repeats
        .iter()
        .flat_map(|identification| &identification.runs)
        .flat_map(|run| &run.alignment.sections)
        .filter(|section| !section.transit)
        .map(|section| section.feed_mm_s.round() as i64)
        .collect();
    if feeds.len() == 1 {
        sentences.push(
            "All arcs have one feed: effects of time or speed (following error, reversal spikes, vibration) differ from effects of position by their shape only. A second feed would separate them."
                .to_owned(),
        );
    }
    let mountings: BTreeSet<usize> = campaign
        .repeats
        .iter()
        .flat_map(|identification| &identification.runs)
        .map(|run| run.mounting)
        .collect();
    if mountings.len() == 1 {
        sentences.push(
            "Only one mounting: an angular error of an axis differs from the straightness or positioning error that it causes at the balls by the levers within the sphere only. Another tool length or place would separate them."
                .to_owned(),
        );
    }
    sentences
}

/// The first names, and how many more there are.
fn named(names: &[String]) -> String {
    let first = names.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => first,
        further => format!("{first} and {further} more"),
    }
}
