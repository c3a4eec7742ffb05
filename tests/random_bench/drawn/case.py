"""One set: an experiment, what is hidden in it, how it is measured. Everything follows from the seed."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from bench.dataset import write_csv
from bench.effects import Effect

from .experiment import MODES, Experiment
from .laws import sized
from .library import draw_foreign, draw_known, is_possible, kinds, resized
from .noise import COLOURS, Noise, draw_noise

FAMILIES = ("clean", "strong", "middle", "pair", "outside", "all joints")
LEVELS = {"strong": (6.0, 14.0), "middle": (1.5, 3.0), "pair": (4.0, 12.0), "outside": (4.0, 12.0)}
MOST_ATTEMPTS = 30
# by so much of it, the level at the steps of the data may be off the one that was drawn
LEVEL_ACCURACY = 0.2
# of the spread of the channel of its unit that moves most
LEAST_PART = 1e-3


@dataclass
class Case:
    """A set as it was drawn."""

    seed: int
    mode: str
    family: str
    experiment: Experiment
    truth: tuple = ()
    shifts: tuple[float, ...] = ()
    noise: list[Noise] = field(default_factory=list)
    nuisances: list[str] = field(default_factory=list)
    levels: list[float] = field(default_factory=list)
    clean: np.ndarray | None = None
    noisy: np.ndarray | None = None
    """What a perfect logger would have written: without spikes, steps and gaps. The oracle sees this."""
    scenario: Path | None = None
    data: Path | None = None
    floor_rms: dict[str, float] = field(default_factory=dict)


class Unfit(ValueError):
    """What was drawn cannot be had: too large an effect would be needed, or nothing moves."""


def draw_case(seed: int, mode: str, family: str, folder: Path, kind: str | None = None) -> Case:
    """The set of this seed; with `kind` what is hidden is (first) of that kind.

    An experiment that cannot show what is to be hidden is drawn again.
    """
    for attempt in range(MOST_ATTEMPTS):
        draw = np.random.default_rng([seed, attempt, FAMILIES.index(family), sorted(MODES).index(mode)])
        try:
            return _draw(draw, seed, mode, family, folder, kind)
        except (Unfit, RuntimeError):
            continue
    raise Unfit(f"seed {seed}: nothing fitting in {MOST_ATTEMPTS} attempts")


def _draw(draw: np.random.Generator, seed: int, mode: str, family: str, folder: Path, only: str | None):
    experiment = MODES[mode](draw, folder)
    if mode != "inverse" and draw.random() < 0.2:
        experiment.draw_lag(draw)
    case = Case(seed, mode, family, experiment)
    # coarser steps do to find a size
    experiment.fast = True
    nominal = _prepare(experiment)
    _draw_noise(draw, case, nominal)
    case.shifts = tuple(float(x) for x in np.clip(draw.standard_normal(experiment.shifts), -1.5, 1.5))
    case.truth = _draw_truth(draw, case, nominal, only)
    experiment.fast = False
    _check_levels(case)
    case.clean = experiment.converged(case.truth, case.shifts, np.array([one.rms for one in case.noise]))
    if not np.isfinite(case.clean).all():
        raise Unfit("the run diverged")
    _measure(draw, case)
    return case


def _prepare(experiment: Experiment) -> np.ndarray:
    """Signals of the nominal run, kept with the experiment; its outputs."""
    experiment.signals_kept = experiment.signals()
    nominal = experiment.predict()
    spread = np.std(nominal, axis=0)
    units = [unit for _, unit in experiment.outputs]
    most = [max(spread[i] for i, other in enumerate(units) if other == unit) for unit in units]
    moves = [i for i, x in enumerate(spread) if x > LEAST_PART * most[i] > 0.0]
    if len(moves) < len(units):
        # nobody compares what does not move
        experiment.outputs = [experiment.outputs[i] for i in moves]
        experiment.kept.clear()
        nominal = nominal[:, moves]
    experiment.spread_kept = [float(x) for x in np.std(nominal, axis=0)]
    experiment.place_kept = [float(x) for x in np.mean(nominal, axis=0)]
    if not moves or min(s["effort"] for s in experiment.signals_kept) <= 0.0:
        raise Unfit("an output does not move")
    # what the arm's links weigh, as its URDF says
    text = experiment.arm.urdf
    experiment.moving_mass_kg = sum(float(part.split('"')[1]) for part in text.split("<mass value=")[1:])
    return nominal


def _draw_noise(draw: np.random.Generator, case: Case, nominal: np.ndarray) -> None:
    experiment = case.experiment
    low, high = (0.003, 0.03) if case.mode == "inverse" else (0.01, 0.03)
    colour = str(draw.choice(COLOURS))
    for spread in experiment.spread_kept:
        rms = spread * float(np.exp(draw.uniform(np.log(low), np.log(high))))
        case.noise.append(
            draw_noise(draw, rms, experiment.rate_hz, experiment.band_hz, nominal.shape[0], colour)
        )


def _draw_truth(draw: np.random.Generator, case: Case, nominal: np.ndarray, only: str | None) -> tuple:
    family, experiment = case.family, case.experiment
    if family == "clean":
        return ()
    if family == "all joints":
        return _all_joints(draw, experiment)
    if family == "outside":
        return (_at_level(draw, case, draw_foreign(draw, experiment, only), nominal),)
    found: list[Effect] = []
    for _ in range(2 if family == "pair" else 1):
        # every kind is as likely as any other, then its target
        possible = [pair for pair in kinds(experiment) if pair not in [(e.kind, e.target) for e in found]]
        kind = str(draw.choice(sorted({k for k, _ in possible})))
        kind = kind if only is None or found else only
        targets = [target for k, target in possible if k == kind]
        if not targets:
            raise Unfit(f"{kind} does not act here")
        target = targets[int(draw.integers(len(targets)))]
        found.append(_at_level(draw, case, draw_known(draw, experiment, kind, target, 1.0), nominal))
    return tuple(found)


def _at_level(draw: np.random.Generator, case: Case, effect, nominal: np.ndarray):
    """The effect, as large as its family wants it beside the noise."""
    level = float(draw.uniform(*LEVELS[case.family]))
    for _ in range(3):
        if not is_possible(effect, case.experiment):
            raise Unfit(f"{effect.name} would have to be too large")
        ratio = level_of(case, effect, nominal)
        if not 0.0 < ratio < np.inf:
            raise Unfit(f"{effect.name} does not show")
        if abs(ratio / level - 1.0) < 0.05:
            break
        effect = resized(case.experiment, effect, float(np.clip(level / ratio, 0.02, 50.0)))
    if not is_possible(effect, case.experiment):
        raise Unfit(f"{effect.name} would have to be too large")
    case.levels.append(level_of(case, effect, nominal))
    return effect


def _check_levels(case: Case) -> None:
    """Refuses what the coarser steps let seem larger or smaller than it is in the data: a spring too stiff for them, say."""
    if case.mode == "inverse":
        # nothing is stepped there
        return
    nominal = case.experiment.predict()
    for effect, level in zip(case.truth, case.levels):
        if abs(level_of(case, effect, nominal) / level - 1.0) > LEVEL_ACCURACY:
            raise Unfit(f"{effect.name} is not as large in the data as coarse steps say")


def level_of(case: Case, effect, nominal: np.ndarray) -> float:
    """RMS of what nominal numbers leave of an effect, over that of the noise, in the channel that shows it best."""
    experiment = case.experiment
    change = experiment.predict((effect,)) - nominal
    columns = [shift_column(experiment, i) for i in range(experiment.shifts)]
    weights = np.array([1.0 / one.rms for one in case.noise])
    x = np.stack([(c * weights).ravel() for c in columns], axis=1)
    target = (change * weights).ravel()
    with_priors = np.vstack([x, np.eye(len(columns))]), np.append(target, np.zeros(len(columns)))
    left = target - x @ np.linalg.lstsq(*with_priors, rcond=None)[0]
    return float(np.sqrt(np.mean(left.reshape(change.shape) ** 2, axis=0)).max())


def shift_column(experiment: Experiment, i: int) -> np.ndarray:
    """Change of the outputs per deviation of the i-th number."""
    if not hasattr(experiment, "columns_kept"):
        experiment.columns_kept = {}
    if i not in experiment.columns_kept:
        up = tuple(0.5 if j == i else 0.0 for j in range(experiment.shifts))
        down = tuple(-x for x in up)
        experiment.columns_kept[i] = experiment.predict((), up) - experiment.predict((), down)
    return experiment.columns_kept[i]


def _all_joints(draw: np.random.Generator, experiment: Experiment) -> tuple:
    """Viscous and dry friction of every joint, offsets of some: a tenth to a half of what the joints need."""
    found = []
    for j, one in enumerate(experiment.signals_kept):
        speed = max(one["speed"], 1e-9)
        found.append(sized("joint_viscous", j + 1, [float(draw.uniform(0.1, 0.5)) * one["effort"] / speed]))
        found.append(sized("joint_coulomb", j + 1, [float(draw.uniform(0.1, 0.5)) * one["effort"]]))
        if draw.random() < 0.3:
            found.append(sized("joint_offset", j + 1, [float(draw.uniform(-0.3, 0.3)) * one["effort"]]))
    return tuple(found)


def _measure(draw: np.random.Generator, case: Case) -> None:
    """Noise, and what a logger does."""
    experiment, clean = case.experiment, case.clean
    noise = np.stack([one.sample(draw) for one in case.noise], axis=1)
    case.noisy = clean + noise
    written = case.noisy.copy()
    sigma = noise.std(axis=0)
    if draw.random() < 0.3:
        case.nuisances.append("quantised")
        step = draw.uniform(0.5, 1.5) * sigma
        written = np.round(written / step) * step
    honest = written - clean
    # what a look at the samples would show, steps included
    seen = honest.std(axis=0)
    if draw.random() < 0.2:
        case.nuisances.append("spikes")
        at = draw.random(written.shape) < 0.002
        written[at] += (draw.choice([-1.0, 1.0], written.shape) * draw.uniform(6.0, 15.0, written.shape) * sigma)[at]
    if draw.random() < 0.25:
        case.nuisances.append("gaps")
        written[draw.random(written.shape) < 0.01] = np.nan
        start = int(draw.integers(written.shape[0] // 4, written.shape[0] // 2))
        written[start : start + round(0.15 * experiment.rate_hz), int(draw.integers(written.shape[1]))] = np.nan
    stamps = experiment.time
    if np.ptp(np.diff(stamps)) > 1e-6:
        case.nuisances.append("irregular")
    if draw.random() < 0.2:
        case.nuisances.append("clock")
        stamps = stamps * (1.0 + draw.choice([-1.0, 1.0]) * draw.uniform(2e-5, 1e-4))
    if experiment.lag_deviation_s:
        case.nuisances.append("lag")
    stated = bool(draw.random() < 0.3)
    if stated:
        case.nuisances.append("noise stated")
    case.scenario = experiment.write([float(x) for x in seen] if stated else None)
    columns = {"t": stamps} | {name: values for name, (_, _, values) in experiment.inputs().items()}
    if case.mode == "inverse" and draw.random() < 0.3:
        case.nuisances.append("encoder")
        step = float(draw.choice([1e-6, 5e-6]))
        columns |= {name: np.round(columns[name] / step) * step for name in columns if name.startswith("q")}
    columns |= {f"y{i + 1}": written[:, i] for i in range(written.shape[1])}
    case.data = case.scenario.with_name("data.csv")
    write_csv(case.data, columns)
    left = experiment.compared(honest)
    case.floor_rms = {name: float(x) for (name, _), x in zip(experiment.outputs, np.sqrt(np.mean(left**2, axis=0)))}
