"""One pass of a tool that is led along a path, in truecut and in MuJoCo at two steps: forces and deflection of the tool side by side."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.interpolate

from conftest import FIGURES
from truecut_reference import compare
from truecut_reference.led_run import LedRun
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot
from truecut_reference.wheel import Command, CommandedPath


def nrmse(found: np.ndarray, expected: np.ndarray) -> float:
    """Root mean square distance over the range of the expected; of vectors over the diagonal of their box."""
    found, expected = found.reshape(len(found), -1), expected.reshape(len(expected), -1)
    return float(math.sqrt(np.mean(np.sum((found - expected) ** 2, axis=1))) / np.linalg.norm(np.ptp(expected, axis=0)))


@dataclass(frozen=True)
class LedPass:
    """A scenario with changes, its table with these made, and the tool's run in MuJoCo."""

    scenario: Path
    changes: dict
    table: dict
    run_of: Callable[[Plant, Command], LedRun]
    # by name, the recording's channel; in the order in which the run tells them
    forces: dict[str, str]
    step_s: float

    def check(self, truecut, title: str, bound: float) -> dict[str, np.ndarray]:
        """Deflection and forces within the bound of their range; the reference moves by less than a third of that at half its step.
        Returns the reference's."""
        recording = compare.Recording.read(truecut.record(self.scenario, self.changes))
        command, robot = recording.command(), _robot(self.table["robot"], self.scenario.parent)
        model = truecut.mjcf(self.scenario, self.changes)
        until_s = float(recording.time_s[-1])

        def plant() -> Plant:
            first = Plant(model, robot)
            return Plant(model, robot, first.rigid_posture(command.joints[0]))

        runs = [self.run_of(plant(), command).run(h, until_s) for h in (self.step_s, 0.5 * self.step_s)]
        rows = (recording.time_s > self.step_s) & (recording.time_s < until_s - self.step_s)
        time_s = recording.time_s[rows]
        rigid = CommandedPath(plant(), command).displacement_m(time_s)
        axes, origin = plant().axes, plant().tool_position0

        def at_rows(run) -> dict[str, np.ndarray]:
            times, places, middles, told = run
            moved = scipy.interpolate.CubicSpline(times, places)(time_s)
            told = scipy.interpolate.CubicSpline(middles, told)(time_s)
            forces = {name: told[:, k] for k, name in enumerate(self.forces)}
            return {"deflection": (moved - origin) @ axes.T - rigid, **forces}

        coarse, fine = map(at_rows, runs)
        place = np.array([recording.channels[f"tool.position_{a}"][rows] for a in "xyz"]).T
        found = {name: recording.channels[channel][rows] for name, channel in self.forces.items()}
        found["deflection"] = (place - origin) @ axes.T - rigid
        for name, expected in fine.items():
            apart, halving = nrmse(found[name], expected), nrmse(coarse[name], expected)
            FIGURES.append(f"{f'{title}, {name}':40} {apart:8.4%} halving {halving:8.4%}")
            assert halving < bound / 3.0, (name, halving)
            assert apart < bound, (name, apart)
        return fine
