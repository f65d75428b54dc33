//! A test on a virtual machine.

use std::path::{Path, PathBuf};

use ballbar::model::{Effect, ModelFile};
use ballbar::simulate::Scenario;
use ballbar::virtual_test;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::error::{argument, work};
use crate::run::Run;
use crate::test::Test;
use crate::words::toml_of;

/// The runs of a virtual machine, and what is true of it.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Simulation {
    runs: Vec<Run>,
    truth: String,
}

#[pymethods]
impl Simulation {
    #[getter]
    fn runs(&self) -> Vec<Run> {
        self.runs.clone()
    }

    /// What was put in, TOML as in truth.toml.
    #[getter]
    fn truth(&self) -> &str {
        &self.truth
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Simulation: {} runs>", self.runs.len())
    }
}

/// A scenario as it is given: a dictionary, or a path of a file.
enum Given {
    File(PathBuf),
    Text(String),
}

impl Given {
    fn of(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
            return Ok(Self::File(given.extract()?));
        }
        Ok(Self::Text(toml_of(name, given)?))
    }

    fn scenario(&self) -> ballbar::Result<Scenario> {
        match self {
            Self::File(file) => Scenario::read(file),
            Self::Text(text) => Scenario::parse(text, Path::new("scenario.toml")),
        }
    }
}

/// Let a virtual machine run the programs of a test and an instrument read it.
///
/// Args:
///     scenario: what machine and instrument are like: a file, or a mapping with its keys.
///     hide: effects, such as ``"cyclic:on=EXX,period_mm=10,amplitude_um=1.2"``.
///     model: a model.toml whose errors the machine has.
///     seed: where everything random begins.
///     repeats: how often the test is run.
///     paper: take the coefficients of the paper instead of drawing a machine.
#[pyfunction]
#[pyo3(signature = (test, *, scenario = None, hide = Vec::new(), model = None, seed = None, repeats = 1, paper = false))]
#[allow(clippy::too_many_arguments)] // by name
pub(crate) fn simulate(
    py: Python<'_>,
    test: &Test,
    scenario: Option<&Bound<'_, PyAny>>,
    hide: Vec<String>,
    model: Option<PathBuf>,
    seed: Option<u64>,
    repeats: u32,
    paper: bool,
) -> PyResult<Simulation> {
    if !(1..=10_000).contains(&repeats) {
        let what = format!("{repeats} where 1 to 10000 is expected");
        return Err(argument(py, "repeats", &what, "how often the test is run"));
    }
    let given = scenario.map(|given| Given::of("scenario", given)).transpose()?;
    let (test, machine) = (&test.test, &test.machine.machine);
    work(py, || {
        let scenario =
            given.map_or_else(|| Ok(virtual_test::usual_scenario(test)), |of| of.scenario());
        let mut scenario = scenario?;
        if let Some(seed) = seed {
            scenario.seed = seed;
        }
        if let Some(file) = &model {
            scenario.take(&ModelFile::read(file)?)?;
        }
        for effect in &hide {
            scenario.hide(Effect::parse(effect)?)?;
        }
        if !paper {
            virtual_test::draw_machine(&mut scenario, test, machine);
        }
        let programs = virtual_test::programs(test, machine)?;
        let runs = virtual_test::simulate(test, machine, &scenario, &programs, repeats, &|| ())?;
        let truth = virtual_test::truth(test, machine, &scenario, &programs, &runs)?;
        let run = |of: virtual_test::VirtualRun| {
            let program = &programs[of.program];
            Run::simulated(test, program, of)
        };
        Ok(Simulation { runs: runs.into_iter().map(run).collect::<ballbar::Result<_>>()?, truth })
    })
}
