//! Real spherical harmonics.

use nalgebra::Vector3;

/// `Y(degree, order; direction)` with an rms of 1 over the sphere: the polar angle counts from Z, the
/// azimuth from X towards Y, an order above 0 goes with `cos(order · azimuth)`, below 0 with
/// `sin(|order| · azimuth)`; without the Condon-Shortley sign, 0 where the order is beyond the degree.
///
/// The fully normalised recurrence upwards in the degree is stable. The power of the sine of the polar
/// angle stays with the azimuth, as `(x + i y)^m`, so that the poles are no exception.
pub(super) fn harmonic(degree: u32, order: i32, direction: &Vector3<f64>) -> f64 {
    let m = order.unsigned_abs();
    if m > degree {
        return 0.0;
    }
    let (mut cosine, mut sine, mut sectoral) = (1.0, 0.0, 1.0_f64);
    for k in 1..=m {
        (cosine, sine) =
            (cosine * direction.x - sine * direction.y, cosine * direction.y + sine * direction.x);
        let k = f64::from(k);
        // The first step brings the factor 2 that cosine and sine have beside order 0.
        let doubled = if k > 1.0 { 1.0 } else { 2.0 };
        sectoral *= (doubled * (2.0 * k + 1.0) / (2.0 * k)).sqrt();
    }
    let m = f64::from(m);
    let (mut before, mut legendre) = (0.0, sectoral);
    for n in order.unsigned_abs() + 1..=degree {
        let n = f64::from(n);
        let both = (n - m) * (n + m);
        let up = ((2.0 * n - 1.0) * (2.0 * n + 1.0) / both).sqrt();
        let down = if n > m + 1.0 {
            ((2.0 * n + 1.0) * (n + m - 1.0) * (n - m - 1.0) / (both * (2.0 * n - 3.0))).sqrt()
        } else {
            0.0
        };
        (before, legendre) = (legendre, up * direction.z * legendre - down * before);
    }
    legendre * if order < 0 { sine } else { cosine }
}
