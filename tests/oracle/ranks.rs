//! The tables of `DESIGN.md`, section 4: what can be told apart, in the volume and by a ball-bar.
//!
//! The figures there were computed apart from this code. The arcs are ideal circles, each by itself, in
//! both directions; a slide that stands still during an arc has the sense 0 there. Rank is counted at
//! 1e-10 on columns of unit length, and a column that vanishes to rounding stays zero.

use ballbar::identify::{Gather, POINTS, POSES, Sight};
use ballbar::machine::{Axis, Machine, Mounting, Pivot};
use ballbar::model::coefficients;
use ballbar::paper::{Pruning, removed_by, stages};
use ballbar::plan::Strategy;
use nalgebra::Vector3;

use crate::common::repository;

const BAR_MM: f64 = 150.0;

/// Numbers of columns where the paper's Sections 4 and 5 stop to count; the names are the library's.
const VOLUME: [usize; 8] = [96, 93, 77, 65, 61, 60, 59, 56];
const BALL_BAR: [usize; 7] = [56, 48, 44, 43, 42, 41, 40];
const PLANES: [usize; 5] = [40, 36, 35, 34, 32];

fn hu40t() -> Machine {
    Machine::read(&repository("machines/hu40t.toml")).unwrap()
}

/// The mounting of `tests/data`.
fn mounting_a() -> Mounting {
    Mounting {
        coincidence_mm: Vector3::new(20.0, -35.0, 40.0),
        tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
    }
}

/// Number and rank of the columns that a choice of names leaves.
fn ranked(sight: &Sight, keep: impl Fn(&str) -> bool) -> (usize, usize) {
    let columns = sight.columns(keep);
    // `look` refuses a rank that hangs on the tolerance: it would be no rank of the ideal path.
    (columns.len(), sight.look(&columns).unwrap().rank)
}

/// Ranks along a list of stages; `removed` is what was removed before the first.
fn ranks(sight: &Sight, list: Pruning, sizes: &[usize], removed: &[&'static str]) -> Vec<usize> {
    let mut gone = removed.to_vec();
    assert_eq!(stages(list).len(), sizes.len());
    stages(list)
        .iter()
        .zip(sizes)
        .map(|(stage, size)| {
            gone.extend(stage.removed());
            let (columns, rank) = ranked(sight, |name| !gone.contains(&name));
            assert_eq!(columns, *size, "the stage has another number of columns");
            rank
        })
        .collect()
}

fn volume_ranks(machine: &Machine) -> Vec<usize> {
    let mut gather = Gather::new(machine, &[mounting_a()]).unwrap();
    gather.volume(Axis::ALL.map(|axis| machine.slide(axis).travel_mm), POSES);
    ranks(&gather.finish().unwrap(), Pruning::Volume, &VOLUME, &[])
}

fn driven(machine: &Machine, strategy: Strategy) -> Sight {
    let mut gather = Gather::new(machine, &[mounting_a()]).unwrap();
    gather.drive(0, &strategy.arcs(), BAR_MM, POINTS);
    gather.finish().unwrap()
}

#[test]
fn the_volume_needs_59_of_96_columns_and_56_without_the_three_gradients() {
    let paper = [59, 59, 59, 59, 59, 59, 59, 56];
    for (pivot, machine) in
        [("carriage", hu40t()), ("base on X", hu40t().with_pivot(Axis::X, Pivot::Base))]
    {
        let found = volume_ranks(&machine);
        println!("volume, {pivot:<10} {found:?}");
        assert_eq!(found, paper, "pivot {pivot}");
    }
}

#[test]
fn strategies_with_meridians_see_36_columns_from_the_carriage_and_40_from_the_base() {
    let start = removed_by(&[Pruning::Volume]);
    for strategy in [Strategy::ThreeD5, Strategy::ThreeD6, Strategy::ThreeD10] {
        for (pivot, machine, expected) in [
            ("carriage", hu40t(), [38, 38, 36, 36, 36, 36, 36]),
            ("base on X", hu40t().with_pivot(Axis::X, Pivot::Base), [42, 42, 40, 40, 40, 40, 40]),
        ] {
            let sight = driven(&machine, strategy);
            let found = ranks(&sight, Pruning::Meridians, &BALL_BAR, &start);
            println!("{:<5} {pivot:<10} {found:?}", strategy.name());
            assert_eq!(found, expected, "{} {pivot}", strategy.name());
        }
    }
}

#[test]
fn the_three_planes_see_30_columns_from_the_carriage_and_32_of_32_from_the_base() {
    let start = removed_by(&[Pruning::Volume, Pruning::Meridians]);
    for (pivot, machine, expected) in [
        ("carriage", hu40t(), [30, 30, 30, 30, 30]),
        ("base on X", hu40t().with_pivot(Axis::X, Pivot::Base), [34, 34, 34, 34, 32]),
    ] {
        let sight = driven(&machine, Strategy::TwoD);
        let found = ranks(&sight, Pruning::Planes, &PLANES, &start);
        println!("2d    {pivot:<10} {found:?}");
        assert_eq!(found, expected, "{pivot}");
    }
}

/// The paper prints 40 seven times, and 33, 33, 33, 33, 32.
#[test]
fn no_choice_of_pivots_has_all_ranks_of_the_paper() {
    let start = removed_by(&[Pruning::Volume]);
    let planes = removed_by(&[Pruning::Volume, Pruning::Meridians]);
    for bits in 0..8 {
        let machine = Axis::ALL.into_iter().fold(hu40t(), |machine, axis| {
            let base = bits >> axis.index() & 1 == 1;
            machine.with_pivot(axis, if base { Pivot::Base } else { Pivot::Carriage })
        });
        let three = driven(&machine, Strategy::ThreeD6);
        let three = ranks(&three, Pruning::Meridians, &BALL_BAR, &start);
        let two = driven(&machine, Strategy::TwoD);
        let two = ranks(&two, Pruning::Planes, &PLANES, &planes);
        println!("pivots on the base {bits:03b}: {three:?} {two:?}");
        assert!(three != [40; 7] && two != [33, 33, 33, 33, 32], "{bits:03b}");
        if bits == 0b101 {
            assert_eq!(three, [40, 40, 40, 40, 40, 40, 39], "X and Z");
        }
    }
}

/// The named sets hold what their descriptions promise.
#[test]
fn the_named_sets_have_full_rank_where_they_say_so() {
    let base = hu40t().with_pivot(Axis::X, Pivot::Base);
    for (set, machine, strategy, expected) in [
        ("observable35", hu40t(), Strategy::ThreeD6, 38),
        ("paper37", base, Strategy::ThreeD6, 40),
        ("paper37", hu40t(), Strategy::ThreeD6, 36),
        ("planar27", hu40t(), Strategy::TwoD, 30),
        ("observable35", hu40t(), Strategy::TwoD, 32),
    ] {
        let names: Vec<String> =
            coefficients(set).unwrap().iter().map(ToString::to_string).collect();
        let keep =
            |name: &str| names.iter().any(|n| n == name) || ["EXt", "EYt", "EZt"].contains(&name);
        let (columns, rank) = ranked(&driven(&machine, strategy), keep);
        println!(
            "{set:<13} {:<4} pivot of X {:?}: {rank} of {columns}",
            strategy.name(),
            machine.slide(Axis::X).pivot
        );
        assert_eq!(rank, expected, "{set} on {}", strategy.name());
    }
}

/// `(coincidence, z of the tool ball, bar)`, mm, of every mounting.
type Places = &'static [([f64; 3], f64, f64)];

const A: [f64; 3] = [20.0, -35.0, 40.0];

/// Rank of the coefficients: of all columns, less the set-up errors that every mounting brings.
fn identifiable(places: Places, keep: impl Fn(&str) -> bool) -> (usize, usize) {
    let machine = hu40t();
    let mountings: Vec<Mounting> = places
        .iter()
        .map(|(at, tool, _)| Mounting {
            coincidence_mm: Vector3::from(*at),
            tool_ball_mm: Vector3::new(0.0, 0.0, *tool),
        })
        .collect();
    let mut gather = Gather::new(&machine, &mountings).unwrap();
    for (k, (_, _, bar_mm)) in places.iter().enumerate() {
        gather.drive(k, &Strategy::ThreeD6.arcs(), *bar_mm, POINTS);
    }
    let (columns, rank) = ranked(&gather.finish().unwrap(), keep);
    (columns - 3 * places.len(), rank - 3 * places.len())
}

#[test]
fn three_mountings_that_are_not_on_one_line_identify_all_53() {
    const TABLE: [(&str, Places, usize); 10] = [
        ("one", &[(A, -200.0, 150.0)], 35),
        ("one place, two bar lengths", &[(A, -200.0, 150.0), (A, -200.0, 100.0)], 36),
        // A longer tool meets the same workpiece ball from higher up.
        (
            "two tool lengths, same workpiece ball",
            &[(A, -200.0, 150.0), ([20.0, -35.0, 120.0], -280.0, 150.0)],
            39,
        ),
        ("two places apart in X", &[(A, -200.0, 150.0), ([100.0, -35.0, 40.0], -200.0, 150.0)], 44),
        ("two places apart in Z", &[(A, -200.0, 150.0), ([20.0, -35.0, 120.0], -200.0, 150.0)], 48),
        ("two places apart in Y", &[(A, -200.0, 150.0), ([20.0, 45.0, 40.0], -200.0, 150.0)], 49),
        (
            "two places apart in X, Y and Z",
            &[(A, -200.0, 150.0), ([100.0, 45.0, 120.0], -200.0, 150.0)],
            49,
        ),
        (
            "three places on one line",
            &[
                (A, -200.0, 150.0),
                ([60.0, 5.0, 80.0], -200.0, 150.0),
                ([100.0, 45.0, 120.0], -200.0, 150.0),
            ],
            49,
        ),
        (
            "three places, not on one line",
            &[
                (A, -200.0, 150.0),
                ([100.0, 45.0, 120.0], -200.0, 150.0),
                ([-60.0, 45.0, 10.0], -200.0, 150.0),
            ],
            53,
        ),
        (
            "three places and two tool lengths",
            &[
                (A, -200.0, 150.0),
                ([100.0, 45.0, 120.0], -200.0, 150.0),
                ([-60.0, 45.0, 10.0], -280.0, 150.0),
            ],
            53,
        ),
    ];
    let gone = removed_by(&[Pruning::Volume]);
    let mut wrong = Vec::new();
    for (what, places, expected) in TABLE {
        let (of, rank) = identifiable(places, |name| !gone.contains(&name));
        let (of_all, all) = identifiable(places, |name| !name.ends_with('w'));
        println!("{what:<40} {rank} of {of}, {all} of {of_all}");
        if rank != expected {
            wrong.push(format!("{what}: {rank} instead of {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
