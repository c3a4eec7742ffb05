"""Laws outside the library are shown as curves: one of each form on drawn arms, in inverse dynamics and under a load."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import curves  # noqa: E402

PROGRAM = os.environ.get("TRUECUT_BIN", curves.PROGRAM)


@pytest.mark.parametrize(
    ("mode", "form", "seed"),
    [
        ("inverse", "hard_spot", 61_001),
        ("inverse", "place_friction", 61_002),
        ("inverse", "powered_drag", 61_003),
        ("inverse", "cogging", 61_004),
    ],
)
def test_crosscheck_mujoco_a_law_without_a_name_is_shown(mode, form, seed, tmp_path):
    """Joint, what the law follows, its shape within the band, and an error near the noise."""
    found = curves.one(seed, mode, form, tmp_path, [PROGRAM], 2)
    assert found.verdict == "unknown_cause"
    assert found.right, found
    assert found.inside >= 0.8 * found.places > 0, found
    assert found.left < 0.5 * found.left_nominal, found
