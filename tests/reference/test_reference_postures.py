"""Reference numbers of docs/physics/stability.md, section "An arm"."""

import numpy as np
import postures as p
import stability as s
from pytest import approx

# θr, k_min and k_max (N/µm), f1 and f2 (Hz), planar limit (mm), limit of six modes (mm, Hz),
# half slot with feed along X and Y (mm)
MAP = [
    (20, (0.615, 1.535), (6.50, 9.74), 1.20, (2.27, 9.4), (8.68, 3.81)),
    (60, (0.571, 1.963), (7.14, 9.95), 1.82, (1.66, 9.4), (6.50, 2.79)),
    (120, (0.596, 2.217), (7.87, 9.61), 2.11, (0.77, 9.0), (3.03, 1.31)),
    (160, (0.553, 2.588), (7.61, 9.84), 2.65, (1.14, 9.1), (4.39, 1.98)),
    (220, (0.615, 1.529), (6.68, 9.83), 1.19, (2.06, 9.4), (7.98, 3.66)),
]


def test_printed_postures():
    for angle, expected in [
        (20, [-43.1717, 33.4476, 5.1977, -72.4716, 110.6398, 131.8613]),
        (120, [-52.5034, 9.8275, 38.4479, -170.0007, 48.7107, 173.3639]),
    ]:
        off = [(np.degrees(q) - expected + 180) % 360 - 180 for q in p.postures(p.P1, angle)]
        assert min(np.abs(d).max() for d in off) < 1e-4


def test_map():
    slot, half = s.average_pa(*p.ALUMINIUM, *p.SLOT), s.average_pa(*p.ALUMINIUM, *p.HALF)
    for angle, stiffness, f, planar, (limit, hertz), halves in MAP:
        q = p.postures(p.P1, angle)[0]
        k = p.planar_stiffness(p.P1, q)
        assert 1e-6 * k == approx(stiffness, rel=2e-3)
        modes = p.tip_modes(p.P1, q)
        assert [w / (2 * np.pi) for w, *_ in modes[:2]] == approx(f, abs=5.1e-3)
        assert 1e3 * 2 * (k[1] - k[0]) / (2 * 767e6) == approx(planar, abs=6e-3)
        depth, at = s.lowest_limit((3, 60), modes, slot)
        assert 1e3 * depth == approx(limit, abs=6e-3) and at == approx(hertz, abs=0.051)
        found = [
            1e3 * s.lowest_limit((3, 60), modes, p.turned(half, feed))[0] for feed in (0, np.pi / 2)
        ]
        assert found == approx(halves, abs=6e-3)


def test_both_wrists_are_the_same_mechanics():
    one, other = (p.tip_modes(p.P1, q) for q in p.postures(p.P1, 120))
    b = s.average_pa(*p.ALUMINIUM, *p.SLOT)
    assert s.lowest_limit((3, 60), one, b)[0] == approx(
        s.lowest_limit((3, 60), other, b)[0], rel=1e-9
    )


def test_stable_angles_in_steel():
    slot, half = s.average_pa(*p.STEEL, *p.SLOT), s.average_pa(*p.STEEL, *p.HALF)
    ranges = lambda *ends: [a for first, last in ends for a in range(first, last + 1, 10)]

    def angles(point, first, process):
        stable = lambda a: all(
            p.stable(p.tip_modes(point, p.postures(point, a)[0]), b) for b in process
        )
        return [a for a in range(first, 241, 10) if stable(a)]

    worst = [half, p.turned(half, np.pi / 2)]
    assert angles(p.P1, 10, [slot]) == ranges((10, 60), (190, 240))
    assert angles(p.P2, 20, [slot]) == ranges((20, 70), (200, 240))
    assert angles(p.P1, 10, worst) == ranges((10, 90), (160, 240))
    assert angles(p.P2, 20, worst) == ranges((20, 240))


def test_regeneration_contradicts_mode_coupling():
    modes = p.tip_modes(p.P1, p.postures(p.P1, 120)[0])
    slot = s.average_pa(*p.STEEL, *p.SLOT)
    assert 1e3 * s.lowest_limit((3, 60), modes, slot)[0] == approx(0.142, abs=6e-4)
    for rpm, expected in [(150, 0.035), (300, 0.071), (600, 0.119), (1000, 0.49), (2400, 2.79)]:
        depth, _ = s.lowest_limit((3, 60), modes, slot, 15 / rpm)
        assert 1e3 * depth == approx(expected, rel=0.015)
