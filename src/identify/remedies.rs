//! What would separate a confounded group: other arcs, another place, another tool, another bar.
//!
//! A confounded group is a change `n` of the coefficients that no reading shows, `J n = 0`. A remedy adds
//! rows. It separates the group if the new rows show the change whatever the set-up errors `s` that it
//! brings along: `min over s of |J_new n + S s| > 0`. Everything is computed on ideal arcs, so it is a
//! fact about geometry; how well the noise then lets the group be seen is the plan's business.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::observability::{Sight, ideal_poses};
use crate::machine::{Axis, Machine, Mounting};
use crate::model::{Ball, Coefficient, SetUp, Situation, Term};
use crate::plan::Arc;
use crate::solve::NullDirection;

/// Points of an arc, each way.
const POINTS: usize = 48;
/// Effects below this part of the numbers that cancel in them are rounding.
const ROUNDING: f64 = 1e-9;
/// How far away a second place is tried, mm; less where the travel ends.
const APART_MM: f64 = 100.0;
/// A place nearer than this is no second place, mm.
const LEAST_APART_MM: f64 = 20.0;
/// How much longer a second tool is tried, mm.
const LONGER_MM: f64 = 80.0;
/// How far off the spindle's axis a tool ball is tried, mm.
const ASIDE_MM: f64 = 50.0;

/// One mounting with what is driven in it.
#[derive(Debug, Clone)]
pub struct Driven {
    /// Where the balls are.
    pub mounting: Mounting,
    /// Length of the bar, mm.
    pub bar_mm: f64,
    /// The arcs, each driven both ways.
    pub arcs: Vec<Arc>,
}

/// A confounded group: a change of coefficients and of the set-up errors of mountings, by their indices.
struct Group {
    coefficients: Vec<(Coefficient, f64)>,
    set_ups: Vec<((SetUp, usize), f64)>,
}

/// Something to do about a confounded group.
#[derive(Debug, Clone)]
struct Remedy {
    what: String,
    /// What is driven besides, each with the mounting whose balls stay as they are; `None` if they are
    /// mounted anew.
    driven: Vec<(Driven, Option<usize>)>,
}

/// For each confounded group what would separate it, in words, from little trouble to much; empty where
/// nothing that was tried does. The groups are combinations of the columns of `sight`.
pub fn remedies(
    machine: &Machine,
    test: &[Driven],
    groups: &[NullDirection],
    sight: &Sight,
) -> Vec<Vec<String>> {
    let single = single_remedies(machine, test);
    let combined = combined_remedies(machine, test);
    groups
        .iter()
        .map(|group| {
            let of = |k: usize| sight.id(k).coefficient();
            let parts = group.parts.iter().filter_map(|&(k, share)| Some((of(k)?, share)));
            let set_ups =
                group.parts.iter().filter_map(|&(k, share)| Some((sight.id(k).set_up()?, share)));
            let group = Group { coefficients: parts.collect(), set_ups: set_ups.collect() };
            let helps = |remedy: &&Remedy| separates(machine, remedy, &group);
            let told = |remedies: &[Remedy]| -> Vec<String> {
                remedies.iter().filter(helps).map(|remedy| remedy.what.clone()).collect()
            };
            let alone = told(&single);
            if alone.is_empty() { told(&combined) } else { alone }
        })
        .collect()
}

/// Whether the rows of a remedy show a change that the set-up errors of a new mounting cannot hide.
fn separates(machine: &Machine, remedy: &Remedy, group: &Group) -> bool {
    remedy.driven.iter().any(|(driven, same_as)| {
        let mut effect = Vec::new();
        let mut of_place: [Vec<f64>; 3] = [const { Vec::new() }; 3];
        let mut size: f64 = 0.0;
        for arc in &driven.arcs {
            for pose in ideal_poses(&driven.mounting, arc, driven.bar_mm, POINTS) {
                let Some(at) = Situation::new(machine, &driven.mounting, 0, &pose) else {
                    continue;
                };
                let mut sum = 0.0;
                let mut value = [0.0];
                for (coefficient, share) in &group.coefficients {
                    coefficient.columns(&at, &mut value);
                    sum += share * value[0];
                    size += (share * value[0]).powi(2);
                }
                if let Some(mounting) = same_as {
                    for ((set_up, of), share) in &group.set_ups {
                        if of != mounting {
                            continue;
                        }
                        let along = at.direction[set_up.axis.index()];
                        let value = if set_up.ball == Ball::Tool { along } else { -along };
                        sum += share * value;
                        size += (share * value).powi(2);
                    }
                }
                effect.push(sum);
                for (column, along) in of_place.iter_mut().zip(at.direction.iter()) {
                    column.push(*along);
                }
            }
        }
        if same_as.is_none() {
            take_off(&mut effect, &mut of_place);
        }
        let left: f64 = effect.iter().map(|e| e * e).sum();
        left > ROUNDING * ROUNDING * size
    })
}

/// Takes the projection on the columns off a vector.
fn take_off(vector: &mut [f64], columns: &mut [Vec<f64>; 3]) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for k in 0..columns.len() {
        let (before, rest) = columns.split_at_mut(k);
        let column = &mut rest[0];
        for _ in 0..2 {
            for q in before.iter() {
                let along = dot(q, column);
                column.iter_mut().zip(q).for_each(|(c, q)| *c -= along * q);
            }
        }
        let length = dot(column, column).sqrt();
        if length > 0.0 {
            for c in column.iter_mut() {
                *c /= length;
            }
        }
        for _ in 0..2 {
            let along = dot(column, vector);
            vector.iter_mut().zip(column.iter()).for_each(|(v, c)| *v -= along * c);
        }
    }
}

/// Circles in all directions over the upper half of the sphere.
fn everywhere() -> Vec<Arc> {
    let mut arcs = vec![Arc::equator("", 0.0, 2.0 * PI)];
    for k in 0..8_u32 {
        let azimuth = f64::from(k) * PI / 8.0;
        arcs.push(Arc::meridian("", azimuth, 0.0, PI));
        for tilt in [0.3, 0.8] {
            let (sin, cos) = f64::sin_cos(tilt);
            let along = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
            let across = Vector3::new(-azimuth.sin() * cos, azimuth.cos() * cos, sin);
            let normal = nalgebra::Unit::new_normalize(along.cross(&across));
            let start = nalgebra::Unit::new_normalize(along);
            arcs.push(Arc { name: String::new(), start, normal, sweep_rad: PI });
        }
    }
    for polar in [0.35, 0.8, 1.2] {
        arcs.push(Arc::parallel("", polar, 0.0, 2.0 * PI));
    }
    arcs.push(Arc::parallel("", FRAC_PI_2 * 0.9, 0.0, 2.0 * PI));
    arcs
}

fn single_remedies(machine: &Machine, test: &[Driven]) -> Vec<Remedy> {
    let Some(first) = test.first() else { return Vec::new() };
    let everywhere = everywhere();
    let more_arcs = test.iter().enumerate().map(|(mounting, driven)| {
        (Driven { arcs: everywhere.clone(), ..driven.clone() }, Some(mounting))
    });
    let mut all = vec![
        Remedy { what: "more arcs in the same mounting".into(), driven: more_arcs.collect() },
        Remedy {
            what: format!("a bar of {:.0} mm in the same place", other_bar_mm(first)),
            driven: vec![(Driven { bar_mm: other_bar_mm(first), ..first.clone() }, None)],
        },
    ];
    for axis in Axis::ALL {
        if let Some((moved, apart_mm)) = moved(machine, first, axis) {
            let what = format!("a second place {apart_mm:.0} mm along {axis}");
            all.push(Remedy { what, driven: vec![(moved, None)] });
        }
    }
    all.push(Remedy {
        what: format!("a tool {LONGER_MM:.0} mm longer"),
        driven: vec![(longer(first), None)],
    });
    let mut aside = first.clone();
    aside.mounting.tool_ball_mm.x += ASIDE_MM;
    aside.mounting.coincidence_mm.x -= ASIDE_MM;
    all.push(Remedy {
        what: format!("a tool ball {ASIDE_MM:.0} mm off the spindle's axis"),
        driven: vec![(aside, None)],
    });
    all
}

/// What is tried where nothing helps alone.
fn combined_remedies(machine: &Machine, test: &[Driven]) -> Vec<Remedy> {
    let Some(first) = test.first() else { return Vec::new() };
    let places: Vec<(Driven, Option<usize>)> =
        Axis::ALL.iter().filter_map(|&axis| Some((moved(machine, first, axis)?.0, None))).collect();
    let mut with_tool = places.clone();
    with_tool.extend(places.iter().map(|(driven, _)| (longer(driven), None)));
    vec![
        Remedy { what: "more places, not on one line".into(), driven: places },
        Remedy { what: "more places and a longer tool".into(), driven: with_tool },
    ]
}

/// Bars are sold as 50, 100, 150 and 300 mm: the next shorter one, or the next longer than the shortest.
fn other_bar_mm(driven: &Driven) -> f64 {
    [300.0, 150.0, 100.0, 50.0].into_iter().find(|bar| *bar < driven.bar_mm - 1.0).unwrap_or(100.0)
}

/// The same test along an axis, as far as there is room, and how far that is, mm.
fn moved(machine: &Machine, driven: &Driven, axis: Axis) -> Option<(Driven, f64)> {
    let [low, high] = machine.slide(axis).travel_mm;
    let at = driven.mounting.coincidence_mm[axis.index()];
    // The sphere is above its centre along the tool's axis, to both sides along the others.
    let below = if axis == Axis::Z { 0.0 } else { driven.bar_mm };
    let (down, up) = (at - below - low, high - driven.bar_mm - at);
    let apart_mm = if up >= down { up.min(APART_MM) } else { -down.min(APART_MM) };
    if apart_mm.abs() < LEAST_APART_MM {
        return None;
    }
    let mut moved = driven.clone();
    moved.mounting.coincidence_mm[axis.index()] += apart_mm;
    Some((moved, apart_mm.abs()))
}

/// A longer tool meets the same workpiece ball from higher up.
fn longer(driven: &Driven) -> Driven {
    let mut longer = driven.clone();
    longer.mounting.tool_ball_mm.z -= LONGER_MM;
    longer.mounting.coincidence_mm.z += LONGER_MM;
    longer
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::identify::{Gather, preference};
    use crate::plan::Strategy;

    /// For every removed term of a test: its name, the reason, the remedies.
    fn told(strategy: Strategy) -> Vec<(String, String, Vec<String>)> {
        let machine = Machine::read("machines/hu40t.toml".as_ref()).unwrap();
        let mounting = Mounting {
            coincidence_mm: Vector3::new(20.0, -35.0, 40.0),
            tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
        };
        let mut gather = Gather::new(&machine, &[mounting]).unwrap();
        gather.drive(0, &strategy.arcs(), 150.0, 240);
        let sight = gather.finish().unwrap();
        let selection = sight.select(&sight.ordered(&preference(&[]).unwrap())).unwrap();
        let groups: Vec<NullDirection> =
            selection.removed.iter().map(|removal| removal.direction.clone()).collect();
        let test = [Driven { mounting, bar_mm: 150.0, arcs: strategy.arcs() }];
        let remedies = remedies(&machine, &test, &groups, &sight);
        let removed = selection.removed.into_iter().zip(remedies);
        removed.map(|(removal, remedies)| (removal.name, removal.reason, remedies)).collect()
    }

    #[test]
    fn what_separates_a_group_is_what_the_table_of_mountings_says() {
        let told = told(Strategy::ThreeD6);
        let of = |name: &str| &told.iter().find(|(n, ..)| n == name).unwrap().2;
        let helped = |name: &str, by: &str| of(name).iter().any(|remedy| remedy.contains(by));
        // A rotation of X about Y acts as displacements as long as the lever is the same.
        assert!(!helped("EBXb", "more arcs") && !helped("EBXb", "a bar"));
        assert!(helped("EBXb", "along X") && helped("EBXb", "along Z"));
        assert!(!helped("EBXb", "along Y") && !helped("EBXb", "longer"));
        // A rotation of the last slide turns the tool: only another tool has another lever.
        assert!(helped("EBYb", "longer") && !helped("EBYb", "second place"), "{:?}", of("EBYb"));
        // About the spindle's own axis it turns nothing that is on the axis.
        assert!(helped("ECYb", "off the spindle") && of("ECYb").len() == 1, "{:?}", of("ECYb"));
        // Where the machine's zero is, nobody will ever see.
        assert!(of("EXX0").is_empty(), "{:?}", of("EXX0"));
        // Nothing that 3D6 misses in one mounting is for want of arcs.
        assert!(told.iter().all(|(name, ..)| !helped(name, "more arcs")));
    }

    #[test]
    fn the_planes_want_more_arcs() {
        let told = told(Strategy::TwoD);
        let of = |name: &str| &told.iter().find(|(n, ..)| n == name).unwrap().2;
        for name in ["ECZ1", "ECZ2", "ECZ3", "ECZb", "EZX3", "EZY3"] {
            assert!(of(name).iter().any(|remedy| remedy.contains("more arcs")), "{name}");
        }
    }
}
