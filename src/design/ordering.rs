//! The order of set-ups and arcs: as an operator would do them.

use nalgebra::{Unit, UnitVector3, Vector3};

use super::candidates::SetUpCandidate;
use super::information::ArcInformation;
use super::problem::Chosen;
use super::proposed::ProposedSetUp;
use crate::plan::Arc;

/// The chosen set-ups and arcs in order.
///
/// Tools and bars are changed as rarely as can be, places follow each other by their distance, and the
/// ways from one arc to the next are short: an arc may begin at its other end, a whole circle anywhere.
pub(super) fn ordered(
    chosen: &Chosen,
    of_arcs: &[ArcInformation],
    set_ups: &[SetUpCandidate],
    arcs: &[Arc],
) -> Vec<ProposedSetUp> {
    let mut proposed: Vec<ProposedSetUp> = chosen
        .set_ups
        .iter()
        .map(|&index| {
            let of_set_up = chosen.arcs.iter().map(|&k| &of_arcs[k]).filter(|a| a.set_up == index);
            let mut indices: Vec<usize> = of_set_up.map(|a| a.arc).collect();
            indices.sort_unstable();
            let arcs = indices.into_iter().map(|arc| arcs[arc].clone()).collect();
            ProposedSetUp { set_up: set_ups[index].clone(), arcs: short_ways(arcs) }
        })
        .filter(|proposed| !proposed.arcs.is_empty())
        .collect();
    let mut in_order: Vec<ProposedSetUp> = Vec::with_capacity(proposed.len());
    while !proposed.is_empty() {
        let trouble = |next: &ProposedSetUp| {
            let Some(last) = in_order.last() else {
                // Where the balls are already, one begins.
                return (usize::from(next.set_up.given.is_none()), 0.0);
            };
            let (from, to) = (&last.set_up, &next.set_up);
            let tool = usize::from(from.mounting.tool_ball_mm != to.mounting.tool_ball_mm);
            let bar = usize::from((from.bar_mm - to.bar_mm).abs() > 1e-9);
            (2 * tool + bar, (from.mounting.coincidence_mm - to.mounting.coincidence_mm).norm())
        };
        let nearest = proposed
            .iter()
            .map(trouble)
            .enumerate()
            .min_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let index = nearest.map_or(0, |(index, _)| index);
        in_order.push(proposed.remove(index));
    }
    in_order
}

/// From the first arc always to the nearest one.
fn short_ways(mut arcs: Vec<Arc>) -> Vec<Arc> {
    let mut in_order: Vec<Arc> = Vec::with_capacity(arcs.len());
    while !arcs.is_empty() {
        // Driven forward and back, an arc ends where it began.
        let at = in_order.last().map(|arc| arc.start);
        let Some(at) = at else {
            in_order.push(arcs.remove(0));
            continue;
        };
        let begun: Vec<(f64, Arc)> = arcs.iter().map(|arc| begin_near(arc, &at)).collect();
        let nearest = begun.iter().enumerate().min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        let index = nearest.map_or(0, |(index, _)| index);
        in_order.push(begun[index].1.clone());
        arcs.remove(index);
    }
    in_order
}

/// The same arc begun as near to a direction as it can, and the angle to its beginning, rad.
fn begin_near(arc: &Arc, at: &UnitVector3<f64>) -> (f64, Arc) {
    let angle = |from: &UnitVector3<f64>| from.dot(at).clamp(-1.0, 1.0).acos();
    if arc.is_closed() {
        let height = arc.normal.dot(&arc.start);
        let aside: Vector3<f64> = at.into_inner() - arc.normal.into_inner() * arc.normal.dot(at);
        let radius = (1.0 - height * height).max(0.0).sqrt();
        if let Some(along) = Unit::try_new(aside, 1e-6) {
            let start = arc.normal.into_inner() * height + along.into_inner() * radius;
            let turned = Arc { start: Unit::new_normalize(start), ..arc.clone() };
            return (angle(&turned.start), turned);
        }
    }
    let back = arc.reversed(&arc.name);
    let (forward, backward) = (angle(&arc.start), angle(&back.start));
    if backward < forward { (backward, back) } else { (forward, arc.clone()) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    #[test]
    fn an_arc_begins_at_its_nearer_end_and_a_circle_anywhere() {
        let meridian = Arc::meridian("M", 0.3, 0.0, PI);
        let at = meridian.at(0.9);
        let (angle, begun) = begin_near(&meridian, &at);
        assert!((angle - 0.1 * PI).abs() < 1e-9);
        assert!((begun.start.into_inner() - meridian.at(1.0).into_inner()).norm() < 1e-12);
        let parallel = Arc::parallel("P", 0.8, 0.0, TAU);
        let (angle, begun) = begin_near(&parallel, &Arc::parallel("", 1.0, 2.0, 1.0).start);
        assert!((angle - 0.2).abs() < 1e-9, "{angle}");
        assert!((begun.normal.dot(&begun.start) - 0.8_f64.cos()).abs() < 1e-12);
    }

    #[test]
    fn ways_between_arcs_become_short() {
        let arcs: Vec<Arc> = [0.0, 1.5, 0.2, 1.3]
            .iter()
            .map(|&azimuth| Arc::meridian("M", azimuth, 0.0, PI))
            .collect();
        let way = |arcs: &[Arc]| -> f64 {
            arcs.windows(2).map(|w| w[0].start.dot(&w[1].start).clamp(-1.0, 1.0).acos()).sum()
        };
        let ordered = short_ways(arcs.clone());
        assert!(way(&ordered) < 0.6 * way(&arcs), "{} {}", way(&ordered), way(&arcs));
        assert_eq!(ordered.len(), 4);
    }
}
