"""A cylinder on rubber bonded to a hub, in plane strain, by ways of its own.

The answer of the layer to a pressure p cos kx is solved through its thickness: displacements and stresses obey a linear system, carried from the
bonded face to the free one by a matrix exponential. Two contacts are made of it:

`Layer.patch`: a slack belt. The slope of the contact is a singular integral equation, collocated at Chebyshev's points (Erdogan and Gupta 1972).
`line_load`: a belt under tension over the layer, whose answer is 1/(E* k/2M + N k^2), as an obstacle problem on a grid: nothing is taken to be local.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.interpolate
import scipy.linalg

NODES, WIDEST_S = 80, 9.0


def answer(s: float, poisson: float) -> float:
    """M: deflection of the layer over that of a half-space, for waves of s/h."""
    lame, shear = 2.0 * poisson / (1.0 - 2.0 * poisson), 1.0
    confined = lame + 2.0 * shear
    through = np.array(
        [
            [0.0, s, 1.0 / shear, 0.0],
            [-lame * s / confined, 0.0, 0.0, 1.0 / confined],
            [4.0 * shear * (lame + shear) / confined * s * s, 0.0, 0.0, lame / confined * s],
            [0.0, 0.0, -s, 0.0],
        ]
    )
    top = scipy.linalg.expm(through)[:, 2:]
    stresses = np.linalg.solve(top[2:], [0.0, 1.0])
    return float(top[1] @ stresses) * s * shear / (1.0 - poisson)


class Layer:
    """Line contact of rubber of one Poisson's ratio; lengths in its thickness."""

    def __init__(self, poisson: float) -> None:
        x, weight = np.polynomial.legendre.leggauss(NODES)
        self.s, self.weight = 0.5 * WIDEST_S * (x + 1.0), 0.5 * WIDEST_S * weight
        self.m = np.array([answer(s, poisson) for s in self.s])
        # over the logarithm of the half width, in which both are smooth
        logs = np.linspace(math.log(1e-4), math.log(3.0), 90)
        rows = np.array([self.patch(math.exp(x)) for x in logs])
        self.table = scipy.interpolate.CubicSpline(logs, np.log(rows))

    def patch(self, wide: float, points: int = 24) -> tuple[float, float]:
        """Force over Hertz's at the same half width, and the approach over b^2/2R, at a half width over the thickness."""
        j, r = np.arange(1, points + 1), np.arange(1, points + 2)
        at, asked = np.cos(np.pi * j / (points + 1)), np.cos(np.pi * (2 * r - 1) / (2 * points + 2))
        # on the middle the equation says nothing: both sides are odd
        asked = np.delete(asked, points // 2)
        weights = np.pi * (1.0 - at * at) / (points + 1)
        apart = asked[:, None] - at
        rest = np.sin(self.s * wide * apart[..., None]) @ ((1.0 - self.m) * self.weight)
        height = np.linalg.solve((1.0 / apart - wide * rest) * weights, asked)
        # p = E* b/2R pi sqrt(1 - x^2) height: Hertz's is 1/pi
        force = 2.0 * weights @ height
        polynomial = np.polynomial.Chebyshev.fit(at, height, points - 1, domain=[-1, 1])
        nodes, share = np.polynomial.legendre.leggauss(120)
        t = 0.5 * (nodes + 1.0)
        x, dx = t**4, 4.0 * t**3 * 0.5 * share
        smooth = np.cos(self.s * wide * x[:, None]) @ ((self.m - 1.0 + np.exp(-self.s)) / self.s * self.weight)
        sunk = smooth + 0.5 * np.log1p(1.0 / (wide * x) ** 2)
        return float(force), float(4.0 * (np.sqrt(1.0 - x * x) * polynomial(x) * sunk) @ dx)

    def at(self, approach: float) -> tuple[float, float, float]:
        """B, a_0 and the rate of B^2 at an approach of 2 R d/h^2."""
        low, high = self.table.x[0], self.table.x[-1]
        reached = lambda x: 2.0 * x + float(self.table(x)[1]) - math.log(approach)
        x = scipy.optimize.brentq(reached, low, high, xtol=1e-14)
        rate = 2.0 / (2.0 + float(self.table(x, 1)[1])) * math.exp(2.0 * x) / approach
        return math.exp(x), math.exp(float(self.table(x)[0])), rate


def line_load(depth: float, radius: float, modulus: float, rubber: float, poisson: float, tension: float, points: int = 2048) -> float:
    """Force per width at a depth on a surface of relative radius `radius`, N/m: the obstacle problem, periodic over 14 thicknesses."""
    length = 14.0 * rubber
    step = length / points
    waves = np.maximum(2.0 * np.pi * np.fft.rfftfreq(points, step) * rubber, 1e-3)
    grid = np.linspace(1e-3, WIDEST_S, 300)
    m = np.interp(waves, grid, _answers(poisson), right=1.0)
    yields = 1.0 / (modulus * waves / (2.0 * rubber * m) + tension * (waves / rubber) ** 2)
    reach = min(points // 4, int(1.5 * math.sqrt(2.0 * radius * depth) / step))
    row = np.fft.irfft(yields, points)[: 2 * reach + 1]
    sinks = scipy.linalg.toeplitz(row)
    x = np.arange(-reach, reach + 1) * step
    reaches_in = depth - x * x / (2.0 * radius)
    # the patch is an interval: it loses ends that pull and takes up ends that would cut in
    half = int(math.sqrt(2.0 * radius * depth) / step * 0.7)
    seen = set()
    while half not in seen:
        seen.add(half)
        inside = slice(reach - half, reach + half + 1)
        pressed = np.linalg.solve(sinks[inside, inside], reaches_in[inside])
        if pressed[0] < 0.0 and half > 1:
            half -= 1
        elif sinks[reach + half + 1, inside] @ pressed < reaches_in[reach + half + 1]:
            half += 1
    return float(pressed.sum()) * step


_KEPT: dict[float, np.ndarray] = {}


def _answers(poisson: float) -> np.ndarray:
    if poisson not in _KEPT:
        _KEPT[poisson] = np.array([answer(s, poisson) for s in np.linspace(1e-3, WIDEST_S, 300)])
    return _KEPT[poisson]
