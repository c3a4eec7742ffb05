"""Filters and distributions: docs/physics/sensors.md and diagnosis.md."""

import numpy as np
from scipy import integrate, signal


def wave():
    """The series that the filter's reference values belong to."""
    k = np.arange(60.0)
    return np.sin(0.05 * k) + 0.3 * np.sin(0.7 * k) + 0.01 * k


def zero_phase(order, cutoff, rate, values):
    """Butterworth low pass, forward and backward."""
    return signal.sosfiltfilt(signal.butter(order, cutoff, fs=rate, output="sos"), values)


def dilogarithm(x):
    """Li₂(x) by its integral."""
    return integrate.quad(lambda t: -np.log1p(-t) / t, 0, x)[0]


def low_pass_of_a_parabola(time_constant, coefficients, step, rest):
    """T y' + y = x over a step, x a polynomial (highest power first), y = rest at first."""
    rates = lambda t, y: (np.polyval(coefficients, t) - y) / time_constant
    return integrate.solve_ivp(rates, [0, step], [rest], rtol=1e-10, atol=1e-12).y[0, -1]
