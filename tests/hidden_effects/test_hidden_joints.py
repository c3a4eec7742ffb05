"""Effects in the joint of a slide that mills: the generator's reference against truecut, and against closed forms."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench.effects import Effect  # noqa: E402
from bench.experiment import MILL  # noqa: E402
from bench.noise import rms  # noqa: E402
from bench.score import ON_SLIDES, sized  # noqa: E402
from test_crosscheck_effects import recorded  # noqa: E402

IN_THE_SLIDE = [
    ("joint_stiffness", {"factor": 0.97}),
    ("joint_damping", {"factor": 1.4}),
    ("joint_viscous", {"viscous_n_s_per_m": 150.0}),
    ("joint_coulomb", {"friction_n": 0.6}),
    ("joint_hysteresis", {"amplitude_n": 0.6, "yield_windup_m": 3e-6}),
    ("joint_backlash", {"gap_m": 4e-6}),
    ("joint_offset", {"force_n": 2.0}),
]


class _Written:
    """An effect as a scenario of a slide has it."""

    def __init__(self, kind: str, values: dict[str, float]) -> None:
        self.kind, self.target, self.values = kind, 1, values


@pytest.mark.parametrize(("kind", "values"), IN_THE_SLIDE, ids=lambda x: x if isinstance(x, str) else "")
def test_crosscheck_mujoco_effects_of_a_slide_that_mills(kind, values, tmp_path):
    """Both sides differ by less than 5 % of what the effect changes, or a fifth of the reference noise."""
    parameters = {key: {"value": value} for key, value in values.items()}
    effect = sized({"kind": kind, "target": "joint1", "parameters": parameters})
    noise = np.array(MILL.reference_noise)
    mine = MILL.outputs_of((effect,))
    change = rms((MILL.seen(mine) - MILL.seen(MILL.outputs_of())) / noise)
    apart = rms((MILL.seen(recorded(MILL, (_Written(kind, values),), tmp_path)) - MILL.seen(mine)) / noise)
    assert change.max() > 0.5, change
    assert np.all(apart < np.maximum(0.05 * change.max(), 0.2)), (apart, change)


def test_verify_names_of_slides():
    """Every name on a slide stands for one that the generator has."""
    from bench.effects import KINDS

    known = {key for kind in KINDS if kind.startswith("joint_") for part in KINDS[kind] for key in part}
    assert set(ON_SLIDES.values()) <= known
    ripple = {"cosine_m": 1e-5, "sine_m": 0.0, "cycles": 100.0}
    found = sized({"kind": "joint_ripple", "target": "joint1", "parameters": {k: {"value": v} for k, v in ripple.items()}})
    # per metre in a scenario, radians per metre in the generator
    assert found.values["cycles"] == pytest.approx(200.0 * np.pi)


def test_verify_effects_without_a_law_are_refused():
    """An effect that a run would leave out is no run of that effect."""
    with pytest.raises(ValueError, match="no law for payload"):
        values = {"mass_kg": 1.0, "center_x_m": 0.0, "center_y_m": 0.0, "center_z_m": 0.0}
        MILL._run((Effect("payload", None, values),), (), None)
