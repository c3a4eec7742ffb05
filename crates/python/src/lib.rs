//! The Python module: the library's front door with Python's types. Work goes on in threads that do
//! not hold the interpreter, signals are listened to meanwhile, and every error is an exception.

mod attended;
mod errors;
mod lobes;
mod recording;
mod reports;
mod robot;
mod scenario;
mod sweep;
mod values;

use pyo3::prelude::*;

/// Compiled part of `truecut`.
#[pymodule]
mod _truecut {
    #[pymodule_export]
    use super::errors::TruecutError;
    #[pymodule_export]
    use super::lobes::lobes;
    #[pymodule_export]
    use super::recording::{Profile, Recording, Scalar};
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::scenario::{Scenario, load};
    #[pymodule_export]
    use super::sweep::SweepTable;

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
