//! Polishing a face with a wheel in precession, on the HP20 in rapier: forces, removal, edges,
//! force control.

mod edges;
mod grains;
mod inside;
mod support;

use crate::support as shared;
