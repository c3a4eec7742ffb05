//! A job as its file says it, and the program that it makes a robot run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, Robot};

use super::{Rconf, pulses_per_unit};
use crate::program::flags::Resolver;
use crate::program::travel::rated_chain;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Tool, Zone};

/// A job as its file says it, in the file's units.
#[derive(Debug, Clone, PartialEq)]
pub struct JbiJob {
    pub path: PathBuf,
    pub name: String,
    pub comment: String,
    pub tool: u8,
    /// By number.
    pub positions: BTreeMap<u32, JbiPosition>,
    /// Pulses of the station by number, with the line.
    pub stations: BTreeMap<u32, (f64, usize)>,
    pub moves: Vec<JbiMove>,
    /// Jobs that are called, in order.
    pub calls: Vec<JbiCall>,
    /// Outputs switched: before which move, number, value.
    pub outputs: Vec<(usize, u32, bool)>,
    /// What was left aside, with lines.
    pub notes: Vec<String>,
}

/// A call of another job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JbiCall {
    pub line: usize,
    pub name: String,
    /// How many of the job's own moves and switched outputs stand before it.
    pub moves: usize,
    pub outputs: usize,
}

/// A position with the line that holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct JbiPosition {
    pub line: usize,
    pub value: JbiPositionValue,
}

/// What a position holds.
#[derive(Debug, Clone, PartialEq)]
pub enum JbiPositionValue {
    Rectangular {
        xyz_mm: [f64; 3],
        /// About fixed axes x, then y, then z.
        rxyz_deg: [f64; 3],
        rconf: Rconf,
    },
    Pulses(Vec<f64>),
}

/// A move to a position.
#[derive(Debug, Clone, PartialEq)]
pub struct JbiMove {
    pub line: usize,
    pub path_point: usize,
    pub motion: Motion,
    pub position: u32,
    pub station: Option<u32>,
    /// `PL`: 0 stops at the point.
    pub level: Option<u8>,
}

impl JbiJob {
    /// The program that the job makes a robot run: the posture of each move is found from pose and
    /// manipulator type, or pose from pulses; the turntable's angle with the pulses per degree of
    /// its motor.
    ///
    /// # Errors
    /// With the position's line: if no posture reaches a pose with its manipulator type, or pulses
    /// cannot be turned into joints.
    pub fn program(
        &self,
        robot: &Robot,
        tool: &Tool,
        world_from_base: &Isometry3<f64>,
        station_pulses_per_deg: Option<f64>,
    ) -> Result<Program, ProgramError> {
        let mut program = Program {
            name: self.name.clone(),
            comment: self.comment.clone(),
            tool: Tool {
                number: self.tool,
                ..tool.clone()
            },
            world_from_base: *world_from_base,
            moves: Vec::with_capacity(self.moves.len()),
            spindle: Vec::new(),
            notes: self.notes.clone(),
        };
        let mut resolver = None;
        let mut columns = Vec::with_capacity(self.moves.len());
        for step in &self.moves {
            let position = &self.positions[&step.position];
            let at = |kind| ProgramError::in_file(&self.path, position.line, kind);
            let (base_from_tool, postures) = match &position.value {
                JbiPositionValue::Pulses(pulses) => {
                    let posture = joints(robot, step.position, pulses).map_err(at)?;
                    let flange = robot.world_from_frame(&posture, FrameId::Flange);
                    let world_from_tool = flange * tool.flange_from_tool;
                    (
                        world_from_base.inverse() * world_from_tool,
                        vec![(0.0, posture)],
                    )
                }
                JbiPositionValue::Rectangular {
                    xyz_mm,
                    rxyz_deg,
                    rconf,
                } => {
                    let resolver = match &mut resolver {
                        Some(resolver) => resolver,
                        none => none.insert(Resolver::new(robot).map_err(at)?),
                    };
                    let pose = pose(xyz_mm, rxyz_deg);
                    let flange = program.world_from_flange(&pose);
                    let found = resolver.postures(step.path_point, &flange, rconf);
                    (pose, found.map_err(at)?)
                }
            };
            let turntable_rad = self.turntable(step, station_pulses_per_deg)?;
            program.moves.push(Move {
                path_point: step.path_point,
                base_from_tool,
                motion: step.motion,
                zone: match step.level {
                    Some(0) => Zone::Stop,
                    _ => Zone::Unstated,
                },
                turntable_rad,
                posture: Vec::new(),
            });
            columns.push(postures);
        }
        for (step, posture) in program.moves.iter_mut().zip(rated_chain(&columns)) {
            step.posture = posture;
        }
        Ok(program)
    }

    /// Angle of the turntable at a move, if it has one.
    fn turntable(
        &self,
        step: &JbiMove,
        pulses_per_deg: Option<f64>,
    ) -> Result<Option<f64>, ProgramError> {
        let Some(number) = step.station else {
            return Ok(None);
        };
        let (pulses, line) = self.stations[&number];
        let per_deg = pulses_per_deg.ok_or_else(|| {
            ProgramError::in_file(&self.path, line, ProgramErrorKind::NoStationPulses)
        })?;
        Ok(Some((pulses / per_deg).to_radians()))
    }
}

fn pose(xyz_mm: &[f64; 3], rxyz_deg: &[f64; 3]) -> Isometry3<f64> {
    let [rx, ry, rz] = rxyz_deg.map(f64::to_radians);
    Isometry3::from_parts(
        Translation3::from(Vector3::from(*xyz_mm) * 1e-3),
        UnitQuaternion::from_euler_angles(rx, ry, rz),
    )
}

fn joints(robot: &Robot, number: u32, pulses: &[f64]) -> Result<Vec<f64>, ProgramErrorKind> {
    if pulses.len() != robot.dof() {
        return Err(ProgramErrorKind::JointCount {
            what: format!("C{number:05}"),
            found: pulses.len(),
            wanted: robot.dof(),
        });
    }
    let joints = robot.chain.joints.iter().zip(pulses);
    joints
        .map(|(joint, count)| Ok(count / pulses_per_unit(joint)?))
        .collect()
}
