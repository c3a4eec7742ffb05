#!/usr/bin/env python3
"""Makes the data of the shipped example, `scenarios/diagnosis/elbow.csv`: an arm whose elbow has play; and
`elbow_later.csv`, the same motion when the elbow has worn.

The example's scenario is the bench's `two_joint` under another name; sensors have ordinary noise, the robot's masses
are 1 % heavier than stated.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402
from bench.dataset import write_csv  # noqa: E402
from bench.effects import Effect  # noqa: E402
from bench.experiment import TWO_JOINT, Experiment  # noqa: E402
from bench.noise import unit_noise  # noqa: E402

DATA = ROOT / "scenarios" / "diagnosis" / "elbow.csv"
LATER = DATA.with_name("elbow_later.csv")
HIDDEN = Effect("joint_backlash", 2, {"gap_rad": 1.2e-3})
WORN = Effect("joint_backlash", 2, {"gap_rad": 1.5e-3})
# places after the point at which no sensor here has anything to say
DECIMALS = {"t_s": 4, "command_1_deg": 7, "command_2_deg": 7, "torque_1_n_m": 3, "torque_2_n_m": 3, "height_mm": 3}


def measurement(e: Experiment, hidden: tuple[Effect, ...], seed: int) -> dict[str, np.ndarray]:
    """Columns of a measurement in their units."""
    noise = unit_noise("ar1", e.time_s.size, len(e.outputs), e.rate_hz, e.band_hz, seed)
    measured = e.outputs_of(hidden, (0.5,)) + 0.7 * noise * np.array(e.reference_noise)
    found = {"t_s": e.time_s}
    command = e.command()
    for i, column in enumerate(c for c in e.columns if c.is_input):
        found[column.name] = command[:, i] / column.si
    for i, column in enumerate(e.outputs):
        found[column.name] = measured[:, i] / column.si
    return found


def columns(hidden: Effect = HIDDEN, seed: int = 2024) -> dict[str, np.ndarray]:
    """The example's columns, rounded as in its file."""
    found = measurement(TWO_JOINT, (hidden,), seed)
    return {name: np.round(values, DECIMALS[name]) for name, values in found.items()}


if __name__ == "__main__":
    DATA.parent.mkdir(parents=True, exist_ok=True)
    for path, found in ((DATA, columns()), (LATER, columns(WORN, 2025))):
        write_csv(path, found)
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")
