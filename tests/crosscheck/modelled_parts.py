"""Parts drawn at random with build123d: eight families, each from a seed."""

from __future__ import annotations

import math
import random


def drawn(seed: int):
    """Family and part."""
    import build123d as b

    rng = random.Random(seed)
    families = [block, turned, outline, waved, loft, pipe, balls, shell]
    family = families[seed % len(families)]
    part = family(b, rng)
    turn = b.Rot(rng.uniform(-180, 180), rng.uniform(-90, 90), rng.uniform(-180, 180))
    return family.__name__, b.Pos(*(rng.uniform(-80, 80) for _ in range(3))) * turn * part


def block(b, rng):
    """A box with rounded and bevelled edges, through holes and a blind one."""
    x, y, z = rng.uniform(60, 160), rng.uniform(40, 100), rng.uniform(15, 40)
    part = b.Box(x, y, z)
    part = b.fillet(part.edges().filter_by(b.Axis.Z), rng.uniform(3, 12))
    part = b.fillet(part.faces().sort_by(b.Axis.Z)[-1].edges(), rng.uniform(0.5, 2.5))
    part = b.chamfer(part.faces().sort_by(b.Axis.Z)[0].edges(), rng.uniform(0.5, 2))
    for _ in range(rng.randint(1, 4)):
        at = rng.uniform(-0.3, 0.3) * x, rng.uniform(-0.25, 0.25) * y
        part -= b.Pos(*at, 0) * b.Cylinder(rng.uniform(2, 6), 3 * z)
    part -= b.Pos(0.35 * x, 0.1 * y, 0.5 * z) * b.Cone(rng.uniform(1, 3), rng.uniform(4, 7), 8)
    return part


def turned(b, rng):
    """A body of revolution with arcs, straight and slanted flanks, and holes in a circle."""
    bore, rim, high = rng.uniform(8, 15), rng.uniform(50, 80), rng.uniform(20, 50)
    neck = rng.uniform(bore + 5, 0.5 * rim)
    with b.BuildPart() as made:
        with b.BuildSketch(b.Plane.XZ):
            with b.BuildLine():
                b.Polyline((neck, high), (bore, high), (bore, 0), (rim, 0), (rim, 10))
                b.Line((rim, 10), (rim - 6, 14))
                b.RadiusArc((rim - 6, 14), (neck + 5, 18), rng.uniform(80, 300))
                b.Line((neck + 5, 18), (neck, high))
            b.make_face()
        b.revolve(axis=b.Axis.Z)
        with b.PolarLocations(0.75 * rim, rng.randint(3, 7)):
            b.Hole(rng.uniform(2, 4))
    return made.part


def outline(b, rng):
    """A prism over a closed spline, with a hole."""
    count = rng.randint(5, 9)
    corner = [(rng.uniform(25, 50), 2 * math.pi * k / count) for k in range(count)]
    points = [(r * math.cos(a), r * math.sin(a)) for r, a in corner]
    with b.BuildPart() as made:
        with b.BuildSketch():
            with b.BuildLine():
                b.Spline(*points, periodic=True)
            b.make_face()
        b.extrude(amount=rng.uniform(10, 40))
        with b.Locations((0, 0, 0)):
            b.Hole(rng.uniform(4, 9))
    return made.part


def waved(b, rng):
    """A block under a B-spline face."""
    a, c, d = (rng.uniform(-4, 4) for _ in range(3))
    grid = [
        [
            b.Vector(x, y, 30 + a * math.sin(x / 25) * math.cos(y / 30) + c * x * y / 2000 + d * math.cos(x / 40))
            for y in range(-48, 49, 16)
        ]
        for x in range(-75, 76, 15)
    ]
    above = b.Solid.extrude(b.Face.make_surface_from_array_of_points(grid, tol=1e-3), b.Vector(0, 0, 60))
    part = b.Box(rng.uniform(80, 130), rng.uniform(50, 80), 60, align=(b.Align.CENTER, b.Align.CENTER, b.Align.MIN))
    part = b.fillet(part.edges().filter_by(b.Axis.Z), rng.uniform(3, 15)) - above
    part -= b.Pos(rng.uniform(-20, 20), rng.uniform(-10, 10)) * b.Cylinder(rng.uniform(3, 10), 200)
    return part


def loft(b, rng):
    """From a rounded rectangle to a circle."""
    with b.BuildPart() as made:
        with b.BuildSketch():
            b.RectangleRounded(rng.uniform(50, 90), rng.uniform(40, 60), rng.uniform(5, 15))
        with b.BuildSketch(b.Plane.XY.offset(rng.uniform(25, 60))):
            b.Circle(rng.uniform(10, 20))
        b.loft()
    return made.part


def pipe(b, rng):
    """A bent pipe, open at both ends."""
    line = b.Spline(*[(20.0 * k, rng.uniform(-12, 12), rng.uniform(-12, 12)) for k in range(5)])
    outer = rng.uniform(6, 10)
    start = b.Plane(origin=line @ 0, z_dir=line % 0)
    part = b.sweep(start * b.Circle(outer), path=line)
    return part - b.sweep(start * b.Circle(0.6 * outer), path=line)


def balls(b, rng):
    """A ball, a ring and a cone in one, cut by a plane."""
    part = b.Sphere(rng.uniform(20, 30)) + b.Pos(0, 0, rng.uniform(-5, 5)) * b.Torus(rng.uniform(32, 40), rng.uniform(5, 9))
    part += b.Pos(rng.uniform(-5, 5), 0, 25) * b.Cone(rng.uniform(8, 14), rng.choice([0, 4]), 40)
    return part - b.Pos(0, 0, -60) * b.Box(200, 200, rng.uniform(70, 90))


def shell(b, rng):
    """A rounded box hollowed out, open above."""
    part = b.Box(rng.uniform(60, 120), rng.uniform(40, 80), rng.uniform(20, 40))
    part = b.fillet(part.edges().filter_by(b.Axis.Z), rng.uniform(8, 15))
    part = b.fillet(part.faces().sort_by(b.Axis.Z)[0].edges(), rng.uniform(3, 6))
    return b.offset(part, amount=-rng.uniform(1.5, 2.5), openings=part.faces().sort_by(b.Axis.Z)[-1])
