"""What paths take of a block against exact solids: the bodies of cutters, convex, swept between poses, united and cut out of the block."""

from __future__ import annotations

import json
import math

import manifold3d
import numpy as np
import pytest

from conftest import FIGURES, ROOT
from truecut_reference.sampled import some

SIZE_MM = np.array([36.0, 24.0, 6.0])
SIDES = 128
# a polygon's area is that of the circle
ROUNDER = 1.0 / math.sqrt(math.sin(math.tau / SIDES) / (math.tau / SIDES))
# of a body that turns between two poses the sweep is that of hulls between so many in between
PIECES = 5


def body(radius: float, corner: float) -> np.ndarray:
    """Points on a cutter, its tip at the origin, z up its axis; higher than any block."""
    kappa = np.linspace(0.0, math.pi / 2, 24 if corner > 0 else 1)
    rings = [(radius - corner + corner * math.sin(k), corner * (1 - math.cos(k))) for k in kappa] if corner > 0 else [(radius, 0.0)]
    rings.append((radius, 40.0))
    angle = math.tau * np.arange(SIDES) / SIDES
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * ROUNDER
    return np.concatenate([np.column_stack([ring * r, np.full(SIDES, z)]) for r, z in rings])


def turned(axis: np.ndarray) -> np.ndarray:
    """A rotation that takes z to an axis."""
    x = np.cross([0.0, 1.0, 0.0], axis)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def removed_mm3(points: np.ndarray, axes: np.ndarray, cutter: np.ndarray) -> float:
    """Volume that straight ways between these places of the tip, the axis turning evenly, take of the block."""
    swept = []
    for k in range(len(points) - 1):
        angle = math.acos(np.clip(axes[k] @ axes[k + 1], -1.0, 1.0))
        poses = []
        for share in np.linspace(0.0, 1.0, PIECES + 1):
            weights = (1 - share, share) if angle < 1e-9 else (math.sin((1 - share) * angle), math.sin(share * angle))
            axis = weights[0] * axes[k] + weights[1] * axes[k + 1]
            tip = points[k] + share * (points[k + 1] - points[k])
            poses.append(cutter @ turned(axis / np.linalg.norm(axis)).T + tip)
        swept += [manifold3d.Manifold.hull_points(np.concatenate(pair)) for pair in zip(poses, poses[1:])]
    block = manifold3d.Manifold.cube(SIZE_MM).translate([0.0, 0.0, -SIZE_MM[2]])
    return (block ^ manifold3d.Manifold.batch_boolean(swept, manifold3d.OpType.Add)).volume()


def drawn(seed: int) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Tips and axes of a path over the block that bends and turns, leaning forwards; flat, ball and bull nose in turn."""
    random = np.random.default_rng(seed)
    radius = random.uniform(4.0, 6.0)
    corner = [0.0, radius, 0.4 * radius][seed % 3]
    points, axes = [], []
    heading, aside = random.uniform(-0.2, 0.2), random.uniform(-0.3, 0.3)
    place = np.array([-radius - 4.0, random.uniform(9.0, 15.0), -random.uniform(0.8, 1.6)])
    bend, turn, rise = random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(0.0, 0.01)
    lean = random.uniform(0.2, 0.4)
    while place[0] < SIZE_MM[0] + radius + 3.0:
        forwards = np.array([math.cos(heading), math.sin(heading), 0.0])
        axis = math.tan(lean) * forwards + math.tan(aside) * np.array([-forwards[1], forwards[0], 0.0]) + np.array([0.0, 0.0, 1.0])
        points.append(place.copy())
        axes.append(axis / np.linalg.norm(axis))
        step = 2.0
        place = place + step * (forwards + np.array([0.0, 0.0, rise]))
        heading, aside = heading + bend * step, aside + turn * step
    return np.array(points), np.array(axes), radius, corner


def scenario(folder, points: np.ndarray, axes: np.ndarray, radius: float, corner: float):
    """Written as APT, with a scenario that mills along it."""
    goto = ["GOTO/" + ",".join(f"{one:.7f}" for one in (*point, *axis)) for point, axis in zip(points, axes)]
    head = ["PARTNO/DRAWN", "UNITS/MM", "MULTAX/ON", "RAPID", goto[0], "FEDRAT/1800,MMPM"]
    (folder / "way.apt").write_text("\n".join([*head, *goto[1:], "FINI"]) + "\n", encoding="utf-8")
    robots = ROOT / "assets" / "robots" / "irb6600_175_255"
    file = folder / "drawn.toml"
    file.write_text(
        f"""
name = "Drawn"
[robot]
urdf = '{robots / "robot.urdf"}'
config = '{robots / "milling.toml"}'
[run]
duration_s = 0.02
[process.path_milling]
spindle_rpm = 12000
[process.path_milling.cutter]
diameter_mm = {2 * radius!r}
corner_radius_mm = {corner!r}
teeth = 2
[process.path_milling.cutting]
tangential_mpa = 600
radial_mpa = 200
[process.path_milling.path]
file = "way.apt"
work_xyz_mm = [1050, -1450, 870]
[process.path_milling.stock]
corner_mm = [0, 0, {-SIZE_MM[2]}]
size_mm = {SIZE_MM.tolist()}
grid_mm = 0.2
""",
        encoding="utf-8",
    )
    return file


@pytest.mark.parametrize("seed", some(range(6), 3))
def test_verify_volume_of_a_path_that_leans_against_solids(truecut, tmp_path, seed):
    points, axes, radius, corner = drawn(seed)
    file = scenario(tmp_path, points, axes, radius, corner)
    out = tmp_path / "out"
    truecut.call("run", file, "--out", out, "--no-rrd")
    summary = json.loads((out / "drawn" / "summary.json").read_text(encoding="utf-8"))
    found = summary["metrics"]["path_milling.target_removed"] * 1e9
    expected = removed_mm3(points, axes, body(radius, corner))
    assert expected > 100.0, "nothing is cut"
    kind = "flat" if corner == 0 else "ball" if corner == radius else "bull nose"
    FIGURES.append(f"volume of a path that leans, {kind}: {found:.2f} of {expected:.2f} mm^3, {found / expected - 1:+.3%}")
    assert abs(found / expected - 1) < 5e-3
