//! The test.

use std::path::PathBuf;

use ballbar::solve::Loss;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{rows, vector};
use crate::error::{argument, work};
use crate::machine::Machine;
use crate::words::toml_of;

/// A test: machine, bar, mountings, arcs, what is estimated, and the runs that were measured. It can be pickled.
#[pyclass(frozen, module = "ballbar", from_py_object)]
#[derive(Clone)]
pub(crate) struct Test {
    pub(crate) test: ballbar::plan::Test,
    pub(crate) machine: Machine,
    text: String,
}

#[pymethods]
impl Test {
    /// Read a test file and, unless one is given, the machine file that it names.
    #[staticmethod]
    #[pyo3(signature = (path, machine = None))]
    fn read(py: Python<'_>, path: PathBuf, machine: Option<Machine>) -> PyResult<Self> {
        let text = work(py, || ballbar::nc::text_of(&path))?;
        Self::parse(py, text, machine, path)
    }

    /// Check the text of a test file; paths in it are relative to the folder of ``file``.
    #[staticmethod]
    #[pyo3(signature = (text, machine = None, file = PathBuf::from("test.toml")))]
    fn parse(
        py: Python<'_>,
        text: String,
        machine: Option<Machine>,
        file: PathBuf,
    ) -> PyResult<Self> {
        let test = work(py, || ballbar::plan::Test::parse(&text, &file))?;
        let machine = if let Some(machine) = machine {
            machine
        } else {
            let files = test.files();
            // After the test's own file stands that of its machine.
            Machine::read(py, files.get(1).cloned().unwrap_or_default())?
        };
        Ok(Self { test, machine, text })
    }

    /// A test of a mapping with the keys of the file; with a machine, ``"machine"`` need not be among them.
    #[staticmethod]
    #[pyo3(signature = (keys, machine = None, file = PathBuf::from("test.toml")))]
    fn of(
        py: Python<'_>,
        keys: &Bound<'_, PyAny>,
        machine: Option<Machine>,
        file: PathBuf,
    ) -> PyResult<Self> {
        let copy = PyDict::new(py);
        let given = keys.cast::<pyo3::types::PyMapping>().map_err(|_| {
            argument(
                py,
                "keys",
                "is no dictionary",
                "it has the keys of a test file: docs/reference.md",
            )
        })?;
        copy.update(given)?;
        if machine.is_some() && !copy.contains("machine")? {
            copy.set_item("machine", "machine.toml")?;
        }
        Self::parse(py, toml_of("keys", &copy)?, machine, file)
    }

    /// The same test with another choice of what is estimated: the keys of ``[identify]``.
    #[pyo3(signature = (*, terms = None, loss = None, minimum_norm = None))]
    pub(crate) fn estimating(
        &self,
        py: Python<'_>,
        terms: Option<Vec<String>>,
        loss: Option<&str>,
        minimum_norm: Option<bool>,
    ) -> PyResult<Self> {
        let mut estimation = self.test.estimation().clone();
        if let Some(terms) = terms {
            estimation.minimum_norm |= terms.iter().any(|name| name == "all");
            estimation.terms = terms;
        }
        if let Some(loss) = loss {
            let named = Loss::NAMED.into_iter().find(|(name, _)| *name == loss);
            estimation.loss = named.map(|(_, loss)| loss).ok_or_else(|| {
                let names = Loss::NAMED.map(|(name, _)| format!("{name:?}")).join(", ");
                argument(py, "loss", &format!("{loss:?} is none"), &format!("one of {names}"))
            })?;
        }
        if let Some(minimum_norm) = minimum_norm {
            estimation.minimum_norm = minimum_norm;
        }
        Ok(Self { test: self.test.clone().with_estimation(estimation), ..self.clone() })
    }

    #[getter]
    fn name(&self) -> &str {
        self.test.name()
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.test.file().to_path_buf()
    }

    /// The text of the file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    #[getter]
    fn machine(&self) -> Machine {
        self.machine.clone()
    }

    #[getter]
    fn terms(&self) -> Vec<String> {
        self.test.estimation().terms.clone()
    }

    /// Their names, in order.
    #[getter]
    fn mountings(&self) -> Vec<String> {
        self.test.mountings().iter().map(|mounting| mounting.name.clone()).collect()
    }

    /// Where the balls coincide in each mounting, machine coordinates, mm, shape (mountings, 3).
    #[getter]
    fn coincidence_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mountings = self.test.mountings().iter();
        let places = mountings.flat_map(|of| <[f64; 3]>::from(of.mounting.coincidence_mm));
        rows(py, places.collect(), 3)
    }

    /// The tool ball in the frame of the last slide on the tool side, mm, shape (mountings, 3).
    #[getter]
    fn tool_ball_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mountings = self.test.mountings().iter();
        let places = mountings.flat_map(|of| <[f64; 3]>::from(of.mounting.tool_ball_mm));
        rows(py, places.collect(), 3)
    }

    /// Nominal length of the bar in each mounting, mm, shape (mountings,).
    #[getter]
    fn bar_length_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.test.mountings().iter().map(|of| of.bar_length_mm).collect())
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Test {:?} on {:?}>", self.test.name(), self.machine.machine.name())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Test3, Estimating))> {
        let of = slf.get();
        let estimation = of.test.estimation();
        let loss = Loss::NAMED.into_iter().find(|(_, loss)| *loss == estimation.loss);
        let estimating =
            (estimation.terms.clone(), loss.map(|(name, _)| name), estimation.minimum_norm);
        let test = (of.text.clone(), of.machine.clone(), of.file());
        Ok((slf.get_type().getattr("_again")?, (test, estimating)))
    }

    #[staticmethod]
    fn _again(
        py: Python<'_>,
        test: Test3,
        estimating: (Vec<String>, Option<String>, bool),
    ) -> PyResult<Self> {
        let (terms, loss, minimum_norm) = estimating;
        let test = Self::parse(py, test.0, Some(test.1), test.2)?;
        test.estimating(py, Some(terms), loss.as_deref(), Some(minimum_norm))
    }
}

/// Text, machine and file.
type Test3 = (String, Machine, PathBuf);
/// Terms, loss and whether of all solutions the shortest is taken.
type Estimating = (Vec<String>, Option<&'static str>, bool);
