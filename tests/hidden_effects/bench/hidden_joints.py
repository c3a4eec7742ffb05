"""The plant of a machining run with effects in its joints.

Factors on stiffness and damping are the model's own springs and dampers. All else is evaluated at mid-step and held
over the step; dry friction is an impulse, bounded by its level, that brings a joint to rest within the step where it can.
"""

from __future__ import annotations

import copy

import mujoco
import numpy as np
from truecut_reference.plant import Plant
from truecut_reference.scenario import Robot
from truecut_reference.wheel import Command

from .effects import Effect
from .joint_law import JointLaw, stopping


class HiddenJoints(Plant):
    """An arm led by `command` (or standing at its start) whose joints hide something."""

    def __init__(
        self,
        model: mujoco.MjModel,
        robot: Robot,
        q0: np.ndarray | None = None,
        *,
        effects: list[Effect],
        command: Command | None,
    ) -> None:
        stiffness, damping = (x.reshape(model.nv, -1)[:, 0].copy() for x in (model.jnt_stiffness, model.dof_damping))
        on_joint = [[effect for effect in effects if effect.target == i + 1] for i in range(model.nv)]
        self.laws = [JointLaw.of(float(k), float(d), one) for k, d, one in zip(stiffness, damping, on_joint)]
        model = copy.copy(model)  # a run may make more than one plant of a model: the factors act once
        for i, law in enumerate(self.laws):
            model.jnt_stiffness.reshape(model.nv, -1)[i, 0] = law.stiffness
            model.dof_damping.reshape(model.nv, -1)[i, 0] = law.damping
        super().__init__(model, robot, q0)
        self._spline = None if command is None else command.spline()
        self._rate = None if command is None else self._spline.derivative()
        self._t = 0.0
        self._moves = False
        self._rubbed = np.zeros(self.nv)
        self._rubbing = [i for i, law in enumerate(self.laws) if law.rubs]
        for law, theta, q in zip(self.laws, self._led(0.0)[0], self.q0):
            law.start(law.windup(theta, 0.0, q, 0.0)[0])

    def _led(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        if self._spline is None:
            return self.command0, np.zeros(self.nv)
        return self._spline(t), self._rate(t)

    def _beyond(self, led, q, rate, moves_memory: bool) -> np.ndarray:
        """What the joints exert beyond the model's springs and dampers."""
        theta, theta_rate = led
        found = np.zeros(self.nv)
        for i, law in enumerate(self.laws):
            w, w_rate = law.windup(theta[i], theta_rate[i], q[i], rate[i])
            torque = law.transmission(w, w_rate) if moves_memory else law.static(w, w_rate)
            linear = law.stiffness * (theta[i] - q[i]) + law.damping * (theta_rate[i] - rate[i])
            found[i] = torque - linear + law.link(q[i], rate[i])
        return found

    def apply(self, force_tool, force_foot, torque_joints=None, moment_tool=None) -> None:
        """As for any plant; at rest with what the joints exert there."""
        super().apply(force_tool, force_foot, torque_joints, moment_tool)
        if not self._moves:
            still = np.zeros(self.nv)
            self.data.qfrc_applied += self._beyond((self._led(0.0)[0], still), self.data.qpos, still, False)

    def settle(self, force_tool, force_foot, moment_tool=None) -> None:
        """Static equilibrium, nothing wound up by friction or hysteresis."""
        super().settle(force_tool, force_foot, moment_tool)
        for law, theta, q in zip(self.laws, self._led(0.0)[0], self.data.qpos):
            law.start(law.windup(theta, 0.0, q, 0.0)[0])
        self._moves = True

    def step(self, h: float) -> None:
        """Advances by h seconds with the forces last applied and what the joints exert at mid-step."""
        d = self.data
        middle = d.qpos + 0.5 * h * d.qvel + 0.125 * h * h * d.qacc
        rate = d.qvel + 0.5 * h * d.qacc
        d.qfrc_applied += self._beyond(self._led(self._t + 0.5 * h), middle, rate, True)
        if self._rubbing:
            self._rubbed = self._friction(h)
            d.qfrc_applied += self._rubbed
        super().step(h)
        self._t += h

    def _friction(self, h: float) -> np.ndarray:
        """Torque of dry friction over the step; the acceleration at hand holds that of the last one."""
        d = self.data
        theta, theta_rate = self._led(self._t)
        mobility = np.linalg.inv(self.mass_matrix())
        bounds = {}
        for i in self._rubbing:
            law = self.laws[i]
            load = law.static(*law.windup(theta[i], theta_rate[i], d.qpos[i], d.qvel[i]))
            bounds[i] = law.friction_bounds(self._t, d.qpos[i], d.qvel[i], load)
        return stopping(d.qvel + h * (d.qacc - mobility @ self._rubbed), mobility, bounds, h)
