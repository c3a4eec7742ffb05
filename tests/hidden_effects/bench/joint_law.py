"""What one joint does beside turning: transmission, friction and springs, with any effects hidden in it.

Motor coordinate theta, link coordinate q, wind-up w = theta + e(theta) - q with the transmission error e. On the link:

    transmission   K w + D w', or with play g  K (w -+ g/2) + D w' while wound up beyond it (never pulling the flanks
                   together), else nothing;  plus  c w^3  and  A z,  dz/dw = (1 - z sign(w')) / w_y  (Dahl)
    link           -b q',  spring  C cos q + S sin q,  constant force
    dry friction   between -F(+) and F(-), an impulse that stops the joint where it can; F grows by a share of what the
                   transmission passes on
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .effects import Effect

SWEEPS = 30


@dataclass
class JointLaw:
    """The law of one joint; keeps the memory of its hysteresis."""

    stiffness: float
    damping: float
    viscous_positive: float = 0.0
    viscous_negative: float = 0.0
    drag: float = 0.0
    friction_positive: float = 0.0
    friction_negative: float = 0.0
    load_share: float = 0.0
    excess: float = 0.0
    excess_speed: float = 1.0
    place_level: float = 0.0
    place_cycles: float = 0.0
    gap: float = 0.0
    loop: float = 0.0
    yield_windup: float = 1.0
    cubic: float = 0.0
    ripple_cosine: float = 0.0
    ripple_sine: float = 0.0
    cycles: float = 1.0
    spring_cosine: float = 0.0
    spring_sine: float = 0.0
    force: float = 0.0
    friction_from_s: float = -math.inf

    def __post_init__(self) -> None:
        self.z = 0.0
        self._w = 0.0

    @classmethod
    def of(cls, stiffness: float, damping: float, effects: list[Effect]) -> JointLaw:
        """The law with all effects that act on this joint."""
        law = cls(stiffness, damping)
        for effect in effects:
            law._add(effect.kind, effect.values)
            law.friction_from_s = max(law.friction_from_s, effect.from_s)
        return law

    def _add(self, kind: str, v: dict[str, float]) -> None:
        if kind == "joint_stiffness":
            self.stiffness *= v["factor"]
        elif kind == "joint_damping":
            self.damping *= v["factor"]
        elif kind == "joint_viscous":
            self.viscous_positive += v["viscous_n_m_s_per_rad"]
            self.viscous_negative += v["viscous_n_m_s_per_rad"]
        elif kind == "joint_asymmetric_viscous":
            self.viscous_positive += v["viscous_positive_n_m_s_per_rad"]
            self.viscous_negative += v["viscous_negative_n_m_s_per_rad"]
        elif kind == "joint_coulomb":
            self.friction_positive += v["friction_n_m"]
            self.friction_negative += v["friction_n_m"]
        elif kind == "joint_asymmetric_coulomb":
            self.friction_positive += v["friction_positive_n_m"]
            self.friction_negative += v["friction_negative_n_m"]
        elif kind == "joint_load_friction":
            self.load_share = v["share"]
        elif kind == "joint_stribeck":
            self.excess, self.excess_speed = v["excess_n_m"], v["speed_rad_per_s"]
        elif kind == "joint_backlash":
            self.gap = v["gap_rad"]
        elif kind == "joint_hysteresis":
            self.loop, self.yield_windup = v["amplitude_n_m"], v["yield_windup_rad"]
        elif kind == "joint_cubic_stiffness":
            self.cubic = v["cubic_n_m_per_rad3"]
        elif kind == "joint_ripple":
            self.ripple_cosine, self.ripple_sine, self.cycles = v["cosine_rad"], v["sine_rad"], v["cycles"]
        elif kind == "joint_counterbalance":
            self.spring_cosine, self.spring_sine = v["cosine_n_m"], v["sine_n_m"]
        elif kind == "joint_offset":
            self.force += v["force_n_m"]
        elif kind == "outside_quadratic_drag":
            self.drag = v["drag_n_m_s2_per_rad2"]
        elif kind == "outside_place_dependent_friction":
            self.place_level, self.place_cycles = v["level_n_m"], v["cycles"]
        elif kind != "joint_zero":  # the arm is built with it
            raise ValueError(f"{kind} is no effect of a joint")

    def windup(self, theta: float, theta_rate: float, q: float, q_rate: float) -> tuple[float, float]:
        """Wind-up and its rate."""
        w, rate = theta - q, theta_rate - q_rate
        if self.ripple_cosine or self.ripple_sine:
            sin, cos = math.sin(self.cycles * theta), math.cos(self.cycles * theta)
            w += self.ripple_cosine * cos + self.ripple_sine * sin
            rate += self.cycles * theta_rate * (self.ripple_sine * cos - self.ripple_cosine * sin)
        return w, rate

    def start(self, w: float) -> None:
        """Lays the hysteresis to rest at this wind-up."""
        self.z, self._w = 0.0, w

    def transmission(self, w: float, rate: float) -> float:
        """Torque of the transmission on the link at this wind-up; moves the memory there."""
        if self.loop:
            change = w - self._w
            end = math.copysign(1.0, change)
            self.z = end + (self.z - end) * math.exp(-abs(change) / self.yield_windup)
            self._w = w
        return self.static(w, rate) + self.loop * self.z

    def static(self, w: float, rate: float) -> float:
        """What of that has no memory."""
        if self.gap:
            half = 0.5 * self.gap
            if w > half:
                flank = max(0.0, self.stiffness * (w - half) + self.damping * rate)
            elif w < -half:
                flank = min(0.0, self.stiffness * (w + half) + self.damping * rate)
            else:
                flank = 0.0
        else:
            flank = self.stiffness * w + self.damping * rate
        return flank + self.cubic * w * w * w

    def link(self, q: float, rate: float) -> float:
        """Torque on the link beside transmission and dry friction."""
        viscous = self.viscous_positive if rate > 0.0 else self.viscous_negative
        found = self.force - viscous * rate - self.drag * rate * abs(rate)
        if self.spring_cosine or self.spring_sine:
            found += self.spring_cosine * math.cos(q) + self.spring_sine * math.sin(q)
        return found

    @property
    def rubs(self) -> bool:
        """Whether there is any dry friction."""
        dry = max(self.friction_positive, self.friction_negative, self.load_share)
        return max(dry, self.excess, self.place_level) > 0.0

    def friction_bounds(self, t: float, q: float, rate: float, load: float) -> tuple[float, float]:
        """Smallest and largest torque that dry friction can exert on the link while the transmission passes on `load`."""
        if t < self.friction_from_s:
            return 0.0, 0.0
        more = self.load_share * abs(load)
        more += self.place_level * (1.0 + math.sin(self.place_cycles * q)) if self.place_level else 0.0
        if self.excess:
            ratio = rate / self.excess_speed
            more += self.excess * math.exp(-ratio * ratio)
        return -(self.friction_positive + more), self.friction_negative + more


def stopping(free: np.ndarray, mobility: np.ndarray, bounds: dict[int, tuple[float, float]], step_s: float) -> np.ndarray:
    """Torques of dry friction over a step at whose end the joints would have the velocities `free`: impulses within their
    bounds that stop what they can (projected Gauss-Seidel)."""
    impulse = np.zeros(free.size)
    for _ in range(1 if len(bounds) == 1 else SWEEPS):
        for i, (low, high) in bounds.items():
            end = free[i] + float(mobility[i] @ impulse)
            impulse[i] = min(max(impulse[i] - end / mobility[i, i], low * step_s), high * step_s)
    return impulse / step_s
