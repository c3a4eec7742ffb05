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

    def pushed_at_rest(self) -> np.ndarray | float:
        """Of the force that will be let go."""
        if self.release is None:
            return 0.0
        mujoco.mj_forward(self.model, self.data)
        return self.at_tool(self.release)

    def pushed(self, t: float) -> np.ndarray | float:
        """Of the force at this time."""
        return 0.0 if self.force is None else self.at_tool(self.force(t))

    def handed_on(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Over a step that is the command's mean."""
        edges = np.append(t, t[-1] + self.h)
        way = self.command.antiderivative()(edges)
        return np.diff(way, axis=0) / self.h, np.diff(self.command(edges), axis=0) / self.h

    def before(self, t: float, rate: list[float]) -> None:
        """For laws outside the library."""
        for law in self.strange:
            law.now = t, rate[law.foreign.other]

    def settle(self) -> None:
        """As for an arm that nobody pushes; the force is let go in the end."""
        super().settle()
        own = slice(self.first, self.first + self.n)
        at_rest, still = self.data.qpos[own].copy(), [0.0] * self.n
        self.data.qfrc_applied[:] = 0.0
        self.data.qfrc_applied[own] = self.extra(self.command(0.0), still, at_rest, still, False)
        mujoco.mj_forward(self.model, self.data)

    def run(self, every: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Times and channels at every step that is a multiple of `every`."""
        times, channels = super().run(every)
        for values in channels.values():
            if not (np.isfinite(values).all() and np.abs(values).max() < LARGE):
                raise RuntimeError("the run diverged")
        return times, channels
