//! One step: loads, contacts, plant, guard, memory of the process.

use super::Cell;
use crate::channels;
use crate::guard::{Balance, Watch};
use crate::loads::{Attachment, Loads, MAX_LOADS, Wrench, stacked};
use crate::plant::{Command, WorldWrench, combined};
use crate::process::{FrameMotion, ToolState};
use nalgebra::Vector3;
use truecut_recording::Outcome;

impl Cell {
    /// The `step`-th step, at `time_s`, up to the moment when it could be recorded: the state then,
    /// or how it ended the run.
    pub(super) fn step(&mut self, step: usize, time_s: f64) -> Result<ToolState, Outcome> {
        let n = self.plant.dof();
        let mut position = [0.0; truecut_arm::MAX_JOINTS];
        let mut velocity = [0.0; truecut_arm::MAX_JOINTS];
        self.command
            .at(time_s, &mut position[..n], &mut velocity[..n]);
        let mut force = [0.0; truecut_arm::MAX_JOINTS];
        self.command.force_at(time_s, &mut force[..n]);
        let command = Command {
            position: &position[..n],
            velocity: &velocity[..n],
            force: &force[..n],
        };
        let mut state = self.tool_state(time_s);
        let loads = self.process.evaluate(&state);
        let wrenches = self.to_world(&loads);
        self.plant.begin(command, &wrenches);
        self.contacts
            .solve(self.plant.as_mut(), &loads.contacts, &self.axes);
        self.plant
            .finish(&self.contacts.wrenches, &self.contacts.joint_torques);
        if self.asked.is_none() {
            self.torque_use.watch(time_s, self.plant.as_ref());
            self.spring_use.watch(time_s, self.plant.joints());
        }
        // The arm stands where it stood; only its velocity is known better.
        state.tool.velocity_m_per_s = self.velocity(Attachment::Tool);
        state.foot.velocity_m_per_s = self.velocity(Attachment::Foot);
        state.tool_turning_rad_s = self.rate(Attachment::Tool, 3);
        if let Some(diverged) = self.watch(step, time_s, &wrenches) {
            return Err(diverged);
        }
        let dt_s = self.plant.time_step_s();
        self.process
            .commit(&state, &loads, &self.contacts.outcomes, dt_s);
        self.process.ended().map_or(Ok(state), Err)
    }

    fn to_world(&self, loads: &Loads) -> arrayvec::ArrayVec<WorldWrench, MAX_LOADS> {
        let to_world = |w: &Wrench| {
            let (force_n, moment_n_m) = (self.axes * w.force_n, self.axes * w.moment_n_m);
            (w.frame, stacked(&force_n, &moment_n_m))
        };
        loads.wrenches.iter().map(to_world).collect()
    }

    fn motion(&self, attachment: Attachment, start_m: &Vector3<f64>) -> FrameMotion {
        let frame = self.plant.frame(attachment);
        FrameMotion {
            displacement_m: self
                .axes
                .tr_mul(&(frame.world_from_frame.translation.vector - start_m)),
            velocity_m_per_s: self.velocity(attachment),
        }
    }

    /// Velocity of a frame, process axes.
    fn velocity(&self, attachment: Attachment) -> Vector3<f64> {
        self.axes.tr_mul(&self.rate(attachment, 0))
    }

    /// Velocity (`row` 0) or angular velocity (`row` 3) of a frame, world axes.
    fn rate(&self, attachment: Attachment, row: usize) -> Vector3<f64> {
        let jacobian = &self.plant.frame(attachment).jacobian;
        combined(jacobian, row, &self.plant.joints().velocity)
    }

    fn tool_state(&self, time_s: f64) -> ToolState {
        ToolState {
            world_from_tool: self.plant.frame(Attachment::Tool).world_from_frame,
            tool_turning_rad_s: self.rate(Attachment::Tool, 3),
            time_s,
            tool: self.motion(Attachment::Tool, &self.tool_start_m),
            foot: self.motion(Attachment::Foot, &self.foot_start_m),
        }
    }

    /// Whether the run has diverged. Where rows alone are asked for, energy is balanced at the
    /// interval of the rows that the scenario has, and not at all where the arm is stepped exactly.
    fn watch(&mut self, step: usize, time_s: f64, wrenches: &[WorldWrench]) -> Option<Outcome> {
        let every = |steps: usize| step.is_multiple_of(steps);
        let looked_at = self.asked.is_none_or(|asked| {
            every(self.steps_per_balance) || asked.energy && every(self.steps_per_row)
        });
        if looked_at {
            self.energy_j = self.plant.energy_j();
        }
        // An arm about one posture is stepped exactly, without energy of its own; of thousands of
        // such runs in a search the balance would take a tenth.
        let balanced = self.asked.is_none() || !self.plant.is_linear();
        let balance = balanced.then(|| Balance {
            dt_s: self.plant.time_step_s(),
            energy_j: looked_at.then_some(self.energy_j.0 + self.energy_j.1),
            power_w: self.power_w(wrenches),
        });
        let joints = self.plant.joints();
        self.guard.check(&Watch {
            time_s,
            positions: &joints.position,
            velocities: &joints.velocity,
            balance,
        })
    }

    /// Power of drives and loads less what is dissipated, W.
    fn power_w(&self, wrenches: &[WorldWrench]) -> f64 {
        let mut power_w = self.plant.drive_power_w() - self.plant.dissipation_w();
        let joints = self.plant.joints();
        for (attachment, wrench) in wrenches.iter().chain(&self.contacts.wrenches) {
            let jacobian = &self.plant.frame(*attachment).jacobian;
            let columns = jacobian.column_iter().zip(&joints.velocity);
            power_w += columns
                .map(|(column, v)| column.dot(wrench) * v)
                .sum::<f64>();
        }
        for (torque, v) in self.contacts.joint_torques.iter().zip(&joints.velocity) {
            power_w += torque * v;
        }
        power_w
    }

    /// The row of the instant that was stepped last.
    pub(super) fn record(&mut self, state: &ToolState, row: &mut Vec<f64>) {
        row.clear();
        let position = self.plant.frame(Attachment::Tool).world_from_frame;
        channels::record(
            row,
            state,
            &position.translation.vector,
            self.plant.joints(),
            self.base_joints,
            self.energy_j,
        );
        if let Some(deflection) = &mut self.deflection {
            let is_asked = self.asked.is_none_or(|asked| asked.deflection);
            let now = is_asked.then(|| deflection.now(self.plant.joints()));
            row.extend(now.unwrap_or([f64::NAN; 3]));
        }
        self.process.record(row);
        debug_assert_eq!(
            row.len(),
            self.channels.len(),
            "a process records one value for each of its channels"
        );
        for (column, sensor) in &mut self.sensors {
            row[*column] = sensor.measure(state.time_s, row[*column]);
        }
    }
}
