"""Noise of a measurement: white, coloured by a first-order recursion, or 1/f; its size is its RMS within a band."""

from __future__ import annotations

import numpy as np
import scipy.signal

COLOURS = ("white", "ar1", "one_over_f")
AR1_COEFFICIENT = 0.8


def in_band(values: np.ndarray, rate_hz: float, band_hz: float) -> np.ndarray:
    """The part of a series (along the first axis) below `band_hz`, its mean included."""
    spectrum = np.fft.rfft(values, axis=0)
    spectrum[np.fft.rfftfreq(values.shape[0], 1.0 / rate_hz) > band_hz] = 0.0
    return np.fft.irfft(spectrum, n=values.shape[0], axis=0)


def rms(values: np.ndarray) -> np.ndarray:
    """Root mean square along the first axis."""
    return np.sqrt(np.mean(np.square(values), axis=0))


def unit_noise(colour: str, count: int, channels: int, rate_hz: float, band_hz: float, seed: int) -> np.ndarray:
    """Independent noise in each channel (a column each), with an RMS of 1 within the band."""
    white = np.random.default_rng([seed, 7919]).standard_normal((count, channels))
    if colour == "white":
        found = white
    elif colour == "ar1":
        lead = np.random.default_rng([seed, 104729]).standard_normal((200, channels))
        found = scipy.signal.lfilter([1.0], [1.0, -AR1_COEFFICIENT], np.concatenate((lead, white)), axis=0)[200:]
    elif colour == "one_over_f":
        spectrum = np.fft.rfft(white, axis=0)
        hz = np.fft.rfftfreq(count, 1.0 / rate_hz)
        # power as 1/f down to the slowest that the record holds
        spectrum[1:] /= np.sqrt(hz[1:, None] * count / rate_hz)
        spectrum[0] = 0.0
        found = np.fft.irfft(spectrum, n=count, axis=0)
    else:
        raise ValueError(f"no noise of colour {colour}")
    return found / rms(in_band(found, rate_hz, band_hz))


def density(colour: str, hz: np.ndarray, rate_hz: float, band_hz: float) -> np.ndarray:
    """Variance per bin of a transform, divided by the number of samples, of noise with an RMS of 1 within the band."""
    if colour == "white":
        found = np.ones_like(hz)
    elif colour == "ar1":
        found = np.abs(1.0 - AR1_COEFFICIENT * np.exp(-2j * np.pi * hz / rate_hz)) ** -2
    elif colour == "one_over_f":
        # it has no mean: its first bin stands for that, which is no smaller than what a fit leaves of it
        found = 1.0 / np.maximum(hz, hz[1])
    else:
        raise ValueError(f"no noise of colour {colour}")
    both = np.where((hz == 0.0) | (hz == 0.5 * rate_hz), 1.0, 2.0)
    if colour == "one_over_f":
        both[0] = 0.0
    of_band = np.sum((both * found)[hz <= band_hz]) / (2 * (hz.size - 1))
    return found / of_band
