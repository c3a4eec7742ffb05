//! Every reader by name.

use std::path::Path;

use nalgebra::Isometry3;
use truecut::{Run, Scenario};
use truecut_arm::{Robot, expanded_urdf};
use truecut_plan::cam::{self, CamOptions};
use truecut_plan::program::{Frames, Settings, Tool};
use truecut_plan::program::{dialect_of, read_text};
use truecut_plan::surface::PatchFile;
use truecut_scenario::{CellFile, Identification, PathJob};
use truecut_telemetry::{read_recording, read_table, read_tables};

use crate::beside;
use crate::columns::{columns, recordings};
use crate::seeds::{Seed, root, seeds};

/// Steps that a scenario is run for.
const STEPS: f64 = 10.0;
/// No more than this is read of a scenario that asks for long steps, s.
const LONGEST_S: f64 = 1.0;

/// What a reader is given: the file's name, as errors say it and as its neighbours are found, and
/// what it holds; and a folder that is the case's own.
pub struct Case<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    pub folder: &'a Path,
}

impl Case<'_> {
    /// As text; what is none is for [`Case::written`] to read.
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(self.bytes).into_owned()
    }

    /// As a file of its own.
    pub(crate) fn written(&self) -> std::path::PathBuf {
        let name = self.path.file_name().expect("a file");
        let path = self.folder.join(name);
        std::fs::write(&path, self.bytes).expect("a file of the case");
        path
    }
}

/// A reader under test.
pub struct Reader {
    pub name: &'static str,
    /// Files that it knows.
    pub seeds: fn() -> Vec<Seed>,
    /// Reads a case: whether it was accepted, else what was said of it.
    pub read: fn(&Case) -> Result<(), String>,
    /// Arguments of the program that read a case; `CASE` stands for its file, also within
    /// a word, `ROBOT` for an arm.
    pub commands: &'static [&'static [&'static str]],
}

/// All of them.
pub const READERS: &[Reader] = &[
    Reader {
        name: "scenario",
        seeds: scenarios,
        read: scenario,
        commands: &[
            &["run", "CASE", "--set", "run.duration_s=0.01"],
            &["export-mjcf", "CASE", "-o", "case.xml"],
        ],
    },
    Reader {
        name: "ten_steps",
        seeds: runnable,
        read: ten_steps,
        commands: &[&["run", "CASE", "--set", "run.duration_s=0.05"]],
    },
    Reader {
        name: "path_job",
        seeds: path_jobs,
        read: |case| said(PathJob::from_str(case.path, &case.text())),
        commands: &[&["path", "CASE"]],
    },
    Reader {
        name: "cell",
        seeds: cells,
        read: |case| {
            let at_flange = nalgebra::Isometry3::identity();
            said(CellFile::from_str(case.path, &case.text(), &at_flange))
        },
        commands: &[&[
            "path",
            "scenarios/arm/contour.nc",
            "--robot",
            "ROBOT",
            "--work-xyz-mm=900,0,600",
            "--cell",
            "CASE",
        ]],
    },
    Reader {
        name: "identification",
        seeds: identifications,
        read: |case| said(Identification::from_str(case.path, &case.text())),
        commands: &[&["identify", "CASE"]],
    },
    Reader {
        name: "patch",
        seeds: patches,
        read: |case| said(PatchFile::from_text(&case.text(), case.path)),
        commands: &[],
    },
    Reader {
        name: "robot_file",
        seeds: robot_files,
        read: robot_file,
        commands: &[&["robot", "ROBOT", "--config", "CASE"]],
    },
    Reader {
        name: "urdf",
        seeds: urdfs,
        read: urdf,
        commands: &[
            &["robot", "CASE"],
            &[
                "robot",
                "init",
                "CASE",
                "--mass",
                "400",
                "--payload",
                "20",
                "--out",
                "case_robot.toml",
                "--force",
            ],
        ],
    },
    Reader {
        name: "xacro",
        seeds: xacros,
        read: xacro,
        commands: &[&["robot", "CASE"]],
    },
    Reader {
        name: "mesh",
        seeds: meshes,
        read: beside::mesh,
        commands: &[&["part", "CASE"]],
    },
    Reader {
        name: "table",
        seeds: tables,
        read: |case| said(read_table(&case.written(), true)),
        commands: &[&["data", "CASE"]],
    },
    Reader {
        name: "log",
        seeds: || seeds(&["tests/logs"], &["mcap"], |_, _| true),
        read: |case| said(read_tables(&case.written(), true)),
        commands: &[&["data", "CASE"]],
    },
    Reader {
        name: "telegrams",
        seeds: || {
            seeds(&["tests/logs", "tests/invalid_input"], &["xml"], |_, _| {
                true
            })
        },
        read: |case| said(read_table(&case.written(), true)),
        commands: &[&["data", "CASE"]],
    },
    Reader {
        name: "columns",
        seeds: || recordings().into_iter().chain(columns()).collect(),
        read: |case| said(read_table(&case.written(), true)),
        commands: &[&["data", "CASE"]],
    },
    Reader {
        name: "recording",
        seeds: recordings,
        read: |case| said(read_recording(&case.written())),
        commands: &[&["view", "--rrd", "CASE"]],
    },
    Reader {
        name: "cam",
        seeds: cam_files,
        read: |case| said(cam::read(&case.text(), case.path, &CamOptions::default())),
        commands: &[&[
            "path",
            "CASE",
            "--robot",
            "ROBOT",
            "--work-xyz-mm=900,0,600",
        ]],
    },
    Reader {
        name: "program",
        seeds: programs,
        read: program,
        commands: &[&["program", "CASE", "--robot", "ROBOT"]],
    },
    Reader {
        name: "material",
        seeds: beside::materials,
        read: beside::material,
        commands: &[&[
            "run",
            "scenarios/milling/own_surface.toml",
            "--set",
            "process.milling.material.file='CASE'",
            "--set",
            "run.duration_s=0.01",
        ]],
    },
    Reader {
        name: "taught",
        seeds: beside::taught_points,
        read: beside::taught,
        commands: &[&["robot", "ROBOT", "--fk", "CASE"]],
    },
    Reader {
        name: "yaml",
        seeds: beside::yamls,
        read: beside::yaml,
        commands: &[],
    },
    Reader {
        name: "sweep_rows",
        seeds: beside::sweep_rows,
        read: beside::sweep_goes_on,
        commands: &[],
    },
    Reader {
        name: "sweep_part",
        seeds: beside::sweep_rows,
        read: beside::sweep_part,
        commands: &[],
    },
    Reader {
        name: "predictions",
        seeds: beside::predictions,
        read: beside::search_goes_on,
        commands: &[],
    },
];

/// The reader of this name.
#[must_use]
pub fn reader(name: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name == name)
}

pub(crate) fn said<T, E: ToString>(read: Result<T, E>) -> Result<(), String> {
    read.map(|_| ()).map_err(|error| error.to_string())
}

const EVERYWHERE: &[&str] = &["scenarios", "assets", "tests/invalid_input"];

fn has(table: &str) -> impl Fn(&Path, &[u8]) -> bool {
    let begins = format!("\n[{table}");
    move |_, bytes| format!("\n{}", String::from_utf8_lossy(bytes)).contains(&begins)
}

fn scenarios() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], has("process."))
}

/// Scenarios that are good as they stand, of every process.
fn runnable() -> Vec<Seed> {
    seeds(&["scenarios"], &["toml"], has("process."))
}

fn path_jobs() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], has("surface"))
}

fn cells() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], has("[fixture]"))
}

fn identifications() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], |path, bytes| {
        has("stiffness")(path, bytes) || has("modes")(path, bytes)
    })
}

fn patches() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], |_, bytes| {
        String::from_utf8_lossy(bytes).contains("kind = \"nurbs\"")
    })
}

fn robot_files() -> Vec<Seed> {
    seeds(EVERYWHERE, &["toml"], |path, _| {
        path.file_name().is_some_and(|name| name == "robot.toml")
            && path.with_file_name("robot.urdf").exists()
    })
}

fn urdfs() -> Vec<Seed> {
    seeds(EVERYWHERE, &["urdf"], |_, _| true)
}

fn xacros() -> Vec<Seed> {
    seeds(
        &["tests/invalid_input", "tests/crosscheck"],
        &["xacro"],
        |_, _| true,
    )
}

fn meshes() -> Vec<Seed> {
    let folders = ["scenarios", "assets", "tests/invalid_input", "crates/arm"];
    seeds(&folders, &["stl", "obj", "ply", "step"], |_, _| true)
}

fn tables() -> Vec<Seed> {
    seeds(EVERYWHERE, &["csv", "txt"], |_, _| true)
}

fn cam_files() -> Vec<Seed> {
    let folders = ["tests/invalid_input", "tests/crosscheck", "crates/plan"];
    seeds(
        &folders,
        &["nc", "mpf", "ngc", "gcode", "apt", "csv"],
        |_, _| true,
    )
}

fn programs() -> Vec<Seed> {
    seeds(
        &["crates/plan"],
        &["JBI", "MOD", "src", "script", "LS"],
        |path, _| dialect_of(path).is_some(),
    )
}

fn scenario(case: &Case) -> Result<(), String> {
    said(Scenario::from_str(case.path, &case.text(), &[]))
}

/// Loads, builds and runs a scenario for ten of its steps.
fn ten_steps(case: &Case) -> Result<(), String> {
    let scenario = Scenario::from_str(case.path, &case.text(), &[]).map_err(|e| e.to_string())?;
    let run = Run::of(&scenario);
    let step_s = run.time_step_s().map_err(|error| error.to_string())?;
    said(run.rows(&[], Some((STEPS * step_s).min(LONGEST_S))))
}

fn robot_file(case: &Case) -> Result<(), String> {
    let urdf = case.path.with_file_name("robot.urdf");
    let text = std::fs::read_to_string(&urdf).map_err(|error| error.to_string())?;
    said(Robot::from_texts(
        (&text, &urdf),
        Some((&case.text(), case.path)),
        None,
    ))
}

fn urdf(case: &Case) -> Result<(), String> {
    said(Robot::from_texts((&case.text(), case.path), None, None))
}

fn xacro(case: &Case) -> Result<(), String> {
    said(expanded_urdf(
        &case.written(),
        &Default::default(),
        &Default::default(),
    ))
}

fn program(case: &Case) -> Result<(), String> {
    let dialect = dialect_of(case.path).expect("a dialect");
    let path = case.written();
    let beside = |asked: &Path| match asked.file_name() == path.file_name() {
        true => read_text(&path),
        // What the program calls stands beside the file that it was made of.
        false => read_text(
            &case
                .path
                .with_file_name(asked.file_name().unwrap_or_default()),
        ),
    };
    thread_local! {
        static ROBOT: Robot = Robot::load(&root().join("assets/robots/hp20/robot.urdf"), None, None)
            .expect("an arm");
    }
    ROBOT.with(|robot| {
        let frames = Frames {
            tool: Tool::of(robot, "wheel", 0),
            world_from_base: Isometry3::identity(),
        };
        let settings = Settings {
            pulses_per_deg: Some(1000.0),
            ..Settings::default()
        };
        said(dialect.read(&path, &beside, robot, &frames, &settings))
    })
}
