"""Two recordings of one machine: something that the model lacks in both, and between them one change, or none."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from bench import motion
from bench.dataset import write_csv
from bench.effects import KINDS, Effect
from bench.score import is_cause, name_of

from .case import LEVELS, MOST_ATTEMPTS, Case, Unfit, _at_level, _draw_noise, _prepare
from .experiment import MODES, Experiment
from .laws import Foreign, sized
from .library import draw_foreign, draw_known, is_possible, kinds
from .noise import Noise
from .oracle import Label, Oracle

FAMILIES = ("nothing", "middle", "strong")
TIME_LIMIT_S = 400.0
MOST_ALTERNATIVES = 3


@dataclass
class Pair:
    """A pair as it was drawn. `case` is of the change alone: its noise is that of a difference."""

    seed: int
    mode: str
    family: str
    repeats: bool
    case: Case
    common: tuple
    change: tuple
    grown: bool
    """Whether the change is one of the size of something that is there in both."""
    gone: bool
    """Whether it is there in the first recording, and not in the second."""
    nuisances: list[str] = field(default_factory=list)
    scenario: Path | None = None
    data: tuple[Path, ...] = ()


def draw_pair(seed: int, mode: str, family: str, folder: Path, repeats: bool | None = None) -> Pair:
    """The pair of this seed; with `repeats` its motion is the same, or is not."""
    for attempt in range(MOST_ATTEMPTS):
        draw = np.random.default_rng([seed, attempt, FAMILIES.index(family), sorted(MODES).index(mode), 23])
        try:
            return _draw(draw, seed, mode, family, folder, repeats)
        except (Unfit, RuntimeError):
            continue
    raise Unfit(f"seed {seed}: nothing fitting in {MOST_ATTEMPTS} attempts")


def _draw(draw, seed: int, mode: str, family: str, folder: Path, repeats: bool | None) -> Pair:
    first = MODES[mode](draw, folder)
    if mode != "inverse" and draw.random() < 0.2:
        first.draw_lag(draw)
    same = draw.random() < 0.5
    repeats = mode == "load" or (same if repeats is None else repeats)
    case = Case(seed, mode, "pair", first)
    first.fast = True
    nominal = _prepare(first)
    _draw_noise(draw, case, nominal)
    case.shifts = tuple(float(x) for x in np.clip(draw.standard_normal(first.shifts), -1.5, 1.5))
    common = _draw_common(draw, case, nominal)
    change, grown = _draw_change(draw, case, nominal, family, common)
    gone = bool(change) and not grown and draw.random() < 0.3
    after = common if not change else _with(common, change[0])
    if not all(isinstance(e, Foreign) or is_possible(e, first) for e in after):
        raise Unfit("too large with what is there")
    second = again(draw, first, repeats)
    sides = [(first, after if gone else common), (second, common if gone else after)]
    pair = Pair(seed, mode, family, repeats, case, common, change, grown, gone)
    _measure(draw, pair, sides)
    return pair


def _draw_common(draw, case: Case, nominal: np.ndarray) -> tuple:
    """One or two things that no recording lacks: of the library, or outside it."""
    found: list = []
    for _ in range(int(draw.integers(1, 3))):
        if draw.random() < 0.35:
            effect = draw_foreign(draw, case.experiment)
            if any(isinstance(e, Foreign) and e.target == effect.target for e in found):
                raise Unfit("two laws in one place")
        else:
            effect = _any_known(draw, case.experiment, found)
        found.append(_at_level(draw, case, effect, nominal))
    return tuple(found)


def _any_known(draw, experiment: Experiment, taken: list) -> Effect:
    """Every kind is as likely as any other, then its target."""
    possible = [pair for pair in kinds(experiment) if pair not in [(e.kind, e.target) for e in taken]]
    kind = str(draw.choice(sorted({k for k, _ in possible})))
    targets = [target for k, target in possible if k == kind]
    return draw_known(draw, experiment, kind, targets[int(draw.integers(len(targets)))], 1.0)


def _draw_change(draw, case: Case, nominal: np.ndarray, family: str, common: tuple) -> tuple[tuple, bool]:
    """What changes, at the level of its family; in a third of pairs something that is there becomes more."""
    if family == "nothing":
        return (), False
    known = [e for e in common if not isinstance(e, Foreign)]
    grown = bool(known) and draw.random() < 0.33
    if grown:
        effect = known[int(draw.integers(len(known)))]
    else:
        effect = _any_known(draw, case.experiment, list(common))
    case.family = family
    change = _at_level(draw, case, effect, nominal)
    case.truth = (change,)
    return case.truth, grown


def _with(common: tuple, change: Effect) -> tuple:
    """All that is there with the change: sizes of the same kind and target add up."""
    for i, one in enumerate(common):
        if (one.kind, one.target) == (change.kind, change.target):
            sizes = [a + b for a, b in zip(one.sizes.values(), change.sizes.values(), strict=True)]
            shape = tuple(one.values[name] for name in KINDS[one.kind][1])
            return (*common[:i], sized(one.kind, one.target, sizes, shape), *common[i + 1 :])
    return (*common, change)


def again(draw, first: Experiment, repeats: bool) -> Experiment:
    """The same machine another day: sampled at other instants, and on another motion unless it repeats."""
    second = copy.copy(first)
    second.kept, second.fast = {}, False
    second.__dict__.pop("columns_kept", None)
    second.draw_times(draw, bool(draw.random() < 0.3))
    if repeats and first.mode == "inverse":
        # the recorder was started at another moment
        second.time = second.time + float(draw.uniform(-0.08, 0.08))
    if repeats:
        return second
    if first.mode == "inverse":
        number = np.arange(1, first.waves.shape[1] + 1)[:, None]
        second.waves = draw.normal(0.0, 1.0, first.waves.shape) / number
        second.places = first.places + draw.uniform(-0.3, 0.3, first.joints)
        second.q, second.v, second.a = second.motion(second.fine)
    else:
        t, top = first.command_time, draw.uniform(1.5, 4.0)
        waves = [
            place + motion.at_rest_outside(t, reach * motion.multisine(t, 0.4, top, 8, int(draw.integers(1 << 30))))
            for place, reach in zip(draw.uniform(-1.5, 1.5, first.count), draw.uniform(0.2, 0.7, first.count))
        ]
        second.command = np.stack(waves, axis=1)
    return second


def _measure(draw, pair: Pair, sides: list) -> None:
    """Both recordings: noise, and what a logger does; the oracle's case of the change."""
    case, first = pair.case, pair.case.experiment
    stated = bool(draw.random() < 0.3)
    noises, seen, paths = [], [], []
    for name, (experiment, effects) in zip(("first", "second"), sides):
        experiment.fast = False
        clean = experiment.predict(effects, case.shifts)
        if not np.isfinite(clean).all():
            raise Unfit("the run diverged")
        noise = np.stack([one.sample(draw) for one in case.noise], axis=1)
        written = clean + noise
        sigma = noise.std(axis=0)
        if draw.random() < 0.3:
            pair.nuisances.append(f"{name} quantised")
            step = draw.uniform(0.5, 1.5) * sigma
            written = np.round(written / step) * step
        seen.append((written - clean).std(axis=0))
        if draw.random() < 0.2:
            pair.nuisances.append(f"{name} spikes")
            at = draw.random(written.shape) < 0.002
            sign, size = draw.choice([-1.0, 1.0], written.shape), draw.uniform(6.0, 15.0, written.shape)
            written[at] += (sign * size * sigma)[at]
        if draw.random() < 0.25:
            pair.nuisances.append(f"{name} gaps")
            written[draw.random(written.shape) < 0.01] = np.nan
        noises.append(noise)
        stamps = experiment.time - experiment.time[0]
        inputs = {key: values for key, (_, _, values) in experiment.inputs().items()}
        columns = {"t": stamps} | inputs | {f"y{i + 1}": written[:, i] for i in range(written.shape[1])}
        path = first.folder / f"{name}.csv"
        write_csv(path, columns)
        paths.append(path)
    pair.nuisances += ["noise stated"] if stated else []
    pair.scenario = first.write([float(x) for x in np.hypot(*seen) / np.sqrt(2.0)] if stated else None)
    pair.data = tuple(paths)
    first.fast = False
    case.clean = first.predict(case.truth, case.shifts)
    case.noisy = case.clean + noises[1] - noises[0]
    doubled = [Noise(n.colour, n.shape, float(np.sqrt(2.0)) * n.rms, n.rate_hz, n.band_hz, n.count) for n in case.noise]
    case.noise = doubled


@dataclass
class Told:
    """What the program said of a pair."""

    seed: int
    mode: str
    family: str
    repeats: bool
    joints: int
    common: list[str]
    change: list[str]
    grown: bool
    gone: bool
    nuisances: list[str]
    separable: bool
    evidence: float
    rivals: list[str]
    verdict: str
    named: list[str]
    alternatives: int
    repeated: bool | None
    right: bool
    inside: list[bool]
    seconds: float
    reason: str = ""


def ask(program: list[str], pair: Pair, threads: int) -> tuple[dict | None, str, float]:
    """`between.json`, messages, seconds."""
    out = pair.scenario.parent / "answer"
    data = [str(path) for path in pair.data]
    command = [*program, "diagnose", str(pair.scenario), "--between", *data, "--out", str(out)]
    began = time.perf_counter()
    variables = os.environ | {"RAYON_NUM_THREADS": str(threads)}
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=variables, timeout=TIME_LIMIT_S)
    except subprocess.TimeoutExpired:
        return None, f"no answer within {TIME_LIMIT_S:g} s", TIME_LIMIT_S
    seconds = time.perf_counter() - began
    written = sorted(out.rglob("between.json")) if done.returncode == 0 else []
    messages = done.stdout + done.stderr
    return (json.loads(written[0].read_text(encoding="utf-8")) if written else None), messages, seconds


def judge(pair: Pair, answer: dict | None, messages: str, seconds: float, label: Label) -> Told:
    """Right is: of one change it is named and nothing else, or stands in a list of at most three; of none, that no change is
    told: nothing changed, or (after another motion) that it cannot be told."""
    found = answer or {}
    changes, rivals = found.get("changes", []), found.get("alternatives", [])
    verdict = found.get("verdict", "refused")
    truth = pair.change[0] if pair.change else None
    if truth is None:
        right = verdict == "nothing_changed" or (verdict == "ambiguous" and not changes)
    elif verdict == "ambiguous":
        members = changes + [one for rival in rivals for one in rival["changes"]]
        right = any(is_cause(one, truth) for one in members) and len(rivals) < MOST_ALTERNATIVES
    else:
        right = verdict == "changed" and len(changes) == 1 and is_cause(changes[0], truth)
    inside = []
    for one in changes:
        if truth is not None and is_cause(one, truth):
            sign = -1.0 if pair.gone else 1.0
            for key, size in truth.sizes.items():
                told = one["parameters"].get(key, {})
                if told.get("low") is not None and told.get("high") is not None:
                    inside.append(bool(told["low"] <= sign * size <= told["high"]))
    return Told(
        pair.seed,
        pair.mode,
        pair.family,
        pair.repeats,
        pair.case.experiment.joints,
        [e.name for e in pair.common],
        [e.name for e in pair.change],
        pair.grown,
        pair.gone,
        pair.nuisances,
        label.separable,
        round(label.evidence, 1),
        label.rivals,
        verdict,
        [name_of(one) for one in changes],
        len(rivals),
        found.get("compared", {}).get("repeated"),
        right,
        inside,
        round(seconds, 2),
        found.get("reason", messages[-300:]),
    )


def label(pair: Pair) -> Label:
    """Whether the change can be told from all others by one who knows the noise, what is common taken away."""
    pair.case.family = "nothing" if not pair.change else pair.family
    return Oracle(pair.case).label() if pair.change else Label(False, True, 0.0)


__all__ = ["FAMILIES", "LEVELS", "Pair", "Told", "ask", "draw_pair", "judge", "label"]
