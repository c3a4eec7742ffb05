//! Whole scenarios against closed forms and published numbers.

mod chamfering;
mod every_key;
mod friction_tables;
mod passes;
mod reduced;
mod support;
mod threshold;
mod tool_frf;
mod uncertain;
