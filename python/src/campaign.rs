//! What was identified: all repeats of a test.

use std::sync::Arc;

use ballbar::identify::{self, Options};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::diagnosis::Diagnosed;
use crate::error::work;
use crate::identification::Identification;
use crate::words::dictionary;

/// What was identified, as it was or with what a diagnosis has found.
#[derive(Clone)]
pub(crate) enum Identified {
    Stated(Arc<Stated>),
    Extended(Arc<Diagnosed>),
}

/// A campaign with the test and the machine that it was identified with.
pub(crate) struct Stated {
    pub(crate) test: ballbar::plan::Test,
    pub(crate) machine: ballbar::machine::Machine,
    pub(crate) campaign: identify::Campaign,
}

impl Identified {
    pub(crate) fn test(&self) -> &ballbar::plan::Test {
        match self {
            Self::Stated(of) => &of.test,
            Self::Extended(of) => {
                of.diagnosis.extended.as_ref().map_or(&of.stated.test, |of| &of.test)
            }
        }
    }

    pub(crate) fn machine(&self) -> &ballbar::machine::Machine {
        match self {
            Self::Stated(of) => &of.machine,
            Self::Extended(of) => {
                of.diagnosis.extended.as_ref().map_or(&of.stated.machine, |of| &of.machine)
            }
        }
    }

    pub(crate) fn campaign(&self) -> &identify::Campaign {
        match self {
            Self::Stated(of) => &of.campaign,
            Self::Extended(of) => {
                of.diagnosis.extended.as_ref().map_or(&of.stated.campaign, |of| &of.campaign)
            }
        }
    }

    /// The model of a repeat.
    pub(crate) fn model(&self, repeat: usize) -> ballbar::Result<ballbar::model::Model<'_>> {
        self.campaign().model(self.test(), self.machine(), repeat)
    }

    pub(crate) fn options(&self) -> Options {
        Options::of(self.test())
    }
}

/// All repeats of a test, identified; indexing gives an :class:`Identification`.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Campaign {
    pub(crate) of: Identified,
    /// NaN of a campaign that came of a diagnosis.
    pub(crate) elapsed_s: f64,
}

#[pymethods]
impl Campaign {
    #[getter]
    fn terms(&self) -> Vec<String> {
        self.of.campaign().terms.clone()
    }

    #[getter]
    fn repeats(&self) -> Vec<Identification> {
        let count = self.of.campaign().repeats.len();
        (0..count).map(|repeat| Identification { of: self.of.clone(), repeat }).collect()
    }

    /// Runs that took no part, each with the reason.
    #[getter]
    fn left_out(&self) -> Vec<(String, String)> {
        let left_out = self.of.campaign().left_out.iter();
        left_out.map(|(name, error)| (name.clone(), error.what.clone())).collect()
    }

    #[getter]
    fn cautions(&self) -> Vec<String> {
        self.of.campaign().cautions(self.of.test(), self.of.machine())
    }

    /// How long the library took, s; NaN of a campaign that came of a diagnosis.
    #[getter]
    fn elapsed_s(&self) -> f64 {
        self.elapsed_s
    }

    /// What analysis.json holds: docs/analysis-schema.md.
    fn analysis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let json = work(py, || {
            let (test, machine, campaign) = (self.of.test(), self.of.machine(), self.of.campaign());
            ballbar::report::Analysis::new(test, machine, campaign).to_json()
        })?;
        dictionary(py, &json)
    }

    fn __len__(&self) -> usize {
        self.of.campaign().repeats.len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<Identification> {
        let count = self.__len__();
        let at = if index < 0 { index + count as isize } else { index };
        match usize::try_from(at) {
            Ok(repeat) if repeat < count => Ok(Identification { of: self.of.clone(), repeat }),
            // What ends a loop over it.
            _ => Err(PyIndexError::new_err(format!("there are {count} repeats"))),
        }
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Campaign {:?}: {} repeats>", self.of.test().name(), self.__len__())
    }
}
