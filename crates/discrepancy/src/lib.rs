//! Discrepancies between a simulation and measured data, and their causes.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`between`] | what changed between two recordings of one machine |
//! | [`compare`] | how simulation and measurement differ, without naming causes |
//! | [`diagnose`] | the search for effects that explain measured data |
//! | [`confirmed`] | the result of that search, confirmed in the full model |
//! | [`excite`] | a motion that makes parameters identifiable |
//! | [`fit`] | links, rotors and friction of all joints by one least-squares fit |
//! | [`identify`] | joint stiffness and modes from measurements of the arm itself |
//! | [`model`] | the interface that the search needs of a simulation |
//! | [`spikes`] | samples that stand alone, far off their neighbours |
//! | [`trial`] | a scenario and its data as such a model |
//! | [`stats`] | statistics that are valid under coloured noise |

#![warn(missing_docs)]

pub mod between;
pub mod compare;
pub mod confirmed;
pub mod diagnose;
pub mod excite;
pub mod fit;
pub mod identify;
pub mod model;
pub mod spikes;
pub mod stats;
pub mod trial;

#[cfg(test)]
mod testing;
