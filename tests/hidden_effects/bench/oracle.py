"""What the data can tell, by one who knows the truth and the spectrum of the noise.

Generalised least squares on the transforms of the series, each bin weighed by the density of the noise there; nominal
numbers are refitted, with their priors, and so are those of the truth. Two explanations are told apart where one is at
odds of more than 20 : 1 to the other.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from .cases import Case
from .dataset import noise_scale, noise_of
from .effects import KINDS, OUTSIDE, Effect
from .experiment import ALL
from .noise import density

ODDS = 20.0
DECISIVE = 2.0 * math.log(ODDS)
# step of a derivative, as a part of a number
STEP = 0.02


class Oracle:
    """For one set without damage. `evidence` is twice the log of the odds of the truth to another explanation."""

    def __init__(self, case: Case) -> None:
        self.case, self.experiment = case, ALL[case.experiment]
        truth = self._predict(case.truth)
        count, rate = truth.shape[0], self.experiment.rate_hz
        hz = np.fft.rfftfreq(count, 1.0 / rate)
        # beyond the band nothing is hidden, and a reference may err by what no sensor has
        self.bins = hz <= self.experiment.band_hz
        rms = noise_scale(case) * np.array(self.experiment.reference_noise)
        power = density(case.colour, hz, rate, self.experiment.band_hz)[self.bins] * count
        power[1:] *= 0.5  # half of it in the sine, half in the cosine
        self.weights = 1.0 / (np.sqrt(power)[:, None] * rms)
        self.noise = noise_of(case, count, truth.shape[1])
        columns = [self._white(self._slope_of_shift(i)) for i in range(len(self.experiment.uncertain))]
        nuisances = np.array(columns).reshape(len(columns), -1).T
        self.base = np.linalg.qr(np.vstack([nuisances, np.eye(len(columns))]))[0]
        self.truth = truth
        own = self._refitted(self.noise)
        tangents = np.stack([self._refitted(column, prior=False) for column in self._tangents()], axis=1)
        basis = np.linalg.qr(tangents)[0]
        self.least = float(np.sum((own - basis @ (basis.T @ own)) ** 2))

    def evidence(self, effects: tuple[Effect, ...]) -> float:
        """Of the truth against these effects, as they are sized."""
        left = self._refitted(self.truth + self.noise - self._predict(effects))
        return float(left @ left) - self.least

    def tells(self, effects: tuple[Effect, ...]) -> bool:
        """Whether the data decide against these effects."""
        return self.evidence(effects) > DECISIVE

    def _predict(self, effects: tuple[Effect, ...]) -> np.ndarray:
        return self.experiment.outputs_of(effects, self.case.shifts)

    def _white(self, values: np.ndarray) -> np.ndarray:
        """Independent numbers of variance 1, if the values are noise."""
        bins = np.fft.rfft(self.experiment.seen(values), axis=0)[self.bins] * self.weights
        return np.concatenate([bins.real.ravel(), bins.imag[1:].ravel()])

    def _refitted(self, values: np.ndarray, prior: bool = True) -> np.ndarray:
        """What nominal numbers do not explain; their priors are rows of their own, and the truth is off by the shifts."""
        shifts = -np.array(self.case.shifts) if prior and self.case.shifts else np.zeros(self.base.shape[1])
        long = np.append(self._white(values), shifts)
        return long - self.base @ (self.base.T @ long)

    def _slope_of_shift(self, i: int) -> np.ndarray:
        shifts = self.case.shifts or (0.0,) * len(self.experiment.uncertain)
        up, down = (tuple(x + sign * 0.2 * (j == i) for j, x in enumerate(shifts)) for sign in (1.0, -1.0))
        of = self.experiment.outputs_of
        return (of(self.case.truth, up) - of(self.case.truth, down)) / 0.4

    def _tangents(self) -> list[np.ndarray]:
        """Change of the outputs with each number of the truth."""
        found = []
        for i, effect in enumerate(self.case.truth):
            neutral = {} if effect.kind in OUTSIDE else KINDS[effect.kind][0]
            for key, value in effect.values.items():
                step = STEP * (value - neutral.get(key, 0.0))
                if step == 0.0:
                    continue
                up, down = (
                    dataclasses.replace(effect, values=effect.values | {key: value + sign * step}) for sign in (1.0, -1.0)
                )
                ends = [self._predict((*self.case.truth[:i], one, *self.case.truth[i + 1 :])) for one in (up, down)]
                found.append((ends[0] - ends[1]) / (2.0 * STEP))
        return found

