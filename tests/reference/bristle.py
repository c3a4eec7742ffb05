"""One bristle as an elastica, and the edge that a brush rounds: docs/physics/brush.md.

Forces in units of EI/L², lengths in units of L.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


def law(shortening, friction=0.0):
    """Slight bending, N / (1 + Nμ/(3Y)), Y = √(5δ/3), N Euler's load."""
    return np.pi**2 / 4 / (1 + np.pi**2 / 12 * friction / np.sqrt(5 * shortening / 3))


def frictionless(shortening):
    """Exact axial force: δ = 2 (1 − E/K), n = K²."""
    m = brentq(lambda m: 2 * (1 - ellipe(m) / ellipk(m)) - shortening, 1e-12, 0.9)
    return ellipk(m) ** 2


def elastica(tip_angle, friction):
    """Force and shortening of a clamped bristle whose tip turns by an angle under n and μn: θ'' =
    −n (sin θ + μ cos θ).
    """

    def along(n, dense=False):
        rates = lambda s, y: [y[1], -n * (np.sin(y[0]) + friction * np.cos(y[0])), np.cos(y[0])]
        return solve_ivp(rates, [1, 0], [tip_angle, 0, 0], rtol=1e-10, atol=1e-12).y[:, -1]

    most = 4.0
    n = brentq(lambda n: along(n)[0], 1e-6, most)
    return n, 1 + along(n)[2]


def exact(shortening, friction):
    """Normal force of the elastica at a shortening."""
    angle = brentq(lambda a: elastica(a, friction)[1] - shortening, 0.02, 1.5)
    return elastica(angle, friction)[0]


def edge_radius(dose, preston, tip, angle):
    """Radius of an edge after a dose (J/m²) by integration of 2 c r dr = k_p (t + a r) dD."""
    c = 1 / np.tan(angle / 2) - (np.pi - angle) / 2
    a = 2 * np.cos(angle / 2)
    # In r²: d(r²)/dD = k_p (t + a r)/c is regular at 0.
    found = solve_ivp(
        lambda _, y: [preston * (tip + a * np.sqrt(max(y[0], 0))) / c],
        [0, dose],
        [0],
        rtol=1e-9,
        atol=1e-20,
    )
    return np.sqrt(found.y[0, -1]), c, a
