"""Reference numbers of docs/physics/surfaces.md."""

import numpy as np
import surface as s
from pytest import approx

TABLE = [
    (
        (0.25, 0.25),
        (50, -20, 15.5777),
        (-0.26751, -0.19803, 0.94299),
        (0.0037888, 0.0094832),
        (-0.96356, 0.05512, -0.26177),
        (39.433, -27.822, 52.826),
        3.2,
    ),
    ((0.5, 0.5), (100, 0, 25), (0, 0, 1), (0.0061685, 0.0090000), (1, 0, 0), (100, 0, 64.5), 0.0),
    (
        (0.75, 0.8),
        (150, 24, 15.5177),
        (0.25596, 0.17125, 0.95140),
        (0.0036629, 0.0072013),
        (0.92627, 0.23817, -0.29207),
        (160.111, 30.764, 53.098),
        14.0,
    ),
]
RADIUS, INDENTATION, WIDTH = 40.0, 0.5, 25.0


def test_table_of_the_spoke():
    for uv, point, normal, curvature, axis, centre, psi in TABLE:
        p, (r_u, _), _ = s.derivatives(*uv)
        n, _, _ = s.forms(*uv)
        values, direction = s.curvatures(*uv)
        assert p == approx(point, abs=1e-4) and n == approx(normal, abs=1e-5)
        assert values == approx(curvature, abs=1e-7)
        assert direction * np.sign(direction @ axis) == approx(axis, abs=1e-5)
        assert p + (RADIUS - INDENTATION) * n == approx(centre, abs=1e-3)
        feed = r_u / np.linalg.norm(r_u)
        assert np.degrees(np.arccos(abs(feed @ direction))) == approx(psi, abs=0.05)


def test_fundamental_forms():
    _, first, second = s.forms(0.25, 0.25)
    assert first == approx((43218.98, 953.165, 6682.24), rel=2e-6)
    assert second == approx((-164.525, -9.0527, -63.3688), rel=1e-5)


def test_edge_gaps_and_swath():
    gaps = [1e3 * row[3][0] * WIDTH**2 / 8 for row in TABLE]
    assert min(gaps) == approx(286, abs=0.5) and max(gaps) == approx(482, abs=0.5)
    # Line load 1.2 N/mm; the swath is the width seen across the feed and what the contact adds.
    values, axis = s.curvatures(0.25, 0.25)
    _, (r_u, _), _ = s.derivatives(0.25, 0.25)
    psi = np.arccos(abs(axis @ r_u) / np.linalg.norm(r_u))
    b, _ = s.hertz_line(1.2, RADIUS, values[1], 8.0)
    assert WIDTH * np.sin(psi) + 2 * b * np.cos(psi) == approx(6.1, abs=0.05)


def test_line_contact():
    b, pressure = s.hertz_line(1.2, RADIUS, 0.009, 8.0)
    assert b == approx(2.37, abs=5e-3) and pressure == approx(0.32, abs=5e-3)
