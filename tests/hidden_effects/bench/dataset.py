"""Writes a case as a data file, and its label into another folder that the program is never told of."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .cases import Case
from .experiment import ALL
from .noise import unit_noise
from .signature import size_of

WRONG_UNIT_SI = {"in rad": 1.0, "in kN m": 1e3, "in m": 1.0, "in kN": 1e3}
# missing cells, and rows where no column drives a replay
GAP_S, MISSING_PART, MISSING_ROWS = 0.2, 0.01, 20
# the last part of a set: no model can be better there than the errors of the measurement
HELD_OUT = 0.22


def noise_scale(case: Case) -> float:
    """RMS of the noise in band, in units of the reference noise."""
    if case.level is None:
        return case.noise
    return size_of(ALL[case.experiment], case.truth, case.shifts) / case.level


def noise_of(case: Case, count: int, channels: int) -> np.ndarray:
    """What is added to the true outputs."""
    experiment = ALL[case.experiment]
    noise = unit_noise(case.colour, count, channels, experiment.rate_hz, experiment.band_hz, case.seed)
    return noise * noise_scale(case) * np.array(experiment.reference_noise)


def measurement(case: Case) -> tuple[dict[str, np.ndarray], dict]:
    """Columns of the data file in their units, and what only the judge may know."""
    experiment = ALL[case.experiment]
    scale = noise_scale(case)
    clean = experiment.outputs_of(case.truth, case.shifts, case.still)
    count, channels = clean.shape
    noise = noise_of(case, count, channels)
    measured = clean + noise
    draw = np.random.default_rng([case.seed, 31])
    if case.damage == "quantised":
        step = 2.0 * noise.std(axis=0)
        measured = np.round(measured / step) * step
    if case.damage == "gappy":
        start = draw.integers(count // 4, count // 2, channels)
        for i, k in enumerate(start):
            measured[k : k + round(GAP_S * experiment.rate_hz), i] = np.nan
        measured[draw.random(measured.shape) < MISSING_PART] = np.nan
    columns = {"t_s": experiment.time_s}
    command = experiment.command()
    if command is not None:
        still = 1.0 if case.still is None else case.still
        command = command[0] + still * (command - command[0])
        for i, column in enumerate(c for c in experiment.columns if c.is_input):
            columns[column.name] = command[:, i] / column.si
    for i, column in enumerate(experiment.outputs):
        wrong = case.damage.partition(" ")[2] if case.damage.startswith(f"{column.name} ") else ""
        columns[column.name] = measured[:, i] / (WRONG_UNIT_SI[wrong] if wrong else column.si)
    if case.damage == "gappy" and command is None:
        keep = np.ones(count, bool)
        keep[draw.choice(np.arange(10, count - 10), MISSING_ROWS, replace=False)] = False
        columns = {name: values[keep] for name, values in columns.items()}
    # whole passes are set aside where there are several
    last = count // experiment.passes if experiment.passes > 2 else round(HELD_OUT * count)
    held_out = (measured - clean)[-last:]
    floor = np.sqrt(np.nanmean(np.square(held_out), axis=0))
    known = {
        "noise_scale": scale,
        "floor_rms": {c.channel: float(floor[i]) for i, c in enumerate(experiment.outputs)},
        "noise_rms": {c.channel: float(noise[:, i].std()) for i, c in enumerate(experiment.outputs)},
    }
    return columns, known


def write_csv(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Columns under their names; missing cells are empty."""
    lines = [",".join(columns)]
    for row in zip(*columns.values()):
        lines.append(",".join("" if np.isnan(x) else f"{x:.9g}" for x in row))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write(case: Case, number: int, work: Path) -> str:
    """Data and label of a case; its name in `work`, which says nothing of what is hidden."""
    name = f"set_{number:04d}"
    data, label = work / "data" / name, work / "labels"
    data.mkdir(parents=True, exist_ok=True)
    label.mkdir(parents=True, exist_ok=True)
    columns, known = measurement(case)
    write_csv(data / "data.csv", columns)
    told = {
        "family": case.family,
        "experiment": case.experiment,
        "expected": case.expected,
        "truth": [effect.as_dict() for effect in case.truth],
        "level": case.level,
        "colour": case.colour,
        "shifts": case.shifts,
        "damage": case.damage,
        **known,
    }
    (label / f"{name}.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    return name
