"""Milling machines drawn at random: one slide that gives way along the feed, a cutter, a cut, and what may hide in it.

A machine is kept if the reference cuts steadily on it, as it is and with what is hidden: what differs between a tooth
and the next has died away before the end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from . import ROOT
from .cases import LEVELS, Case
from .effects import Effect
from .experiment import ALL, Experiment
from .noise import COLOURS, rms

# Of the URDF's slide: what scales refer to.
MASS_KG, STIFFNESS_N_PER_M, DAMPING_N_S_PER_M = 0.03993, 1.34004965e6, 5.0890039
TRIES = 40
# A mode of the tool moves at most this part of the slide's mass.
HEAVIEST = 0.15
# A steady cut differs from tooth to tooth by less than this part of its deviation, in the last fifth of the run.
STEADY = 0.05

SCENARIO = """name = "Drawn milling machine {seed}"

[robot]
urdf = "{robots}/rig_milling/robot.urdf"
gravity = false
inertia_scale = {inertia:.6g}
stiffness_scale = {stiffness:.6g}
damping_scale = {damping:.6g}

[process.milling]
spindle_rpm = {rpm:.6g}
feed_mm_per_tooth = {feed_mm:.4g}
axial_depth_mm = {depth_mm:.4g}
engagement = "{engagement}"
radial_depth_mm = {radial_mm:.4g}
start_angle_deg = {start_deg:.4g}
ramp_mm = {ramp_mm:.3g}

[process.milling.cutter]
diameter_mm = {diameter_mm:.4g}
teeth = {teeth}

[process.milling.cutting]
tangential_mpa = {tangential_mpa:.5g}
radial_mpa = {radial_mpa:.5g}

[process.milling.path]
direction = [1, 0, 0]
length_mm = {length_mm:.4g}

[run]
duration_s = {duration_s:.4g}

[data]
file = "data.csv"
time = "t_s"

[[data.channel]]
column = "force_x_n"
channel = "milling.force_x"
unit = "N"

[[data.channel]]
column = "force_y_n"
channel = "milling.force_y"
unit = "N"

[[data.channel]]
column = "slide_um"
channel = "joint1.position"
unit = "um"

[[uncertain]]
key = "process.milling.cutting.tangential_mpa"
relative = 0.03

[[uncertain]]
key = "robot.stiffness_scale"
relative = 0.02
"""


@dataclass(frozen=True)
class DrawnMill(Experiment):
    """An experiment whose scenario was drawn."""

    folder: str = field(default="", repr=False)

    @property
    def path(self) -> Path:
        """The scenario file."""
        return Path(self.folder) / f"{self.name}.toml"

    def __str__(self) -> str:
        # runs are kept by this; what its sensors err by says nothing of a run
        return f"{self.name} {self.rate_hz} {self.duration_s} {self.step_s}"


@dataclass(frozen=True)
class Machine:
    """A machine, with what hides in it at a size of 1."""

    experiment: DrawnMill
    tool_mode: Effect
    process_damping: Effect


def draw(seed: int, folder: Path) -> Machine:
    """The machine of a seed; its scenario is written to the folder."""
    for attempt in range(TRIES):
        machine = _draw(np.random.default_rng([seed, attempt]), seed, folder)
        if machine is None:
            continue
        period_s = machine.experiment.tooth_period_s
        hidden = ((), (machine.tool_mode,), (machine.process_damping,))
        try:
            runs = [machine.experiment.outputs_of(effects) for effects in hidden]
        except (RuntimeError, ValueError, FloatingPointError):
            continue
        if all(_is_steady(machine.experiment, run, period_s) for run in runs):
            return _with_noise(machine, runs[0], np.random.default_rng([seed, 77]))
    raise RuntimeError(f"no steady machine in {TRIES} draws of seed {seed}")


@dataclass(frozen=True)
class _Mill(DrawnMill):
    tooth_period_s: float = field(default=0.0, repr=False)


def _draw(rng: np.random.Generator, seed: int, folder: Path) -> Machine | None:
    def log_uniform(low: float, high: float) -> float:
        return float(math.exp(rng.uniform(math.log(low), math.log(high))))

    mass, hz, ratio = log_uniform(20.0, 200.0), log_uniform(8.0, 35.0), rng.uniform(0.02, 0.06)
    omega = 2.0 * math.pi * hz
    stiffness = mass * omega**2
    teeth, tooth_hz = int(rng.integers(2, 6)), log_uniform(10.0, 50.0)
    diameter = float(rng.uniform(10e-3, 25e-3))
    spindle = 2.0 * math.pi * tooth_hz / teeth
    tangential = log_uniform(600e6, 2500e6)
    # of the slide's stiffness, what the chip has
    depth = rng.uniform(0.03, 0.25) * stiffness / tangential
    feed = float(rng.uniform(0.05e-3, 0.15e-3))
    engagement = ("up", "down")[int(rng.integers(2))]
    values = {
        "seed": seed,
        "robots": ROOT / "assets" / "robots",
        "inertia": mass / MASS_KG,
        "stiffness": stiffness / STIFFNESS_N_PER_M,
        "damping": 2.0 * ratio * mass * omega / DAMPING_N_S_PER_M,
        "rpm": 60.0 * tooth_hz / teeth,
        "feed_mm": feed * 1e3,
        "depth_mm": depth * 1e3,
        "engagement": engagement,
        "radial_mm": diameter * rng.uniform(0.2, 0.8) * 1e3,
        "start_deg": rng.uniform(0.0, 360.0),
        "ramp_mm": 0.2 * feed * 1e3,
        "diameter_mm": diameter * 1e3,
        "teeth": teeth,
        "tangential_mpa": tangential / 1e6,
        "radial_mpa": tangential * rng.uniform(0.2, 0.5) / 1e6,
    }
    duration_s = min(max(30.0 / tooth_hz, 1.2), 2.0)
    values |= {"duration_s": duration_s, "length_mm": (duration_s * tooth_hz + 2.0) * feed * 1e3}
    name = f"drawn_mill_{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.toml").write_text(SCENARIO.format(**values), encoding="utf-8")
    rate_hz = 1000.0
    # at rates of 1 kHz what is hidden shows below a fifth of that
    experiment = _Mill(
        name, rate_hz, duration_s, 0.2e-3, 200.0, (1.0, 1.0, 1e-6), folder=str(folder), tooth_period_s=1.0 / tooth_hz
    )
    mode_hz = log_uniform(max(50.0, 2.5 * hz), 250.0)
    mode_ratio = rng.uniform(0.015, 0.06)
    softest = mode_ratio / (tangential * depth)
    # so stiff that it moves a part of the slide's mass
    stiffest = 1.0 / (HEAVIEST * mass * (2.0 * math.pi * mode_hz) ** 2)
    if stiffest > 0.9 * softest:
        return None
    compliance = log_uniform(stiffest, 0.9 * softest)
    mode = {"compliance_m_per_n": compliance, "frequency_hz": mode_hz, "damping_ratio": mode_ratio}
    # as a damper on the slide it is so many times what the slide has
    times = rng.uniform(0.15, 0.8)
    slope = times * 2.0 * ratio * mass * omega * spindle * 0.5 * diameter / depth
    return Machine(
        experiment,
        Effect("tool_mode", None, mode),
        Effect("milling_process_damping", None, {"per_slope_n_per_m": slope}),
    )


def _is_steady(experiment: _Mill, run: np.ndarray, period_s: float) -> bool:
    lag = round(period_s * experiment.rate_hz)
    slide = run[:, 2]
    # the command goes on by as much from tooth to tooth
    apart = slide[lag:] - slide[:-lag]
    last = apart[-max(len(slide) // 5, 2 * lag) :]
    moves = slide - np.polyval(np.polyfit(experiment.time_s, slide, 1), experiment.time_s)
    return bool(np.all(np.isfinite(run)) and np.std(last) < STEADY * np.std(moves))


def _with_noise(machine: Machine, nominal: np.ndarray, rng: np.random.Generator) -> Machine:
    """Sensors with errors of 1 to 4 % of what the forces move, and 0.3 to 1 % of what the slide does beside its feed."""
    t = machine.experiment.time_s
    slide = nominal[:, 2] - np.polyval(np.polyfit(t, nominal[:, 2], 1), t)
    parts = (*rng.uniform(0.01, 0.04, 2), rng.uniform(0.003, 0.01))
    sizes = (*rms(nominal[:, :2] - nominal[:, :2].mean(axis=0)), np.std(slide))
    noise = tuple(float(f"{part * size:.3g}") for part, size in zip(parts, sizes))
    return replace(machine, experiment=replace(machine.experiment, reference_noise=noise))


def cases_of(machine: Machine, seed: int, clean: int) -> list[Case]:
    """Clean sets, and both effects at two levels; every set in another colour of noise."""
    name = machine.experiment.name
    ALL[name] = machine.experiment
    draw_shifts = np.random.default_rng([seed, 3])
    count = len(machine.experiment.uncertain)
    found = []

    def add(family: str, truth: tuple, expected: str, **more) -> None:
        shifts = np.clip(draw_shifts.standard_normal(count), -1.5, 1.5)
        number = len(found)
        colour = COLOURS[(seed + number) % len(COLOURS)]
        shifts = tuple(float(round(x, 3)) for x in shifts)
        found.append(Case(family, name, truth, expected, shifts, colour, seed * 100 + number, **more))

    for k in range(clean):
        add("drawn clean", (), "nothing", noise=(0.5, 1.0, 2.0)[k % 3])
    for effect in (machine.tool_mode, machine.process_damping):
        for level in ("strong", "middle"):
            add(f"drawn {effect.kind} {level}", (effect,), "named", level=LEVELS[level])
    return found
