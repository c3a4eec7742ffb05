"""A compliant wheel that is carried over a flat plate: normal spring and damper, sliding friction, Preston removal.

The tool travels along the process Y axis on commanded joint coordinates; X points into the plate.

    N = max(0, k pen + c d(pen)/dt) while pen > 0,   pen = N0/k + dX + e sin(w t)

The wheel's rim slides over the plate at -w R ("climb", against the travel) or +w R ("against", with the travel) plus
the travel of the tool; friction on the wheel opposes that. The plate loses the section k_p (N/width) |v_s| dt, spread
semi-elliptically over the chord that the undeformed wheel would cut.

The command is an input, taken from the recording and interpolated: what a controller asks of the joints is no law of
physics. `CommandedPath` holds it to what it must do: carry the tool straight along Y, without turning it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy.interpolate

from .plant import Plant
from .profile import Profile
from .scenario import ScenarioError, Wheel

PATH_KNOTS = 400
# By then the feed must have come up to speed.
RUN_UP_S = 0.1


@dataclass(frozen=True)
class Command:
    """Commanded joint coordinates (rad or m; a row per instant) at given times (s)."""

    time_s: np.ndarray
    joints: np.ndarray

    def spline(self) -> scipy.interpolate.CubicSpline:
        """Joint coordinates over time."""
        return scipy.interpolate.CubicSpline(self.time_s, self.joints)


class CommandedPath:
    """Where the tool of a rigid arm would be on the command: displacement since the start, process axes, and turn.

    `rotation_rad` is the largest turn of the tool on the way.
    """

    def __init__(self, plant: Plant, command: Command) -> None:
        self.time_s = np.linspace(command.time_s[0], command.time_s[-1], PATH_KNOTS + 1)
        scratch = mujoco.MjData(plant.model)
        site = scratch.site("tool")
        places, turns = [], []
        for row in command.spline()(self.time_s):
            scratch.qpos[:] = plant.rigid_posture(row)
            mujoco.mj_kinematics(plant.model, scratch)
            places.append(plant.axes @ (site.xpos - plant.tool_position0))
            turn = plant.tool_rotation0.T @ site.xmat.reshape(3, 3)
            turns.append(0.5 * math.hypot(turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]))
        self.places_m = np.array(places)
        self.rotation_rad = max(turns)
        self._spline = scipy.interpolate.CubicSpline(self.time_s, self.places_m)

    def displacement_m(self, t) -> np.ndarray:
        """Displacement at times `t`; the last axis holds X, Y, Z."""
        return self._spline(t)


class WheelProcess:
    """One pass of the wheel."""

    channels = ("wheel.normal_force", "wheel.friction_force", "wheel.indentation", "wheel.position")
    foot = None

    def __init__(self, spec: Wheel, duration_s: float, longest_step_s: float, plant: Plant, command: Command | None):
        if command is None:
            raise ScenarioError("a wheel pass needs the commanded joint coordinates")
        self.spec = spec
        self.step_s = duration_s / math.ceil(duration_s / longest_step_s - 1e-9)
        self.surface_m_per_s = {"climb": -1.0, "against": 1.0}[spec.spin] * spec.speed_rad_per_s * spec.radius_m
        self.pen0_m = spec.normal_force_n / spec.stiffness_n_per_m
        self.removals: list[tuple[float, float, float]] = []
        self.row: tuple[float, ...] = ()
        self.plant = plant
        self._command = command.spline()
        self._command_rate = self._command.derivative()

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """At rest under the normal force, without friction."""
        return np.array([-self.spec.normal_force_n, 0.0, 0.0]), np.zeros(3)

    def joint_torque(self, t: float) -> np.ndarray:
        """What the moved command adds to springs and dampers; the model refers them to the first command, at rest."""
        p = self.plant
        return p.stiffness * (self._command(t) - p.command0) + p.damping * self._command_rate(t)

    def tool_force(self, t: float, x, v) -> tuple[float, float, float]:
        """Force of the plate on the wheel (N, process frame) at mid-step; removes material."""
        s = self.spec
        angle = s.speed_rad_per_s * t
        pen = self.pen0_m + x[0] + s.eccentricity_m * math.sin(angle)
        rate = v[0] + s.eccentricity_m * s.speed_rad_per_s * math.cos(angle)
        normal = max(0.0, s.stiffness_n_per_m * pen + s.damping_n_s_per_m * rate) if pen > 0.0 else 0.0
        slip = self.surface_m_per_s + v[1]
        friction = -math.copysign(s.mu * normal, slip)
        if normal > 0.0:
            section = s.preston_per_pa * (normal / s.width_m) * abs(slip) * self.step_s
            half_chord = math.sqrt(pen * (2.0 * s.radius_m - pen))
            self.removals.append((section, x[1], half_chord))
        self.row = (normal, friction, pen, x[1])
        return -normal, friction, 0.0

    def removed_depth_m(self) -> np.ndarray:
        """Depth that the pass has taken from each cell of the strip."""
        s = self.spec
        cell_m = s.strip_length_m / s.strip_cells
        edges = cell_m * np.arange(s.strip_cells + 1)
        beyond = np.zeros(s.strip_cells + 1)
        # the whole pass at once would take gigabytes
        for part in np.array_split(np.array(self.removals).reshape(-1, 3), 1 + len(self.removals) // 5000):
            section, place, half = part.T[:, :, None]
            u = np.clip((edges - place) / half, -1.0, 1.0)
            share = 0.5 + (u * np.sqrt(1.0 - u * u) + np.arcsin(u)) / math.pi
            beyond += np.sum(section * share, axis=0)
        return np.diff(beyond) / cell_m

    def findings(self) -> tuple[dict[str, float], dict[str, Profile]]:
        """Removed volume on the strip, Preston's integral with what fell beyond its ends; depth along the strip."""
        s = self.spec
        cell_m = s.strip_length_m / s.strip_cells
        depth = self.removed_depth_m()
        scalars = {
            "wheel.removed_volume": float(depth.sum()) * cell_m * s.width_m,
            "wheel.preston_volume": s.width_m * sum(removal[0] for removal in self.removals),
        }
        return scalars, {"wheel.removed_depth": Profile(cell_m * (np.arange(s.strip_cells) + 0.5), depth)}
