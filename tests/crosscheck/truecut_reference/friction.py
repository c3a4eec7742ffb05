"""Dry friction in a plane as an impulse that either stops the foot within the step or opposes its sliding.

Over one step of length h the foot, left alone, would end with the in-plane velocity v. The impulse P on the robot
changes that to v + W P, with W the inverse effective mass of the arm at the foot (2 x 2, symmetric). Coulomb's law:

    |P| <= L = mu N h,   and   v + W P = 0   or   P = -L (v + W P) / |v + W P|.

The second case reads (W + a I) P = -v with a = |v + W P| / L > 0, one equation |P(a)| = L in one unknown.
Nothing is smoothed: a foot that can be held is held with exactly zero predicted velocity.
"""

from __future__ import annotations

import math


def coulomb_impulse(
    vy: float, vz: float, wyy: float, wyz: float, wzz: float, limit: float
) -> tuple[float, float, bool]:
    """Impulse on the robot (N s), and whether the foot slides, for the free end velocity (vy, vz) in m/s.

    `wyy`, `wyz`, `wzz` are the entries of the inverse effective mass (1/kg), `limit` is mu N h (N s).
    """
    if limit <= 0.0:
        return 0.0, 0.0, True
    det = wyy * wzz - wyz * wyz
    py = (wyz * vz - wzz * vy) / det
    pz = (wyz * vy - wyy * vz) / det
    size = math.hypot(py, pz)
    if size <= limit:
        return py, pz, False
    a = 0.0
    # 1/|P(a)| is concave and nearly linear in a; Newton from the left converges in a few steps.
    for _ in range(30):
        gap = size / limit - 1.0
        if abs(gap) < 1e-13:
            break
        # d|P|/da = -P.(W+aI)^-1 P / |P|
        qy = ((wzz + a) * py - wyz * pz) / det
        qz = ((wyy + a) * pz - wyz * py) / det
        a += gap * size * size / (py * qy + pz * qz)
        dy, dz = wyy + a, wzz + a
        det = dy * dz - wyz * wyz
        py = (wyz * vz - dz * vy) / det
        pz = (wyz * vy - dy * vz) / det
        size = math.hypot(py, pz)
    return py, pz, True


class FootFriction:
    """Friction coefficient of the law chosen in the scenario; holds whether the foot slid in the last step."""

    def __init__(self, friction) -> None:
        if friction.law not in ("coulomb", "stribeck", "none"):
            raise NotImplementedError(f"friction law '{friction.law}' has no counterpart in the reference")
        self.law = friction.law
        self.mu = 0.0 if friction.law == "none" else friction.mu
        self.mu_static = friction.mu_static
        self.speed_m_per_s = friction.stribeck_speed_m_per_s

    def coefficient(self, slip_speed_m_per_s: float) -> float:
        """Friction coefficient at the given slip speed (Stribeck: kinetic + rest * exp(-(v/v_s)^2))."""
        if self.law != "stribeck":
            return self.mu
        ratio = slip_speed_m_per_s / self.speed_m_per_s
        return self.mu + (self.mu_static - self.mu) * math.exp(-ratio * ratio)
