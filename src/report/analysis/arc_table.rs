//! The table of arcs of the report.

use super::facts::{Analysis, ArcResult};
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
    pub(super) transit: bool,
}

/// Arcs of the same mounting, name, direction and feed are one row, with a column a repeat.
pub(super) fn rows(analysis: &Analysis) -> Vec<ArcRow> {
    let mut rows: Vec<(&str, &ArcResult, Vec<Vec<&ArcResult>>)> = Vec::new();
    let repeats = analysis.repeats.len();
    for (index, repeat) in analysis.repeats.iter().enumerate() {
        let arcs = repeat.runs.iter().flat_map(|run| run.arcs.iter().map(move |arc| (run, arc)));
        for (run, arc) in arcs {
            let same = |mounting: &str, row: &ArcResult| {
                mounting == run.mounting
                    && row.name == arc.name
                    && row.circle == arc.circle
                    && row.direction == arc.direction
                    && (row.feed_mm_min - arc.feed_mm_min).abs() < 0.5
            };
            let place =
                rows.iter().position(|(of, first, _)| same(of, first)).unwrap_or_else(|| {
                    rows.push((&run.mounting, arc, vec![Vec::new(); repeats]));
                    rows.len() - 1
                });
            rows[place].2[index].push(arc);
        }
    }
    rows.into_iter()
        .map(|(mounting, first, of_repeats)| {
            let all: Vec<&ArcResult> = of_repeats.iter().flatten().copied().collect();
            let samples: usize = all.iter().map(|arc| arc.samples).sum();
            let weighted = |value: &dyn Fn(&ArcResult) -> f64, arcs: &[&ArcResult]| {
                let of: usize = arcs.iter().map(|arc| arc.samples).sum();
                arcs.iter().map(|arc| value(arc) * arc.samples as f64).sum::<f64>()
                    / of.max(1) as f64
            };
            ArcRow {
                name: first.name.clone(),
                mounting: mounting.to_owned(),
                circle: first.circle.clone(),
                direction: first.direction,
                feed: fixed(first.feed_mm_min, 0),
                samples: count(samples),
                rms: of_repeats
                    .iter()
                    .map(|arcs| {
                        if arcs.is_empty() {
                            return "–".into();
                        }
                        fixed(weighted(&|arc| arc.rms_um.powi(2), arcs).sqrt(), 3)
                    })
                    .collect(),
                mean: typeset(&signed(weighted(&|arc| arc.mean_um, &all), 3)),
                worst: fixed(all.iter().map(|arc| arc.worst_um).fold(0.0, f64::max), 2),
                transit: first.transit,
            }
        })
        .collect()
}
