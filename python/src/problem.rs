//! A fit for others to solve, and as columns that others can set their own beside.

use ballbar::identify::{self, About};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Numbers, rows, vector};
use crate::campaign::Identified;
use crate::error::work;

/// The least squares that a fit came to rest at; m residuals, u unknowns.
///
/// Unknowns are the p parameters, through the exact chain, and what each run has for itself (offsets of legs in s,
/// rates, how the control drove), by their derivatives where the fit came to rest. Readings, weights and noise are those
/// of the fit. Residuals are observed minus computed in standard deviations: of readings, then of what is known of times
/// and what is plausible.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Problem {
    of: Identified,
    repeat: usize,
    problem: identify::Problem,
}

impl Problem {
    pub(crate) fn new(of: Identified, repeat: usize, problem: identify::Problem) -> Self {
        Self { of, repeat, problem }
    }

    fn values(&self, values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        let count = self.problem.unknowns().len();
        let values_given = Numbers::of("values", values, &[Some(count)])?;
        Ok(values_given.finite(values.py(), "values")?.to_vec())
    }
}

#[pymethods]
impl Problem {
    #[getter]
    fn names(&self) -> Vec<String> {
        self.problem.unknowns().iter().map(|of| of.name.clone()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.problem.unknowns().iter().map(|of| of.unit).collect()
    }

    /// Where the fit came to rest, shape (u,).
    #[getter]
    fn values_at_rest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.problem.unknowns().iter().map(|of| of.value).collect())
    }

    /// What each residual is about: ``"reading"``, ``"time"`` or ``"plausible"``.
    #[getter]
    fn about(&self) -> Vec<&'static str> {
        let word = |about: &About| match about {
            About::Reading(_) => "reading",
            About::Time => "time",
            About::Plausible => "plausible",
        };
        self.problem.about().iter().map(word).collect()
    }

    /// Of each reading the stretch of neighbours that its noise is correlated with, shape (readings,).
    #[getter]
    fn stretch<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let of = |about: &About| match about {
            About::Reading(stretch) => Some(*stretch as i64),
            About::Time | About::Plausible => None,
        };
        vector(py, self.problem.about().iter().filter_map(of).collect())
    }

    /// Standard deviation that each reading counted with, um, shape (readings,); infinite where it had no weight.
    #[getter]
    fn reading_sigma_um<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.problem.reading_sigmas_mm().into_iter().map(|mm| 1e3 * mm).collect())
    }

    /// Residuals at values of the unknowns, shape (u,): shape (m,).
    fn residuals<'py>(
        &self,
        py: Python<'py>,
        values: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.values(values)?;
        let residuals =
            work(py, || Ok(self.problem.residuals(&self.of.model(self.repeat)?, &values)))?;
        Ok(vector(py, residuals))
    }

    /// Their derivatives, shape (m, u); the array takes over what the library computed, nothing is copied.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        values: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = self.values(values)?;
        let jacobian =
            work(py, || Ok(self.problem.jacobian(&self.of.model(self.repeat)?, &values)))?;
        rows(py, jacobian, values.len())
    }

    /// Gauss-Newton from values to where less than 1e-7 of a standard deviation is left to gain, shape (u,).
    #[pyo3(signature = (values = None))]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        values: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = match values {
            Some(values) => self.values(values)?,
            None => self.problem.unknowns().iter().map(|of| of.value).collect(),
        };
        let solved = work(py, || self.problem.solve(&self.of.model(self.repeat)?, &values))?;
        Ok(vector(py, solved))
    }

    fn __repr__(&self) -> String {
        let (rows, unknowns) = (self.problem.about().len(), self.problem.unknowns().len());
        format!("<ballbar.Problem: {rows} residuals, {unknowns} unknowns>")
    }
}

/// A fit as a linear problem: what a further column explains beside it; n readings, r directions.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Linearised {
    of: Identified,
    repeat: usize,
    linearised: identify::Linearised,
}

impl Linearised {
    pub(crate) fn new(of: Identified, repeat: usize, linearised: identify::Linearised) -> Self {
        Self { of, repeat, linearised }
    }
}

#[pymethods]
impl Linearised {
    /// Orthonormal columns that the fit follows, shape (n, r); one copy.
    #[getter]
    fn basis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (basis, count) = (&self.linearised.basis, self.linearised.samples.len());
        let values = (0..count).flat_map(|sample| basis.row(sample)).collect();
        rows(py, values, basis.rank())
    }

    /// What the fit leaves, times the root of the weight, um, shape (n,).
    #[getter]
    fn left_um<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let samples = self.linearised.samples.iter();
        vector(py, samples.map(|sample| 1e3 * sample.left_mm * sample.root_weight).collect())
    }

    /// What a column is multiplied by at each reading, shape (n,).
    #[getter]
    fn root_weight<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.linearised.samples.iter().map(|sample| sample.root_weight).collect())
    }

    /// Number of the arc, counted over the runs, shape (n,).
    #[getter]
    fn arc<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        vector(py, self.linearised.samples.iter().map(|sample| sample.arc as i64).collect())
    }

    /// Number of the run, shape (n,).
    #[getter]
    fn run<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        vector(py, self.linearised.samples.iter().map(|sample| sample.run as i64).collect())
    }

    /// Where each reading was taken, as :meth:`AlignedRun.columns`.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let runs = &self.of.campaign().repeats[self.repeat].runs;
        let samples = self.linearised.samples.iter();
        crate::columns::places(py, samples.map(|s| &runs[s.run].records[s.reading].sample))
    }

    fn __repr__(&self) -> String {
        let (samples, rank) = (self.linearised.samples.len(), self.linearised.basis.rank());
        format!("<ballbar.Linearised: {samples} readings, {rank} columns>")
    }
}
