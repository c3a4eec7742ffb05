"""The same polishing pass in truecut and in MuJoCo, contact and edges written a second time.

The wheel begins over a corner, follows the edge, rounds the next corner and goes inside, while its axis precesses and its eccentricity
turns. Bounds: normal force, force along edges and deflection of the tool 1 % of their range.
"""

from __future__ import annotations

from conftest import ROOT, tomllib
from led_pass import LedPass
from truecut_reference.polish import PolishRun, Tool

SCENARIO = ROOT / "scenarios" / "finishing" / "mould_free.toml"
CHANGES = {
    "process.polish.face.length_mm": 30,
    "process.polish.face.width_mm": 20,
    "process.polish.path.line_spacing_mm": 10,
    "run.duration_s": 2.0,
}
STEP_S = 400e-6
BOUND = 0.01


def test_crosscheck_mujoco_polishing_pass_over_edges(truecut):
    """Normal force, edge force and deflection within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    for key, value in CHANGES.items():
        *path, last = key.split(".")
        inner = table
        for name in path:
            inner = inner.setdefault(name, {})
        inner[last] = value
    forces = {"normal force": "polish.normal_force", "edge force": "polish.edge_force"}
    tool = Tool.of(table["process"]["polish"])
    one = LedPass(SCENARIO, CHANGES, table, lambda plant, command: PolishRun(tool, plant, command), forces, STEP_S)
    one.check(truecut, "polishing", BOUND)
