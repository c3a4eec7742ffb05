"""The noise floor of `truecut diagnose` is one that no answer can reach: arms drawn from seeds, their drive forces by
MuJoCo, with torque ripple written here, which is none of the effects known."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from test_fit import Arm

NOISE_N_M = 0.26
RIPPLE_N_M = 1.7
SEEDS = (51_001, 51_005)


class Rippled(Arm):
    """Without friction. Its motion never comes again unless `periodic`, and never rests unless `rests`."""

    def __init__(self, seed: int, ripple: float, *, periodic: bool = False, rests: bool = False, colour: float = 0.0) -> None:
        super().__init__(seed, rotors=0.0)
        for name in self.truth:
            if name.split()[0] in ("viscous", "coulomb", "offset"):
                self.truth[name] = 0.0
        draw = np.random.default_rng([seed, 1])
        time = self.time
        if not periodic:
            hz = 0.125 * np.sqrt(np.arange(2, 12, 2))[:, None] * draw.uniform(0.8, 1.2, (5, self.joints))
            size = draw.normal(0, 0.4, hz.shape) / np.arange(1, 6)[:, None] * np.where(self.slides, 0.3, 1.0)
            phase = draw.uniform(0, 2 * np.pi, hz.shape)
            turn = 2 * np.pi * hz * time[:, None, None] + phase
            rate = 2 * np.pi * hz
            self.q, self.v, self.a = (
                (size * rate**k * wave).sum(1)
                for k, wave in enumerate((np.sin(turn), np.cos(turn), -np.sin(turn)))
            )
        if rests:
            # The path is gone along with a clock that stands at both ends.
            clock = np.clip((time - 2.0) / (time[-1] - 4.0), 0, 1)
            way = clock - np.sin(2 * np.pi * clock) / (2 * np.pi)
            path = CubicSpline(time, self.q)
            place = way * time[-1]
            rate = np.gradient(place, time, edge_order=2)
            speed = np.where((time < 2.0) | (time > time[-1] - 2.0), 0.0, rate)
            jolt = np.gradient(speed, time)
            self.q = path(place)
            self.v = path(place, 1) * speed[:, None]
            self.a = path(place, 2) * speed[:, None] ** 2 + path(place, 1) * jolt[:, None]
        self.ripple = np.zeros_like(self.q)
        self.rippled = int(draw.integers(0, self.joints))
        while self.slides[self.rippled]:
            self.rippled = int(draw.integers(0, self.joints))
        per_rad = draw.uniform(6, 20)
        self.ripple[:, self.rippled] = ripple * np.sin(per_rad * self.q[:, self.rippled] + draw.uniform(0, 6))
        drawn = draw.normal(size=self.q.shape)
        self.noise = np.zeros_like(self.q)
        for k in range(1, len(time)):
            self.noise[k] = colour * self.noise[k - 1] + NOISE_N_M * np.sqrt(1 - colour**2) * drawn[k]

    def drive_forces(self) -> np.ndarray:
        return super().drive_forces() + self.ripple


def diagnosed(truecut, folder: Path, arm: Arm, *, noise: float | None = None) -> dict:
    folder.mkdir()
    scenario = arm.write(folder)
    text = scenario.read_text(encoding="utf-8").partition("[fit]")[0]
    if noise is not None:
        for unit in ('unit = "N m"\n', 'unit = "N"\n'):
            text = text.replace(unit, f"{unit}noise = {noise}\n")
    scenario.write_text(text, encoding="utf-8")
    truecut.call("diagnose", scenario, "--out", folder)
    return json.loads((folder / scenario.stem / "diagnosis.json").read_text(encoding="utf-8"))


KINDS = {
    "repetition": {"periodic": True},
    "standstill": {"rests": True},
    "stated": {},
    "nothing": {},
}


@pytest.mark.parametrize("kind", KINDS)
def test_crosscheck_mujoco_ripple_is_told_from_noise(truecut, tmp_path, kind):
    """Ripple of 1.7 N m in noise of 0.26: "unknown", whatever the noise is known from; clean, no more than noise."""
    for seed in SEEDS:
        for ripple in (RIPPLE_N_M, 0.0):
            arm = Rippled(seed, ripple, **KINDS[kind])
            stated = NOISE_N_M if kind == "stated" else None
            found = diagnosed(truecut, tmp_path / f"{seed}_{ripple}", arm, noise=stated)
            channels = found["channels"]
            print(seed, ripple, found["verdict"], found["reason"], [one["kind"] for one in found["causes"]])
            sources = {one["noise_source"] for one in channels.values()}
            if kind != "nothing":
                assert sources == {kind}, sources
            if ripple:
                assert found["verdict"] == "unknown_cause", (seed, found["reason"])
                name = f"joint{arm.rippled + 1}.drive_torque"
                assert name in found["reason"], (seed, found["reason"])
            else:
                assert found["verdict"] == "nothing_beyond_noise", (seed, found["reason"])
