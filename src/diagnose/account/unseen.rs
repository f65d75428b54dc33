//! What these runs cannot see, whatever is there.

use crate::diagnose::thresholds::SEEN;
use crate::identify::Campaign;
use crate::model::{CAUSES, Cause, Seat, Shape};
use crate::residual::{Beside, Element, System};

/// Names in one sentence; more are counted.
const MOST_NAMES: usize = 12;

/// Sentences about causes of which the fit of the model leaves nothing.
pub(crate) fn unseen(alone: &Beside, campaign: &Campaign) -> Vec<String> {
    let seen = |cause: &'static Cause, seat: Seat| {
        let shape = Shape { cause, seat, inner: None };
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
        "A radius that shrinks with the square of the feed is a scale of all axes in each run; compare EXX1, EYY1 and EZZ1 of runs at two feeds."
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

/// The first names, and how many more there are.
fn named(names: &[String]) -> String {
    let first = names.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => first,
        further => format!("{first} and {further} more"),
    }
}
