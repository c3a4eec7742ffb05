//! Contract tests: what every plant and every process keeps, one `#[test]` a law and a subject.
//!
//! [`plant_contract!`](crate::plant_contract) and [`process_contract!`](crate::process_contract)
//! make a module of tests from a closure that captures nothing and gives the subject, in this crate
//! and in others (feature `contract`; names in the closure are seen from within the module):
//!
//! ```text
//! truecut_sim::process_contract!(drilling, || {
//!     Subject::new(Box::new(Drilling::new()), 1e-4, states_along_x())
//! });
//! ```

pub mod plant;
pub mod process;
#[cfg(test)]
mod shipped;

/// Tests of a plant: `plant_contract!(name, make)` with `make: fn(&plant::Case) -> Box<dyn Plant>`.
#[macro_export]
macro_rules! plant_contract {
    ($name:ident, $make:expr) => {
        $crate::contract_tests!(
            $name,
            plant,
            $make,
            free_velocity_is_what_finish_gives,
            mobility_is_symmetric_and_positive,
            an_impulse_changes_the_velocity_by_its_mobility,
            positions_follow_the_half_step_velocity,
            energy_is_balanced,
            the_same_state_gives_the_same_step,
            an_arm_without_load_stays_at_rest,
            locked_joints_stand_still,
            one_joint_decays_as_its_closed_form,
        );
    };
}

/// Tests of a process: `process_contract!(name, make)` with `make: fn() -> process::Subject`.
#[macro_export]
macro_rules! process_contract {
    ($name:ident, $make:expr) => {
        $crate::contract_tests!(
            $name,
            process,
            $make,
            rows_have_a_value_for_every_channel,
            channels_are_named_once_and_described,
            evaluating_twice_changes_nothing,
            recording_twice_changes_nothing,
            the_same_states_give_the_same_rows,
            findings_are_finite_and_named_once,
            rows_alone_are_the_same_rows,
            neutral_effects_change_no_bit,
            times_and_springs_are_positive,
            the_field_has_a_value_for_every_cell,
        );
    };
}

/// One module with one `#[test]` for each function of a battery.
#[doc(hidden)]
#[macro_export]
macro_rules! contract_tests {
    ($name:ident, $battery:ident, $make:expr, $($law:ident),* $(,)?) => {
        mod $name {
            $(#[test]
            fn $law() {
                $crate::contract::$battery::$law($make);
            })*
        }
    };
}
