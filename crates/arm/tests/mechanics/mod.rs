//! Kinematics, dynamics, compliance and modes: each against a definition it does not share code
//! with.

mod branches;
mod dynamics;
mod held;
mod inverse_kinematics;
mod modal;
mod ortho_parallel;
mod random_chain;
mod response;
mod spare_joints;
mod statics;
mod tangents;
mod tool_modes;
