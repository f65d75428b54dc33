//! Least squares in blocks: unknowns that all blocks share, and some that each has for itself.
//!
//! Runs share the machine; each has times of its own. With `y_b` the own unknowns of block `b` and `x` the shared ones,
//! the rows of a block fold into
//!
//! ```text
//! [ J_b  K_b ]       [ T_b  C_b ] [ y_b ]   [ d_b ]
//! [          ] = Q_b [          ] [     ] = [     ]
//! [          ]       [  0   S_b ] [  x  ]   [ f_b ]
//! ```
//!
//! so `x` answers to the rows `S_b` of all blocks alone, and then
//!
//! ```text
//! y_b = T_b^-1 (d_b - C_b x) = T_b^-1 d_b - H_b x,    H_b = T_b^-1 C_b
//! ```
//!
//! Work and memory are linear in the number of blocks; one triangle of all
//! unknowns takes the cube and the square of it.

use super::bordered_solution::{BorderedSolution, Elimination, Unknowns};
use super::choice::Choice;
use super::matrix::{Matrix, norm};
use super::spectrum::{Spectrum, Truncation, VANISHED};
use super::triangle::Triangle;
use super::tsqr::Tsqr;
use super::vector::dot;
use crate::Result;

/// Rows of all blocks, with what each has for itself taken out of what they share.
#[derive(Debug, Clone)]
pub struct Bordered {
    blocks: Vec<Block>,
    /// Rows about the shared unknowns alone.
    known: Triangle,
    /// The shared unknowns, for all rows.
    shared: Triangle,
    /// Norms of the columns of the shared unknowns before anything was taken out.
    norms: Vec<f64>,
}

/// One block.
#[derive(Debug, Clone)]
struct Block {
    /// Own unknowns first.
    triangle: Triangle,
    elimination: Elimination,
    /// `T^-1 d`.
    direct: Vec<f64>,
}

impl Block {
    fn new(triangle: Triangle, own: usize) -> Self {
        let (r, shared) = (&triangle.r, triangle.columns() - own);
        let inverse = inverse_of_triangle(r, own);
        let border = Matrix::from_fn(own, shared, |i, k| r[(i, own + k)]);
        let ratio = inverse.times(&border);
        let direct = inverse.times_vector(&triangle.q_t_rhs[..own]);
        Self { triangle, elimination: Elimination { inverse, ratio }, direct }
    }

    fn own(&self) -> usize {
        self.direct.len()
    }
}

/// The inverse of the first `n` columns of an upper triangle. A column of which nothing is left beside those before it
/// is not seen: its row and its column are zero.
fn inverse_of_triangle(r: &Matrix, n: usize) -> Matrix {
    let mut inverse = Matrix::zeros(n, n);
    let seen = |k: usize| {
        let whole = norm((0..=k).map(|i| r[(i, k)]));
        r[(k, k)].abs() > VANISHED * whole
    };
    for k in (0..n).filter(|&k| seen(k)) {
        inverse[(k, k)] = r[(k, k)].recip();
        for i in (0..k).rev() {
            let diagonal = inverse[(i, i)];
            let sum: f64 = (i + 1..=k).map(|j| r[(i, j)] * inverse[(j, k)]).sum();
            inverse[(i, k)] = -diagonal * sum;
        }
    }
    inverse
}

impl Bordered {
    /// From the triangle of each block, its own unknowns first, so many of them, and rows about the shared unknowns
    /// alone.
    ///
    /// # Errors
    /// When squares leave the range of numbers.
    ///
    /// # Panics
    /// If a block has another number of shared unknowns.
    pub fn new(blocks: Vec<(usize, Triangle)>, known: Triangle) -> Result<Self> {
        let blocks = blocks.into_iter().map(|(own, triangle)| Block::new(triangle, own)).collect();
        Self::of_blocks(blocks, known)
    }

    fn of_blocks(blocks: Vec<Block>, known: Triangle) -> Result<Self> {
        let count = known.columns();
        let mut rows = Tsqr::new(count);
        let mut squares = vec![Vec::new(); count];
        for Block { triangle, direct, .. } in &blocks {
            let own = direct.len();
            assert_eq!(triangle.columns() - own, count, "blocks share the same unknowns");
            for i in own..own + count {
                rows.push(&triangle.r.row(i)[own..], triangle.q_t_rhs[i]);
            }
            rows.push(&vec![0.0; count], triangle.residual_norm);
            let norms = triangle.r.column_norms();
            squares.iter_mut().zip(&norms[own..]).for_each(|(of, norm)| of.push(*norm));
        }
        rows.push_triangle(&known);
        squares.iter_mut().zip(known.r.column_norms()).for_each(|(of, norm)| of.push(norm));
        let all = blocks.iter().map(|block| block.triangle.rows).sum::<usize>() + known.rows;
        let shared = Triangle { rows: all, ..rows.finish()? };
        let norms = squares.iter().map(|of| norm(of.iter().copied())).collect();
        Ok(Self { blocks, known, shared, norms })
    }

    /// The same with more known beforehand about own unknowns: block, unknown, value and its standard deviation.
    ///
    /// # Errors
    /// When squares leave the range of numbers.
    pub fn with_priors(&self, priors: &[(usize, usize, f64, f64)]) -> Result<Self> {
        let mut blocks = self.blocks.clone();
        for &(block, unknown, value, sigma) in priors {
            let block = &mut blocks[block];
            let mut rows = Tsqr::of(&block.triangle);
            rows.push_prior(unknown, value, sigma);
            *block = Block::new(rows.finish()?, block.own());
        }
        Self::of_blocks(blocks, self.known.clone())
    }

    /// The same with more rows about the shared unknowns alone.
    ///
    /// # Errors
    /// When squares leave the range of numbers.
    pub fn with_known(self, known: &Triangle) -> Result<Self> {
        let mut rows = Tsqr::of(&self.known);
        rows.push_triangle(known);
        Self::of_blocks(self.blocks, rows.finish()?)
    }

    /// The shared unknowns, with the own ones free to follow.
    pub fn shared(&self) -> &Triangle {
        &self.shared
    }

    /// Norms of the columns of the shared unknowns where the own ones stand still, in the units of the columns.
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// How many rows, priors included.
    pub fn rows(&self) -> usize {
        self.shared.rows
    }

    /// The norm of the right-hand side, in its unit.
    pub fn rhs_norm(&self) -> f64 {
        let own = self.blocks.iter().flat_map(|of| of.triangle.q_t_rhs[..of.own()].iter().copied());
        norm(own.chain([self.shared.rhs_norm()]))
    }

    /// `|J x|`, in the unit of the right-hand side.
    pub fn change(&self, unknowns: &Unknowns) -> f64 {
        let x = &unknowns.shared;
        let of_block = |(block, own): (&Block, &Vec<f64>)| {
            let count = own.len();
            let row = |i: usize| {
                let (left, right) = block.triangle.r.row(i).split_at(count);
                dot(left, own) + dot(right, x)
            };
            norm((0..count).map(row))
        };
        let shared = self.shared.r.times_vector(x);
        norm(
            self.blocks
                .iter()
                .zip(&unknowns.own)
                .map(of_block)
                .chain([norm(shared.iter().copied())]),
        )
    }

    /// Which shared unknowns to keep, as [`Triangle::choose`] has it, with the own ones free to follow.
    ///
    /// # Errors
    /// When singular values cannot be computed.
    pub fn choose(
        &self,
        order: &[usize],
        references: &[f64],
        truncation: Truncation,
    ) -> Result<Choice> {
        self.shared.choose_scaled(order, &self.norms, references, truncation)
    }

    /// The least-squares solution over the directions of the shared unknowns that a truncation keeps; `references` as in
    /// [`Spectrum::with_references`].
    ///
    /// Shared unknowns are scaled by their [`norms`](Self::norms): what own unknowns imitate is not blown up.
    ///
    /// # Errors
    /// When the singular values cannot be computed.
    pub fn solve(&self, references: &[f64], truncation: Truncation) -> Result<BorderedSolution> {
        let spectrum = Spectrum::with_norms(&self.shared, &self.norms, references)?;
        let shared = spectrum.solve(truncation);
        let own = |block: &Block| {
            let follows = block.elimination.ratio.times_vector(shared.x());
            block.direct.iter().zip(follows).map(|(direct, follows)| direct - follows).collect()
        };
        let own = self.blocks.iter().map(own).collect();
        let unknowns = Unknowns { shared: shared.x().to_vec(), own };
        let eliminations = self.blocks.iter().map(|block| block.elimination.clone()).collect();
        Ok(BorderedSolution { shared, unknowns, eliminations })
    }
}

#[cfg(test)]
mod tests {
    use super::super::bordered_solution::BorderedCovariance;
    use super::*;
    use crate::solve::solve;

    /// Three blocks with two, one and no own unknowns, three shared ones, and a prior on one of these.
    const OWN: [usize; 3] = [2, 1, 0];
    const SHARED: usize = 3;
    const TOTAL: usize = 6;

    fn row(block: usize, i: usize) -> ([f64; TOTAL], f64) {
        let first: usize = SHARED + OWN[..block].iter().sum::<usize>();
        let wave = |k: usize| (0.31 * ((i + 17 * block) * (k + 1)) as f64 + block as f64).cos();
        let mut row = [0.0; TOTAL];
        for (k, value) in row.iter_mut().enumerate() {
            if k < SHARED || (first..first + OWN[block]).contains(&k) {
                *value = wave(k) + if k < SHARED { 0.4 * wave(first) } else { 0.0 };
            }
        }
        (row, (0.7 * (i + block) as f64).sin())
    }

    fn own_first(row: &[f64; TOTAL], block: usize) -> Vec<f64> {
        let first: usize = SHARED + OWN[..block].iter().sum::<usize>();
        [&row[first..first + OWN[block]], &row[..SHARED]].concat()
    }

    fn both() -> (Bordered, Triangle, Vec<Triangle>) {
        let mut whole = Tsqr::new(TOTAL);
        let mut blocks = Vec::new();
        for (block, own) in OWN.into_iter().enumerate() {
            let mut of_block = Tsqr::new(own + SHARED);
            for i in 0..60 {
                let (row, rhs) = row(block, i);
                whole.push(&row, rhs);
                of_block.push(&own_first(&row, block), rhs);
            }
            blocks.push((own, of_block.finish().unwrap()));
        }
        whole.push_prior(1, 0.5, 0.1);
        let mut known = Tsqr::new(SHARED);
        known.push_prior(1, 0.5, 0.1);
        let filtered = blocks.iter().map(|(_, triangle)| triangle.clone()).collect();
        let bordered = Bordered::new(blocks, known.finish().unwrap()).unwrap();
        (bordered, whole.finish().unwrap(), filtered)
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} is not {b}");
    }

    /// Block by block as in one piece: unknowns, residual, both covariances.
    #[test]
    fn blocks_agree_with_one_problem_of_all_unknowns() {
        let (bordered, whole, _) = both();
        let all = Truncation::Relative(1e-12);
        let (of_blocks, of_all) =
            (bordered.solve(bordered.norms(), all).unwrap(), solve(&whole, all).unwrap());
        let unknowns = of_blocks.unknowns();
        let flat: Vec<f64> = [unknowns.shared.clone(), unknowns.own.concat()].concat();
        flat.iter().zip(of_all.x()).for_each(|(a, b)| near(*a, *b));
        near(of_blocks.shared().residual_norm(), of_all.residual_norm());
        near(bordered.rhs_norm(), whole.rhs_norm());
        assert_eq!(bordered.rows(), whole.rows());
        let change = whole.r().times_vector(of_all.x());
        near(bordered.change(unknowns), norm(change.into_iter()));
        bordered.norms().iter().zip(whole.r().column_norms()).for_each(|(a, b)| near(*a, b));

        let covariance = of_blocks.covariance_unscaled();
        let expected = of_all.covariance_unscaled();
        agree(&covariance, &expected);
    }

    /// Noise of twice the size in every other row of the blocks, none in the prior.
    #[test]
    fn correlated_noise_agrees_too() {
        let (bordered, whole, _) = both();
        let all = Truncation::Relative(1e-12);
        let mut filtered = Tsqr::new(TOTAL);
        let mut by_block = Vec::new();
        for (block, own) in OWN.into_iter().enumerate() {
            let mut of_block = Tsqr::new(own + SHARED);
            for i in 0..60 {
                let (row, _) = row(block, i);
                let factor = 1.0 + (i % 2) as f64;
                filtered.push_weighted(&row, 0.0, factor);
                of_block.push_weighted(&own_first(&row, block), 0.0, factor);
            }
            by_block.push(of_block.finish().unwrap());
        }
        let of_blocks = bordered.solve(bordered.norms(), all).unwrap();
        let expected = solve(&whole, all).unwrap().covariance_sandwich(&filtered.finish().unwrap());
        agree(&of_blocks.covariance_sandwich(&by_block).unwrap(), &expected);
    }

    fn agree(covariance: &BorderedCovariance, expected: &Matrix) {
        for i in 0..SHARED {
            for k in 0..SHARED {
                near(covariance.shared[(i, k)], expected[(i, k)]);
            }
        }
        let mut first = SHARED;
        for (own, of_block) in OWN.into_iter().zip(&covariance.own) {
            for i in 0..own {
                for k in 0..own {
                    near(of_block[(i, k)], expected[(first + i, first + k)]);
                }
            }
            first += own;
        }
    }

    #[test]
    fn what_is_known_of_an_own_unknown_holds_it() {
        let (bordered, _, _) = both();
        let held = bordered.with_priors(&[(0, 1, 3.0, 1e-9)]).unwrap();
        let solution = held.solve(held.norms(), Truncation::Relative(1e-12)).unwrap();
        assert!((solution.unknowns().own[0][1] - 3.0).abs() < 1e-9);
        assert_eq!(held.rows(), bordered.rows() + 1);
    }

    /// An own unknown that no row of its block has a part in stays zero, and nothing else minds.
    #[test]
    fn an_own_unknown_that_is_not_seen_stays_zero() {
        let mut rows = Tsqr::new(3);
        for i in 0..20 {
            rows.push(&[1.0, 0.0, f64::from(i)], 2.0 + 0.5 * f64::from(i));
        }
        let known = Tsqr::new(1).finish().unwrap();
        let bordered = Bordered::new(vec![(2, rows.finish().unwrap())], known).unwrap();
        let solution = bordered.solve(bordered.norms(), Truncation::Relative(1e-12)).unwrap();
        near(solution.unknowns().shared[0], 0.5);
        near(solution.unknowns().own[0][0], 2.0);
        near(solution.unknowns().own[0][1], 0.0);
    }
}
