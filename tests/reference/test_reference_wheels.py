"""Contacts of soft wheels that the core is held against: docs/physics/wheel_contact.md."""

from pathlib import Path

import wheels
from pytest import approx, mark

ROWS = Path(wheels.__file__).parents[2] / "crates" / "core" / "tests" / "wheels.csv"


def rows(kind):
    lines = ROWS.read_text(encoding="utf-8").splitlines()
    return [[float(x) for x in line.split(",")[1:]] for line in lines if line.startswith(f"{kind},")]


@mark.parametrize("case", [(0.36, 15, 0.48, 2.5246, 3.3893), (0.5, 15, 0.48, 3.9629, 4.1949), (0.5, 15, 0.3, 3.0349, 3.7267),
                           (0.1, 15, 0.48, 0.48582, 1.5155), (0.5, 8, 0.48, 7.4243, 5.0888)])
def test_bonded_rubber_by_both_ways(case):
    """R_e = 30 mm, E* = 8 MPa: force N/mm and half width mm of the page, by collocation and as an obstacle problem."""
    depth, rubber, poisson, force, half = case
    wide, factor, _ = wheels.Layer(poisson).at(60 * depth / rubber**2)
    assert wide * rubber == approx(half, rel=1e-4)
    assert factor * 3.14159265 * 8 * (wide * rubber) ** 2 / 120 == approx(force, rel=1e-4)
    assert wheels.line_load(depth, 30, 8, rubber, poisson, 0.0, 8192) == approx(force, rel=1e-4)


def test_rows_are_found_anew():
    """A row of each kind; the edge on a coarser grid."""
    radius, rubber, poisson, modulus, tension, depth, force = rows("belt")[0]
    assert wheels.line_load(depth, radius, modulus, rubber, poisson, tension, 4096) == approx(force, rel=1e-4)
    radius, thickness, poisson, young, pressure, depth, force = rows("shell")[0]
    tool = wheels.wheel(radius, thickness, poisson, young, pressure)
    found = tool.shell.at(depth / radius)[0] * tool.modulus * radius**2
    assert found == approx(force, rel=2e-3)
    *wheel, depth, at, force = rows("edge")[0]
    assert wheels.cut(wheels.wheel(*wheel), depth, at, 43) == approx(force, rel=0.01)
