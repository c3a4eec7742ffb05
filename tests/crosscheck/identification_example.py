#!/usr/bin/env python3
"""Makes the data of the shipped example, `scenarios/identification`: a robot whose joints are not as stiff as its file
says, measured with a load cell, a laser tracker (noise 10 µm) and an impact hammer, all in MuJoCo.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from truecut_reference.identification import AXES, MeasuredArm, write_table  # noqa: E402

ROOT = HERE.parents[1]
FOLDER = ROOT / "scenarios" / "identification"
SCENARIO = ROOT / "scenarios" / "arm" / "static_load.toml"
# what the measured arm has beside its file
STIFFNESS_FACTOR = np.array([0.82, 1.25, 0.7, 1.4, 0.9, 1.0])
DAMPING_FACTOR = 1.5
HAMMERED_DEG = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
POSTURES_DEG = [
    HAMMERED_DEG,
    [0.0, 20.0, 10.0, 0.0, 60.0, 0.0],
    [40.0, -20.0, 30.0, 70.0, -70.0, 30.0],
    [-20.0, 40.0, -40.0, 110.0, 80.0, 90.0],
    [90.0, 10.0, -20.0, -60.0, 100.0, -40.0],
    [10.0, 60.0, 20.0, 150.0, -90.0, 10.0],
]
NOISE_M = 1e-5
FORCES_N = [[sign * 800.0 if axis == k else 0.0 for k in range(3)] for axis in range(3) for sign in (1, -1)]
BLOWS = {
    "rate_hz": 160.0,
    "oversampling": 40,
    "blows": 3,
    "interval_s": 5.0,
    "first_s": 0.1,
    "contact_s": 0.006,
    "peak_n": 2000.0,
    "noise": [0.5, 5e-4, 5e-4, 5e-4],
    "seed": 11,
}


def model(binary: Path) -> str:
    """The arm as truecut exports it."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "arm.xml"
        subprocess.run([binary, "export-mjcf", SCENARIO, "-o", target], check=True, stdout=subprocess.DEVNULL)
        return target.read_text(encoding="utf-8")


def make(binary: Path, folder: Path) -> None:
    """Writes the three tables."""
    folder.mkdir(parents=True, exist_ok=True)
    arm = MeasuredArm(model(binary), STIFFNESS_FACTOR, DAMPING_FACTOR)
    rows = arm.load_table(np.radians(POSTURES_DEG), np.array(FORCES_N), NOISE_M, seed=7)
    names = [f"q{k}_deg" for k in range(1, 7)] + [f"force_{a}_n" for a in AXES] + [f"d{a}_mm" for a in AXES]
    write_table(folder / "loads.csv", names, rows, [2] * 6 + [0] * 3 + [4] * 3)
    for axis in (1, 2):
        samples = arm.blows(np.radians(HAMMERED_DEG), axis, BLOWS)
        names = ["force_n"] + [f"a{a}_m_s2" for a in AXES]
        write_table(folder / f"hammer_{AXES[axis]}.csv", names, samples, [1] + [4] * 3)


if __name__ == "__main__":
    make(ROOT / "target" / "release" / "truecut", FOLDER)
    print(*(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB" for path in sorted(FOLDER.glob("*.csv"))), sep="\n")
