//! Damaged and hostile files for every reader.
//!
//! A *case* is made of two things: files of the repository that a reader knows (its *seeds*), and
//! bytes that choose which of them is damaged, where, and how. The bytes come from a generator with
//! a seed, so that a case is told by the name of its reader and a number.
//!
//! | file | what |
//! | --- | --- |
//! | `mutate` | damages a file as bytes and as text |
//! | `seeds` | the files of the repository that a reader knows |
//! | `readers` | every reader by name; a scenario is built and run for ten steps |
//! | `beside` | readers of what stands beside scenarios, and of what stopped searches left |
//! | `campaign` | cases one after the other: no panic, no memory beyond a limit |
//! | `program` | the same through the program: its exit code, its memory, what it prints |
//!
//! `cargo test --release -p truecut-fuzz` runs a part of each that takes seconds; the program
//! `truecut-fuzz` runs as many as one has time for.

mod beside;
pub mod campaign;
mod columns;
pub mod mutate;
pub mod program;
pub mod readers;
pub mod seeds;
