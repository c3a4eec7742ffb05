//! One program for all of them: linking takes longer than most of the tests.

mod adjusted_robot;
mod belt;
mod brush;
mod effects_joint;
mod effects_off_and_on;
mod effects_process;
mod effects_robot;
mod joint_zero;
mod milling;
mod modal_damping;
mod numerics;
mod own_process;
mod polish;
mod posture_plan;
mod random_robots;
mod replay;
mod rows_only;
mod support;
mod tool_bends;
mod travelling;
