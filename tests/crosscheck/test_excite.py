"""`truecut excite`: what a planned motion tells and what it asks of an arm, with drive forces by MuJoCo.

`TRUECUT_EXCITE_REPEATS=50` measures the spread of estimates as often, on three arms."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from truecut_reference.excited_arm import SHARE, Machine, drawn_urdf, motion_of

ROBOTS = Path(__file__).resolve().parents[2] / "assets" / "robots"
REPEATS = int(os.environ.get("TRUECUT_EXCITE_REPEATS", "0"))
LINKS = '["links", "rotors", "viscous", "coulomb"]'


def limits_of(machine_urdf: str) -> np.ndarray:
    """Range, speed, acceleration, effort of the joints of a URDF; infinite where it has 0."""
    import xml.etree.ElementTree as ElementTree

    joints = [one for one in ElementTree.fromstring(machine_urdf).iter("joint") if one.get("type") == "revolute"]
    rows = [[float(one.find("limit").get(key)) for key in ("lower", "upper", "velocity", "effort")] for one in joints]
    lower, upper, speed, effort = np.array(rows).T
    effort[effort == 0] = np.inf
    return np.column_stack([lower, upper, speed, np.full(len(rows), np.inf), effort])


def drawn(folder: Path, seed: int, joints: int, **keys: float) -> tuple[Machine, str]:
    urdf = drawn_urdf(seed, joints)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    machine = Machine(urdf, limits_of(urdf), np.zeros(joints), seed, **keys)
    return machine, '[robot]\nurdf = "robot.urdf"\n'


def shipped(name: str, rotors: list[float], efforts: list[float] | None = None) -> tuple[Machine, str]:
    file = ROBOTS / name / "robot.urdf"
    limits = limits_of(file.read_text(encoding="utf-8"))
    if efforts:
        limits[:, 4] = efforts
    machine = Machine(file.read_text(encoding="utf-8"), limits, np.array(rotors), 7)
    return machine, f'[robot]\nurdf = "{file}"\n'


def planned(truecut, scenario: Path, *arguments: str) -> tuple[dict, Path]:
    truecut.call("excite", scenario, "--out", scenario.parent, *arguments)
    out = scenario.parent / scenario.stem
    return json.loads((out / "excitation.json").read_text(encoding="utf-8")), out


def geometric(ratios: np.ndarray) -> float:
    return float(np.exp(np.log(ratios).mean()))


@pytest.mark.parametrize("seed", [53_001, 53_002, 53_003, 53_004])
def test_crosscheck_mujoco_limits_are_kept_at_every_sample(truecut, tmp_path, seed):
    """Of arms drawn from seeds: range, speed and acceleration from the file's coordinates, drive forces by MuJoCo."""
    draw = np.random.default_rng(seed)
    joints = int(draw.integers(2, 8))
    machine, head = drawn(tmp_path, seed, joints, duration_s=8)
    # One joint may turn less, and be sped up less, than its drive would allow.
    bounded = int(draw.integers(joints))
    limits = machine.limits
    limits[bounded, 1], limits[bounded, 3] = limits[bounded, 1] / 2, draw.uniform(0.5, 2)
    text = (
        f"evaluations = 300\n[[excite.joint]]\njoint = {bounded + 1}\nupper_deg = {np.degrees(limits[bounded, 1])}\n"
        f"acceleration_deg_per_s2 = {np.degrees(limits[bounded, 3])}\n"
    )
    report, out = planned(truecut, machine.write(tmp_path, head, LINKS, text))
    q, v, a = motion_of(out / "motion.csv", joints, 8)
    middle, half = limits[:, :2].mean(1), np.diff(limits[:, :2]).ravel() / 2
    used = np.array(
        [
            (np.abs(q - middle) / half).max(0),
            (np.abs(v) / limits[:, 2]).max(0),
            (np.abs(a) / limits[:, 3]).max(0),
            # What is known of friction when the motion is planned: nothing.
            (np.abs(machine.rigid(q, v, a)) / limits[:, 4]).max(0),
        ]
    )
    print(joints, "joints, most used:", used.max(0).round(3))
    assert used.max() <= SHARE * (1 + 1e-5)
    assert (used.max(0) > 0.3 * SHARE).all(), "some joint hardly moves"
    for end in (0, -1):
        assert np.abs(v[end]).max() < 1e-4
        assert np.abs(a[end]).max() < 1e-3
    assert report["mean_ratio"] < 0.9


def test_crosscheck_mujoco_estimates_spread_half_as_much(truecut, tmp_path):
    """A random seven-axis arm: noise moves the estimates of `truecut fit` by what is told, and by half of what it moves them
    by in random motions of the same duration within the same limits."""
    machine, head = drawn(tmp_path, 53_010, 7)
    scenario = machine.write(tmp_path, head, LINKS, "evaluations = 6000\n")
    report, out = planned(truecut, scenario)
    draw = np.random.default_rng(1)
    told = np.array([one["planned"] for one in report["parameters"]])
    own = rms(machine.deviations(truecut, scenario, motion_of(out / "motion.csv", 7, 10), 6, draw))
    random = [machine.deviations(truecut, scenario, machine.random_motion(draw), 1, draw) for _ in range(5)]
    told_ratio, ratio = geometric(own / told), geometric(own / rms(np.vstack(random)))
    print(f"{len(told)} parameters: spread {told_ratio:.2f} of what is told, {ratio:.2f} of that in random motions")
    assert 0.8 < told_ratio < 1.25
    assert ratio <= 0.5


def rms(rows: np.ndarray) -> np.ndarray:
    return np.sqrt((rows**2).mean(0))


ARMS = {
    "ur10e": lambda folder: shipped("ur10e", [9.2, 9.2, 6.8, 0.42, 0.42, 0.42]),
    "irb6600": lambda folder: shipped(
        "irb6600_175_255", [200, 200, 200, 25, 20, 15], [15e3, 15e3, 12e3, 3e3, 3e3, 1.5e3]
    ),
    "seven axes": lambda folder: drawn(folder, 53_011, 7),
}


@pytest.mark.skipif(not REPEATS, reason="TRUECUT_EXCITE_REPEATS says how often")
@pytest.mark.parametrize("name", ARMS)
def test_crosscheck_mujoco_spread_on_three_arms(truecut, tmp_path, name):
    machine, head = ARMS[name](tmp_path)
    scenario = machine.write(tmp_path, head, LINKS)
    report, out = planned(truecut, scenario)
    draw = np.random.default_rng(2)
    told = np.array([one["planned"] for one in report["parameters"]])
    own = rms(machine.deviations(truecut, scenario, motion_of(out / "motion.csv", machine.joints, 10), REPEATS, draw))
    random = [machine.deviations(truecut, scenario, machine.random_motion(draw), 1, draw) for _ in range(REPEATS)]
    random = np.array(random)[:, 0]
    ratios, typical = own / rms(random), own / (np.median(np.abs(random), axis=0) / 0.6745)
    print(
        f"{name}: {len(told)} parameters, told {report['mean_ratio']:.3f}; spread {geometric(own / told):.3f} of what is told; of "
        f"random motions {geometric(ratios):.3f} (rms), {geometric(typical):.3f} (median); half or less for "
        f"{(ratios <= 0.5).mean():.0%} of the parameters, worst {ratios.max():.2f}"
    )
    assert geometric(ratios) <= 0.5
