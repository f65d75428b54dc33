//! Engineering units: a metrologist reads um/m, not mm/mm.

use super::numbers;

/// A unit for the eye, and the factor that leads to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::report) struct Engineering {
    /// Its name in ASCII, for the terminal.
    pub(in crate::report) plain: &'static str,
    /// Its name with the signs of the trade, for the report.
    pub(in crate::report) fine: &'static str,
    /// Multiplies a value in the unit of the model.
    pub(in crate::report) factor: f64,
}

const TABLE: [(&str, Engineering); 8] = [
    ("mm", Engineering { plain: "um", fine: "µm", factor: 1e3 }),
    ("mm/mm", Engineering { plain: "um/m", fine: "µm/m", factor: 1e6 }),
    ("mm/mm²", Engineering { plain: "um/m^2", fine: "µm/m²", factor: 1e9 }),
    ("mm/mm³", Engineering { plain: "um/m^3", fine: "µm/m³", factor: 1e12 }),
    ("rad", Engineering { plain: "urad", fine: "µrad", factor: 1e6 }),
    ("rad/mm", Engineering { plain: "urad/m", fine: "µrad/m", factor: 1e9 }),
    ("rad/mm²", Engineering { plain: "urad/m^2", fine: "µrad/m²", factor: 1e12 }),
    ("rad/mm³", Engineering { plain: "urad/m^3", fine: "µrad/m³", factor: 1e15 }),
];

/// The engineering unit of a unit of the model; a unit that is not in the table stays as it is.
pub(in crate::report) fn engineering(unit: &'static str) -> Engineering {
    TABLE
        .iter()
        .find(|(of_model, _)| *of_model == unit)
        .map_or(Engineering { plain: unit, fine: unit, factor: 1.0 }, |(_, unit)| *unit)
}

/// How many decimals a row deserves: two digits of its standard deviation, or four of the value where
/// there is none.
pub(in crate::report) fn row_decimals(value: f64, sigma: Option<f64>) -> usize {
    match sigma.filter(|s| *s > 0.0) {
        Some(sigma) => numbers::decimals(sigma, 2).min(6),
        None => numbers::decimals(value, 4).min(6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Coefficient;

    #[test]
    fn every_unit_of_the_model_has_an_engineering_unit() {
        for coefficient in Coefficient::all() {
            let unit = engineering(coefficient.unit());
            assert!(unit.plain.is_ascii(), "{coefficient}");
            assert!(unit.factor >= 1e3, "{coefficient}");
        }
    }

    #[test]
    fn a_cubic_over_a_metre_is_the_same_length_in_both_units() {
        let h_mm = 1000.0_f64;
        let per_mm3 = 3.64e-10;
        let um = per_mm3 * h_mm.powi(3) * 1e3;
        assert!((per_mm3 * engineering("mm/mm³").factor - um).abs() < 1e-9);
    }

    #[test]
    fn two_digits_of_sigma_are_shown() {
        assert_eq!(row_decimals(12.345, Some(0.12)), 2);
        assert_eq!(row_decimals(12345.0, Some(170.0)), 0);
        assert_eq!(row_decimals(12.345, None), 2);
    }
}
