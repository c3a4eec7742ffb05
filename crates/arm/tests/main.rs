//! One program for all of them: linking takes longer than most of the tests.

mod doubts;
mod drawing;
mod estimates;
mod export;
mod followers;
mod inertials;
mod mechanics;
mod milling_arm;
mod payload;
mod reading;
mod refusals;
mod seven_axes;
mod urdf_faults;
mod verify_hp20;
mod verify_irb6600;
mod verify_milling_postures;
mod verify_milling_time_domain;
mod xacro;
