"""Reference numbers of docs/physics/brush.md."""

import bristle as b
import numpy as np
from pytest import approx


def test_buckling_load():
    assert b.frictionless(1e-7) == approx(np.pi**2 / 4, rel=1e-5)


def test_what_slight_bending_leaves_out():
    assert b.exact(0.1, 0.0) == approx(b.frictionless(0.1), rel=1e-6)
    points = [(0.02, 0.0), (0.05, 0.0), (0.1, 0.0), (0.17, 0.0), (0.05, 0.3), (0.15, 0.3), (0.1, 0.5), (0.17, 0.5)]
    off = [100 * (b.law(d, mu) / b.exact(d, mu) - 1) for d, mu in points]
    assert off == approx([-1.0, -2.5, -5.0, -8.6, -4.7, -12.1, -9.6, -15.2], abs=0.06)


def test_forces_of_the_elastica():
    """As the documents have them, in EI/L²."""
    found = [b.exact(d, mu) for d, mu in [(0.05, 0.3), (0.15, 0.3), (0.1, 0.5), (0.17, 0.5), (0.4, 0.2)]]
    assert found == approx([1.3953, 1.87844, 1.36006, 1.64216, 2.78171], rel=1e-5)


def test_radius_of_a_right_angled_edge():
    dose, preston, tip = 5e5, 1.5e-10, 0.5e-3
    r, c, a = b.edge_radius(dose, preston, tip, np.pi / 2)
    assert c == approx(1 - np.pi / 4) and a == approx(np.sqrt(2))
    assert (2 * c / a) * (r - tip / a * np.log1p(a * r / tip)) == approx(preston * dose, rel=1e-5)
