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

    #[getter]
    fn clock_rate_ppm(&self) -> f64 {
        1e6 * self.run.alignment.time_map.rate
    }

    #[getter]
    fn sample_period_s(&self) -> f64 {
        self.run.alignment.sample_period_s
    }

    /// Where every reading was taken, a column each.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        places(py, self.run.samples().iter())
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.AlignedRun {:?}: {} readings>", self.run.name, self.run.samples().len())
    }
}

/// Lays logs over their programs; times are refined by `identify` alone.
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

/// Identifies the machine from the runs of a test: those of its file, or those that are given.
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
