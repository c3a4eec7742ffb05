//! Sweeps: one scenario at many values of some of its keys.
//!
//! [`sweep`] runs all of it, in parallel, and gives a [`SweepTable`], on which the sweep's claims
//! are judged. Its [`jobs`] can also be run one by one, here or on a cluster: a [`Job`] holds all
//! that it needs, runs alone ([`run_job`]) and gives one [`SweepRow`].

mod job;
mod judge;
mod table;

pub use job::{Entry, Fault, Job, SweepRow, jobs, run_job};
pub use table::{Column, Done, Sweep, SweepTable, TableRow, sweep};
