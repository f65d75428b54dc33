//! Arrays of `NumPy`: checked on the way in, moved on the way out.

use numpy::{
    Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use ballbar::solve::Matrix;

use crate::error::argument;

/// Numbers of an argument of a known shape; `None` of a size is any.
pub(crate) struct Numbers<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
}

impl<'py> Numbers<'py> {
    /// Checks dtype, shape and order of an argument; what is in it is seen where it is used.
    pub(crate) fn of(
        name: &str,
        given: &Bound<'py, PyAny>,
        shape: &[Option<usize>],
    ) -> PyResult<Self> {
        let py = given.py();
        let wanted = wanted(shape);
        let refused = |what: &str| {
            argument(py, name, &format!("{what} where {wanted} is expected"), &hint(name))
        };
        let Ok(untyped) = given.cast::<PyUntypedArray>() else {
            let kind = given.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
            return Err(refused(&format!("a {kind}")));
        };
        // An array in everything but its mask, which the numbers alone do not have.
        if given.hasattr("mask")? {
            return Err(argument(
                py,
                name,
                &format!("a masked array where {wanted} is expected: its mask would be lost"),
                &format!(
                    "pass {name}.filled(numpy.nan) where NaN says that there is no reading, else leave masked rows out"
                ),
            ));
        }
        let Ok(array) = given.cast::<PyArrayDyn<f64>>() else {
            return Err(refused(&format!("an array of {}", untyped.dtype())));
        };
        let of = untyped.shape();
        let fits = |(size, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|w| w == *size);
        if of.len() != shape.len() || !of.iter().zip(shape).all(fits) {
            return Err(refused(&format!("an array of shape {}", tuple(of))));
        }
        if untyped.len() == 0 {
            return Err(refused("an empty array"));
        }
        if !untyped.is_c_contiguous() {
            return Err(argument(
                py,
                name,
                &format!(
                    "a strided or Fortran-ordered array where {wanted} in C order is expected"
                ),
                &format!("pass numpy.ascontiguousarray({name}); nothing is copied unasked"),
            ));
        }
        let array = array.try_readonly().map_err(|_| refused("an array that is being written"))?;
        Ok(Self { array })
    }

    /// The numbers, row after row.
    pub(crate) fn slice(&self) -> PyResult<&[f64]> {
        Ok(self.array.as_slice()?)
    }

    /// The numbers, none of them NaN or infinite.
    pub(crate) fn finite(&self, py: Python<'_>, name: &str) -> PyResult<&[f64]> {
        let numbers = self.slice()?;
        if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
            let what =
                format!("element {index} is {}, and finite numbers are expected", numbers[index]);
            return Err(argument(py, name, &what, "leave such rows out"));
        }
        Ok(numbers)
    }
}

fn wanted(shape: &[Option<usize>]) -> String {
    let sizes: Vec<String> =
        shape.iter().map(|size| size.map_or_else(|| "n".into(), |size| size.to_string())).collect();
    let comma = if sizes.len() == 1 { "," } else { "" };
    format!("a float64 array of shape ({}{comma})", sizes.join(", "))
}

fn tuple(of: &[usize]) -> String {
    let comma = if of.len() == 1 { "," } else { "" };
    let sizes: Vec<String> = of.iter().map(ToString::to_string).collect();
    format!("({}{comma})", sizes.join(", "))
}

fn hint(name: &str) -> String {
    format!(
        "numpy.asarray({name}, dtype=float) makes one of numbers; the documentation has the shape"
    )
}

/// An array that takes a vector over.
pub(crate) fn vector<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}

/// An array of rows that takes a vector over, row after row.
pub(crate) fn rows<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    PyArray1::from_vec(py, values).reshape([rows, columns])
}

/// An array of a small matrix.
pub(crate) fn matrix<'py>(py: Python<'py>, of: &Matrix) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = (0..of.rows()).flat_map(|i| of.row(i).to_vec()).collect();
    PyArray1::from_vec(py, values).reshape([of.rows(), of.columns()])
}
