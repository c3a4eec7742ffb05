//! The `[process.belt]` table: a belt over a contact wheel finishes the face of a path job,
//! simulated along the job's lines.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::abrasive::Abrasive;
use truecut_core::wheel::belt::BeltWheel;
use truecut_core::wheel::force_control::ForceControl;
use truecut_plan::path_file::PathFile;
use truecut_plan::surface_path::{ContactWheel, PathSetup, SurfaceSetup, Symmetry};

use crate::check::Check;
use crate::control::{ControlTable, Pressed};
use crate::error::ScenarioError;
use crate::fault::Fault;
use crate::path_job::PathJob;
use crate::process::path_file::PathFileTable;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room, WheelPart, hold};
use crate::robot::RobotSpec;
use crate::roughness::RoughnessTable;
use crate::units::from_mm;

/// Belt finishing of a face. The wheel's centre is the tool frame's origin, its axis the frame's y;
/// z points into the face, as in path jobs.
#[derive(Debug, Clone, PartialEq)]
pub struct BeltSpec {
    /// Face, wheel and lines.
    pub job: BeltJob,
    /// How many of the symmetric copies are finished, one after another.
    pub copies: usize,
    /// Path from CAM, or robot program, that leads the wheel in the place of the job's lines.
    pub path: Option<PathFile>,
    /// Speed of the belt over the face, positive along the tool's x axis.
    pub belt_m_per_s: f64,
    /// Contact wheel and belt.
    pub wheel: BeltWheel,
    /// What the belt does to the face.
    pub abrasive: Abrasive,
    /// Largest size of the cells on which removal is kept.
    pub cell_m: f64,
    /// What holds the normal force.
    pub control: ForceControl,
}

/// What a run takes from a path job.
#[derive(Debug, Clone, PartialEq)]
pub struct BeltJob {
    /// The job's file.
    pub file: PathBuf,
    /// The arm, which is the scenario's, and the posture that it comes from.
    pub robot: RobotSpec,
    /// The face.
    pub surface: SurfaceSetup,
    /// The contact wheel.
    pub wheel: ContactWheel,
    /// The lines.
    pub path: PathSetup,
    /// Copies of the face.
    pub symmetry: Option<Symmetry>,
    /// Speed of moves by joints, share of the top speed.
    pub joint_share: f64,
    /// Largest motion of one joint from point to point on a line, rad.
    pub largest_step_rad: f64,
}

/// Belt finishing of the face of a path job.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BeltTable {
    /// Path job (`truecut path`) that gives face, wheel, lines, feed, symmetry and the posture that
    /// the arm comes from, relative to this file. Its robot is the scenario's.
    job: String,
    /// How many of the job's copies are finished, one after another. Default: 1.
    #[schemars(range(min = 1), extend("x-rule" = "one copy at least is finished"))]
    copies: Option<usize>,
    /// Path from a file in the place of the job's lines: what follows it is the wheel's centre, or
    /// a place in the tool frame.
    path: Option<PathFileTable>,
    /// Speed of the belt over the face, positive along the tool's x axis (the wheel's axis times
    /// the direction into the face).
    belt_m_per_s: f64,
    /// Tension of the belt.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "a belt pulls and cannot push"))]
    tension_n: f64,
    /// Thickness of the rubber on the wheel's hub.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "rubber has a thickness"))]
    rubber_mm: f64,
    /// Poisson's ratio of the rubber. Default: 0.49.
    #[schemars(extend("minimum" = 0.0, "exclusiveMaximum" = 0.5, "x-rule" = "0.5 is incompressible"))]
    poisson: Option<f64>,
    /// Viscous pressure per rate at which the wheel's surface is pressed in. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "negative damping would create energy"))]
    damping_pa_s_per_m: Option<f64>,
    /// Coefficient of friction between belt and face.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: f64,
    /// Preston coefficient.
    #[schemars(extend(
        "minimum" = 0.0,
        "maximum" = 1e-6,
        "x-rule" = "grinding removes material, less than a metre of it on a metre's way under 1 MPa"
    ))]
    preston_per_pa: f64,
    /// Largest size of the cells on which removal is kept. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cell has a size"))]
    cell_mm: Option<f64>,
    /// What holds the normal force: nothing but the path, or a carrier between tool and wheel that
    /// moves along the tool's z axis. Default: law = "position".
    control: Option<ControlTable>,
    /// How the surface smooths.
    roughness: RoughnessTable,
}

const TABLE: &str = "process.belt";
const JOB: &str = "process.belt.job";

/// Rubber is all but incompressible.
const DEFAULT_POISSON: f64 = 0.49;
/// Size of the cells where a scenario does not give one, mm.
const DEFAULT_CELL_MM: f64 = 1.0;

impl BeltTable {
    /// `None` after recording a fault. `folder` is that of the scenario file.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<BeltSpec> {
        if self.belt_m_per_s == 0.0 {
            let message = "is 0, but must not be: a belt that stands still only rubs by the feed";
            check.wrong(TABLE, "belt_m_per_s", message, "does not run");
        }
        check.belt(TABLE, "belt_m_per_s", self.belt_m_per_s);
        let polishing = self.roughness.resolve(TABLE, check);
        let path = match self.path {
            None => Some(None),
            Some(path) => {
                let because = "[process.belt.path] leads the wheel over one face";
                check.ignored(TABLE, &["copies"], because);
                let table = format!("{TABLE}.path");
                path.resolve(&table, folder, check).map(Some)
            }
        };
        let job = read_job(&self.job, folder, check)?;
        check_rubber(self.rubber_mm, &self.job, &job.wheel, check);
        let control = match self.control {
            None => Some(ForceControl::Position),
            Some(table) => {
                let pressed = Pressed::ByPath {
                    indentation_m: job.wheel.indentation_m,
                    says: "the path job's wheel.indentation_mm",
                    // How far a path from a file is lifted is its own affair.
                    lift_m: match path {
                        Some(Some(_)) => f64::INFINITY,
                        _ => job.path.lift_m,
                    },
                };
                let control = table.resolve(&format!("{TABLE}.control"), &pressed, check);
                control.map(|(control, _)| control)
            }
        };
        Some(BeltSpec {
            control: control?,
            copies: copies(self.copies, &self.job, &job, check)?,
            path: path?,
            belt_m_per_s: self.belt_m_per_s,
            wheel: BeltWheel {
                radius_m: job.wheel.radius_m,
                width_m: job.wheel.width_m,
                contact_modulus_pa: job.wheel.modulus_pa,
                poisson: self.poisson.unwrap_or(DEFAULT_POISSON),
                rubber_m: from_mm(self.rubber_mm),
                tension_n: self.tension_n,
                damping_pa_s_per_m: self.damping_pa_s_per_m.unwrap_or(0.0),
            },
            abrasive: Abrasive {
                mu: self.mu,
                preston_per_pa: self.preston_per_pa,
                polishing,
            },
            cell_m: from_mm(self.cell_mm.unwrap_or(DEFAULT_CELL_MM)),
            job,
        })
    }
}

/// Refuses rubber that the job's wheel has no room for, or that the path would press through.
fn check_rubber(rubber_mm: f64, written: &str, wheel: &ContactWheel, check: &mut Check) {
    let rubber_m = from_mm(rubber_mm);
    let (bound, limit_m, why) = if rubber_m >= wheel.radius_m {
        let why = "it lies on a hub";
        ("below the wheel's radius", wheel.radius_m, why)
    } else if rubber_m <= wheel.indentation_m {
        let why = "the path would press the hub onto the face";
        ("above the indentation", wheel.indentation_m, why)
    } else {
        return;
    };
    let message = format!(
        "is {rubber_mm}, but must be {bound} of {} mm, which {written} gives: {why}",
        limit_m * 1e3
    );
    check.wrong(TABLE, "rubber_mm", message, "does not fit the wheel");
}

/// Copies that are finished: no more than the job has.
fn copies(asked: Option<usize>, written: &str, job: &BeltJob, check: &mut Check) -> Option<usize> {
    let most = job.symmetry.map_or(1, |symmetry| symmetry.count);
    let copies = asked.unwrap_or(1);
    if copies <= most {
        return Some(copies);
    }
    let why = match job.symmetry {
        Some(_) => "has no more copies",
        None => "has no [symmetry]",
    };
    let message = format!("is {copies}, but must be at most {most}: {written} {why}");
    check.wrong(TABLE, "copies", message, "too many");
    None
}

/// The job, or `None` after recording a fault.
fn read_job(written: &str, folder: &Path, check: &mut Check) -> Option<BeltJob> {
    let file = folder.join(written);
    let refused = match PathJob::load(&file) {
        Ok(job) => match unfit(&job) {
            None => return Some(BeltJob::of(job)),
            Some(reason) => (format!("`{JOB}`: {written} {reason}"), "does not fit"),
        },
        Err(ScenarioError::Unreadable { reason, .. }) => {
            let message = format!("`{JOB}`: cannot read the path job {written}: {reason}");
            (message, "cannot be read")
        }
        Err(error) => {
            let line = error.problems().next().and_then(|problem| problem.line());
            let line = line.map_or_else(String::new, |line| format!(":{line}"));
            let message = format!("`{JOB}`: {written}{line} is no path job: {error}");
            (message, "no path job")
        }
    };
    check.refuse(Fault::value(JOB, refused.0, refused.1));
    None
}

/// Why a job cannot be simulated.
fn unfit(job: &PathJob) -> Option<String> {
    if job.wheel.indentation_m == 0.0 {
        return Some(
            "has no `wheel.indentation_mm`, but needs one above 0: the path presses the wheel on by it"
                .to_owned(),
        );
    }
    if let Some(taught) = job.taught.first() {
        return Some(format!(
            "plays the taught postures of {}, but a run follows planned lines only: leave [[taught]] out",
            taught.file.display()
        ));
    }
    None
}

impl BeltJob {
    fn of(job: PathJob) -> Self {
        Self {
            file: job.path().to_owned(),
            robot: job.robot,
            surface: job.surface,
            wheel: job.wheel,
            path: job.path,
            symmetry: job.symmetry,
            joint_share: job.program.joint_share,
            largest_step_rad: job.program.largest_step_rad,
        }
    }
}

impl BeltSpec {
    /// Speed at which the belt turns the contact wheel.
    pub fn wheel_rad_s(&self) -> f64 {
        self.belt_m_per_s.abs() / self.wheel.radius_m
    }

    /// Checks that the job's arm is the scenario's, and lets that come from the job's posture.
    fn lead_from_job(&self, robot: &mut RobotSpec, check: &mut Check) {
        let because = "the arm comes from the posture that the path job gives";
        check.ignored("robot", &["posture_deg", "posture_mm"], because);
        let arm = &self.job.robot;
        let config = |urdf: &Path, config: &Option<PathBuf>| {
            config
                .clone()
                .unwrap_or_else(|| urdf.with_file_name("robot.toml"))
        };
        let files = [
            ("urdf", arm.urdf.clone(), robot.urdf.clone()),
            (
                "transmission data",
                config(&arm.urdf, &arm.config),
                config(&robot.urdf, &robot.config),
            ),
        ];
        let other = files.iter().find(|(_, job, own)| !same_file(job, own));
        let told = match other {
            Some((what, job, own)) => {
                Some((*what, job.display().to_string(), own.display().to_string()))
            }
            None if arm.tip != robot.tip => {
                let name = |tip: &Option<String>| {
                    tip.clone()
                        .unwrap_or_else(|| "the end of the chain".to_owned())
                };
                Some(("tip", name(&arm.tip), name(&robot.tip)))
            }
            None if arm.arguments != robot.arguments => {
                let (job, own) = (&arm.arguments, &robot.arguments);
                Some(("list of arguments", format!("{job:?}"), format!("{own:?}")))
            }
            None => None,
        };
        if let Some((what, job, own)) = told {
            let message = format!(
                "`{JOB}` is for another robot: its {what} is {job}, the scenario's {own}; both must be the same, since the job's lines are solved for it"
            );
            check.refuse(Fault::value(JOB, message, "another robot"));
            return;
        }
        robot.posture_rad.clone_from(&arm.posture_rad);
        robot.posture_m.clone_from(&arm.posture_m);
    }
}

/// Whether two paths lead to one file; of files that are not there, whether they are written alike.
fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.belt.belt_m_per_s", "belt speed", &[0.6, 1.6]),
    Knob::new("process.belt.tension_n", "belt tension", &[0.5, 2.0]),
    Knob::new("process.belt.control.force_n", "force", &[0.5, 2.0]),
];

impl Room for BeltSpec {
    type Table = BeltTable;

    fn resolve(table: BeltTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.wheel_rad_s()),
            natural_duration_s: Some(f64::INFINITY),
            signals: &[
                "belt.normal_force",
                "belt.indentation",
                "belt.contact_width",
                "belt.position_u",
                "belt.position_v",
                "tool.displacement_x",
            ],
            knobs: KNOBS,
            files: &["job", "path.file"],
            needs_drive: Some("belt"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Job(self.job.file.clone()),
            parts: Parts {
                wheel: Some(WheelPart {
                    hold: hold(&self.control),
                    shows_removal: true,
                    turns: true,
                    over_edges: false,
                    indentation_m: self.job.wheel.indentation_m,
                }),
                ..Parts::NONE
            },
        }
    }

    fn lead(&self, robot: &mut RobotSpec, check: &mut Check) {
        self.lead_from_job(robot, check);
    }
}
