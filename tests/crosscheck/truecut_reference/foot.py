"""Normal force of the pressure foot: preload, gas spring, and a rod that its seal holds until it breaks away.

    N = max(0, n p A + k_g x + s),   s <- clamp(s + k_rod dx, -limit, +limit),

with x the advance of the foot along the feed axis since touch-down and s zero there.
"""

from __future__ import annotations

from .scenario import Foot


class FootNormal:
    """Evaluated once a step at the mid-step advance; keeps the seal's history."""

    def __init__(self, foot: Foot, arm_stiffness_n_per_m: float) -> None:
        self.preload_n = foot.preload_n
        self.gas_n_per_m = foot.gas_stiffness_n_per_m(arm_stiffness_n_per_m)
        self.rod_n_per_m = foot.rod_stiffness_n_per_m
        self.limit_n = foot.seal_stiction_n
        self.axial_share = self.gas_n_per_m / (self.gas_n_per_m + arm_stiffness_n_per_m)
        self.seal_n = 0.0
        self._advance_m = 0.0

    def advance_to(self, advance_m: float) -> float:
        """Normal force (N, on the workpiece) with the foot at the given advance; moves the seal's memory there."""
        seal = self.seal_n + self.rod_n_per_m * (advance_m - self._advance_m)
        self.seal_n = min(max(seal, -self.limit_n), self.limit_n)
        self._advance_m = advance_m
        return max(0.0, self.preload_n + self.gas_n_per_m * advance_m + self.seal_n)
