//! What the bar reads where slides turn round, of which a fit takes nothing: a spike that is over before it begins again.

use super::record::{Apart, Record};
use super::result::IdentifiedRun;
use crate::machine::Axis;
use crate::solve;

/// Readings that lie so many times farther off than is usual, beyond all that a wrong time of the reversal can make, are no chance.
const FAR_OFF: f64 = 10.0;

/// A while about a reversal in which no reading takes part.
struct Turn {
    axis: Axis,
    /// By how much readings lie off there, the second farthest of one side, mm, positive where they are longer; 0 where the sense of
    /// before or after explains them.
    off_mm: f64,
    /// From its first reading to its last, s.
    lasts_s: f64,
    /// Whether the leg is driven in chords, which tell its times.
    in_chords: bool,
}

/// Axes at half of whose reversals, or more, readings that take no part lie off to one side, each with a sentence.
///
/// A reading in such a while may have the sense of before or of after it: what is computed to step there is no spike. The second
/// largest of a side counts, as a single reading may be anything.
pub(super) fn spikes<'a>(runs: impl Iterator<Item = &'a IdentifiedRun>) -> Vec<(Axis, String)> {
    let turns: Vec<Turn> = runs.flat_map(of_run).collect();
    let of_axis = |axis: Axis| {
        let of: Vec<&Turn> = turns.iter().filter(|turn| turn.axis == axis).collect();
        let side = of.iter().map(|turn| turn.off_mm).sum::<f64>().signum();
        let mut off_mm: Vec<f64> =
            of.iter().map(|turn| turn.off_mm * side).filter(|off_mm| *off_mm > 0.0).collect();
        if off_mm.len() < 2 || 2 * off_mm.len() < of.len() {
            return None;
        }
        off_mm.sort_by(f64::total_cmp);
        let (middle_mm, most_mm) = (off_mm[off_mm.len() / 2], off_mm[off_mm.len() - 1]);
        let lasts_s = of.iter().map(|turn| turn.lasts_s).sum::<f64>() / of.len() as f64;
        let better = if of.iter().any(|turn| turn.in_chords) {
            ""
        } else {
            ". Programs of chords (`interpolation = \"chords\"`) tell times to some milliseconds"
        };
        let words = format!(
            "where {axis} turns round the bar reads {:.1} um {} than the model, {:.1} at the most, at {} of {} reversals: a spike that is over within the {:.0} ms or so of which no reading takes part, as the times of readings are not known better there. It is not in what was found, nor in any number; the picture of the circle shows it{better}",
            1e3 * middle_mm,
            if side > 0.0 { "more" } else { "less" },
            1e3 * most_mm,
            off_mm.len(),
            of.len(),
            1e3 * lasts_s
        );
        Some((axis, words))
    };
    Axis::ALL.into_iter().filter_map(of_axis).collect()
}

fn of_run(run: &IdentifiedRun) -> Vec<Turn> {
    let used = run.records.iter().filter(|record| record.used());
    let mut used_mm: Vec<f64> = used.map(|record| record.residual_mm).collect();
    let Some(usual_mm) = solve::robust_scale(&mut used_mm) else { return Vec::new() };
    let apart = |record: &Record| record.apart == Some(Apart::Reversal);
    let whiles = run.records.chunk_by(|a, b| apart(a) == apart(b));
    let of_while = |records: &[Record]| {
        let (first, last) = (records.first()?, records.last()?);
        let (before, after) = (first.sample.pose.sense, last.sample.pose.sense);
        let mut turning = Axis::ALL.into_iter().filter(|axis| {
            let k = axis.index();
            before[k] * after[k] < 0.0
        });
        // Of two that turn at once nobody knows whose it is.
        let axis = turning.next().filter(|_| turning.next().is_none())?;
        let turns = |two: &[Record]| two[0].sample.pose.sense != two[1].sample.pose.sense;
        let at = records.windows(2).position(turns)?;
        let step_mm = records[at + 1].computed_mm - records[at].computed_mm;
        // What lies off beyond all that the other sense makes of a reading, and by how much it lies off.
        let mut off_mm: Vec<[f64; 2]> = (0..)
            .zip(records)
            .map(|(k, record): (usize, _)| {
                let other_mm = if k > at { -step_mm } else { step_mm };
                let off_mm = record.residual_mm;
                [off_mm - off_mm.clamp(other_mm.min(0.0), other_mm.max(0.0)), off_mm]
            })
            .collect();
        off_mm.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [low, high] = [*off_mm.get(1)?, *off_mm.get(off_mm.len().checked_sub(2)?)?];
        let second = if -low[0] > high[0] { low } else { high };
        Some(Turn {
            axis,
            off_mm: if second[0].abs() > FAR_OFF * usual_mm { second[1] } else { 0.0 },
            lasts_s: last.sample.log_s - first.sample.log_s,
            in_chords: run.alignment.time_map.chords[first.sample.leg].there_are(),
        })
    };
    whiles.filter(|records| apart(&records[0])).filter_map(of_while).collect()
}
