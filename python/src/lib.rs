//! The compiled half of the Python package: the library's answers, handed over. What a Python user meets is in `palmistry/*.py`, which
//! gives them their form; nothing is decided here.

mod answers;
mod errors;
mod scenes;
mod states;
mod system;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::answers::{CertificateFound, ClaimsFound, ObservationFound, RankFound};
    #[pymodule_export]
    use super::scenes::{latex, observe, our_names, verify};
    #[pymodule_export]
    use super::states::StatesDecider;
    #[pymodule_export]
    use super::system::System;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
