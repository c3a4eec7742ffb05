"""What the data can tell, by one who knows the truth and the spectrum of the noise.

Generalised least squares on the transforms of the series, each bin weighed by the density of the noise there; nominal
numbers are refitted, with their priors, and so are those of the truth. Of noise as 1/f the spectrum is known at the
frequencies of the record, not its mean, which is what goes on below them. Two explanations are told apart where one is at
odds of more than 20 : 1 to the other.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .cases import Case
from .dataset import noise_scale, noise_of
from .effects import KINDS, OUTSIDE, Effect
from .experiment import ALL
from .noise import density
from .whitened import DECISIVE, Whitened

# step of a derivative, as a part of a number
STEP = 0.02


class Oracle:
    """For one set without damage. `evidence` is twice the log of the odds of the truth to another explanation."""

    def __init__(self, case: Case) -> None:
        self.case, self.experiment = case, ALL[case.experiment]
        self.truth = self._predict(case.truth)
        count, rate, band = self.truth.shape[0], self.experiment.rate_hz, self.experiment.band_hz
        hz = np.fft.rfftfreq(count, 1.0 / rate)
        rms = noise_scale(case) * np.array(self.experiment.reference_noise)
        one = density(case.colour, hz, rate, band)
        if case.colour == "one_over_f":
            # noise that grows towards ever lower frequencies has a mean; that the generator's is zero no record tells
            one[0] = np.inf
        # beyond the band nothing is hidden, and a reference may err by what no sensor has
        self.whitened = Whitened(hz <= band, [one * level**2 for level in rms], count)
        self.whitened.refit([self._slope_of_shift(i) for i in range(len(self.experiment.uncertain))])
        self.noise = noise_of(case, count, self.truth.shape[1])
        own = self.refitted(self.noise, case.shifts)
        basis, _ = np.linalg.qr(np.stack([self.refitted(column) for column in self._tangents()], axis=1))
        self.least = float(np.sum((own - basis @ (basis.T @ own)) ** 2))

    def refitted(self, values: np.ndarray, shifts: tuple[float, ...] = ()) -> np.ndarray:
        """Values of the outputs that can be seen, white, nominal numbers refitted."""
        return self.whitened.refitted(self.experiment.seen(values), shifts)

    def evidence(self, effects: tuple[Effect, ...]) -> float:
        """Of the truth against these effects, as they are sized."""
        left = self.refitted(self.truth + self.noise - self._predict(effects), self.case.shifts)
        return float(left @ left) - self.least

    def tells(self, effects: tuple[Effect, ...]) -> bool:
        """Whether the data decide against these effects."""
        return self.evidence(effects) > DECISIVE

    def _predict(self, effects: tuple[Effect, ...]) -> np.ndarray:
        return self.experiment.outputs_of(effects, self.case.shifts)

    def _slope_of_shift(self, i: int) -> np.ndarray:
        shifts = self.case.shifts or (0.0,) * len(self.experiment.uncertain)
        up, down = (tuple(x + sign * 0.2 * (j == i) for j, x in enumerate(shifts)) for sign in (1.0, -1.0))
        of = self.experiment.outputs_of
        return self.experiment.seen(of(self.case.truth, up) - of(self.case.truth, down)) / 0.4

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

