//! The `[process]` table: exactly one of the processes.
//!
//! A process is one room: a file or folder here with its table, its parameters and its [`Facts`],
//! and one in `sim` with what it does. [`processes!`] makes the enum, the reading and the lists
//! from one line each.

mod custom;
mod facts;
mod material;

pub(crate) mod belt;
pub(crate) mod brush;
pub(crate) mod chamfer;
pub(crate) mod load;
pub(crate) mod milling;
pub(crate) mod path_file;
pub(crate) mod path_milling;
pub(crate) mod polish;
pub(crate) mod replay;
pub(crate) mod surface_polish;
pub(crate) mod wheel;

pub use custom::{BrokenRule, CustomSpec, Definition};
pub(crate) use facts::hold;
pub use facts::{Facts, Knob, ModesIn, Parts, PostureFrom, WheelHold, WheelPart};

use std::path::Path;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use crate::check::Check;
use crate::fault::Fault;
use crate::robot::RobotSpec;
use crate::run::RunSpec;

/// What every process gives. Implemented by its parameters.
pub(crate) trait Room: Sized {
    /// Its table, in the user's units.
    type Table: DeserializeOwned + JsonSchema;

    /// The parameters in SI, or `None` after recording a fault. `folder` is that of the scenario
    /// file.
    fn resolve(table: Self::Table, folder: &Path, check: &mut Check) -> Option<Self>;

    /// What others may ask of it.
    fn facts(&self) -> Facts;

    /// Checks the arm against the process, or lets it start where the process begins.
    fn lead(&self, _robot: &mut RobotSpec, _check: &mut Check) {}

    /// Checks the run against the process.
    fn check_run(&self, _run: &RunSpec, _check: &mut Check) {}
}

macro_rules! processes {
    ($( $(#[doc = $text:literal])+ $room:ident => $Kind:ident($Spec:ident) ),* $(,)?) => {
        /// What the tool does to the workpiece.
        #[derive(Debug, Clone, PartialEq)]
        pub enum ProcessSpec {
            $( $(#[doc = $text])+ $Kind(Box<$room::$Spec>), )*
            /// A process of a user's own crate.
            Custom(CustomSpec),
        }

        impl ProcessSpec {
            /// Names of the processes of this crate, which are also the names of their tables.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($room)),*];

            /// The process's name, which is also the name of its table.
            pub fn name(&self) -> &str {
                match self {
                    $( ProcessSpec::$Kind(_) => stringify!($room), )*
                    ProcessSpec::Custom(one) => one.name(),
                }
            }

            /// What is known of the process without knowing which one it is.
            pub fn facts(&self) -> Facts {
                match self {
                    $( ProcessSpec::$Kind(one) => one.facts(), )*
                    ProcessSpec::Custom(one) => one.facts(),
                }
            }

            /// Checks the arm against the process, or lets it start where the process begins.
            pub(crate) fn lead(&self, robot: &mut RobotSpec, check: &mut Check) {
                match self {
                    $( ProcessSpec::$Kind(one) => one.lead(robot, check), )*
                    ProcessSpec::Custom(_) => {}
                }
            }

            /// Checks the run against the process.
            pub(crate) fn check_run(&self, run: &RunSpec, check: &mut Check) {
                match self {
                    $( ProcessSpec::$Kind(one) => one.check_run(run, check), )*
                    ProcessSpec::Custom(_) => {}
                }
            }
        }

        /// Exactly one of the processes.
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct ProcessTable {
            $( $(#[doc = $text])+ $room: Option<<$room::$Spec as Room>::Table>, )*
        }

        impl ProcessTable {
            /// Names of the processes that are given.
            fn given(&self) -> Vec<&str> {
                let given = [$( self.$room.is_some().then_some(stringify!($room)) ),*];
                given.into_iter().flatten().collect()
            }

            fn resolve_one(self, folder: &Path, check: &mut Check) -> Option<ProcessSpec> {
                $(
                    if let Some(table) = self.$room {
                        let spec = <$room::$Spec as Room>::resolve(table, folder, check)?;
                        return Some(ProcessSpec::$Kind(Box::new(spec)));
                    }
                )*
                None
            }
        }
    };
}

processes! {
    /// Chamfering the rim of a hole.
    chamfer => Chamfer(ChamferSpec),
    /// Polishing a strip with a compliant wheel.
    wheel => Wheel(WheelSpec),
    /// Milling along a straight line.
    milling => Milling(MillingSpec),
    /// Milling of stock along a path from a file.
    path_milling => PathMilling(PathMillingSpec),
    /// Polishing a face with a soft wheel in precession.
    polish => Polish(PolishSpec),
    /// Polishing a freeform face, of a mesh or from a file, with a soft wheel in precession.
    surface_polish => SurfacePolish(SurfacePolishSpec),
    /// Finishing the face of a path job with a belt over a contact wheel.
    belt => Belt(BeltSpec),
    /// Deburring edges with a wheel brush along taught postures, or a path from a file.
    brush => Brush(BrushSpec),
    /// Given forces at the tool, at rest or along a path from a file.
    load => Load(LoadSpec),
    /// Measured inputs.
    replay => Replay(ReplaySpec),
}

impl ProcessSpec {
    /// Dotted keys of the scenario that hold the path of a file.
    pub(crate) fn files(&self) -> Vec<String> {
        let full = |key: &&str| format!("process.{}.{key}", self.name());
        self.facts().files.iter().map(full).collect()
    }
}

impl ProcessTable {
    /// `None` after recording a fault if there is not exactly one process, of these or of `own`.
    /// `known` are the names of all; `folder` is that of the scenario file.
    pub(crate) fn resolve(
        self,
        own: Vec<(Arc<Definition>, Json)>,
        known: &[&str],
        folder: &Path,
        check: &mut Check,
    ) -> Option<ProcessSpec> {
        let mut given = self.given();
        given.extend(own.iter().map(|(definition, _)| definition.name()));
        if given.len() != 1 {
            check.refuse(not_one(&given, known));
            return None;
        }
        match own.into_iter().next() {
            Some((definition, json)) => {
                CustomSpec::read(definition, json, check).map(ProcessSpec::Custom)
            }
            None => self.resolve_one(folder, check),
        }
    }
}

/// The fault of a scenario that has not exactly one process.
pub(crate) fn not_one(given: &[&str], names: &[&str]) -> Fault {
    let known = list(names);
    match given.last() {
        None => Fault::key(
            "process",
            format!("no process: one of {known} is needed"),
            "empty",
        ),
        Some(last) => {
            let message = format!(
                "{} processes ({}), but a scenario has exactly one of {known}",
                given.len(),
                given.join(", ")
            );
            Fault::key(&format!("process.{last}"), message, "one too many")
        }
    }
}

/// Tables of processes, in words.
fn list(names: &[&str]) -> String {
    let tables: Vec<String> = names
        .iter()
        .map(|name| format!("[process.{name}]"))
        .collect();
    match tables.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => tables.concat(),
    }
}
