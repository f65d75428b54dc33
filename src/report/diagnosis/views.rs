//! Which of the many views are drawn, and views, pictures and arcs as plain numbers.

use super::facts::{ArcFacts, BinFacts, FeatureFacts, PictureFacts, PointFacts, ViewFacts};
use crate::diagnose::{ArcShare, Kind, Picture, View};
use crate::model::place;

/// So many views are drawn.
const DRAWN: usize = 8;
/// Of the views of one kind, such as the circles, so many.
const OF_A_KIND: usize = 2;

const UM: f64 = 1e3;

/// All views in their order; bins for those that are drawn: of each variable the one that holds most.
pub(super) fn of(views: &[View]) -> Vec<ViewFacts> {
    let mut drawn: Vec<&str> = Vec::new();
    views
        .iter()
        .map(|view| {
            let kind = |variable: &str| variable.split(" of ").next().unwrap_or("").to_owned();
            let kind = |variable: &str| {
                if variable.starts_with("angle on") { "angle on".into() } else { kind(variable) }
            };
            let own = kind(&view.variable);
            let alike = drawn.iter().filter(|variable| kind(variable) == own).count();
            let draw = drawn.len() < DRAWN
                && alike < OF_A_KIND
                && !drawn.contains(&view.variable.as_str())
                && view.bins.len() > 3;
            if draw {
                drawn.push(&view.variable);
            }
            ViewFacts {
                variable: view.variable.clone(),
                counted: view.counted.clone(),
                unit: view.unit,
                kind: match view.kind {
                    Kind::Means => "means",
                    Kind::Spectrum => "spectrum",
                },
                share_before: view.share_before,
                share_after: view.share_after,
                bins: if draw { bins(view) } else { Vec::new() },
            }
        })
        .collect()
}

fn bins(view: &View) -> Vec<BinFacts> {
    let each = view.bins.iter().map(|bin| BinFacts {
        center: bin.center,
        before_um: bin.before_mm * UM,
        after_um: bin.after_mm * UM,
        sigma_um: bin.sigma_mm * UM,
        count: bin.count,
    });
    each.collect()
}

/// A picture; of a curve without a cause without what the model spans anyway.
pub(super) fn picture(of: &Picture, feature: Option<&FeatureFacts>) -> PictureFacts {
    let (unit, factor) = if of.angular { ("urad", 1e6) } else { ("um", UM) };
    let points = of.points.iter().map(|point| {
        let fitted = match feature {
            Some(feature) => {
                let (first, share) = place(&feature.knots, point.at);
                (1.0 - share) * feature.values[first] + share * feature.values[first + 1]
            }
            None => point.fitted * factor,
        };
        PointFacts {
            at: point.at,
            measured: (point.measured - point.fitted) * factor + fitted,
            fitted,
            sigma: point.sigma * factor,
        }
    });
    PictureFacts {
        variable: of.variable.clone(),
        variable_unit: of.unit,
        unit,
        points: points.collect(),
    }
}

/// The arcs.
pub(super) fn arcs(of: &[ArcShare]) -> Vec<ArcFacts> {
    let each = of.iter().map(|arc| ArcFacts {
        name: arc.name.clone(),
        feed_mm_min: arc.feed_mm_min,
        run_count: arc.runs,
        samples: arc.samples,
        before_um: arc.before_mm * UM,
        after_um: arc.after_mm * UM,
        structure_share_before: arc.structure_before,
        structure_share_after: arc.structure_after,
    });
    each.collect()
}
