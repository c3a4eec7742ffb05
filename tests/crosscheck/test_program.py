"""`truecut crosscheck` as a user meets it: what it refuses, what it leaves out, and its exit codes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from conftest import ROBOTS, ROOT

BAD_INPUT, DIVERGED, DISAGREES = 2, 3, 4
SWEEP = ROOT / "scenarios" / "chamfer" / "threshold.toml"
SCENARIO = """
name = "rig"
[robot]
urdf = "{urdf}"
{robot}
[run]
duration_s = 0.1
[process.load]
release_n = [10.0, 0.0, 0.0]
"""
FOOT = """
[process.load.foot]
pressure_mpa = 0.3
bore_mm = 32
cylinders = 2
seal_stiction_n = 97
[process.load.foot.friction]
law = "equivalent_viscous"
mu = 0.15
amplitude_floor_um = 1.0
"""


def rig(folder: Path, rest: str = "", robot: str = "") -> Path:
    """A short run of the planar rig."""
    path = folder / "rig.toml"
    text = SCENARIO.format(urdf=ROBOTS / "rig_planar" / "robot.urdf", robot=robot)
    path.write_text(text + rest, encoding="utf-8")
    return path


def crosscheck(truecut, out: Path, *scenarios: Path, python: str = sys.executable):
    """A call of the program."""
    return truecut.run("crosscheck", *scenarios, "--out", out, TRUECUT_PYTHON=python)


def test_a_sweep_is_left_out_and_named(truecut, tmp_path):
    """A whole folder can be given: what is a single run in it is compared."""
    done = crosscheck(truecut, tmp_path, SWEEP, rig(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "threshold.toml: left out" in done.stdout
    assert not (tmp_path / "threshold").exists()
    assert (tmp_path / "rig" / "crosscheck.json").exists()


def test_nothing_but_sweeps_is_refused(truecut, tmp_path):
    """Nothing compared must not look like agreement."""
    done = crosscheck(truecut, tmp_path, SWEEP)
    assert done.returncode == BAD_INPUT
    assert "sweep" in done.stderr


@pytest.mark.parametrize(("code", "expected"), [(0, 0), (DISAGREES, DISAGREES), (1, BAD_INPUT), (BAD_INPUT, BAD_INPUT)])
def test_exit_code_follows_the_comparison(truecut, tmp_path, code, expected):
    """An interpreter that only ends stands in for the comparison."""
    python = tmp_path / "python"
    python.write_text(f"#!/bin/sh\nexit {code}\n", encoding="utf-8")
    python.chmod(0o755)
    assert crosscheck(truecut, tmp_path, rig(tmp_path), python=str(python)).returncode == expected


def test_a_missing_interpreter_is_named(truecut, tmp_path):
    """What `TRUECUT_PYTHON` names must be there."""
    done = crosscheck(truecut, tmp_path, rig(tmp_path), python=str(tmp_path / "nowhere"))
    assert done.returncode == BAD_INPUT
    assert "nowhere" in done.stderr


def test_a_law_without_counterpart_is_named(truecut, tmp_path):
    """The paper's viscous law is a fiction that the reference does not repeat: no verdict, rather than a wrong one."""
    done = crosscheck(truecut, tmp_path, rig(tmp_path, FOOT))
    assert done.returncode == BAD_INPUT
    assert "equivalent_viscous" in done.stderr


def test_a_run_that_diverges_is_not_compared(truecut, tmp_path):
    """Half a recording is no disagreement of engines: exit 3 tells the two apart."""
    done = crosscheck(truecut, tmp_path, rig(tmp_path, "constant_n = [0.0, 1e9, 0.0]"))
    assert done.returncode == DIVERGED, done.stdout + done.stderr
    assert not (tmp_path / "rig" / "crosscheck.json").exists()
