"""The same polishing pass in truecut and in MuJoCo, contact and edges written a second time.

The wheel begins over a corner, follows the edge, rounds the next corner and goes inside, while its axis precesses and its eccentricity
turns. Bounds: normal force, force along edges and deflection of the tool 1 % of their range.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.interpolate

from conftest import FIGURES, ROOT, tomllib
from truecut_reference import compare
from truecut_reference.plant import Plant
from truecut_reference.polish import PolishRun, Tool
from truecut_reference.scenario import _robot
from truecut_reference.wheel import CommandedPath

SCENARIO = ROOT / "scenarios" / "finishing" / "mould_free.toml"
CHANGES = {
    "process.polish.face.length_mm": 30,
    "process.polish.face.width_mm": 20,
    "process.polish.path.line_spacing_mm": 10,
    "run.duration_s": 2.0,
}
STEP_S = 400e-6
BOUND = 0.01


def nrmse(found: np.ndarray, expected: np.ndarray) -> float:
    """Root mean square distance over the range of the expected; of vectors over the diagonal of their box."""
    found, expected = found.reshape(len(found), -1), expected.reshape(len(expected), -1)
    return float(math.sqrt(np.mean(np.sum((found - expected) ** 2, axis=1))) / np.linalg.norm(np.ptp(expected, axis=0)))


def test_crosscheck_mujoco_polishing_pass_over_edges(truecut):
    """Normal force, edge force and deflection within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    for key, value in CHANGES.items():
        *path, last = key.split(".")
        inner = table
        for name in path:
            inner = inner.setdefault(name, {})
        inner[last] = value
    recording = compare.Recording.read(truecut.record(SCENARIO, CHANGES))
    command, robot = recording.command(), _robot(table["robot"], SCENARIO.parent)
    model = truecut.mjcf(SCENARIO, CHANGES)
    until_s = float(recording.time_s[-1])

    def plant() -> Plant:
        first = Plant(model, robot)
        return Plant(model, robot, first.rigid_posture(command.joints[0]))

    runs = [PolishRun(Tool.of(table["process"]["polish"]), plant(), command).run(h, until_s) for h in (STEP_S, 0.5 * STEP_S)]
    rows = (recording.time_s > STEP_S) & (recording.time_s < until_s - STEP_S)
    time_s = recording.time_s[rows]
    rigid = CommandedPath(plant(), command).displacement_m(time_s)

    def at_rows(run) -> dict[str, np.ndarray]:
        times, places, middles, forces = run
        axes = plant().axes
        moved = scipy.interpolate.CubicSpline(times, places)(time_s) @ axes.T - plant().tool_position0 @ axes.T
        force = scipy.interpolate.CubicSpline(middles, forces)(time_s)
        return {"deflection": moved - rigid, "normal force": force[:, 0], "edge force": force[:, 1]}

    coarse, fine = map(at_rows, runs)
    axes, origin = plant().axes, plant().tool_position0
    place = np.array([recording.channels[f"tool.position_{a}"][rows] for a in "xyz"]).T
    found = {
        "deflection": (place - origin) @ axes.T - rigid,
        "normal force": recording.channels["polish.normal_force"][rows],
        "edge force": recording.channels["polish.edge_force"][rows],
    }
    for name, expected in fine.items():
        apart, halving = nrmse(found[name], expected), nrmse(coarse[name], expected)
        FIGURES.append(f"polishing, {name:29} {apart:8.4%} halving {halving:8.4%}")
        assert halving < BOUND / 3.0, (name, halving)
        assert apart < BOUND, (name, apart)
