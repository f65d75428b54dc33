//! What the model gets wrong.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::campaign::{Campaign, Identified, Stated};
use crate::error::{argument, work};
use crate::words::dictionary;

/// A diagnosis with the campaign that it is of.
pub(crate) struct Diagnosed {
    pub(crate) stated: Arc<Stated>,
    pub(crate) diagnosis: ballbar::diagnose::Diagnosis,
}

/// What the model gets wrong.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Diagnosis {
    pub(crate) of: Arc<Diagnosed>,
}

#[pymethods]
impl Diagnosis {
    /// Whether nothing is wrong that these runs would show.
    #[getter]
    fn nothing_found(&self) -> bool {
        self.of.diagnosis.nothing_found()
    }

    /// The effects that were found, the largest first, as :func:`simulate` takes them.
    #[getter]
    fn effects(&self) -> Vec<String> {
        let findings = self.of.diagnosis.findings.iter();
        findings.flat_map(|finding| finding.effects.iter().map(ToString::to_string)).collect()
    }

    /// Residual of the model, and of the model with what was found, um rms.
    #[getter]
    fn before_after_um(&self) -> (f64, f64) {
        let verdict = &self.of.diagnosis.verdict;
        (1e3 * verdict.before_mm, 1e3 * verdict.after_mm)
    }

    /// The model with what was found, the text of model.toml.
    #[getter]
    fn model(&self) -> String {
        self.of.diagnosis.model_file(&self.of.stated.campaign).to_toml()
    }

    /// The campaign identified anew with what was found; the same where nothing was.
    #[getter]
    fn extended(&self) -> Campaign {
        Campaign { of: Identified::Extended(Arc::clone(&self.of)), elapsed_s: f64::NAN }
    }

    /// The diagnosis in analysis.json: docs/analysis-schema.md.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let facts = self.analysis(py)?.get_item("diagnosis")?;
        Ok(facts.map_or_else(|| Ok(PyDict::new(py)), Bound::cast_into)?)
    }

    /// What analysis.json of ``ballbar analyse`` holds: docs/analysis-schema.md.
    fn analysis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let json = work(py, || {
            let Stated { test, machine, campaign } = &*self.of.stated;
            ballbar::report::Analysis::diagnosed(test, machine, campaign, &self.of.diagnosis)
                .to_json()
        })?;
        dictionary(py, &json)
    }

    fn __repr__(&self) -> String {
        let effects = self.effects();
        let found = if effects.is_empty() { "nothing".to_owned() } else { effects.join(" + ") };
        format!("<ballbar.Diagnosis: {found}>")
    }
}

/// Look for what the model of a campaign gets wrong.
#[pyfunction]
pub(crate) fn diagnose(py: Python<'_>, campaign: &Campaign) -> PyResult<Diagnosis> {
    let Identified::Stated(stated) = &campaign.of else {
        return Err(argument(
            py,
            "campaign",
            "is one that a diagnosis has extended already",
            "diagnose what identify() returned",
        ));
    };
    let stated = Arc::clone(stated);
    work(py, || {
        let Stated { test, machine, campaign } = &*stated;
        let diagnosis = ballbar::diagnose::diagnose(test, machine, campaign)?;
        Ok(Diagnosis { of: Arc::new(Diagnosed { stated, diagnosis }) })
    })
}
