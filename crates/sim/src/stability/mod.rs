//! What stability tools need of a milling scenario: its arm, path and cut, and what they answer in
//! its terms.
//!
//! The arm is the nominal one with its transmissions, motors standing still; effects of the
//! scenario act in runs only.

mod along;
mod damping;
mod diagram;
mod draws;
pub(crate) mod known;
mod runs;
#[cfg(test)]
mod tests;
mod turns;
mod view;

pub use along::{PathPlace, PathRun, PathSegment, PathStability, path_runs, path_stability};
pub use damping::OtherDamping;
pub use draws::Draws;
pub use runs::{StabilityRun, stability_runs};
pub use turns::{PathPosture, PathPostures, path_postures, posture_runs};

use std::sync::Arc;

use nalgebra::{Unit, Vector3};
use truecut_arm::{FrameId, OpwGeometry, Robot, TransmissionValue, Wrist};
use truecut_core::chatter::TipMode;
use truecut_plan::motion::branch::BranchWish;
use truecut_plan::motion::straight::SolvedPath;
use truecut_plan::{Cut, Plan, PlanError, ToolPath, modes_in_cut};
use truecut_scenario::{MillingSpec, PathStart, PlannedPath, ProcessSpec, Scenario, TurnKnot};

use crate::error::SimError;
use crate::motion::straight;
use crate::posture::posture;
use crate::process::{linear_share, milling_notes};
use crate::robots::Robots;

const PATH: &str = "process.milling.path";
const DEPTH: &str = "process.milling.axial_depth_mm";

/// A milling scenario as its stability is asked for.
#[derive(Debug, Clone)]
pub struct MillingStudy {
    pub robot: Arc<Robot>,
    pub path: ToolPath,
    pub cut: Cut,
    milling: MillingSpec,
    /// The robot's posture in the scenario.
    posture: Vec<f64>,
    /// Direction of the tool's x axis at redundancy angle 0.
    zero_direction: Vector3<f64>,
}

impl MillingStudy {
    /// # Errors
    /// If the scenario is not one of milling, or something is wrong with its robot or path.
    pub fn of(scenario: &Scenario) -> Result<Self, SimError> {
        Self::read(scenario, &Robots::new())
    }

    fn read(scenario: &Scenario, robots: &Robots) -> Result<Self, SimError> {
        let ProcessSpec::Milling(milling) = &scenario.process else {
            return Err(SimError::scenario(
                "process",
                format!(
                    "the process is \"{}\", but must be \"milling\": a stability diagram and a choice of postures are about its \
                     cut",
                    scenario.process.name()
                ),
            ));
        };
        let robot = robots.robot(&scenario.robot)?;
        let posture = posture(&scenario.robot, &robot)?;
        let here = robot.world_from_frame(&posture, FrameId::Tool);
        let (start_m, axis, zero_direction) = match &milling.path.start {
            Some(start) => (
                Vector3::from(start.point_m),
                Vector3::from(start.tool_axis),
                Vector3::from(start.zero_direction),
            ),
            // The tool keeps its attitude, and that is redundancy angle 0.
            None => (
                here.translation.vector,
                here * Vector3::z(),
                here * Vector3::x(),
            ),
        };
        let end_m = start_m + Vector3::from(milling.path.direction) * milling.path.length_m;
        let axis = Unit::new_normalize(axis);
        let path = ToolPath::new(&[start_m, end_m], axis, zero_direction).map_err(in_scenario)?;
        Ok(Self {
            cut: Cut {
                nominal: milling.cut,
                spindle_rad_s: milling.spindle_rad_s,
                attached: milling.attached.clone(),
            },
            robot,
            path,
            milling: (**milling).clone(),
            posture,
            zero_direction,
        })
    }

    /// Whether teeth meet the surface that earlier teeth left.
    pub fn regeneration(&self) -> bool {
        self.milling.regeneration
    }

    /// Motion from tooth to tooth, as a part of the feed per tooth, beyond which a run has no
    /// growth rate.
    pub fn linear_share(&self) -> f64 {
        linear_share(self.milling.regeneration)
    }

    /// Postures along the scenario's own path.
    ///
    /// # Errors
    /// If the arm cannot follow it.
    pub fn postures(&self) -> Result<SolvedPath, SimError> {
        straight::solve(&self.milling.path, &self.robot, &self.posture)
    }

    /// Redundancy angle of the scenario's own path at a place, rad.
    pub fn angle_rad(&self, along_m: f64) -> f64 {
        let start = self.milling.path.start.as_ref();
        start.map_or(0.0, |start| start.redundancy_rad(along_m))
    }

    /// The branch that the scenario asks for, as far as it does.
    pub fn branch(&self) -> BranchWish {
        let start = self.milling.path.start.as_ref();
        start.map_or_else(BranchWish::default, PathStart::wish)
    }

    /// The robot's posture in the scenario, to which a plan shall start near; zeros for an arm that
    /// is not of six joints.
    pub fn near(&self) -> [f64; 6] {
        self.posture[..].try_into().unwrap_or([0.0; 6])
    }

    /// Modes between tool and workpiece at a posture in the milling frame.
    ///
    /// # Errors
    /// If a joint has no stiffness, or the tool's modes weigh more than the arm at its tool point.
    pub fn modes(&self, posture: &[f64]) -> Result<Vec<TipMode>, SimError> {
        (self.modes_of(&self.robot, posture, self.cut.spindle_rad_s)).map_err(in_scenario)
    }

    /// The same with another arm and at another spindle speed, rad/s.
    ///
    /// # Errors
    /// As [`Self::modes`].
    pub fn modes_of(
        &self,
        robot: &Robot,
        posture: &[f64],
        spindle_rad_s: f64,
    ) -> Result<Vec<TipMode>, PlanError> {
        let axes = self.path.world_from_milling(0);
        modes_in_cut(robot, posture, &axes, &self.cut.attached.at(spindle_rad_s))
    }

    /// What a reader of limits should know of the cut and of its modes.
    pub fn notes(&self, modes: &[TipMode]) -> Vec<String> {
        let mut notes = milling_notes(&self.cut.nominal);
        notes.extend(damping::damping_notes(modes));
        notes.extend(self.estimates());
        notes
    }

    /// What of the arm's values is estimated and decides its modes.
    pub fn estimates(&self) -> Option<String> {
        let values = match self.robot.damping_ratios.is_empty() {
            true => &[TransmissionValue::Stiffness, TransmissionValue::Damping][..],
            false => &[TransmissionValue::Stiffness],
        };
        self.robot.estimates(values)
    }

    /// A plan in the terms of a scenario file.
    pub fn planned(&self, plan: &Plan) -> PlannedPath {
        let first = &plan.points[0];
        let wrist =
            OpwGeometry::of(&self.robot).map(|geometry| geometry.branch(&first.posture).wrist);
        let turn = plan
            .knots()
            .into_iter()
            .map(|(at_m, redundancy_rad)| TurnKnot {
                at_m,
                redundancy_rad,
            });
        PlannedPath {
            start: PathStart {
                point_m: first.point_m.into(),
                tool_axis: self.path.tool_axis().into_inner().into(),
                zero_direction: self.zero_direction.into(),
                turn: turn.collect(),
                shoulder: Some(plan.family.shoulder),
                elbow: Some(plan.family.elbow),
                wrist: Some(wrist.unwrap_or(Wrist::Positive)),
            },
            end_m: plan.points[plan.points.len() - 1].point_m.into(),
            posture_rad: first.posture.clone(),
        }
    }
}

/// A planner's refusal at the key that it is about.
pub fn in_scenario(error: PlanError) -> SimError {
    let key = match error {
        PlanError::Arm(error) => return error.into(),
        PlanError::NoStableAngle { .. } => DEPTH,
        PlanError::NotOrthoParallel => "robot.urdf",
        _ => PATH,
    };
    SimError::scenario(key, error.to_string())
}
