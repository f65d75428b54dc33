//! For any other control: corrections as a grid of vectors, and by axis and direction.
//!
//! `grid.csv` has the mean of both directions of every slide, as three-dimensional compensations take it; `axes.csv` has, by the slide and
//! its direction, all that hangs on one slide. They are two views of one machine: the grid holds what the mean of `axes.csv` holds and
//! the angles beside.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::asked::{Limits, Named, Written};
use super::lines::{lines, whole};
use super::points::{Asked, FINEST_MM};
use crate::compensate::tables::{Column, Grid, Tables, Ways};
use crate::compensate::wanted::Wanted;
use crate::error::Result;
use crate::machine::Axis;

const GRID: &str = "grid.csv";
const AXES: &str = "axes.csv";
const GRID_HEAD: &str = "x_mm,y_mm,z_mm,cx_um,cy_um,cz_um";
const AXES_HEAD: &str = "axis,at_mm,direction,cx_um,cy_um,cz_um";
/// Points along an axis.
pub(super) const MOST_POINTS: usize = 21;
/// What a smooth error needs.
const USUAL_POINTS: usize = 11;

pub(super) fn write(wanted: &Wanted, limits: &Limits) -> Written {
    let mut lost = Vec::new();
    let nodes = Axis::ALL.map(|over| {
        let [low, high] = wanted.range_mm(over);
        let parts =
            limits.step_mm.map_or(USUAL_POINTS - 1, |step| ((high - low) / step).ceil() as usize);
        let parts = parts.clamp(1, limits.most_points.clamp(2, MOST_POINTS) - 1);
        let asked = Asked { wanted, over, along: &Axis::ALL };
        if high <= low {
            return asked.points(vec![low], FINEST_MM, &mut lost);
        }
        let step_mm = (high - low) / parts as f64;
        let at = (0..=parts).map(|k| low + k as f64 * step_mm);
        asked.points(at.map(|at| (at * 1e4).round() / 1e4).collect(), step_mm, &mut lost)
    });
    let [x, y, z] = nodes.each_ref().map(|points| &points.at_mm);
    let mut grid = format!("{GRID_HEAD}\n");
    for z in z {
        for y in y {
            for x in x {
                let c = -1e3 * wanted.vector_mm(&Vector3::new(*x, *y, *z));
                let _ = writeln!(
                    grid,
                    "{x:.4},{y:.4},{z:.4},{:.4},{:.4},{:.4}",
                    c.x + 0.0,
                    c.y + 0.0,
                    c.z + 0.0
                );
            }
        }
    }
    let mut axes = format!("{AXES_HEAD}\n");
    for over in Axis::ALL {
        for (direction, sense) in [("+", 1.0), ("-", -1.0)] {
            let points = &nodes[over.index()];
            for at in &points.at_mm {
                let of =
                    |along: Axis| points.value(|at| wanted.error_mm(over, along, at, sense), *at);
                let c = Axis::ALL.map(|along| -1e3 * of(along) + 0.0);
                let _ = writeln!(
                    axes,
                    "{over},{at:.4},{direction},{:.4},{:.4},{:.4}",
                    c[0], c[1], c[2]
                );
            }
        }
    }
    Written {
        files: vec![(GRID.into(), grid), (AXES.into(), axes)],
        load: vec![
            "c is what is added to the commanded position, the error with the other sign, tool against workpiece, along the programmed positive directions, at machine coordinates.".into(),
            "Use one of both: the grid where the control interpolates vectors in space; the functions where it has tables by axis. By direction the grid knows nothing: the difference of both directions is in axes.csv.".into(),
        ],
        lost,
        ..Written::default()
    }
}

/// The grid, and of the functions what hangs on the direction.
pub(super) fn read(files: &[Named]) -> Result<Tables> {
    let mut tables = Tables::default();
    for file in files {
        match file.0.as_str() {
            GRID => tables.grid = Some(grid(file)?),
            AXES => axes(file, &mut tables)?,
            _ => return Err(whole(&file.0, "no file of the kind has this name")),
        }
    }
    Ok(tables)
}

fn grid(file: &Named) -> Result<Grid> {
    let mut at_mm: [Vec<f64>; 3] = Default::default();
    let mut nodes: Vec<[f64; 6]> = Vec::new();
    for (k, line) in lines(file)?.iter().enumerate() {
        if k == 0 {
            if line.text != GRID_HEAD {
                return Err(line.faulty(format!("the first line is `{GRID_HEAD}`")));
            }
            continue;
        }
        let numbers =
            line.text.split(',').map(|word| line.number(word)).collect::<Result<Vec<f64>>>()?;
        let Ok(node) = <[f64; 6]>::try_from(numbers) else {
            return Err(line.faulty("a line has six numbers"));
        };
        for (known, at) in at_mm.iter_mut().zip(node) {
            if known.last().is_none_or(|last| *last < at) {
                known.push(at);
            }
        }
        nodes.push(node);
    }
    let [nx, ny, nz] = [0, 1, 2].map(|k| at_mm[k].len());
    let in_order = nodes.iter().enumerate().all(|(k, node)| {
        let of = [k % nx, k / nx % ny, k / nx / ny];
        (0..3).all(|j| at_mm[j].get(of[j]).is_some_and(|at| (at - node[j]).abs() < 1e-9))
    });
    if nodes.is_empty() || nodes.len() != nx * ny * nz || !in_order {
        return Err(whole(&file.0, "it is no whole grid, X the fastest"));
    }
    let error_mm = nodes.iter().map(|node| Vector3::new(node[3], node[4], node[5]) * -1e-3);
    Ok(Grid { at_mm, error_mm: error_mm.collect() })
}

/// Corrections of one slide, um, with where they hold, mm, of both directions.
type Both = [Vec<(f64, [f64; 3])>; 2];

fn axes(file: &Named, tables: &mut Tables) -> Result<()> {
    let mut all: [Both; 3] = Default::default();
    for (k, line) in lines(file)?.iter().enumerate() {
        if k == 0 {
            if line.text != AXES_HEAD {
                return Err(line.faulty(format!("the first line is `{AXES_HEAD}`")));
            }
            continue;
        }
        let words: Vec<&str> = line.text.split(',').collect();
        let [axis, at, direction, x, y, z] = words[..] else {
            return Err(
                line.faulty("a line has an axis, a position, a direction and three numbers")
            );
        };
        let axis = Axis::ALL.into_iter().find(|of| of.to_string() == axis);
        let axis = axis.ok_or_else(|| line.faulty("the axis is X, Y or Z"))?;
        let way = match direction {
            "+" => 0,
            "-" => 1,
            _ => return Err(line.faulty("the direction is + or -")),
        };
        let at = line.number(at)?;
        let of = &mut all[axis.index()][way];
        if of.last().is_some_and(|(before, _)| *before >= at) {
            return Err(line.faulty("positions must ascend"));
        }
        of.push((at, [line.number(x)?, line.number(y)?, line.number(z)?]));
    }
    for (over, [plus, minus]) in Axis::ALL.into_iter().zip(all) {
        let same = plus.len() == minus.len()
            && plus.iter().zip(&minus).all(|(p, m)| (p.0 - m.0).abs() < 1e-9);
        if plus.is_empty() || !same {
            return Err(whole(
                &file.0,
                format!("both directions of {over} have not the same points"),
            ));
        }
        for along in Axis::ALL {
            let k = along.index();
            for (ways, sign) in [(Ways::Plus, -0.5e-3), (Ways::Minus, 0.5e-3)] {
                let halves = plus.iter().zip(&minus).map(|(p, m)| sign * (p.1[k] - m.1[k]));
                tables.columns.push(Column {
                    over,
                    along,
                    ways,
                    at_mm: plus.iter().map(|(at, _)| *at).collect(),
                    error_mm: halves.collect(),
                });
            }
        }
    }
    Ok(())
}
