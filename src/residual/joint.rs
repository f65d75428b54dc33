//! The fit of several effects at once, beside everything that the model spans.
//!
//! With the columns `c_j` of the effects outside of the fits' span, the amplitudes solve
//! `N a = r`, `N_ij = c'_i · c'_j`, `r_i = c'_i · e`. The numbers inside (a period, a time constant) follow
//! by Gauss-Newton with the derivative of the fitted effect as a further column (variable projection,
//! Kaufman 1975).

use rayon::prelude::*;

use super::data::{Column, Data, dot};
use super::element::Element;
use crate::solve::{Cholesky, Matrix};

/// Steps of Gauss-Newton; a good start takes three.
const MOST_STEPS: usize = 12;
/// A step that lowers the sum of squares by less than this share of the gain is the last.
const SETTLED: f64 = 1e-4;
/// What is added to the diagonal, as a share of a column's square: amplitudes that the model spans, such as some
/// orders of a ball's roundness, stay small instead of running away; of others this changes nothing.
const RIDGE: f64 = 1e-6;

/// Effects with everything that was estimated of them.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) elements: Vec<Element>,
    /// Amplitudes of each element, run after run where each has its own, mm and rad.
    pub(crate) amplitudes: Vec<Vec<f64>>,
    /// By how much they lower the sum of squares, mm².
    pub(crate) gain_mm2: f64,
    /// Inverse of the normal matrix over all amplitudes and then all numbers inside, per mm².
    pub(crate) inverse: Matrix,
    /// Largest part of a column's square that lies outside of what is spanned.
    pub(crate) seen: f64,
    /// Columns of the amplitudes, then those of the numbers inside.
    pub(crate) columns: Vec<Column>,
}

impl Fitted {
    /// Sum of the effects' columns with their amplitudes, outside of what the fits span, mm.
    pub(crate) fn effect(&self, data: &Data) -> Column {
        let mut sum: Column = data.blocks.iter().map(|b| vec![0.0; b.samples.len()]).collect();
        let amplitudes = self.amplitudes.iter().flatten();
        for (amplitude, column) in amplitudes.zip(&self.columns) {
            for (s, c) in sum.iter_mut().zip(column) {
                for (s, c) in s.iter_mut().zip(c) {
                    *s += amplitude * c;
                }
            }
        }
        data.projected(&sum)
    }

    /// Gives the residuals back what the effects had taken out of them, as far as the model does not follow.
    pub(crate) fn give_back(&self, data: &mut Data) {
        let mut sum: Column = data.blocks.iter().map(|b| vec![0.0; b.samples.len()]).collect();
        for (element, amplitudes) in self.elements.iter().zip(&self.amplitudes) {
            for (amplitude, column) in amplitudes.iter().zip(element.columns(data)) {
                for (sum, column) in sum.iter_mut().zip(column) {
                    for (s, c) in sum.iter_mut().zip(column) {
                        *s += amplitude * c;
                    }
                }
            }
        }
        let effects = data.projected(&sum);
        for (block, effect) in data.blocks.iter_mut().zip(effects) {
            for (e, c) in block.residual_mm.iter_mut().zip(effect) {
                *e += c;
            }
        }
        data.accept(&[]);
    }

    /// What is left of the residuals with the effects besides what has been accepted, mm.
    pub(crate) fn left_mm(&self, data: &Data) -> Column {
        let mut left = data.left_mm.clone();
        for (left, effect) in left.iter_mut().zip(self.outside(data)) {
            left.iter_mut().zip(effect).for_each(|(e, c)| *e -= c);
        }
        left
    }

    /// The effects outside of what the fits span and of what has been accepted, mm.
    pub(crate) fn outside(&self, data: &Data) -> Column {
        let mut trace = self.effect(data);
        for unit in &data.span {
            let along = product(unit, &trace);
            for (u, c) in unit.iter().zip(&mut trace) {
                c.iter_mut().zip(u).for_each(|(c, u)| *c -= along * u);
            }
        }
        trace
    }

    /// One of the elements alone, as it was fitted with the others.
    pub(crate) fn part(&self, element: usize) -> Self {
        let first = self.first_index(element);
        let own = &self.columns[first..first + self.amplitudes[element].len()];
        Self {
            elements: vec![self.elements[element].clone()],
            amplitudes: vec![self.amplitudes[element].clone()],
            columns: own.to_vec(),
            ..self.clone()
        }
    }

    /// Where the number inside of an element stands in `inverse`.
    pub(crate) fn inner_index(&self, element: usize) -> Option<usize> {
        self.elements[element].free()?;
        let amplitudes: usize = self.amplitudes.iter().map(Vec::len).sum();
        let before = self.elements[..element].iter().filter(|e| e.free().is_some()).count();
        Some(amplitudes + before)
    }

    /// Where the amplitudes of an element begin in `inverse`.
    pub(crate) fn first_index(&self, element: usize) -> usize {
        self.amplitudes[..element].iter().map(Vec::len).sum()
    }
}

/// Columns with their products.
#[derive(Debug, Default)]
pub(crate) struct System {
    columns: Vec<Column>,
    /// `Q^T c` of each column in each block.
    along: Vec<Vec<Vec<f64>>>,
    /// Products with the accepted columns.
    accepted: Vec<Vec<f64>>,
    normal: Matrix,
    common: Vec<f64>,
    /// Products of the columns as they are, row after row of the lower triangle.
    products: Vec<Vec<f64>>,
}

impl System {
    /// The columns of an element.
    pub(crate) fn of(data: &Data, element: &Element) -> Self {
        let mut system = Self::default();
        system.push(data, element.columns(data));
        system
    }

    /// The largest part of a column's square that lies outside of what is spanned.
    pub(crate) fn seen(&self) -> f64 {
        let share = |k: usize| self.normal[(k, k)] / self.products[k][k].max(f64::MIN_POSITIVE);
        (0..self.columns.len()).map(share).fold(0.0, f64::max)
    }

    /// What the columns explain of what is left now, mm², wherever the numbers inside are.
    pub(crate) fn gain_mm2(&self, data: &Data) -> Option<f64> {
        let n = self.columns.len();
        let accepted: Vec<Vec<f64>> = self
            .columns
            .iter()
            .map(|column| data.span.iter().map(|unit| product(unit, column)).collect())
            .collect();
        let alone = Matrix::from_fn(n, n, |i, k| {
            let pairs = self.along[i].iter().zip(&self.along[k]);
            let spanned: f64 = pairs.map(|(a, b)| dot(a, b)).sum();
            let both = self.products[i.max(k)][i.min(k)];
            let ridge = if i == k { RIDGE * both } else { 0.0 };
            both + ridge - spanned - dot(&accepted[i], &accepted[k])
        });
        let common: Vec<f64> =
            self.columns.iter().map(|column| product(column, &data.left_mm)).collect();
        Some(dot(&Cholesky::of(&alone)?.solve(&common), &common))
    }

    /// Adds columns.
    fn push(&mut self, data: &Data, columns: Vec<Column>) {
        let first = self.columns.len();
        let by_block: Vec<Vec<Vec<f64>>> = data
            .blocks
            .par_iter()
            .enumerate()
            .map(|(index, block)| {
                let of_block: Vec<&[f64]> = columns.iter().map(|c| c[index].as_slice()).collect();
                block.along(&of_block)
            })
            .collect();
        for (k, column) in columns.into_iter().enumerate() {
            self.along.push(by_block.iter().map(|block| block[k].clone()).collect());
            self.accepted.push(data.span.iter().map(|unit| product(unit, &column)).collect());
            self.common.push(product(&column, &data.left_mm));
            self.columns.push(column);
        }
        let n = self.columns.len();
        let mut normal = Matrix::zeros(n, n);
        for i in 0..n {
            if i >= first {
                let before = self.columns[..=i].iter();
                let row = before.map(|other| product(&self.columns[i], other)).collect();
                self.products.push(row);
            }
            for k in 0..=i {
                normal[(i, k)] = if i < first {
                    self.normal[(i, k)]
                } else {
                    let both = self.products[i][k];
                    let pairs = self.along[i].iter().zip(&self.along[k]);
                    let spanned: f64 = pairs.map(|(a, b)| dot(a, b)).sum();
                    both - spanned - dot(&self.accepted[i], &self.accepted[k])
                };
                normal[(k, i)] = normal[(i, k)];
            }
        }
        self.normal = normal;
    }

    fn part(&self, keep: usize) -> (Matrix, &[f64]) {
        let normal = Matrix::from_fn(keep, keep, |i, k| {
            match self.normal[(i, k)] {
                // What nothing tells, such as the phase of a run that takes no part, stays zero.
                0.0 if i == k => 1.0,
                value if i == k => value + RIDGE * self.products[k][k],
                value => value,
            }
        });
        (normal, &self.common[..keep])
    }
}

/// Products of columns that are both there.
fn product(a: &Column, b: &Column) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// Fits effects beside what has been accepted; the numbers inside start from where they are.
///
/// `None` where the effects cannot be told from what is spanned, or from each other.
pub(crate) fn fit(data: &Data, elements: Vec<Element>) -> Option<Fitted> {
    fit_to(data, elements, &vec![true; data.blocks.len()])
}

/// The same with some of the repeats alone.
pub(crate) fn fit_to(data: &Data, elements: Vec<Element>, repeats: &[bool]) -> Option<Fitted> {
    let mut elements = elements;
    let mut best: Option<Fitted> = None;
    let mut shorter = 1.0;
    for _ in 0..MOST_STEPS {
        let mut of_elements: Vec<Vec<Column>> = elements.iter().map(|e| e.columns(data)).collect();
        for column in of_elements.iter_mut().flatten() {
            let out = column.iter_mut().zip(repeats).filter(|(_, takes_part)| !**takes_part);
            out.for_each(|(block, _)| block.clear());
        }
        let counts: Vec<usize> = of_elements.iter().map(Vec::len).collect();
        let mut system = System::default();
        system.push(data, of_elements.into_iter().flatten().collect());
        let linear = system.columns.len();
        let (normal, common) = system.part(linear);
        let amplitudes = Cholesky::of(&normal)?.solve(common);
        let gain_mm2 = dot(&amplitudes, common);
        let better = best.as_ref().is_none_or(|best| gain_mm2 > best.gain_mm2);
        if !better {
            // Back half the way to the best.
            shorter *= 0.5;
            let best = best.as_ref()?;
            if shorter < 0.1 {
                break;
            }
            elements = elements
                .iter()
                .zip(&best.elements)
                .map(|(now, best)| match (now.free(), best.free()) {
                    (Some(now), Some(at)) => best.with_free(0.5 * (now + at)),
                    _ => best.clone(),
                })
                .collect();
            continue;
        }
        let settled =
            best.as_ref().is_some_and(|best| gain_mm2 - best.gain_mm2 < SETTLED * gain_mm2);
        let seen = system.seen();
        let mut by_element = Vec::new();
        let mut inside = Vec::new();
        let mut first = 0;
        for (element, count) in elements.iter().zip(&counts) {
            let own = amplitudes[first..first + count].to_vec();
            if element.free().is_some() {
                inside.push(derivative(data, element, &own, &system.columns[first..first + count]));
            }
            by_element.push(own);
            first += count;
        }
        system.push(data, inside);
        let (normal, common) = system.part(system.columns.len());
        let cholesky = Cholesky::of(&normal)?;
        let step = cholesky.solve(common);
        best = Some(Fitted {
            elements: elements.clone(),
            amplitudes: by_element,
            gain_mm2,
            inverse: cholesky.inverse(),
            seen,
            columns: system.columns,
        });
        if settled || step.len() == linear {
            break;
        }
        let mut inner = step[linear..].iter();
        elements = elements
            .iter()
            .map(|element| match (element.free(), element.free().and_then(|_| inner.next())) {
                (Some(at), Some(step)) => {
                    let longest = element.long_step();
                    element.with_free(at + (shorter * step).clamp(-longest, longest))
                }
                _ => element.clone(),
            })
            .collect();
    }
    best
}

/// Derivative of a fitted effect with respect to the number inside.
fn derivative(data: &Data, element: &Element, amplitudes: &[f64], columns: &[Column]) -> Column {
    let at = element.free().unwrap_or(0.0);
    let step = element.small_step();
    let beside = element.with_free(at + step).columns(data);
    let mut sum: Column = vec![Vec::new(); data.blocks.len()];
    for ((amplitude, after), before) in amplitudes.iter().zip(&beside).zip(columns) {
        for (sum, (after, before)) in sum.iter_mut().zip(after.iter().zip(before)) {
            if before.is_empty() {
                continue;
            }
            sum.resize(after.len(), 0.0);
            for (s, (a, b)) in sum.iter_mut().zip(after.iter().zip(before)) {
                *s += amplitude * (a - b) / step;
            }
        }
    }
    sum
}
