//! What a control takes to compensate the machine.

use ballbar::compensate::{self as of_errors, Compensating, Control, Limits, Named, Worth};
use ballbar::machine::Axis;
use ballbar::report::{Compensated, compensation_json, compensation_text};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Numbers;
use crate::error::{argument, work};
use crate::source::Source;
use crate::words::dictionary;

/// Files for a control that compensates, and what they leave.
#[pyclass(frozen, module = "ballbar")]
pub(crate) struct Compensation {
    control: Control,
    files: Vec<Named>,
    text: String,
    json: String,
}

#[pymethods]
impl Compensation {
    /// The control.
    #[getter]
    fn control(&self) -> &'static str {
        self.control.name()
    }

    /// Texts of the files by their names, as the control takes them.
    #[getter]
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, text) in &self.files {
            files.set_item(name, text)?;
        }
        Ok(files)
    }

    /// The page that says how they are loaded, how the sign is checked at one point, and what they leave.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// What `ballbar compensate --json` tells: docs/compensation-schema.md.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dictionary(py, &self.json)
    }

    fn __repr__(&self) -> String {
        format!("<ballbar.Compensation for {}: {} files>", self.control.name(), self.files.len())
    }
}

/// Write what a control takes to compensate the machine; nothing is written to disk.
///
/// Args:
///     source: what was identified or diagnosed, or the path of an analysis.json or of its folder.
///     control: "linuxcnc", "isg", "siemens", "fanuc", "klipper", "marlin", "reprapfirmware", "grblhal" or "csv".
///     tool_mm: tip of the tool in the frame of the last slide on the tool side, mm, shape (3,).
///     at_mm: machine coordinates of the other slides while one moves, mm, shape (3,).
///     step_mm: distance of the points of a table, 0.1 to 1000.
///     points: of a table at the most, 2 to 5000.
///     tables: for other axes at the most, 0 to 62.
///     unit_um: detection unit of the axes, 0.001 to 10.
///     on_top: names and texts of the files that were active when the machine was measured.
#[pyfunction]
#[pyo3(signature = (source, control, *, tool_mm = None, at_mm = None, step_mm = None, points = None, tables = None, unit_um = None, on_top = None))]
// As many as the command has options.
#[expect(clippy::too_many_arguments)]
pub(crate) fn compensate(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    control: &str,
    tool_mm: Option<&Bound<'_, PyAny>>,
    at_mm: Option<&Bound<'_, PyAny>>,
    step_mm: Option<f64>,
    points: Option<usize>,
    tables: Option<usize>,
    unit_um: Option<f64>,
    on_top: Option<Vec<Named>>,
) -> PyResult<Compensation> {
    let control = Control::named(control).ok_or_else(|| {
        let names = Control::ALL.map(Control::name).join(", ");
        argument(py, "control", &format!("`{control}` is no control"), &format!("one of {names}"))
    })?;
    let usual = control.limits();
    let within = |name: &str, value: f64, [low, high]: [f64; 2]| {
        let what = format!("{value} where {low} to {high} is expected");
        let inside = (low..=high).contains(&value);
        inside.then_some(value).ok_or_else(|| argument(py, name, &what, "see the documentation"))
    };
    let count = |name: &str, value: Option<usize>, usual: usize, bounds: [f64; 2]| {
        value.map_or(Ok(usual), |count| within(name, count as f64, bounds).map(|_| count))
    };
    let limits = Limits {
        most_points: count("points", points, usual.most_points, [2.0, 5000.0])?,
        most_tables: count("tables", tables, usual.most_tables, [0.0, 62.0])?,
        unit_mm: unit_um.map_or(Ok(usual.unit_mm), |um| {
            within("unit_um", um, [1e-3, 10.0]).map(|um| 1e-3 * um)
        })?,
        step_mm: step_mm.map(|mm| within("step_mm", mm, [0.1, 1000.0])).transpose()?,
    };
    let place = |name: &str, array: &Bound<'_, PyAny>| -> PyResult<[f64; 3]> {
        let numbers = Numbers::of(name, array, &[Some(3)])?;
        let numbers = numbers.finite(py, name)?;
        Ok([numbers[0], numbers[1], numbers[2]])
    };
    let tool_mm = tool_mm.map(|of| place("tool_mm", of)).transpose()?;
    let at_mm = at_mm.map(|of| place("at_mm", of)).transpose()?;
    let source = Source::of(source)?;
    let analysed = work(py, || source.analysed())?;
    for axis in Axis::ALL {
        let [low, high] = analysed.errors.machine.slide(axis).travel_mm;
        if let Some(at) = at_mm.map(|of| of[axis.index()]).filter(|at| !(low..=high).contains(at)) {
            let what = format!("{axis} {at} mm is beyond the travel of {low} to {high} mm");
            return Err(argument(py, "at_mm", &what, "machine coordinates within the travel"));
        }
    }
    work(py, || {
        let usual_mm = analysed.errors.mountings[0].1.tool_ball_mm;
        let tool_ball_mm = tool_mm.map_or(usual_mm, Into::into);
        let Worth { errors, shrunk, before_mm, after_mm, unknown } =
            analysed.worth(tool_ball_mm)?;
        let asked = Compensating {
            control,
            limits,
            tool_ball_mm,
            place_mm: at_mm.map_or(errors.frame.middle_mm, Into::into),
            existing: on_top.unwrap_or_default(),
        };
        let of = of_errors::Compensation::of(&errors, &asked)?;
        let told = Compensated {
            test: analysed.test.clone(),
            machine: errors.machine.name().to_owned(),
            file: analysed.file.to_string_lossy().into_owned(),
            active: analysed.compensation.clone(),
            found: &analysed.found,
            shrunk,
            shrunk_mm: [before_mm, after_mm],
            unknown,
            changed: errors.changed,
            of: &of,
        };
        let (text, json) = (compensation_text(&told), compensation_json(&told).to_string());
        Ok(Compensation { control, files: of.written.files, text, json })
    })
}
