//! How near bodies came to each other in a run.

use std::sync::Arc;

use truecut_arm::Robot;
use truecut_plan::clearance::{Cell, Own, Station};
use truecut_recording::{Recording, Scalar, Unit};
use truecut_scenario::{CellFile, Scenario};

use crate::channels::position_name;
use crate::error::SimError;
use crate::robots::Robots;

/// What stands about the arm of a scenario.
pub(super) struct About {
    robot: Arc<Robot>,
    cell: Cell,
}

impl About {
    /// Reads the cell that a scenario names, if it names one; tool and part are those of its
    /// process, where it has them.
    pub fn of(
        scenario: &Scenario,
        robots: Option<&Robots>,
        run: &crate::cell::Cell,
    ) -> Result<Option<Self>, SimError> {
        let Some(path) = &scenario.cell else {
            return Ok(None);
        };
        if scenario.robot.urdf.as_os_str().is_empty() {
            let message = "has no effect: the scenario has no arm that could meet anything";
            return Err(scenario.problem("cell", message).into());
        }
        let own = Robots::new();
        let robot = robots.unwrap_or(&own).robot(&scenario.robot)?;
        let file = CellFile::load(path, &robot.frames.flange_from_tool)?;
        let part = run.part()?;
        if !part.is_empty() && file.setup.part.is_some() {
            let process = scenario.process.name();
            let message = format!("`part` has no effect: process.{process} has its own part");
            return Err(file.problem("part", message).into());
        }
        let own = Own {
            part: (part.iter().map(|(mesh, place)| (mesh.as_ref(), *place))).collect(),
            tools: run.tools(),
        };
        let cell = Cell::new(&robot, &file.setup, &own);
        let cell = cell.map_err(|error| file.refused(&error))?;
        Ok(Some(Self { robot, cell }))
    }

    /// What was left out of clearances.
    pub fn notes(&self) -> impl Iterator<Item = &String> {
        self.cell.notes().iter()
    }

    /// The channels that tell where the arm is.
    pub fn channels(&self) -> impl Iterator<Item = String> {
        let joints = self.robot.chain.joints.iter().enumerate();
        joints.map(|(index, joint)| position_name(index + 1, joint.kind))
    }

    /// The least clearance over the rows of a recording, between which joints go evenly. What cuts
    /// may touch the part at all times: rows do not say where it is fed.
    pub fn clearance(&self, recording: &Recording) -> Scalar {
        let columns = self.channels().filter_map(|name| {
            let channels = &recording.header.channels;
            let at = channels.iter().position(|channel| channel.name == name)?;
            recording.columns.get(at)
        });
        let columns: Vec<&Vec<f64>> = columns.collect();
        let rows = recording.time_s.len();
        let station = |row: usize| Station {
            path_point: row,
            posture: columns.iter().map(|column| column[row]).collect(),
            is_fed: true,
        };
        let finite = |station: &Station| station.posture.iter().all(|q| q.is_finite());
        let stations: Vec<Station> = match columns.len() == self.robot.dof() {
            true => (0..rows).map(station).filter(finite).collect(),
            false => Vec::new(),
        };
        let found = match stations.is_empty() {
            true => None,
            false => self.cell.along(&self.robot, &stations).least,
        };
        let Some(least) = found else {
            let what = "Least distance of two bodies of the cell: there were none that could meet";
            return Scalar::new("cell.clearance", Unit::Metre, f64::NAN, what);
        };
        let [moving, other] = &least.pair;
        let time_s = recording.time_s[least.at.path_point];
        let what = format!(
            "Least distance of two bodies of the cell: \"{moving}\" from \"{other}\" at {time_s:.3} s"
        );
        Scalar::new("cell.clearance", Unit::Metre, least.least_m, what)
    }
}
