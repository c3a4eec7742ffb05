"""What the data can tell, by one who knows the noise's spectrum and the truth.

Generalised least squares on the transforms of the series, each bin weighed by the true density of the noise there.
Nominal numbers are refitted with their priors. The true model stands against every effect of the library in its
place: where runs depend on an effect's numbers in a curve, the best few are fitted by Gauss and Newton. A set is
*separable* where the truth is at odds of more than 20 : 1 to all of them, by Schwarz's criterion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from bench.effects import KINDS
from bench.whitened import DECISIVE, Whitened

from .case import Case
from .laws import Foreign, sized
from .library import GENERAL, is_possible, kinds, scales, shapes

TOP_HZ = 60.0
REFINED = 3
ROUNDS = 2
# traces of the first are sums of the second's, as far as friction adds up
SUMS = {"joint_viscous": "joint_asymmetric_viscous", "joint_coulomb": "joint_asymmetric_coulomb"}


@dataclass
class Label:
    """What is known of a set; `evidence` is twice the log of the odds of the truth to the best other."""

    detectable: bool
    separable: bool
    evidence: float
    rivals: list[str] = field(default_factory=list)
    deviations: dict[str, float] = field(default_factory=dict)
    """Cramér–Rao's bound of each size of the truth, by effect and parameter."""


@dataclass
class Rival:
    """A model of the library in the truth's place."""

    effects: tuple
    loss: float


# a direction that changes the data by less than this part of what one number alone does is not in them
UNSEEN = 1e-9


def cramer_rao(tangents: np.ndarray) -> np.ndarray:
    """Least deviations of numbers whose tangents, whitened, are the columns; infinite where the data do not tell one."""
    lengths = np.linalg.norm(tangents, axis=0)
    scale = np.where(lengths > 0.0, lengths, 1.0)
    _, found, directions = np.linalg.svd(tangents / scale)
    seen = found > UNSEEN
    squares = np.sum((directions[: found.size][seen] / found[seen, None]) ** 2, axis=0)
    unseen = np.sum(directions[found.size :] ** 2, axis=0) + np.sum(directions[: found.size][~seen] ** 2, axis=0)
    return np.where(unseen > UNSEEN, math.inf, np.sqrt(squares) / scale)


class Oracle:
    """For one set."""

    def __init__(self, case: Case) -> None:
        self.case, self.experiment = case, case.experiment
        count, rate = case.clean.shape[0], self.experiment.rate_hz
        hz = np.fft.rfftfreq(count, 1.0 / rate)
        top = self.experiment.band_hz if case.mode == "inverse" else min(TOP_HZ, 0.45 * rate)
        self.whitened = Whitened(hz <= top, [one.density(hz) for one in case.noise], count)
        self.white, self.refitted, self.rows = self.whitened.white, self.whitened.refitted, self.whitened.rows
        self.traces: dict[tuple, np.ndarray] = {}
        # slopes are taken where the truth is: a swing's phase is no straight line of a mass
        self.experiment.fast = True
        slopes = [self.slope_of_shift(i) for i in range(self.experiment.shifts)]
        self.experiment.fast = False
        self.whitened.refit(slopes)
        self.start = self.refitted(case.noisy - self.predict(), case.shifts)
        self.experiment.fast = True
        self.nominal = self.predict()

    def predict(self, effects: tuple = ()) -> np.ndarray:
        """With the nominal numbers as they truly are."""
        return self.experiment.predict(effects, self.case.shifts)

    def slope_of_shift(self, i: int) -> np.ndarray:
        """Change of the outputs per deviation of the i-th nominal number."""
        up, down = ([x + sign * 0.2 * (j == i) for j, x in enumerate(self.case.shifts)] for sign in (1.0, -1.0))
        return (self.experiment.predict((), tuple(up)) - self.experiment.predict((), tuple(down))) / 0.4

    def change(self, effects: tuple) -> np.ndarray:
        """What effects change, white and refitted."""
        return self.refitted(self.predict(effects) - self.nominal)

    def loss(self, square: float, numbers: int) -> float:
        """Schwarz's criterion, but for a constant."""
        return square + numbers * math.log(self.rows)

    def label(self) -> Label:
        """The truth against nothing, and against all others."""
        case = self.case
        if not case.truth:
            return Label(False, True, 0.0)
        tangents, names = self.tangents()
        own = self.own_residual()
        basis, triangle = np.linalg.qr(tangents)
        left = own - basis @ (basis.T @ own)
        deviations = dict(zip(names, cramer_rao(triangle).tolist()))
        truth = self.loss(float(left @ left), tangents.shape[1])
        nothing = self.loss(float(self.start @ self.start), 0)
        if case.family == "all joints":
            return Label(nothing - truth > DECISIVE, True, nothing - truth, [], deviations)
        rivals = self.pairs() if case.family == "pair" else self.singles(case.family == "outside")
        rivals.append(Rival((), nothing))
        best = min(rivals, key=lambda rival: rival.loss)
        near = [r for r in sorted(rivals, key=lambda r: r.loss) if r.loss - truth < DECISIVE]
        told = [" + ".join(e.name for e in rival.effects) or "nothing" for rival in near]
        return Label(nothing - truth > DECISIVE, not near, best.loss - truth, told[:6], deviations)

    def own_residual(self) -> np.ndarray:
        """What the true effects leave, nominal numbers refitted."""
        self.experiment.fast = False
        found = self.refitted(self.case.noisy - self.predict(self.case.truth), self.case.shifts)
        self.experiment.fast = True
        return found

    def tangents(self, truth: tuple | None = None) -> tuple[np.ndarray, list[str]]:
        """Change of the outputs with each number of these effects (of the truth), and its name."""
        truth = self.case.truth if truth is None else truth
        columns, names = [], []
        for i, effect in enumerate(truth):
            others = truth[:i] + truth[i + 1 :]
            if isinstance(effect, Foreign):
                ends = [effect.at(factor * effect.size) for factor in (1.02, 0.98)]
                columns.append(self.between(others, *ends, 0.04 * effect.size))
                names.append(f"{effect.name} size")
                continue
            sizes, shape = list(effect.sizes.values()), [effect.values[key] for key in KINDS[effect.kind][1]]
            largest = max(abs(x) for x in sizes)
            for k, key in enumerate(effect.sizes):
                step = 0.02 * largest
                up, down = ([x + sign * step * (n == k) for n, x in enumerate(sizes)] for sign in (1.0, -1.0))
                ends = [sized(effect.kind, effect.target, x, tuple(shape)) for x in (up, down)]
                columns.append(self.between(others, *ends, 2.0 * step))
                names.append(f"{effect.name} {key}")
            for k, key in enumerate(KINDS[effect.kind][1]):
                step = 0.02 * (abs(shape[k]) if effect.kind != "payload" else 0.5)
                up, down = (tuple(x + sign * step * (n == k) for n, x in enumerate(shape)) for sign in (1.0, -1.0))
                ends = [sized(effect.kind, effect.target, sizes, x) for x in (up, down)]
                columns.append(self.between(others, *ends, 2.0 * step))
                names.append(f"{effect.name} {key}")
        return np.stack(columns, axis=1), names

    def between(self, others: tuple, up, down, distance: float) -> np.ndarray:
        """Slope from one effect to another, beside others."""
        predict = self.predict
        return self.refitted((predict((*others, up)) - predict((*others, down))) / distance)

    def columns(self, kind: str, target, shape: tuple[float, ...]) -> tuple[np.ndarray, list[float]]:
        """Change with each size of an effect at its scale, and the scale."""
        scale = scales(self.experiment, kind, target)
        if (kind, target, shape) in self.traces:
            return self.traces[kind, target, shape], scale
        if kind in SUMS:
            columns, _ = self.columns(SUMS[kind], target, ())
            return columns.sum(axis=1, keepdims=True), scale
        found = []
        for k in range(len(scale)):
            sizes = [s if n == k else 0.0 for n, s in enumerate(scale)]
            found.append(self.change((sized(kind, target, sizes, shape),)))
        self.traces[kind, target, shape] = np.stack(found, axis=1)
        return self.traces[kind, target, shape], scale

    def fit(self, kind: str, target, residual: np.ndarray, beside: np.ndarray | None = None):
        """The best of an effect by its traces at its scale, of a few shapes; `beside`: what else is refitted."""
        best = None
        tried = shapes(self.experiment, kind, target)
        if kind == "payload":
            return self.payload(residual, beside)
        for shape in tried:
            try:
                columns, scale = self.columns(kind, target, shape)
            except (RuntimeError, FloatingPointError, ValueError):
                continue
            if not np.isfinite(columns).all() or not np.linalg.norm(columns, axis=0).all():
                continue
            columns = without(columns, beside)
            amount = np.linalg.lstsq(columns, residual, rcond=None)[0]
            left = residual - columns @ amount
            loss = self.loss(float(left @ left), len(scale) + len(shape))
            if best is None or loss < best[0].loss:
                effect = sized(kind, target, [a * s for a, s in zip(amount, scale)], shape)
                best = (Rival((effect,), loss), shape)
        return best

    def payload(self, residual: np.ndarray, beside: np.ndarray | None):
        """Mass and first moments together, which are all but linear."""
        (mass,) = scales(self.experiment, "payload", None)
        try:
            traces = [self.columns("payload", None, x)[0][:, 0] for x in shapes(self.experiment, "payload", None)]
        except RuntimeError:
            return None
        columns = without(np.stack([traces[0], *(trace - traces[0] for trace in traces[1:])], axis=1), beside)
        amount = np.linalg.lstsq(columns, residual, rcond=None)[0]
        left = residual - columns @ amount
        centre = tuple(float(x) for x in np.clip(0.15 * amount[1:] / (amount[0] or 1.0), -1.0, 1.0))
        effect = sized("payload", None, [mass * float(amount[0])], centre)
        return Rival((effect,), self.loss(float(left @ left), 4)), centre

    def refined(self, rival: Rival, basis: np.ndarray | None = None) -> Rival:
        """The same kind of effect, its sizes and shapes fitted by runs of its own.

        Those before it are as they truly are, and move along the basis.
        """
        *kept, effect = rival.effects
        scale = np.array(scales(self.experiment, effect.kind, effect.target))
        names = KINDS[effect.kind][1]
        numbers = np.array([*effect.sizes.values(), *(effect.values[name] for name in names)])
        steps = np.append(0.1 * scale, [0.05 if effect.kind == "payload" else 0.1 * effect.values[n] for n in names])

        def made(x: np.ndarray):
            values = [float(v) for v in x]
            one = sized(effect.kind, effect.target, values[: scale.size], tuple(values[scale.size :]))
            if not is_possible(one, self.experiment):
                raise ValueError(one)
            return one

        def left(x: np.ndarray) -> np.ndarray:
            return without(self.start - self.change((*kept, made(x))), basis)

        try:
            now = left(numbers)
            for _ in range(ROUNDS):
                slopes = []
                for k, step in enumerate(steps):
                    beside = numbers.copy()
                    beside[k] += step
                    slopes.append((left(beside) - now) / -step)
                move = np.linalg.lstsq(np.stack(slopes, axis=1) * steps, now, rcond=None)[0] * steps
                for part in (1.0, 0.4, 0.1):
                    after = left(numbers + part * move)
                    if after @ after < now @ now:
                        numbers, gain, now = numbers + part * move, now @ now - after @ after, after
                        break
                else:
                    break
                if gain < 0.1:
                    break
            count = numbers.size + (0 if basis is None else basis.shape[1])
            return Rival((*kept, made(numbers)), self.loss(float(now @ now), count))
        except (RuntimeError, ValueError, FloatingPointError, OverflowError):
            return rival

    def others(self, taken: tuple) -> list[tuple]:
        """Kinds and targets that are none of these, nor hold one of these as a special case."""
        names = {(e.kind, e.target) for e in taken}
        names |= {(general, e.target) for e in taken for general in GENERAL.get(e.kind, ())}
        return [pair for pair in kinds(self.experiment) if pair not in names]

    def singles(self, two: bool) -> list[Rival]:
        """Every other effect alone; for a law outside the library also the best two together."""
        fits = [self.fit(kind, target, self.start) for kind, target in self.others(self.case.truth)]
        found = sorted((fit[0] for fit in fits if fit is not None), key=lambda rival: rival.loss)
        found = [self.refined(rival) for rival in found[:REFINED]] + found[REFINED:]
        if two:
            best = min(found, key=lambda rival: rival.loss)
            found += self.beside(best.effects, self.start - self.change(best.effects), self.others(best.effects))
        return found

    def pairs(self) -> list[Rival]:
        """One of the two alone, and beside another than its partner."""
        found = []
        for keep, gone in (self.case.truth, self.case.truth[::-1]):
            self.experiment.fast = False
            left = self.refitted(self.case.noisy - self.predict((keep,)), self.case.shifts)
            self.experiment.fast = True
            found += self.beside((keep,), left, self.others((keep, gone)))
        return found

    def beside(self, kept: tuple, left: np.ndarray, others: list[tuple]) -> list[Rival]:
        """Effects that are there, alone and with each of the others; all their numbers move along."""
        tangents, names = self.tangents(kept)
        basis, _ = np.linalg.qr(tangents)
        left = without(left, basis)
        extra = len(names) * math.log(self.rows)
        found = [Rival(kept, self.loss(float(left @ left), len(names)))]
        fits = [self.fit(kind, target, left, basis) for kind, target in others]
        both = [Rival((*kept, *fit[0].effects), fit[0].loss + extra) for fit in fits if fit is not None]
        both.sort(key=lambda rival: rival.loss)
        return found + [self.refined(rival, basis) for rival in both[:REFINED]] + both[REFINED:]


def without(values: np.ndarray, basis: np.ndarray | None) -> np.ndarray:
    """What of the values is none of the basis."""
    return values if basis is None else values - basis @ (basis.T @ values)
