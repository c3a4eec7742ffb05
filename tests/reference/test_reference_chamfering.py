"""Reference numbers of docs/physics/chamfering.md and pressure_foot.md."""

import chamfering as c
import numpy as np
from pytest import approx


def test_chip_area_is_the_closed_form():
    d, f = np.array([0.0, 0.3e-3, 1e-3]), c.FEED_M
    assert c.chip_area_m2(d) == approx((d + f / 2) * f * np.tan(c.HALF_ANGLE), rel=1e-12)


def test_forces_at_full_depth():
    assert c.rotating_force_n(c.DEPTH_M) == approx(109.68, abs=6e-3)
    assert c.axial_force_n(c.DEPTH_M) == approx(100.45, abs=5e-3)
    assert 1e6 * c.rotating_force_n(c.DEPTH_M) / c.ARM_N_PER_M[1] == approx(101.7, abs=0.05)
    assert 1e6 * c.axial_force_n(c.DEPTH_M) / c.ARM_N_PER_M[0] == approx(116, abs=0.5)


def test_foot_of_two_cylinders():
    assert 0.3e6 * c.PISTONS_M2 == approx(482.5, abs=0.1)
    assert 1e6 * 0.3e6 * c.PISTONS_M2 / c.ARM_N_PER_M[0] == approx(558, abs=0.5)
    gas = c.gas_stiffness_n_per_m(0.3e6)
    assert gas == approx(1.8e4, rel=0.01)
    assert c.axial_share(gas) == approx(0.02, abs=1e-3)


def test_threshold_pressures():
    assert c.paper_threshold_pa(c.MU) == approx(0.295e6, abs=500)
    assert c.exact_threshold_pa(c.MU, 1.0) == approx(0.392e6, abs=500)
    assert c.exact_threshold_pa(c.MU, 0.0) == approx(0.455e6, abs=500)


def test_the_published_pressure_is_too_low():
    ratio = lambda mu, share: c.exact_threshold_pa(mu, share) / c.paper_threshold_pa(mu)
    for mu, share, expected in [(0.1, 1, 1.31), (0.3, 1, 1.42), (0.1, 0, 1.44), (0.3, 0, 1.96)]:
        assert ratio(mu, share) == approx(expected, abs=0.011)


def test_first_slip_in_the_plane():
    assert 1e3 * c.first_slip_depth_m(0.3e6, 0.0) == approx(0.651, abs=5e-4)
    assert 1e3 * c.first_slip_depth_m(0.3e6, 1.0) == approx(0.759, abs=5e-4)


def test_first_slip_on_the_arm():
    share = c.axial_share(c.gas_stiffness_n_per_m(0.3e6))
    found = [c.first_slip_depth_on_the_arm_m(0.3e6, share, 0.525, sign) for sign in (-1, 1)]
    # Runs slip within the next revolution, when the worst direction comes round.
    for depth, run_mm in zip(found, (0.462, 0.440)):
        assert depth * 1e3 == approx(0.435, abs=2e-3)
        assert depth * 1e3 < run_mm < depth * 1e3 + 0.05


def test_regeneration_is_stiffer_than_the_arm():
    assert c.axial_process_stiffness_n_per_m() == approx(1.96e6)
    assert c.axial_process_stiffness_n_per_m() / c.ARM_N_PER_M[0] == approx(2.3, abs=0.05)
