"""The arm in MuJoCo under the loads of a tool that is led along a recorded command.

The command is an input, taken from the recording: what a controller asks of the joints is no law of physics.
"""

from __future__ import annotations

import mujoco
import numpy as np

from .plant import Plant
from .wheel import Command


class LedRun:
    """From rest at the start, loads taken in the middle of each step. `wrench` is the tool's."""

    def __init__(self, plant: Plant, command: Command) -> None:
        self.plant = plant
        self._command = command.spline()
        self._rate = self._command.derivative()
        self._scratch = mujoco.MjData(plant.model)
        self._along, self._about = np.zeros((3, plant.nv)), np.zeros((3, plant.nv))

    def tool_at(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Place of the tool point and its axes (columns), velocity and turning, world, at a state."""
        m, d = self.plant.model, self._scratch
        d.qpos[:] = q
        mujoco.mj_kinematics(m, d)
        mujoco.mj_comPos(m, d)
        site = self.plant.site["tool"]
        mujoco.mj_jacSite(m, d, self._along, self._about, site)
        return d.site_xpos[site].copy(), d.site_xmat[site].reshape(3, 3).copy(), self._along @ v, self._about @ v

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force and moment on the tool about its point, world axes, at a state, and what is told of them."""
        raise NotImplementedError

    def advance(self, h: float) -> None:
        """Moves what the tool itself carries along, by the loads of the step."""

    def settle(self) -> None:
        """Rest at the start, the tool spinning."""
        p = self.plant
        for _ in range(12):
            force, moment, _ = self.wrench(0.0, p.data.qpos.copy(), np.zeros(p.nv))
            p.settle(p.axes @ force, np.zeros(3), p.axes @ moment)

    def run(self, h: float, until_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Times and tool points (world) of states; times of mid-steps and what is told there."""
        p = self.plant
        d = p.data
        self.settle()
        places, forces = [], []
        count = round(until_s / h)
        for i in range(count):
            t = i * h
            places.append(d.site_xpos[p.site["tool"]].copy())
            middle = d.qpos + 0.5 * h * d.qvel + 0.125 * h * h * d.qacc
            force, moment, told = self.wrench(t + 0.5 * h, middle, d.qvel + 0.5 * h * d.qacc)
            forces.append(told)
            self.advance(h)
            command, rate = self._command(t + 0.5 * h), self._rate(t + 0.5 * h)
            torque = p.stiffness * (command - p.command0) + p.damping * rate
            p.apply(p.axes @ force, np.zeros(3), torque, p.axes @ moment)
            p.step(h)
        times = h * np.arange(count)
        return times, np.array(places), times + 0.5 * h, np.array(forces)
