"""Drive forces that are late, each joint's by a time of its own or all by one, beside friction of every joint: arms drawn
from seeds, their drive forces by MuJoCo."""

from __future__ import annotations

import json

import numpy as np
import pytest
from truecut_reference.drawn_arm import RATE_HZ, Arm
from truecut_reference.sampled import some

SEEDS = some(range(43_000, 43_004), 2)


class Late(Arm):
    """Links are known, friction is not."""

    def __init__(self, seed: int, alike: bool) -> None:
        super().__init__(seed, rotors=0.0)
        draw = np.random.default_rng([seed, 2])
        own, one = draw.uniform(0.005, 0.03, self.joints), draw.uniform(0.005, 0.03)
        while np.ptp(own) < 1 / RATE_HZ:
            own = draw.uniform(0.005, 0.03, self.joints)
        self.delays_s = np.full(self.joints, one) if alike else own

    def drive_forces(self) -> np.ndarray:
        measured, columns = (self.q, self.v, self.a), []
        for joint, delay in enumerate(self.delays_s):
            self.q, self.v, self.a = self.moved(self.time - delay)
            columns.append(super().drive_forces()[:, joint])
        self.q, self.v, self.a = measured
        return np.stack(columns, axis=1)


@pytest.mark.parametrize("alike", [True, False], ids=["alike", "each"])
@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_mujoco_late_drive_forces_beside_friction(truecut, tmp_path, seed, alike):
    """One delay where all are late alike, else each joint's own; friction keeps its size."""
    arm = Late(seed, alike)
    scenario = arm.write(tmp_path)
    truecut.call("diagnose", scenario, "--out", tmp_path)
    diagnosis = json.loads((tmp_path / scenario.stem / "diagnosis.json").read_text(encoding="utf-8"))
    found = {(one["kind"], one["target"]): next(iter(one["parameters"].values())) for one in diagnosis["causes"]}
    delays = {key: one for key, one in found.items() if key[0].endswith("_delay")}
    print(1e3 * arm.delays_s, {key[1]: (1e3 * one["low"], 1e3 * one["high"]) for key, one in delays.items()})
    assert (("clock_delay", None) in delays) == alike
    assert len(delays) == (1 if alike else arm.joints)
    for (_, target), one in delays.items():
        truth = arm.delays_s[0 if alike else int(target.removeprefix("joint").split(".")[0]) - 1]
        # where the velocity changes its sign is known to a sample, and each period has it at the same one
        room = max(0.5 / RATE_HZ, 1.5 * 0.5 * (one["high"] - one["low"]))
        assert abs(one["value"] - truth) < room, (target, one, truth)
    for joint in range(1, arm.joints + 1):
        for kind in ("viscous", "coulomb"):
            value = found[f"joint_{kind}", f"joint{joint}"]["value"]
            assert abs(value / arm.truth[f"{kind} {joint}"] - 1) < 0.2, (kind, joint, value)
