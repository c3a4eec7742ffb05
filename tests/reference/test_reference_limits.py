"""Limits of docs/physics/stability.md and of crates/core/tests/limits.csv, computed anew."""

import csv
from pathlib import Path

import limits
import numpy as np
import pytest

ROWS = list(csv.DictReader((Path(__file__).parents[2] / "crates/core/tests/limits.csv").open()))


def extrapolated(modes, process, period, about, steps):
    """From so many steps a tooth period and twice as many."""
    coarse = limits.near(modes, process, period, steps, about)
    fine = limits.near(modes, process, period, 2 * steps, coarse)
    return (4 * fine - coarse) / 3


def test_limit_with_edge_forces():
    """Slot at 12 523 rpm of docs/physics/stability.md: without and with edge forces."""
    directions = ((1000, [1.0, 0.0]), (1040, [0.0, 1.0]))
    modes = [(2 * np.pi * f, 0.03, np.array(d) * 2 * np.pi * f / np.sqrt(1e7)) for f, d in directions]
    process, period = (2, 243.8e6, 113.5 / 243.8, 0.0, np.pi), 30.0 / 12523
    for edge, expected in ((None, 3.0715e-3), ((7.53e3, 7.83e3, 5e-5), 2.0760e-3)):
        coarse = limits.near(modes, process, period, 60, 1.01 * expected, edge)
        fine = limits.near(modes, process, period, 120, coarse, edge)
        assert (4 * fine - coarse) / 3 == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("row", [0, 15, 26, 38])
def test_drawn_limits(row):
    case = ROWS[row]
    modes = []
    for mode in case["modes"].split(";"):
        w, zeta, x, y = map(float, mode.split())
        modes.append((w, zeta, np.array([x, y])))
    names = ("tangential_pa", "radial_ratio", "entry_rad", "exit_rad")
    process = (int(case["teeth"]), *(float(case[name]) for name in names))
    limit = float(case["limit_m"])
    found = extrapolated(modes, process, float(case["period_s"]), limit, 60)
    assert found == pytest.approx(limit, rel=1e-3)


@pytest.mark.parametrize(
    ("rpm", "immersion", "up", "expected_mm"),
    [(7000, 0.3, True, 1.0718), (5000, 0.3, True, 0.3652), (9000, 0.5, True, 1.6020), (6000, 0.5, False, 1.1389)],
)
def test_limits_of_benchmark_1(rpm, immersion, up, expected_mm):
    entry = 0.0 if up else np.arccos(2 * immersion - 1)
    exit = np.arccos(1 - 2 * immersion) if up else np.pi
    modes = [(2 * np.pi * 922.0, 0.011, np.array([1.0, 0.0]) / np.sqrt(0.03993))]
    found = extrapolated(modes, (2, 6e8, 1 / 3, entry, exit), 30 / rpm, 1e-3 * expected_mm, 120)
    assert 1e3 * found == pytest.approx(expected_mm, rel=1e-3)
