//! One program for all of them: linking takes longer than most of the tests.

mod assets;
mod cam_files;
mod cam_gaps;
mod cam_refusals;
mod cam_run;
mod lobes;
mod maps;
#[path = "../../arm/tests/milling_arm/mod.rs"]
mod milling_arm;
mod patent_path;
mod path_file;
mod path_start;
mod precession;
mod program_dialects;
mod program_files;
mod program_makers;
mod program_replay;
mod program_round_trips;
mod program_travel;
mod refusals;
#[path = "../../arm/tests/seven_axes/mod.rs"]
mod seven_axes;
mod spare_joints;
mod support;
mod surface_paths;
mod taught_round_trips;
