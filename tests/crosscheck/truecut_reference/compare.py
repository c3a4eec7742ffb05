"""Holds a recording against the reference: quantity by quantity, and stick and slip by their times.

A vector is compared as one quantity, so that a component which hardly moves is not judged by its own noise. Of the two
relative measures, `nrmse` (root mean square distance over the range of the reference, of a vector the diagonal of the
box its components span) is the project's NRMSE; `relative_rms` (over the reference's RMS) is given beside it.
"""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.parquet

from .profile import Profile
from .simulate import EVENT_S, Result
from .wheel import Command

EVENT_TOLERANCE_S = 2e-3
RMS_AFTER_TOLERANCE = 0.03
# an event whose length is this near to the 3 ms from which events count may be counted by one side only
EVENT_MARGIN_S = 1e-3

VECTORS = {
    "tool.displacement": ("tool.displacement_x", "tool.displacement_y", "tool.displacement_z"),
    "tool.deflection": ("tool.deflection_x", "tool.deflection_y", "tool.deflection_z"),
    "tool.velocity": ("tool.velocity_x", "tool.velocity_y", "tool.velocity_z"),
    "cutting.force": ("cutting.force_x", "cutting.force_y", "cutting.force_z"),
    "milling.force": ("milling.force_x", "milling.force_y", "milling.force_z"),
    "dynamometer.force": ("dynamometer.force_x", "dynamometer.force_y", "dynamometer.force_z"),
    "foot.friction": ("foot.friction_y", "foot.friction_z"),
    "load.force": ("load.force_x", "load.force_y", "load.force_z"),
}
SCALARS = (
    "foot.normal_force",
    "cutting.depth",
    "cutting.engaged_depth",
    "cutting.chip_area",
    "cutting.torque",
    "wheel.normal_force",
    "wheel.friction_force",
    "wheel.indentation",
    "wheel.position",
)


@dataclass
class Recording:
    """What truecut wrote: a time base, channels, named results, profiles on the workpiece."""

    time_s: np.ndarray
    channels: dict[str, np.ndarray]
    scalars: dict[str, float]
    profiles: dict[str, Profile]

    @staticmethod
    def read(path: Path) -> Recording:
        """Reads a Parquet recording."""
        with pyarrow.parquet.ParquetFile(path) as file:
            table = file.read()
            metadata = file.metadata.metadata or {}
        if b"truecut.ending" not in metadata:
            raise ValueError(f"{path} is no recording of a run that ended")
        ending = json.loads(metadata[b"truecut.ending"])
        columns = {name: table[name].to_numpy() for name in table.column_names}
        scalars = {s["name"]: s["value"] for s in ending["scalars"]}
        profiles = {p["name"]: Profile(np.array(p["axis"]), np.array(p["values"])) for p in ending["profiles"]}
        return Recording(columns.pop("time"), columns, scalars, profiles)

    @staticmethod
    def of_result(result: Result) -> Recording:
        """A reference run in a recording's clothes, all channels on the state's time base."""
        time_s = result.state_time_s
        channels = {n: np.interp(time_s, result.time_of(n), v) for n, v in result.channels.items()}
        return Recording(time_s, channels, result.scalars, result.profiles)

    def command(self) -> Command:
        """The commanded joint coordinates."""
        names = [f"joint{n}.command" for n in range(1, len(self.channels) + 1) if f"joint{n}.command" in self.channels]
        return Command(self.time_s, np.array([self.channels[name] for name in names]).T)


@dataclass
class Distance:
    """How far a quantity of the recording is from the reference within a window."""

    nrmse: float
    relative_rms: float
    rms_ratio: float
    largest: float

    def as_dict(self) -> dict[str, float]:
        """For JSON."""
        return dict(vars(self))


def distance(reference: Result, recording: Recording, names, rows: np.ndarray) -> Distance:
    """Distance of the channels `names`, taken as one vector, over the recording's rows `rows` (mask)."""
    time_s = recording.time_s[rows]
    expected = np.array([np.interp(time_s, reference.time_of(n), reference.channels[n]) for n in names])
    found = np.array([recording.channels[n][rows] for n in names])
    error = math.sqrt(float(np.mean(np.sum((found - expected) ** 2, axis=0))))
    diagonal = math.sqrt(float(np.sum(np.ptp(expected, axis=1) ** 2)))
    own = math.sqrt(float(np.mean(np.sum(expected**2, axis=0))))
    others = math.sqrt(float(np.mean(np.sum(found**2, axis=0))))
    return Distance(
        nrmse=_quotient(error, diagonal),
        relative_rms=_quotient(error, own),
        rms_ratio=_quotient(others, own),
        largest=float(np.max(np.abs(found - expected))),
    )


def _quotient(a: float, b: float) -> float:
    if a == b == 0.0:
        return 0.0
    return a / b if b > 0.0 else math.inf


def quantities(reference: Result, recording: Recording) -> dict[str, tuple[str, ...]]:
    """The quantities both sides have: vectors, scalars, each component, each joint."""
    both = [n for n in reference.channels if n in recording.channels]
    found: dict[str, tuple[str, ...]] = {}
    for name, parts in VECTORS.items():
        if all(p in both for p in parts):
            found[name] = parts
    for name in both:
        if name in SCALARS or name.startswith("joint"):
            found[name] = (name,)
    return found


def profile_distance(reference: Profile, found: Profile) -> dict[str, float]:
    """Means of both, and the root mean square distance over the mean of the reference."""
    expected = reference.at(found.axis)
    mean = float(expected.mean())
    error = math.sqrt(float(np.mean((found.values - expected) ** 2)))
    return {
        "reference_mean": mean,
        "recording_mean": float(found.values.mean()),
        "relative_rms": _quotient(error, mean),
    }


# -- stick and slip --------------------------------------------------------------------------------------------


def events(time_s: np.ndarray, sliding: np.ndarray, shortest_s: float = EVENT_S) -> list[tuple[str, float, float]]:
    """Stick and slip intervals ("slip", start, end); what is shorter than `shortest_s` joins its surroundings.

    The shortest interval is removed first, until none is too short.
    """
    state = np.asarray(sliding) > 0.5
    marks = np.flatnonzero(np.diff(state.astype(np.int8)))
    bounds = [float(time_s[0]), *(0.5 * (time_s[marks] + time_s[marks + 1])).tolist(), float(time_s[-1])]
    kinds = [bool(state[0])] + [bool(state[m + 1]) for m in marks]
    while len(kinds) > 1:
        lengths = [b - a for a, b in itertools.pairwise(bounds)]
        worst = min(range(len(kinds)), key=lengths.__getitem__)
        if lengths[worst] >= shortest_s:
            break
        if worst == 0:
            del kinds[0], bounds[1]
        elif worst == len(kinds) - 1:
            del kinds[-1], bounds[-2]
        else:
            del kinds[worst : worst + 2], bounds[worst : worst + 2]
    return [("slip" if k else "stick", a, b) for k, a, b in zip(kinds, bounds, bounds[1:])]


def same_events(time_a, sliding_a, time_b, sliding_b, tolerance_s: float = EVENT_TOLERANCE_S) -> dict:
    """Whether both sides stick and slip at the same times; the largest difference of a matched time in seconds.

    Both sides are first taken with the same shortest event; if their lists differ in length, one side's
    limit may differ by `EVENT_MARGIN_S`, since an event of almost 3 ms may fall on either side of it.
    """
    steps = (0.0, -0.25, 0.25, -0.5, 0.5, -0.75, 0.75, -1.0, 1.0)
    trials = [(EVENT_S, EVENT_S + s * EVENT_MARGIN_S) for s in steps]
    trials += [(b, a) for a, b in trials[1:]]
    best = None
    for shortest_a, shortest_b in trials:
        a, b = events(time_a, sliding_a, shortest_a), events(time_b, sliding_b, shortest_b)
        same = [e[0] for e in a] == [e[0] for e in b]
        apart = max((abs(x[1] - y[1]) for x, y in zip(a[1:], b[1:])), default=0.0) if same else math.inf
        if best is None or apart < best["largest_difference_s"]:
            best = {
                "same": same and apart <= tolerance_s,
                "largest_difference_s": apart,
                "reference": a,
                "recording": b,
            }
        if best["same"]:
            break
    return best


# -- the whole -------------------------------------------------------------------------------------------------


def left_cut_s(recording: Recording, ramp_s: float) -> float | None:
    """When an edge of the recorded run first had no chip during the ramp."""
    area = recording.channels.get("cutting.chip_area")
    if area is None:
        return None
    # the first row may lie before the first evaluation
    rows = np.flatnonzero((area <= 0.0) & (recording.time_s < ramp_s))
    rows = rows[rows > 1]
    return float(recording.time_s[rows[0]]) if len(rows) else None


def sliding_rows(recording: Recording) -> np.ndarray:
    """Rows within the recorded run's slip events; none without a foot."""
    rows = np.zeros(len(recording.time_s), bool)
    if "foot.sliding" not in recording.channels:
        return rows
    for kind, start, end in events(recording.time_s, recording.channels["foot.sliding"]):
        if kind == "slip":
            rows |= (recording.time_s >= start) & (recording.time_s <= end)
    return rows
