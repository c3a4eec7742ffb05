//! Readers of what stands beside a scenario or a robot, and of what earlier searches left.

use std::sync::LazyLock;
use std::time::Duration;

use tempfile::TempDir;
use truecut::discrepancy::model::{Candidate, Columns, Model, PredictError};
use truecut::recording::ChannelSpec;
use truecut::scenario::UncertainSpec;
use truecut::scenario::effect::Effect;
use truecut::{Engine, KeptModel, Scenario, SweepOutputs, SweepParts};
use truecut_arm::{Robot, expanded_urdf};
use truecut_plan::surface::part::{Part, PartOptions};
use truecut_plan::surface::{Mesh, MeshUse};
use truecut_plan::surface_path::TaughtPoints;

use crate::readers::{Case, said};
use crate::seeds::{Seed, root, seeds};

/// Rows of a sweep, and its journal's name.
const SWEEP: &str = "name = \"fuzz\"\n[robot]\nurdf = \"assets/robots/rig_1dof/robot.urdf\"\n\
                     [run]\nduration_s = 0.001\n[process.load]\nrelease_n = [100, 0, 0]\n\
                     [[sweep.axis]]\nkey = \"process.load.release_n.0\"\nvalues = [10, 20, 30]\n\
                     [[sweep.column]]\nname = \"swing\"\nmetric = \"peak\"\n\
                     channel = \"tool.displacement_x\"\nunit = \"um\"\n";
const ROWS: &str = "sweep.rows.jsonl";
/// Predictions that the file of a search holds.
const PREDICTIONS: u8 = 4;
const SEARCH: &str = "fuzz";

pub(crate) fn materials() -> Vec<Seed> {
    seeds(&["assets/materials"], &["toml"], |_, _| true)
}

/// Coefficients of a material, as a milling scenario names them.
pub(crate) fn material(case: &Case) -> Result<(), String> {
    static MILLING: LazyLock<(std::path::PathBuf, String)> = LazyLock::new(|| {
        let path = root().join("scenarios/milling/own_surface.toml");
        let text = std::fs::read_to_string(&path).expect("a scenario");
        (path, text)
    });
    let (path, text) = &*MILLING;
    let file = format!("'{}'", case.written().display());
    let overrides = [("process.milling.material.file".to_owned(), file)];
    said(Scenario::from_str(path, text, &overrides))
}

pub(crate) fn taught_points() -> Vec<Seed> {
    seeds(
        &["tests/invalid_input", "tests/verify"],
        &["csv"],
        |_, bytes| String::from_utf8_lossy(bytes).contains("j1,j2,j3"),
    )
}

pub(crate) fn taught(case: &Case) -> Result<(), String> {
    static ROBOT: LazyLock<Robot> = LazyLock::new(|| {
        let urdf = root().join("assets/robots/hp20/robot.urdf");
        Robot::load(&urdf, None, None).expect("an arm")
    });
    said(TaughtPoints::from_text(&case.text(), case.path, &ROBOT))
}

pub(crate) fn yamls() -> Vec<Seed> {
    seeds(&["tests/crosscheck/xacro"], &["yaml"], |_, _| true)
}

/// Values that a xacro loads.
pub(crate) fn yaml(case: &Case) -> Result<(), String> {
    let file = case.written();
    let name = file.file_name().expect("a file").to_string_lossy();
    let text = format!(
        "<robot name=\"a\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\
         <xacro:property name=\"values\" value=\"${{xacro.load_yaml('{name}')}}\"/>\
         <link name=\"l${{values}}\"/></robot>"
    );
    let robot = case.folder.join("loads.xacro");
    std::fs::write(&robot, text).expect("a file of the case");
    said(expanded_urdf(
        &robot,
        &Default::default(),
        &Default::default(),
    ))
}

fn sweep() -> Scenario {
    Scenario::from_str(&root().join("fuzz.toml"), SWEEP, &[]).expect("a scenario")
}

/// What a sweep leaves that was stopped when its rows were done, and its table was not.
pub(crate) fn sweep_rows() -> Vec<Seed> {
    let folder = TempDir::new().expect("a folder");
    let scenario = sweep();
    let outputs =
        SweepOutputs::prepare(folder.path(), &scenario, Engine::Rapier).expect("a folder");
    outputs.run(&|_| (), None).expect("rows");
    drop(outputs);
    let path = folder.path().join(scenario.stem()).join(ROWS);
    let bytes = std::fs::read(&path).expect("rows");
    vec![Seed { path, bytes }]
}

/// A sweep goes on from there; it is right with whatever is left, and accepted where all rows are.
pub(crate) fn sweep_goes_on(case: &Case) -> Result<(), String> {
    static SCENARIO: LazyLock<Scenario> = LazyLock::new(sweep);
    let folder = case.folder.join(SCENARIO.stem());
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join(ROWS), case.bytes).expect("rows");
    let outputs = SweepOutputs::prepare(case.folder, &SCENARIO, Engine::Rapier);
    let outputs = outputs.map_err(|e| e.to_string())?;
    let kept = outputs.kept();
    let table = outputs.run(&|_| (), None).map_err(|e| e.to_string())?;
    assert_eq!(table.rows.len(), 3, "rows of the sweep");
    match kept {
        3 => Ok(()),
        _ => Err(format!("{kept} rows kept")),
    }
}

/// The same rows as a part of a sweep: a table where all are there, and fit.
pub(crate) fn sweep_part(case: &Case) -> Result<(), String> {
    static SCENARIO: LazyLock<Scenario> = LazyLock::new(sweep);
    static PARTS: LazyLock<SweepParts<'static>> =
        LazyLock::new(|| SweepParts::of(&SCENARIO, Engine::Rapier).expect("a sweep"));
    let table = PARTS.merge(&[case.written()]).map_err(|e| e.to_string())?;
    assert_eq!(table.rows.len(), 3, "rows of the sweep");
    assert!(
        table
            .rows
            .iter()
            .all(|row| row.len() == table.columns.len())
    );
    Ok(())
}

/// Predicts a little, slowly enough to be worth keeping.
struct Slow(Duration);

impl Model for Slow {
    fn channels(&self) -> &[ChannelSpec] {
        &[]
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &[]
    }

    fn candidates(&self) -> Vec<Candidate> {
        Vec::new()
    }

    fn predict(&self, nominal: &[f64], _: &[Effect]) -> Result<Columns, PredictError> {
        std::thread::sleep(self.0);
        match nominal {
            [value] if *value > 0.0 => Ok(vec![vec![*value; 5]; 2]),
            _ => Err(PredictError("it diverges".to_owned())),
        }
    }
}

/// What a diagnosis leaves that was stopped.
pub(crate) fn predictions() -> Vec<Seed> {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("diagnosis.runs");
    let slow = Slow(Duration::from_millis(1));
    let model = KeptModel::new(&slow, &path, SEARCH, None).expect("a file");
    for asked in 0..PREDICTIONS {
        let _ = model.predict(&[f64::from(asked)], &[]);
    }
    assert_eq!(model.made(), usize::from(PREDICTIONS), "predictions kept");
    let bytes = std::fs::read(&path).expect("predictions");
    vec![Seed { path, bytes }]
}

/// The search goes on from there; accepted where all is left.
pub(crate) fn search_goes_on(case: &Case) -> Result<(), String> {
    let model = Slow(Duration::ZERO);
    let path = case.written();
    let model = KeptModel::new(&model, &path, SEARCH, None).map_err(|error| error.to_string())?;
    for asked in 0..PREDICTIONS {
        let _ = model.predict(&[f64::from(asked)], &[]);
    }
    match model.kept() {
        kept if kept == usize::from(PREDICTIONS) => Ok(()),
        kept => Err(format!("{kept} predictions kept")),
    }
}

/// As a part, a face and a body.
pub(crate) fn mesh(case: &Case) -> Result<(), String> {
    let path = case.written();
    let options = PartOptions {
        unit_m: 1e-3,
        crease_rad: 0.5,
        weld_m: None,
    };
    let part = Part::load(&path, &options, &|_| ());
    part.map_err(|error| error.to_string())?;
    said(Mesh::load(&path, 1e-3, MeshUse::Face))?;
    said(Mesh::load(&path, 1e-3, MeshUse::Body))
}
