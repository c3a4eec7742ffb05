"""`truecut diagnose` on drive forces of a few seconds: samples kept at twice the filter's cutoff would be too few."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from truecut_reference.drawn_arm import CUTOFF_HZ, RATE_HZ, Arm

DURATION_S = 7.0
SEEDS = range(42_000, 42_008)


def drawn(seed: int, named: bool) -> tuple[Arm, str | None]:
    """An arm without friction, or with that of one joint."""
    arm = Arm(seed, rotors=0.0, duration_s=DURATION_S)
    joint = int(np.random.default_rng([seed, 1]).integers(1, arm.joints + 1))
    kept = f"viscous {joint}" if named else None
    for one in arm.truth:
        if one.split()[0] in ("viscous", "coulomb", "offset") and one != kept:
            arm.truth[one] = 0.0
    return arm, kept


def diagnosed(truecut, arm: Arm, folder: Path) -> tuple[dict, str]:
    scenario = arm.write(folder)
    text = truecut.call("diagnose", scenario, "--out", folder)
    return json.loads((folder / scenario.stem / "diagnosis.json").read_text(encoding="utf-8")), text


def test_crosscheck_mujoco_a_short_record_is_thinned_less(truecut, tmp_path):
    """One viscous friction is named with its size, and the report says what was kept."""
    assert 2 * CUTOFF_HZ * DURATION_S < 200
    for seed in SEEDS:
        arm, kept = drawn(seed, named=True)
        folder = tmp_path / str(seed)
        folder.mkdir()
        diagnosis, text = diagnosed(truecut, arm, folder)
        causes = {f"{one['kind']} {one['target']}": one["parameters"] for one in diagnosis["causes"]}
        joint = kept.split()[1]
        print(seed, kept, arm.truth[kept], diagnosis["verdict"], causes)
        (parameter,) = causes[f"joint_viscous joint{joint}"].values()
        assert list(causes) == [f"joint_viscous joint{joint}"]
        assert abs(parameter["value"] / arm.truth[kept] - 1) < 0.25
        assert "since the record is short" in " ".join(text.split())


@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_mujoco_a_short_record_without_cause(truecut, tmp_path, seed):
    arm, _ = drawn(seed, named=False)
    diagnosis, _ = diagnosed(truecut, arm, tmp_path)
    assert diagnosis["verdict"] == "nothing_beyond_noise", diagnosis["causes"]


def test_a_record_that_is_too_short_says_what_to_do(truecut, tmp_path):
    arm = Arm(SEEDS[0], duration_s=3.0)
    done = truecut.run("diagnose", arm.write(tmp_path), "--out", tmp_path)
    message = " ".join(done.stderr.replace("\u2502", " ").split())
    assert done.returncode == 2
    assert f"of {int(3 * RATE_HZ)} samples" in message
    assert "compare_cutoff_hz to 20 Hz" in message and "a record of 6 s in place of 3.0 s" in message, message
