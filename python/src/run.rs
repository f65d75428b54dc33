//! A run: a program and what the bar read while it ran.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ballbar::identify::MeasuredRun;
use ballbar::log::{Log, Reading};
use ballbar::nc::Source;
use ballbar::simulate::TruePoint;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{Numbers, rows, vector};
use crate::error::{argument, of_argument, work};
use crate::test::Test;

/// A program that ran and what the bar read. It can be pickled, without what is true of a simulated run.
///
/// Its arrays are checked and copied once.
///
/// Args:
///     program: text of the program.
///     time_s: on the instrument's clock, increasing, s, shape (n,), C-contiguous float64.
///     deviation_um: length minus nominal length, um, shape (n,); NaN where the bar was out of range.
///     name: what it is called in messages.
///     mounting: its name; may be left out where the test has one.
///     repeat: runs of the same repeat are identified together.
///     feed_override_percent: where the knob stood, 1 to 200.
#[pyclass(frozen, module = "ballbar", from_py_object)]
#[derive(Clone)]
pub(crate) struct Run {
    name: String,
    mounting: String,
    repeat: u32,
    feed_override_percent: f64,
    log: Log,
    source: Arc<Source>,
    truth: Option<Arc<Vec<TruePoint>>>,
}

#[pymethods]
impl Run {
    #[new]
    #[pyo3(signature = (program, time_s, deviation_um, *, name = "run1", mounting = "", repeat = 1, feed_override_percent = 100.0))]
    #[allow(clippy::too_many_arguments)] // by name
    fn new(
        py: Python<'_>,
        program: String,
        time_s: &Bound<'_, PyAny>,
        deviation_um: &Bound<'_, PyAny>,
        name: &str,
        mounting: &str,
        repeat: u32,
        feed_override_percent: f64,
    ) -> PyResult<Self> {
        if !(1.0..=200.0).contains(&feed_override_percent) {
            let what = format!("{feed_override_percent} where 1 to 200 is expected");
            return Err(argument(
                py,
                "feed_override_percent",
                &what,
                "100 where the knob stood at the programmed feed",
            ));
        }
        let log = log_of(py, name, time_s, deviation_um)?;
        let source = Arc::new(Source { file: format!("{name}.nc").into(), text: program });
        Ok(Self {
            name: name.to_owned(),
            mounting: mounting.to_owned(),
            repeat,
            feed_override_percent,
            log,
            source,
            truth: None,
        })
    }

    /// The same run with other readings at its times, um, shape (n,): to hide an effect of one's own.
    fn with_deviation_um(&self, py: Python<'_>, deviation_um: &Bound<'_, PyAny>) -> PyResult<Self> {
        let time_s = self.time_s(py);
        Ok(Self { log: log_of(py, &self.name, time_s.as_any(), deviation_um)?, ..self.clone() })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn program(&self) -> &str {
        &self.source.text
    }

    #[getter]
    fn mounting(&self) -> &str {
        &self.mounting
    }

    #[getter]
    fn repeat(&self) -> u32 {
        self.repeat
    }

    #[getter]
    fn feed_override_percent(&self) -> f64 {
        self.feed_override_percent
    }

    /// Shape (n,), s; a copy.
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.log.readings().iter().map(|reading| reading.time_s).collect())
    }

    /// Shape (n,), um, NaN out of range; a copy.
    #[getter]
    fn deviation_um<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let um = |reading: &Reading| reading.deviation_mm.map_or(f64::NAN, |mm| 1e3 * mm);
        vector(py, self.log.readings().iter().map(um).collect())
    }

    /// What the bar would have read without noise, steps and range, um, shape (n,); of a simulated run.
    #[getter]
    fn true_deviation_um<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let truth = self.truth.as_ref()?;
        Some(vector(py, truth.iter().map(|point| 1e3 * point.exact_mm).collect()))
    }

    /// Where the slides were commanded to be, mm, shape (n, 3); of a simulated run.
    #[getter]
    fn true_position_mm<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(truth) = self.truth.as_ref() else { return Ok(None) };
        let places = truth.iter().flat_map(|point| <[f64; 3]>::from(point.state.position_mm));
        rows(py, places.collect(), 3).map(Some)
    }

    /// Where in its program the machine was, s, shape (n,); of a simulated run.
    #[getter]
    fn true_program_s<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let truth = self.truth.as_ref()?;
        Some(vector(py, truth.iter().map(|point| point.moment.program_s).collect()))
    }

    fn __len__(&self) -> usize {
        self.log.readings().len()
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Run {:?}: {} readings>", self.name, self.log.readings().len())
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, (String, String, u32, f64)),
    )> {
        let (py, of) = (slf.py(), slf.get());
        let rest = (of.name.clone(), of.mounting.clone(), of.repeat, of.feed_override_percent);
        let arrays = (of.source.text.clone(), of.time_s(py), of.deviation_um(py), rest);
        Ok((slf.get_type().getattr("_again")?, arrays))
    }

    #[staticmethod]
    fn _again(
        py: Python<'_>,
        program: String,
        time_s: &Bound<'_, PyAny>,
        deviation_um: &Bound<'_, PyAny>,
        rest: (String, String, u32, f64),
    ) -> PyResult<Self> {
        let (name, mounting, repeat, feed) = rest;
        Self::new(py, program, time_s, deviation_um, &name, &mounting, repeat, feed)
    }
}

impl Run {
    /// A run that was simulated; its log as its file has it.
    pub(crate) fn simulated(
        test: &ballbar::plan::Test,
        program: &ballbar::virtual_test::VirtualProgram,
        of: ballbar::virtual_test::VirtualRun,
    ) -> ballbar::Result<Self> {
        let csv = of.run.csv();
        let format = ballbar::log::Format::default();
        let log = ballbar::log::read_bytes(csv.as_bytes(), Path::new(&of.log), &format)?;
        let name = of.log.strip_suffix(".csv").unwrap_or(&of.log).to_owned();
        Ok(Self {
            name,
            mounting: test.mountings()[program.mounting].name.clone(),
            repeat: of.repeat,
            feed_override_percent: 100.0,
            log,
            source: Arc::new(Source {
                file: program.file.clone().into(),
                text: program.text.clone(),
            }),
            truth: Some(Arc::new(of.run.truth)),
        })
    }

    fn measured(&self, test: &Test, mounting: usize) -> MeasuredRun {
        debug_assert!(mounting < test.test.mountings().len());
        MeasuredRun {
            name: self.name.clone(),
            mounting,
            feed_override: self.feed_override_percent / 100.0,
            log: self.log.clone(),
            source: Arc::clone(&self.source),
            motion: None,
        }
    }
}

fn log_of(
    py: Python<'_>,
    name: &str,
    time_s: &Bound<'_, PyAny>,
    deviation_um: &Bound<'_, PyAny>,
) -> PyResult<Log> {
    let time_s = Numbers::of("time_s", time_s, &[None])?;
    let deviation_um = Numbers::of("deviation_um", deviation_um, &[None])?;
    let log = Log::of_columns(Path::new(name), time_s.slice()?, deviation_um.slice()?);
    log.map_err(|error| {
        let of = if error.what.starts_with("time ") { "time_s" } else { "deviation_um" };
        of_argument(py, of, &error)
    })
}

/// The runs of a test by repeat: those that are given, else those that the test names, read.
pub(crate) fn repeats(
    py: Python<'_>,
    test: &Test,
    runs: Option<Vec<Run>>,
) -> PyResult<Vec<Vec<MeasuredRun>>> {
    let mut repeats: BTreeMap<u32, Vec<MeasuredRun>> = BTreeMap::new();
    let Some(runs) = runs else {
        return work(py, || {
            for run in test.test.runs()? {
                repeats.entry(run.repeat).or_default().push(MeasuredRun::read(&test.test, run)?);
            }
            Ok(repeats.into_values().collect())
        });
    };
    if runs.is_empty() {
        return Err(argument(
            py,
            "runs",
            "an empty list where runs are expected",
            "leave it out to read those of the test file",
        ));
    }
    let mountings = test.test.mountings().iter();
    let names: Vec<&str> = mountings.map(|mounting| mounting.name.as_str()).collect();
    for run in &runs {
        let mounting = if run.mounting.is_empty() && names.len() == 1 {
            0
        } else {
            names.iter().position(|name| *name == run.mounting).ok_or_else(|| {
                let what = format!(
                    "{:?} has the mounting {:?}, which the test does not have",
                    run.name, run.mounting
                );
                argument(py, "runs", &what, &format!("mounting= is one of {names:?}"))
            })?
        };
        repeats.entry(run.repeat).or_default().push(run.measured(test, mounting));
    }
    Ok(repeats.into_values().collect())
}
