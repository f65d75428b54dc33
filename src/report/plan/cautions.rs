//! What a reader should know before he runs a test.

use super::facts::TestOutlook;
use super::words::vector;
use crate::report::analysis::cautions::DETERMINED;
use crate::report::text::numbers::{fixed, many};
use crate::report::text::words::list;

/// Bodies that pass nearer than this deserve a look before the program runs, mm.
const NEAR_MM: f64 = 10.0;

/// The cautions of a test, the gravest first.
pub(super) fn of(test: &TestOutlook, minimum_norm: bool) -> Vec<String> {
    let mut all = clearance(test);
    all.extend(confounded(test, minimum_norm));
    let sight = &test.sight;
    if sight.rank < sight.ideal_rank {
        all.push(format!(
            "The noise hides {} of the {} directions that ideal arcs would show. Less noise, more samples or other terms would help.",
            sight.ideal_rank - sight.rank,
            sight.ideal_rank
        ));
    }
    if sight.rank > sight.ideal_rank {
        all.push(format!(
            "The path shows {} more than ideal arcs do, by the direction of motion that an axis keeps from its last motion while it stands still.",
            many(sight.rank - sight.ideal_rank, "direction")
        ));
    }
    all
}

fn clearance(test: &TestOutlook) -> Vec<String> {
    let named = |at: &super::facts::MountingOutlook| {
        let least = at.clearance.as_ref()?;
        let where_ =
            format!("on {} at the ball vector {} mm", least.section, vector(&least.ball_mm));
        if least.clearance_mm <= 0.0 {
            return Some(format!(
                "COLLISION: mounting {}: {} and support touch {where_}. Do not run {}.",
                at.name, least.part, at.program
            ));
        }
        (least.clearance_mm < NEAR_MM).then(|| {
            format!(
                "WARNING: mounting {}: only {} mm between {} and support {where_}.",
                at.name,
                fixed(least.clearance_mm, 1),
                least.part
            )
        })
    };
    let mut told: Vec<String> = test.mountings.iter().filter_map(named).collect();
    told.sort_by_key(|line| line.starts_with("WARNING"));
    if test.mountings.iter().any(|mounting| mounting.clearance.is_none()) {
        told.push(
            "The machine file names no `[clearance.support]`, or nothing that could touch it: collisions were not checked.".into(),
        );
    }
    told
}

fn confounded(test: &TestOutlook, minimum_norm: bool) -> Option<String> {
    let sight = &test.sight;
    if sight.rank == sight.parameter_count {
        return None;
    }
    let weak = test.parameters.iter().filter(|parameter| parameter.observed < DETERMINED);
    let what = if minimum_norm {
        "`analyse` will give the smallest of many solutions"
    } else {
        "`analyse` will refuse them"
    };
    Some(format!(
        "{} of {} directions of the named terms are not observable, among {}: {what}. With `terms = [\"complete\"]` the test chooses what it can distinguish.",
        sight.parameter_count - sight.rank,
        sight.parameter_count,
        list(weak.map(|parameter| parameter.name.as_str()))
    ))
}
