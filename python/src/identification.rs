//! One repeat, identified, and its runs.

use ballbar::identify;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{matrix, rows, vector};
use crate::campaign::Identified;
use crate::columns::records;
use crate::error::work;
use crate::problem::{Linearised, Problem};

/// One repeat, identified; p parameters, each in the unit that ``units`` has.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Identification {
    pub(crate) of: Identified,
    pub(crate) repeat: usize,
}

impl Identification {
    fn result(&self) -> &identify::Identification {
        &self.of.campaign().repeats[self.repeat]
    }

    fn numbers<'py>(
        &self,
        py: Python<'py>,
        of: fn(&identify::Estimate) -> f64,
    ) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.result().estimates.iter().map(of).collect())
    }
}

#[pymethods]
impl Identification {
    #[getter]
    fn names(&self) -> Vec<String> {
        self.result().estimates.iter().map(|of| of.parameter.name.clone()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.result().estimates.iter().map(|of| of.parameter.unit).collect()
    }

    /// Shape (p,).
    #[getter]
    fn value<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |of| of.value)
    }

    /// Standard deviations by the noise: what repeats would scatter, shape (p,).
    #[getter]
    fn sigma_noise<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |of| of.sigma)
    }

    /// By the noise and by what these runs cannot tell from other plausible faults; NaN where none was assumed.
    #[getter]
    fn sigma_all<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |of| of.all.unwrap_or(f64::NAN))
    }

    /// Standard deviations of what was taken for plausible, NaN where nothing was, shape (p,).
    #[getter]
    fn plausible<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |of| of.plausible.unwrap_or(f64::NAN))
    }

    /// How much of each the data determine, 0 to 1, shape (p,).
    #[getter]
    fn observed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |of| of.observed)
    }

    /// By the noise, shape (p, p).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.result().covariance)
    }

    /// Shape (p, p).
    #[getter]
    fn correlation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.result().correlation)
    }

    /// What one plausible standard deviation of each fault (column) does to the estimates, then what each effect that nobody has
    /// explained has moved them by; shape (p, faults).
    #[getter]
    fn left_open<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.result().left_open.as_ref().map(|of| matrix(py, of)).transpose()
    }

    #[getter]
    fn rank(&self) -> usize {
        self.result().rank
    }

    #[getter]
    fn condition(&self) -> f64 {
        self.result().condition
    }

    /// Root mean square of what the fit leaves, um.
    #[getter]
    fn rms_um(&self) -> f64 {
        1e3 * self.result().rms_mm
    }

    /// Readings that took part.
    #[getter]
    fn used(&self) -> usize {
        self.result().used
    }

    #[getter]
    fn steps(&self) -> usize {
        self.result().steps
    }

    #[getter]
    fn cautions(&self) -> Vec<String> {
        self.result().cautions(self.of.machine(), self.of.test().estimation().loss)
    }

    /// Standard deviation of the noise of a reading, um.
    #[getter]
    fn noise_um(&self) -> f64 {
        1e3 * self.result().noise.sigma()
    }

    /// Coefficients of the autoregression of the noise, shape (order,).
    #[getter]
    fn noise_phi<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.result().noise.phi().to_vec())
    }

    /// Standard deviation of what is new in every reading, um.
    #[getter]
    fn noise_innovation_um(&self) -> f64 {
        1e3 * self.result().noise.innovation_sigma()
    }

    #[getter]
    fn runs(&self) -> Vec<IdentifiedRun> {
        let runs = 0..self.result().runs.len();
        runs.map(|run| IdentifiedRun { of: self.of.clone(), repeat: self.repeat, run }).collect()
    }

    /// What people ask of the machine at the place of the test.
    ///
    /// By name, such as ``"squareness XY"``: ``value``, ``sigma_noise``, ``sigma_all`` (or ``None``), all in ``unit``
    /// (``"um/m"``, ``"um"`` or ``"urad"``). Empty where there is no such place.
    fn answers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let answers = work(py, || {
            let result = self.result();
            let Some(frame) = self.of.campaign().frame.as_ref() else { return Ok(Vec::new()) };
            let model = self.of.model(self.repeat)?;
            let values = result.values();
            Ok(identify::answers(&model, frame, &result.known(&values)))
        })?;
        crate::planning::answers(py, &answers)
    }

    /// The least squares that the fit came to rest at.
    fn problem(&self, py: Python<'_>) -> PyResult<Problem> {
        let problem = work(py, || {
            let model = self.of.model(self.repeat)?;
            Ok(self.result().problem(&model, &self.of.options()))
        })?;
        Ok(Problem::new(self.of.clone(), self.repeat, problem))
    }

    /// The fit as orthonormal columns, to set columns of one's own beside.
    fn linearised(&self, py: Python<'_>) -> PyResult<Linearised> {
        work(py, || {
            let model = self.of.model(self.repeat)?;
            let linearised = self.result().linearised(&model, &self.of.options())?;
            Ok(Linearised::new(self.of.clone(), self.repeat, linearised))
        })
    }

    fn __repr__(&self) -> String {
        let result = self.result();
        format!(
            "<ballbar.Identification: {} parameters, {} readings, {:.3} um rms>",
            result.estimates.len(),
            result.used,
            1e3 * result.rms_mm
        )
    }
}

/// A run that took part; n readings.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct IdentifiedRun {
    of: Identified,
    repeat: usize,
    run: usize,
}

impl IdentifiedRun {
    fn result(&self) -> &identify::IdentifiedRun {
        &self.of.campaign().repeats[self.repeat].runs[self.run]
    }
}

#[pymethods]
impl IdentifiedRun {
    #[getter]
    fn name(&self) -> &str {
        &self.result().name
    }

    #[getter]
    fn mounting(&self) -> &str {
        &self.of.test().mountings()[self.result().mounting].name
    }

    #[getter]
    fn bar_length_mm(&self) -> f64 {
        self.result().nominal_mm
    }

    /// What is known of every reading: the columns of :meth:`AlignedRun.columns` with refined times, and more.
    ///
    /// ``computed_um``, ``residual_um`` (observed minus computed), ``whitened`` (in standard deviations, NaN where it
    /// took no part), ``weight`` (0 to 1), ``used`` (bool), all of shape (n,); ``apart``: why it took no part, a list.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        records(py, &self.result().records)
    }

    /// Change of the deviation at every reading with each parameter, mm per unit, shape (n, p); of a machine that
    /// does not err. The array takes over what the library computed, nothing is copied.
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (values, count) = work(py, || {
            let model = self.of.model(self.repeat)?;
            let (count, run) = (model.parameters().len(), self.result());
            let mut values = vec![0.0; count * run.records.len()];
            for (record, row) in run.records.iter().zip(values.chunks_exact_mut(count.max(1))) {
                let sample = &record.sample;
                model.row(&model.situation(&sample.pose, &sample.motion, run.mounting), row);
            }
            Ok((values, count))
        })?;
        rows(py, values, count)
    }

    fn __repr__(&self) -> String {
        let run = self.result();
        format!("<ballbar.IdentifiedRun {:?}: {} readings>", run.name, run.records.len())
    }
}
