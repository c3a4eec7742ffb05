"""The same polishing pass in truecut and in MuJoCo, contact and edges written a second time.

The wheel begins over a corner, follows the edge, rounds the next corner and goes inside, while its axis precesses and its eccentricity
turns. Bounds: normal force, force along edges and deflection of the tool 1 % of their range.
"""

from __future__ import annotations

import math

import pytest
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


def test_crosscheck_claims_of_the_mould_lie_about_the_wheel_at_rest():
    """Force of the wheel at the path's indentation, and the bounds on what Preston's law makes of it on this arm: none of it from a run."""
    for name in ("mould_free.toml", "mould_constrained.toml"):
        table = tomllib.loads((SCENARIO.parent / name).read_text(encoding="utf-8"))
        polish = table["process"]["polish"]
        tool = Tool.of(polish)
        depth = polish["control"]["indentation_mm"] * 1e-3
        force = tool.shell.at(depth / tool.radius)[0] * tool.modulus * tool.radius**2
        assert force == pytest.approx(5.67, abs=0.01)
        lever = (tool.radius - depth) * math.sin(math.radians(polish["tilt_deg"]))
        section = polish["path"]["feed_mm_per_s"] * polish["path"]["line_spacing_mm"] * 1e-6
        removed = polish["preston_per_pa"] * 5.5 * tool.spin * lever / section * 1e6
        claim = next(claim for claim in table["claim"] if claim.get("scalar") == "polish.depth_middle")
        assert claim["min"] < removed < claim["max"] < 1.1 * removed
