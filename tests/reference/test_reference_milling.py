"""Reference numbers of docs/physics/milling_forces.md."""

import milling as m
import numpy as np
from pytest import approx


def test_mean_forces():
    k, edge = (767e6, 168.8e6, 222e6), (27.7e3, 26.6e3, 2e3)
    for arc in [(0, np.pi), (0, 1.1), (2.0, np.pi), (0.4, 2.2)]:
        args = (3, 1e-4, 2e-3, k, edge, *arc)
        assert m.mean_force_n(*args) == approx(m.mean_force_closed_n(*args), rel=1e-6)


def test_floor_feedback_of_a_slot():
    # Per depth the mean force of a slot is (N c/4) (−K_r, K_t): the feed per revolution over four.
    feed_per_revolution, k = 0.4e-3, (2e9, 0.6e9, 0.0)
    per_depth = m.mean_force_closed_n(4, feed_per_revolution / 4, 1.0, k, (0, 0, 0), 0, np.pi)
    assert per_depth[:2] == approx(feed_per_revolution / 4 * np.array([-k[1], k[0]]))
    assert per_depth[1] == approx(2e5)
