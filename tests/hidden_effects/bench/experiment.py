"""The bench's scenarios, and one run of each in MuJoCo as sampled outputs; runs are kept on disk."""

from __future__ import annotations

import functools
import hashlib
import json
import math
import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from truecut_reference import scenario as scenario_file
from truecut_reference.scenario import Replay

from . import ROOT, belting, brushing, machining, motion, polishing, sensors
from .arm import Arm
from .effects import Effect

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

HERE = Path(__file__).resolve().parent
SCENARIOS = HERE.parent / "scenarios"
CACHE = Path(os.environ.get("TRUECUT_HIDDEN_CACHE", ROOT / "target" / "hidden_effects" / "cache"))
SI_OF = {"deg": math.pi / 180.0, "N m": 1.0, "N": 1.0, "um": 1e-6, "mm": 1e-3, "rad": 1.0, "mm^3": 1e-9}


@dataclass(frozen=True)
class Column:
    """One column of the data."""

    name: str
    channel: str
    unit: str
    is_input: bool

    @property
    def si(self) -> float:
        """SI value of one unit of the column."""
        return SI_OF[self.unit]


@dataclass(frozen=True)
class Experiment:
    """One scenario of the bench with how it is measured.

    `band_hz`: what the experiment moves lies below. `reference_noise`: RMS in band of an ordinary sensor, by output.
    """

    name: str
    rate_hz: float
    duration_s: float
    step_s: float
    band_hz: float
    reference_noise: tuple[float, ...]
    # says nothing of a run, only how often it is measured
    passes: int = field(default=1, repr=False)

    @property
    def path(self) -> Path:
        """The scenario file."""
        return SCENARIOS / f"{self.name}.toml"

    @functools.cached_property
    def table(self) -> dict:
        """The scenario file, parsed."""
        return tomllib.loads(self.path.read_text(encoding="utf-8"))

    @functools.cached_property
    def columns(self) -> list[Column]:
        """Columns of the data, without the time."""
        rows = self.table["data"]["channel"]
        return [Column(r["column"], r["channel"], r["unit"], r.get("role") == "input") for r in rows]

    @property
    def outputs(self) -> list[Column]:
        """Columns that are compared."""
        return [column for column in self.columns if not column.is_input]

    @functools.cached_property
    def uncertain(self) -> dict[str, float]:
        """Nominal parameters that may be refitted: key, one standard deviation as a part of the value."""
        return {row["key"]: row["relative"] for row in self.table["uncertain"]}

    def nominal_value(self, key: str) -> float:
        """What the file says of a key; the scales of the robot are 1 where it is silent."""
        found = self.table
        for part in key.split("."):
            found = found.get(part, {}) if isinstance(found, dict) else {}
        return found if isinstance(found, (int, float)) else 1.0

    @functools.cached_property
    def pass_time_s(self) -> np.ndarray:
        """Times of the samples of one pass."""
        return np.arange(round(self.duration_s * self.rate_hz) + 1) / self.rate_hz

    @functools.cached_property
    def time_s(self) -> np.ndarray:
        """Times of the samples, pass after pass."""
        return np.arange(self.passes * self.pass_time_s.size) / self.rate_hz

    def seen(self, outputs: np.ndarray) -> np.ndarray:
        """What counts of outputs (SI, a row per sample) when it is asked how much shows."""
        return outputs

    def command(self) -> np.ndarray | None:
        """Commanded joint coordinates at the samples, a row per instant; None where the process has its own."""
        return motion.commands(self.name, self.time_s) if "replay" in self.table["process"] else None

    def outputs_of(
        self, effects: tuple[Effect, ...] = (), shifts: tuple[float, ...] = (), standing_still: float | None = None
    ) -> np.ndarray:
        """True outputs (SI, a row per sample), with the uncertain parameters shifted by so many deviations.

        `standing_still` scales the commanded motion down to that part of it. Every pass starts afresh.
        """
        one = self._one_pass(effects, shifts, standing_still)
        return np.concatenate([one] * self.passes)

    def _one_pass(self, effects: tuple[Effect, ...], shifts: tuple[float, ...], standing_still: float | None):
        shifts = shifts or (0.0,) * len(self.uncertain)
        what = {"effects": [e.as_dict() for e in effects], "shifts": shifts, "still": standing_still}
        key = json.dumps(what, sort_keys=True) + str(self) + _sources(self.path)
        path = CACHE / f"{self.name}-{hashlib.sha256(key.encode()).hexdigest()[:20]}.npy"
        if path.exists():
            return np.load(path)
        found = self._run(effects, shifts, standing_still)
        path.parent.mkdir(parents=True, exist_ok=True)
        written = path.with_suffix(f".{os.getpid()}.tmp.npy")
        np.save(written, found)
        written.replace(path)
        return found

    def _run(self, effects, shifts, standing_still) -> np.ndarray:
        overrides = {
            key: self.nominal_value(key) * (1.0 + relative * shift)
            for (key, relative), shift in zip(self.uncertain.items(), shifts)
        }
        physical = [e for e in effects if not sensors.is_sensor(e)]
        for name, led in (("polish", polishing), ("belt", belting), ("brush", brushing)):
            if name in self.table["process"]:
                times, channels = led.run(self.path, overrides, physical, self.step_s)
                return self._measured(times, channels, effects)
        scenario = scenario_file.load(self.path, overrides)
        if isinstance(scenario.process, Replay):
            command = self.command()
            if standing_still is not None:
                command = command[0] + standing_still * (command - command[0])
            arm = Arm(scenario.robot, physical, self.time_s, command, self.step_s)
            time_s, channels = arm.run(every=1)
            times = dict.fromkeys(channels, time_s)
        else:
            result = machining.run(scenario, physical, self.step_s)
            channels = result.channels
            times = {name: result.time_of(name) for name in channels}
        return self._measured(times, channels, effects)

    def _measured(self, times: dict[str, np.ndarray], channels: dict[str, np.ndarray], effects) -> np.ndarray:
        outputs = []
        for column in self.outputs:
            of_channel = sensors.of_channel(effects, column.channel)
            t, values = times[column.channel], channels[column.channel]
            outputs.append(sensors.measured(t, values, of_channel, self.pass_time_s))
        return np.stack(outputs, axis=1)


@dataclass(frozen=True)
class DrawnExperiment(Experiment):
    """An experiment whose scenario was drawn."""

    folder: str = field(default="", repr=False)

    @property
    def path(self) -> Path:
        """The scenario file."""
        return Path(self.folder) / f"{self.name}.toml"

    def __str__(self) -> str:
        # runs are kept by this; what its sensors err by says nothing of a run
        return f"{self.name} {self.rate_hz} {self.duration_s} {self.step_s}"


@functools.cache
def _sources(scenario: Path) -> str:
    """Hash of everything that a run depends on besides its arguments."""
    robots = sorted((ROOT / "assets" / "robots").glob("*/robot.*"))
    reference = sorted((ROOT / "tests" / "crosscheck" / "truecut_reference").glob("*.py"))
    names = ("arm", "belting", "brushing", "hidden_joints", "joint_law", "led_way", "machining", "motion", "polishing", "sensors")
    mine = [HERE / f"{m}.py" for m in names]
    found = hashlib.sha256()
    # a belt's path job and face and a brush's taught postures stand beside their scenarios
    beside = [*SCENARIOS.glob("belt_*.toml"), *SCENARIOS.glob("*.csv")]
    for path in [*robots, *reference, *mine, scenario, *sorted(beside)]:
        found.update(path.read_bytes())
    return found.hexdigest()


# Samples nearer to a jump than so many are not counted.
BESIDE = 1.5


class Milled(Experiment):
    """A cut of straight edges, whose force jumps where a tooth enters or leaves."""

    @property
    def tooth_period_s(self) -> float:
        """From one tooth to the next."""
        cut = self.table["process"]["milling"]
        return 60.0 / (cut["spindle_rpm"] * cut["cutter"]["teeth"])

    def beside_jumps(self) -> np.ndarray:
        """Samples within one and a half of where a tooth enters or leaves."""
        cut = self.table["process"]["milling"]
        reached = math.acos(2.0 * cut["radial_depth_mm"] / cut["cutter"]["diameter_mm"] - 1.0)
        angles = (0.0, math.pi - reached) if cut["engagement"] == "up" else (reached, math.pi)
        beside = np.zeros(self.time_s.size, dtype=bool)
        for angle in angles:
            first_s = (angle - math.radians(cut.get("start_angle_deg", 0.0))) / (cut["spindle_rpm"] * math.pi / 30.0)
            since = np.mod(self.time_s - first_s, self.tooth_period_s)
            beside |= np.minimum(since, self.tooth_period_s - since) < BESIDE / self.rate_hz
        return beside

    def seen(self, outputs: np.ndarray) -> np.ndarray:
        """Forces with lines in the place of samples beside jumps: what a deflection moves there, by the moment at which a
        tooth leaves, is many times what it changes elsewhere, and no sensor has it."""
        kept = ~self.beside_jumps()
        bridged = outputs.copy()
        for column in range(2):
            bridged[:, column] = np.interp(self.time_s, self.time_s[kept], outputs[kept, column])
        return bridged


AXIS = Experiment("axis", 250.0, 6.0, 0.25e-3, 30.0, (5e-5, 1.0))
SINGLE_TONE = Experiment("axis_single_tone", 250.0, 6.0, 0.25e-3, 10.0, (5e-5,))
SMALL = Experiment("axis_small", 250.0, 5.0, 0.25e-3, 30.0, (2e-6, 0.05))
TWO_JOINT = Experiment("two_joint", 250.0, 5.0, 0.25e-3, 30.0, (1.0, 0.3, 1e-4))
CHAMFER = Experiment("chamfer", 250.0, 4.0, 0.125e-3, 60.0, (1.0, 1.0, 1e-6), passes=3)
TEETH = Experiment("teeth", 500.0, 3.1, 0.2e-3, 100.0, (0.02, 0.02, 1e-8))
TEETH_THREE = Experiment("teeth_three", 500.0, 3.1, 0.2e-3, 100.0, (0.02, 0.02, 1e-8))
WHEEL = Experiment("wheel", 250.0, 4.4, 0.25e-3, 30.0, (0.1, 5e-7))
POLISH = Experiment("polish", 250.0, 2.4, 1e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
POLISH_FORCE = Experiment("polish_force", 250.0, 2.4, 1e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
BELT = Experiment("belt", 250.0, 2.4, 0.5e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
BELT_FORCE = Experiment("belt_force", 250.0, 2.4, 0.5e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
BRUSH = Experiment("brush", 250.0, 2.4, 1e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
POLISH_EDGE = Experiment("polish_edge", 250.0, 2.4, 1e-3, 30.0, (0.05, 0.05, 3e-13, 1e-6, 1e-6))
# new ones at the end: what is drawn for a case depends on the order
MILL = Milled("mill", 1000.0, 1.5, 0.05e-3, 200.0, (0.5, 0.5, 3e-7))
_MACHINING = (CHAMFER, TEETH, TEETH_THREE, WHEEL, POLISH, POLISH_FORCE, BELT, BELT_FORCE, BRUSH, POLISH_EDGE, MILL)
ALL = {e.name: e for e in (AXIS, SINGLE_TONE, SMALL, TWO_JOINT, *_MACHINING)}
