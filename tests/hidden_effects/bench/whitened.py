"""Generalised least squares on the transforms of several series, for one who knows the noise's spectrum."""

from __future__ import annotations

import math

import numpy as np

ODDS = 20.0
# Twice the logarithm: so far apart two values of minus twice the log-likelihood decide.
DECISIVE = 2.0 * math.log(ODDS)


class Whitened:
    """Series (a column each) below some frequency, in units of the noise of each bin; nominal numbers are refitted with
    their priors."""

    def __init__(self, bins: np.ndarray, densities: list[np.ndarray], count: int) -> None:
        """`bins`: those of the transform of `count` samples that are looked at. `densities`, one for each series: such
        that the mean over all bins of a transform is the noise's variance."""
        self.bins = bins
        self.weights = []
        for density in densities:
            power = count * density[bins]
            power[1:] *= 0.5  # half of it in the sine, half in the cosine
            self.weights.append(1.0 / np.sqrt(power))
        self.rows = len(densities) * (2 * int(bins.sum()) - 1)
        self.numbers = 0
        self.base = np.zeros((self.rows, 0))

    def white(self, values: np.ndarray) -> np.ndarray:
        """Independent numbers of variance 1, if the values are noise."""
        found = []
        for column, weight in zip(values.T, self.weights):
            bins = np.fft.rfft(column)[self.bins] * weight
            found += [bins.real, bins.imag[1:]]
        return np.concatenate(found)

    def refit(self, slopes: list[np.ndarray]) -> None:
        """Sets the nominal numbers: change of the series per deviation of each."""
        self.numbers = len(slopes)
        columns = np.array([self.white(slope) for slope in slopes]).reshape(self.numbers, self.rows).T
        # a prior is a row of its own
        self.base, _ = np.linalg.qr(np.vstack([columns, np.eye(self.numbers)]))

    def refitted(self, values: np.ndarray, shifts: tuple[float, ...] = ()) -> np.ndarray:
        """White values less what nominal numbers explain. Of a residual: how far these are from what the scenario says."""
        prior = -np.array(shifts) if shifts else np.zeros(self.numbers)
        long = np.append(self.white(values), prior)
        return long - self.base @ (self.base.T @ long)
