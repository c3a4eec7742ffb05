//! One program for all of them: linking takes longer than most of the tests.

mod planar_oscillator;
mod verify_limits;
mod vibration_tables;
mod wheels;
