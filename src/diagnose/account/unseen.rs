//! What these runs cannot see, whatever is there.

use crate::diagnose::thresholds::SEEN;
use crate::identify::Campaign;
use crate::machine::Axis;
use crate::model::{Coefficient, Component, Kind, Seat, Shape};
use crate::residual::{Beside, Element, System};

/// Names in one sentence; more are counted.
const MOST_NAMES: usize = 12;

/// Sentences about causes of which the fit of the model leaves nothing.
pub(crate) fn unseen(alone: &Beside, campaign: &Campaign) -> Vec<String> {
    let seen = |kind: Kind, seat: Seat, inner: Option<f64>| {
        let shape = Shape { cause: kind.cause(), seat, inner };
        System::of(alone, &Element::shared(shape)).share_outside() > SEEN
    };
    let mut sentences = Vec::new();
    if !seen(Kind::BarLength, Seat::Whole, None) {
        sentences.push(
            "A wrong length of the bar is the same as a scale of all slides: a second bar length would tell them apart."
                .to_owned(),
        );
    }
    let hidden: Vec<String> = Axis::ALL
        .into_iter()
        .flat_map(|slide| Component::ALL.into_iter().map(move |c| Seat::Function(slide, c)))
        .filter(|seat| !seen(Kind::GrowingBacklash, *seat, None))
        .map(|seat| seat.to_string())
        .collect();
    if !hidden.is_empty() {
        sentences.push(format!(
            "Backlash that grows along the slide leaves nothing in the residuals for {}.",
            hidden.join(", ")
        ));
    }
    let without: Vec<String> = Coefficient::all()
        .filter(|c| !campaign.estimates(&c.to_string()))
        .filter(|c| !seen(Kind::Coefficient, Seat::Coefficient(*c), None))
        .map(|c| c.to_string())
        .collect();
    if !without.is_empty() {
        let named = without.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
        let further = without.len().saturating_sub(MOST_NAMES);
        let further = if further > 0 { format!(" and {further} more") } else { String::new() };
        sentences.push(format!(
            "{named}{further} are beside the chosen terms and like them in these runs: further mountings would tell (`ballbar plan`)."
        ));
    }
    sentences.push(
        "A radius that shrinks with the square of the feed is a scale of all slides in each run; compare EXX1, EYY1 and EZZ1 of runs at two feeds."
            .to_owned(),
    );
    let runs = campaign.repeats.iter().flat_map(|repeat| &repeat.runs);
    if runs.map(|run| run.mounting).all(|mounting| mounting == 0) {
        sentences.push(
            "A wrong place of the balls in the test file, or a wrong pivot in the machine file, moves coefficients and leaves next to no residual in one mounting."
                .to_owned(),
        );
    }
    sentences
}
