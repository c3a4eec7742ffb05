//! Milling runs against closed forms and stability theory.

mod arm;
mod chatter;
mod crossings;
mod forces;
mod limits;
mod reduced;
mod spindle;
mod support;
mod tool_modes;
