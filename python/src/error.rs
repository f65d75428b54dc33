//! Errors of the library as the package's one exception, and work without the interpreter's lock.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ballbar::error::Kind;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What an error of the library is in Python.
pub(crate) fn raised(py: Python<'_>, error: &ballbar::Error) -> PyErr {
    let kind = match error.kind {
        Kind::Input => "input",
        Kind::Mismatch => "mismatch",
        Kind::Undetermined => "undetermined",
        Kind::Output => "output",
    };
    let place = error.place.as_deref();
    made(py, &error.what, |of| {
        of.set_item("kind", kind)?;
        of.set_item("hint", error.hint.as_deref())?;
        if let Some(place) = place {
            of.set_item("file", place.file.to_string_lossy())?;
            of.set_item("line", (place.line > 0).then_some(place.line))?;
            of.set_item("column", (place.column > 0).then_some(place.column))?;
            of.set_item("text", (!place.text.is_empty()).then_some(&place.text))?;
        }
        Ok(())
    })
}

/// An argument that cannot be used.
pub(crate) fn argument(py: Python<'_>, name: &str, what: &str, hint: &str) -> PyErr {
    made(py, &format!("{name}: {what}"), |of| {
        of.set_item("argument", name)?;
        of.set_item("hint", hint)
    })
}

/// What the library said of an argument.
pub(crate) fn of_argument(py: Python<'_>, name: &str, error: &ballbar::Error) -> PyErr {
    argument(py, name, &error.what, error.hint.as_deref().unwrap_or("see the documentation"))
}

fn made(py: Python<'_>, what: &str, with: impl Fn(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    let made = || {
        let of = PyDict::new(py);
        with(&of)?;
        py.import("ballbar._error")?.getattr("Error")?.call((what,), Some(&of))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Does work of the library without the interpreter's lock; a fault in it becomes an error, too.
pub(crate) fn work<T: Send>(
    py: Python<'_>,
    what: impl FnOnce() -> ballbar::Result<T> + Send,
) -> PyResult<T> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(what))) {
        Ok(done) => done.map_err(|error| raised(py, &error)),
        Err(fault) => Err(made(py, &format!("a fault in ballbar: {}", words(&*fault)), |of| {
            of.set_item("kind", "internal")?;
            of.set_item("hint", "please report it, with the files or arrays that it came of")
        })),
    }
}

fn words(fault: &(dyn Any + Send)) -> &str {
    let words = fault.downcast_ref::<&str>().copied();
    words.or_else(|| fault.downcast_ref::<String>().map(String::as_str)).unwrap_or("no words")
}

/// A fault, for the test that says what becomes of one.
#[pyfunction]
#[allow(clippy::panic)] // it is what it is for
pub(crate) fn _panic(py: Python<'_>) -> PyResult<()> {
    work(py, || panic!("asked for"))
}
