"""An arm on its springs in MuJoCo, led by commands or pushed at its tool, with effects and laws outside the library."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
from bench.arm import Arm
from truecut_reference.scenario import Robot

from .laws import Foreign, ForeignLaw

# a command that stands still has no spline of its own
STILL_SAMPLES = 5
# of an angle, a torque or a place: nothing that is drawn comes near
LARGE = 1e6


class Moving(Arm):
    """One run. `force` gives the force on the tool (N, world) at a time; `release` is one that goes at the start."""

    def __init__(self, robot: Robot, effects: list, time_s, command, step_s: float, force=None, release=None) -> None:
        known = [e for e in effects if not isinstance(e, Foreign)]
        super().__init__(robot, known, time_s, command, step_s)
        self.force, self.release = force, release
        self.jacobian = np.zeros((3, self.model.nv))
        laws = []
        for i, law in enumerate(self.laws):
            whole = ForeignLaw(**{f.name: getattr(law, f.name) for f in dataclasses.fields(law)})
            whole.foreign = next((e for e in effects if isinstance(e, Foreign) and e.target == i + 1), None)
            laws.append(whole)
        self.laws = laws
        self.strange = [law for law in laws if law.foreign is not None]

    def at_tool(self, force) -> np.ndarray:
        """Torques of a force at the tool on all of MuJoCo's joints."""
        mujoco.mj_jacSite(self.model, self.data, self.jacobian, None, self.data.site("tool").id)
        return self.jacobian.T @ force

    def settle(self) -> None:
        """Rest under gravity and the force that will be let go."""
        m, d, own = self.model, self.data, slice(self.first, self.first + self.n)
        theta, still = self.command(0.0), [0.0] * self.n
        d.qpos[own] = theta
        for _ in range(500):
            q = d.qpos[own]
            mujoco.mj_forward(m, d)
            d.qfrc_applied[:] = 0.0 if self.release is None else self.at_tool(self.release)
            d.qfrc_applied[own] += self.extra(theta, still, q, still, False)
            mujoco.mj_forward(m, d)
            change = (d.qfrc_passive + d.qfrc_applied - d.qfrc_bias) / self.all_stiffness
            d.qpos[:] += 0.7 * change
            if np.max(np.abs(change)) < 1e-13:
                break
        else:
            raise RuntimeError("static equilibrium not found")
        d.qfrc_applied[:] = 0.0
        d.qfrc_applied[own] = self.extra(theta, still, d.qpos[own], still, False)
        mujoco.mj_forward(m, d)
        for i, law in enumerate(self.laws):
            law.start(law.windup(theta[i], 0.0, d.qpos[self.first + i], 0.0)[0])

    def run(self, every: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Times and channels at every step that is a multiple of `every`."""
        self.settle()
        m, d, h = self.model, self.data, self.h
        count = round(self.duration_s / h)
        t = h * np.arange(count + 2)
        way = self.command.antiderivative()(t)
        at, at_rate = self.command(t).tolist(), self.command_rate(t).tolist()
        # what a spring hands on over a step is the command's mean
        mean, mean_rate = (np.diff(way, axis=0) / h).tolist(), (np.diff(self.command(t), axis=0) / h).tolist()
        own = slice(self.first, self.first + self.n)
        tool = d.site("tool")
        rubbing = [i for i, law in enumerate(self.laws) if law.rubs]
        rows = []
        for k in range(count + 1):
            q, v, a = d.qpos[own].tolist(), d.qvel[own].tolist(), d.qacc[own].tolist()
            torque = [
                law.transmission(*law.windup(at[k][i], at_rate[k][i], q[i], v[i])) for i, law in enumerate(self.laws)
            ]
            if k % every == 0:
                rows.append((*q, *torque, *tool.xpos))
            middle = [x + 0.5 * h * y + 0.125 * h * h * z for x, y, z in zip(q, v, a)]
            rate = [y + 0.5 * h * z for y, z in zip(v, a)]
            for law in self.strange:
                law.now = t[k] + 0.5 * h, rate[law.foreign.other]
            applied = np.array(self.extra(mean[k], mean_rate[k], middle, rate, True))
            if rubbing:
                applied += self.friction(k * h, applied, q, v, torque, rubbing)
            d.qfrc_applied[own] = applied
            if self.force is not None:
                pushed = self.at_tool(self.force(t[k] + 0.5 * h))
                d.qfrc_applied[:] = pushed
                d.qfrc_applied[own] += applied
            mujoco.mj_step(m, d)
        found = np.array(rows)
        if not (np.isfinite(found).all() and np.abs(found).max() < LARGE):
            raise RuntimeError("the run diverged")
        return t[: count + 1 : every], self._channels(found)
