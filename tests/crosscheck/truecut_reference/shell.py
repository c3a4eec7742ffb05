"""A rubber shell pressed onto a plane, by ways of its own: a hollow elastic sphere, ring by ring.

In the logarithm of the radius the equations of a hollow sphere under a pressure P_n(cos) have constant coefficients; their exponents and vectors are
found as eigenvalues, and the stresses at both faces fix them. What the shell yields more than a solid sphere is stiffened by the air's tension; the solid
sphere is a half-space. The contact is an obstacle problem: constant pressures on rings, those that would pull are let go.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.interpolate
import scipy.optimize
from scipy.special import j0, j1

RINGS = 60
# over the root of twice the approach: how far the rings reach
REACH = 1.05
APPROACHES = 20


def yields(n: int, thickness: float, poisson: float) -> float:
    """Deflection of a sphere of radius 1 under the pressure P_n, times E*; thickness 1 is solid."""
    lame, degree = 2.0 * poisson / (1.0 - 2.0 * poisson), n * (n + 1.0)
    confined = lame + 2.0
    # u_r, u_t, r times the radial and the shear stress; their changes over ln r
    stretched = np.array([2.0, -degree, 0.0, 0.0])
    radial = np.array([-2.0 * lame, lame * degree, 1.0, 0.0]) / confined
    grows = np.array(
        [
            radial,
            [-1.0, 1.0, 0.0, 1.0],
            2.0 * lame * radial + 2.0 * (lame + 1.0) * stretched + [0.0, 0.0, -1.0, degree],
            -lame * (radial + stretched) - 2.0 * np.array([1.0, 1.0 - degree, 0.0, 0.0]) + [0.0, 0.0, 0.0, -2.0],
        ]
    )
    if n == 0:
        grows = grows[np.ix_([0, 2], [0, 2])]
    powers, vectors = (np.real(part) for part in np.linalg.eig(grows))
    half = len(powers) // 2
    outwards = powers > 0.0
    inside = 0.0 if thickness >= 1.0 else 1.0 - thickness
    # growing ones are 1 outside, falling ones 1 inside
    far = np.power(inside, np.abs(powers))
    at_outer, at_inner = np.where(outwards, 1.0, far), np.where(outwards, far, 1.0)
    stresses = np.vstack([vectors[half:] * at_outer, vectors[half:] * at_inner])
    sides = np.zeros(2 * half)
    sides[0] = 1.0
    parts = np.linalg.solve(stresses, sides)
    return float((vectors[0] * at_outer) @ parts) * 2.0 / (1.0 - poisson)


class Shell:
    """Contacts with a plane; lengths over the radius, forces over E* R^2, tension over E* R."""

    def __init__(self, thickness: float, poisson: float, tension: float, deepest: float) -> None:
        self.n = np.arange(0, max(20, math.ceil(12.0 / thickness)), 2)
        more = np.array([yields(n, thickness, poisson) - yields(n, 1.0, poisson) for n in self.n])
        stretched = np.maximum((self.n - 1.0) * (self.n + 2.0), 0.0) * tension
        self.k, self.more = self.n + 0.5, more / (1.0 + stretched * more)
        # a half-space under rings between 0 and 1
        self.edges = np.linspace(0.0, 1.0, RINGS + 1)
        self.middles = 0.5 * (self.edges[1:] + self.edges[:-1])
        waves = np.arange(0.25, 6000.0, 0.5)
        self.half_space = 2.0 * j0(np.outer(self.middles, waves)) * 0.5 @ self._rings(self.edges, waves)
        roots = np.sqrt(deepest) * (np.arange(1, APPROACHES + 1) / APPROACHES)
        rows = np.array([self.contact(x * x) for x in roots])
        # force and radius over those of Hertz
        shares = np.column_stack([rows[:, 0] / (4.0 / 3.0 * roots**3), rows[:, 1] / roots])
        self.table = scipy.interpolate.CubicSpline(np.append(0.0, roots), np.vstack([[1.0, 1.0], shares]))

    @staticmethod
    def _rings(edges: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Hankel transforms of rings of pressure 1."""
        whole = edges * j1(np.outer(waves, edges)) / waves[:, None]
        return whole[:, 1:] - whole[:, :-1]

    def contact(self, approach: float) -> tuple[float, float]:
        """Force and radius of the patch."""
        reach = REACH * math.sqrt(2.0 * approach) if approach else 0.0
        edges, middles = reach * self.edges, reach * self.middles
        # w = sum of C_n (2n+1)/2 P_n over the transforms, twice for the opposite plane
        shell = 2.0 * j0(np.outer(middles, self.k)) * (self.more * self.k) @ self._rings(edges, self.k)
        sinks = reach * self.half_space + shell
        asked = approach - middles**2 / 2.0
        touches = middles < math.sqrt(approach)
        for _ in range(200):
            pressure = np.zeros(RINGS)
            pressure[touches] = np.linalg.solve(sinks[np.ix_(touches, touches)], asked[touches])
            now = np.where(touches, pressure > 0.0, sinks @ pressure < asked)
            if (now == touches).all():
                break
            touches = now
        force = math.pi * float(pressure @ (edges[1:] ** 2 - edges[:-1] ** 2))
        # towards the rim the pressure falls like a root: its square is smooth
        last = int(np.flatnonzero(touches)[-1])
        near = slice(max(last - 12, 0), last - 1)
        square = np.polynomial.Polynomial.fit(middles[near] ** 2, pressure[near] ** 2, 2)
        rim = [float(x.real) for x in square.roots() if x.real > middles[last - 2] ** 2]
        return force, math.sqrt(min(rim))

    def at(self, approach: float) -> tuple[float, float, float]:
        """Force, a^2/2 and the rate of that."""
        x = math.sqrt(approach)
        force, radius = (float(part) for part in self.table(x))
        slope = float(self.table(x, 1)[1])
        return force * 4.0 / 3.0 * x**3, 0.5 * (radius * x) ** 2, 0.5 * radius * (radius + x * slope)
