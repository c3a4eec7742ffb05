"""What the arm's build does to its motion: bases that give, and links that are not as long as their file says. Drawn
arms that follow commands, in MuJoCo."""

from __future__ import annotations

import os
import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from drawn import case as drawn_case  # noqa: E402
from drawn.case import draw_case  # noqa: E402
from drawn.experiment import Forward  # noqa: E402
from drawn.judge import ask  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

PROGRAM = shlex.split(os.environ.get("TRUECUT_BIN", run.PROGRAM))


def causes(answer) -> list[tuple[str, str | None, dict]]:
    print(answer.verdict, answer.diagnosis["reason"])
    return [(one["kind"], one["target"], one["parameters"]) for one in answer.diagnosis["causes"]]


@pytest.mark.parametrize("seed", some(range(9_781_000, 9_781_004), 1))
def test_crosscheck_mujoco_a_base_that_gives_is_found_where_the_arm_rings(seed, tmp_path):
    """The base is without damping: a fit finds its compliance only from where the arm's frequency is nearly right."""
    case = draw_case(seed, "forward", "strong", tmp_path, "base_compliance")
    (hidden,) = case.truth
    assert case.levels[0] > 3.0, "the data do not show it"
    ((kind, target, parameters),) = causes(ask(PROGRAM, case, 2))
    (found,) = parameters.values()
    assert (kind, target) == ("base_compliance", hidden.target)
    # The step of the data's solver moves its frequency by up to a thousandth.
    assert found["value"] == pytest.approx(hidden.values["compliance_rad_per_n_m"], rel=0.05)


class Placed(Forward):
    """Of which all places of the tool are measured; no arm of one or two joints."""

    def __init__(self, draw: np.random.Generator, folder: Path, *others: object) -> None:
        super().__init__(draw, folder, *others)
        if self.count < 3:
            raise drawn_case.Unfit("an arm of few joints")
        torques = [one for one in self.outputs if "transmission" in one[0]]
        self.outputs = torques + [(f"tool.position_{axis}", "m") for axis in "xyz"]


@pytest.mark.parametrize("seed", some(range(9_782_000, 9_782_004), 1))
def test_crosscheck_mujoco_places_of_the_tool_show_a_link_of_another_length(seed, tmp_path, monkeypatch):
    """The file has the next joint, or the flange, elsewhere than the machine."""
    monkeypatch.setitem(drawn_case.MODES, "forward", Placed)
    case = draw_case(seed, "forward", "clean", tmp_path)
    draw = np.random.default_rng([seed, 7])
    joint = int(draw.integers(1, case.experiment.count))
    shift = draw.normal(size=3)
    shift *= draw.uniform(0.01, 0.04) / np.linalg.norm(shift)
    urdf = tmp_path / "robot.urdf"

    def moved(found: re.Match) -> str:
        place = np.array([float(x) for x in found[2].split()]) - shift
        return f'{found[1]}"{" ".join(repr(float(x)) for x in place)}"'

    text = urdf.read_text(encoding="utf-8")
    changed = re.sub(rf'(<joint name="joint_{joint + 1}"[^>]*><origin xyz=)"([^"]+)"', moved, text)
    assert changed != text
    urdf.write_text(changed, encoding="utf-8")
    found = causes(ask(PROGRAM, case, 2))
    print(joint, shift, found)
    ((kind, target, parameters),) = found
    assert (kind, target) == ("link_length", f"joint{joint}")
    for value, true in zip(parameters.values(), shift, strict=True):
        assert abs(value["value"] - true) < 0.75 * (value["high"] - value["low"]) + 1e-4
