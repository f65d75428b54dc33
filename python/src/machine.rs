//! The machine.

use std::path::PathBuf;

use ballbar::machine::{Axis, Builtin};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::rows;
use crate::error::work;
use crate::words::toml_of;

/// A machine: the order of its slides, their travels and accelerations, its control. It can be pickled.
#[pyclass(frozen, module = "ballbar", from_py_object)]
#[derive(Clone)]
pub(crate) struct Machine {
    pub(crate) machine: ballbar::machine::Machine,
    /// Its text, for workers elsewhere.
    text: String,
}

#[pymethods]
impl Machine {
    /// Read a machine file.
    #[staticmethod]
    pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        work(py, || {
            let machine = ballbar::machine::Machine::read(&path)?;
            let text = ballbar::nc::text_of(&path)?;
            Ok(Self { machine, text })
        })
    }

    /// Check the text of a machine file; ``file`` is for messages.
    #[staticmethod]
    #[pyo3(signature = (text, file = PathBuf::from("machine.toml")))]
    fn parse(py: Python<'_>, text: String, file: PathBuf) -> PyResult<Self> {
        work(py, || Ok(Self { machine: ballbar::machine::Machine::parse(&text, &file)?, text }))
    }

    /// A machine of a mapping with the keys of the file: docs/reference.md.
    #[staticmethod]
    fn of(py: Python<'_>, keys: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::parse(py, toml_of("keys", keys)?, PathBuf::from("machine.toml"))
    }

    /// A machine that is in the package: ``"vertical"``, ``"horizontal"`` or ``"hu40t"``.
    #[staticmethod]
    fn builtin(py: Python<'_>, name: &str) -> PyResult<Self> {
        work(py, || {
            let builtin = Builtin::named(name)?;
            Ok(Self { machine: builtin.machine()?, text: builtin.text.to_owned() })
        })
    }

    #[getter]
    fn name(&self) -> &str {
        self.machine.name()
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.machine.file().to_path_buf()
    }

    /// The text of the file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// From the workpiece ``w`` over the slides to the tool ``t``.
    #[getter]
    fn topology(&self) -> String {
        self.machine.topology().as_str().to_owned()
    }

    /// Lowest and highest machine coordinate of X, Y, Z, mm, shape (3, 2).
    #[getter]
    fn travel_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let travels = Axis::ALL.iter().flat_map(|axis| self.machine.slide(*axis).travel_mm);
        rows(py, travels.collect(), 2)
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Machine {:?} {}>", self.machine.name(), self.topology())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let of = slf.get();
        Ok((slf.get_type().getattr("parse")?, (of.text.clone(), of.file())))
    }
}
