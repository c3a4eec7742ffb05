//! One program for all of them: linking takes longer than most of the tests.

mod effects;
mod facts;
mod milling;
mod reading;
mod refusing;
mod renamed;
mod round_trips;
mod values;
