"""Soft wheels drawn at random that run over an edge inward: what grains that jam there change, and what else would.

The wheel is led along a line at one distance from the edge. What the grains hold is then a part of a load that varies with the
wheel's eccentricity alone: with a little of it the change is a constant, as an offset of the sensor is. A wheel is kept if
sensors of a quarter of the ordinary error see its grains: a change of five times their noise, nominal values refitted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.signal

from .cases import LEVELS, Case
from .drawn_mills import BEST_SENSOR, LEAST_STRONG
from .effects import Effect
from .experiment import ALL, POLISH_EDGE, SCENARIOS, DrawnExperiment, Experiment
from .noise import AR1_COEFFICIENT, rms
from .signature import change_of, nominal_signatures, scaled, size_of

# Column of the force that the grains change.
FRICTION = 1
TRIES = 40


@dataclass(frozen=True)
class Machine:
    """A wheel, its grains, and by how many deviations its nominal values are off."""

    experiment: DrawnExperiment
    grains: Effect
    shifts: tuple[float, ...]


def draw(seed: int, folder: Path, part: float | None = None) -> Machine:
    """The wheel of a seed; `part` is its eccentricity over the indentation, else drawn up to 0.3."""
    for attempt in range(TRIES):
        try:
            machine = _draw(np.random.default_rng([seed, attempt]), f"{seed}_{attempt}", folder, part)
        except ValueError:
            continue  # deeper than the reference's table
        if size_of(machine.experiment, (machine.grains,), machine.shifts) >= LEAST_STRONG * BEST_SENSOR:
            return machine
    raise RuntimeError(f"no wheel in {TRIES} draws of seed {seed}")


def _draw(rng: np.random.Generator, name: str, folder: Path, part: float | None) -> Machine:
    indentation = rng.uniform(0.3, 0.7)
    drawn = rng.uniform(0.0, 0.3)
    values = {
        "spin_rpm": rng.uniform(400.0, 1200.0),
        "tilt_deg": 20,
        "mu": rng.uniform(0.2, 0.5),
        # none at all has no angle, which is refused
        "eccentricity_um": max(1.0, 1e3 * indentation * (drawn if part is None else part)),
        "eccentricity_angle_deg": rng.uniform(0.0, 360.0),
        "radius_mm": rng.uniform(15.0, 30.0),
        "youngs_modulus_mpa": rng.uniform(5.0, 12.0),
        "inset_mm": rng.uniform(0.2, 1.8),
        "feed_mm_per_s": rng.uniform(10.0, 20.0),
        "indentation_mm": indentation,
    }
    lines = []
    for line in (SCENARIOS / "polish_edge.toml").read_text(encoding="utf-8").splitlines():
        key = line.partition(" = ")[0]
        if key == "urdf":
            line = line.replace("../../../", f"{SCENARIOS.parents[2]}/")
        lines.append(f"{key} = {values.pop(key):.5g}" if key in values else line)
    assert not values
    name = f"drawn_wheel_{name}" + ("" if part is None else f"_{round(1000 * part)}")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shifts = np.clip(rng.standard_normal(2), -1.5, 1.5)
    grains = Effect("wheel_edge_grains", None, {"share": round(float(rng.uniform(0.2, 0.9)), 3)})
    measured = (POLISH_EDGE.rate_hz, POLISH_EDGE.duration_s, POLISH_EDGE.step_s, POLISH_EDGE.band_hz)
    experiment = DrawnExperiment(name, *measured, POLISH_EDGE.reference_noise, folder=str(folder))
    # sensors with errors of a hundredth of what they measure; of the places as in the bench
    nominal = rms(experiment.outputs_of()[:, :2])
    noise = tuple(float(f"{0.01 * size:.3g}") for size in nominal)
    experiment = replace(experiment, reference_noise=(*noise, *POLISH_EDGE.reference_noise[2:]))
    ALL[name] = experiment
    return Machine(experiment, grains, tuple(float(round(x, 3)) for x in shifts))


def whitened(values: np.ndarray, colour: str) -> np.ndarray:
    """Columns of unit noise of a colour become white of unit size; the first sample's own weight included."""
    if colour == "white":
        return values
    assert colour == "ar1"
    steps = scipy.signal.lfilter([1.0, -AR1_COEFFICIENT], [1.0], values, axis=0)
    steps[1:] /= math.sqrt(1.0 - AR1_COEFFICIENT**2)
    return steps


def energies(machine: Machine, colour: str, level: float) -> tuple[float, dict[str, float]]:
    """By how much minus twice the log-likelihood falls with the grains named, in the mean and beside what the noise gives;
    and by how much more than with each rival in their place. Noise of known size and colour, nominal values refitted."""
    experiment, truth = machine.experiment, (machine.grains,)
    change = change_of(experiment, truth, machine.shifts)
    nominal = [column.reshape(change.shape) for column in nominal_signatures(experiment.name).T]
    size = _level_of(change, nominal, experiment)
    # noise of 1 in band has that variance over the band's part of all frequencies
    spread = _whole_over_band(experiment, colour) * size / level
    base = [whitened(c, colour).ravel() / spread for c in nominal]
    target = whitened(change / np.array(experiment.reference_noise), colour).ravel() / spread
    left = {}
    for kind, own in rivals(machine).items():
        own = whitened(own / np.array(experiment.reference_noise), colour).ravel()
        left[kind] = _left(target, [*base, own])
    return _left(target, base), left


def rivals(machine: Machine) -> dict[str, np.ndarray]:
    """What a search has beside the grains in the channel that they change: changes of the outputs."""
    experiment = machine.experiment
    nominal = experiment.outputs_of((), machine.shifts)
    offset, gain = np.zeros_like(nominal), np.zeros_like(nominal)
    offset[:, FRICTION], gain[:, FRICTION] = 1.0, nominal[:, FRICTION]
    friction = Effect("wheel_friction", None, {"factor": 1.05})
    found = {"sensor_offset": offset, "sensor_gain": gain}
    return found | {"wheel_friction": change_of(experiment, (friction,), machine.shifts)}


def _left(target: np.ndarray, columns: list[np.ndarray]) -> float:
    matrix = np.stack(columns, axis=1)
    matrix = matrix / np.linalg.norm(matrix, axis=0)
    rest = target - matrix @ np.linalg.lstsq(matrix, target, rcond=None)[0]
    return float(rest @ rest)


def _level_of(change: np.ndarray, nominal: list[np.ndarray], experiment: Experiment) -> float:
    target = scaled(experiment, change).ravel()
    matrix = np.stack([column.ravel() for column in nominal], axis=1)
    rest = target - matrix @ np.linalg.lstsq(matrix, target, rcond=None)[0]
    return float(rms(rest.reshape(change.shape)).max())


def _whole_over_band(experiment: Experiment, colour: str) -> float:
    """Deviation of noise over its RMS in band."""
    turns = np.linspace(0.0, math.pi, 4001)[1:]
    a = AR1_COEFFICIENT if colour == "ar1" else 0.0
    power = 1.0 / (1.0 - 2.0 * a * np.cos(turns) + a * a)
    below = turns <= 2.0 * math.pi * experiment.band_hz / experiment.rate_hz
    return float(math.sqrt(power.sum() / power[below].sum()))


def cases_of(machine: Machine, seed: int) -> list[Case]:
    """Clean sets and two levels, in white and in autoregressive noise."""
    name, found = machine.experiment.name, []
    largest = size_of(machine.experiment, (machine.grains,), machine.shifts) / BEST_SENSOR
    for colour in ("white", "ar1"):
        for k, level in enumerate((None, LEVELS["strong"], LEVELS["middle"])):
            truth = () if level is None else (machine.grains,)
            family = f"{colour} " + ("clean", "strong", "middle")[k]
            expected = "named" if truth else "nothing"
            case_seed = seed * 100 + len(found)
            level = None if level is None else min(level, largest)
            found.append(Case(family, name, truth, expected, machine.shifts, colour, case_seed, level))
    return found
