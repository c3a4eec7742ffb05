"""What measured motion does to a diagnosis: few samples in a period, coarse encoders, links and rotors that are not
those of the file, a clock that runs fast, limits that a file gives too narrow, a wrist that bends by a few thousandths
of what it moves by. Drawn arms, their forces and motion by MuJoCo."""

from __future__ import annotations

import json
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from truecut_reference.drawn_arm import RATE_HZ, Arm
from truecut_reference.sampled import some

# Of the deviation of each drive force.
NOISE = 0.01
SEEDS = some(range(47_000, 47_004), 2)


class Quiet(Arm):
    """Without friction, offsets and rotors; white noise of a hundredth of each force."""

    def __init__(self, seed: int, **hidden: float) -> None:
        super().__init__(seed, rotors=0.0)
        for name in self.truth:
            if name.split()[0] in ("viscous", "coulomb", "offset"):
                self.truth[name] = hidden.get(name.replace(" ", "_"), 0.0)
        self.noise = np.zeros_like(self.q)
        self.sizes = NOISE * super().drive_forces().std(0)
        self.noise = self.sizes * np.random.default_rng([seed, 3]).normal(size=self.q.shape)


def diagnosed(truecut, folder: Path, arm: Quiet, *, resample_hz: float, cutoffs_hz: tuple[float, float]) -> dict:
    scenario = arm.write(folder)
    text = scenario.read_text(encoding="utf-8").partition("[fit]")[0]
    text = text.replace("differentiate_cutoff_hz = 40\ncompare_cutoff_hz = 10.0\n", "")
    text = text.replace(
        'mode = "inverse"\n',
        f'mode = "inverse"\ndifferentiate_cutoff_hz = {cutoffs_hz[0]}\ncompare_cutoff_hz = {cutoffs_hz[1]}\n',
    ).replace('time = "t"\n', f'time = "t"\nresample_hz = {resample_hz}\n')
    for joint, (slides, size) in enumerate(zip(arm.slides, arm.sizes, strict=True), 1):
        kind, unit = ("force", "N") if slides else ("torque", "N m")
        line = f'channel = "joint{joint}.drive_{kind}"\nunit = "{unit}"\n'
        assert line in text
        text = text.replace(line, f"{line}noise = {size}\n")
    scenario.write_text(text, encoding="utf-8")
    truecut.call("diagnose", scenario, "--out", folder)
    return json.loads((folder / scenario.stem / "diagnosis.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_mujoco_few_samples_make_no_gains(truecut, tmp_path, seed):
    """Motion of up to 0.6 Hz, thinned to 40 Hz: central differences make accelerations 0.3 % small there."""
    arm = Quiet(seed)
    assert RATE_HZ == 200
    found = diagnosed(truecut, tmp_path, arm, resample_hz=40, cutoffs_hz=(12, 6))
    print(found["verdict"], found["reason"], [(one["kind"], one["target"]) for one in found["causes"]])
    assert found["verdict"] == "nothing_beyond_noise"


class Brisk(Quiet):
    """The same courses in less than half the time: up to 1.7 Hz."""

    SPEED = 1.7 / 0.625

    def moved(self, time: np.ndarray) -> list[np.ndarray]:
        return [self.SPEED**order * moved for order, moved in enumerate(super().moved(self.SPEED * time))]


@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_mujoco_a_fast_motion_makes_no_clock(truecut, tmp_path, seed):
    """Up to 1.7 Hz at 125 Hz: central differences make accelerations 0.24 % small there, as a slower clock does."""
    for hidden in ({}, {"viscous_1": 20.0}):
        folder = tmp_path / str(len(hidden))
        folder.mkdir()
        found = diagnosed(truecut, folder, Brisk(seed, **hidden), resample_hz=125, cutoffs_hz=(12, 6))
        causes = [(one["kind"], one["target"]) for one in found["causes"]]
        print(found["verdict"], found["reason"], causes)
        assert causes == [("joint_viscous", "joint1")] * len(hidden)


@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_mujoco_coarse_encoders_make_no_unknown_cause(truecut, tmp_path, seed):
    """Places in steps of 2 pi / 2^13, or 0.1 mm. Friction is found in them as well."""
    bits = np.where(Arm(seed).slides, 1e-4, 2 * np.pi / 2**13)
    for hidden in ({}, {"coulomb_2": 12.0}):
        arm = Quiet(seed, **hidden)
        exact = arm.drive_forces()
        arm.q = bits * np.round(arm.q / bits)
        arm.drive_forces = lambda forces=exact: forces
        folder = tmp_path / str(len(hidden))
        folder.mkdir()
        found = diagnosed(truecut, folder, arm, resample_hz=100, cutoffs_hz=(20, 6))
        causes = {(one["kind"], one["target"]): one["parameters"] for one in found["causes"]}
        print(found["verdict"], found["reason"], causes)
        if hidden:
            # At reversals, which happen between samples, much is left of a friction so far above the noise.
            assert list(causes) == [("joint_coulomb", "joint2")]
            (size,) = causes["joint_coulomb", "joint2"].values()
            assert abs(size["value"] - 12.0) < max(0.3, 0.75 * (size["high"] - size["low"]))
        else:
            assert found["verdict"] == "nothing_beyond_noise"


def test_crosscheck_mujoco_motion_a_little_beyond_the_limits_is_taken_as_measured(truecut, tmp_path):
    """The file's limits may be narrower than the machine's: that is told, and nothing follows from it."""
    arm = Quiet(47_010)
    low, high = arm.q[:, 0].min(), arm.q[:, 0].max()
    limits = f'lower="{low + 0.02}" upper="{high + 0.5}"'
    # The machine has no stop there, as MuJoCo would.
    forces = arm.drive_forces()
    arm.drive_forces = lambda: forces
    arm.urdf = arm.urdf.replace('lower="-6" upper="6"', limits, 1)
    found = diagnosed(truecut, tmp_path, arm, resample_hz=100, cutoffs_hz=(20, 6))
    assert found["verdict"] == "nothing_beyond_noise"
    told = " ".join(truecut.call("diagnose", tmp_path / "drawn.toml", "--out", tmp_path).split())
    assert "beyond the limits of joint `joint_1` in its file" in told and "taken as measured" in told


def only_cause(found: dict) -> tuple[str, str | None, dict]:
    print(found["verdict"], found["reason"], [(one["kind"], one["target"]) for one in found["causes"]])
    assert found["verdict"] == "named" and not found["changes"]
    (one,) = found["causes"]
    (value,) = one["parameters"].values()
    return one["kind"], one["target"], value


@pytest.mark.parametrize("seed", some(range(47_100, 47_105), 3))
def test_crosscheck_mujoco_a_link_of_another_mass_is_named(truecut, tmp_path, seed):
    """The file has a link whose mass and inertia are not the machine's; nothing is uncertain."""
    arm = Quiet(seed)
    draw = np.random.default_rng([seed, 5])
    # The first link's own moment may be next to nothing beside what it carries.
    joint, factor = int(draw.integers(2, arm.joints + 1)), float(draw.choice([0.8, 0.88, 1.12, 1.25]))
    forces, text = arm.drive_forces(), arm.urdf

    def scaled(link: re.Match) -> str:
        return re.sub(r'(mass value|i[xyz]{2})="([^"]+)"', lambda m: f'{m[1]}="{float(m[2]) / factor}"', link[0])

    arm.urdf = re.sub(rf'<link name="link_{joint}">.*?</link>', scaled, text)
    assert arm.urdf != text
    arm.drive_forces = lambda: forces
    found = diagnosed(truecut, tmp_path, arm, resample_hz=100, cutoffs_hz=(20, 6))
    kind, target, value = only_cause(found)
    assert (kind, target) == ("link_mass", f"joint{joint}")
    assert abs(value["value"] - factor) < 0.75 * (value["high"] - value["low"]) + 1e-3


def drawn_off(draw: np.random.Generator, last: int, least: float) -> tuple[int, np.ndarray]:
    """A link from the second to the last, and by how much the file has something of it elsewhere, m: up to 40 mm."""
    direction = draw.normal(size=3)
    return int(draw.integers(2, last + 1)), draw.uniform(least, 0.04) * direction / np.linalg.norm(direction)


def causes_with(truecut, folder: Path, arm: Quiet, place: str, off: np.ndarray) -> tuple[str, dict]:
    """The verdict and the causes where the file has the place behind a text `off` from where the machine has it."""
    forces, text = arm.drive_forces(), arm.urdf

    def moved(found: re.Match) -> str:
        return f'{found[1]}{" ".join(map(str, np.array(found[2].split(), float) - off))}"'

    arm.urdf = re.sub(rf'({place}.*?<origin xyz=")([^"]+)"', moved, text, count=1)
    assert arm.urdf != text
    arm.drive_forces = lambda: forces
    found = diagnosed(truecut, folder, arm, resample_hz=100, cutoffs_hz=(20, 6))
    causes = {(one["kind"], one["target"]): one["parameters"] for one in found["causes"]}
    print(found["verdict"], found["reason"], causes, place, off)
    return found["verdict"], causes


@pytest.mark.parametrize("seed", some(range(47_300, 47_304), 2))
def test_crosscheck_mujoco_a_link_with_its_centre_elsewhere_is_named(truecut, tmp_path, seed):
    """The file has the centre of mass of a link 10 to 40 mm from where the machine has it."""
    arm = Quiet(seed)
    joint, off = drawn_off(np.random.default_rng([seed, 7]), arm.joints, 0.01)
    verdict, causes = causes_with(truecut, tmp_path, arm, f'<link name="link_{joint}"><inertial>', off)
    assert verdict == "named" and list(causes) == [("link_center", f"joint{joint}")]
    # Its place across the axis changes the moments of its own drive.
    for name, true in zip(("x_m", "y_m"), off, strict=False):
        value = causes["link_center", f"joint{joint}"][name]
        assert abs(value["value"] - true) < 0.75 * (value["high"] - value["low"]) + 1e-4


# Arms of two joints are left out: one link carries another there, and that nothing.
ARMS_OF_THREE = some([seed for seed in range(47_500, 47_520) if Arm(seed).joints > 2][:6], 3)


@pytest.mark.parametrize("seed", ARMS_OF_THREE)
def test_crosscheck_mujoco_a_link_of_another_length_is_named(truecut, tmp_path, seed):
    """The file has the next joint 15 to 40 mm from where it stands on its link."""
    arm = Quiet(seed)
    joint, off = drawn_off(np.random.default_rng([seed, 9]), arm.joints - 1, 0.015)
    verdict, causes = causes_with(truecut, tmp_path, arm, f'<joint name="joint_{joint + 1}"', off)
    assert verdict == "named" and list(causes) == [("link_length", f"joint{joint}")]
    places = [causes["link_length", f"joint{joint}"][name] for name in ("x_m", "y_m", "z_m")]
    # What no drive feels has no interval.
    felt = [(value, true) for value, true in zip(places, off, strict=True) if value["low"] is not None]
    most = np.abs(off).argmax()
    assert abs(places[most]["value"] - off[most]) < 1e-3
    for value, true in felt:
        assert abs(value["value"] - true) < 0.75 * (value["high"] - value["low"]) + 1e-4


@pytest.mark.parametrize("seed", some(range(47_600, 47_612), 3))
def test_crosscheck_mujoco_friction_over_the_place_is_no_change_over_time(truecut, tmp_path, seed):
    """The motion comes again, and with it what a joint's friction makes of its places: it is shown as a curve."""
    arm = Quiet(seed)
    draw = np.random.default_rng([seed, 10])
    joint = int(draw.integers(1, arm.joints + 1))
    place, speed = arm.q[:, joint - 1], arm.v[:, joint - 1]
    # A half wave or less from end to end.
    share = (place - place.min()) / np.ptp(place)
    friction = 20 * arm.sizes[joint - 1] * (1 + 0.8 * np.cos(draw.uniform(0.7, 1.0) * np.pi * share))
    forces = arm.drive_forces()
    forces[:, joint - 1] += friction * np.tanh(speed / (0.01 * speed.std()))
    arm.drive_forces = lambda: forces
    found = diagnosed(truecut, tmp_path, arm, resample_hz=100, cutoffs_hz=(20, 6))
    causes = [(one["kind"], one["target"]) for one in found["causes"]]
    print(found["verdict"], found["reason"], causes, joint)
    assert not found["changes"]
    assert found["verdict"] == "unknown_cause"
    assert (found["curve"]["kind"], found["curve"]["target"]) == ("joint_friction_by_position", f"joint{joint}")


@pytest.mark.parametrize("seed", some(range(47_400, 47_404), 2))
def test_crosscheck_mujoco_a_rotor_that_the_file_lacks_is_named(truecut, tmp_path, seed):
    """A motor has a rotor of which the file says nothing."""
    arm = Quiet(seed)
    draw = np.random.default_rng([seed, 8])
    joint = int(draw.integers(1, arm.joints + 1))
    inertia = draw.uniform(3, 8) * arm.sizes[joint - 1] / arm.a[:, joint - 1].std()
    arm.truth[f"rotor {joint}"] = inertia
    found = diagnosed(truecut, tmp_path, arm, resample_hz=100, cutoffs_hz=(20, 6))
    kind, target, value = only_cause(found)
    assert (kind, target) == ("joint_rotor", f"joint{joint}")
    assert abs(value["value"] - inertia) < 0.75 * (value["high"] - value["low"])


@pytest.mark.parametrize("seed", some(range(47_200, 47_204), 2))
def test_crosscheck_mujoco_a_clock_that_runs_fast_is_named(truecut, tmp_path, seed):
    """The times of the data are off by a hundredth or so: torques are those of a faster or a slower motion."""
    arm = Quiet(seed)
    factor = float(np.random.default_rng([seed, 6]).choice([0.98, 0.99, 1.008, 1.015]))
    forces = arm.drive_forces()
    arm.drive_forces = lambda: forces
    arm.time = arm.time * factor
    found = diagnosed(truecut, tmp_path, arm, resample_hz=100, cutoffs_hz=(20, 6))
    kind, target, value = only_cause(found)
    assert (kind, target) == ("clock_rate", None)
    assert abs(value["value"] - factor) < 0.75 * (value["high"] - value["low"]) + 2e-4


class Wrist:
    """An arm of three joints that follow a command on springs; the last carries next to nothing."""

    STIFFNESS = np.array([8e4, 6e4, 9e3])

    def __init__(self, seed: int, factor: float) -> None:
        draw = np.random.default_rng(seed)
        masses, length = [20.0, 9.0, draw.uniform(0.8, 2.0)], draw.uniform(0.3, 0.6, 2)
        places = ["0 0 0.3", f"0 0 {length[0]}", f"{length[1]} 0 0"]
        text = ['<robot name="wrist"><link name="base"/>']
        axes, centres = ["0 0 1", "0 1 0", "0 1 0"], ["0.02 0 0.1", f"{length[1] / 2} 0 0.02", "0.05 0.01 0"]
        sizes = [0.3, 0.25, 0.004]
        for joint in range(3):
            moment = sizes[joint]
            text.append(
                f'<link name="link_{joint + 1}"><inertial><origin xyz="{centres[joint]}"/><mass value="{masses[joint]}"/>'
                f'<inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="joint_{joint + 1}" type="revolute"><origin xyz="{places[joint]}"/>'
                f'<parent link="{f"link_{joint}" if joint else "base"}"/><child link="link_{joint + 1}"/>'
                f'<axis xyz="{axes[joint]}"/><limit lower="-3" upper="3" effort="900" velocity="9"/></joint>'
            )
        self.urdf = "".join(text) + "</robot>"
        self.stiffness = self.STIFFNESS * np.array([1.0, 1.0, factor])
        self.hz, self.phase = draw.uniform(0.3, 0.9, (3, 2)), draw.uniform(0, 2 * np.pi, (3, 2))
        self.size = draw.uniform(0.1, 0.25, (3, 2))
        self.seed = seed

    def command(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Smoothly out of rest within a second."""
        turn = 2 * np.pi * self.hz * t[:, None, None] + self.phase
        q = (self.size * (np.sin(turn) - np.sin(self.phase))).sum(2)
        v = (self.size * 2 * np.pi * self.hz * np.cos(turn)).sum(2)
        part = np.clip(t, 0, 1)[:, None]
        ramp, rate = part**3 * (10 - 15 * part + 6 * part**2), 30 * part**2 * (1 - part) ** 2
        return ramp * q, ramp * v + rate * q

    def write(self, folder: Path, rate_hz: float = 200.0, duration_s: float = 5.0) -> Path:
        h, every = 1e-4, round(1e4 / rate_hz)
        fine = np.arange(round(duration_s / h)) * h
        theta, rate = self.command(fine)
        model = mujoco.MjModel.from_xml_string(self.urdf)
        model.opt.timestep = h
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
        data, damping = mujoco.MjData(model), 6e-4 * self.STIFFNESS
        for _ in range(50):
            mujoco.mj_forward(model, data)
            data.qpos[:] = theta[0] - data.qfrc_bias / self.stiffness
        rows = []
        for k in range(len(fine)):
            torque = self.stiffness * (theta[k] - data.qpos) + damping * (rate[k] - data.qvel)
            if k % every == 0:
                rows.append([fine[k], *theta[k], *data.qpos, *torque])
            data.qfrc_applied[:] = torque
            mujoco.mj_step(model, data)
        table = np.array(rows)
        draw = np.random.default_rng([self.seed, 1])
        noise = [2e-5] * 3 + list(0.01 * table[:, 7:].std(0))
        table[:, 4:] += np.array(noise) * draw.normal(size=table[:, 4:].shape)
        (folder / "robot.urdf").write_text(self.urdf, encoding="utf-8")
        joints = "".join(
            f'[[joint]]\nname = "joint_{j + 1}"\nstiffness_nm_per_rad = {k}\ndamping_nm_s_per_rad = {6e-4 * k}\n'
            '[joint.source]\nstiffness = "drawn"\ndamping = "drawn"\n'
            for j, k in enumerate(self.STIFFNESS)
        )
        frame = "[frames.tool]\nxyz_m = [0.1, 0, 0]\nrpy_deg = [0, 0, 0]\n"
        (folder / "robot.toml").write_text(f'name = "wrist"\n{frame}{joints}', encoding="utf-8")
        names = [f"{name}{j}" for name in "cqt" for j in (1, 2, 3)]
        np.savetxt(folder / "data.csv", table, delimiter=",", header=",".join(["t", *names]), comments="", fmt="%.10g")
        channels = "".join(
            f'[[data.channel]]\ncolumn = "c{j}"\nchannel = "joint{j}.command"\nunit = "rad"\nrole = "input"\n'
            f'[[data.channel]]\ncolumn = "q{j}"\nchannel = "joint{j}.angle"\nunit = "rad"\nnoise = 2e-5\n'
            f'[[data.channel]]\ncolumn = "t{j}"\nchannel = "joint{j}.transmission_torque"\nunit = "N m"\nnoise = {noise[2 + j]}\n'
            for j in (1, 2, 3)
        )
        scenario = folder / "wrist.toml"
        scenario.write_text(
            'name = "wrist"\n[robot]\nurdf = "robot.urdf"\ndrive = "position"\nhold_against_sag = false\n'
            f"posture_deg = {np.degrees(theta[0]).tolist()}\n"
            f'[process.replay]\nmode = "forward"\n[data]\nfile = "data.csv"\ntime = "t"\n{channels}',
            encoding="utf-8",
        )
        return scenario


@pytest.mark.parametrize("seed", [48_000, 48_001])
def test_crosscheck_mujoco_stiffness_of_a_light_wrist_is_named(truecut, tmp_path, seed):
    """It bends by some 5e-4 of what it moves by: what a simulation errs by is a part of the former."""
    for factor in (0.7, 1.0):
        folder = tmp_path / str(factor)
        folder.mkdir()
        scenario = Wrist(seed, factor).write(folder)
        truecut.call("diagnose", scenario, "--out", folder)
        found = json.loads((folder / "wrist" / "diagnosis.json").read_text(encoding="utf-8"))
        causes = {(one["kind"], one["target"]): one["parameters"] for one in found["causes"]}
        print(factor, found["verdict"], found["reason"], causes)
        if factor == 1.0:
            assert found["verdict"] == "nothing_beyond_noise"
            continue
        # A play of this joint may say nearly the same; a change over time does not.
        assert found["verdict"] in ("named", "ambiguous") and not found["changes"], found["reason"]
        assert list(causes) == [("joint_stiffness", "joint3")]
        value = causes["joint_stiffness", "joint3"]["factor"]
        assert abs(value["value"] - factor) < 3 * (value["high"] - value["low"]) / 4 + 0.01
