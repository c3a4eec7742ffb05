"""Ball and bull-nose cutters against a stock of heights on a fine grid, and against mean forces of the literature.

The motion of the tip is the recording's, vibration included. The heights know nothing of earlier passes, of distances or of layers:
teeth lower them, sector by sector, and the chip of a piece of an edge is what of a level ray up to it stands higher than it does.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np
import pyarrow.parquet as pq
import pytest

from conftest import FIGURES, ROOT

SCENARIO = ROOT / "scenarios" / "milling" / "pocket.toml"
STEP_MS = 0.0625
RADIUS_M = 6e-3
HOLE_M = 6.5e-3
TEETH = 2
SPIN_RAD_S = 12000 / 60 * math.tau
K_T, K_R, K_A = 600e6, 200e6, 150e6
FEED_M = 20e-3 * 60 / 12000 / TEETH
CORNER_M = np.array([-1e-3, -7e-3])
SIZE_M = np.array([23e-3, 19e-3])
CELL_M = 10e-6
# level chips of an edge that sinks are long near its tip
REACH_M = 0.4e-3
SAMPLE_M = 5e-6
ALONG = -SAMPLE_M * (np.arange(round(REACH_M / SAMPLE_M)) + 0.5)
PIECES = 32
PARTS = 2
BEHIND_RAD = 1.0


class Heights:
    """The stock from above: how high it stands at the middles of cells."""

    def __init__(self, corner_radius_m: float) -> None:
        self.corner, self.end = corner_radius_m, RADIUS_M - corner_radius_m
        self.count = np.rint(SIZE_M / CELL_M).astype(int)
        self.height = np.zeros(self.count)
        x, y = (CORNER_M[axis] + CELL_M * (np.arange(self.count[axis]) + 0.5) for axis in range(2))
        self.height[x[:, None] ** 2 + y[None, :] ** 2 < HOLE_M**2] = -1.0

    def index(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cells = ((places - CORNER_M) * (1 / CELL_M)).astype(np.int32)
        return np.clip(cells[..., 0], 0, self.count[0] - 1), np.clip(cells[..., 1], 0, self.count[1] - 1)

    def pieces(self, depth_m: float) -> tuple[np.ndarray, np.ndarray]:
        """κ of the corner's pieces below the stock's top, and their angle."""
        last = math.acos(1.0 - min(depth_m / self.corner, 1.0))
        return last * (np.arange(PIECES) + 0.5) / PIECES, np.full(PIECES, last / PIECES)

    def force(self, place: np.ndarray, angle: float) -> np.ndarray:
        """Of one straight edge on the tool, frame of the path."""
        depth_m = -place[2]
        if depth_m <= 0.0:
            return np.zeros(3)
        kappa, width = self.pieces(depth_m)
        rho = self.end + self.corner * np.sin(kappa)
        z = place[2] + self.corner * (1.0 - np.cos(kappa))
        out = np.array([math.sin(angle), math.cos(angle)])
        # level rays, inwards from the edge, no further than to the flat end
        along = rho[:, None] + ALONG[None, :]
        rays = place[:2] + along[..., None] * out
        stands = (self.height[self.index(rays)] > z[:, None]) & (along > self.end)
        chip = stands.sum(axis=1) * SAMPLE_M * np.sin(kappa)
        area = chip * self.corner * width
        tangential, radial, axial = K_T * area, K_R * area, K_A * area
        inward = (radial * np.sin(kappa) - axial * np.cos(kappa)).sum()
        upward = (radial * np.cos(kappa) + axial * np.sin(kappa)).sum()
        t = tangential.sum()
        return np.array([-t * out[1] - inward * out[0], t * out[0] - inward * out[1], upward])

    def sweep(self, before: tuple[np.ndarray, float], now: tuple[np.ndarray, float]) -> None:
        """Lowers what lies between two places of an edge to the body about the axis between."""
        axis = 0.5 * (before[0] + now[0])
        if axis[2] >= 0.0:
            return
        rise = min(-axis[2], self.corner)
        rim = self.end + math.sqrt(self.corner**2 - (self.corner - rise) ** 2) + CELL_M
        fine = 0.6 * CELL_M
        # what lies further in has been lowered before, when it lay there
        rho = np.arange(max(0.0, self.end - 0.3e-3), rim, fine)
        turned = now[1] - before[1]
        angle = before[1] + turned * np.linspace(0.0, 1.0, max(2, math.ceil(rim * turned / fine)))
        places = axis[:2] + rho[:, None, None] * np.stack((np.sin(angle), np.cos(angle)), axis=-1)
        column, row = self.index(places)
        x, y = CORNER_M[0] + CELL_M * (column + 0.5), CORNER_M[1] + CELL_M * (row + 0.5)
        beyond = np.maximum(np.hypot(x - axis[0], y - axis[1]) - self.end, 0.0)
        body = axis[2] + self.corner - np.sqrt(np.maximum(self.corner**2 - beyond**2, 0.0))
        self.height[column, row] = np.minimum(self.height[column, row], body)


def forces(corner_radius_m: float, time_s: np.ndarray, tip_m: np.ndarray) -> np.ndarray:
    """Mean forces of the steps about these times, N, by the linear-edge law without edge forces; the stock's top is at 0."""
    stock = Heights(corner_radius_m)
    found = np.zeros_like(tip_m)
    dt = time_s[1] - time_s[0]
    rays: list[deque[tuple[np.ndarray, float]]] = [deque() for _ in range(TEETH)]
    for row in range(1, len(time_s) - 1):
        for part in range(PARTS):
            ahead = (part + 0.5) / PARTS - 0.5
            other = tip_m[row + 1] if ahead > 0 else tip_m[row - 1]
            place = tip_m[row] + abs(ahead) * (other - tip_m[row])
            for tooth in range(TEETH):
                angle = SPIN_RAD_S * (time_s[row] + ahead * dt) - math.tau / TEETH * tooth
                found[row] += stock.force(place, angle) / PARTS
                now = (place, angle)
                rays[tooth].append(now)
                # cells near the tip are wide in angle: a tooth would find what it has just lowered itself
                while angle - rays[tooth][0][1] > BEHIND_RAD:
                    stock.sweep(rays[tooth].popleft(), rays[tooth][0])
    return found


def slot_mean_n(corner_radius_m: float, depth_m: float) -> np.ndarray:
    """Mean force of a slot by quadrature: Lee and Altintas (1996) for a ball, Engin and Altintas (2001) for a bull nose, with
    their axial force, which points down to the tip, turned round. A chip c sin φ sin κ wide dz/sin κ; depth within the corner.
    """
    last = math.acos(1.0 - depth_m / corner_radius_m)
    kappa = last * (np.arange(2000) + 0.5)[:, None] / 2000
    phi = math.pi * (np.arange(720) + 0.5)[None, :] / 720
    area = FEED_M * np.sin(phi) * np.sin(kappa) * corner_radius_m * last / 2000 * TEETH / 720 / 2
    t, r, a = K_T * area, K_R * area, -K_A * area
    x = -r * np.sin(phi) * np.sin(kappa) - t * np.cos(phi) - a * np.sin(phi) * np.cos(kappa)
    y = -r * np.cos(phi) * np.sin(kappa) + t * np.sin(phi) - a * np.cos(phi) * np.cos(kappa)
    z = r * np.cos(kappa) - a * np.sin(kappa)
    return np.array([one.sum() for one in (x, y, z)])


@pytest.mark.parametrize(("corner_mm", "until_s"), [(6.0, 1.7), (2.5, 1.5)])
def test_crosscheck_forces_of_round_cutters_around_a_corner(truecut, corner_mm, until_s):
    """Means over tooth periods within 2 % of the largest; along the slot those of the literature, too."""
    changes = {
        "process.path_milling.cutter.corner_radius_mm": corner_mm,
        "process.path_milling.cutter.helix_deg": 0,
        "process.path_milling.cutting.axial_mpa": K_A * 1e-6,
        "run.time_step_ms": STEP_MS,
        "run.record_interval_ms": STEP_MS,
        "run.duration_s": until_s,
    }
    table = pq.read_table(truecut.record(SCENARIO, changes))
    column = {name: table[name].to_numpy() for name in table.column_names}
    tip = np.stack([column[f"path_milling.position_{axis}"] for axis in "xyz"], axis=-1)
    force = np.stack([column[f"path_milling.force_{axis}"] for axis in "xyz"], axis=-1)
    first, last = np.flatnonzero(column["path_milling.teeth_in_cut"] > 0)[0] - 100, len(force) - 1
    expected = forces(corner_mm * 1e-3, column["time"][first:last], tip[first:last])
    force, tip = force[first:last], tip[first:last]
    period = round(60 / 12000 / TEETH * 1e3 / STEP_MS)
    count = len(force) // period
    mean, model, place = (one[: count * period].reshape(count, period, 3).mean(axis=1) for one in (force, expected, tip))
    size = np.linalg.norm(model, axis=1).max()
    assert size > 2.0, "nothing is cut"
    apart = np.linalg.norm(mean - model, axis=1).max() / size
    cut = np.linalg.norm(model[:, :2], axis=1) > 0.5 * size * 0.7
    turned = np.abs(np.diff(np.unwrap(np.arctan2(*model[cut, :2].T)))).sum()
    assert turned > 1.0, "no corner was passed"
    # a slot at the commanded feed, behind the hole and before the corner
    slot = (place[:, 0] > 9.5e-3) & (place[:, 0] < 12.0e-3) & (np.abs(place[:, 1]) < 0.1e-3)
    assert slot.sum() > 20
    literature = slot_mean_n(corner_mm * 1e-3, -place[slot, 2].mean())
    off = np.linalg.norm(mean[slot].mean(axis=0) - literature) / np.linalg.norm(literature)
    FIGURES.append(f"corner radius {corner_mm} mm round a corner: heights {apart:.2%} of the largest apart, slot of the literature {off:.2%}")
    assert apart < 0.02
    assert off < 0.02
