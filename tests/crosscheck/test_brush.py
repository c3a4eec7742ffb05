"""The same taught program over an edge in truecut and in MuJoCo, bristles and block written a second time.

The brush comes down beside the block, runs onto its edge and along it. Bounds: force of the bristles and deflection of the tool 1 % of
their range.
"""

from __future__ import annotations

import numpy as np
import scipy.interpolate

from conftest import FIGURES, ROOT, tomllib
from test_polish import nrmse
from truecut_reference import compare
from truecut_reference.brush import BrushRun, Tool
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot
from truecut_reference.wheel import CommandedPath

SCENARIO = ROOT / "scenarios" / "finishing" / "block_edge_brush.toml"
CHANGES = {"process.brush.feed_mm_per_s": 80, "run.duration_s": 1.8, "run.record_interval_ms": 1}
BLOCK_M = (0.1, 0.06, 0.02)
STEP_S = 1e-3
BOUND = 0.01


def test_crosscheck_mujoco_brush_along_an_edge(truecut):
    """Force of the bristles and deflection within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    recording = compare.Recording.read(truecut.record(SCENARIO, CHANGES))
    command, robot = recording.command(), _robot(table["robot"], SCENARIO.parent)
    model = truecut.mjcf(SCENARIO, CHANGES)
    until_s = float(recording.time_s[-1])

    def plant() -> Plant:
        first = Plant(model, robot)
        return Plant(model, robot, first.rigid_posture(command.joints[0]))

    tool = Tool.of(table["process"]["brush"], BLOCK_M)
    runs = [BrushRun(tool, plant(), command).run(h, until_s) for h in (STEP_S, 0.5 * STEP_S)]
    rows = (recording.time_s > STEP_S) & (recording.time_s < until_s - STEP_S)
    time_s = recording.time_s[rows]
    rigid = CommandedPath(plant(), command).displacement_m(time_s)
    axes, origin = plant().axes, plant().tool_position0

    def at_rows(run) -> dict[str, np.ndarray]:
        times, places, middles, forces = run
        moved = scipy.interpolate.CubicSpline(times, places)(time_s)
        force = scipy.interpolate.CubicSpline(middles, forces)(time_s)
        return {"deflection": (moved - origin) @ axes.T - rigid, "force of the bristles": force[:, 0]}

    coarse, fine = map(at_rows, runs)
    place = np.array([recording.channels[f"tool.position_{a}"][rows] for a in "xyz"]).T
    found = {"deflection": (place - origin) @ axes.T - rigid, "force of the bristles": recording.channels["brush.bristle_force"][rows]}
    assert fine["force of the bristles"].max() > 1.5
    for name, expected in fine.items():
        apart, halving = nrmse(found[name], expected), nrmse(coarse[name], expected)
        FIGURES.append(f"brushing, {name:30} {apart:8.4%} halving {halving:8.4%}")
        assert halving < BOUND / 3.0, (name, halving)
        assert apart < BOUND, (name, apart)
