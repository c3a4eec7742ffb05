"""Laws without a name as curves: the same law, written out in MuJoCo's plant and given to truecut by its values at even
places, must leave the same trace."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench.effects import Effect  # noqa: E402
from bench.experiment import ALL  # noqa: E402
from bench.noise import rms  # noqa: E402
from test_crosscheck_effects import recorded  # noqa: E402

SEED = 77_100


class Curve(NamedTuple):
    """A curve of joint 1, as a scenario has it."""

    kind: str
    values: dict
    target: int = 1


def drag(draw: np.random.Generator) -> tuple[Effect, Curve]:
    """Friction with the square of the speed."""
    factor = float(draw.uniform(5.0, 12.0))
    speeds = np.linspace(0.0, 12.0, 200)
    curve = {"from_rad_per_s": 0.0, "to_rad_per_s": 12.0, "frictions_n_m": [float(factor * v * v) for v in speeds]}
    return Effect("outside_quadratic_drag", 1, {"drag_n_m_s2_per_rad2": factor}), Curve("joint_friction_by_speed", curve)


def place(draw: np.random.Generator) -> tuple[Effect, Curve]:
    """Dry friction that comes and goes with the place."""
    level, cycles = float(draw.uniform(5.0, 10.0)), float(draw.uniform(15.0, 30.0))
    places = np.linspace(-1.6, 1.6, 200)
    curve = {
        "from_rad": -1.6,
        "to_rad": 1.6,
        "frictions_n_m": [float(level * (1.0 + np.sin(cycles * q))) for q in places],
    }
    law = {"level_n_m": level, "cycles": cycles}
    return Effect("outside_place_dependent_friction", 1, law), Curve("joint_friction_by_position", curve)


def spring(draw: np.random.Generator) -> tuple[Effect, Curve]:
    """A balancing spring, given by its torques."""
    cosine, sine = (float(x) for x in draw.uniform(-15.0, 15.0, 2))
    places = np.linspace(-1.6, 1.6, 41)
    torques = [float(cosine * np.cos(q) + sine * np.sin(q)) for q in places]
    curve = {"from_rad": -1.6, "to_rad": 1.6, "torques_n_m": torques}
    return (
        Effect("joint_counterbalance", 1, {"cosine_n_m": cosine, "sine_n_m": sine}),
        Curve("joint_position_curve", curve),
    )


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("law", [drag, place, spring])
def test_crosscheck_mujoco_curves_leave_the_trace_of_their_law(law, seed, tmp_path):
    """The two sides differ by less than 5 % of what the law changes, or a fifth of the reference noise."""
    experiment = ALL["axis"]
    hidden, curve = law(np.random.default_rng([SEED, seed]))
    noise = np.array(experiment.reference_noise)
    theirs = experiment.outputs_of((hidden,))
    change = rms((theirs - experiment.outputs_of()) / noise)
    apart = rms((recorded(experiment, (curve,), tmp_path) - theirs) / noise)
    assert change.max() > 2.0, change
    assert np.all(apart < np.maximum(0.05 * change.max(), 0.2)), (apart, change)
