"""`truecut fit`: arms drawn from seeds, their drive forces by MuJoCo with friction and rotors written here; and, where
`TRUECUT_DATA` names the folder with them, measured arms beside a least squares that shares nothing with the program."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from truecut_reference.drawn_arm import CUTOFF_HZ, RATE_HZ, Arm
from truecut_reference.whole_arm import Motion, Problem, coupled, inertial, low_pass, of_joints

SEEDS = range(41_000, 41_006)


def fitted(truecut, scenario: Path, *arguments: object) -> dict:
    out = scenario.parent if os.access(scenario.parent, os.W_OK) else truecut.work
    truecut.call("fit", scenario, "--out", out, *arguments)
    return json.loads((out / scenario.stem / "fit.json").read_text(encoding="utf-8"))


def true_sum(name: str, truth: dict[str, float]) -> float:
    """Of what a base parameter names: members with factors."""
    terms = re.findall(r"(?:^|([+-]) )(-?[\d.e-]* ?)((?:link|rotor|viscous|coulomb|offset) \d+(?: mass| [mI] [xyz]+)?)", name)
    assert terms, name
    total = 0.0
    for sign, factor, member in terms:
        size = {"": 1.0, "-": -1.0}.get(factor.strip(), None)
        total += (-1 if sign == "-" else 1) * (float(factor) if size is None else size) * truth[member]
    return total


def test_crosscheck_mujoco_fit_of_whole_arms(truecut, tmp_path):
    """Every joint has large friction at once. Intervals of 95 % hold, and the error on blocks left out is the noise."""
    inside, told = 0, 0
    for seed in SEEDS:
        arm = Arm(seed)
        folder = tmp_path / str(seed)
        folder.mkdir()
        report = fitted(truecut, arm.write(folder))
        for one in report["parameters"]:
            if not one["seen"]:
                assert one["interval"] is None
                continue
            low, high = one["interval"]
            truth = true_sum(one["name"], arm.truth)
            told += 1
            inside += low - 1e-3 * abs(truth) <= truth <= high + 1e-3 * abs(truth)
            if one["name"].split()[0] in ("viscous", "coulomb"):
                assert abs(one["value"] / truth - 1) < 0.15, (seed, one, truth)
        noise = low_pass(arm.noise, CUTOFF_HZ, RATE_HZ).std(0)
        for joint, (one, level) in enumerate(zip(report["channels"], noise, strict=True)):
            assert 0.8 < one["held_out"] / level < 1.35, (seed, joint, one, level)
    print(f"{inside} of {told} true values inside their 95 % interval")
    assert inside / told > 0.9, f"{inside} of {told}"


@pytest.mark.parametrize("seed", [41_101, 41_104, 41_122])
def test_crosscheck_mujoco_diagnosis_names_the_friction_of_every_joint(truecut, tmp_path, seed):
    """All at once, on arms whose links are known: one after another they hide each other."""
    arm = Arm(seed, rotors=0.0)
    assert arm.joints >= 3
    scenario = arm.write(tmp_path)
    truecut.call("diagnose", scenario, "--out", tmp_path)
    diagnosis = json.loads((tmp_path / scenario.stem / "diagnosis.json").read_text(encoding="utf-8"))
    found = {(one["kind"], one["target"]): one["parameters"] for one in diagnosis["causes"]}
    print(diagnosis["verdict"], diagnosis["reason"], sorted(found), diagnosis["work"])
    assert diagnosis["verdict"] == "named"
    assert not any(kind.endswith("_delay") for kind, _ in found)
    for joint in range(1, arm.joints + 1):
        for kind in ("viscous", "coulomb"):
            one = found[f"joint_{kind}", f"joint{joint}"]
            (parameter,) = one.values()
            assert abs(parameter["value"] / arm.truth[f"{kind} {joint}"] - 1) < 0.2, (joint, kind, parameter)


def measured_arm(folder: str, joints: int, rate_hz: float) -> tuple[Path, np.ndarray, np.ndarray]:
    """Folder, coordinates and torques at even times; skips where there is none."""
    if "TRUECUT_DATA" not in os.environ:
        pytest.skip("TRUECUT_DATA names no folder")
    place = Path(os.environ["TRUECUT_DATA"]) / folder
    file = next(place.glob("*.csv"))
    table = np.genfromtxt(file, delimiter=",", names=True)
    even = np.arange(table["t"][0], table["t"][-1], 1 / rate_hz)
    column = lambda name: np.interp(even, table["t"], table[name])  # noqa: E731
    pick = lambda what: np.column_stack([column(f"{what}{j + 1}") for j in range(joints)])  # noqa: E731
    return file, pick("q"), pick("tau")


def scenario_of(file: Path, joints: int, work: Path, head: str, fit: str) -> Path:
    channels = "".join(
        f'[[data.channel]]\ncolumn = "q{j}"\nchannel = "joint{j}.angle"\nunit = "rad"\nrole = "input"\n'
        f'[[data.channel]]\ncolumn = "tau{j}"\nchannel = "joint{j}.drive_torque"\nunit = "N m"\n'
        for j in range(1, joints + 1)
    )
    urdf, data = (file.parent / "robot.urdf").resolve(), file.resolve()
    text = f'name = "measured"\n[robot]\nurdf = "{urdf}"\n[process.replay]\nmode = "inverse"\n{head}'
    scenario = work / f"{file.parent.name}.toml"
    scenario.write_text(text.replace("FILE", str(data)) + channels + fit, encoding="utf-8")
    return scenario


PUBLISHED_TX40 = {
    "viscous": [8.05, 5.53, 1.97, 1.11, 1.86, 0.65],
    "coulomb": [7.14, 8.26, 6.34, 2.48, 3.03],
}


def test_validate_tx40_all_frictions_at_once(truecut, tmp_path):
    """Six joints, each with large friction, the last two coupled (`figaroh`)."""
    file, q, torque = measured_arm("tx40", 6, 5000.0)
    motion, step = Motion.of(q, 5000.0, 50.0), 10
    thin = motion.every(step)
    model = pinocchio.buildModelFromUrdf(str(file.parent / "robot.urdf"))
    frictions = [of_joints(list(x.T)) for x in (thin.a, thin.v, np.sign(thin.v), np.ones_like(thin.v))]
    columns = np.concatenate([inertial(model, thin), *frictions, coupled(thin, (4, 5))], axis=2)
    problem = Problem.of(columns, low_pass(torque, 200.0, 5000.0)[::step], thin, 10.0, 0.02)
    reference = problem.rms(problem.held_out(10))
    head = 'differentiate_cutoff_hz = 50\ncompare_cutoff_hz = 10\n[data]\nfile = "FILE"\ntime = "t"\nresample_hz = 500\n'
    fit = '[fit]\nunknowns = ["links", "rotors", "viscous", "coulomb", "offset"]\n[[fit.coupled_motor]]\njoints = [5, 6]\n'
    report = fitted(truecut, scenario_of(file, 6, tmp_path, head, fit))
    ratio = np.array([one["held_out"] for one in report["channels"]]) / reference
    print("held out over that of the reference:", ratio.round(3))
    assert ratio.max() <= 1.05
    found = {one["name"]: one["value"] for one in report["parameters"]}
    for name, published in PUBLISHED_TX40.items():
        off = [found[f"{name} {j}"] / value - 1 for j, value in enumerate(published, 1)]
        print(name, "over published, %:", np.round(100 * np.array(off), 1))
        assert np.abs(off).max() <= (0.05 if name == "viscous" else 0.08)
    assert any("coulomb 6" in one["name"] and "motor" in one["name"] for one in report["combinations"])
    assert min(one["standing_within_friction"] for one in report["channels"]) > 0.9


# The published friction of the Panda: a sigmoid of the velocity (`gaz2019`).
SIGMOID = np.array(
    [
        [0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489],
        [5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336],
        [0.039533, 0.025882, -0.04607, 0.036194, 0.026226, -0.021047, 0.0035526],
    ]
)


def test_validate_panda_base_parameters_beat_the_published_model(truecut, tmp_path):
    """Seven joints; ten parameters of each link. Error on blocks left out over that of the published model."""
    file, q, torque = measured_arm("panda", 7, 1000.0)
    motion, step = Motion.of(q, 1000.0, 10.0), 4
    thin = motion.every(step)
    model = pinocchio.buildModelFromUrdf(str(file.parent / "robot.urdf"))
    links = inertial(model, thin)[:, :7]
    standard = np.concatenate([one.toDynamicParameters() for one in list(model.inertias)[1:8]])
    size, slope, shift = SIGMOID
    friction = size / (1 + np.exp(-slope * (thin.v + shift))) - size / (1 + np.exp(-slope * shift))
    published = (links[:, :, : len(standard)] @ standard + friction)[:, :, None]
    problem = Problem.of(published, low_pass(torque, 100.0, 1000.0)[::step], thin, 5.0, -1.0)
    left = problem.torque - problem.columns[:, :, 0]
    head = 'differentiate_cutoff_hz = 10\ncompare_cutoff_hz = 5\n[data]\nfile = "FILE"\ntime = "t"\nresample_hz = 250\n'
    fit = '[fit]\nunknowns = ["links", "viscous", "coulomb", "offset"]\nstandstill_rad_per_s = 0\n'
    report = fitted(truecut, scenario_of(file, 7, tmp_path, head, fit))
    ratio = np.array([one["held_out"] for one in report["channels"]]) / problem.rms(left)
    # Blocks drawn with replacement, the same for both models.
    own = np.array([one["held_out_by_block"] for one in report["channels"]]) ** 2
    block = np.arange(len(left)) * own.shape[1] // len(left)
    other = np.array([(left[block == one] ** 2).mean(0) for one in range(own.shape[1])]).T
    draws = np.random.default_rng(5).integers(0, own.shape[1], (2000, own.shape[1]))
    ratios = np.sqrt(own[:, draws].mean(2) / other[:, draws].mean(2))
    low, high = np.quantile(ratios, [0.025, 0.975], axis=1)
    print("held out over the published model's error:", ratio.round(2), low.round(2), high.round(2))
    assert ratio.max() <= 1.0
