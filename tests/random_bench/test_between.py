"""Changes between two recordings of drawn arms: named, and silent where nothing changed."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import between  # noqa: E402
from drawn.oracle import Label  # noqa: E402
from drawn.pair import ask, draw_pair, judge  # noqa: E402

SEED = 62_001
PROGRAM = os.environ.get("TRUECUT_BIN", between.run.PROGRAM)


def told(seed: int, family: str, folder: Path, repeats: bool):
    """What is said of a pair in inverse mode."""
    folder.mkdir()
    pair = draw_pair(seed, "inverse", family, folder, repeats)
    return judge(pair, *ask([PROGRAM], pair, 2), Label(True, True, 0.0))


def test_crosscheck_mujoco_what_changed_is_named(tmp_path):
    """Of three strong changes on the same motion two are named, or stand in a short list."""
    found = [told(SEED + i, "strong", tmp_path / str(i), True) for i in range(3)]
    assert all(one.repeated for one in found), found
    assert sum(one.right for one in found) >= 2, found


@pytest.mark.parametrize("repeats", [True, False])
def test_crosscheck_mujoco_what_both_share_is_no_change(tmp_path, repeats):
    """An arm that lacks something in both recordings: silence, whether the motion repeats or not."""
    found = told(SEED + 10 + repeats, "nothing", tmp_path / "pair", repeats)
    assert found.repeated is repeats and found.right, found
