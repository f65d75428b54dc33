//! Blind trials, one at a time.

use std::path::PathBuf;

use ballbar::report::trial_json;
use ballbar::trial::{Class, Course, Request, Session};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{argument, work};
use crate::words::dictionary;

/// Effects hidden at random in simulated campaigns, diagnosed without knowing: the trials of ``ballbar blind``.
///
/// A trial is its seed, its class and its index: the same three give the same result, wherever it is computed, but for
/// how long it took.
///
/// Args:
///     seed: where everything random begins.
///     size_um: size of every hidden effect, um rms outside of the model, 0.001 to 100; that of its class where none.
///     test: a test file whose programs are driven, instead of the campaign that is in the package.
///     repeats: how often the plan of that test is repeated, 1 to 1000, instead of its runs.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Trials {
    session: Session,
}

#[pymethods]
impl Trials {
    #[new]
    #[pyo3(signature = (seed = 1, *, size_um = None, test = None, repeats = None))]
    fn new(
        py: Python<'_>,
        seed: u64,
        size_um: Option<f64>,
        test: Option<PathBuf>,
        repeats: Option<u32>,
    ) -> PyResult<Self> {
        if let Some(um) = size_um.filter(|um| !(1e-3..=100.0).contains(um)) {
            let what = format!("{um} where 0.001 to 100 is expected");
            return Err(argument(py, "size_um", &what, "um rms outside of the model"));
        }
        if let Some(repeats) = repeats.filter(|of| test.is_none() || !(1..=1000).contains(of)) {
            let what = format!("{repeats} where 1 to 1000 and a test is expected");
            return Err(argument(py, "repeats", &what, "how often the plan of test= is repeated"));
        }
        work(py, || {
            let course = match &test {
                Some(file) => Course::of(file, repeats)?,
                None => Course::built_in()?,
            };
            Ok(Self { session: Session::new(course, seed, size_um.map(|um| um * 1e-3))? })
        })
    }

    /// Does one trial: what ``ballbar blind --json`` says of it.
    ///
    /// ``kind`` is ``"single"``, ``"small"``, ``"sizes"``, ``"none"``, ``"two"`` or ``"outside"``.
    fn trial<'py>(&self, py: Python<'py>, kind: &str, index: u64) -> PyResult<Bound<'py, PyDict>> {
        let Some(class) = Class::parse(kind) else {
            let names = Class::ALL.map(Class::name).join(", ");
            let what = format!("{kind:?} is none");
            return Err(argument(py, "kind", &what, &format!("one of {names}")));
        };
        let requests = [Request { class, index }];
        let outcomes = work(py, || self.session.run(&requests, &|_| ()))?;
        let json = outcomes.first().map(|outcome| trial_json(outcome).to_string());
        dictionary(py, &json.unwrap_or_default())
    }
}
