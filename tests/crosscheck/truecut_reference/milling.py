"""Peripheral milling along a straight line: teeth on true circles against the surface that earlier teeth cut.

The surface is not stored as displacements over the spindle's angle. Where a tooth stands now, the ray from the axis
through its tip meets the arc that an earlier tooth cut at the time when that tooth's tip lay on the ray: the time is
found by Newton's method from the recorded places of the axis (cubic Hermite between steps). The chip is what lies
between the outermost of those points and the tip.

Frame of the cut: x the feed, z the tool axis from the tip into the spindle (process -X), y = z x x. A tooth at the
angle phi from +y towards +x points along (sin phi, cos phi); the tool turns clockwise seen from the spindle. The law
covers straight edges without runout, which is what is cross-checked; anything else is refused.
"""

from __future__ import annotations

import math

import numpy as np

from . import teeth
from .plant import Plant
from .scenario import Milling, ScenarioError
from .wheel import Command

STEPS_PER_TOOTH = 80
STEPS_PER_PERIOD = 130


class MillingProcess:
    """One straight pass."""

    channels = ("milling.force_x", "milling.force_y", "milling.force_z")
    foot = None

    def __init__(self, spec: Milling, longest_step_s: float, plant: Plant, command: Command | None) -> None:
        if command is None:
            raise ScenarioError("a milling pass needs the commanded joint coordinates")
        if spec.helix_rad or spec.runout_m or spec.ramp_m and not spec.regeneration:
            raise ScenarioError("the reference mills with straight teeth that run true")
        self.spec = spec
        tooth_s = spec.tooth_period_s
        fastest_s = 1.0 / plant.fastest_mode_hz()
        # As the step is halved, so are the others.
        longest = min(1.0, longest_step_s / 100e-6) * min(tooth_s / STEPS_PER_TOOTH, fastest_s / STEPS_PER_PERIOD)
        self.step_s = tooth_s / math.ceil(tooth_s / min(longest, longest_step_s) - 1e-9)
        self.plant = plant
        self._command = command.spline()
        self._command_rate = self._command.derivative()
        self.axes = _cut_axes(plant, spec)
        self.origin = plant.tool_position0.copy()
        force, moment = _mean_load(spec)
        steady = plant.deflection("tool", force @ self.axes, moment @ self.axes)
        # A tool that sinks under the force cuts deeper, in proportion; both are found together.
        deeper = spec.axial_depth_m / (spec.axial_depth_m + float(self.axes[2] @ steady))
        self.mean_force, self.mean_moment, self.steady = deeper * force, deeper * moment, deeper * steady
        self.in_cut = spec.lead_in_m is None and spec.ramp_m == 0.0
        # Rest, and with it the place of the axis before the start: known once the arm has settled.
        self.offset = np.zeros(3)
        self.moment = (0.0, 0.0, 0.0)
        self.row: tuple[float, ...] = ()
        # Steps so far: their times, and place and velocity of the axis in the plane.
        self.count, self.times, self.places = 0, np.zeros(4096), np.zeros((4096, 4))
        self._pass: teeth.Pass | None = None

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """A cut that is under way holds the arm deflected by its mean force."""
        to_process = self.plant.axes @ self.axes.T
        if self.in_cut:
            self.moment = tuple(to_process @ self.mean_moment)
            return to_process @ self.mean_force, np.zeros(3)
        return np.zeros(3), np.zeros(3)

    def start_velocity(self) -> np.ndarray:
        """Joints move with the command from the start on."""
        return self._command_rate(0.0)

    def settled(self) -> None:
        """The arm rests at its start."""
        place = self.plant.data.site("tool").xpos
        self.offset = self.axes @ (place - self.origin)
        self._to_process = self.plant.axes @ self.axes.T
        self._pass = self._describe()

    def joint_torque(self, t: float) -> np.ndarray:
        """What the moved command adds to springs and dampers; the model refers them to the first command, at rest."""
        p = self.plant
        return p.stiffness * (self._command(t) - p.command0) + p.damping * self._command_rate(t)

    def tool_force(self, t: float, x, v) -> tuple[float, float, float]:
        """Force on the tool (N, process frame), averaged over the step about t; notes where the axis is."""
        moved, rate = self._to_process.T @ np.asarray(x[:3]), self._to_process.T @ np.asarray(v[:3])
        place = self.offset + moved
        if self.count == len(self.places):
            self.times, self.places = _grown(self.times), _grown(self.places)
        self.times[self.count] = t
        self.places[self.count] = place[0], place[1], rate[0], rate[1]
        self.count += 1
        force, moment = teeth.step_load(self._pass, self.times, self.places, self.count, t, place, rate)
        self.row = tuple(force.tolist())
        self.moment = tuple(self._to_process @ moment)
        return tuple(self._to_process @ force)

    def _describe(self) -> teeth.Pass:
        """What teeth need to know of the pass, once the arm has settled."""
        s = self.spec
        entry, leave = s.engagement_rad
        steady = self.offset if s.regeneration else self.steady_place
        return teeth.Pass(
            radius=0.5 * s.diameter_m,
            teeth=s.teeth,
            spin=s.spindle_rad_per_s,
            start=s.start_angle_rad,
            feed=s.feed_m_per_s,
            feed_per_tooth=s.feed_per_tooth_m,
            tooth_s=s.tooth_period_s,
            entry=entry,
            leave=leave,
            lead_in=math.nan if s.lead_in_m is None else s.lead_in_m,
            ramp=float(s.ramp_m),
            depth=s.axial_depth_m,
            pressures=(s.tangential_pa, s.radial_pa, s.axial_pa),
            edge=(s.edge_tangential_n_per_m, s.edge_radial_n_per_m, s.edge_axial_n_per_m),
            land=float(s.wear_land_m),
            indentation=s.indentation_n_per_m3,
            flank_friction=s.flank_friction,
            regenerates=bool(s.regeneration),
            before=(float(steady[0]), float(steady[1])),
            step=self.step_s,
        )

    @property
    def steady_place(self) -> tuple[float, float]:
        """Displacement of the steadily deflected tool; at the start where the cut is under way."""
        if self.in_cut:
            return self.offset[0], self.offset[1]
        extra = self.axes @ self.steady
        return self.offset[0] + extra[0], self.offset[1] + extra[1]

    def findings(self) -> tuple[dict, dict]:
        """What the run says by itself."""
        return {}, {}


def _grown(rows: np.ndarray) -> np.ndarray:
    """The same rows, and as many again that are empty."""
    return np.concatenate((rows, np.zeros_like(rows)))


def _cut_axes(plant: Plant, spec: Milling) -> np.ndarray:
    """Rows x, y, z of the cut's frame in the world."""
    z = -plant.axes[0]
    x = np.asarray(spec.direction) - np.dot(spec.direction, z) * z
    x = x / np.linalg.norm(x)
    return np.array([x, np.cross(z, x), z])


def _mean_load(spec: Milling) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment of the nominal chip c sin(phi), averaged over a turn by Gauss's rule, in the cut's frame."""
    entry, leave = spec.engagement_rad
    nodes, weights = np.polynomial.legendre.leggauss(40)
    phi = 0.5 * (leave - entry) * nodes + 0.5 * (leave + entry)
    weight = 0.5 * (leave - entry) * weights * spec.teeth / (2.0 * math.pi) * spec.axial_depth_m
    chip = spec.feed_m_per_s * spec.tooth_period_s * np.sin(phi)
    tangential = spec.tangential_pa * chip + spec.edge_tangential_n_per_m
    radial = spec.radial_pa * chip + spec.edge_radial_n_per_m
    axial = spec.axial_pa * chip + spec.edge_axial_n_per_m
    force = np.array(
        [
            -tangential * np.cos(phi) - radial * np.sin(phi),
            tangential * np.sin(phi) - radial * np.cos(phi),
            axial,
        ]
    )
    radius = 0.5 * spec.diameter_m
    arm = np.array([radius * np.sin(phi), radius * np.cos(phi), np.full_like(phi, 0.5 * spec.axial_depth_m)])
    return force @ weight, np.cross(arm.T, force.T).T @ weight


def growth_rate(time_s: np.ndarray, motion: np.ndarray, period_s: float, window_s: float, linear_m: float) -> float:
    """Growth (1/s) of what does not repeat with the period: slope of the logarithm of its level in windows.

    Second differences over the period leave out what is forced and its drift; windows whose first difference leaves the
    linear range end the stretch.
    """
    step = float(np.median(np.diff(time_s)))
    lag = round(period_s / step)
    first = motion[lag:] - motion[:-lag]
    second = first[lag:] - first[:-lag]
    first = first[lag:]
    count = max(1, round(window_s / step))
    levels = []
    for k in range(len(second) // count):
        part = slice(k * count, (k + 1) * count)
        if np.max(np.linalg.norm(first[part], axis=1)) > linear_m:
            break
        levels.append(math.sqrt(float(np.mean(np.sum(second[part] ** 2, axis=1)))))
    levels = np.log(levels[len(levels) * 2 // 5 :])
    if len(levels) < 3:
        return math.nan
    return float(np.polyfit(np.arange(len(levels)) * count * step, levels, 1)[0])
