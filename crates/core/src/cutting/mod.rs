//! Cutting: chip area, forces, the surface that is left.

pub mod chamfer;
pub mod milling;
pub mod rim;
pub mod slip_condition;
