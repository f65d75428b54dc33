//! Real spherical harmonics.

use std::array::from_fn;
use std::sync::LazyLock;

use nalgebra::Vector3;

/// The highest degree.
pub(super) const MOST_DEGREE: usize = 8;

type ByDegreeAndOrder = [[f64; MOST_DEGREE + 1]; MOST_DEGREE + 1];

/// What the recurrence over degree and order multiplies by; worked out once, because it is evaluated at every reading.
struct Recurrence {
    /// `P(m, m) / P(m - 1, m - 1)`.
    diagonal: [f64; MOST_DEGREE + 1],
    /// `P(l, m) = a (z P(l-1, m) - b P(l-2, m))`, fully normalised.
    a: ByDegreeAndOrder,
    b: ByDegreeAndOrder,
}

static RECURRENCE: LazyLock<Recurrence> = LazyLock::new(|| {
    let diagonal = |m: usize| {
        let order = m.max(1) as f64;
        let doubled = if m == 1 { 2.0 } else { 1.0 };
        (doubled * (2.0 * order + 1.0) / (2.0 * order)).sqrt()
    };
    let a = |l: usize, m: usize| {
        let (l_squared, m_squared) = ((l * l) as f64, (m * m) as f64);
        if l > m { ((4.0 * l_squared - 1.0) / (l_squared - m_squared)).sqrt() } else { 0.0 }
    };
    let b = |l: usize, m: usize| {
        let (last, m_squared) = (((l.max(1) - 1) * (l.max(1) - 1)) as f64, (m * m) as f64);
        ((last - m_squared) / (4.0 * last - 1.0)).max(0.0).sqrt()
    };
    Recurrence {
        diagonal: from_fn(diagonal),
        a: from_fn(|l| from_fn(|m| a(l, m))),
        b: from_fn(|l| from_fn(|m| b(l, m))),
    }
});

/// The `2 l + 1` harmonics of a degree `l` in a direction, orders `-l ..= l`, each of rms 1 over the sphere.
///
/// `Y(l, m) = N P(l, |m|; cos theta) · {cos m phi, m > 0; 1, m = 0; sin |m| phi, m < 0}`, with the polar
/// angle `theta` from Z, the azimuth `phi` from X towards Y, and no alternating sign. Products with
/// `sin^m theta` are taken as powers of `x + i y`, so that the poles are places like others.
pub(super) fn harmonics(degree: usize, direction: &Vector3<f64>, out: &mut [f64]) {
    let (x, y, z) = (direction.x, direction.y, direction.z);
    let numbers = &*RECURRENCE;
    // sin^m theta (cos m phi, sin m phi), and P(m, m) without it, normalised so that Y has rms 1.
    let (mut cosine, mut sine) = (1.0, 0.0);
    let mut diagonal = 1.0;
    for m in 0..=degree {
        if m > 0 {
            (cosine, sine) = (x * cosine - y * sine, x * sine + y * cosine);
            diagonal *= numbers.diagonal[m];
        }
        let (mut before, mut value) = (0.0, diagonal);
        for l in m + 1..=degree {
            (before, value) = (value, numbers.a[l][m] * (z * value - numbers.b[l][m] * before));
        }
        out[degree + m] = value * cosine;
        if m > 0 {
            out[degree - m] = value * sine;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_of_a_degree_are_orthonormal_over_the_sphere() {
        // Midpoints over z converge slowly at the poles; a thousand are good to 1e-4.
        for degree in 0..=6 {
            let count = 2 * degree + 1;
            let mut products = vec![0.0; count * count];
            for i in 0..1000 {
                let z = (f64::from(i) + 0.5) / 500.0 - 1.0;
                for k in 0..40 {
                    let phi = (f64::from(k) + 0.5) * std::f64::consts::TAU / 40.0;
                    let radius = (1.0 - z * z).sqrt();
                    let direction = Vector3::new(radius * phi.cos(), radius * phi.sin(), z);
                    let mut y = vec![0.0; count];
                    harmonics(degree, &direction, &mut y);
                    for a in 0..count {
                        for b in 0..count {
                            products[a * count + b] += y[a] * y[b] / 40_000.0;
                        }
                    }
                }
            }
            for a in 0..count {
                for b in 0..count {
                    let expected = if a == b { 1.0 } else { 0.0 };
                    let found: f64 = products[a * count + b];
                    assert!((found - expected).abs() < 2e-4, "{degree}: {a} {b} {found}");
                }
            }
        }
    }
}
