"""A wheel brush on a block, written a second time: ray by ray against the block's six planes.

Every ray stands for the bristles of a small sector of a thin slice. It leaves the axis square to it and enters the block behind the last
of the planes that it comes through; held there, a bristle of free length L is bent by Y = sqrt(5 L d / 3), d what it lacks to its length,
and pushes back with 5EI/2L^2 / (1 + 5 mu L / 6Y), its tip dragged by mu times that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .led_run import LedRun
from .plant import Plant
from .wheel import Command

# the block is convex: a bristle that meets it stands within acos(1 - depth/R) of the way to its nearest point; enough for R/14
WITHIN_RAD = 0.38


@dataclass(frozen=True)
class Tool:
    """Brush and block, SI. The block's frame is turned by nothing against the world's."""

    radius: float
    width: float
    bristles: float
    length: float
    buckling: float
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
            buckling=2.5 * bending / length**2,
            mu=t["mu"],
            spin=t["speed_rpm"] * 2.0 * math.pi / 60.0,
            corner=np.array(t["workpiece"]["xyz_mm"], dtype=float) * 1e-3,
            size=np.array(size_m),
        )

    def bristle(self, lacking: np.ndarray | float) -> np.ndarray:
        """Force of a bristle that lacks so much to its length."""
        bent = np.sqrt(5.0 / 3.0 * self.length * lacking)
        return self.buckling / (1.0 + 5.0 * self.mu * self.length / (6.0 * bent))

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
