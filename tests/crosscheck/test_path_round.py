"""Forces of ball and bull-nose cutters round a corner against a model of its own: the stock as heights over cells.

The motion of the tip is the recording's, vibration included; what is held against each other is what the teeth meet, hence the
force. A tooth that passes over the middle of a cell lowers it to its edge. The chip is what stands above the edge, column by
column along the edge seen from above; each bit of it presses along the line from the middle of the corner's arc through it. The
heights know nothing of layers, of rays at a height, or of earlier passes.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np
import pyarrow.parquet as pq
import pytest

from conftest import FIGURES, ROOT

STEPS = 40
K_T, K_R = 600.0, 200.0
GRID_MM, CELL_MM = 0.1, 0.03
PARTS = 4
# pieces of an edge
PIECES = 100
SCENARIO = """
name = "Corner with a round cutter"
[robot]
urdf = "{robot}/robot.urdf"
config = "{robot}/milling.toml"
inertia_scale = 1.2195121951219512
[run]
time_step_ms = {step_ms}
record_interval_ms = {step_ms}
[process.path_milling]
spindle_rpm = {rpm}
cutter = {{ diameter_mm = {diameter}, corner_radius_mm = {corner}, teeth = {teeth} }}
cutting = {{ tangential_mpa = 600, radial_mpa = 200 }}
path = {{ file = "{path}", work_xyz_mm = [1050, -1450, 870], rapid_mm_per_s = 200 }}
[process.path_milling.stock]
corner_mm = [-15, -15, -6]
size_mm = [40, 30, 6]
grid_mm = {grid}
hole = [{{ xy_mm = [0, 0], diameter_mm = {hole} }}]
"""


@dataclass(frozen=True)
class Case:
    """A cutter and its way out of a hole and round a corner, mm."""

    radius: float
    corner: float
    depth: float
    teeth: int
    chip: float
    rpm: float
    turn: float

    @staticmethod
    def drawn(seed: int) -> Case:
        """Every second one a ball. No deeper than 0.7 of the corner's radius: walls that are nearly upright are the flat
        cutter's, and columns know them badly."""
        draw = random.Random(seed)
        radius = draw.uniform(2.0, 3.5)
        corner = radius if seed % 2 == 0 else radius * draw.uniform(0.35, 0.8)
        return Case(
            radius=radius,
            corner=corner,
            depth=corner * draw.uniform(0.25, 0.7),
            teeth=draw.choice([2, 3]),
            chip=draw.uniform(0.03, 0.05),
            rpm=draw.uniform(6000, 12000),
            turn=math.radians(draw.choice([-1, 1]) * draw.uniform(60, 120)),
        )

    @property
    def hole(self) -> float:
        return self.radius + 0.3

    @property
    def flat(self) -> float:
        """Radius of the flat end."""
        return self.radius - self.corner

    @property
    def spin(self) -> float:
        return self.rpm / 60 * math.tau

    def write(self, folder, grid: float, steps: int):
        """The scenario's file."""
        path, scenario = folder / "corner.nc", folder / "round_corner.toml"
        x = 2.5
        end = x + 2.5 * math.cos(self.turn), 2.5 * math.sin(self.turn)
        feed = self.chip * self.teeth * self.rpm
        lines = [
            "G21 G90 G94 G17",
            "G0 X0. Y0. Z0.5",
            "G61",
            f"G0 Z{-self.depth:.6f}",
            "G64",
            f"G1 X{x} F{feed:.4f}",
            f"X{end[0]:.6f} Y{end[1]:.6f}",
            "M30",
        ]
        path.write_text("%\n" + "\n".join(lines) + "\n%\n", encoding="utf-8")
        text = SCENARIO.format(
            robot=(ROOT / "assets" / "robots" / "irb6600_175_255").as_posix(),
            step_ms=60e3 / self.rpm / self.teeth / steps,
            rpm=self.rpm,
            diameter=2 * self.radius,
            corner=self.corner,
            teeth=self.teeth,
            path=path.name,
            grid=grid,
            hole=2 * self.hole,
        )
        scenario.write_text(text, encoding="utf-8")
        return scenario


class Heights:
    """The stock from above, its top at 0; the height of what is left at the middles of cells."""

    def __init__(self, least: np.ndarray, most: np.ndarray, cell: float, hole: float) -> None:
        self.cell, self.hole = cell, hole
        count = np.ceil((most - least) / cell).astype(int)
        self.x, self.y = (least[k] + cell * (np.arange(count[k]) + 0.5) for k in range(2))
        self.z = np.zeros(count)

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Bilinear between cells; the hole is exact."""
        u, v = (x - self.x[0]) / self.cell, (y - self.y[0]) / self.cell
        i, j = u.astype(np.int64), v.astype(np.int64)
        u, v = u - i, v - j
        flat, width = self.z.ravel(), self.z.shape[1]
        k = i * width + j
        low = flat[k] * (1 - v) + flat[k + 1] * v
        high = flat[k + width] * (1 - v) + flat[k + width + 1] * v
        return np.where(x * x + y * y < self.hole**2, -np.inf, low * (1 - u) + high * u)

    def about(self, middle: np.ndarray, reach: float) -> tuple[slice, slice]:
        """Cells of a square."""
        ends = [np.searchsorted(line, [middle[k] - reach, middle[k] + reach]) for k, line in enumerate((self.x, self.y))]
        return slice(*ends[0]), slice(*ends[1])


class Cut:
    """A tip that moves (mm, a row a step) turns its teeth through heights."""

    def __init__(self, case: Case, time_s: np.ndarray, tip: np.ndarray, steps: int, cell: float) -> None:
        self.case, self.time, self.tip, self.steps = case, time_s, tip, steps
        self.rows = np.arange(len(tip), dtype=float)
        deepest = math.acos(1 + tip[:, 2].min() / case.corner) if -tip[:, 2].min() < case.corner else 0.5 * math.pi
        bounds = np.linspace(0.0, deepest, PIECES + 1)
        kappa = 0.5 * (bounds[1:] + bounds[:-1])
        # a column's distance from the arc's middle across, the middle's height above the edge, and the column's width
        self.across, self.below = case.corner * np.sin(kappa), case.corner * np.cos(kappa)
        self.width = case.corner * np.diff(np.sin(bounds))
        self.reach = case.flat + case.corner * math.sin(deepest) + 3 * cell
        self.stock = Heights(tip[:, :2].min(axis=0) - self.reach, tip[:, :2].max(axis=0) + self.reach, cell, case.hole)

    def axis(self, row: np.ndarray) -> np.ndarray:
        """Where the tip was, by steps and parts of them."""
        return np.stack([np.interp(row, self.rows, self.tip[:, k]) for k in range(3)], axis=-1)

    def angle(self, row: np.ndarray, tooth: int = 0) -> np.ndarray:
        """Of a tooth, from y towards x."""
        dt = self.time[1] - self.time[0]
        return self.case.spin * (self.time[0] + row * dt) - math.tau / self.case.teeth * tooth

    def forces(self) -> np.ndarray:
        """Means over tooth periods, N. Within one no tooth comes to where another has been in it."""
        periods = []
        for first in range(0, len(self.tip) - self.steps + 1, self.steps):
            row = first - 0.5 + (np.arange(self.steps * PARTS) + 0.5) / PARTS
            place = self.axis(row)
            each = [self.of_tooth(place, self.angle(row, tooth)) for tooth in range(self.case.teeth)]
            periods.append(sum(each).mean(axis=0))
            self.sweep(first - 0.5)
        return np.array(periods)

    def of_tooth(self, place: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Force on the tool at each of several instants."""
        sin, cos = np.sin(angle), np.cos(angle)
        x, y = (place[:, k, None] + (self.case.flat + self.across) * way[:, None] for k, way in enumerate((sin, cos)))
        chip = np.maximum(self.stock.at(x, y) - place[:, 2:] - self.case.corner + self.below, 0.0)
        # of a column's bits: area, and the parts of their directions outwards and down
        upper = np.maximum(self.below - chip, 0.0)
        outwards = np.maximum(chip - self.below, 0.0) + self.across * (
            np.arcsinh(self.below / self.across) - np.arcsinh(upper / self.across)
        )
        down = np.hypot(self.across, self.below) - np.hypot(self.across, upper)
        tangential, inwards, up = K_T * (chip @ self.width), K_R * (outwards @ self.width), K_R * (down @ self.width)
        return np.stack([-tangential * cos - inwards * sin, tangential * sin - inwards * cos, up], axis=-1)

    def sweep(self, begin: float) -> None:
        """Teeth turn on by a pitch from a row on; all cells about the axis have been passed once then."""
        middle = np.array(begin + 0.5 * self.steps)
        columns, rows = self.stock.about(self.axis(middle), self.reach)
        x, y = self.stock.x[columns, None], self.stock.y[None, rows]
        row = np.broadcast_to(middle, (x.shape[0], y.shape[1]))
        pitch = math.tau / self.case.teeth
        for _ in range(3):
            axis = self.axis(row)
            ahead = (np.arctan2(x - axis[..., 0], y - axis[..., 1]) - self.angle(begin)) % pitch
            row = begin + ahead / pitch * self.steps
        off = np.hypot(x - axis[..., 0], y - axis[..., 1])
        across = np.clip(off - self.case.flat, 0.0, self.case.corner)
        edge = axis[..., 2] + self.case.corner - np.sqrt(self.case.corner**2 - across**2)
        cells = self.stock.z[columns, rows]
        np.minimum(cells, edge, out=cells, where=off <= self.case.radius)


def compared(truecut, folder, case: Case, grid: float = GRID_MM, steps: int = STEPS, cell: float = CELL_MM) -> tuple:
    """Means over tooth periods of the program and of heights, N, from the first cut on."""
    table = pq.read_table(truecut.record(case.write(folder, grid, steps)))
    column = {name: table[name].to_numpy() for name in table.column_names}
    tip, force = (
        np.stack([column[f"path_milling.{name}_{axis}"] for axis in "xyz"], axis=-1) for name in ("position", "force")
    )
    first = max(np.flatnonzero(column["path_milling.teeth_in_cut"] > 0)[0] - 2 * steps, 0)
    expected = Cut(case, column["time"][first:], tip[first:] * 1e3, steps, cell).forces()
    count = len(expected)
    return force[first : first + count * steps].reshape(count, steps, 3).mean(axis=1), expected


@pytest.mark.parametrize("seed", [4, 7])
def test_crosscheck_forces_of_round_cutters_around_a_corner_against_heights(truecut, tmp_path, seed):
    """Means over tooth periods within 2 % of the largest: out of a hole, along a slot, round a drawn corner."""
    case = Case.drawn(seed)
    found, expected = compared(truecut, tmp_path, case)
    size = np.linalg.norm(expected, axis=1).max()
    assert size > 5.0, "nothing is cut"
    apart = np.linalg.norm(found - expected, axis=1).max() / size
    kind = "ball" if case.flat == 0.0 else "bull nose"
    FIGURES.append(f"path milling round a corner, {kind}: means over a tooth {apart:.2%} of the largest apart")
    assert apart < 0.02
