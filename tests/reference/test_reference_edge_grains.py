"""Reference numbers of docs/physics/edge_grains.md."""

import edge_grains as e
import numpy as np
import pytest
from pytest import approx

CASES = [
    # E, μ, share that jams, force across inward and outward, their ratio, ratio of all
    (2, 0.3, 0.398, 82.2, 10.8, 7.62, 2.45),
    (2, 0.5, 0.739, 110.9, 16.8, 6.59, 3.01),
    (2, 0.8, 0.949, 126.3, 26.6, 4.75, 2.97),
    (4, 0.5, 0.180, 42.5, 20.8, 2.05, 1.15),
    (4, 0.8, 0.532, 69.2, 32.9, 2.10, 1.36),
    (8, 0.5, 0.018, 26.1, 24.0, 1.09, 0.97),
]


@pytest.mark.parametrize(("modulus", "mu", "share", "inward", "outward", "across", "whole"), CASES)
def test_grains_over_a_corner(modulus, mu, share, inward, outward, across, whole):
    """20 000 grains, one by one: the share of the closed form within the grid of depths, none outward."""
    found = e.corner_of_a_mould(modulus, mu)
    assert e.share_of_law(modulus, mu) == approx(share, abs=6e-4)
    assert found[0] == approx(share, abs=0.012) and found[1] == 0
    assert found[2:4] == approx([inward, outward], rel=3e-3)
    assert found[4:] == approx([across, whole], rel=4e-3)


def test_what_makes_an_edge_quiet_or_loud():
    ratio = lambda **other: e.corner_of_a_mould(4, 0.5, **other)[4]
    assert ratio(fillet=30.0) == approx(1.14, abs=0.01)
    assert ratio(pressure_mpa=0.06) == approx(1.44, abs=0.01)
    assert [e.share_of_law(4, 0.5, fillet=30.0), e.share_of_law(4, 0.5, pressure_mpa=0.06)] == approx([0.0041, 0.0183], abs=1e-4)
    louder = [e.corner_of_a_mould(2, 0.3, strength=80.0)[4], e.corner_of_a_mould(4, 0.8, strength=80.0)[4]]
    assert louder == approx([20.25, 5.72], rel=3e-3)
    sloping = e.corner_of_a_mould(4, 0.8, slope=0.3)
    assert sloping[0] == approx(0.532, abs=0.012) and sloping[4] == approx(2.05, abs=0.01)


def test_work_and_way_of_a_climb():
    kn = 2 * 4 / 0.75 * 40e-3
    stiffness, corner = (kn, 0.75 * kn), e.Corner(40.0, 5.0)
    table = [(5.0, 0.3, 15.8, 22.6), (20.0, 0.3, 192.4, 45.4), (20.0, 0.5, 301.7, 50.7), (30.0, 0.3, 440.5, 54.8)]
    for depth, mu, work, way in table:
        across, down, _ = e.run(np.array([depth]), corner, stiffness, mu, -1, step=0.05)
        begins = np.nonzero(across[:, 0])[0][0]
        arrives = np.nonzero(np.abs(down[:, 0] / (kn * depth) - 1) < 1e-6)[0][0]
        assert -across[:arrives, 0].sum() * 0.05 == approx(work, rel=3e-3)
        assert (arrives - begins) * 0.05 == approx(way, abs=0.15)
        assert -across[-1, 0] == approx(mu * kn * depth, rel=1e-6)


def test_grains_that_run_obliquely():
    kn = 2 * 4 / 0.75 * 40e-3
    depths = np.arange(20.0, 47.0, 1.0)
    for mu, degrees, least in [(0.3, 10, 34.5), (0.3, 15, 39.2), (0.5, 20, 31.2), (0.8, 30, 25.5)]:
        found = e.jam_depth(e.Corner(40.0, 5.0), (kn, 0.75 * kn), mu, np.radians(degrees), 40.0, depths)
        slope = np.tan(np.radians(degrees)) ** 2
        assert 45 * (1 - np.sqrt((mu**2 - slope) / (1 + mu**2))) == approx(least, abs=0.05)
        assert abs(found - least - 0.5) < 0.8, "depths stand 1 apart"
    beyond = e.jam_depth(e.Corner(40.0, 5.0), (kn, 0.75 * kn), 0.5, np.radians(40), 40.0, depths)
    assert beyond == 41
