//! The tables of `DESIGN.md`, section 4: what can be told apart, in the volume and by a ball-bar.
//!
//! The figures there were computed apart from this code. The arcs are ideal circles, each by itself, in
//! both directions; a slide that stands still during an arc has the sense 0 there. Rank is counted at
//! 1e-10 on columns of unit length, and a column that vanishes to rounding stays zero.

use ballbar::machine::{Axis, Machine, Mounting, Pivot, Pose};
use ballbar::model::{Coefficient, Model, SetUp, Situation, coefficients, terms};
use ballbar::paper::{Pruning, removed_by, stages};
use ballbar::plan::{Arc, Strategy};
use ballbar::solve::{Spectrum, Tsqr};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::common::{random_pose, repository};

const TOLERANCE: f64 = 1e-10;
const BAR_MM: f64 = 150.0;
/// Points of an arc, half a step from its ends: an even number, so none lies where a slide turns round.
const POINTS: usize = 240;

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

/// A column of the table, or the set-up error of one mounting.
#[derive(Clone, Copy)]
enum Kind {
    Coefficient(Coefficient),
    SetUp(SetUp, usize),
}

/// The rows of all columns, and for each column the norm that it would have if nothing in it cancelled.
struct Rows<'a> {
    model: Model<'a>,
    kinds: Vec<Kind>,
    names: Vec<String>,
    tsqr: Tsqr,
    squares: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(machine: &'a Machine, mountings: &[Mounting]) -> Self {
        let places: Vec<String> = (0..mountings.len()).map(|k| format!("P{k}")).collect();
        let all = terms(&["all".to_owned()], &places).unwrap();
        let model = Model::new(machine, mountings.to_vec(), all);
        let set_ups =
            (0..mountings.len()).flat_map(|k| SetUp::all().map(move |s| Kind::SetUp(s, k)));
        let kinds: Vec<Kind> = Coefficient::all().map(Kind::Coefficient).chain(set_ups).collect();
        let names = model.parameters().iter().map(|p| p.name.clone()).collect();
        let columns = kinds.len();
        Self { model, kinds, names, tsqr: Tsqr::new(columns), squares: vec![0.0; columns] }
    }

    /// A row, and the sizes of the numbers that were subtracted from each other in it: levers and
    /// directions are differences of positions.
    fn push(&mut self, at: &Situation, direction_size: &Vector3<f64>) {
        let mut row = vec![0.0; self.kinds.len()];
        self.model.row(at, &mut row);
        self.tsqr.push(&row, 0.0);
        let mounting = &self.model.mountings()[at.mounting];
        let lever_size = mounting.tool_ball_mm.abs() + at.pose.position_mm.abs();
        let turned = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            lever_size[j] * direction_size[k] + lever_size[k] * direction_size[j]
        };
        for (square, kind) in self.squares.iter_mut().zip(&self.kinds) {
            let size = match kind {
                Kind::SetUp(_, mounting) if *mounting != at.mounting => 0.0,
                Kind::SetUp(set_up, _) => direction_size[set_up.axis.index()],
                Kind::Coefficient(c) => {
                    let basis = at.basis[c.slide.index()][c.power as usize].abs();
                    let i = c.component.direction();
                    basis * if c.component.is_angular() { turned(i) } else { direction_size[i] }
                }
            };
            *square += size * size;
        }
    }

    /// All arcs of a strategy, forward and backward, on a bar of this length.
    fn drive(&mut self, mounting: usize, strategy: Strategy, bar_mm: f64) {
        let at = self.model.mountings()[mounting];
        for forward in strategy.arcs() {
            for arc in [forward.clone(), forward.reversed("back")] {
                for pose in poses(&arc, &at, bar_mm) {
                    let situation =
                        Situation::new(self.model.machine(), &at, mounting, &pose).unwrap();
                    let size = (pose.position_mm.abs() + at.coincidence_mm.abs()) / bar_mm;
                    self.push(&situation, &size);
                }
            }
        }
    }

    fn finish(self) -> Ranks {
        let references = self.squares.into_iter().map(f64::sqrt).collect();
        Ranks { triangle: self.tsqr.finish().unwrap(), references, names: self.names }
    }
}

/// An ideal circle: no chords, no rounding, the sense of the tangent.
fn poses(arc: &Arc, mounting: &Mounting, bar_mm: f64) -> Vec<Pose> {
    (0..POINTS)
        .map(|k| {
            let direction = arc.at((k as f64 + 0.5) / POINTS as f64);
            let tangent = arc.normal.cross(&direction) * arc.sweep_rad.signum();
            Pose {
                position_mm: mounting.coincidence_mm + direction.into_inner() * bar_mm,
                sense: tangent.map(|t| if t.abs() < 1e-9 { 0.0 } else { t.signum() }),
            }
        })
        .collect()
}

struct Ranks {
    triangle: ballbar::solve::Triangle,
    references: Vec<f64>,
    names: Vec<String>,
}

impl Ranks {
    /// Number and rank of the columns that a choice of names leaves.
    fn of(&self, keep: impl Fn(&str) -> bool) -> (usize, usize) {
        let columns: Vec<usize> = (0..self.names.len()).filter(|&k| keep(&self.names[k])).collect();
        let references: Vec<f64> = columns.iter().map(|&k| self.references[k]).collect();
        let narrow = self.triangle.select(&columns).unwrap();
        let spectrum = Spectrum::with_references(&narrow, &references).unwrap();
        let rank = spectrum.rank(TOLERANCE);
        // A rank that hung on the tolerance would be no rank of the ideal path.
        let values = spectrum.singular_values();
        let below = values.get(rank).map_or(0.0, |next| next / values[0]);
        let last = values[rank - 1] / values[0];
        assert!(below < 1e-12 && last > 1e-7, "no clear cut: {last:.1e} above, {below:.1e} below");
        (columns.len(), rank)
    }

    /// Ranks along a list of stages; `removed` is what was removed before the first.
    fn stages(&self, list: Pruning, sizes: &[usize], removed: &[&'static str]) -> Vec<usize> {
        let mut gone = removed.to_vec();
        assert_eq!(stages(list).len(), sizes.len());
        stages(list)
            .iter()
            .zip(sizes)
            .map(|(stage, size)| {
                gone.extend(stage.removed());
                let (columns, rank) = self.of(|name| !gone.contains(&bare(name)));
                assert_eq!(columns, *size, "the stage has another number of columns");
                rank
            })
            .collect()
    }
}

/// `EXt` of `EXt@P0`.
fn bare(name: &str) -> &str {
    name.split('@').next().unwrap()
}

fn volume_ranks(machine: &Machine) -> Vec<usize> {
    let mut random = Pcg64Mcg::seed_from_u64(8000);
    let mut rows = Rows::new(machine, &[mounting_a()]);
    for _ in 0..8000 {
        let pose = random_pose(machine, &mut random);
        for axis in Axis::ALL {
            let along = Vector3::ith(axis.index(), 1.0);
            let situation = Situation::along(machine, &mounting_a(), 0, &pose, along);
            rows.push(&situation, &along);
        }
    }
    rows.finish().stages(Pruning::Volume, &VOLUME, &[])
}

fn driven(machine: &Machine, strategy: Strategy) -> Ranks {
    let mut rows = Rows::new(machine, &[mounting_a()]);
    rows.drive(0, strategy, BAR_MM);
    rows.finish()
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
            let found = driven(&machine, strategy).stages(Pruning::Meridians, &BALL_BAR, &start);
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
        let found = driven(&machine, Strategy::TwoD).stages(Pruning::Planes, &PLANES, &start);
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
        let three = three.stages(Pruning::Meridians, &BALL_BAR, &start);
        let two = driven(&machine, Strategy::TwoD);
        let two = two.stages(Pruning::Planes, &PLANES, &planes);
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
        let (columns, rank) = driven(&machine, strategy).of(|name| keep(bare(name)));
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
    let mut rows = Rows::new(&machine, &mountings);
    for (k, (_, _, bar_mm)) in places.iter().enumerate() {
        rows.drive(k, Strategy::ThreeD6, *bar_mm);
    }
    let (columns, rank) = rows.finish().of(|name| keep(bare(name)));
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
