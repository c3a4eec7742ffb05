"""A wheel brush on a block, written a second time: ray by ray against the block's six planes.

Every ray stands for the bristles of a small sector of a thin slice. It leaves the axis square to it and enters the block behind the last
of the planes that it comes through. Held there, a bristle is an elastica, EI theta'' = -n (sin theta + mu cos theta), clamped in the hub: it is
integrated from its tip, where it does not bend, as long as it takes to come to the hub's direction, and so for many tips.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from .led_run import LedRun
from .plant import Plant
from .wheel import Command

# the block is convex: a bristle that meets it stands within acos(1 - depth/R) of the way to its nearest point; enough for R/14
WITHIN_RAD = 0.38


@functools.cache
def bent(mu: float) -> PchipInterpolator:
    """Force of a bristle in EI/L^2 over the square root of what it lacks, in L, for a coefficient of friction.

    With phi = theta + atan mu the curve is phi'' = -sin phi in lengths of sqrt(EI/P), P the force on the tip.
    """
    lean = math.atan(mu)
    lacks, forces = [0.0], [math.pi**2 / 4.0 if mu == 0.0 else 0.0]

    def hub(_, y):
        return y[0] - lean

    hub.terminal = True
    for inclined in np.geomspace(1e-3, 1.4, 120):
        def rates(_, y):
            return [y[1], -math.sin(y[0]), 1.0 - math.cos(y[0] - lean)]

        curve = solve_ivp(rates, [0.0, 10.0], [lean + inclined, 0.0, 0.0], events=hub, rtol=1e-9, atol=1e-13)
        length = curve.t_events[0][0]
        lacks.append(math.sqrt(curve.y_events[0][0][2] / length))
        forces.append(length**2 * math.cos(lean))
    return PchipInterpolator(lacks, forces)


@dataclass(frozen=True)
class Tool:
    """Brush and block, SI. The block's frame is turned by nothing against the world's."""

    radius: float
    width: float
    bristles: float
    length: float
    bending: float
    mu: float
    spin: float
    corner: np.ndarray
    size: np.ndarray
    # one slice is enough where the block is the same all along the axis
    slices: int = 48
    angles: int = 3840

    @staticmethod
    def of(t: dict, size_m: tuple[float, float, float]) -> Tool:
        """From `[process.brush]`, whose workpiece is a block of this size."""
        length = t["free_length_mm"] * 1e-3
        bending = t["youngs_modulus_mpa"] * 1e6 * math.pi / 64.0 * (t["bristle_diameter_mm"] * 1e-3) ** 4
        assert "rpy_deg" not in t["workpiece"]
        return Tool(
            radius=t["radius_mm"] * 1e-3,
            width=t["width_mm"] * 1e-3,
            bristles=float(t["bristles"]),
            length=length,
            bending=bending,
            mu=t["mu"],
            spin=t["speed_rpm"] * 2.0 * math.pi / 60.0,
            corner=np.array(t["workpiece"]["xyz_mm"], dtype=float) * 1e-3,
            size=np.array(size_m),
        )

    def bristle(self, lacking: np.ndarray | float) -> np.ndarray:
        """Force of a bristle that lacks so much to its length."""
        lacking = np.asarray(lacking) / self.length
        assert np.all(lacking < bent(self.mu).x[-1] ** 2)
        return self.bending / self.length**2 * bent(self.mu)(np.sqrt(lacking))

    def loads(self, centre: np.ndarray, axes: np.ndarray, velocity: np.ndarray, turning: np.ndarray) -> np.ndarray:
        """Force and moment on the tool about the centre, world axes; then the sum of the bristles' forces and the friction of all tips
        together."""
        angle = 2.0 * math.pi * (np.arange(self.angles) + 0.5) / self.angles - math.pi
        ray = np.sin(angle)[:, None] * axes[:, 0] + np.cos(angle)[:, None] * axes[:, 2]
        nearest = np.clip(centre, self.corner, self.corner + self.size) - centre
        nearest -= nearest @ axes[:, 1] * axes[:, 1]
        assert np.linalg.norm(nearest) > math.cos(WITHIN_RAD) * self.radius
        ray = ray[ray @ nearest > math.cos(WITHIN_RAD) * np.linalg.norm(nearest)]
        along = self.width * ((np.arange(self.slices) + 0.5) / self.slices - 0.5)
        start = centre + along[:, None] * axes[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            near = (self.corner - start)[:, None, :] / ray[None]
            far = (self.corner + self.size - start)[:, None, :] / ray[None]
        enters = np.minimum(near, far).max(axis=2)
        leaves = np.maximum(near, far).min(axis=2)
        lacking = np.where((enters < leaves) & (enters > 0.0), self.radius - enters, 0.0)
        slice_, sector = np.nonzero(lacking > 0.0)
        lacking, ray = lacking[slice_, sector], ray[sector]
        push = self.bristles / (self.angles * self.slices) * self.bristle(lacking)
        arm = along[slice_, None] * axes[:, 1] + (self.radius - lacking)[:, None] * ray
        tip = velocity + np.cross(turning + self.spin * axes[:, 1], arm)
        tip -= np.sum(tip * ray, axis=1)[:, None] * ray
        drag = tip / np.linalg.norm(tip, axis=1)[:, None]
        friction = -self.mu * push[:, None] * drag
        force = friction - push[:, None] * ray
        told = push.sum(), np.linalg.norm(friction.sum(axis=0))
        return np.array([*force.sum(axis=0), *np.cross(arm, force).sum(axis=0), *told])


class BrushRun(LedRun):
    """The arm in MuJoCo under the brush's loads, along the recorded command."""

    def __init__(self, tool: Tool, plant: Plant, command: Command) -> None:
        super().__init__(plant, command)
        self.tool = tool

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Told: the sum of the bristles' forces, and the friction of all tips together."""
        found = self.tool.loads(*self.tool_at(q, v))
        return found[:3], found[3:6], found[6:]
