//! Rows a second that `Tsqr` folds on one thread, and the small work after it.
//!
//! `cargo bench --bench solve`. The same matrices, by the same formula, are solved by LAPACK in
//! `benches/numpy_lstsq.py`.

use ballbar::solve::{Solution, Truncation, Tsqr, solve};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

/// Row after row with the right-hand side at its end: `cos(0.37 i (k + 1))` and `sin(i)`.
fn data(rows: usize, columns: usize) -> Vec<f64> {
    let row = |i: usize| {
        let waves = (0..columns).map(move |k| (0.37 * (i * (k + 1)) as f64).cos());
        waves.chain(std::iter::once((i as f64).sin()))
    };
    (0..rows).flat_map(row).collect()
}

fn fold(data: &[f64], columns: usize) -> Tsqr {
    let mut tsqr = Tsqr::new(columns);
    for row in data.chunks_exact(columns + 1) {
        tsqr.push(&row[..columns], row[columns]);
    }
    tsqr
}

/// Everything from rows to coefficients, as `numpy.linalg.lstsq` does it.
#[divan::bench(args = [(100_000, 40), (1_000_000, 40), (100_000, 100)], sample_count = 7)]
fn rows_to_solution(bencher: Bencher, (rows, columns): (usize, usize)) {
    let data = data(rows, columns);
    bencher.counter(ItemsCount::new(rows)).bench(|| -> Option<Solution> {
        let triangle = fold(&data, columns).finish().ok()?;
        solve(&triangle, Truncation::Relative(1e-10)).ok()
    });
}

/// Singular values, solution and covariance of a triangle, without the pass over the rows.
#[divan::bench(args = [40, 96])]
fn triangle_to_covariance(bencher: Bencher, columns: usize) {
    let triangle = fold(&data(2000, columns), columns).finish().ok();
    bencher.bench(|| {
        let solution = solve(triangle.as_ref()?, Truncation::Relative(1e-10)).ok()?;
        Some(solution.covariance_unscaled())
    });
}
