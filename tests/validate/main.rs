//! Against measured data of real machines. The data is not part of the project: the folder that
//! holds it is named in `TRUECUT_DATA`. Without it a test is counted as ignored, with its name; the
//! harness is libtest-mimic's because the built-in one cannot decide that while it runs.

mod emps;
mod inverse;
mod support;
mod turning;
mod ur10e;

use libtest_mimic::{Arguments, Completion, Trial};
use support::NoData;

/// Trials named as their functions.
macro_rules! trials {
    ($($module:ident::$test:ident),* $(,)?) => {
        vec![$(trial(stringify!($test), $module::$test)),*]
    };
}

fn trial(name: &str, test: fn() -> Result<(), NoData>) -> Trial {
    Trial::ignorable_test(name, move || match test() {
        Ok(()) => Ok(Completion::Completed),
        Err(NoData) => Ok(Completion::ignored_with(
            "TRUECUT_DATA names no folder of measured data",
        )),
    })
}

fn main() {
    let trials = trials![
        emps::validate_emps_friction_is_named_and_stribeck_is_not,
        inverse::validate_emps_inverse_dynamics_error_is_the_published_one,
        inverse::validate_ur10e_torque_errors_without_and_with_the_payload,
        turning::validate_turning_runout_is_named_and_the_chuck_is_described,
        ur10e::validate_ur10e_friction_is_named_without_load_and_the_payload_with_it,
        ur10e::validate_ur10e_whose_base_is_turned_is_told_before_causes,
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}
