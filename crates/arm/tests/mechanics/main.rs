//! Kinematics, dynamics, compliance and modes: each against a definition it does not share code with.

mod dynamics;
mod inverse_kinematics;
mod modal;
mod random_chain;
mod statics;
mod tangents;
