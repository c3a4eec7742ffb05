"""A belt over a contact wheel on a plane, written a second time: the wheel in many thin slices, each summed point by point.

A slice that reaches in by d touches over the half width b of rubber bonded to a hub, whose force is a_0 times that of Hertz's line contact
(`bonded.py`). Above the rim the wheel overlaps by u = (b^2 - x^2)/2R and presses with a_0 E*/sqrt(2R) sqrt(u), the
belt of tension N per width beside it with N/R; the belt lifts off where it leaves without a kink, (N c/R)^2 = 2N integral of that pressure. The bed's damping
answers the rate at which the surface is pressed in. A carrier without mass may move the wheel along the tool's z axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.interpolate
import scipy.optimize

from .bonded import Layer
from .led_run import LedRun
from .plant import Plant
from .wheel import Command

SLICES, POINTS = 24, 48
# of the rubber: the half width up to which depths are tabled
WIDEST = 2.5


@dataclass(frozen=True)
class Tool:
    """Wheel, belt and plane, SI."""

    radius: float
    width: float
    modulus: float
    tension: float
    damping: float
    speed: float
    mu: float
    # outward normal of the plane (world), and its height along that
    normal: np.ndarray
    height: float
    # held force, its damping, fastest speed, stroke; none where the path alone presses
    control: tuple[float, float, float, float] | None
    deepest: float
    table: scipy.interpolate.CubicSpline

    @staticmethod
    def of(t: dict, job: dict, outside: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> Tool:
        """From `[process.belt]` and its path job on a plane with this normal (world)."""
        wheel = job["wheel"]
        radius, modulus = wheel["radius_mm"] * 1e-3, wheel["modulus_mpa"] * 1e6
        width = wheel["width_mm"] * 1e-3
        rubber, poisson, tension = t["rubber_mm"] * 1e-3, t["poisson"], t["tension_n"] / width
        control = t.get("control")
        if control is not None:
            assert control["law"] == "constant_force"
            keys = ("force_n", "damping_n_s_per_mm", "fastest_mm_per_s", "stroke_mm")
            force, damping, fastest, stroke = (float(control[key]) for key in keys)
            control = (force, damping * 1e3, fastest * 1e-3, stroke * 1e-3)

        layer = Layer(poisson)

        def row(depth: float) -> tuple[float, float, float, float]:
            """Overlap in the middle, its rate per indentation, force over Hertz's, half width of the patch."""
            wide, factor, rate = layer.at(2.0 * radius * depth / rubber**2)
            b = wide * rubber
            u0 = b * b / (2.0 * radius)
            energy = factor * modulus / math.sqrt(2.0 * radius) * 2.0 / 3.0

            def kink(c: float) -> float:
                u = max(u0 - c * c / (2.0 * radius), 0.0)
                return 2.0 * tension * energy * u**1.5 - (tension * c / radius) ** 2

            return u0, rate, factor, scipy.optimize.brentq(kink, 1e-9, b, xtol=1e-15)

        # over the root of the depth, in which all four are smooth down to nothing
        deepest = layer.patch(WIDEST)[1] * (WIDEST * rubber) ** 2 / (2.0 * radius)
        roots = np.linspace(1e-3, math.sqrt(deepest / radius), 800)
        rows = np.array([row(root * root * radius) for root in roots])
        return Tool(
            radius=radius,
            width=width,
            modulus=modulus,
            tension=tension,
            damping=t["damping_pa_s_per_m"],
            speed=t["belt_m_per_s"],
            mu=t["mu"],
            normal=np.array(outside),
            height=float(np.dot(job["surface"]["xyz_mm"], outside)) * 1e-3,
            control=control,
            deepest=deepest,
            table=scipy.interpolate.CubicSpline(roots, rows),
        )

    def loads(
        self,
        centre: np.ndarray,
        axes: np.ndarray,
        velocity: np.ndarray,
        turning: np.ndarray,
        eccentricity: tuple[float, float] = (0.0, 0.0),
    ) -> np.ndarray:
        """Force and moment on the wheel about its centre, world axes; then the sum of normal forces, friction on the plane along the tool's
        x axis, and the power of sliding over mu. `eccentricity`: how much further the wheel reaches, and the rate of that."""
        axis, normal = axes[:, 1], self.normal
        lean = math.sqrt(1.0 - float(axis @ normal) ** 2)
        to_axis = (normal - float(axis @ normal) * axis) / lean
        run = np.cross(axis, normal) / lean
        along = self.width * ((np.arange(SLICES) + 0.5) / SLICES - 0.5)
        middle = centre + along[:, None] * axis
        distance = (middle @ normal - self.height) / lean
        depth = self.radius + eccentricity[0] - distance
        touches = depth > 1e-6 * self.radius
        if not touches.any():
            return np.zeros(9)
        middle, distance, depth = middle[touches], distance[touches], depth[touches]
        assert depth.max() < self.deepest
        u0, rate, factor, c = self.table(np.sqrt(depth / self.radius)).T
        # by the sine of an angle, in which pressures that fall to zero like a root are smooth
        angle = math.pi * ((np.arange(POINTS) + 0.5) / POINTS - 0.5)
        x, dx = c[:, None] * np.sin(angle), c[:, None] * np.cos(angle) * math.pi / POINTS
        foot = middle - distance[:, None] * to_axis
        arm = foot[:, None, :] + x[..., None] * run - centre
        slide = velocity + np.cross(turning, arm) - self.speed * run
        slide -= (slide @ normal)[..., None] * normal
        reach = velocity + np.cross(turning, foot - centre)
        approach = eccentricity[1] - (reach @ normal) / lean
        inwards = rate[:, None] * approach[:, None] - (slide @ run) * x / self.radius
        u = np.maximum(u0[:, None] - x * x / (2.0 * self.radius), 0.0)
        rubber = self.modulus * factor[:, None] * np.sqrt(u / (2.0 * self.radius))
        pressure = rubber + self.tension / self.radius + self.damping * inwards
        pressed = np.maximum(pressure, 0.0) * dx * self.width / SLICES / lean
        speed = np.linalg.norm(slide, axis=2)
        friction = self.mu * (pressed / speed)[..., None] * slide
        force = pressed[..., None] * normal - friction
        moment = np.cross(arm, force).sum(axis=(0, 1))
        told = pressed.sum(), friction.sum(axis=(0, 1)) @ axes[:, 0], (pressed * speed).sum()
        return np.array([*force.sum(axis=(0, 1)), *moment, *told])


class BeltRun(LedRun):
    """The arm in MuJoCo under the belt's loads, along the recorded command."""

    def __init__(self, tool: Tool, plant: Plant, command: Command) -> None:
        super().__init__(plant, command)
        self.tool = tool
        self.out, self.rate, self.pushed = 0.0, 0.0, 0.0

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Told: the sum of normal forces, friction along the tool's x axis, power of sliding over mu."""
        place, axes, velocity, turning = self.tool_at(q, v)
        out = self.out * axes[:, 2]
        velocity = velocity + np.cross(turning, out) + self.rate * axes[:, 2]
        found = self.tool.loads(place + out, axes, velocity, turning, self.eccentricity(t))
        self.pushed = -float(found[:3] @ axes[:, 2])
        return found[:3], found[3:6] + np.cross(out, found[:3]), found[6:]

    def eccentricity(self, _t: float) -> tuple[float, float]:
        """How much further than its radius the wheel reaches, and the rate of that."""
        return 0.0, 0.0

    def missing(self, force: float) -> float:
        """What a carrier without mass makes up for."""
        return force - self.pushed

    def advance(self, h: float) -> None:
        """Moves the carrier by what is missing of its force."""
        if self.tool.control is None:
            return
        force, damping, fastest, stroke = self.tool.control
        self.rate = min(max(self.missing(force) / damping, -fastest), fastest)
        moved = self.out + h * self.rate
        self.out = min(max(moved, -stroke), stroke)
        if self.out != moved:
            self.rate = 0.0
