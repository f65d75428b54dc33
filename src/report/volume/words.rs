//! A map in words.

use super::Mapped;
use crate::compensate::{Figure, Figures};
use crate::report::analysis::place::decimals;
use crate::report::text::numbers::{count, fixed};

/// What the figures are of.
pub(super) const BASIS: &str = "Displacement of the tool against the workpiece, actual less commanded, in the programmed directions, of a machine that stands still or creeps, \
both senses of every slide. `noise`: what repeats would scatter; `all`: noise and what this test cannot tell from other plausible faults; both are one standard deviation.";

/// A figure with both uncertainties, um.
pub(super) fn told(of: &Figure) -> String {
    let [value, noise, all] = cells(of);
    format!("{value} um (noise {noise}, all {all})")
}

/// Value, noise and all, um, as many decimals as the uncertainty has meaning.
pub(super) fn cells(of: &Figure) -> [String; 3] {
    let um = [of.value_mm, of.sigmas.noise, of.sigmas.all].map(|mm| mm * 1e3);
    [fixed(um[0], decimals(um[2])), fixed(um[1], decimals(um[1])), fixed(um[2], decimals(um[2]))]
}

/// The verdict in sentences.
pub(super) fn verdict(of: &Mapped) -> Vec<String> {
    let map = &of.map;
    let mut sentences = Vec::new();
    let all = |figures: &Figures| {
        format!(
            "{} at the most, {} for 95 % of the poses, {} rms",
            told(&figures.largest),
            told(&figures.most),
            told(&figures.rms)
        )
    };
    match &map.near {
        Some(near) => {
            let place = <[f64; 3]>::from(near.largest_at_mm).map(|mm| fixed(mm, 1)).join(", ");
            sentences.push(format!(
                "Where something was measured near, the tool is off by {}. The largest is at X, Y, Z {place} mm.",
                all(near)
            ));
            if near.unknown.all > near.rms.value_mm {
                let um = near.unknown.all * 1e3;
                let um = fixed(um, decimals(um));
                sentences.push(format!(
                    "More is unknown than known here: of the vector {um} um rms are not told from other plausible faults. Test in more places before anything is compensated by this."
                ));
            }
        }
        None => {
            sentences
                .push("Nothing was measured near this volume: what follows is a guess.".into());
        }
    }
    if let Some(whole) = &map.whole {
        let far = map.nodes.iter().filter(|node| !node.near).count();
        sentences.push(format!(
            "Over the whole volume it would be {}; {} of its {} points lie farther from what was measured than a tenth of the bar, and nobody has looked there.",
            all(whole),
            count(far),
            count(map.nodes.len())
        ));
    }
    sentences.push(if map.volume.keep_rigid {
        "Counted from the middle of the test; a rigid motion of the workpiece is left in.".into()
    } else {
        "Without the rigid motion of the workpiece that fits best: that is its set-up.".into()
    });
    if let Some(compensation) = &of.compensation {
        sentences.push(format!(
            "Active when it was measured: {compensation}. This is what is left beside that."
        ));
    }
    sentences
}

/// What of a line was measured near, in words.
pub(super) fn near(of: &crate::compensate::Line) -> String {
    let near = of.points.iter().filter(|point| point.near).count();
    match (near, of.points.len()) {
        (0, _) => "not near".into(),
        (near, all) if near == all => "near".into(),
        (near, all) => format!("near {near} of {all}"),
    }
}
