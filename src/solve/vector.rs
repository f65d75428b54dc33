//! Sums over long columns, always in the same order.

/// Sums side by side: each waits for itself alone, so that with eight a product takes no longer than its
/// numbers take to come.
pub(super) const LANES: usize = 8;

/// `a · b`, summed in eight lanes: always the same eight, so always the same bits. What is longer in one of
/// them does not count.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mut lanes = [0.0; LANES];
    let (eights_a, eights_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = eights_a.remainder().iter().zip(eights_b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in eights_a.zip(eights_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    across(lanes) + rest
}

/// The sum of what the lanes hold.
pub(super) fn across([a, b, c, d, e, f, g, h]: [f64; LANES]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
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
        for count in 0..20_i32 {
            let a: Vec<f64> = (1..=count).map(f64::from).collect();
            let squares: i32 = (1..=count).map(|k| k * k).sum();
            assert!((dot(&a, &a) - f64::from(squares)).abs() < 1e-12);
            for longer in 1..10 {
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
