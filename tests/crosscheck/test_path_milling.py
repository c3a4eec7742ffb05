"""Forces of a pocket against a model of its own: the stock as cells of some micrometres, teeth as rays that empty them.

The motion of the tip is the recording's, vibration included; what is held against each other is what the teeth meet, hence the
force. The cells know nothing of earlier passes, of distances or of layers.
"""

from __future__ import annotations

import math

import numpy as np
import pyarrow.parquet as pq

from conftest import FIGURES, ROOT

SCENARIO = ROOT / "scenarios" / "milling" / "pocket.toml"
STEP_MS = 0.0625
RADIUS_M = 6e-3
HOLE_M = 6.5e-3
SPIN_RAD_S = 12000 / 60 * math.tau
K_T, K_R = 600e6, 200e6
CORNER_M = np.array([-15e-3, -12e-3])
SIZE_M = np.array([50e-3, 40e-3])
CELL_M = 5e-6
# along a ray, inwards from the tip: thicker chips there are none
REACH_M = 0.159e-3
SAMPLE_M = 3e-6
ALONG = RADIUS_M - REACH_M + SAMPLE_M * (np.arange(round(REACH_M / SAMPLE_M)) + 0.5)
PARTS = 4


class Cells:
    """The stock from above: cells are full, or their middles have been swept."""

    def __init__(self) -> None:
        shape = np.rint(SIZE_M / CELL_M).astype(int)
        self.full = np.ones(shape, dtype=bool)
        self.x, self.y = (CORNER_M[axis] + CELL_M * (np.arange(shape[axis]) + 0.5) for axis in range(2))
        near = np.flatnonzero(np.abs(self.x) < HOLE_M)
        self.full[near] = self.x[near, None] ** 2 + self.y[None, :] ** 2 > HOLE_M**2

    def chip_m(self, axis: np.ndarray, out: np.ndarray) -> float:
        """Material along a ray up to the tip."""
        index = ((axis + ALONG[:, None] * out - CORNER_M) * (1 / CELL_M)).astype(np.int32)
        return self.full[index[:, 0], index[:, 1]].sum() * SAMPLE_M

    def sweep(self, rays: list[tuple[np.ndarray, np.ndarray]]) -> None:
        """Empties what lies between two rays, up to the rim about the axis between."""
        ends = np.array([axis + reach * out for axis, out in rays for reach in (RADIUS_M - REACH_M, RADIUS_M)])
        low, high = ((np.array(place) - CORNER_M) / CELL_M for place in (ends.min(axis=0), ends.max(axis=0)))
        columns, rows = (slice(int(low[k]) - 1, int(high[k]) + 3) for k in range(2))
        x, y = self.x[columns, None], self.y[None, rows]
        axis = 0.5 * (rays[0][0] + rays[1][0])
        swept = (x - axis[0]) ** 2 + (y - axis[1]) ** 2 < RADIUS_M**2
        # a tooth moves along (out_y, -out_x): ahead of the first ray and behind the second
        for (axis, out), sign in zip(rays, (1.0, -1.0)):
            swept &= sign * ((x - axis[0]) * out[1] - (y - axis[1]) * out[0]) >= 0.0
        self.full[columns, rows] &= ~swept


def forces(time_s: np.ndarray, tip_m: np.ndarray) -> np.ndarray:
    """Mean forces of the steps about these times, N, by the linear-edge law without edge forces; the stock's top is at 0."""
    cells = Cells()
    depth_m, tip_m = -tip_m[:, 2], tip_m[:, :2]
    found = np.zeros_like(tip_m)
    dt = time_s[1] - time_s[0]
    before: list[tuple[np.ndarray, np.ndarray] | None] = [None, None]
    for row in range(1, len(time_s) - 1):
        for part in range(PARTS):
            ahead = (part + 0.5) / PARTS - 0.5
            other = tip_m[row + 1] if ahead > 0 else tip_m[row - 1]
            axis = tip_m[row] + abs(ahead) * (other - tip_m[row])
            for tooth in range(2):
                angle = SPIN_RAD_S * (time_s[row] + ahead * dt) - math.pi * tooth
                sin, cos = math.sin(angle), math.cos(angle)
                ray = (axis, np.array([sin, cos]))
                area = cells.chip_m(*ray) * depth_m[row] / PARTS
                tangential, radial = K_T * area, K_R * area
                found[row] += np.array([-tangential * cos - radial * sin, tangential * sin - radial * cos])
                if before[tooth] is not None:
                    cells.sweep([before[tooth], ray])
                before[tooth] = ray
    return found


def test_crosscheck_forces_around_a_corner_against_cells(truecut):
    """Means over tooth periods within 2 % of the largest: into the stock from a hole, along a slot, round a right corner."""
    changes = {
        "process.path_milling.cutter.helix_deg": 0,
        "run.time_step_ms": STEP_MS,
        "run.record_interval_ms": STEP_MS,
        "run.duration_s": 1.9,
    }
    table = pq.read_table(truecut.record(SCENARIO, changes))
    column = {name: table[name].to_numpy() for name in table.column_names}
    tip = np.stack([column[f"path_milling.position_{axis}"] for axis in "xyz"], axis=-1)
    force = np.stack([column[f"path_milling.force_{axis}"] for axis in "xy"], axis=-1)
    # from the hole on, in which the tool comes down
    first, last = np.flatnonzero(column["path_milling.teeth_in_cut"] > 0)[0] - 100, len(force) - 1
    expected = forces(column["time"][first:last], tip[first:last])
    force = force[first:last]
    period = round(60 / 12000 / 2 * 1e3 / STEP_MS)
    count = len(force) // period
    mean = [one[: count * period].reshape(count, period, 2).mean(axis=1) for one in (force, expected)]
    size = np.abs(mean[1]).max()
    assert size > 5.0, "nothing is cut"
    apart = np.abs(mean[0] - mean[1]).max() / size
    turned = np.abs(np.diff(np.arctan2(*mean[1][np.linalg.norm(mean[1], axis=1) > 0.5 * size].T))).sum()
    assert turned > 1.0, "no corner was passed"
    FIGURES.append(f"path milling round a corner: means over a tooth {apart:.2%} of the largest apart")
    assert apart < 0.02
