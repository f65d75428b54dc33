//! The table of arcs of the report.

use super::facts::{Analysis, RepeatResult};
use super::run_facts::ArcResult;
use crate::report::text::numbers::{count, fixed, signed, typeset};

/// A row of the table of arcs: the first run that drove it, and all of them.
pub(super) struct ArcRow {
    pub(super) name: String,
    pub(super) mounting: String,
    pub(super) circle: String,
    pub(super) direction: &'static str,
    pub(super) feed: String,
    pub(super) samples: String,
    pub(super) rms: Vec<String>,
    pub(super) mean: String,
    pub(super) worst: String,
    /// Over all runs, without what was found.
    pub(super) before: String,
    pub(super) transit: bool,
}

/// Arcs of the same mounting, name, direction and feed, repeat by repeat.
struct Group<'a> {
    mounting: &'a str,
    first: &'a ArcResult,
    of_repeats: Vec<Vec<&'a ArcResult>>,
}

impl Group<'_> {
    fn holds(&self, mounting: &str, arc: &ArcResult) -> bool {
        mounting == self.mounting
            && self.first.name == arc.name
            && self.first.circle == arc.circle
            && self.first.direction == arc.direction
            && (self.first.feed_mm_min - arc.feed_mm_min).abs() < 0.5
    }

    fn all(&self) -> Vec<&ArcResult> {
        self.of_repeats.iter().flatten().copied().collect()
    }
}

fn groups(repeats: &[RepeatResult]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for (index, repeat) in repeats.iter().enumerate() {
        let arcs = repeat.runs.iter().flat_map(|run| run.arcs.iter().map(move |arc| (run, arc)));
        for (run, arc) in arcs {
            let known = groups.iter().position(|group| group.holds(&run.mounting, arc));
            let place = known.unwrap_or_else(|| {
                let of_repeats = vec![Vec::new(); repeats.len()];
                groups.push(Group { mounting: &run.mounting, first: arc, of_repeats });
                groups.len() - 1
            });
            groups[place].of_repeats[index].push(arc);
        }
    }
    groups
}

/// Mean over samples.
fn weighted(value: impl Fn(&ArcResult) -> f64, arcs: &[&ArcResult]) -> f64 {
    let of: usize = arcs.iter().map(|arc| arc.samples).sum();
    arcs.iter().map(|arc| value(arc) * arc.samples as f64).sum::<f64>() / of.max(1) as f64
}

/// Root mean square, um.
fn rms(arcs: &[&ArcResult]) -> String {
    if arcs.is_empty() {
        return "–".into();
    }
    fixed(weighted(|arc| arc.rms_um.powi(2), arcs).sqrt(), 3)
}

/// Arcs of the same mounting, name, direction and feed are one row, with a column a repeat.
pub(super) fn rows(analysis: &Analysis) -> Vec<ArcRow> {
    let earlier = analysis.before.as_ref().map_or(&[][..], |before| &before.repeats);
    let earlier = groups(earlier);
    let row = |group: Group<'_>| {
        let (first, all) = (group.first, group.all());
        let before = earlier.iter().find(|before| before.holds(group.mounting, first));
        ArcRow {
            name: first.name.clone(),
            mounting: group.mounting.to_owned(),
            circle: first.circle.clone(),
            direction: first.direction,
            feed: fixed(first.feed_mm_min, 0),
            samples: count(all.iter().map(|arc| arc.samples).sum()),
            rms: group.of_repeats.iter().map(|arcs| rms(arcs)).collect(),
            before: rms(&before.map_or_else(Vec::new, Group::all)),
            mean: typeset(&signed(weighted(|arc| arc.mean_um, &all), 3)),
            worst: fixed(all.iter().map(|arc| arc.worst_um).fold(0.0, f64::max), 2),
            transit: first.transit,
        }
    };
    groups(&analysis.repeats).into_iter().map(row).collect()
}
