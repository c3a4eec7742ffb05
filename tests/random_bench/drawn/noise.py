"""Noise whose spectrum is known: white, of first order, or 1/f to a power."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PAD = 4


@dataclass(frozen=True)
class Noise:
    """A colour and a size: the RMS within `band_hz`."""

    colour: str
    shape: float
    rms: float
    rate_hz: float
    band_hz: float
    count: int

    def _shape_of(self, hz: np.ndarray) -> np.ndarray:
        if self.colour == "white":
            return np.ones_like(hz)
        if self.colour == "ar1":
            turn = np.exp(-2j * np.pi * hz / self.rate_hz)
            return 1.0 / np.abs(1.0 - self.shape * turn) ** 2
        slowest = self.rate_hz / (PAD * self.count)
        return np.maximum(hz, slowest) ** -self.shape

    def density(self, hz: np.ndarray) -> np.ndarray:
        """Power density such that its mean over all bins of a transform is the variance."""
        every = np.fft.fftfreq(PAD * self.count, 1.0 / self.rate_hz)
        inside = np.abs(every) <= self.band_hz
        power = self._shape_of(np.abs(every))
        return self._shape_of(hz) * self.rms**2 * every.size / power[inside].sum()

    def sample(self, draw: np.random.Generator) -> np.ndarray:
        """A realisation, cut out of a longer one that is periodic."""
        white = np.fft.rfft(draw.standard_normal(PAD * self.count))
        hz = np.fft.rfftfreq(PAD * self.count, 1.0 / self.rate_hz)
        return np.fft.irfft(white * np.sqrt(self.density(hz)), n=PAD * self.count)[: self.count]


def draw_noise(draw: np.random.Generator, rms: float, rate_hz: float, band_hz: float, count: int, colour: str) -> Noise:
    """The colour's own number at random."""
    shape = {"white": 0.0, "ar1": draw.uniform(0.5, 0.95), "power": draw.uniform(0.5, 1.2)}[colour]
    return Noise(colour, float(shape), float(rms), rate_hz, band_hz, count)


COLOURS = ("white", "ar1", "power")
