"""The same taught program over an edge in truecut and in MuJoCo, bristles and block written a second time.

The brush comes down beside the block, runs onto its edge and along it. Bounds: force of the bristles and deflection of the tool 1 % of
their range.
"""

from __future__ import annotations

from conftest import ROOT, tomllib
from led_pass import LedPass
from truecut_reference.brush import BrushRun, Tool

SCENARIO = ROOT / "scenarios" / "finishing" / "block_edge_brush.toml"
CHANGES = {"process.brush.feed_mm_per_s": 80, "run.duration_s": 1.8, "run.record_interval_ms": 1}
BLOCK_M = (0.1, 0.06, 0.02)
STEP_S = 1e-3
BOUND = 0.01


def test_crosscheck_mujoco_brush_along_an_edge(truecut):
    """Force of the bristles and deflection within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    tool = Tool.of(table["process"]["brush"], BLOCK_M)
    forces = {"force of the bristles": "brush.bristle_force"}
    one = LedPass(SCENARIO, CHANGES, table, lambda plant, command: BrushRun(tool, plant, command), forces, STEP_S)
    reference = one.check(truecut, "brushing", BOUND)
    assert reference["force of the bristles"].max() > 1.5
