"""Process damping: the damper against the overlap of the land."""

import numpy as np
import pytest

import flank


def test_reference_damper_of_a_worn_flank_and_the_overlap_of_its_land():
    """Slot at 300 rpm: the page's rates to four places."""
    printed = {"sharp": 0.8677, "law": 0.7665, "overlap": 0.7674}
    for law, rate in printed.items():
        found = flank.growth_per_s(*flank.motion(300, 0.0, np.pi, law))
        assert found == pytest.approx(rate, abs=2e-4), law
