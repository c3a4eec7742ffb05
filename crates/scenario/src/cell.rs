//! The cell: what stands about an arm and what its flange carries, for clearances.
//!
//! It is a file of its own, since one cell serves many jobs, programs and scenarios.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use nalgebra::{Isometry3, Vector3};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;
use truecut_plan::clearance::{Carried, CellError, CellSetup, Form, Standing};
use truecut_plan::surface::MeshFile;

use crate::check::Check;
use crate::document::Document;
use crate::error::{ScenarioError, read_text};
use crate::file;
use crate::format::Format;
use crate::path_job::place;
use crate::schema::schema_of;
use crate::units::from_mm;

/// A cell in SI.
#[derive(Debug, Clone)]
pub struct CellFile {
    /// What stands and what is carried, carried things in the frame of the flange.
    pub setup: CellSetup,
    document: Document,
}

/// A truecut cell: part, fixtures and what the flange carries, for clearances.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "truecut cell")]
struct FileTable {
    /// Least clearance that is allowed. Default: 0, nothing may touch.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a distance"))]
    clearance_mm: Option<f64>,
    /// The part, for programs, paths from CAM and scenarios; a path job has its own.
    part: Option<PartTable>,
    /// What stands about the part: tables, vices, clamps, walls.
    fixture: Option<Vec<FixtureTable>>,
    /// What the flange carries beside what the robot's file has: spindle, bracket, cutter.
    carried: Option<Vec<CarriedTable>>,
}

/// A form: one of a box, a cylinder and a mesh.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ShapeTable {
    /// Sides of a box along x, y and z, its middle at the origin of its frame.
    box_mm: Option<[f64; 3]>,
    /// Radius of a cylinder along z, its middle at the origin of its frame.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cylinder has a radius"))]
    radius_mm: Option<f64>,
    /// Length of that cylinder.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cylinder has a length"))]
    length_mm: Option<f64>,
    /// Mesh (.stl, .obj, .ply or .step), relative to this file.
    mesh: Option<String>,
    /// Length of the mesh's unit. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a unit has a length"))]
    unit_mm: Option<f64>,
}

/// The part.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PartTable {
    /// Its form.
    shape: ShapeTable,
    /// Where its frame stands in the world. Default: [0, 0, 0].
    xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of its frame about the world's x, y, z. Default: [0, 0, 0].
    rpy_deg: Option<[f64; 3]>,
}

/// Something that stands still.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FixtureTable {
    /// Its name in reports.
    name: String,
    /// Its form.
    shape: ShapeTable,
    /// Where its frame stands in the world. Default: [0, 0, 0].
    xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of its frame about the world's x, y, z. Default: [0, 0, 0].
    rpy_deg: Option<[f64; 3]>,
    /// Links of the arm and carried bodies whose clearance from it does not matter. Default: none.
    may_touch: Option<Vec<String>>,
}

/// A frame of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Frame {
    /// The tip link of the URDF.
    Flange,
    /// The tool frame of robot.toml.
    Tool,
}

/// Something fixed to the flange.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CarriedTable {
    /// Its name in reports.
    name: String,
    /// Its form; a mesh counts as its convex hull.
    shape: ShapeTable,
    /// The frame in which it is placed. Default: "flange".
    frame: Option<Frame>,
    /// Where its frame stands in that. Default: [0, 0, 0].
    xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of its frame in that. Default: [0, 0, 0].
    rpy_deg: Option<[f64; 3]>,
    /// Whether it works on the part, so that it may touch that where it is fed. Default: false.
    cuts: Option<bool>,
}

impl CellFile {
    /// Reads a cell before the arm whose tool frame is given.
    ///
    /// # Errors
    /// A file that cannot be read; every rule of the format that is broken, with its place.
    pub fn load(path: &Path, flange_from_tool: &Isometry3<f64>) -> Result<CellFile, ScenarioError> {
        let text = read_text("cell", path)?;
        CellFile::from_str(path, &text, flange_from_tool)
    }

    /// Reads a cell from a text. `path` names it in errors, and its folder resolves relative paths.
    ///
    /// # Errors
    /// Every rule of the format that is broken, with its place.
    pub fn from_str(
        path: &Path,
        text: &str,
        flange_from_tool: &Isometry3<f64>,
    ) -> Result<CellFile, ScenarioError> {
        let (table, document) = file::read::<FileTable>(Format::Cell, path, text, &SCHEMA)?;
        table.resolve(flange_from_tool, document)
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        self.document.path()
    }

    /// An error about the value of a dotted key that showed only later.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> ScenarioError {
        self.document.problem(key, message)
    }

    /// The error of a cell that could not be made of this file.
    pub fn refused(&self, error: &CellError) -> ScenarioError {
        self.document.problem(&error.key, error.to_string())
    }

    /// JSON Schema of the cell, for editors. `x-rule` beside a bound gives its reason.
    pub fn json_schema() -> Json {
        SCHEMA.as_ref().clone()
    }
}

static SCHEMA: LazyLock<Arc<Json>> = LazyLock::new(|| Arc::new(schema_of::<FileTable>()));

impl FileTable {
    fn resolve(
        self,
        flange_from_tool: &Isometry3<f64>,
        document: Document,
    ) -> Result<CellFile, ScenarioError> {
        let folder = document.folder();
        let mut check = Check::new(&document);
        let part = self.part.and_then(|table| {
            Some(Standing {
                name: "part".to_owned(),
                form: table.shape.resolve("part.shape", &folder, &mut check)?,
                world_from_form: place(table.xyz_mm, table.rpy_deg),
                may_touch: Vec::new(),
            })
        });
        let fixtures = self.fixture.unwrap_or_default().into_iter().enumerate();
        let fixtures = fixtures.filter_map(|(index, table)| {
            let key = format!("fixture.{index}.shape");
            Some(Standing {
                name: table.name,
                form: table.shape.resolve(&key, &folder, &mut check)?,
                world_from_form: place(table.xyz_mm, table.rpy_deg),
                may_touch: table.may_touch.unwrap_or_default(),
            })
        });
        let fixtures = fixtures.collect();
        let carried = self.carried.unwrap_or_default().into_iter().enumerate();
        let carried = carried.filter_map(|(index, table)| {
            let key = format!("carried.{index}.shape");
            let at = place(table.xyz_mm, table.rpy_deg);
            Some(Carried {
                name: table.name,
                form: table.shape.resolve(&key, &folder, &mut check)?,
                flange_from_form: match table.frame.unwrap_or(Frame::Flange) {
                    Frame::Flange => at,
                    Frame::Tool => flange_from_tool * at,
                },
                cuts: table.cuts.unwrap_or(false),
            })
        });
        let setup = CellSetup {
            least_m: from_mm(self.clearance_mm.unwrap_or(0.0)),
            part,
            fixtures,
            carried: carried.collect(),
        };
        let faults = check.into_faults();
        document.refuse(faults)?;
        Ok(CellFile { setup, document })
    }
}

impl ShapeTable {
    /// `None` after recording a fault.
    fn resolve(self, key: &str, folder: &Path, check: &mut Check) -> Option<Form> {
        let is_cylinder = self.radius_mm.is_some() || self.length_mm.is_some();
        let given = [self.box_mm.is_some(), is_cylinder, self.mesh.is_some()];
        if self.mesh.is_none() {
            check.ignored(
                key,
                &["unit_mm"],
                "there is no `mesh` whose unit it could be",
            );
        }
        match (given.iter().filter(|one| **one).count(), self.mesh) {
            (0, _) => {
                let who = "a form (or `radius_mm` and `length_mm` of a cylinder, or a `mesh`)";
                check.needed(key, "box_mm", None, who)
            }
            (1, Some(mesh)) => Some(Form::Mesh(MeshFile {
                file: folder.join(mesh),
                unit_m: from_mm(self.unit_mm.unwrap_or(1.0)),
            })),
            (1, None) => match self.box_mm {
                Some(sides) => {
                    let has_size = sides.iter().all(|side| side.is_finite() && *side > 0.0);
                    if !has_size {
                        let message = format!(
                            "is {sides:?}, but every side must be greater than 0: a box has a size"
                        );
                        check.wrong(key, "box_mm", message, "no size");
                        return None;
                    }
                    let sides_m = Vector3::from(sides.map(from_mm));
                    Some(Form::Box { sides_m })
                }
                None => {
                    let who = "a cylinder";
                    let radius = check.needed(key, "radius_mm", self.radius_mm, who);
                    let length = check.needed(key, "length_mm", self.length_mm, who);
                    Some(Form::Cylinder {
                        radius_m: from_mm(radius?),
                        length_m: from_mm(length?),
                    })
                }
            },
            _ => {
                let keys = ["box_mm", "radius_mm", "length_mm", "mesh"];
                let because = "a body has one form: a box, a cylinder or a mesh";
                check.ignored(key, &keys[1..], because);
                None
            }
        }
    }
}
