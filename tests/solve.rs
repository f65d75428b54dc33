//! The room `solve` held against certified values, a worse method and repeated experiments.
#![allow(clippy::unwrap_used)]

use ballbar::solve::{
    Autocovariances, BackwardFilter, Matrix, NoiseModel, Solution, Truncation, Tsqr, correlation,
    solve, standard_deviations,
};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

fn fit(rows: &[(Vec<f64>, f64)]) -> Solution {
    let mut tsqr = Tsqr::new(rows[0].0.len());
    for (row, rhs) in rows {
        tsqr.push(row, *rhs);
    }
    solve(&tsqr.finish().unwrap(), Truncation::Relative(1e-13)).unwrap()
}

fn sigmas(solution: &Solution) -> Vec<f64> {
    let sigma = solution.residual_sigma().unwrap();
    let unscaled = standard_deviations(&solution.covariance_unscaled());
    unscaled.into_iter().map(|s| s * sigma).collect()
}

/// The largest relative error against certified values.
fn error(found: &[f64], certified: &[f64]) -> f64 {
    assert_eq!(found.len(), certified.len());
    let pairs = found.iter().zip(certified);
    pairs.fold(0.0, |worst, (f, c)| worst.max((f / c - 1.0).abs()))
}

/// NIST Statistical Reference Datasets, Longley: US employment 1947 to 1962, six predictors and a
/// constant, raw condition number 5e9. <https://www.itl.nist.gov/div898/strd/lls/data/Longley.shtml>
#[test]
fn nist_longley() {
    let data = [
        (60323.0, [83.0, 234_289.0, 2356.0, 1590.0, 107_608.0]),
        (61122.0, [88.5, 259_426.0, 2325.0, 1456.0, 108_632.0]),
        (60171.0, [88.2, 258_054.0, 3682.0, 1616.0, 109_773.0]),
        (61187.0, [89.5, 284_599.0, 3351.0, 1650.0, 110_929.0]),
        (63221.0, [96.2, 328_975.0, 2099.0, 3099.0, 112_075.0]),
        (63639.0, [98.1, 346_999.0, 1932.0, 3594.0, 113_270.0]),
        (64989.0, [99.0, 365_385.0, 1870.0, 3547.0, 115_094.0]),
        (63761.0, [100.0, 363_112.0, 3578.0, 3350.0, 116_219.0]),
        (66019.0, [101.2, 397_469.0, 2904.0, 3048.0, 117_388.0]),
        (67857.0, [104.6, 419_180.0, 2822.0, 2857.0, 118_734.0]),
        (68169.0, [108.4, 442_769.0, 2936.0, 2798.0, 120_445.0]),
        (66513.0, [110.8, 444_546.0, 4681.0, 2637.0, 121_950.0]),
        (68655.0, [112.6, 482_704.0, 3813.0, 2552.0, 123_366.0]),
        (69564.0, [114.2, 502_601.0, 3931.0, 2514.0, 125_368.0]),
        (69331.0, [115.7, 518_173.0, 4806.0, 2572.0, 127_852.0]),
        (70551.0, [116.9, 554_894.0, 4007.0, 2827.0, 130_081.0]),
    ];
    let rows: Vec<(Vec<f64>, f64)> = (1947..)
        .zip(data)
        .map(|(year, (employed, x))| {
            let row = std::iter::once(1.0).chain(x).chain([f64::from(year)]);
            (row.collect(), employed)
        })
        .collect();
    let solution = fit(&rows);
    let coefficients = [
        -3_482_258.634_595_82,
        15.061_872_271_373_3,
        -0.358_191_792_925_910e-1,
        -2.020_229_803_816_83,
        -1.033_226_867_173_59,
        -0.511_041_056_535_807e-1,
        1_829.151_464_613_55,
    ];
    let deviations = [
        890_420.383_607_373,
        84.914_925_774_766_9,
        0.334_910_077_722_432e-1,
        0.488_399_681_651_699,
        0.214_274_163_161_675,
        0.226_073_200_069_370,
        455.478_499_142_212,
    ];
    assert_eq!((solution.rank(), solution.degrees_of_freedom()), (7, 9));
    assert!(error(solution.x(), &coefficients) < 1e-9);
    assert!(error(&sigmas(&solution), &deviations) < 1e-9);
    assert!((solution.residual_sigma().unwrap() / 304.854_073_561_965 - 1.0).abs() < 1e-12);
}

/// NIST Statistical Reference Datasets, Wampler1: a polynomial of degree five through exact points.
/// <https://www.itl.nist.gov/div898/strd/lls/data/Wampler1.shtml>
#[test]
fn nist_wampler1() {
    let rows: Vec<(Vec<f64>, f64)> = (0..=20)
        .map(|t| {
            let row: Vec<f64> = (0..=5).map(|k| f64::from(t).powi(k)).collect();
            let sum = row.iter().sum();
            (row, sum)
        })
        .collect();
    let solution = fit(&rows);
    assert!(error(solution.x(), &[1.0; 6]) < 1e-9);
    assert!(solution.residual_norm() < 1e-8);
}

/// Forty columns that share all but 1e-7 of their variance.
#[test]
fn nearly_collinear_columns_keep_their_digits() {
    const N: usize = 40;
    let mut rng = Pcg64Mcg::seed_from_u64(40);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let (shared, own) = ((1.0 - 1e-7_f64).sqrt(), 1e-7_f64.sqrt());
    let truth: Vec<f64> = (0..N).map(|k| 1.0 + k as f64 / 10.0).collect();
    let mut tsqr = Tsqr::new(N);
    let mut squares = Matrix::zeros(N, N);
    let mut products = [0.0; N];
    for _ in 0..20_000 {
        let common = shared * normal();
        let row: Vec<f64> = (0..N).map(|_| common + own * normal()).collect();
        let rhs: f64 = row.iter().zip(&truth).map(|(a, x)| a * x).sum();
        tsqr.push(&row, rhs);
        for i in 0..N {
            products[i] += row[i] * rhs;
            for k in 0..N {
                squares[(i, k)] += row[i] * row[k];
            }
        }
    }
    let solution = solve(&tsqr.finish().unwrap(), Truncation::Relative(1e-10)).unwrap();
    assert_eq!(solution.rank(), N);
    let folded = error(solution.x(), &truth);
    let normal_equations = error(&cholesky(&squares, &products), &truth);
    assert!(folded < 1e-11, "{folded:e}");
    assert!(normal_equations > 1e3 * folded, "{normal_equations:e}");
}

/// Solves the normal equations, for comparison only.
fn cholesky(a: &Matrix, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut l = Matrix::zeros(n, n);
    let mut x = b.to_vec();
    for i in 0..n {
        for k in 0..=i {
            let sum: f64 = (0..k).map(|j| l[(i, j)] * l[(k, j)]).sum();
            let left = a[(i, k)] - sum;
            l[(i, k)] = if i == k { left.sqrt() } else { left / l[(k, k)] };
        }
        x[i] = (x[i] - (0..i).map(|j| l[(i, j)] * x[j]).sum::<f64>()) / l[(i, i)];
    }
    for i in (0..n).rev() {
        x[i] = (x[i] - (i + 1..n).map(|j| l[(j, i)] * x[j]).sum::<f64>()) / l[(i, i)];
    }
    x
}

#[test]
fn truncated_solution_is_the_shortest_and_its_covariance_the_pseudo_inverse() {
    // Column 2 = column 0 + column 1, all of unit length after scaling; column 3 stands alone.
    let wave = |i: usize, k: usize| (0.37 * (i * (k + 1)) as f64).cos();
    let row = |i: usize| vec![wave(i, 0), wave(i, 1), wave(i, 0) + wave(i, 1), 1e3 * wave(i, 4)];
    let rows: Vec<_> = (0..2000).map(|i| (row(i), row(i)[2] + 2e-3 * row(i)[3])).collect();
    let solution = fit(&rows);
    assert_eq!(solution.rank(), 3);
    assert!(solution.residual_norm() < 1e-11);
    assert!((solution.x()[3] - 2e-3).abs() < 1e-15);
    let fraction = solution.observed_fraction();
    assert!((fraction[3] - 1.0).abs() < 1e-12 && fraction[0] < 0.9);

    // The shortest solution in scaled coefficients has nothing of the null direction in it.
    let null = solution.spectrum().null_space(3).column(0);
    let scales = solution.spectrum().scales();
    let along: f64 = (0..4).map(|k| null[k] * scales[k] * solution.x()[k]).sum();
    assert!(along.abs() < 1e-12);

    // G = (J^T J)^+ in scaled coefficients: G A G = G and symmetric, with A = D^-1 J^T J D^-1.
    let covariance = solution.covariance_unscaled();
    let g = Matrix::from_fn(4, 4, |i, k| covariance[(i, k)] * scales[i] * scales[k]);
    let a = Matrix::from_fn(4, 4, |i, k| {
        let products = rows.iter().map(|(row, _)| row[i] * row[k]);
        products.sum::<f64>() / scales[i] / scales[k]
    });
    let again = g.times(&a).times(&g);
    for i in 0..4 {
        for k in 0..4 {
            assert!((again[(i, k)] - g[(i, k)]).abs() < 1e-12);
            assert!((g[(i, k)] - g[(k, i)]).abs() < 1e-15);
        }
    }
    // Dropping directions on purpose leaves their part in the residual.
    let mut tsqr = Tsqr::new(4);
    for (row, rhs) in &rows {
        tsqr.push(row, *rhs);
    }
    let none = solve(&tsqr.finish().unwrap(), Truncation::Rank(0)).unwrap();
    let all: f64 = rows.iter().map(|(_, rhs)| rhs * rhs).sum();
    assert!((none.residual_norm() / all.sqrt() - 1.0).abs() < 1e-12);
    assert!(none.x().iter().all(|x| x.abs() < f64::MIN_POSITIVE));
}

#[test]
fn a_prior_pulls_by_the_ratio_of_the_variances() {
    // Four measurements of 3 with sigma 1 and the belief in 0 with sigma 0.5 weigh alike.
    let mut tsqr = Tsqr::new(2);
    for _ in 0..4 {
        tsqr.push(&[1.0, 0.0], 3.0);
    }
    tsqr.push_prior(0, 0.0, 0.5);
    tsqr.push_prior(1, 7.0, 0.1);
    let solution = solve(&tsqr.finish().unwrap(), Truncation::Relative(1e-10)).unwrap();
    assert!(error(solution.x(), &[1.5, 7.0]) < 1e-14);
    let deviations = standard_deviations(&solution.covariance_unscaled());
    assert!(error(&deviations, &[8.0_f64.sqrt().recip(), 0.1]) < 1e-14);
}

const SEGMENTS: usize = 3;
const LENGTH: usize = 60;

/// A constant and a slope over `t`, the same in every segment.
fn line(t: usize) -> [f64; 2] {
    [1.0, t as f64 / LENGTH as f64]
}

/// The mean, and the covariance about the truth, of a fit to simulated noise, against the sandwich.
#[test]
fn sandwich_agrees_with_repeated_experiments() {
    const REPEATS: usize = 20_000;
    let noise = NoiseModel::autoregressive(vec![0.9], 0.2).unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(2026);
    let mut plain = Tsqr::new(2);
    let mut filtered = Tsqr::new(2);
    let mut filter = BackwardFilter::new(&noise, 2);
    for _ in 0..SEGMENTS {
        filter.begin(LENGTH);
        for t in (0..LENGTH).rev() {
            plain.push(&line(t), 0.0);
            filtered.push(filter.push(&line(t)), 0.0);
        }
    }
    let solution = solve(&plain.finish().unwrap(), Truncation::Relative(1e-10)).unwrap();
    let sandwich = solution.covariance_sandwich(&filtered.finish().unwrap());

    let mut sums = Matrix::zeros(2, 2);
    let mut autocovariances = Autocovariances::new(4);
    for repeat in 0..REPEATS {
        let mut tsqr = Tsqr::new(2);
        for _ in 0..SEGMENTS {
            let mut e: Vec<f64> = Vec::with_capacity(LENGTH);
            for t in 0..LENGTH {
                let w: f64 = StandardNormal.sample(&mut rng);
                e.push(match e.last() {
                    None => noise.sigma() * w,
                    Some(last) => 0.9 * last + noise.innovation_sigma() * w,
                });
                tsqr.push(&line(t), e[t]);
            }
            if repeat < 500 {
                autocovariances.push_segment(&e);
            }
        }
        let x = solve(&tsqr.finish().unwrap(), Truncation::Relative(1e-10)).unwrap();
        for i in 0..2 {
            for k in 0..2 {
                sums[(i, k)] += x.x()[i] * x.x()[k] / REPEATS as f64;
            }
        }
    }
    let (expected, found) = (standard_deviations(&sums), standard_deviations(&sandwich));
    assert!(error(&found, &expected) < 0.03, "{found:?} {expected:?}");
    let (expected, found) = (correlation(&sums)[(0, 1)], correlation(&sandwich)[(0, 1)]);
    assert!((expected - found).abs() < 0.03, "{found} {expected}");

    // Taking the samples for independent would promise three times too much.
    let naive = standard_deviations(&solution.covariance_unscaled());
    assert!(standard_deviations(&sandwich)[0] > 3.0 * noise.sigma() * naive[0]);

    // And the noise model is found again in the noise itself; Akaike's criterion may add to it what is
    // next to nothing.
    let model = NoiseModel::fit(&autocovariances, 4).unwrap();
    assert!((model.phi()[0] - 0.9).abs() < 0.01, "{model:?}");
    assert!(model.phi()[1..].iter().all(|phi| phi.abs() < 0.01), "{model:?}");
    assert!((model.long_run_variance() / noise.long_run_variance() - 1.0).abs() < 0.05);
}
