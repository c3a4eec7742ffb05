"""Reference numbers of docs/physics/stability.md."""

import numpy as np
import pytest
import stability as s
from pytest import approx

SLOT, QUARTER = (0.0, np.pi), (0.0, np.pi / 2)


def test_directional_matrix():
    a = s.alpha(np.pi / 2, 0.07) - s.alpha(0.0, 0.07)
    assert a == approx(np.array([[-1.110, -1.641], [1.501, 0.890]]), abs=6e-4)
    mean = np.mean(
        [s.instant_pa(t, 3, 6e8, 0.07, *QUARTER) for t in np.linspace(0, 2 * np.pi, 60_001)[:-1]],
        axis=0,
    )
    assert mean == approx(s.average_pa(3, 6e8, 0.07, *QUARTER), rel=1e-3)


def test_flutter_eigenvalue():
    k = np.diag([0.9e6, 1.0e6]) - 0.3e-3 * s.average_pa(2, 767e6, 0.22, *SLOT)
    found = s.rightmost(500 * np.eye(2), 871.8 * np.eye(2), k)
    assert found.real == approx(1.471451, rel=1e-6)
    assert abs(found.imag) == approx(44.219371, rel=1e-7)


def test_process_of_one_direction():
    def eigenvalues(alpha, gamma):
        direction = lambda deg: np.array([np.cos(np.radians(deg)), np.sin(np.radians(deg))])
        return np.linalg.eigvals(
            np.diag([1e6, 1.1e6]) + 2e5 * np.outer(direction(gamma), direction(alpha))
        )

    unstable = eigenvalues(60, -20)
    assert unstable.real == approx([1.0674e6] * 2, rel=1e-4)
    assert abs(unstable.imag) == approx([6.97e4] * 2, rel=1e-3)
    assert sorted(eigenvalues(60, 20).real) == approx([1.0452e6, 1.2080e6], rel=1e-4)


def test_multipliers_of_benchmark_1():
    process = (2, 6e8, 1 / 3, *s.down(1.0))
    size = lambda depth_mm, steps: abs(
        s.multiplier(s.benchmark_1(), process, 6e-3, depth_mm * 1e-3, steps)
    )
    assert [size(d, 200) for d in (0.2, 0.5, 1.0)] == approx([0.81929, 1.07273, 1.40417], abs=1e-5)
    narrow = (2, 6e8, 1 / 3, *s.down(0.05))
    assert abs(s.multiplier(s.benchmark_1(), narrow, 6e-3, 1e-3, 200)) == approx(0.7494, abs=1e-4)
    # Second order in the step: two sizes give the limit.
    extrapolated = [(4 * size(d, 200) - size(d, 100)) / 3 for d in (0.2, 0.5, 1.0)]
    assert extrapolated == approx([0.8197, 1.0740, 1.4065], abs=1e-4)


SPEEDS = (5e3, 8e3, 10e3, 12e3, 16e3, 18e3, 20e3, 25e3)
FIRST_LIMITS = {
    0.05: ([2.21, 2.16, 4.09, 1.68, 5.50, 1.30, 2.29, 2.91], "HHFHFFHH"),
    0.5: ([0.852, 0.800, 2.11, 0.614, 2.07, 1.62, 0.720, 1.04], "HHFHFHHH"),
    1.0: ([0.414, 0.680, 0.323, 2.14, 0.319, 0.690, 1.42, 3.94], "HHHFHHFH"),
}


@pytest.mark.parametrize("immersion", FIRST_LIMITS)
def test_first_limits_of_benchmark_1(immersion):
    limits, kinds = FIRST_LIMITS[immersion]
    for rpm, expected, kind in zip(SPEEDS, limits, kinds):
        process = (2, 6e8, 1 / 3, *s.down(immersion))
        deepest = 1.3e-3 * expected
        limit, mu = s.first_limit(s.benchmark_1(), process, 30 / rpm, deepest, 100, points=12)
        assert 1e3 * limit == approx(expected, rel=0.02)
        assert (mu.real < 0 and abs(mu.imag) < 1e-6) == (kind == "F")


def test_zero_order_of_benchmark_2():
    modes = s.benchmark_2()
    b = s.average_pa(3, 6e8, 0.07, *QUARTER)
    omega = 2 * np.pi * np.linspace(500, 900, 20_001)
    values = np.linalg.eigvals(s.receptance(omega, modes) @ b)
    # Over all speeds κ takes every phase: a = (1 + (Im/Re)²) / (2 Re) of the eigenvalue.
    with np.errstate(divide="ignore"):
        depth = (1 + (values.imag / values.real) ** 2) * values.real / (2 * abs(values) ** 2)
    depth[depth <= 0] = np.inf
    at = np.unravel_index(np.argmin(depth), depth.shape)
    assert 1e3 * depth[at] == approx(1.087, abs=5e-4)
    assert omega[at[0]] / (2 * np.pi) == approx(633, abs=0.5)


@pytest.mark.parametrize(
    "arc, rows",
    [
        (
            QUARTER,
            [(5e3, 1.087, 1.10), (8e3, 1.095, 1.10), (10e3, 1.340, 1.366), (12e3, 4.03, 4.29)],
        ),
        (
            SLOT,
            [(5e3, 0.780, 0.789), (8e3, 0.777, 0.783), (10e3, 0.956, 0.968), (12e3, 2.69, 2.77)],
        ),
    ],
)
def test_limits_of_benchmark_2(arc, rows):
    for rpm, zero, semi in rows:
        b = s.average_pa(3, 6e8, 0.07, *arc)
        depth, _ = s.lowest_limit((300, 1500), s.benchmark_2(), b, 20 / rpm)
        assert 1e3 * depth == approx(zero, rel=3e-3)
        process = (3, 6e8, 0.07, *arc)
        limit, _ = s.first_limit(s.benchmark_2(), process, 20 / rpm, 1.3e-3 * semi, 48, points=12)
        assert 1e3 * limit == approx(semi, rel=0.01)
