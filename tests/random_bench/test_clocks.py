"""A logger whose quartz is off by less than it is sold for is no cause: drawn arms that are pushed, in MuJoCo."""

from __future__ import annotations

import csv
import os
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from drawn.case import draw_case  # noqa: E402
from drawn.judge import ask  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

PROGRAM = os.environ.get("TRUECUT_BIN", run.PROGRAM)
SEED = 88_001


def stamped(data: Path, factor: float) -> None:
    """The same samples with stamps of a clock that goes so fast."""
    with data.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    at = rows[0].index("t")
    for row in rows[1:]:
        row[at] = f"{float(row[at]) * factor:.12g}"
    with data.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)


@pytest.mark.parametrize("seed", some(range(SEED, SEED + 6), 3))
def test_crosscheck_mujoco_a_quartz_that_is_off_is_no_cause(seed, tmp_path):
    """Nothing is told but the clock's rate, as it is: by 1e-5, or by what noise lets it be known to."""
    case = draw_case(seed, "load", "clean", tmp_path)
    draw = np.random.default_rng(seed)
    factor = 1.0 + float(draw.choice([-1.0, 1.0]) * draw.uniform(2e-5, 1e-4))
    if "clock" not in case.nuisances:
        stamped(case.data, factor)
    answer = ask(shlex.split(PROGRAM), case, 2)
    assert answer.verdict == "nothing_beyond_noise", answer.diagnosis["reason"]
    if "clock" not in case.nuisances:
        found = next(one for one in answer.diagnosis["nominal"] if one["key"] == "data.clock_rate")["after"]
        error = (found["high"] - found["low"]) / (2.0 * 1.96)
        assert abs(found["value"] - 1.0 / factor) < max(1e-5, 3.5 * error), (found, factor)
