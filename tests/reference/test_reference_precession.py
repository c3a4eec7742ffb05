"""Reference numbers of docs/physics/precession.md."""

import numpy as np
import precession as p
import pytest
from pytest import approx


def test_patch_and_lever():
    assert p.PATCH == approx(4.862, abs=1e-3) and p.LEVER == approx(7.061, abs=1e-3)
    assert p.epsilon(0.0) == approx(0.689, abs=1e-3)


def test_point_near_one_edge():
    assert p.epsilon(2.0) == approx(0.6276, abs=1e-4)
    assert np.degrees(np.arccos(p.epsilon(2.0))) == approx(51.12, abs=5e-3)
    start = p.edges(np.array([50.0, 58.0]))[0][2][0]
    found = [
        p.outward_mm(np.radians(beta), np.array([0.0, 1.0]), start) for beta in (0, 45, 60, 80, 180)
    ]
    assert found == approx([2.471, 0.527, -0.847, -3.012, -10.80], abs=5e-3)


def test_point_near_a_corner():
    for rule, expected in [
        (0.0, (270, 360)),
        ("whole", (308.88, 327.19)),
        ("clipped", (308.88, 343.55)),
    ]:
        found = np.degrees(p.allowed(np.array([97.0, 58.0]), rule)) % 360
        found[1] = found[1] or 360.0
        assert found == approx(expected, abs=6e-3)


def test_corners_ask_for_a_smaller_patch():
    # Two chords at right angles: whole ones need ε ≤ cos 45°, clipped ones end at the corner.
    assert np.cos(np.pi / 4) == approx(0.707, abs=2e-4)
    start = p.edges(np.array([100.0, 60.0]))
    assert {round(min(c[0], -c[1]), 9) for _, _, _, c in start} <= {0.0, -round(p.PATCH, 9)}


@pytest.mark.parametrize(
    "rule, points, share, fastest",
    [
        ("none", 70.99, 0.541, 1.5),
        (0.0, 70.78, 0.326, 157.1),
        (0.2, 69.47, 0.207, 136.9),
        ("whole", 0.0, 0.0, 116.9),
    ],
)
def test_raster(rule, points, share, fastest):
    zone, *found = p.table(rule)
    assert zone == 1451
    assert found[0] == approx(points, abs=0.15)
    assert found[1] == approx(share, abs=5e-3)
    assert found[2] == approx(fastest, abs=0.06)
