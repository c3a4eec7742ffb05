"""Models the parts of this folder with build123d and writes each as STL and as STEP: `pip install build123d`, then
`python draw.py [FOLDER]`.

A bracket whose top waves, a plate with pockets, and a flange whose face is domed, with a bore and bolt holes. Nothing is
done for the sake of what reads them: faces have their seams and meshes their slivers as Open CASCADE makes them. Its mesher
keeps the tolerance at some places of a triangle only, so that it is asked for much less than what is needed.
"""

import math
import sys
from pathlib import Path

from build123d import (
    Align,
    Axis,
    Box,
    BuildLine,
    BuildPart,
    BuildSketch,
    Cylinder,
    Face,
    Hole,
    Plane,
    PolarLocations,
    Polyline,
    Pos,
    RadiusArc,
    RectangleRounded,
    SlotOverall,
    Solid,
    Vector,
    export_step,
    export_stl,
    extrude,
    fillet,
    make_face,
    revolve,
)

UPWARDS = (Align.CENTER, Align.CENTER, Align.MIN)


def wave(x, y):
    """Height of the bracket's top, mm."""
    bow = 40 + 5 * math.cos(math.pi * x / 130) - y * y / 420
    return bow + 2.2 * math.sin(2 * math.pi * x / 150) * math.cos(math.pi * y / 90)


def bracket():
    """A foot of 170 by 84 by 12 mm with four holes, on it a block of 104 by 70 mm under a B-spline face, both with rounded
    corners."""
    grid = [[Vector(x, y, wave(x, y)) for y in range(-51, 52, 17)] for x in range(-72, 73, 18)]
    above = Solid.extrude(Face.make_surface_from_array_of_points(grid, tol=1e-3), Vector(0, 0, 60))
    foot = Box(170, 84, 12, align=UPWARDS)
    foot = fillet(foot.edges().filter_by(Axis.Z), 10)
    block = Box(104, 70, 60, align=UPWARDS)
    block = fillet(block.edges().filter_by(Axis.Z), 6)
    part = foot + (block - above)
    for x, y in [(-72, -24), (-72, 24), (72, -24), (72, 24)]:
        part -= Pos(x, y, 0) * Cylinder(5.5, 60)
    return part


def plate():
    """A plate of 170 by 110 by 18 mm, its top at z = 0: a pocket of 8 mm, a slot of 6 mm, a bore and four holes."""
    whole = Box(170, 110, 18, align=(Align.CENTER, Align.CENTER, Align.MAX))
    part = fillet(whole.edges().filter_by(Axis.Z), 14)
    part -= Pos(-40, 0, -8) * extrude(RectangleRounded(60, 70, 12), 20)
    part -= Pos(42, 18, -6) * extrude(SlotOverall(60, 26), 20)
    part -= Pos(42, -26, 0) * Cylinder(15, 60)
    for x, y in [(-76, -46), (-76, 46), (76, -46), (76, 46)]:
        part -= Pos(x, y, 0) * Cylinder(4, 60)
    return part


def flange():
    """A disc of 144 mm, 14 mm high at its rim and domed with a radius of 300 mm, a bore of 36 mm and six holes of 10 mm."""
    with BuildPart() as made:
        with BuildSketch(Plane.XZ):
            with BuildLine():
                Polyline((72, 14), (72, 0), (18, 0), (18, 20.6))
                RadiusArc((18, 20.6), (72, 14), 300)
            make_face()
        revolve(axis=Axis.Z)
        with PolarLocations(52, 6):
            Hole(5)
    return made.part


def main():
    """Writes all parts."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for name, part, chord_mm in [("bracket", bracket(), 0.0005), ("plate", plate(), 0.01), ("flange", flange(), 0.004)]:
        export_stl(part, str(folder / f"{name}.stl"), tolerance=chord_mm, angular_tolerance=0.2)
        export_step(part, str(folder / f"{name}.step"), write_pcurves=False, timestamp="2026-01-31T12:00:00")


if __name__ == "__main__":
    main()
