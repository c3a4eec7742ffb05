"""Identification of an arm that MuJoCo measures: loads and deflections, hammer blows, linearised truth."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest

import identification_example as example
from conftest import FIGURES, ROOT
from truecut_reference.identification import MeasuredArm

FILE = ROOT / "scenarios" / "identification" / "arm.toml"


@pytest.fixture(scope="module")
def arm(truecut) -> MeasuredArm:
    """The arm of the example, as it truly is."""
    return MeasuredArm(truecut.mjcf(example.SCENARIO), example.STIFFNESS_FACTOR, example.DAMPING_FACTOR)


@pytest.fixture(scope="module")
def nominal(truecut) -> np.ndarray:
    """Stiffnesses of the robot's file."""
    return mujoco.MjModel.from_xml_string(truecut.mjcf(example.SCENARIO)).jnt_stiffness.copy()


def identified(truecut, file, folder) -> dict:
    """Both reports."""
    truecut.call("identify", file, "--out", folder)
    out = folder / file.stem
    return {name: json.loads((out / f"{name}.json").read_text()) for name in ("stiffness", "modes")}


@pytest.fixture(scope="module")
def shipped(truecut, tmp_path_factory) -> dict:
    """Reports of the shipped example."""
    return identified(truecut, FILE, tmp_path_factory.mktemp("identify"))


def test_crosscheck_mujoco_stiffness_of_the_shipped_example(shipped, nominal):
    """Every joint that a load turns: truth within 1.5 times its interval; the last joint is said not to be loaded."""
    joints = shipped["stiffness"]["joints"]
    assert joints[5]["status"] == "not_loaded"
    for joint, truth in zip(joints[:5], (nominal * example.STIFFNESS_FACTOR)[:5]):
        compliance, error = joint["compliance"]
        assert abs(compliance - 1 / truth) < 3 * error, joint
        assert abs(joint["value"] / truth - 1) < 0.05
        FIGURES.append(f"identified stiffness of {joint['name']}: {100 * (joint['value'] / truth - 1):+.2f} %")


def test_crosscheck_mujoco_stiffness_without_noise(truecut, arm, nominal, tmp_path):
    """MuJoCo's rests, unrounded: the stiffness comes back to the digits of the file."""
    rows = arm.load_table(np.radians(example.POSTURES_DEG), np.array(example.FORCES_N), 0.0, seed=0)
    names = [f"q{k}_deg" for k in range(1, 7)] + [f"force_{a}_n" for a in "xyz"] + [f"d{a}_mm" for a in "xyz"]
    text = "\n".join([",".join(names), *(",".join(map(repr, row.tolist())) for row in rows)])
    (tmp_path / "loads.csv").write_text(text + "\n")
    described = FILE.read_text(encoding="utf-8").split("[modes]")[0]
    file = tmp_path / "exact.toml"
    file.write_text(described.replace("../../assets", str(ROOT / "assets")))
    truecut.call("identify", file, "--out", tmp_path)
    joints = json.loads((tmp_path / "exact" / "stiffness.json").read_text())["joints"]
    worst = max(abs(j["value"] / k - 1) for j, k in zip(joints[:5], nominal * example.STIFFNESS_FACTOR))
    FIGURES.append(f"identified stiffness without noise: {worst:.1e}")
    assert worst < 1e-6


def truth(arm: MeasuredArm) -> list[tuple[float, float]]:
    """Frequencies and damping ratios of MuJoCo's own linearisation, from the eigenvalues of its state matrix."""
    command = np.radians(example.HAMMERED_DEG)
    _, q = arm.rest(command, np.zeros(3))
    size = q.size
    stiffness = np.empty((size, size))
    for k in range(size):
        step = np.zeros(size)
        step[k] = 1e-6
        ahead, behind = arm._out_of_balance(q + step, np.zeros(3)), arm._out_of_balance(q - step, np.zeros(3))
        stiffness[:, k] = -(ahead - behind) / 2e-6
    arm._out_of_balance(q, np.zeros(3))
    mass = np.zeros((size, size))
    if hasattr(arm.data, "qM"):
        mujoco.mj_fullM(arm.model, mass, arm.data.qM)
    else:
        mujoco.mj_fullM(arm.model, arm.data, mass)
    inverse = np.linalg.inv(mass)
    damping = np.diag(arm.model.dof_damping)
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ damping]])
    poles = [s for s in np.linalg.eigvals(state) if s.imag > 0]
    return sorted((abs(s) / (2 * np.pi), -s.real / abs(s)) for s in poles)


def test_crosscheck_mujoco_modes_of_the_shipped_example(shipped, arm):
    """Modes from blows beside the eigenvalues of MuJoCo's linearisation: frequency 0.3 %, damping 3 %."""
    expected = [one for one in truth(arm) if one[0] < 60]
    found = shipped["modes"]["measured"]
    assert len(found) == len(expected)
    for mode, (hz, zeta) in zip(found, expected):
        f, z = mode["frequency_hz"]["value"], mode["damping_ratio"]["value"]
        FIGURES.append(f"identified mode at {hz:.2f} Hz: {100 * (f / hz - 1):+.3f} %, damping {100 * (z / zeta - 1):+.2f} %")
        assert abs(f / hz - 1) < 0.003, (mode, hz)
        assert abs(z / zeta - 1) < 0.03, (mode, zeta)


def test_crosscheck_mujoco_identified_stiffness_explains_the_modes(shipped):
    """The loads were measured at rest, the blows in motion: the model with the identified stiffness rings as measured."""
    for mode in shipped["modes"]["measured"]:
        measured, of_file = mode["frequency_hz"]["value"], shipped["modes"]["model"][mode["partner"]]["frequency_hz"]
        updated = mode["identified_stiffness_hz"]
        assert abs(updated / measured - 1) < 0.01
        assert abs(updated - measured) < 0.3 * abs(of_file - measured)
