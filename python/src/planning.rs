//! What a test takes and what it will determine, and its programs.

use ballbar::design::Outlook;
use ballbar::identify::Answer;
use ballbar::report::{PlanReport, Planned};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{matrix, vector};
use crate::error::{argument, work};
use crate::test::Test;
use crate::words::dictionary;

/// An NC program of a test.
#[pyclass(frozen, module = "ballbar", get_all)]
pub(crate) struct Program {
    /// Name of its file.
    name: String,
    mounting: String,
    text: String,
}

#[pymethods]
impl Program {
    fn __repr__(&self) -> String {
        format!("<ballbar.Program {} for mounting {:?}>", self.name, self.mounting)
    }
}

/// Write the programs of a test's plan, one for each mounting.
#[pyfunction]
pub(crate) fn programs(py: Python<'_>, test: &Test) -> PyResult<Vec<Program>> {
    let programs = work(py, || {
        test.test.plan()?;
        ballbar::virtual_test::programs(&test.test, &test.machine.machine)
    })?;
    let mountings = test.test.mountings();
    let of = |program: ballbar::virtual_test::VirtualProgram| Program {
        name: program.file,
        mounting: mountings[program.mounting].name.clone(),
        text: program.text,
    };
    Ok(programs.into_iter().map(of).collect())
}

/// What a test takes and what it will determine; p parameters.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Plan {
    outlook: Outlook,
    json: String,
}

#[pymethods]
impl Plan {
    #[getter]
    fn names(&self) -> Vec<String> {
        self.outlook.prediction.parameters.iter().map(|of| of.name.clone()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.outlook.prediction.parameters.iter().map(|of| of.unit).collect()
    }

    /// Standard deviation of each parameter by the noise, in its unit, shape (p,).
    #[getter]
    fn sigma_noise<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.outlook.prediction.sigmas.clone())
    }

    /// How much of each the test determines, 0 to 1, shape (p,).
    #[getter]
    fn observed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.outlook.prediction.observed.clone())
    }

    /// Shape (p, p), in the units of the parameters.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.outlook.prediction.covariance)
    }

    #[getter]
    fn rank(&self) -> usize {
        self.outlook.prediction.rank
    }

    #[getter]
    fn samples(&self) -> usize {
        self.outlook.prediction.samples
    }

    /// Time that the machine takes, s.
    #[getter]
    fn machine_s(&self) -> f64 {
        self.outlook.time().machine_s()
    }

    /// Time with that of the operator, s.
    #[getter]
    fn total_s(&self) -> f64 {
        self.outlook.time().total_s()
    }

    /// What will be known at the place of the test; as :meth:`Identification.answers`.
    fn answers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        answers(py, &self.outlook.at_the_place)
    }

    /// What plan.json holds: docs/plan-schema.md.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dictionary(py, &self.json)
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Plan {:?}: {:.0} s>", self.outlook.name, self.total_s())
    }
}

/// Rehearse a test on a perfect virtual machine.
#[pyfunction]
#[pyo3(signature = (test, *, repeats = 1))]
pub(crate) fn plan(py: Python<'_>, test: &Test, repeats: u32) -> PyResult<Plan> {
    if !(1..=1000).contains(&repeats) {
        let what = format!("{repeats} where 1 to 1000 is expected");
        return Err(argument(py, "repeats", &what, "how often the test is run"));
    }
    let (test, machine) = (test.test.clone(), test.machine.machine.clone());
    work(py, || {
        let outlook = Outlook::new(&test, &machine)?;
        let planned = [Planned { test, machine, outlook }];
        let json = PlanReport::new(&planned, repeats).to_json()?;
        let [Planned { outlook, .. }] = planned;
        Ok(Plan { outlook, json })
    })
}

/// Answers by name, each with value and standard deviations in the unit that its keys end with.
pub(crate) fn answers<'py>(py: Python<'py>, of: &[Answer]) -> PyResult<Bound<'py, PyDict>> {
    let answers = PyDict::new(py);
    for answer in of {
        let (unit, of_unit) = answer.asked.unit();
        let one = PyDict::new(py);
        one.set_item("value", of_unit * answer.value)?;
        one.set_item("sigma_noise", of_unit * answer.noise)?;
        one.set_item("sigma_all", answer.all.map(|all| of_unit * all))?;
        one.set_item("unit", unit)?;
        answers.set_item(answer.asked.name(), one)?;
    }
    Ok(answers)
}
