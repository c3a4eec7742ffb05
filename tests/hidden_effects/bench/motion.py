"""Commanded motions: bandlimited, at rest at both ends, sampled at the rate of the data.

Between samples a command is the cubic spline through them (not-a-knot), and its velocity is the derivative of that
spline. The motions hold next to nothing above 8 Hz, so that any cubic through the samples at 250 Hz, truecut's as well,
lies within 1e-6 of their range of it.
"""

from __future__ import annotations

import numpy as np


def smooth_step(t: np.ndarray, start_s: float, length_s: float) -> np.ndarray:
    """From 0 to 1 with velocity, acceleration and jerk that vanish at both ends."""
    u = np.clip((t - start_s) / length_s, 0.0, 1.0)
    return u**4 * (35.0 - 84.0 * u + 70.0 * u**2 - 20.0 * u**3)


def multisine(t: np.ndarray, from_hz: float, to_hz: float, count: int, seed: int) -> np.ndarray:
    """Tones of equal acceleration at random phases, scaled to a peak of 1."""
    draw = np.random.default_rng(seed)
    hz = np.geomspace(from_hz, to_hz, count)
    phase = draw.uniform(0.0, 2.0 * np.pi, count)
    wave = np.sum(np.sin(2.0 * np.pi * hz[:, None] * t + phase[:, None]) / hz[:, None] ** 1.5, axis=0)
    return wave / np.abs(wave).max()


def at_rest_outside(t: np.ndarray, wave: np.ndarray, rest_s: float = 0.1, run_up_s: float = 0.4) -> np.ndarray:
    """The wave, faded in and out."""
    end = t[-1]
    return wave * smooth_step(t, rest_s, run_up_s) * (1.0 - smooth_step(t, end - rest_s - run_up_s, run_up_s))


def lively_and_slow(t: np.ndarray, lively_rad: float, slow_rad: float, period_s: float, seed: int) -> np.ndarray:
    """In each period two thirds of multisine, one third of slow reversals: dry friction shows in the latter."""
    fade_s = 0.25
    gate = np.zeros_like(t)
    for start in np.arange(0.0, t[-1], period_s):
        gate += smooth_step(t, start + 0.05, fade_s) * (1.0 - smooth_step(t, start + 0.62 * period_s, fade_s))
    slow = slow_rad * np.sin(2.0 * np.pi * 1.6 * t)
    return lively_rad * gate * multisine(t, 0.5, 4.0, 9, seed) + at_rest_outside(t, slow)


def commands(name: str, t: np.ndarray) -> np.ndarray:
    """Command of every joint (rad, a row per instant) of the experiment of this name."""
    if name == "axis":
        joints = [lively_and_slow(t, 0.45, 0.02, 2.0, 11)]
    elif name == "axis_single_tone":
        joints = [at_rest_outside(t, 0.10 * np.sin(2.0 * np.pi * 2.0 * t), run_up_s=1.5)]
    elif name == "axis_small":
        joints = [at_rest_outside(t, np.radians(0.5) * multisine(t, 0.5, 6.0, 9, 13))]
    elif name == "two_joint":
        joints = [
            np.radians(-40.0) + at_rest_outside(t, 0.40 * multisine(t, 0.4, 3.0, 8, 17)),
            np.radians(60.0) + lively_and_slow(t, 0.55, 0.03, 2.5, 19),
        ]
    else:
        raise KeyError(name)
    return np.stack(joints, axis=1)
