//! Samples as columns: each number of all samples in one array, its unit in its name.

use ballbar::align::{Part, Sample};
use ballbar::identify::Record;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{rows, vector};

/// Where samples were taken.
pub(crate) fn places<'py, 'a>(
    py: Python<'py>,
    samples: impl Iterator<Item = &'a Sample> + Clone,
) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let numbers = |of: fn(&Sample) -> f64| vector(py, samples.clone().map(of).collect());
    columns.set_item("log_s", numbers(|sample| sample.log_s))?;
    columns.set_item("program_s", numbers(|sample| sample.program_s))?;
    columns.set_item("time_sigma_s", numbers(|sample| sample.time_sigma_s))?;
    columns.set_item("elapsed_s", numbers(|sample| sample.motion.elapsed_s))?;
    columns.set_item("deviation_um", numbers(|sample| 1e3 * sample.deviation_mm))?;
    let triples = |of: fn(&Sample) -> [f64; 3]| rows(py, samples.clone().flat_map(of).collect(), 3);
    columns.set_item("position_mm", triples(|sample| sample.pose.position_mm.into())?)?;
    columns.set_item("velocity_mm_s", triples(|sample| sample.motion.velocity_mm_s.into())?)?;
    columns.set_item("sense", triples(|sample| sample.pose.sense.into())?)?;
    let arc = |sample: &Sample| match sample.part {
        Part::Arc(index) => index as i64,
        Part::Ramp | Part::Dwell | Part::Stop => -1,
    };
    columns.set_item("arc", vector(py, samples.clone().map(arc).collect()))?;
    columns.set_item("leg", vector(py, samples.clone().map(|s| s.leg as i64).collect()))?;
    columns.set_item("line", vector(py, samples.map(|s| s.line as i64).collect()))?;
    Ok(columns)
}

/// Where readings were taken, and what became of them.
pub(crate) fn records<'py>(py: Python<'py>, records: &[Record]) -> PyResult<Bound<'py, PyDict>> {
    let columns = places(py, records.iter().map(|record| &record.sample))?;
    let numbers = |of: fn(&Record) -> f64| vector(py, records.iter().map(of).collect());
    columns.set_item("computed_um", numbers(|record| 1e3 * record.computed_mm))?;
    columns.set_item("residual_um", numbers(|record| 1e3 * record.residual_mm))?;
    columns.set_item("whitened", numbers(|record| record.whitened.unwrap_or(f64::NAN)))?;
    columns.set_item("weight", numbers(|record| record.weight))?;
    columns.set_item("used", vector(py, records.iter().map(Record::used).collect()))?;
    let apart = records.iter().map(|record| record.apart.map_or("", |apart| apart.word()));
    columns.set_item("apart", apart.collect::<Vec<_>>())?;
    Ok(columns)
}
