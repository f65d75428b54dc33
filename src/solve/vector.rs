//! Sums over long columns, always in the same order.

/// `a · b`, summed in four lanes: always the same four, so always the same bits. What is longer in one of
/// them does not count.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mut lanes = [0.0; 4];
    let (fours_a, fours_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = fours_a.remainder().iter().zip(fours_b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in fours_a.zip(fours_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes[0] + lanes[1] + (lanes[2] + lanes[3]) + rest
}

/// The upper of the two middle values, or the middle one; `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_of_any_length() {
        for count in 0..10_i32 {
            let a: Vec<f64> = (1..=count).map(f64::from).collect();
            let squares: i32 = (1..=count).map(|k| k * k).sum();
            assert!((dot(&a, &a) - f64::from(squares)).abs() < 1e-12);
            for longer in 1..5 {
                let b = [&a[..], &vec![7.0; longer]].concat();
                assert!((dot(&a, &b) - f64::from(squares)).abs() < 1e-12);
                assert!((dot(&b, &a) - f64::from(squares)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_middle_of_values_in_any_order() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(3.0));
        assert_eq!(median(Vec::new()), None);
    }
}
