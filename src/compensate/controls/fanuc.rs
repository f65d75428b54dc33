//! Fanuc 0i, 16i, 18i, 30i: stored pitch errors (3620 to 3624) and backlash (1851).
//!
//! The number at a point is the change of the correction over the interval that ends there, seen from the negative end, in
//! detection units times the magnification, -7 to 7; the correction is 0 at the point of the reference position. So the point of a
//! position `h` is `reference + h / interval`, and the smallest number belongs to the interval after the lowest position.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::asked::{Limits, Named, SMALLEST_MM, Written};
use super::lines::{Line, lines, whole};
use super::points::{Asked, Points};
use crate::compensate::tables::{Column, Tables, Ways};
use crate::compensate::wanted::Wanted;
use crate::error::{Error, Result};
use crate::machine::Axis;

const FILE: &str = "PITCH.TXT";
/// Points of an axis between the extremes, numbers in all, and the largest change.
pub(super) const MOST_POINTS: usize = 128;
const MOST_NUMBERS: usize = 1024;
const MOST_CHANGE: f64 = 7.0;
const MOST_MAGNIFICATION: usize = 100;
/// Parameter 3624 counts these, mm.
const INTERVAL_MM: f64 = 1e-3;
/// G10 reaches pitch numbers from here on.
const FIRST_NUMBER: usize = 10_000;

const HEAD: &str = "(PITCH ERRORS - RESULT OF A BALL-BAR TEST)\n(NOT CERTAIN - SIGN OF A NUMBER, G10 FORM, 15I NUMBERS ARE OTHERS)\n(CHECK ONE POINT BEFORE USE)\n";

pub(super) fn write(wanted: &Wanted, limits: &Limits) -> Result<Written> {
    let mut written = Written::default();
    let mut text = format!("%\n{HEAD}G10 L50\n");
    let mut next = 0;
    for axis in Axis::ALL {
        let p = axis.index() + 1;
        let of = |at: f64| wanted.error_mm(axis, axis, at, 0.0);
        if wanted.extent_mm(of, axis) >= SMALLEST_MM {
            let travel = wanted.machine().slide(axis).travel_mm;
            let asked = Asked { wanted, over: axis, along: &[axis] };
            let points = asked.even(travel, limits, &mut written.lost)?;
            let first = (points.at_mm[0] / points.step_mm).round();
            let count = points.at_mm.len();
            if next + count > MOST_NUMBERS || first > 0.0 || first + (count as f64) < 1.0 {
                return Err(Error::input(format!(
                    "{axis} has no reference position among its points, or the control no {} numbers",
                    next + count
                ))
                .hint("a larger `--step`, or a travel that has the zero of the machine in it"));
            }
            let reference = next + (-first) as usize;
            let (steps, magnification) = changes(&points, limits.unit_mm, of);
            if magnification > MOST_MAGNIFICATION {
                return Err(Error::input(format!(
                    "the error of {axis} is too steep for a pitch table"
                ))
                .hint("a smaller `--step`"));
            }
            if magnification > 1 {
                written.lost.push(format!(
                    "{axis} changes by more than {MOST_CHANGE} units over an interval: its numbers count {magnification} units each"
                ));
            }
            let interval = (points.step_mm / INTERVAL_MM).round();
            let _ = writeln!(
                text,
                "N3620 P{p} R{reference}\nN3621 P{p} R{}\nN3622 P{p} R{}\nN3623 P{p} R{magnification}\nN3624 P{p} R{interval}",
                next + 1,
                next + count - 1
            );
            for (k, step) in steps.iter().enumerate() {
                let _ = writeln!(text, "N{} R{}", FIRST_NUMBER + next + 1 + k, step + 0.0);
            }
            next += count;
        }
        let lost = (wanted.play_mm(axis) / limits.unit_mm).round();
        if lost != 0.0 {
            let _ = writeln!(text, "N1851 P{p} R{lost}");
        }
    }
    text.push_str("G11\n%\n");
    written.files = vec![(FILE.into(), text)];
    written.load = vec![
        "Save all parameters and the old pitch table first; set PWE (parameters may be written), load the file, or type its numbers: N is the parameter, or 10000 and the number of the point, P the axis, R the value.".into(),
        format!("The numbers are for a detection unit of {} um; `--unit` has another.", 1e3 * limits.unit_mm),
        "Set 3620 to 3624 of an axis without lines here to what they were, 1851 too; switch off and on and reference again.".into(),
    ];
    written.unsure = vec![
        "Sign: a positive number moves the axis farther in the positive direction; known by hearsay.".into(),
        "The form with G10 L50 and numbers from 10000 on is of newer controls, and not read in a manual; a 15i, as on some machines, has other parameters altogether.".into(),
        "Straightness and squareness have parameters (5711, 5761) whose form is not known: they are not written.".into(),
    ];
    Ok(written)
}

/// The changes of the correction from point to point in units of the magnification, which is the smallest that holds them.
fn changes(points: &Points, unit_mm: f64, error_mm: impl Fn(f64) -> f64) -> (Vec<f64>, usize) {
    let at_mm = points.at_mm.iter();
    let correction: Vec<f64> = at_mm.map(|at| -points.value(&error_mm, *at) / unit_mm).collect();
    let reference = points.at_mm.iter().position(|at| at.abs() < 1e-6).unwrap_or(0);
    let rounded = |magnification: usize| -> Vec<f64> {
        let whole: Vec<f64> = correction
            .iter()
            .map(|of| ((of - correction[reference]) / magnification as f64).round())
            .collect();
        whole.windows(2).map(|pair| pair[1] - pair[0]).collect()
    };
    let fits = |steps: &[f64]| steps.iter().all(|step| step.abs() <= MOST_CHANGE);
    let magnification = (1..=MOST_MAGNIFICATION).find(|m| fits(&rounded(*m)));
    let magnification = magnification.unwrap_or(MOST_MAGNIFICATION + 1);
    (rounded(magnification), magnification)
}

/// Parameters of an axis, by number.
type Parameters = BTreeMap<usize, f64>;

/// Reads a file back; the detection unit is that of the control.
pub(super) fn read(files: &[Named], unit_mm: f64) -> Result<Tables> {
    let mut tables = Tables::default();
    for file in files {
        if file.0 != FILE {
            return Err(whole(&file.0, "no file of this control has this name"));
        }
        let (axes, points) = words(file)?;
        for (axis, of) in Axis::ALL.into_iter().zip(axes) {
            if let Some(lost) = of.get(&1851) {
                tables.play_mm[axis.index()] = lost * unit_mm;
            }
            let table: Vec<f64> =
                (3620..=3624).filter_map(|number| of.get(&number).copied()).collect();
            match table[..] {
                [] => {}
                [reference, first, last, magnification, interval] => {
                    let whole_numbers = [reference, first, last, magnification, interval];
                    let natural = whole_numbers.iter().all(|n| n.fract() == 0.0 && *n >= 0.0);
                    let inside = first <= last
                        && reference + 1.0 >= first
                        && reference <= last
                        && last < MOST_NUMBERS as f64;
                    if !natural || !inside || interval == 0.0 {
                        return Err(whole(&file.0, format!("3620 to 3624 of {axis} cannot be")));
                    }
                    let count = (last - first) as usize + 2;
                    let mut sum = 0.0;
                    let mut of_point = vec![0.0];
                    for k in 1..count {
                        let number = first as usize + k - 1;
                        let step = points.get(&number).ok_or_else(|| {
                            whole(&file.0, format!("the point {number} of {axis} has no number"))
                        })?;
                        sum += step * magnification;
                        of_point.push(sum);
                    }
                    let low = first - 1.0 - reference;
                    let zero = of_point[(-low) as usize];
                    let at_mm = (0..count).map(|k| (low + k as f64) * interval * INTERVAL_MM);
                    let error_mm = of_point.iter().map(|of| -(of - zero) * unit_mm);
                    tables.columns.push(Column {
                        over: axis,
                        along: axis,
                        ways: Ways::Both,
                        at_mm: at_mm.collect(),
                        error_mm: error_mm.collect(),
                    });
                }
                _ => {
                    return Err(whole(
                        &file.0,
                        format!("3620 to 3624 of {axis} are not all there"),
                    ));
                }
            }
        }
    }
    Ok(tables)
}

/// Parameters of the three axes, and the numbers of points.
fn words(file: &Named) -> Result<([Parameters; 3], Parameters)> {
    let mut axes: [Parameters; 3] = Default::default();
    let mut points = Parameters::new();
    let (mut open, mut closed) = (false, false);
    for line in lines(file)? {
        match line.text.trim() {
            "%" | "" => {}
            text if text.starts_with('(') && text.ends_with(')') => {}
            "G10 L50" if !open => open = true,
            "G11" if open && !closed => closed = true,
            text if open && !closed => parameter(&line, text, &mut axes, &mut points)?,
            _ => return Err(line.faulty("it stands outside of G10 L50 and G11")),
        }
    }
    if closed { Ok((axes, points)) } else { Err(whole(&file.0, "it does not end with G11")) }
}

fn parameter(
    line: &Line,
    text: &str,
    axes: &mut [Parameters; 3],
    points: &mut Parameters,
) -> Result<()> {
    let faulty = || line.faulty("this is no line of a parameter: N, P of an axis, R");
    let words: Vec<&str> = text.split_whitespace().collect();
    let of = |word: &str, letter: char| word.strip_prefix(letter).map(str::to_owned);
    let (number, axis, value) = match words[..] {
        [n, p, r] => (of(n, 'N'), of(p, 'P'), of(r, 'R')),
        [n, r] => (of(n, 'N'), Some(String::new()), of(r, 'R')),
        _ => return Err(faulty()),
    };
    let (Some(number), Some(axis), Some(value)) = (number, axis, value) else {
        return Err(faulty());
    };
    let (number, value) = (line.whole(&number)?, line.number(&value)?);
    let twice = if axis.is_empty() {
        let point =
            number.checked_sub(FIRST_NUMBER).filter(|n| *n < MOST_NUMBERS).ok_or_else(faulty)?;
        if value.fract() != 0.0 || value.abs() > MOST_CHANGE {
            return Err(line
                .faulty(format!("a number of a point is whole, -{MOST_CHANGE} to {MOST_CHANGE}")));
        }
        points.insert(point, value).is_some()
    } else {
        let index = line.whole(&axis)?.checked_sub(1).filter(|k| *k < 3).ok_or_else(faulty)?;
        if !matches!(number, 1851 | 3620..=3624) || value.fract() != 0.0 {
            return Err(faulty());
        }
        axes[index].insert(number, value).is_some()
    };
    if twice { Err(line.faulty("it was said before")) } else { Ok(()) }
}
