"""Reference numbers of docs/physics/sensors.md and diagnosis.md."""

import numpy as np
import pytest
import series
from pytest import approx
from scipy import special, stats

PLACES = [0, 1, 17, 40, 59]


@pytest.mark.parametrize(
    "order, cutoff, rate, expected",
    [
        (4, 50, 1000, [0.0040207596, 0.0678341268, 0.9184695340, 1.3020299825, 0.6312427102]),
        (3, 120, 1000, [0.0011141094, 0.1805888065, 0.8063948509, 1.3596506179, 0.6505836227]),
        (2, 5, 100, [-0.0090202986, 0.0572645220, 0.9148224102, 1.3123746347, 0.6376098371]),
        (1, 10, 100, [0.0013961713, 0.1458316830, 0.8348805041, 1.3398707758, 0.6462079067]),
    ],
)
def test_filter_without_delay(order, cutoff, rate, expected):
    found = series.zero_phase(order, cutoff, rate, series.wave())
    assert found[PLACES] == approx(expected, abs=1e-9)


def test_low_pass_is_exact_on_parabolas():
    time_constant, step, y0 = 0.3, 0.2, -2.0
    x = np.poly1d([7.0, -3.0, 1.0])
    settled = x - time_constant * x.deriv() + time_constant**2 * x.deriv(2)
    closed = settled(step) + (y0 - settled(0.0)) * np.exp(-step / time_constant)
    found = series.low_pass_of_a_parabola(time_constant, x.coefficients, step, y0)
    assert found == approx(closed, rel=1e-7)


def test_tails_of_distributions():
    assert stats.norm.sf(1.959964) == approx(0.025, rel=1e-5)
    assert stats.norm.sf(10.0) == approx(7.619853e-24, rel=1e-6)
    assert stats.chi2.sf([18.307, 29.588], 10) == approx([0.05, 0.001], rel=2e-4)
    assert stats.chi2.ppf(0.5, 1) == approx(0.454936, rel=1e-6)
    assert stats.f.sf(3.325835, 5, 10) == approx(0.05, rel=1e-5)
    assert stats.t.sf(2.570582, 5) == approx(0.025, rel=1e-5)


def test_logarithms_of_neighbouring_powers():
    # Hann window: amplitudes of bins 1 and 2 apart correlate by 2/3 and 1/6.
    window = np.hanning(4097)[:-1] ** 2
    leak = np.abs(np.fft.rfft(window)) / window.sum()
    assert leak[1:3] == approx([2 / 3, 1 / 6], abs=1e-6)
    scale = np.pi**2 / 6
    assert special.polygamma(1, 1.0) == approx(scale)
    shares = [series.dilogarithm(rho**2) / scale for rho in (2 / 3, 1 / 6)]
    assert shares == approx([0.308, 0.017], abs=5e-4)
