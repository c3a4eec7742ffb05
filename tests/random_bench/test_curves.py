"""Laws outside the library are shown as curves: two of each form on drawn arms, in inverse dynamics."""

from __future__ import annotations

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import curves  # noqa: E402

SEED = 61_001
PROGRAM = os.environ.get("TRUECUT_BIN", curves.PROGRAM)


def test_crosscheck_mujoco_laws_without_a_name_are_shown(tmp_path):
    """Of eight laws six are shown: joint, what the law follows, three of four places in the band, and on held-out data less
    than half of the error."""
    forms = [*curves.FORMS, *curves.FORMS]
    found = [
        curves.one(SEED + i, "inverse", form, tmp_path / str(i), [PROGRAM], 2) for i, form in enumerate(forms)
    ]
    assert all(one.verdict == "unknown_cause" for one in found), found
    shown = [one for one in found if one.right and one.left < 0.5 * one.left_nominal]
    assert len(shown) >= 6, curves.table(found)
    assert sum(one.inside for one in shown) >= 0.75 * sum(one.places for one in shown) > 0, curves.table(found)
