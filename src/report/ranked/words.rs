//! What features are called, and what their signs mean.

use super::remedies;
use crate::features::{Feature, Kind};
use crate::identify::Asked;
use crate::machine::Axis;
use crate::report::diagnosis::facts::FindingFacts;
use crate::report::text::numbers::{decimals, fixed};

/// A curve whose middle lies by this part of its range beside its ends is a bow.
const BOW: f64 = 0.6;

/// Such as `squareness XY`, `backlash X`, `cyclic EXX`.
pub(super) fn name(of: &Feature, findings: &[FindingFacts]) -> String {
    match of.kind {
        Kind::Squareness(a, b) => format!("squareness {a}{b}"),
        Kind::ScaleMismatch(a, b) => format!("scale mismatch {a}{b}"),
        Kind::Backlash(axis) => format!("backlash {axis}"),
        Kind::LateralPlay(axis, along) => format!("lateral play {axis} in {along}"),
        Kind::Straightness(axis, along) => format!("straightness {axis} in {along}"),
        Kind::Positioning(axis) => format!("positioning {axis}"),
        Kind::Angle(axis, about) => Asked::Angle(axis, about).name(),
        Kind::AngularReversal(axis, about) => Asked::AngularReversal(axis, about).name(),
        Kind::ServoMismatch(a, b) => format!("servo mismatch {a}{b}"),
        Kind::Found(k) => findings.get(k).map_or_else(String::new, |finding| {
            // A delay that all axes share has no seat.
            if finding.cause == Some("servo") && finding.on.is_empty() {
                return "following error".to_owned();
            }
            let cause = finding.cause.unwrap_or("unexplained").replace('-', " ");
            format!("{cause} {}", finding.on).trim().to_owned()
        }),
    }
}

/// What its sign means; empty where it has none.
pub(super) fn sign(of: &Feature, findings: &[FindingFacts]) -> String {
    let positive = of.value > 0.0;
    let towards =
        |axis: Axis, positive: bool| format!("{}{axis}", if positive { '+' } else { '-' });
    match of.kind {
        Kind::Squareness(a, b) if positive => format!("+{b} leans towards +{a}"),
        Kind::Squareness(a, b) => format!("+{b} leans away from +{a}"),
        Kind::ScaleMismatch(a, b) => {
            let [far, short] = if positive { [a, b] } else { [b, a] };
            format!("{far} goes farther than {short}")
        }
        Kind::Backlash(_) if positive => "lost motion".into(),
        Kind::Backlash(_) => "over-compensated".into(),
        Kind::LateralPlay(axis, along) => {
            format!("towards {} going +{axis}", towards(along, positive))
        }
        Kind::Straightness(_, along) => bow(of, along),
        Kind::Positioning(axis) => bow(of, axis),
        Kind::Angle(..) | Kind::AngularReversal(..) => String::new(),
        Kind::ServoMismatch(a, b) => {
            let [late, early] = if positive { [a, b] } else { [b, a] };
            format!("{late} follows later than {early}")
        }
        Kind::Found(k) => findings.get(k).map_or_else(String::new, |finding| {
            let way = match finding.cause {
                Some("reversal-spike") if positive => Some("lags".to_owned()),
                Some("reversal-spike") => Some("overshoots".to_owned()),
                _ => None,
            };
            let inner = finding.numbers.get(1).map(|number| {
                let places = decimals(number.value, 3);
                let value = fixed(number.value, places);
                format!("{} {value} {}", number.what, number.unit).trim().to_owned()
            });
            way.into_iter().chain(inner).collect::<Vec<_>>().join(", ")
        }),
    }
}

/// What is done about it: what the table of causes says of what was found.
pub(super) fn what_to_do(of: &Feature, findings: &[FindingFacts]) -> &'static str {
    match of.kind {
        Kind::Found(k) => findings.get(k).map_or("", |finding| finding.remedy),
        _ => remedies::of(&name(of, findings), of.value > 0.0).unwrap_or(""),
    }
}

fn bow(of: &Feature, along: Axis) -> String {
    match of.sag_mm {
        Some(sag_mm) if sag_mm.abs() * 1e3 > BOW * of.value.abs() => {
            format!("middle towards {}{along}", if sag_mm > 0.0 { '+' } else { '-' })
        }
        _ => "an S".into(),
    }
}

/// Features of a plane that Ballbar 20 has and that no finding tells of, nor, of spikes, a caution about axes that are `far_off` where
/// they turn.
pub(super) fn not_found(
    of: &[Feature],
    findings: &[FindingFacts],
    far_off: &[Axis],
) -> Vec<String> {
    let axes = of.iter().find_map(|feature| match feature.kind {
        Kind::ServoMismatch(a, b) => Some([a, b]),
        _ => None,
    });
    let is = |cause: &str, axis: Axis| {
        findings.iter().any(|of| of.cause == Some(cause) && of.on.ends_with(axis.letter()))
            || cause == "reversal-spike" && far_off.contains(&axis)
    };
    let [spikes, cyclic] = [("reversal-spike", "reversal spikes"), ("cyclic", "a cyclic error")]
        .map(|(cause, words)| {
            let without = axes.into_iter().flatten().filter(move |axis| !is(cause, *axis));
            without.map(move |axis| format!("{words} of {axis}"))
        });
    spikes.chain(cyclic).collect()
}
