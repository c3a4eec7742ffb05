"""What changes over time is told as that: friction that fades, a brake that sets in, a gain that jumps, a load that is
let go, on arms and motions drawn from seeds. Drive torques are MuJoCo's; half of the motions repeat, half do not.
"""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402, F401
from bench.noise import unit_noise  # noqa: E402
from test_delays import Drawn, named  # noqa: E402

RATE_HZ, DURATION_S = 100.0, 30.0
NOISE = 0.01
CHANGES = ("fades", "brake", "gain", "let_go")


class Changing(Drawn):
    """An arm that moves for half a minute, in three periods or in none."""

    def __init__(self, seed: int, folder: Path, repeats: bool) -> None:
        super().__init__(seed, folder)
        draw = np.random.default_rng([seed, 17])
        self.time = np.arange(round(DURATION_S * RATE_HZ)) / RATE_HZ
        base, waves = (DURATION_S / 3.0, 5) if repeats else (DURATION_S * 1.37, 20)
        rate = 2.0 * np.pi / base * np.arange(1, waves + 1)
        phase = np.outer(self.time, rate)
        cosine, sine = np.cos(phase), np.sin(phase)
        size = draw.normal(size=(2, waves, self.joints)) / np.arange(1, waves + 1)[:, None]
        size *= 0.7 / np.abs(cosine @ size[0] + sine @ size[1]).max(axis=0)
        self.command = draw.uniform(-0.5, 0.5, self.joints) + cosine @ size[0] + sine @ size[1]
        rate = rate[:, None]
        self.speed = cosine @ (rate * size[1]) - sine @ (rate * size[0])
        self.acceleration = -cosine @ (rate**2 * size[0]) - sine @ (rate**2 * size[1])
        self.joint = int(draw.integers(0, self.joints))
        self.moment_s = float(draw.uniform(8.0, 17.0))
        self.part = float(draw.uniform(0.25, 0.5))
        self.draw = draw

    def torque(self, heavier: float = 0.0) -> np.ndarray:
        """Of the motion, with so much more of the last link."""
        model = mujoco.MjModel.from_xml_string(self.urdf)
        model.body_mass[-1] *= 1.0 + heavier
        model.body_inertia[-1] *= 1.0 + heavier
        data, torque = mujoco.MjData(model), np.empty_like(self.command)
        for k, (q, v, a) in enumerate(zip(self.command, self.speed, self.acceleration, strict=True)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
            mujoco.mj_inverse(model, data)
            torque[k] = data.qfrc_inverse
        return torque

    def hidden(self, change: str | None) -> np.ndarray:
        """Torques with the change."""
        torque, late = self.torque(), self.time > self.moment_s
        size = self.part * torque[:, self.joint].std()
        if change == "fades":
            torque[:, self.joint] += 2.0 * size * np.exp(-self.time / 9.0) * np.sign(self.speed[:, self.joint])
        if change == "brake":
            torque[:, self.joint] += size * late * np.sign(self.speed[:, self.joint])
        if change == "gain":
            torque[late, self.joint] *= 1.0 + 0.5 * self.part
        if change == "let_go":
            torque[~late] = self.torque(0.5)[~late]
        return torque

    def data(self, torque: np.ndarray, colour: str) -> dict[str, np.ndarray]:
        """Columns of the data."""
        noise = unit_noise(colour, *torque.shape, RATE_HZ, 30.0, self.seed)
        values = torque + NOISE * self.torque().std(axis=0) * noise
        angles = self.command + 1e-5 * self.draw.normal(size=self.command.shape)
        columns = {"t": self.time} | {f"c{j + 1}": angles[:, j] for j in range(self.joints)}
        return columns | {f"f{j + 1}": values[:, j] for j in range(self.joints)}

    def scenario(self) -> Path:
        path = self.inverse()
        text = path.read_text(encoding="utf-8")
        text = text.replace("differentiate_cutoff_hz = 40", "differentiate_cutoff_hz = 10")
        path.write_text(text.replace("compare_cutoff_hz = 25", "compare_cutoff_hz = 5"), encoding="utf-8")
        return path


@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("seed", range(66_000, 66_002))
def test_crosscheck_mujoco_what_changes_over_time_is_told(change, repeats, seed, tmp_path):
    """It is neither noise nor a cause that acts all along, and a change at once is told with its moment."""
    arm = Changing(seed, tmp_path / "arm", repeats)
    found = named(arm.scenario(), arm.data(arm.hidden(change), "white"))
    assert found["verdict"] == "unknown_cause", found["reason"]
    assert "changes over time" in found["reason"]
    channels = {one["channel"] for one in found["changes"]}
    if change != "let_go":
        assert channels == {f"joint{arm.joint + 1}.drive_torque"}, found["changes"]
    if change != "fades":
        moments = [one["from_s"] for one in found["changes"] if one["from_s"] is not None]
        assert any(abs(moment - arm.moment_s) < 1.0 for moment in moments), (arm.moment_s, found["changes"])
    for channel, errors in found["channels"].items():
        assert errors["after"] <= 1.01 * errors["refitted"], (channel, errors)
        if channel in channels:
            assert errors["noise_source"] != "repetition", (channel, errors)


@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize(("what", "lasts_s"), [("drags", 3.0), ("off", 5.0), ("push", 0.4)])
@pytest.mark.parametrize("seed", range(69_000, 69_002))
def test_crosscheck_mujoco_what_sets_in_and_stops_is_told(what, lasts_s, repeats, seed, tmp_path):
    """A brake that drags for a while, a gain that is off for a while and a blow are told with both moments: they come
    once, and differences between periods, which hold them, are no noise."""
    arm = Changing(seed, tmp_path / "arm", repeats)
    torque, j = arm.torque(), arm.joint
    inside = (arm.time > arm.moment_s) & (arm.time < arm.moment_s + lasts_s)
    size = torque[:, j].std()
    shape = {"drags": np.sign(arm.speed[:, j]), "off": 0.4 * torque[:, j] / size, "push": np.ones_like(arm.time)}[what]
    torque[:, j] += inside * size * shape
    found = named(arm.scenario(), arm.data(torque, "white"))
    assert found["verdict"] == "unknown_cause", found["reason"]
    own = [one for one in found["changes"] if one["channel"] == f"joint{j + 1}.drive_torque"]
    ends = [(one["from_s"], one["until_s"]) for one in own if one.get("until_s") is not None]
    truth = (arm.moment_s, arm.moment_s + lasts_s)
    assert any(max(abs(a - b) for a, b in zip(pair, truth)) < 0.5 for pair in ends), (truth, found["changes"])


@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize("colour", ["white", "ar1", "one_over_f"])
@pytest.mark.parametrize("seed", range(67_000, 67_002))
def test_crosscheck_mujoco_slow_noise_is_no_change(colour, repeats, seed, tmp_path):
    """Noise of any memory is not told as a change, whether the motion repeats or not."""
    arm = Changing(seed, tmp_path / "arm", repeats)
    found = named(arm.scenario(), arm.data(arm.hidden(None), colour))
    assert found["changes"] == [], found["changes"]
    assert found["verdict"] == "nothing_beyond_noise", found["reason"]
