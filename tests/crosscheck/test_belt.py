"""The same belt on a plane in truecut and in MuJoCo, the contact written a second time.

The wheel is set down at the feed and runs along a line, pressed by the path alone or by a carrier that holds the force. Bounds: normal
force, friction and deflection of the tool 1 % of their range.
"""

from __future__ import annotations

import pytest
from conftest import ROOT, tomllib
from led_pass import LedPass
from truecut_reference.belt import BeltRun, Tool

SCENARIO = ROOT / "tests" / "crosscheck" / "belt_plane.toml"
HELD = {"law": "constant_force", "force_n": 12, "damping_n_s_per_mm": 1, "fastest_mm_per_s": 50, "stroke_mm": 1}
STEP_S = 400e-6
BOUND = 0.01


@pytest.mark.parametrize("control", [None, HELD], ids=["path", "held"])
def test_crosscheck_mujoco_belt_along_a_plane(truecut, control):
    """Forces and deflection within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    job = tomllib.loads((SCENARIO.parent / table["process"]["belt"]["job"]).read_text(encoding="utf-8"))
    changes = {}
    if control is not None:
        table["process"]["belt"]["control"] = control
        changes = {f"process.belt.control.{key}": value for key, value in control.items()}
    tool = Tool.of(table["process"]["belt"], job)
    forces = {"normal force": "belt.normal_force", "friction": "belt.friction_run"}
    one = LedPass(SCENARIO, changes, table, lambda plant, command: BeltRun(tool, plant, command), forces, STEP_S)
    title = "belt, force held" if control else "belt, by the path"
    reference = one.check(truecut, title, BOUND)
    assert reference["normal force"].max() > 10.0
