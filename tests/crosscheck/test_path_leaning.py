"""Forces of a tool that leans more and more against a model of its own: the stock as dexels along y, teeth as lines that shorten them.

The motion of the tip is the recording's, vibration included, the direction of the axis the path's; what is held against each other is
what the teeth meet, hence the force. The dexels know nothing of earlier passes or of distances.
"""

from __future__ import annotations

import math

import numpy as np
import pyarrow.parquet as pq

from conftest import FIGURES, ROOT

SCENARIO = ROOT / "scenarios" / "milling" / "swarf.toml"
STEP_MS = 0.0625
RADIUS_M = 6e-3
SPIN_RAD_S = 12000 / 60 * math.tau
K_T, K_R = 600e6, 200e6
HEIGHT_M, WIDTH_M = 8e-3, 12e-3
# dexels stand on a grid of x and z
CELL_X_M, CELL_Z_M = 20e-6, 0.1e-3
LEVELS = -HEIGHT_M + CELL_Z_M * (np.arange(round(HEIGHT_M / CELL_Z_M)) + 0.5)
# along a ray, inwards from the edge: thicker chips there are none
REACH_M = 0.12e-3
SAMPLE_M = 2e-6
INWARDS = SAMPLE_M * (np.arange(round(REACH_M / SAMPLE_M)) + 0.5)
PARTS = 4


def direction(x_m: float) -> np.ndarray:
    """Where the tool points on the path, up its axis: draft grows by 12 degrees over 50 mm, evenly between points 5 mm apart."""
    points = 5e-3 * np.arange(11)
    draft = math.radians(12) * points / 50e-3
    y, z = np.interp(x_m, points, np.sin(draft)), np.interp(x_m, points, np.cos(draft))
    return np.array([0.0, y, z]) / math.hypot(y, z)


class Dexels:
    """How far the stock reaches down along y, by x and z."""

    def __init__(self, x_m: tuple[float, float]) -> None:
        self.first = x_m[0]
        self.count = round((x_m[1] - x_m[0]) / CELL_X_M)
        self.y = np.zeros((len(LEVELS), self.count))
        self.x = self.first + CELL_X_M * (np.arange(self.count) + 0.5)

    def chips_m(self, ends: np.ndarray, inwards: np.ndarray) -> np.ndarray:
        """Material on the ray at each level, from the edge inwards."""
        places = ends[:, None, :] + INWARDS[None, :, None] * inwards
        at = (places[..., 0] - self.first) / CELL_X_M - 0.5
        index = np.clip(np.floor(at).astype(int), 0, self.count - 2)
        level = np.arange(len(LEVELS))[:, None]
        share = np.clip(at - index, 0.0, 1.0)
        surface = self.y[level, index] * (1 - share) + self.y[level, index + 1] * share
        stands = (places[..., 1] > surface) & (places[..., 0] > 0.0) & (places[..., 1] < WIDTH_M)
        return stands.sum(axis=1) * SAMPLE_M

    def sweep(self, pair: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> None:
        """Shortens what lies between two edges, up to the cylinder about the axis between."""
        (tip_a, axis_a, ends_a), (tip_b, axis_b, ends_b) = pair
        tip, axis = 0.5 * (tip_a + tip_b), axis_a + axis_b
        axis = axis / np.linalg.norm(axis)
        low = np.minimum(ends_a[:, 0], ends_b[:, 0]).min() - CELL_X_M
        high = np.maximum(ends_a[:, 0], ends_b[:, 0]).max() + CELL_X_M
        first, last = (int(np.clip((one - self.first) / CELL_X_M, 0, self.count)) for one in (low, high))
        if first >= last:
            return
        x = self.x[first:last][None, :]
        z = LEVELS[:, None]
        # the larger y at which the cylinder |d|^2 - (d.u)^2 = R^2 is left, d = (x, y, z) - tip
        dx, dz = x - tip[0], z - tip[2]
        u = axis
        a = 1.0 - u[1] ** 2
        b = -u[1] * (dx * u[0] + dz * u[2])
        c = dx**2 + dz**2 - (dx * u[0] + dz * u[2]) ** 2 - RADIUS_M**2
        root = b * b - a * c
        y = tip[1] + (-b + np.sqrt(np.maximum(root, 0.0))) / a
        between = (x >= np.minimum(ends_a[:, :1], ends_b[:, :1])) & (x <= np.maximum(ends_a[:, :1], ends_b[:, :1]))
        cut = between & (root > 0.0)
        part = self.y[:, first:last]
        part[cut] = np.maximum(part, y)[cut]


def edge(tip: np.ndarray, axis: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Where a straight edge meets each level, and the direction outwards: angles from y towards x, turned up with the axis."""
    turned = math.atan2(axis[1], axis[2])
    cos, sin = math.cos(turned), math.sin(turned)
    # the axis leans about x alone
    out = math.sin(angle) * np.array([1.0, 0.0, 0.0]) + math.cos(angle) * np.array([0.0, cos, -sin])
    foot = tip + RADIUS_M * out
    along = (LEVELS - foot[2]) / axis[2]
    return foot + along[:, None] * axis, out


def forces(time_s: np.ndarray, tip_m: np.ndarray, x_m: tuple[float, float]) -> np.ndarray:
    """Mean forces of the steps about these times, N, by the linear-edge law without edge forces."""
    dexels = Dexels(x_m)
    found = np.zeros_like(tip_m)
    dt = time_s[1] - time_s[0]
    before: list[tuple[np.ndarray, np.ndarray, np.ndarray] | None] = [None, None]
    for row in range(1, len(time_s) - 1):
        for part in range(PARTS):
            ahead = (part + 0.5) / PARTS - 0.5
            other = tip_m[row + 1] if ahead > 0 else tip_m[row - 1]
            tip = tip_m[row] + abs(ahead) * (other - tip_m[row])
            axis = direction(tip[0])
            for tooth in range(2):
                angle = (SPIN_RAD_S * (time_s[row] + ahead * dt) - math.pi * tooth) % math.tau
                # only the side towards y cuts
                if not (angle < 1.7 or angle > math.tau - 0.6):
                    before[tooth] = None
                    continue
                ends, out = edge(tip, axis, angle)
                ray = (tip, axis, ends)
                if before[tooth] is not None:
                    area = dexels.chips_m(ends, -out).sum() * CELL_Z_M / axis[2] / PARTS
                    along = np.cross(out, axis)
                    found[row] -= area * (K_T * along + K_R * out)
                    dexels.sweep([before[tooth], ray])
                before[tooth] = ray
    return found


def test_crosscheck_forces_of_a_tool_that_leans_against_dexels(truecut):
    """Means over tooth periods within 2 % of the largest, from the entry on until the tool leans by some degrees."""
    changes = {
        "process.path_milling.cutter.helix_deg": 0,
        "run.time_step_ms": STEP_MS,
        "run.record_interval_ms": STEP_MS,
        "run.duration_s": 2.5,
    }
    table = pq.read_table(truecut.record(SCENARIO, changes))
    column = {name: table[name].to_numpy() for name in table.column_names}
    tip = np.stack([column[f"path_milling.position_{axis}"] for axis in "xyz"], axis=-1)
    force = np.stack([column[f"path_milling.force_{axis}"] for axis in "xyz"], axis=-1)
    first, last = np.flatnonzero(column["path_milling.teeth_in_cut"] > 0)[0] - 100, len(force) - 1
    expected = forces(column["time"][first:last], tip[first:last], (-1e-3, tip[last, 0] + RADIUS_M + 1e-3))
    force = force[first:last]
    period = round(60 / 12000 / 2 * 1e3 / STEP_MS)
    count = len(force) // period
    mean = [one[: count * period].reshape(count, period, 3).mean(axis=1) for one in (force, expected)]
    size = np.abs(mean[1]).max()
    assert size > 5.0, "nothing is cut"
    assert direction(tip[last, 0])[1] > math.sin(math.radians(3)), "the tool does not lean"
    apart = np.abs(mean[0] - mean[1]).max() / size
    FIGURES.append(f"path milling by a tool that leans: means over a tooth {apart:.2%} of the largest apart")
    assert apart < 0.02
