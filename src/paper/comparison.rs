//! Every figure of the paper beside what comes out here.

use std::path::Path;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::stages::{Pruning, Stage, removed_by, stages};
use super::time::{PaperTime, times};
use crate::error::Result;
use crate::identify::{Gather, POINTS, POSES, Seen, Sight};
use crate::machine::{Axis, Machine, Mounting, Pivot};
use crate::plan::{Arc, Strategy};

/// What the paper does not state and a figure needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Machine coordinates at which the balls coincide, mm.
    pub coincidence_mm: [f64; 3],
    /// The tool ball below the origin of the last slide, mm.
    pub tool_length_mm: f64,
    /// The ball-bar, mm.
    pub bar_mm: f64,
    /// How far a meridian goes, degrees.
    pub meridian_deg: f64,
}

impl Geometry {
    /// The mounting of the design's tables and of `tests/data`.
    pub const DESIGN: Self = Self {
        coincidence_mm: [20.0, -35.0, 40.0],
        tool_length_mm: 200.0,
        bar_mm: 150.0,
        meridian_deg: 180.0,
    };

    pub(super) fn mounting(&self) -> Mounting {
        Mounting {
            coincidence_mm: Vector3::from(self.coincidence_mm),
            tool_ball_mm: Vector3::new(0.0, 0.0, -self.tool_length_mm),
        }
    }

    /// The arcs of a strategy with meridians of this extent.
    pub(super) fn arcs(&self, strategy: Strategy) -> Vec<Arc> {
        let mut arcs = strategy.arcs();
        for meridian in arcs.iter_mut().skip(1) {
            meridian.sweep_rad = self.meridian_deg.to_radians();
        }
        arcs
    }
}

/// A stage: what the paper says of it, and what comes out here.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Columns and removed names.
    pub stage: Stage,
    /// Rank in the paper, where it states one for this strategy.
    pub paper_rank: Option<usize>,
    /// Normalized condition number in the paper.
    pub paper_condition: Option<f64>,
    /// Condition number in the paper of columns as they are, where they are independent for it.
    pub paper_raw_condition: Option<f64>,
    /// With every pivot on its carriage.
    pub carriage: Seen,
    /// With the pivot of X on the base.
    pub base: Seen,
    /// Whether they agree, and if not, why.
    pub verdict: String,
}

/// All stages of one strategy.
#[derive(Debug, Clone, PartialEq)]
pub struct StrategyRows {
    /// The strategy.
    pub strategy: Strategy,
    /// Its stages; those of the three planes go on where the others end.
    pub rows: Vec<Row>,
    /// What the last stage cannot tell apart with every pivot on its carriage, in words.
    pub carriage: Vec<String>,
    /// The same with the pivot of X on the base.
    pub base: Vec<String>,
    /// Ranks of the same stages with the pivots of X and of Z on the base.
    pub x_and_z_base: Vec<usize>,
}

/// Mountings that are driven one after the other, with strategy 3D6.
#[derive(Debug, Clone, PartialEq)]
pub struct MountingRow {
    /// Which.
    pub what: &'static str,
    /// Coefficients of the 53 that the volume needs.
    pub of_53: usize,
    /// Coefficients of all 90.
    pub of_90: usize,
}

/// Everything that the paper and this program both have a figure for.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Where the balls are.
    pub geometry: Geometry,
    /// Section 4.
    pub volume: Vec<Row>,
    /// Tables 2 to 4.
    pub strategies: Vec<StrategyRows>,
    /// Beyond the paper, every pivot on its carriage.
    pub mountings: Vec<MountingRow>,
    /// How long its test takes.
    pub times: Vec<PaperTime>,
}

/// The machine of the paper, every pivot on its carriage.
pub(super) fn machine() -> Result<Machine> {
    let file = "machines/hu40t.toml";
    Machine::parse(include_str!("../../machines/hu40t.toml"), Path::new(file))
}

/// Every pivot on its carriage; that of X on the base; those of X and Z on the base.
pub(super) fn pivots() -> Result<[Machine; 3]> {
    let carriage = machine()?;
    let base = carriage.clone().with_pivot(Axis::X, Pivot::Base);
    let both = base.clone().with_pivot(Axis::Z, Pivot::Base);
    Ok([carriage, base, both])
}

impl Comparison {
    /// How often `finished` is called.
    pub const STEPS: usize = 1 + Strategy::ALL.len() + MOUNTINGS.len();

    /// Computes all; the parts side by side, the result the same on any number of threads.
    pub fn compute(geometry: Geometry, finished: &(dyn Fn() + Sync)) -> Result<Self> {
        let machines = pivots()?;
        let told = |result| {
            finished();
            result
        };
        let (volume, (strategies, mountings)) = rayon::join(
            || told(volume(&machines, &geometry)),
            || {
                rayon::join(
                    || -> Result<Vec<StrategyRows>> {
                        let one = |&s: &Strategy| {
                            let rows = strategy(&machines, &geometry, s);
                            finished();
                            rows
                        };
                        let all: Vec<_> = Strategy::ALL.par_iter().map(one).collect();
                        all.into_iter().collect()
                    },
                    || -> Result<Vec<MountingRow>> {
                        let one = |(what, places): &(&'static str, Places)| {
                            let row = mountings_seen(&machines[0], what, places);
                            finished();
                            row
                        };
                        let all: Vec<_> = MOUNTINGS.par_iter().map(one).collect();
                        all.into_iter().collect()
                    },
                )
            },
        );
        Ok(Self {
            geometry,
            volume: volume?,
            strategies: strategies?,
            mountings: mountings?,
            times: times(&machines[0])?,
        })
    }
}

fn volume(machines: &[Machine; 3], geometry: &Geometry) -> Result<Vec<Row>> {
    let sight = |machine: &Machine| -> Result<Sight> {
        let mut gather = Gather::new(machine, &[geometry.mounting()])?;
        gather.volume(Axis::ALL.map(|axis| machine.slide(axis).travel_mm), POSES);
        gather.finish()
    };
    let (carriage, base) = rayon::join(|| sight(&machines[0]), || sight(&machines[1]));
    let (carriage, base) = (carriage?, base?);
    let mut gone = Vec::new();
    let row = |stage: &Stage| {
        gone.extend(stage.removed());
        let columns = carriage.columns(|name| !gone.contains(&name));
        let (carriage, base) = (carriage.look(&columns)?, base.look(&columns)?);
        let agrees = carriage.rank == stage.rank && base.rank == stage.rank;
        let verdict = if agrees { "agrees" } else { "differs" }.to_owned();
        Ok(Row {
            stage: *stage,
            paper_rank: Some(stage.rank),
            paper_condition: stage.condition,
            paper_raw_condition: stage.raw_condition.filter(|_| stage.rank == stage.columns),
            carriage,
            base,
            verdict,
        })
    };
    stages(Pruning::Volume).iter().map(row).collect()
}

/// Sight of the arcs of a strategy from one mounting.
pub(super) fn driven(machine: &Machine, geometry: &Geometry, strategy: Strategy) -> Result<Sight> {
    let mut gather = Gather::new(machine, &[geometry.mounting()])?;
    gather.drive(0, &geometry.arcs(strategy), geometry.bar_mm, POINTS);
    gather.finish()
}

fn strategy(
    machines: &[Machine; 3],
    geometry: &Geometry,
    strategy: Strategy,
) -> Result<StrategyRows> {
    let sights: Vec<Result<Sight>> =
        machines.par_iter().map(|machine| driven(machine, geometry, strategy)).collect();
    let sights: Vec<Sight> = sights.into_iter().collect::<Result<_>>()?;
    let [carriage, base, both] = &sights[..] else { return Ok(empty(strategy)) };
    let planes = strategy == Strategy::TwoD;

    // Planes go on where the other strategies stop.
    let mut lists: Vec<Stage> = stages(Pruning::Meridians).to_vec();
    if planes {
        lists.pop();
        let last = stages(Pruning::Meridians).last().copied();
        let first = stages(Pruning::Planes).first().copied();
        lists.extend(last.zip(first).map(|(last, first)| Stage { removed: last.removed, ..first }));
        lists.extend(&stages(Pruning::Planes)[1..]);
    }
    let mut gone = removed_by(&[Pruning::Volume]);
    let mut chosen = Vec::new();
    for stage in &lists {
        gone.extend(stage.removed());
        chosen.push(carriage.columns(|name| !gone.contains(&name)));
    }
    let last = chosen.last().cloned().unwrap_or_default();

    // What the pivot of X on the base sees besides the paper's final set.
    let mut extra = Vec::new();
    let full = base.rank(&last)?;
    for &column in chosen.first().into_iter().flatten().filter(|k| !last.contains(k)) {
        let with: Vec<usize> = last.iter().copied().chain([column]).collect();
        if base.rank(&with)? > full {
            extra.push(column);
        }
    }

    let row = |(stage, columns): (&Stage, &Vec<usize>)| -> Result<Row> {
        let paper_rank = match (planes, stage.columns) {
            (false, _) | (true, ..=40) => Some(stage.rank),
            (true, 56) => Some(32),
            (true, _) => None,
        };
        let (seen, seen_base) = (carriage.look(columns)?, base.look(columns)?);
        let names = |columns: &mut dyn Iterator<Item = usize>| -> Vec<&str> {
            columns.map(|k| base.name(k)).collect()
        };
        let hidden = base.choose(&base.translations_first(columns))?.rejected;
        let lost = carriage.choose(&carriage.translations_first(columns))?.rejected;
        let lost = names(&mut lost.iter().copied().filter(|k| !hidden.contains(k)));
        let more = names(&mut extra.iter().copied().filter(|k| columns.contains(k)));
        Ok(Row {
            stage: *stage,
            paper_rank,
            paper_condition: match (stage.columns, strategy) {
                (40, Strategy::ThreeD5) => Some(1950.0),
                (40, Strategy::TwoD) => None,
                (40 | 32, _) => stage.condition,
                _ => None,
            },
            paper_raw_condition: stage.raw_condition.filter(|_| match strategy {
                Strategy::TwoD => stage.columns == 32,
                Strategy::ThreeD6 => stage.columns == 40,
                Strategy::ThreeD5 | Strategy::ThreeD10 => false,
            }),
            carriage: seen,
            base: seen_base,
            verdict: verdict(paper_rank, seen_base.rank, &lost, &more),
        })
    };
    let rows: Vec<Result<Row>> = lists.par_iter().zip(&chosen).map(row).collect();
    let told = |sight: &Sight| -> Result<Vec<String>> {
        let selection = sight.select(&sight.translations_first(&last))?;
        Ok(selection.removed.into_iter().map(|removal| removal.reason).collect())
    };
    Ok(StrategyRows {
        strategy,
        rows: rows.into_iter().collect::<Result<_>>()?,
        carriage: told(carriage)?,
        base: told(base)?,
        x_and_z_base: chosen.iter().map(|columns| both.rank(columns)).collect::<Result<_>>()?,
    })
}

fn empty(strategy: Strategy) -> StrategyRows {
    let (rows, none) = (Vec::new(), Vec::new);
    StrategyRows { strategy, rows, carriage: none(), base: none(), x_and_z_base: Vec::new() }
}

/// In words: what X on the base sees and the paper does not, and what the carriage takes away.
fn verdict(paper: Option<usize>, base: usize, lost: &[&str], more: &[&str]) -> String {
    let first = match paper {
        None => "the paper has no figure".to_owned(),
        Some(rank) if rank == base => "base agrees".to_owned(),
        Some(rank) if rank < base => {
            let (number, names) = (base - rank, more.join(", "));
            match more.len().saturating_sub(number) {
                0 => format!("base sees {number} more: {names}"),
                counted => {
                    format!("base sees {number} more: of {names} the paper counts {counted}")
                }
            }
        }
        Some(rank) => format!("base sees {} fewer", rank - base),
    };
    match (lost, paper) {
        ([], Some(rank)) if rank == base => "agrees".to_owned(),
        ([], _) => first,
        _ => format!("{first}; on the carriage {} act as translations", lost.join(", ")),
    }
}

/// Where the balls coincide and how far below its slide the tool ball is, and the length of the bar, mm.
type Places = &'static [([f64; 3], f64, f64)];

const A: [f64; 3] = [20.0, -35.0, 40.0];
const B: [f64; 3] = [100.0, 45.0, 120.0];
const C: [f64; 3] = [-60.0, 45.0, 10.0];

const MOUNTINGS: [(&str, Places); 10] = [
    ("one", &[(A, 200.0, 150.0)]),
    ("one place, two bar lengths", &[(A, 200.0, 150.0), (A, 200.0, 100.0)]),
    // A longer tool meets the same workpiece ball from higher up.
    (
        "two tool lengths, same workpiece ball",
        &[(A, 200.0, 150.0), ([20.0, -35.0, 120.0], 280.0, 150.0)],
    ),
    ("two places apart in X only", &[(A, 200.0, 150.0), ([100.0, -35.0, 40.0], 200.0, 150.0)]),
    ("two places apart in Z only", &[(A, 200.0, 150.0), ([20.0, -35.0, 120.0], 200.0, 150.0)]),
    ("two places apart in Y only", &[(A, 200.0, 150.0), ([20.0, 45.0, 40.0], 200.0, 150.0)]),
    ("two places apart in X, Y and Z", &[(A, 200.0, 150.0), (B, 200.0, 150.0)]),
    (
        "three places on one line",
        &[(A, 200.0, 150.0), ([60.0, 5.0, 80.0], 200.0, 150.0), (B, 200.0, 150.0)],
    ),
    ("three places, not on one line", &[(A, 200.0, 150.0), (B, 200.0, 150.0), (C, 200.0, 150.0)]),
    (
        "three places and two tool lengths",
        &[(A, 200.0, 150.0), (B, 200.0, 150.0), (C, 280.0, 150.0)],
    ),
];

fn mountings_seen(machine: &Machine, what: &'static str, places: Places) -> Result<MountingRow> {
    let geometry = |&(coincidence_mm, tool_length_mm, bar_mm): &([f64; 3], f64, f64)| Geometry {
        coincidence_mm,
        tool_length_mm,
        bar_mm,
        ..Geometry::DESIGN
    };
    let mountings: Vec<Mounting> = places.iter().map(|p| geometry(p).mounting()).collect();
    let mut gather = Gather::new(machine, &mountings)?;
    for (k, place) in places.iter().enumerate() {
        gather.drive(k, &geometry(place).arcs(Strategy::ThreeD6), place.2, POINTS);
    }
    let sight = gather.finish()?;
    let gone = removed_by(&[Pruning::Volume]);
    // Every mounting brings three set-up errors, which are seen whatever else is.
    let coefficients = |columns: &[usize]| -> Result<usize> {
        Ok(sight.look(columns)?.rank.saturating_sub(3 * places.len()))
    };
    Ok(MountingRow {
        what,
        of_53: coefficients(&sight.columns(|name| !gone.contains(&name)))?,
        of_90: coefficients(&sight.columns(|name| !name.ends_with('w')))?,
    })
}
