//! truecut simulates robotic machining: a compliant arm, the process that loads it, and claims on
//! the result. From measured data it also finds what a simulation lacks.
//!
//! A *scenario* is a TOML file: a robot, what the tool does, and what must hold. The robot is a
//! URDF, with its compliance, drives and tool in a `robot.toml` beside it. A run of a scenario
//! yields a *recording*: channels with units over time. An *effect* is one physical thing that the
//! model leaves out; a diagnosis answers with effects, as entries of the same scenario.
//!
//! # In a crate of your own
//!
//! ```toml
//! [dependencies]
//! truecut = { path = "../truecut/crates/truecut" }
//! ```
//!
//! Scenarios, robots and materials to begin with lie in `scenarios` and `assets` of the repository;
//! paths in a scenario start from the folder of its file. The smallest program runs one and says
//! what came of its claims:
//!
//! ```no_run
//! use truecut::{Run, Scenario};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let file = "../truecut/scenarios/chamfer/backward_sufficient.toml";
//!     let finished = Run::of(&Scenario::load(file.as_ref(), &[])?).execute()?;
//!     for claim in &finished.claims {
//!         println!("{}: {}", claim.name, claim.shown);
//!     }
//!     Ok(())
//! }
//! ```
//!
//! # A tour
//!
//! It runs inside the repository; `tempfile` is needed for its folder alone.
//!
//! ```
//! use std::path::Path;
//! use truecut::{Engine, Run, Scenario};
//!
//! // The back of a hole is chamfered by a tool whose foot is pressed onto the part, on a rig that
//! // gives way in a plane. Keys have their unit in their name.
//! let text = r#"
//! name = "A foot that holds"
//!
//! [robot]
//! urdf = "assets/robots/rig_planar/robot.urdf"
//! gravity = false
//!
//! [run]
//! duration_s = 1.0
//!
//! [process.chamfer]
//! direction = "backward"
//! spindle_rpm = 300
//! feed_mm_per_rev = 0.1
//! depth_mm = 1.0
//! half_angle_deg = 45
//! hole_diameter_mm = 42
//! regeneration = "off"
//!
//! [process.chamfer.cutting]
//! axial_mpa = 1960
//! in_plane_mpa = 2140
//! in_plane_angle_deg = 20
//!
//! [process.chamfer.foot]
//! pressure_mpa = 0.8
//! bore_mm = 32
//! cylinders = 2
//! seal_stiction_n = 97
//!
//! [process.chamfer.foot.friction]
//! law = "coulomb"
//! mu = 0.15
//!
//! [[claim]]
//! name = "the foot holds"
//! metric = "duration_above"
//! channel = "foot.sliding"
//! threshold = 0.5
//! max = 3
//! unit = "ms"
//! reason = "friction exceeds the rotating force at every depth"
//! "#;
//! // The text stands for a file in the root of the repository: its paths lead from there.
//! let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
//! let scenario = Scenario::from_str(&root.join("foot.toml"), text, &[])?;
//!
//! // A run in one call. Claims are judged; numbers are SI.
//! let held = Run::of(&scenario).execute()?;
//! assert!(held.holds(), "{}", held.claims[0].shown);
//! let axial_n = held.recording.channel("foot.normal_force")?;
//! assert_eq!(axial_n.len(), held.recording.time_s.len());
//!
//! // Any key can be changed from outside, here for one run or in the list that `load` and
//! // `from_str` take: a dotted key and a value in TOML, or a bare word for a text. And the arm can
//! // be stepped by its linearisation, many times as fast. Here the friction is too low: the claim
//! // fails, and says by how much.
//! let slippery = Run {
//!     overrides: vec![("process.chamfer.foot.friction.mu".into(), "0.02".into())],
//!     engine: Engine::REDUCED,
//!     ..Run::of(&scenario)
//! };
//! let slid = slippery.execute()?;
//! assert!(!slid.claims[0].holds);
//! assert!(slid.recording.scalar("chamfer.width_spread")?.value > 0.0);
//! // The recording carries the scenario that really ran, so that it can be run again.
//! assert!(slid.recording.header.scenario_text.contains("mu = 0.02"));
//!
//! // The files of a run go into `out/foot`, named like the scenario's file (`foot.toml`); folders
//! // that are missing are made. Sinks take the rows while the run goes on; `finish` adds the
//! // summary and puts the files where those of an earlier run were, so runs of one scenario with
//! // different overrides need an `out` each. Here these are `recording.parquet` and
//! // `summary.json`; `true` would write `recording.rrd`, too, for the viewer (rerun).
//! let out = tempfile::tempdir()?;
//! let files = truecut::Outputs::prepare(out.path(), &scenario, false)?;
//! let kept = Run { sinks: files.sinks(), ..Run::of(&scenario) }.execute()?;
//! files.finish(&kept.recording, &kept.claims)?;
//! assert!(files.recording().ends_with("foot/recording.parquet"));
//!
//! // A mistake names its place.
//! let error = Scenario::from_str(&root.join("foot.toml"), &text.replace("= 32", "= -32"), &[]);
//! let error = error.unwrap_err();
//! assert_eq!(error.problems().next().and_then(|problem| problem.line()), Some(27));
//!
//! // A sweep runs a scenario over values of its keys, in parallel. Two axes make a grid, the last
//! // one running fastest; their values are in the unit of their key.
//! let sweep = r#"
//! [[sweep.axis]]
//! key = "process.chamfer.foot.friction.mu"
//! values = [0.02, 0.15]
//!
//! [[sweep.axis]]
//! key = "process.chamfer.foot.pressure_mpa"
//! values = [0.7, 0.8]
//!
//! [[sweep.column]]
//! name = "time sliding"
//! metric = "duration_above"
//! channel = "foot.sliding"
//! threshold = 0.5
//! unit = "ms"
//!
//! [[sweep.claim]]
//! name = "the foot holds"
//! column = "time sliding"
//! max = 3
//! reason = "with little friction it does not"
//! "#;
//! // `[[claim]]` is about a single run and is refused beside a sweep. A sweep has claims of its
//! // own: on a column, in its unit, to be held by every row.
//! let (head, _claims) = text.split_once("[[claim]]").unwrap();
//! let swept = Scenario::from_str(&root.join("foot.toml"), &format!("{head}{sweep}"), &[])?;
//! // Metrics are listed in docs/claims_and_ci.md; which channels a run has stands in
//! // `held.recording.header.channels`. The closure is told the part that is done, 0 to 1. Rows are
//! // run in rapier, on all cores.
//! let table = truecut::sweep(&swept, &|_part| {})?;
//! // A row has the axes' values, then the columns', each in the unit of `table.columns`: here ms.
//! let time_sliding = table.index("time sliding").unwrap();
//! let slides = |row: usize| table.rows[row][time_sliding] > 3.0;
//! assert_eq!(table.rows[1][..2], [0.02, 0.8]);
//! assert!(slides(0) && slides(1) && !slides(2) && !slides(3), "{:?}", table.rows);
//! // Its claims are judged on the table, by the worst row.
//! assert!(!table.claims(&swept)[0].holds);
//! // Where a run did not come to its end the row's results are NaN, and `faults` says why; a claim
//! // on a column with such a row does not hold.
//! assert!(table.faults.iter().all(Option::is_none));
//!
//! // The same sweep with its files: each row is on the disk as soon as it is made. Where the
//! // program is killed, the next call goes on from there, if scenario, files and version are the
//! // same. A folder has one writer; that of the run is held as long as `files` above is there.
//! let files = truecut::SweepOutputs::prepare(&out.path().join("swept"), &swept, Engine::Rapier)?;
//! let same = files.run(&|_part| {}, None)?;
//! assert_eq!(same, table);
//! assert!(files.finish(&same)?.ends_with("foot/sweep.parquet"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Measured data are another recording. What a simulation gets wrong about them is compared, then
//! explained:
//!
//! ```
//! use std::path::Path;
//! use truecut::discrepancy::compare::compare_recordings;
//! use truecut::discrepancy::diagnose::{Options, Verdict, diagnose};
//! use truecut::discrepancy::trial::Trial;
//! use truecut::{Claims, Run, RunError, Scenario, data};
//!
//! // The scenario says which column of the data is which channel, in which unit, and which of them
//! // drive the model (docs/measured_data.md). Data are CSV (names of columns in the first line;
//! // delimited by commas, semicolons, tabs or blanks; an empty cell is missing) or Parquet. Of one
//! // with a single joint:
//! //
//! //     name = "An elbow"
//! //
//! //     [robot]
//! //     urdf = "arm.urdf"
//! //     posture_deg = [-40]         # where it starts
//! //     drive = "position"
//! //
//! //     [process.replay]
//! //
//! //     [data]
//! //     file = "elbow.csv"
//! //     time = "t_s"
//! //
//! //     [[data.channel]]            # an input: every driven joint has one
//! //     column = "command_1_deg"
//! //     channel = "joint1.command"
//! //     unit = "deg"
//! //     role = "input"
//! //
//! //     [[data.channel]]            # an output, which is compared with the run
//! //     column = "torque_1_n_m"
//! //     channel = "joint1.transmission_torque"
//! //     unit = "N m"
//! // That of the repository has two joints, and the tool's height as an output, too.
//! let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis/elbow.toml");
//! // One second of the data is enough.
//! let scenario = Scenario::load(&file, &[("data.to_s".into(), "1".into())])?;
//! // `None`: the file that the scenario names. `Some(path)` reads another, with the same columns.
//! let measured = data::measured(&scenario, None)?;
//!
//! // Claims are left alone here: they are about the model, and the question is about the data.
//! // `measured` drives a replay by its inputs, over their time; beside any other process data have
//! // outputs only. The last argument of `compare_recordings` is the spindle's rate in Hz where one
//! // turns: differences are then held against its phase, too.
//! let nominal = Run { measured: Some(&measured), claims: Claims::Ignore, ..Run::of(&scenario) };
//! let differences = compare_recordings(&nominal.execute()?.recording, &measured, None)?;
//! let height = differences.channels.iter().find(|it| it.channel == "tool.position_z");
//! assert!(height.is_some_and(|height| height.level.nrmse > 0.0));
//!
//! // Every kind of effect that can act here is tried (docs/effects.md has them all), and several
//! // together. A trial is the scenario as a model that can be asked for any effects and values,
//! // with what was observed; `RunError::of` gives its errors file and line.
//! let trial = Trial::new(&scenario, &measured).map_err(|error| RunError::of(&scenario, error))?;
//! let answer = diagnose(&trial, &trial.observation, &Options::default(), &|_progress| {})?;
//! assert_eq!(answer.diagnosis.verdict, Verdict::Named);
//! // Here it is play in the second joint, with its size and the ends of its 95 % interval, SI.
//! // Only `Named` is an answer to go on with; `Ambiguous` has `alternatives`, and `reason` says in
//! // words what any verdict means: nothing beyond noise, an unknown cause, data that would not
//! // show one.
//! let play = &answer.diagnosis.causes[0];
//! assert_eq!(play.kind, "joint_backlash");
//! let gap = play.parameters.values().next().unwrap();
//! assert!(gap.low < Some(gap.value) && Some(gap.value) < gap.high, "{}", answer.diagnosis.reason);
//!
//! // The answer is a scenario: what stands under `[[uncertain]]` has been refitted with the
//! // effects. It runs here, and as a text, in which the effects are new entries, for others; its
//! // paths lead from the folder of the scenario. Which joints are rotary decides between keys as
//! // `gap_rad` and `gap_m`.
//! let fitted = scenario.with_overrides(&trial.overrides(&answer.nominal))?;
//! let extended = fitted.with_effects(&answer.effects)?;
//! let text = fitted.extended_text(&answer.effects, &trial.rotary());
//! assert!(text.matches("joint_backlash").count() == 1);
//! let run = Run { measured: Some(&measured), claims: Claims::Ignore, ..Run::of(&extended) };
//! let left = compare_recordings(&run.execute()?.recording, &measured, None)?;
//! assert!(left.channels[0].level.nrmse < differences.channels[0].level.nrmse);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to go on
//!
//! | example, `cargo run --release -p truecut --example …` | shows |
//! | --- | --- |
//! | `chamfer` | one scenario at two pressures, claims, channels, scalars |
//! | `sweep` | a threshold searched over friction, compared with two formulas |
//! | `diagnose` | measured data, and the play that explains them |
//! | `own_process` | a process that truecut does not know, in one's own code |
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`scenario`] | the file format: tables, schema, units, effects, claims |
//! | [`sim`] | the simulator: [`sim::run`], sweeps, plants, processes |
//! | [`recording`] | channels, metrics, claims, measured data, sinks |
//! | [`data`] | the measured data that a scenario names |
//! | [`outputs`], [`telemetry`] | the files of a run, and readers of them |
//! | [`discrepancy`] | comparison with measured data, diagnosis, identification |
//! | [`arm`], [`plan`], [`core`] | robots; tool paths, postures, programs; laws of the processes |
//!
//! # A process of your own
//!
//! It needs nothing in truecut changed. A whole one, drilling, stands at the end of this page: its
//! table, facts, forces and channels, and a run and a sweep of it. Your crate has
//!
//! 1. the type of its table (serde, schemars): keys with units in their names, ranges with their
//!    reason in `x-rule`;
//! 2. [`sim::process::OwnProcess`] for that type: its name, its [`scenario::Facts`], rules between
//!    keys (none by default), and `set_up`, which makes the process; it has `definition()` then;
//! 3. [`sim::process::Process`] for the process: channels, `evaluate` (state of the tool to loads,
//!    changes nothing), `commit` (advances its memory, once a step), `record` (a value a channel,
//!    in their order), `contact_stiffness` (springs of a contact, none if it only pushes), `arrows`
//!    (what is drawn). All else has a default.
//!
//! Process axes are fixed where the tool is when the run begins: x runs along the tool's axis into
//! the workpiece (`z` of the tool frame of `robot.toml`), y is ẑ × x, horizontal (x × x̂ of the
//! world where x is vertical), z = x × y. The arm holds the scenario's posture, or feeds the tool
//! along the process's y axis at
//! [`feed_along_y_m_per_s`](sim::process::Process::feed_along_y_m_per_s). Paths over surfaces and
//! taught postures lead the shipped processes alone.
//!
//! [`scenario::Processes::with`] registers that definition, and [`Scenario::load_with`] reads
//! scenarios that have it. The derives of the table need serde and schemars among your
//! dependencies, in the major versions of [`external`]:
//!
//! ```toml
//! serde = { version = "1", features = ["derive"] }
//! schemars = "1"
//! ```
//!
//! The rules that every process keeps are tests in the feature `contract`; a macro makes a
//! `#[test]` of each:
//!
//! ```toml
//! [dev-dependencies]
//! truecut = { path = "../truecut/crates/truecut", features = ["contract"] }
//! ```
//!
//! The macro takes a name for the tests and a function that makes the process in question with a
//! history of states of its tool; the example below ends with one. Plants, dialects of robot
//! programs and readers of measured data have the like.
//!
//! # The program
//!
//! The program of the same name (package `truecut-cli`) adds arguments, text and figures, and
//! nothing else.
//!
//! # Drilling, a whole process of your own
//!
//! `crates/truecut/examples/own_process.rs`:
//!
//! ```no_run
#![doc = include_str!("../examples/own_process.rs")]
//! ```

#![warn(missing_docs)]

pub mod data;
pub mod inspect;
mod journal;
mod maps;
pub mod outputs;
mod parts;
mod predictions;
mod rows;
mod saturated;
mod shown;
mod staged;

pub use truecut_arm as arm;
pub use truecut_core as core;
pub use truecut_discrepancy as discrepancy;
pub use truecut_plan as plan;
pub use truecut_recording as recording;
pub use truecut_scenario as scenario;
pub use truecut_sim as sim;
pub use truecut_telemetry as telemetry;

pub use journal::SweepOutputs;
pub use outputs::Outputs;
pub use parts::{Made, SweepParts};
pub use predictions::KeptModel;
pub use shown::Shown;
pub use staged::Staged;
pub use truecut_scenario::Scenario;
pub use truecut_sim::run::{Claims, Engine, Finished, Keep, Run, RunError, Runs};
pub use truecut_sim::sweep::{Sweep, SweepTable, sweep};

/// Libraries whose types are part of the interface, in the versions that it uses.
pub mod external {
    pub use nalgebra;
    pub use schemars;
    pub use serde;
}

/// Contract tests for your own implementations: a macro makes a `#[test]` of each rule.
#[cfg(feature = "contract")]
pub mod contract {
    pub use truecut_plan::dialect_contract;
    pub use truecut_plan::program::contract as dialect;
    pub use truecut_sim::contract::{plant, process};
    pub use truecut_sim::{plant_contract, process_contract};
    pub use truecut_telemetry::contract as reader;
    pub use truecut_telemetry::reader_contract;
}
