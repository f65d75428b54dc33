//! Where Python says the errors of a machine are.

use std::path::PathBuf;
use std::sync::Arc;

use ballbar::compensate::Analysed;
use pyo3::prelude::*;

use crate::campaign::{Campaign, Identified};
use crate::diagnosis::Diagnosis;
use crate::error::argument;

/// Where the errors of a machine are.
pub(crate) enum Source {
    Identified(Identified),
    File(PathBuf),
}

impl Source {
    pub(crate) fn of(source: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(campaign) = source.cast::<Campaign>() {
            return Ok(Self::Identified(campaign.get().of.clone()));
        }
        if let Ok(diagnosis) = source.cast::<Diagnosis>() {
            return Ok(Self::Identified(Identified::Extended(Arc::clone(&diagnosis.get().of))));
        }
        source.extract().map(Self::File).map_err(|_| {
            let kind =
                source.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
            let what = format!("a {kind} where a Campaign, a Diagnosis or a path is expected");
            argument(
                source.py(),
                "source",
                &what,
                "a path is that of analysis.json or of its folder",
            )
        })
    }

    pub(crate) fn analysed(&self) -> ballbar::Result<Analysed> {
        match self {
            Self::File(path) => Analysed::read(&ballbar::monitor::resolved(path)?, None),
            Self::Identified(of) => {
                let stated = match of {
                    Identified::Stated(of) => of,
                    Identified::Extended(of) => &of.stated,
                };
                let diagnosis = match of {
                    Identified::Stated(_) => None,
                    Identified::Extended(of) => Some(&of.diagnosis),
                };
                let (test, machine) = (&stated.test, &stated.machine);
                Analysed::of(test, machine, &stated.campaign, diagnosis).ok_or_else(|| {
                    ballbar::Error::input(
                        "this test does not describe the machine where it was measured",
                    )
                    .hint("identify it without terms=, or with terms=[\"local\"]")
                })
            }
        }
    }
}
