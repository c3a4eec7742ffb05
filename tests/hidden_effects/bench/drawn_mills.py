"""Milling machines drawn at random: one slide that gives way along the feed, a cutter, a cut, and what may hide in it.

Two sorts: slow ones, sampled at 1 kHz, whose tool rings at 50 to 250 Hz and whose flanks damp the slide; and fast ones,
sampled at 10 kHz, with a tool as the literature has them: 400 to 3000 Hz, 5 to 40 N/um, damped by 2 to 5 %.

A machine is kept if the reference cuts steadily on it, as it is and with what is hidden (what differs between a tooth and
the next has died away before the end), and if sensors of a quarter of the ordinary error see what is hidden: the RMS that it
changes, nominal values refitted, samples beside jumps of the force left out, is five times theirs in one channel at least.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import ROOT
from .cases import LEVELS, Case
from .effects import Effect
from .experiment import ALL, DrawnExperiment, Milled
from .noise import COLOURS, rms
from .signature import size_of

# Of the URDF's slide: what scales refer to.
MASS_KG, STIFFNESS_N_PER_M, DAMPING_N_S_PER_M = 0.03993, 1.34004965e6, 5.0890039
TRIES = 40
# A mode of the tool moves at most this part of the slide's mass.
HEAVIEST = 0.15
# A steady cut differs from tooth to tooth by less than this part of its deviation, in the last fifth of the run.
STEADY = 0.05
# No sensor errs by less than this part of what an ordinary one does.
BEST_SENSOR = 0.25
# A strong effect is so many times the noise at least.
LEAST_STRONG = 5.0

SCENARIO = """name = "{name}"

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


# Of a run without a tool mode the reference's step is this part of it: it takes so many steps in the mode's period,
# and in a tooth's, that its error there lies below the noise; without the mode the latter alone are too few by far.
REFINED = 0.05


@dataclass(frozen=True)
class _Mill(Milled, DrawnExperiment):
    refined: float = 1.0

    def __str__(self) -> str:
        return f"{super().__str__()} {self.refined}"

    def _run(self, effects, shifts, standing_still) -> np.ndarray:
        has_mode = any(effect.kind == "tool_mode" for effect in effects)
        if has_mode or self.refined == 1.0:
            return super()._run(effects, shifts, standing_still)
        fine = replace(self, step_s=self.step_s * self.refined, refined=1.0)
        return fine._run(effects, shifts, standing_still)


@dataclass(frozen=True)
class Machine:
    """A machine, with what may hide in it, and by how many deviations its nominal values are off."""

    experiment: _Mill
    hidden: tuple[Effect, ...]
    shifts: tuple[float, ...] = ()

    def of(self, kind: str) -> Effect:
        """What is hidden of a kind."""
        return next(effect for effect in self.hidden if effect.kind == kind)


def draw(seed: int, folder: Path, fast: bool = False) -> Machine:
    """The machine of a seed; its scenario is written to the folder."""
    for attempt in range(TRIES):
        rng = np.random.default_rng([seed, attempt])
        # another name for each attempt: runs and sources are kept by it
        name = f"drawn_mill_{'fast_' * fast}{seed}_{attempt}"
        machine = _draw_fast(rng, name, folder) if fast else _draw(rng, name, folder)
        if machine is None:
            continue
        shifts = np.clip(np.random.default_rng([seed, 3]).standard_normal(2), -1.5, 1.5)
        machine = replace(machine, shifts=tuple(float(round(x, 3)) for x in shifts))
        try:
            nominal = machine.experiment.outputs_of((), machine.shifts)
            if not _is_steady(machine.experiment, nominal):
                continue
            machine = _with_noise(machine, nominal, np.random.default_rng([seed, 77]))
            if all(_is_kept(machine, effect) for effect in machine.hidden):
                return machine
        except (RuntimeError, ValueError, FloatingPointError):
            continue
    raise RuntimeError(f"no steady machine in {TRIES} draws of seed {seed}")


def _is_kept(machine: Machine, effect: Effect) -> bool:
    experiment = machine.experiment
    if not _is_steady(experiment, experiment.outputs_of((effect,), machine.shifts)):
        return False
    ALL[experiment.name] = experiment
    return size_of(experiment, (effect,), machine.shifts) >= LEAST_STRONG * BEST_SENSOR


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


@dataclass(frozen=True)
class _Slide:
    """What carries the tool: a mass on a spring along the feed."""

    mass_kg: float
    hz: float
    damping_ratio: float

    @property
    def omega(self) -> float:
        return 2.0 * math.pi * self.hz

    @property
    def stiffness_n_per_m(self) -> float:
        return self.mass_kg * self.omega**2

    @property
    def damping_n_s_per_m(self) -> float:
        return 2.0 * self.damping_ratio * self.mass_kg * self.omega

    def scales(self) -> dict[str, float]:
        """The scenario's factors on the URDF's slide."""
        return {
            "inertia": self.mass_kg / MASS_KG,
            "stiffness": self.stiffness_n_per_m / STIFFNESS_N_PER_M,
            "damping": self.damping_n_s_per_m / DAMPING_N_S_PER_M,
        }


def _draw_slide(rng: np.random.Generator) -> _Slide:
    return _Slide(_log_uniform(rng, 20.0, 200.0), _log_uniform(rng, 8.0, 35.0), rng.uniform(0.02, 0.06))


def _write(rng, name: str, folder: Path, slide: _Slide, cut: dict, duration_s: float) -> None:
    """The scenario of a cut: teeth and how often one comes, diameter, depth, specific force."""
    feed = float(rng.uniform(0.05e-3, 0.15e-3))
    values = slide.scales() | {
        "name": name,
        "robots": ROOT / "assets" / "robots",
        "rpm": 60.0 * cut["tooth_hz"] / cut["teeth"],
        "feed_mm": feed * 1e3,
        "depth_mm": cut["depth_m"] * 1e3,
        "engagement": ("up", "down")[int(rng.integers(2))],
        "radial_mm": cut["diameter_m"] * rng.uniform(0.2, 0.8) * 1e3,
        "start_deg": rng.uniform(0.0, 360.0),
        "ramp_mm": 0.2 * feed * 1e3,
        "diameter_mm": cut["diameter_m"] * 1e3,
        "teeth": cut["teeth"],
        "tangential_mpa": cut["tangential_pa"] / 1e6,
        "radial_mpa": cut["tangential_pa"] * rng.uniform(0.2, 0.5) / 1e6,
        "duration_s": duration_s,
        "length_mm": (duration_s * cut["tooth_hz"] + 2.0) * feed * 1e3,
    }
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.toml").write_text(SCENARIO.format(**values), encoding="utf-8")


def _draw_cut(rng: np.random.Generator, most_teeth: int, tooth_hz: tuple[float, float]) -> dict:
    return {
        "teeth": int(rng.integers(2, most_teeth + 1)),
        "tooth_hz": _log_uniform(rng, *tooth_hz),
        "diameter_m": float(rng.uniform(10e-3, 25e-3)),
        "tangential_pa": _log_uniform(rng, 600e6, 2500e6),
    }


def _draw(rng: np.random.Generator, name: str, folder: Path) -> Machine | None:
    slide, cut = _draw_slide(rng), _draw_cut(rng, 5, (10.0, 50.0))
    # of the slide's stiffness, what the chip has
    cut["depth_m"] = depth = rng.uniform(0.03, 0.25) * slide.stiffness_n_per_m / cut["tangential_pa"]
    mode_hz = _log_uniform(rng, max(50.0, 2.5 * slide.hz), 250.0)
    mode_ratio = rng.uniform(0.015, 0.06)
    softest = mode_ratio / (cut["tangential_pa"] * depth)
    # so stiff that it moves a part of the slide's mass
    stiffest = 1.0 / (HEAVIEST * slide.mass_kg * (2.0 * math.pi * mode_hz) ** 2)
    if stiffest > 0.9 * softest:
        return None
    compliance = _log_uniform(rng, stiffest, 0.9 * softest)
    mode = {"compliance_m_per_n": compliance, "frequency_hz": mode_hz, "damping_ratio": mode_ratio}
    # as a damper on the slide it is so many times what the slide has
    spindle = 2.0 * math.pi * cut["tooth_hz"] / cut["teeth"]
    damper = rng.uniform(0.15, 0.8) * slide.damping_n_s_per_m
    slope = damper * spindle * 0.5 * cut["diameter_m"] / depth
    duration_s = min(max(30.0 / cut["tooth_hz"], 1.2), 2.0)
    _write(rng, name, folder, slide, cut, duration_s)
    # at rates of 1 kHz what is hidden shows below a fifth of that
    measured = (1000.0, duration_s, 0.05e-3, 200.0, (1.0, 1.0, 1e-6))
    experiment = _Mill(name, *measured, folder=str(folder), refined=0.4)
    worn = Effect("milling_process_damping", None, {"per_slope_n_per_m": slope})
    return Machine(experiment, (Effect("tool_mode", None, mode), worn))


def _draw_fast(rng: np.random.Generator, name: str, folder: Path) -> Machine:
    slide, cut = _draw_slide(rng), _draw_cut(rng, 4, (60.0, 400.0))
    mode = {
        "compliance_m_per_n": 1.0 / _log_uniform(rng, 5e6, 40e6),
        "frequency_hz": _log_uniform(rng, 400.0, 3000.0),
        "damping_ratio": rng.uniform(0.02, 0.05),
    }
    # of what the averaged chip needs to chatter in a slot
    chip = rng.uniform(0.3, 0.9) * mode["damping_ratio"] / mode["compliance_m_per_n"]
    cut["depth_m"] = chip / cut["tangential_pa"]
    duration_s = 0.3
    _write(rng, name, folder, slide, cut, duration_s)
    measured = (10_000.0, duration_s, 0.1e-3, 4000.0, (1.0, 1.0, 1e-6))
    experiment = _Mill(name, *measured, folder=str(folder), refined=REFINED)
    return Machine(experiment, (Effect("tool_mode", None, mode),))


def _is_steady(experiment: _Mill, run: np.ndarray) -> bool:
    """By the slide, and by the forces where it hardly moves within the run."""
    t = experiment.time_s
    turns = np.arange(0.8 * t[-1], t[-1] - experiment.tooth_period_s, 1.0 / experiment.rate_hz)
    apart = np.stack([np.interp(turns + experiment.tooth_period_s, t, c) - np.interp(turns, t, c) for c in run.T])
    moves = np.stack([c - np.polyval(np.polyfit(t, c, 1), t) for c in run.T])
    part = np.std(apart, axis=1) / np.std(moves, axis=1)
    channels = [0, 1] if experiment.rate_hz > 5000.0 else [2]
    return bool(np.all(np.isfinite(run)) and np.all(part[channels] < _steady_part(experiment)))


def _steady_part(experiment: _Mill) -> float:
    # where jumps of the force lie between samples they differ by themselves
    return STEADY if experiment.rate_hz < 5000.0 else 4.0 * STEADY


def _with_noise(machine: Machine, nominal: np.ndarray, rng: np.random.Generator) -> Machine:
    """Sensors with errors of 1 to 4 % of what the forces move, and 0.3 to 1 % of what the slide does beside its feed."""
    t = machine.experiment.time_s
    slide = nominal[:, 2] - np.polyval(np.polyfit(t, nominal[:, 2], 1), t)
    parts = (*rng.uniform(0.01, 0.04, 2), rng.uniform(0.003, 0.01))
    sizes = (*rms(nominal[:, :2] - nominal[:, :2].mean(axis=0)), np.std(slide))
    noise = tuple(float(f"{part * size:.3g}") for part, size in zip(parts, sizes))
    return replace(machine, experiment=replace(machine.experiment, reference_noise=noise))


def cases_of(machine: Machine, seed: int, clean: int) -> list[Case]:
    """Clean sets, and what is hidden at two levels; every set in another colour of noise."""
    name, sort = machine.experiment.name, "fast" if "fast" in machine.experiment.name else "slow"
    ALL[name] = machine.experiment
    found = []

    def add(family: str, truth: tuple, expected: str, **more) -> None:
        number = len(found)
        colour = COLOURS[(seed + number) % len(COLOURS)]
        case_seed = seed * 100 + number
        found.append(Case(f"{sort} {family}", name, truth, expected, machine.shifts, colour, case_seed, **more))

    for k in range(clean):
        add("clean", (), "nothing", noise=(0.5, 1.0, 2.0)[k % 3])
    for effect in machine.hidden:
        largest = size_of(machine.experiment, (effect,), machine.shifts) / BEST_SENSOR
        for level in ("strong", "middle"):
            add(f"{effect.kind} {level}", (effect,), "named", level=min(LEVELS[level], largest))
    return found
