//! The stages from logs to a machine.

use std::sync::Arc;
use std::time::Instant;

use ballbar::identify::{Failure, MeasuredRun, RunInput};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::campaign::{Campaign, Identified, Stated};
use crate::columns::places;
use crate::error::{argument, work};
use crate::run::{Run, repeats};
use crate::test::Test;

/// A log laid over its program, before any fit.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct AlignedRun {
    run: RunInput,
    mounting: String,
}

#[pymethods]
impl AlignedRun {
    #[getter]
    fn name(&self) -> &str {
        &self.run.name
    }

    #[getter]
    fn mounting(&self) -> &str {
        &self.mounting
    }

    #[getter]
    fn bar_length_mm(&self) -> f64 {
        self.run.nominal_mm
    }

    /// How much faster the machine's clock goes than the instrument's, 1e-6.
    #[getter]
    fn clock_rate_ppm(&self) -> f64 {
        1e6 * self.run.alignment.time_map.rate
    }

    #[getter]
    fn sample_period_s(&self) -> f64 {
        self.run.alignment.sample_period_s
    }

    /// Where every reading was taken: float64 arrays of shape (n,) or, of X, Y, Z, (n, 3).
    ///
    /// ``log_s``, ``program_s``, ``time_sigma_s``, ``elapsed_s`` (since the program began), ``deviation_um``,
    /// ``position_mm`` (n, 3), ``velocity_mm_s`` (n, 3), ``sense`` (n, 3; -1, 0, 1), and int64 ``arc`` (-1 outside of
    /// arcs), ``leg``, ``line`` (number of the reading in its log).
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        places(py, self.run.samples().iter())
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.AlignedRun {:?}: {} readings>", self.run.name, self.run.samples().len())
    }
}

/// Lay logs over their programs: the runs of the test file, or those that are given.
#[pyfunction]
#[pyo3(signature = (test, runs = None))]
pub(crate) fn align(
    py: Python<'_>,
    test: &Test,
    runs: Option<Vec<Run>>,
) -> PyResult<Vec<AlignedRun>> {
    let measured: Vec<MeasuredRun> = repeats(py, test, runs)?.into_iter().flatten().collect();
    let (of, machine) = (&test.test, &test.machine.machine);
    let laid = || measured.iter().map(|run| run.aligned(of, machine)).collect();
    let aligned: Vec<RunInput> = work(py, laid)?;
    let names = of.mountings();
    let named = |run: RunInput| AlignedRun { mounting: names[run.mounting].name.clone(), run };
    Ok(aligned.into_iter().map(named).collect())
}

/// Identify the machine from the runs of the test file, or from those that are given.
///
/// ``terms``, ``loss`` and ``minimum_norm`` stand for the keys of ``[identify]``; ``on_failure`` says what becomes of a
/// run that cannot be identified.
#[pyfunction]
#[pyo3(signature = (test, runs = None, *, terms = None, loss = None, minimum_norm = None, on_failure = "refuse"))]
pub(crate) fn identify(
    py: Python<'_>,
    test: &Test,
    runs: Option<Vec<Run>>,
    terms: Option<Vec<String>>,
    loss: Option<&str>,
    minimum_norm: Option<bool>,
    on_failure: &str,
) -> PyResult<Campaign> {
    let failure = match on_failure {
        "refuse" => Failure::Refuse,
        "leave_out" => Failure::LeaveOut,
        _ => {
            let what = format!("{on_failure:?} is neither \"refuse\" nor \"leave_out\"");
            return Err(argument(
                py,
                "on_failure",
                &what,
                "what becomes of a run that cannot be identified",
            ));
        }
    };
    let estimated = test.estimating(py, terms, loss, minimum_norm)?;
    let (test, machine) = (estimated.test.clone(), estimated.machine.machine.clone());
    let given = match runs {
        None => None,
        Some(runs) => Some(repeats(py, &estimated, Some(runs))?),
    };
    work(py, || {
        let began = Instant::now();
        let campaign = match given {
            None => ballbar::identify::Campaign::of(&test, &machine, failure, &|| ())?,
            Some(runs) => ballbar::identify::Campaign::of_logs(&test, &machine, runs, failure)?,
        };
        let elapsed_s = began.elapsed().as_secs_f64();
        let of = Identified::Stated(Arc::new(Stated { test, machine, campaign }));
        Ok(Campaign { of, elapsed_s })
    })
}
