//! The compiled half of the Python package: the library's answers, handed over. What a Python user meets is in `palmistry/*.py`, which
//! gives them their form; nothing is decided here.

mod answers;
mod errors;
mod observed;
mod questions;
mod scenes;
mod states;
mod stream;
mod studies;
mod system;
mod told;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::answers::{CertificateFound, ClaimsFound, RankFound};
    #[pymodule_export]
    use super::observed::ObservationFound;
    #[pymodule_export]
    use super::questions::{
        accessible, design, drops, imported, imported_problem, least_model, recheck, recheck_file,
        reparametrised, solutions,
    };
    #[pymodule_export]
    use super::scenes::{latex, observe, observe_measured, our_names, verify};
    #[pymodule_export]
    use super::states::StatesDecider;
    #[pymodule_export]
    use super::stream::Stream;
    #[pymodule_export]
    use super::studies::{advise, examined, formatted, poses, stress, trade};
    #[pymodule_export]
    use super::system::System;
    #[pymodule_export]
    use super::told::Told;
    #[pymodule_export]
    use super::work::set_threads;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
