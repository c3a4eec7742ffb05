//! A belt over a contact wheel on the face of a path job, on the HP20 in rapier: forces, removal,
//! copies.

mod control;
mod copies;
mod effects;
mod engines;
mod path_file;
mod plane;
mod support;

use crate::support as shared;
