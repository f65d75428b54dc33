//! Which geometry would give the paper's condition numbers? It states neither the mounting nor the length
//! of the tool nor the extent of its meridians.

use rayon::prelude::*;

use super::comparison::{Geometry, pivots};
use super::stages::{Pruning, Stage, removed_by, stages};
use crate::error::Result;
use crate::identify::{Gather, POINTS, POSES, Sight};
use crate::machine::Machine;
use crate::plan::Strategy;

/// The paper's normalized condition numbers of 2D, 3D5, 3D6 and 3D10, in this order.
const PAPER: [f64; 4] = [2801.0, 1950.0, 1948.0, 1948.0];
/// The same of the volume, with 59 and 56 columns.
const PAPER_VOLUME: [f64; 2] = [387.0, 108.41];
/// Mirrored geometries differ by rounding only; the first of them stays.
const BETTER: f64 = 1.0 - 1e-6;
/// Poses while searching.
const COARSE_POSES: usize = 400;
/// Small steps of a volume differ by less than so few poses scatter.
const FINE_POSES: usize = 2000;
/// Points of an arc while searching; the figures of the result come from the full number.
const COARSE_POINTS: usize = 60;

/// A geometry with its condition numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Mounting, tool and meridians.
    pub geometry: Geometry,
    /// Scaled condition numbers of 2D at 32 columns and of 3D5, 3D6 and 3D10 at 40.
    pub conditions: [f64; 4],
    /// The largest factor between one of them and the paper's.
    pub worst_factor: f64,
}

/// A working volume with its condition numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundVolume {
    /// Lowest and highest machine coordinate of X, Y and Z, mm.
    pub range_mm: [[f64; 2]; 3],
    /// The tool ball below the origin of the last slide, mm.
    pub tool_length_mm: f64,
    /// Scaled condition numbers at 59 and at 56 columns.
    pub conditions: [f64; 2],
    /// The largest factor between one of them and the paper's.
    pub worst_factor: f64,
}

/// What a search has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// For the volume.
    pub volume: FoundVolume,
    /// For the bar, meridians over 180 degrees and over 360.
    pub bar: [Found; 2],
}

fn volume_of(
    machine: &Machine,
    range_mm: [[f64; 2]; 3],
    tool_length_mm: f64,
    poses: usize,
) -> Result<FoundVolume> {
    let list = stages(Pruning::Volume);
    let (before, last) = list.split_at(list.len() - 1);
    let gone: Vec<&str> = before.iter().flat_map(Stage::removed).collect();
    let last: Vec<&str> = last.iter().flat_map(Stage::removed).collect();
    let mounting = Geometry { tool_length_mm, ..Geometry::DESIGN }.mounting();
    let mut gather = Gather::without(machine, &[mounting], &gone)?;
    gather.volume(range_mm, poses);
    let sight = gather.finish()?;
    let conditions = [
        sight.full_condition(&sight.columns(|_| true))?,
        sight.full_condition(&sight.columns(|name| !last.contains(&name)))?,
    ];
    let worst_factor = worst(&conditions, &PAPER_VOLUME);
    Ok(FoundVolume { range_mm, tool_length_mm, conditions, worst_factor })
}

fn worst(ours: &[f64], paper: &[f64]) -> f64 {
    ours.iter().zip(paper).map(|(a, b)| (a / b).max(b / a)).fold(1.0, f64::max)
}

/// Half widths and centres of X, Y and Z, and tool lengths, mm.
fn volumes() -> Vec<([[f64; 2]; 3], f64)> {
    let mut grid = Vec::new();
    for half in [100.0, 200.0, 280.0] {
        for tool in [100.0, 200.0, 300.0, 400.0] {
            for x in [0.0, 0.5, 1.0] {
                for y in [0.0, 0.5, 1.0] {
                    for z in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                        let range = |share: f64| [(share - 1.0) * half, (share + 1.0) * half];
                        grid.push(([range(x), range(y), range(z)], tool));
                    }
                }
            }
        }
    }
    grid
}

fn search_volume(base: &Machine, finished: &(dyn Fn() + Sync)) -> Result<FoundVolume> {
    let all: Vec<Result<FoundVolume>> = volumes()
        .into_par_iter()
        .map(|(range_mm, tool)| {
            let found = volume_of(base, range_mm, tool, COARSE_POSES);
            finished();
            found
        })
        .collect();
    let all = all.into_iter().collect::<Result<Vec<_>>>()?;
    let best = all.iter().skip(1).fold(all[0], |best, found| {
        if found.worst_factor < best.worst_factor * BETTER { *found } else { best }
    });
    let mut best = volume_of(base, best.range_mm, best.tool_length_mm, FINE_POSES)?;
    for step_mm in [50.0, 25.0, 10.0] {
        for _ in 0..8 {
            let near: Vec<Result<FoundVolume>> = neighbouring_volumes(&best, step_mm)
                .into_par_iter()
                .map(|(range_mm, tool)| volume_of(base, range_mm, tool, FINE_POSES))
                .collect();
            let before = best.worst_factor;
            for candidate in near {
                let candidate = candidate?;
                if candidate.worst_factor < best.worst_factor * BETTER {
                    best = candidate;
                }
            }
            if best.worst_factor >= before {
                break;
            }
        }
    }
    volume_of(base, best.range_mm, best.tool_length_mm, POSES)
}

/// Moved along one axis, wider or narrower along one axis, or with another tool.
fn neighbouring_volumes(at: &FoundVolume, step_mm: f64) -> Vec<([[f64; 2]; 3], f64)> {
    let mut near = Vec::new();
    for step_mm in [-step_mm, step_mm] {
        for axis in 0..3 {
            for shares in [[1.0, 1.0], [-1.0, 1.0]] {
                let mut range_mm = at.range_mm;
                for (limit, share) in range_mm[axis].iter_mut().zip(shares) {
                    *limit += share * step_mm;
                }
                near.push((range_mm, at.tool_length_mm));
            }
        }
        near.push((at.range_mm, at.tool_length_mm + step_mm));
    }
    near.retain(|(range_mm, tool)| {
        *tool >= 50.0 && range_mm.iter().all(|[low, high]| high - low >= 150.0)
    });
    near
}

fn of(machine: &Machine, geometry: Geometry, points: usize) -> Result<Found> {
    let three = removed_by(&[Pruning::Volume, Pruning::Meridians]);
    let two = removed_by(&[Pruning::Planes]);
    let mut conditions = [0.0; 4];
    for (condition, strategy) in conditions.iter_mut().zip(Strategy::ALL) {
        let mut gather = Gather::without(machine, &[geometry.mounting()], &three)?;
        gather.drive(0, &geometry.arcs(strategy), geometry.bar_mm, points);
        let sight: Sight = gather.finish()?;
        let planes = strategy == Strategy::TwoD;
        let columns = sight.columns(|name| !(planes && two.contains(&name)));
        *condition = sight.full_condition(&columns)?;
    }
    let worst_factor = worst(&conditions, &PAPER);
    Ok(Found { geometry, conditions, worst_factor })
}

/// The geometries that are tried first.
fn grid() -> Vec<Geometry> {
    let mut grid = Vec::new();
    for meridian_deg in [180.0, 360.0] {
        for tool_length_mm in [100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0] {
            for x in [0.0, 75.0, 150.0] {
                for y in [0.0, 75.0, 150.0] {
                    for z in [-200.0, -100.0, 0.0, 100.0, 200.0, 300.0] {
                        let coincidence_mm = [x, y, z];
                        let bar_mm = 150.0;
                        let at = Geometry { coincidence_mm, tool_length_mm, bar_mm, meridian_deg };
                        grid.push(at);
                    }
                }
            }
        }
    }
    grid
}

/// Searches the grid, then around its best with ever smaller steps; `finished` is called after each
/// geometry of the two grids. Everything has the pivot of X on the base.
pub fn search(finished: &(dyn Fn() + Sync)) -> Result<Nearest> {
    let [_, base, _] = pivots()?;
    Ok(Nearest { volume: search_volume(&base, finished)?, bar: search_bar(&base, finished)? })
}

/// How often [`search`] calls `finished`.
pub fn search_steps() -> usize {
    volumes().len() + grid().len()
}

/// One result for meridians over 180 degrees and one for whole circles.
fn search_bar(base: &Machine, finished: &(dyn Fn() + Sync)) -> Result<[Found; 2]> {
    let all: Vec<Result<Found>> = grid()
        .into_par_iter()
        .map(|geometry| {
            let found = of(base, geometry, COARSE_POINTS);
            finished();
            found
        })
        .collect();
    let all = all.into_iter().collect::<Result<Vec<Found>>>()?;
    let mut best = [all[0], all[all.len() - 1]];
    for found in all {
        let of_extent = &mut best[usize::from(found.geometry.meridian_deg > 180.0)];
        if found.worst_factor < of_extent.worst_factor * BETTER {
            *of_extent = found;
        }
    }
    for found in &mut best {
        for step_mm in [40.0, 20.0, 10.0, 5.0] {
            for _ in 0..8 {
                let near: Vec<Geometry> = neighbours(found.geometry, step_mm);
                let near: Vec<Result<Found>> =
                    near.into_par_iter().map(|at| of(base, at, COARSE_POINTS)).collect();
                let before = found.worst_factor;
                for candidate in near {
                    let candidate = candidate?;
                    if candidate.worst_factor < found.worst_factor * BETTER {
                        *found = candidate;
                    }
                }
                if found.worst_factor >= before {
                    break;
                }
            }
        }
    }
    for found in &mut best {
        *found = of(base, found.geometry, POINTS)?;
    }
    Ok(best)
}

fn neighbours(at: Geometry, step_mm: f64) -> Vec<Geometry> {
    let mut near = Vec::new();
    for step_mm in [-step_mm, step_mm] {
        for axis in 0..3 {
            let mut moved = at;
            moved.coincidence_mm[axis] += step_mm;
            near.push(moved);
        }
        near.push(Geometry { tool_length_mm: at.tool_length_mm + step_mm, ..at });
    }
    near
}
