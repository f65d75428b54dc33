//! The Python package `ballbar`: the library's stages on arrays of `NumPy`.
//!
//! What Python hands in is checked at the border and copied once; what goes out is moved into arrays. Work runs without the
//! interpreter's lock. Nothing here computes: it is the library's.

mod arrays;
mod campaign;
mod columns;
mod compensation;
mod diagnosis;
mod error;
mod identification;
mod machine;
mod planning;
mod problem;
mod run;
mod source;
mod stages;
mod test;
mod trials;
mod virtually;
mod volume;
mod words;

use pyo3::prelude::*;

#[pymodule]
mod _ballbar {
    #[pymodule_export]
    use crate::campaign::Campaign;
    #[pymodule_export]
    use crate::compensation::{Compensation, compensate};
    #[pymodule_export]
    use crate::diagnosis::{Diagnosis, diagnose};
    #[pymodule_export]
    use crate::error::_panic;
    #[pymodule_export]
    use crate::identification::{Identification, IdentifiedRun};
    #[pymodule_export]
    use crate::machine::Machine;
    #[pymodule_export]
    use crate::planning::{Plan, Program, plan, programs};
    #[pymodule_export]
    use crate::problem::{Linearised, Problem};
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::stages::{AlignedRun, align, identify};
    #[pymodule_export]
    use crate::test::Test;
    #[pymodule_export]
    use crate::trials::Trials;
    #[pymodule_export]
    use crate::virtually::{Simulation, simulate};
    #[pymodule_export]
    use crate::volume::{Volume, volume};

    #[pymodule_init]
    fn init(module: &super::Bound<'_, super::PyModule>) -> super::PyResult<()> {
        super::PyModuleMethods::add(module, "__version__", env!("CARGO_PKG_VERSION"))
    }
}
