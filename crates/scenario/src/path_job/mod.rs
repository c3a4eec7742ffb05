//! The path job: a face, a contact wheel, how lines are laid, and the robot program that comes of
//! it.
//!
//! It is no scenario, since nothing is simulated in time, but follows the same rules: a schema
//! derived from its tables, units in the keys, faults with their places.

mod motion;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;
use truecut_plan::program::ProgramSetup;
use truecut_plan::surface_path::{ContactWheel, PathSetup, SurfaceSetup, Symmetry, TaughtFile};

use motion::SymmetryTable;
pub(crate) use tables::{SurfaceTable, place};

use crate::check::Check;
use crate::document::Document;
use crate::error::{ScenarioError, read_text};
use crate::file;
use crate::format::Format;
use crate::robot::RobotSpec;
use crate::schema::schema_of;
use crate::xacro_arguments::ArgumentTable;

/// A path job in SI.
#[derive(Debug, Clone)]
pub struct PathJob {
    /// Name of the job.
    pub name: String,
    /// The arm, in the posture that it comes from.
    pub robot: RobotSpec,
    /// The face.
    pub surface: SurfaceSetup,
    /// The wheel.
    pub wheel: ContactWheel,
    /// The lines on the face.
    pub path: PathSetup,
    /// Copies of the face.
    pub symmetry: Option<Symmetry>,
    /// Postures that were taught, in the order of the file.
    pub taught: Vec<TaughtFile>,
    /// The robot program.
    pub program: ProgramSetup,
    /// File of what stands about the arm, for clearances.
    pub cell: Option<PathBuf>,
    document: Document,
}

/// A truecut path job: a face, a contact wheel, and the robot program that leads one over the
/// other.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "truecut path job")]
struct FileTable {
    /// Name of the job.
    name: String,
    /// The arm that leads the wheel. The wheel's centre is the tool frame's origin, its axis the
    /// frame's y.
    robot: ArmTable,
    /// The face to be finished.
    surface: SurfaceTable,
    /// The contact wheel.
    wheel: tables::WheelTable,
    /// The lines on the face.
    path: tables::PathTable,
    /// Copies of the face about an axis. Default: the face stands alone.
    symmetry: Option<SymmetryTable>,
    /// Postures recorded on the arm, mixed with the planned lines.
    taught: Option<Vec<motion::TaughtTable>>,
    /// The robot program.
    program: motion::ProgramTable,
    /// File of the cell, relative to this file: what stands about the arm and what it carries.
    /// Default: none; clearances are those from the part alone.
    cell: Option<String>,
}

/// The arm that leads the wheel.
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
    /// Rotary joints of the posture that the arm comes from, in chain order: of equally short ways
    /// the one from here is taken. Default: none; one of `posture_deg` and `posture_mm` must be
    /// there.
    posture_deg: Option<Vec<f64>>,
    /// Prismatic joints of that posture, in chain order. Only for `process.belt`: robot programs
    /// are written for rotary arms.
    posture_mm: Option<Vec<f64>>,
}

impl PathJob {
    /// Reads a path job.
    ///
    /// # Errors
    /// A file that cannot be read; every rule of the format that is broken, with its place.
    pub fn load(path: &Path) -> Result<PathJob, ScenarioError> {
        let text = read_text("path job", path)?;
        PathJob::from_str(path, &text)
    }

    /// Reads a path job from a text. `path` names it in errors, and its folder resolves relative
    /// paths.
    ///
    /// # Errors
    /// Every rule of the format that is broken, with its place.
    pub fn from_str(path: &Path, text: &str) -> Result<PathJob, ScenarioError> {
        let (table, document) = file::read::<FileTable>(Format::PathJob, path, text, &SCHEMA)?;
        table.resolve(document)
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        self.document.path()
    }

    /// Name of the file without folder and extension; outputs are named by it.
    pub fn stem(&self) -> String {
        self.document.stem("path")
    }

    /// An error about the value of a dotted key that showed only later, e.g. when the path was
    /// planned.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> ScenarioError {
        self.document.problem(key, message)
    }

    /// JSON Schema of the path job, for editors. `x-rule` beside a bound gives its reason.
    pub fn json_schema() -> Json {
        SCHEMA.as_ref().clone()
    }
}

static SCHEMA: LazyLock<Arc<Json>> = LazyLock::new(|| Arc::new(schema_of::<FileTable>()));

impl FileTable {
    fn resolve(self, document: Document) -> Result<PathJob, ScenarioError> {
        let folder = document.folder();
        let mut check = Check::new(&document);
        let wheel = self.wheel.resolve(&mut check);
        let path = self.path.resolve(wheel.indentation_m, &mut check);
        let turntable = self.symmetry.as_ref().and_then(SymmetryTable::turntable);
        let symmetry = self.symmetry.map(|table| table.resolve(&mut check));
        let program = self.program.resolve(turntable, &mut check);
        let surface = self.surface.resolve("surface", &folder, &mut check);
        let robot = self.robot.resolve(&folder, &mut check);
        let taught = self.taught.unwrap_or_default().into_iter();
        let taught = taught.map(|table| table.resolve(&folder)).collect();
        let faults = check.into_faults();
        document.refuse(faults)?;
        let (Some(path), Some(program), Some(surface)) = (path, program, surface) else {
            // A table that does not resolve has recorded a fault.
            return Err(document.problem("name", "the path job cannot be resolved"));
        };
        Ok(PathJob {
            name: self.name,
            robot,
            surface,
            wheel,
            path,
            symmetry,
            taught,
            program,
            cell: self.cell.map(|file| folder.join(file)),
            document,
        })
    }
}

impl ArmTable {
    fn resolve(self, folder: &Path, check: &mut Check) -> RobotSpec {
        if self.posture_deg.is_none() && self.posture_mm.is_none() {
            let who = "the way from where the arm comes from (`posture_mm` if it has slides)";
            check.needed::<()>("robot", "posture_deg", None, who);
        }
        let files = (self.urdf, self.config, self.tip, self.arguments);
        RobotSpec::read(folder, files, self.posture_deg, self.posture_mm)
    }
}
