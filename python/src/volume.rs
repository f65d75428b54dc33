//! The map of the volumetric error.

use ballbar::compensate::{Field, MOST_POINTS, Measured, VolumeMap};
use ballbar::machine::Axis;
use ballbar::report::{Mapped, volume_json};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Numbers, rows, vector};
use crate::error::{argument, work};
use crate::source::Source;
use crate::words::dictionary;

/// How far the tool is from where it should be; n points, X the fastest.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Volume {
    map: VolumeMap,
    json: String,
}

impl Volume {
    fn triples<'py>(
        &self,
        py: Python<'py>,
        of: fn(&ballbar::compensate::Node) -> [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.map.nodes.iter().flat_map(of).collect(), 3)
    }
}

#[pymethods]
impl Volume {
    /// Points along X, Y, Z.
    #[getter]
    fn counts(&self) -> [usize; 3] {
        self.map.counts
    }

    /// Machine coordinates, mm, shape (n, 3).
    #[getter]
    fn position_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |node| node.position_mm.into())
    }

    /// Displacement of the tool against the workpiece, mean of both senses, um, shape (n, 3).
    #[getter]
    fn error_um<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |node| [0, 1, 2].map(|k| 1e3 * node.error[k].value_mm))
    }

    /// Standard deviations by the noise, um, shape (n, 3).
    #[getter]
    fn sigma_noise_um<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |node| [0, 1, 2].map(|k| 1e3 * node.error[k].sigmas.noise))
    }

    /// And with what the runs leave open, um, shape (n, 3).
    #[getter]
    fn sigma_all_um<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |node| [0, 1, 2].map(|k| 1e3 * node.error[k].sigmas.all))
    }

    /// Whether something was measured near, shape (n,).
    #[getter]
    fn near<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        vector(py, self.map.nodes.iter().map(|node| node.near).collect())
    }

    /// What volume.json holds: docs/volume-schema.md.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dictionary(py, &self.json)
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Volume: {} points>", self.map.nodes.len())
    }
}

/// Map the volumetric error over what was measured, the travel, or a box.
///
/// Args:
///     source: what was identified or diagnosed, or the path of an analysis.json or of its folder.
///     box_mm: lowest and highest machine coordinate of X, Y, Z, mm, shape (3, 2).
///     tool_mm: tip of the tool in the frame of the last slide on the tool side, mm, shape (3,).
///     points: along each axis, 2 to 21.
///     keep_rigid: leave the rigid motion of the workpiece in.
#[pyfunction]
#[pyo3(signature = (source, *, box_mm = None, travel = false, tool_mm = None, points = 9, keep_rigid = false))]
pub(crate) fn volume(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    box_mm: Option<&Bound<'_, PyAny>>,
    travel: bool,
    tool_mm: Option<&Bound<'_, PyAny>>,
    points: usize,
    keep_rigid: bool,
) -> PyResult<Volume> {
    let most = MOST_POINTS;
    if !(2..=most).contains(&points) {
        let what = format!("{points} where 2 to {most} is expected");
        return Err(argument(py, "points", &what, "points along each axis"));
    }
    let source = Source::of(source)?;
    let given = |name: &str, array: &Bound<'_, PyAny>, shape: &[Option<usize>]| {
        let numbers = Numbers::of(name, array, shape)?;
        numbers.finite(py, name).map(<[f64]>::to_vec)
    };
    let ends_mm = box_mm.map(|of| given("box_mm", of, &[Some(3), Some(2)])).transpose()?;
    let tool_mm = tool_mm.map(|of| given("tool_mm", of, &[Some(3)])).transpose()?;
    let analysed = work(py, || source.analysed())?;
    let errors = &analysed.errors;
    let travels = Axis::ALL.map(|axis| errors.machine.slide(axis).travel_mm);
    let mut ends = if travel {
        [0, 1].map(|k| travels.map(|of| of[k]).into())
    } else {
        Measured::by(errors).range_mm()
    };
    if let Some(of) = &ends_mm {
        for axis in Axis::ALL {
            let k = axis.index();
            let ([low, high], [least, most]) = ([of[2 * k], of[2 * k + 1]], travels[k]);
            if low > high || low < least || high > most {
                let what = format!(
                    "row {k} goes from {low} to {high} mm, and the travel of {axis} from {least} to {most} mm"
                );
                let hint =
                    "rows are X, Y, Z, columns the lowest and the highest machine coordinate";
                return Err(argument(py, "box_mm", &what, hint));
            }
            (ends[0][k], ends[1][k]) = (low, high);
        }
    }
    work(py, || {
        let mut tool_ball_mm = errors.mountings[0].1.tool_ball_mm;
        if let Some(of) = &tool_mm {
            tool_ball_mm.copy_from_slice(of);
        }
        let field = Field::new(errors, tool_ball_mm)?;
        let volume = ballbar::compensate::Volume { ends_mm: ends, points, keep_rigid };
        let map = VolumeMap::of(&field, &volume);
        let mapped = Mapped {
            test: analysed.test.clone(),
            file: analysed.file.to_string_lossy().into_owned(),
            compensation: analysed.compensation.clone(),
            errors,
            tool_ball_mm,
            map,
        };
        let json = volume_json(&mapped).to_string();
        Ok(Volume { map: mapped.map, json })
    })
}
