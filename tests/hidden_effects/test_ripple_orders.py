"""A ripple of any order is named, wherever the order lies between those that a search begins from.

Arms, motions and orders are drawn from seeds; the arm on its rippling transmission is MuJoCo's.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402, F401
from bench.effects import Effect  # noqa: E402
from test_delays import NOISE, Drawn, named  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

# between the orders 10 and 50 that the effect begins from, where a fit does not find its way
ORDERS = (12.0, 48.0)
# what the ripple does over the noise, rms, in the channel where that is most
OVER_NOISE = 5.0


@pytest.mark.parametrize("seed", some(range(68_100, 68_108), 2))
def test_crosscheck_mujoco_a_ripple_of_any_order(seed, tmp_path):
    draw = np.random.default_rng([seed, 23])
    drawn = Drawn(seed, tmp_path / "arm")
    order, phase = draw.uniform(*ORDERS), draw.uniform(0.0, 2.0 * np.pi)
    plain = drawn.moved([])[1]

    def rippled(size: float) -> tuple[np.ndarray, np.ndarray]:
        ripple = {"cosine_rad": size * np.cos(phase), "sine_rad": size * np.sin(phase), "cycles": order}
        return drawn.moved([Effect("joint_ripple", drawn.number, ripple)])

    size = 3e-3 / order
    over = (rippled(size)[1] - plain).std(axis=0) / (NOISE * plain.std(axis=0))
    size *= OVER_NOISE / over.max()
    found = named(drawn.forward(), drawn.measured(*rippled(size), np.zeros(drawn.joints + 1)))
    assert found["verdict"] == "named", found["reason"]
    (cause,) = found["causes"]
    assert (cause["kind"], cause["target"]) == ("joint_ripple", f"joint{drawn.number}")
    told = {key: one["value"] for key, one in cause["parameters"].items()}
    assert told["cycles"] == pytest.approx(order, rel=0.01)
    amplitude = np.hypot(told["cosine_rad"], told["sine_rad"])
    assert amplitude == pytest.approx(size, rel=0.1)
