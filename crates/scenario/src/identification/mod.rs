//! The identification file: measurements of the arm itself, load against deflection and hammer
//! FRFs.
//!
//! It is no scenario, since nothing is simulated in time, but follows the same rules: a schema
//! derived from its tables, units said with every column, faults with their places.

mod hammer;
mod modes;
mod stiffness;

use std::path::Path;
use std::sync::{Arc, LazyLock};

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;

pub use truecut_arm::FrameId;

pub use hammer::{
    Direction, FrfSpec, FrfValues, HammerPoint, ImpactSpec, ModesSpec, MotionKind, Signal,
};
pub use stiffness::{Axes, StiffnessColumn, StiffnessQuantity, StiffnessSpec, Zero};

use crate::check::Check;
use crate::document::Document;
use crate::error::{ScenarioError, read_text};
use crate::fault::Fault;
use crate::file;
use crate::format::Format;
use crate::robot::RobotSpec;
use crate::schema::schema_of;
use crate::xacro_arguments::ArgumentTable;

/// Measurements of an arm, in SI, and the arm that they are held against.
#[derive(Debug, Clone)]
pub struct Identification {
    /// Name of the measurement.
    pub name: String,
    /// The arm.
    pub robot: RobotSpec,
    /// Load against deflection.
    pub stiffness: Option<StiffnessSpec>,
    /// Hammer FRFs.
    pub modes: Option<ModesSpec>,
    document: Document,
}

/// A truecut identification: an arm, and what was measured of its stiffness and its modes.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "truecut identification")]
struct FileTable {
    /// Name of the measurement.
    name: String,
    /// The arm that was measured.
    robot: ArmTable,
    /// Load against deflection: a table of postures, loads and displacements.
    stiffness: Option<stiffness::StiffnessTable>,
    /// Hammer FRFs of one posture.
    modes: Option<modes::ModesTable>,
}

/// The arm that was measured.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ArmTable {
    /// URDF file, relative to this file.
    urdf: String,
    /// Transmission data, relative to this file. Default: robot.toml beside the URDF.
    config: Option<String>,
    /// Link whose frame is the flange. Default: the end of the chain.
    tip: Option<String>,
    /// Arguments of a xacro file, by name: texts, numbers or truths. Default: those of the file.
    arguments: Option<ArgumentTable>,
    /// Rotary joints, in chain order. Default: all zero; joints with a column in [stiffness] take
    /// it from there.
    posture_deg: Option<Vec<f64>>,
    /// Prismatic joints, in chain order. Default: all zero.
    posture_mm: Option<Vec<f64>>,
    /// Whether gravity acts. Default: true.
    gravity: Option<bool>,
    /// Factor on all masses and inertias, e.g. to what a scale says. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "masses are positive"))]
    inertia_scale: Option<f64>,
}

impl Identification {
    /// Reads an identification file.
    ///
    /// # Errors
    /// A file that cannot be read; every rule of the format that is broken, with its place.
    pub fn load(path: &Path) -> Result<Identification, ScenarioError> {
        let text = read_text("identification", path)?;
        Identification::from_str(path, &text)
    }

    /// Reads an identification from a text. `path` names it in errors, and its folder resolves
    /// relative paths.
    ///
    /// # Errors
    /// Every rule of the format that is broken, with its place.
    pub fn from_str(path: &Path, text: &str) -> Result<Identification, ScenarioError> {
        let (table, document) =
            file::read::<FileTable>(Format::Identification, path, text, &SCHEMA)?;
        table.resolve(document)
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        self.document.path()
    }

    /// Name of the file without folder and extension; outputs are named by it.
    pub fn stem(&self) -> String {
        self.document.stem("identification")
    }

    /// An error about the value of a dotted key that showed only later, e.g. with the data.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> ScenarioError {
        self.document.problem(key, message)
    }

    /// Whether the file gives a value for the dotted key.
    pub fn gives(&self, key: &str) -> bool {
        self.document.has(key)
    }

    /// JSON Schema of the identification file, for editors. `x-rule` beside a bound gives its
    /// reason.
    pub fn json_schema() -> Json {
        SCHEMA.as_ref().clone()
    }
}

static SCHEMA: LazyLock<Arc<Json>> = LazyLock::new(|| Arc::new(schema_of::<FileTable>()));

impl FileTable {
    fn resolve(self, document: Document) -> Result<Identification, ScenarioError> {
        let mut check = Check::new(&document);
        let folder = document.folder();
        if self.stiffness.is_none() && self.modes.is_none() {
            let message = "neither [stiffness] nor [modes]: nothing was measured".to_owned();
            check.refuse(Fault::key("name", message, "nothing to identify"));
        }
        let stiffness = (self.stiffness).and_then(|table| table.resolve(&folder, &mut check));
        let modes = (self.modes).and_then(|table| table.resolve(&folder, &mut check));
        let faults = check.into_faults();
        document.refuse(faults)?;
        Ok(Identification {
            name: self.name,
            robot: self.robot.resolve(&folder),
            stiffness,
            modes,
            document,
        })
    }
}

impl ArmTable {
    fn resolve(self, folder: &Path) -> RobotSpec {
        let files = (self.urdf, self.config, self.tip, self.arguments);
        RobotSpec {
            gravity: self.gravity.unwrap_or(true),
            inertia_scale: self.inertia_scale.unwrap_or(1.0),
            ..RobotSpec::read(folder, files, self.posture_deg, self.posture_mm)
        }
    }
}
