"""What an effect changes in the outputs once the nominal parameters have been refitted, and how like another's it is.

Every channel is taken in units of its reference noise and within the experiment's band.
"""

from __future__ import annotations

import functools
import math

import numpy as np
import scipy.optimize

from .effects import Effect
from .experiment import ALL, Experiment
from .noise import in_band, rms

REFIT_SIGMAS = 3.0


def scaled(experiment: Experiment, outputs: np.ndarray) -> np.ndarray:
    """Outputs in units of the reference noise, within the band."""
    return in_band(experiment.seen(outputs), experiment.rate_hz, experiment.band_hz) / np.array(experiment.reference_noise)


@functools.cache
def nominal_signatures(name: str) -> np.ndarray:
    """Change of all outputs, flattened, per standard deviation of each uncertain parameter (a column each)."""
    experiment = ALL[name]
    columns = []
    for i in range(len(experiment.uncertain)):
        shift = [0.0] * len(experiment.uncertain)
        shift[i] = 0.5
        up = experiment.outputs_of((), tuple(shift))
        down = experiment.outputs_of((), tuple(-s for s in shift))
        columns.append(scaled(experiment, up - down).ravel())
    return np.stack(columns, axis=1)


def left_after_refit(experiment: Experiment, change: np.ndarray, bounded: bool = True) -> np.ndarray:
    """What of a change of the outputs no set of nominal parameters explains; a row per sample, scaled."""
    target = scaled(experiment, change).ravel()
    signatures = nominal_signatures(experiment.name)
    if bounded:
        limits = (-REFIT_SIGMAS, REFIT_SIGMAS)
        best = scipy.optimize.lsq_linear(signatures, target, limits).x
    else:
        best = np.linalg.lstsq(signatures, target, rcond=None)[0]
    return (target - signatures @ best).reshape(change.shape)


def change_of(experiment: Experiment, effects: tuple[Effect, ...], shifts: tuple[float, ...] = ()) -> np.ndarray:
    """Change of the outputs (SI) that effects bring."""
    return experiment.outputs_of(effects, shifts) - experiment.outputs_of((), shifts)


def size_of(experiment: Experiment, effects: tuple[Effect, ...], shifts: tuple[float, ...] = ()) -> float:
    """RMS of what is left after the refit over the reference noise, in the channel that shows it best."""
    return float(rms(left_after_refit(experiment, change_of(experiment, effects, shifts))).max())


def angle_deg(experiment: Experiment, one: tuple[Effect, ...], other: tuple[Effect, ...]) -> float:
    """Angle between the signatures of two effects at their sizes, nominal parameters refitted."""
    a = left_after_refit(experiment, change_of(experiment, one)).ravel()
    b = left_after_refit(experiment, change_of(experiment, other)).ravel()
    lengths = np.linalg.norm(a) * np.linalg.norm(b)
    if lengths == 0.0:
        return 90.0
    return math.degrees(math.acos(min(1.0, max(-1.0, float(a @ b) / lengths))))
