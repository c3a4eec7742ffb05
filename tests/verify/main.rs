//! Whole scenarios against closed forms and published numbers.

mod chamfering;
mod friction_tables;
mod support;
mod threshold;
