"""A compliant wheel that is carried over a flat plate: normal spring and damper, sliding friction, Preston removal.

The tool travels along the process Y axis on commanded joint angles; X points into the plate.

    N = max(0, k pen + c d(pen)/dt),   pen = N0/k + dX + e sin(w t)

The wheel's rim slides over the plate at -w R ("climb", against the travel) or +w R ("against", with the travel) plus
the travel of the tool; friction on the wheel opposes that. The removed section grows by k_p (N/width) |v_s| dt and is
put into the two strip cells beside the contact, shared linearly.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
import scipy.interpolate

from .plant import Plant
from .scenario import Wheel

PATH_KNOT_M = 5e-4


class WheelProcess:
    """One pass of the wheel."""

    channels = ("wheel.normal_force", "wheel.friction_force", "wheel.penetration", "wheel.position")
    foot = None

    def __init__(self, spec: Wheel, duration_s: float, longest_step_s: float, plant: Plant) -> None:
        self.spec = spec
        self.step_s = duration_s / math.ceil(duration_s / longest_step_s - 1e-9)
        self.surface_m_per_s = {"climb": -1.0, "against": 1.0}[spec.spin] * spec.speed_rad_per_s * spec.radius_m
        self.pen0_m = spec.normal_force_n / spec.stiffness_n_per_m
        self.cell_m = spec.strip_length_m / spec.strip_cells
        self.removed_m = [0.0] * spec.strip_cells
        self.volume_m3 = 0.0
        self.row: tuple[float, ...] = ()
        self.plant = plant
        self._command = path_command(plant, spec.feed_m_per_s, duration_s)
        self._command_rate = self._command.derivative()

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """At rest under the normal force, without friction."""
        return np.array([-self.spec.normal_force_n, 0.0, 0.0]), np.zeros(3)

    def joint_torque(self, t: float) -> np.ndarray:
        """What the moved command adds to the springs and dampers, which the model refers to the first command and to rest."""
        p = self.plant
        return p.stiffness * (self._command(t) - p.command0) + p.damping * self._command_rate(t)

    def tool_force(self, t: float, x, v) -> tuple[float, float, float]:
        """Force of the plate on the wheel (N, process frame) at mid-step; removes material."""
        s = self.spec
        angle = s.speed_rad_per_s * t
        pen = self.pen0_m + x[0] + s.runout_m * math.sin(angle)
        rate = v[0] + s.runout_m * s.speed_rad_per_s * math.cos(angle)
        normal = max(0.0, s.stiffness_n_per_m * pen + s.damping_n_s_per_m * rate)
        slip = self.surface_m_per_s + v[1]
        friction = -math.copysign(s.mu * normal, slip)
        section = s.preston_per_pa * (normal / s.width_m) * abs(slip) * self.step_s
        self._remove(x[1], section)
        self.row = (normal, friction, pen, x[1])
        return -normal, friction, 0.0

    def _remove(self, position_m: float, section_m2: float) -> None:
        self.volume_m3 += section_m2 * self.spec.width_m
        place = position_m / self.cell_m - 0.5
        cell = math.floor(place)
        share = place - cell
        for index, part in ((cell, 1.0 - share), (cell + 1, share)):
            if 0 <= index < len(self.removed_m):
                self.removed_m[index] += part * section_m2 / self.cell_m

    def scalars(self) -> dict[str, float]:
        """Removed volume of the pass."""
        return {"wheel.removed_volume": self.volume_m3}


def path_command(plant: Plant, feed_m_per_s: float, duration_s: float) -> scipy.interpolate.CubicSpline:
    """Commanded joint coordinates over time that carry the tool along +Y at constant orientation.

    Numeric inverse kinematics on knots, each with its own make-up for the sag, joined by a spline.
    """
    m = plant.model
    scratch = mujoco.MjData(m)
    knots = max(8, math.ceil(feed_m_per_s * duration_s / PATH_KNOT_M))
    times = np.linspace(0.0, duration_s * (1.0 + 2.0 / knots), knots + 3)
    q = plant.q0.copy()
    sag = plant.command_for(plant.q0) - plant.command0  # nonzero only when the command does not make up for it
    commands = []
    for t in times:
        target = plant.tool_position0 + plant.axes[1] * feed_m_per_s * t
        q = inverse_kinematics(plant, scratch, q, target)
        commands.append((q if np.any(sag) else plant.command_for(q)).copy())
    return scipy.interpolate.CubicSpline(times, np.array(commands))


def inverse_kinematics(plant: Plant, scratch: mujoco.MjData, q: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Joint coordinates near q that put the tool at `target` (m, world) in its start orientation (Newton)."""
    m = plant.model
    linear, angular = np.zeros((3, m.nv)), np.zeros((3, m.nv))
    rows = 6 if m.nv >= 6 else 3
    q = q.copy()
    for _ in range(50):
        scratch.qpos[:] = q
        mujoco.mj_kinematics(m, scratch)
        mujoco.mj_comPos(m, scratch)
        mujoco.mj_jacSite(m, scratch, linear, angular, plant.site["tool"])
        site = scratch.site("tool")
        turn = plant.tool_rotation0 @ site.xmat.reshape(3, 3).T
        skew = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        error = np.concatenate((target - site.xpos, skew))[:rows]
        if np.max(np.abs(error)) < 1e-13:
            return q
        q += np.linalg.lstsq(np.concatenate((linear, angular))[:rows], error, rcond=None)[0]
    if np.max(np.abs(error)) > 1e-10:
        raise RuntimeError(f"inverse kinematics stays {error} away from {target}")
    return q
