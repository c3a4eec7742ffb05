"""What sensors make of a channel: effects on it, then samples. Everything happens on the fine time base of the run."""

from __future__ import annotations

import numpy as np
import scipy.signal

from .effects import Effect

OUTSIDE_SENSOR = "outside_load_dependent_delay"
CLOCK = "clock_delay"


def is_sensor(effect: Effect) -> bool:
    """Whether an effect acts on channels after the run."""
    return effect.kind.startswith("sensor_") or effect.kind in (OUTSIDE_SENSOR, CLOCK)


def of_channel(effects: tuple[Effect, ...], channel: str) -> list[Effect]:
    """What acts on a channel: its own sensor's, and the clock that all share."""
    return [e for e in effects if e.kind == CLOCK or is_sensor(e) and e.target == channel]


def measured(time_s: np.ndarray, values: np.ndarray, effects: list[Effect], at_s: np.ndarray) -> np.ndarray:
    """Samples of a channel at `at_s`. Before its first value a channel stood still; between values it is linear."""
    late = at_s
    for effect in effects:
        v = effect.values
        if effect.kind == "sensor_low_pass":
            values = low_pass(time_s, values, v["time_constant_s"])
        elif effect.kind == "sensor_gain":
            values = values * v["factor"]
        elif effect.kind == "sensor_offset":
            values = values + v["offset"]
        elif effect.kind == "sensor_drift":
            values = values - v["amplitude"] * np.expm1(-time_s / v["time_constant_s"])
        elif effect.kind in ("sensor_delay", CLOCK):
            late = late - v["delay_s"]
        elif effect.kind == OUTSIDE_SENSOR:
            load = np.abs(np.interp(at_s, time_s, values)) / v["scale"]
            late = late - v["delay_s"] * load
        else:
            raise ValueError(effect.kind)
    return np.interp(late, time_s, values)


def low_pass(time_s: np.ndarray, values: np.ndarray, time_constant_s: float) -> np.ndarray:
    """First-order filter, exact for values that are linear between the times; at rest before."""
    if time_constant_s == 0.0:
        return values
    h = (time_s[-1] - time_s[0]) / (time_s.size - 1)
    r = h / time_constant_s
    e = np.exp(-r)
    # y[k] = e y[k-1] + a x[k] + b x[k-1] for x linear in between
    a, b = 1.0 - (1.0 - e) / r, (1.0 - e) / r - e
    start = np.array([values[0] * (1.0 - a)])
    return scipy.signal.lfilter([a, b], [1.0, -e], values, zi=start)[0]
