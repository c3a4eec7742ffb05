"""Reference numbers of docs/physics/brush.md."""

import bristle as b
import numpy as np
from pytest import approx


def test_buckling_load():
    assert b.frictionless(1e-7) == approx(np.pi**2 / 4, rel=1e-5)
    assert b.law(0.05) / b.frictionless(1e-7) == approx(1.013, abs=5e-4)


def test_law_against_the_elastica_without_friction():
    off = [100 * (b.law(d) / b.frictionless(d) - 1) for d in (0.02, 0.05, 0.1, 0.17)]
    assert off == approx([0.3, -1.2, -3.8, -7.4], abs=0.06)
    assert b.exact(0.1, 0.0) == approx(b.frictionless(0.1), rel=1e-6)


def test_law_against_the_elastica_with_friction():
    off = [
        100 * (b.law(d, mu) / b.exact(d, mu) - 1)
        for d, mu in [(0.05, 0.3), (0.15, 0.3), (0.1, 0.5)]
    ]
    assert off == approx([-4.0, -11.3, -9.0], abs=0.1)


def test_radius_of_a_right_angled_edge():
    dose, preston, tip = 5e5, 1.5e-10, 0.5e-3
    r, c, a = b.edge_radius(dose, preston, tip, np.pi / 2)
    assert c == approx(1 - np.pi / 4) and a == approx(np.sqrt(2))
    assert (2 * c / a) * (r - tip / a * np.log1p(a * r / tip)) == approx(preston * dose, rel=1e-5)
