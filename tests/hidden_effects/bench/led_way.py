"""The clock and the filter of a way along which a tool is led.

The clock of the way rises from rest as 3u^2 - 2u^3 over its ramp; places are smoothed by Hann's window, half of which is spent at rest.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

RAMP_S = 0.3
WINDOW_S = 0.1
WINDOW_SAMPLES = 20
COMMAND_EVERY_S = 1e-3


def led(until_s: float, place_of: Callable[[np.ndarray], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Times and smoothed places (a row each) up to a time before the way's last ramp, from places by the way's own clock."""
    t = COMMAND_EVERY_S * np.arange(int(np.ceil(until_s / COMMAND_EVERY_S - 1e-9)) + 1)

    def clock_s(at: np.ndarray) -> np.ndarray:
        u = np.clip(at / RAMP_S, 0.0, 1.0)
        return RAMP_S * (u**3 - 0.5 * u**4) + np.maximum(at - RAMP_S, 0.0)

    share = (np.arange(WINDOW_SAMPLES) + 0.5) / WINDOW_SAMPLES
    weights = (1.0 - np.cos(2.0 * np.pi * share)) / WINDOW_SAMPLES
    shifted = (clock_s(t - 0.5 * WINDOW_S + (s - 0.5) * WINDOW_S) for s in share)
    return t, sum(w * place_of(clock) for w, clock in zip(weights, shifted))
