"""Reference numbers of docs/physics/vibration.md."""

import friction as f
import numpy as np
from pytest import approx


def test_steady_amplitudes_at_300_rpm():
    y, z = f.steady_amplitude_um([0, 0.5, 0.7, 0.785, 0.9, 0.95, 1.0], 300.0)
    assert y[:6] == approx([207.4, 172.3, 136.9, 115.3, 73.9, 46.7], rel=3e-3)
    assert z[:6] == approx([129.8, 110.7, 91.1, 79.2, 56.5, 41.0], rel=3e-3)
    assert y[6] < 0.1 and z[6] < 0.1


def test_steady_amplitudes_at_400_rpm():
    y, _ = f.steady_amplitude_um([0, 0.5, 0.9], 400.0)
    assert y == approx([1013.1, 640.0, 134.7], rel=5e-3)


def test_motion_on_a_circle():
    ratios = [0.5, 0.785, 0.9]
    assert [f.circle_radius_um(r) for r in ratios] == approx([179.9, 128.7, 90.5], abs=0.06)
    y, z = f.steady_amplitude_um(ratios, 300.0, 0.0, (f.K2, f.K2), revolutions=150)
    assert y == approx([179.9, 128.7, 90.5], rel=5e-3)
    assert z == approx(y, rel=5e-3)


def test_published_amplitudes():
    found = [f.published_amplitude_um(r) for r in (0.0, 0.5, 0.7, 0.785)]
    assert found == approx([207.7, 160.2, 94.2, 6.6], abs=0.1)
    assert np.isnan(f.published_amplitude_um(0.9))
    # The amplitude that is left where the published rule sees none.
    assert f.circle_radius_um(np.pi / 4) / f.circle_radius_um(0.0) == approx(0.62, abs=2e-3)


def test_ramp():
    limit = 0.15 * 0.3e6 * 2 * np.pi / 4 * 0.032**2
    for rpm, free, held in [
        (300.0, [53, 104, 154, 205], [0, 0, 34, 142]),
        (400.0, [189, 481, 737, 964], [0, 0, 28, 288]),
    ]:
        found = f.ramp_um(rpm, [0.0, limit])
        assert found[0] == approx(free, rel=5e-3, abs=0.5)
        assert found[1] == approx(held, rel=5e-3, abs=0.5)


def test_den_hartog():
    r = 5.0 / 7.0
    expected = [1.984, 1.800, 1.533]
    assert [f.den_hartog(r, rho) for rho in (0.25, 0.5, 0.7)] == approx(expected, abs=6e-4)
    assert f.den_hartog(r, 0.85) == approx(1.22, abs=0.01)
    found = f.den_hartog_in_time(r, [0.25, 0.5, 0.7, 0.85])
    assert found[:3] == approx(expected, rel=5e-3)
    assert found[3] == approx(1.10, abs=0.01)


def test_order_along_a_line_and_round():
    """A motion that turns round along a line costs an order; one that goes round does not."""
    line, round_ = ((1.0, 0.0), (0.0, 0.0)), ((1.0, 0.3), (0.0, 0.4))
    errors = {}
    for name, start, parted in [
        ("line", line, False),
        ("line, parted", line, True),
        ("round", round_, False),
    ]:
        exact = f.decaying_swing(*start, 32768, parted=True)
        runs = [f.decaying_swing(*start, steps, parted) for steps in (256, 512, 1024)]
        errors[name] = [1e3 * np.abs(run - exact).max() for run in runs]
    assert errors["line"] == approx([6.1, 3.0, 1.5], rel=0.03)
    assert errors["line, parted"] == approx([5.1, 1.29, 0.32], rel=0.03)
    assert errors["round"] == approx([5.5, 1.38, 0.346], rel=0.03)
