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

from .plant import Plant
from .scenario import Milling, ScenarioError
from .wheel import Command

# Earlier teeth whose arcs a tooth may meet; further back the surface lies deeper by the feed, while vibration is small.
REMEMBERED = 3
# A tooth whose edge would have to cut through so many feeds to reach stock is out of it.
OUT_OF_STOCK = 20.0
# Places of a wear land and their weights, both as parts of its width: Gauss's rule.
_GAUSS = np.polynomial.legendre.leggauss(6)
LAND = [(0.5 * (x + 1.0), 0.5 * w) for x, w in zip(*_GAUSS)]
# Points of the cut at which a step's force is taken.
PARTS = 2
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
        self.times: list[float] = []
        self.places: list[tuple[float, float, float, float]] = []

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

    def joint_torque(self, t: float) -> np.ndarray:
        """What the moved command adds to springs and dampers; the model refers them to the first command, at rest."""
        p = self.plant
        return p.stiffness * (self._command(t) - p.command0) + p.damping * self._command_rate(t)

    def tool_force(self, t: float, x, v) -> tuple[float, float, float]:
        """Force on the tool (N, process frame), averaged over the step about t; notes where the axis is."""
        s = self.spec
        moved, rate = self._to_process.T @ np.asarray(x[:3]), self._to_process.T @ np.asarray(v[:3])
        place, rate = (self.offset + moved).tolist(), rate.tolist()
        self.times.append(t)
        self.places.append((place[0], place[1], rate[0], rate[1]))
        force, moment = [0.0] * 3, [0.0] * 3
        for part in range(PARTS):
            ahead = ((part + 0.5) / PARTS - 0.5) * self.step_s
            here = [p + r * ahead for p, r in zip(place, rate)]
            f, m = self._cut(t + ahead, here)
            for i in range(3):
                force[i] += f[i] / PARTS
                moment[i] += m[i] / PARTS
        self.row = tuple(force)
        self.moment = tuple(self._to_process @ moment)
        return tuple(self._to_process @ force)

    def _cut(self, t: float, here: list[float]) -> tuple[list[float], list[float]]:
        s = self.spec
        radius, pitch = 0.5 * s.diameter_m, 2.0 * math.pi / s.teeth
        share = 1.0
        if s.ramp_m:
            share = min(max((s.feed_m_per_s * t - (s.lead_in_m or 0.0)) / s.ramp_m, 0.0), 1.0)
        depth = s.axial_depth_m * share - here[2]
        force, moment = [0.0] * 3, [0.0] * 3
        if depth <= 0.0:
            return force, moment
        turned = s.start_angle_rad + s.spindle_rad_per_s * t
        for tooth in range(s.teeth):
            phi = turned - pitch * tooth
            sin, cos = math.sin(phi), math.cos(phi)
            if self._in_stock(here, sin, cos, radius - OUT_OF_STOCK * s.feed_per_tooth_m, radius) <= 0.0:
                continue
            surface = max(self._arc(t, here, phi, sin, cos, m) for m in range(1, REMEMBERED + 1))
            chip = self._in_stock(here, sin, cos, surface, radius)
            if chip <= 0.0:
                continue
            tangential = (s.tangential_pa * chip + s.edge_tangential_n_per_m) * depth
            radial = (s.radial_pa * chip + s.edge_radial_n_per_m) * depth
            axial = (s.axial_pa * chip + s.edge_axial_n_per_m) * depth
            if s.wear_land_m:
                push = s.indentation_n_per_m3 * self._overlap(t, here, phi) * depth
                radial += push
                tangential += s.flank_friction * push
            f = (-tangential * cos - radial * sin, tangential * sin - radial * cos, axial)
            arm = (radius * sin, radius * cos, 0.5 * depth)
            for i in range(3):
                force[i] += f[i]
                j, k = (i + 1) % 3, (i + 2) % 3
                moment[i] += arm[j] * f[k] - arm[k] * f[j]
        return force, moment

    def _overlap(self, t: float, here, phi: float) -> float:
        """Area (m^2) by which the wear land behind a tooth's edge overlaps what the edge left: the land stands where
        the edge is now, and the edge passed the places behind it earlier. The land is ground along the nominal path,
        so that the feed is no overlap."""
        s = self.spec
        speed = 0.5 * s.diameter_m * s.spindle_rad_per_s
        area = 0.0
        for node, weight in LAND:
            ago = node * s.wear_land_m / speed
            x, y, _, _ = self._axis(t - ago)
            behind = phi - s.spindle_rad_per_s * ago
            dx, dy = here[0] - s.feed_m_per_s * ago - x, here[1] - y
            area += max(0.0, dx * math.sin(behind) + dy * math.cos(behind)) * weight * s.wear_land_m
        return area

    def _arc(self, t: float, here, phi: float, sin: float, cos: float, m: int) -> float:
        """Distance from the axis at which the tooth that came m pitches earlier cut the ray at phi."""
        s = self.spec
        radius, pitch = 0.5 * s.diameter_m, 2.0 * math.pi / s.teeth
        then = t - m * s.tooth_period_s
        for _ in range(4):
            cx, cy, rx, ry = self._axis(then)
            psi = phi + s.spindle_rad_per_s * (then - t) + m * pitch
            px = cx + radius * math.sin(psi) - here[0]
            py = cy + radius * math.cos(psi) - here[1]
            off = px * cos - py * sin
            rate = (rx + radius * math.cos(psi) * s.spindle_rad_per_s) * cos - (
                ry - radius * math.sin(psi) * s.spindle_rad_per_s
            ) * sin
            change = off / rate
            then -= change
            if abs(change) < 1e-13:
                break
        return px * sin + py * cos

    def _axis(self, t: float) -> tuple[float, float, float, float]:
        """Place and velocity of the axis that left the surface at a time."""
        s = self.spec
        if not s.regeneration:
            x, y = self.steady_place
            return x + s.feed_m_per_s * t, y, s.feed_m_per_s, 0.0
        if not self.times or t <= self.times[0]:
            return self.offset[0] + s.feed_m_per_s * t, self.offset[1], s.feed_m_per_s, 0.0
        step = self.step_s
        k = min(int((t - self.times[0]) / step), len(self.times) - 2)
        if k < 0:
            return self.places[0]
        (ax, ay, avx, avy), (bx, by, bvx, bvy) = self.places[k], self.places[k + 1]
        u = (t - self.times[k]) / step
        h00, h10 = (1 + 2 * u) * (1 - u) ** 2, u * (1 - u) ** 2 * step
        h01, h11 = u * u * (3 - 2 * u), u * u * (u - 1) * step
        d = 6 * u * (u - 1) / step
        g0, g1 = (1 - u) * (1 - 3 * u), u * (3 * u - 2)
        return (
            h00 * ax + h10 * avx + h01 * bx + h11 * bvx,
            h00 * ay + h10 * avy + h01 * by + h11 * bvy,
            d * (ax - bx) + g0 * avx + g1 * bvx,
            d * (ay - by) + g0 * avy + g1 * bvy,
        )

    @property
    def steady_place(self) -> tuple[float, float]:
        """Displacement of the steadily deflected tool; at the start where the cut is under way."""
        if self.in_cut:
            return self.offset[0], self.offset[1]
        extra = self.axes @ self.steady
        return self.offset[0] + extra[0], self.offset[1] + extra[1]

    def _in_stock(self, here, sin: float, cos: float, low: float, high: float) -> float:
        """Part of the ray between two distances from the axis that lies in the stock."""
        s = self.spec
        if low >= high:
            return 0.0
        radius = 0.5 * s.diameter_m
        entry, leave = s.engagement_rad
        bounds = []
        if leave < math.pi - 1e-12:
            bounds.append((here[1], cos, radius * math.cos(leave), math.inf))
        if entry > 1e-12:
            bounds.append((here[1], cos, -math.inf, radius * math.cos(entry)))
        if s.lead_in_m is not None:
            bounds.append((here[0], sin, s.lead_in_m + radius, math.inf))
        for at, along, least, most in bounds:
            if along == 0.0:
                if not least <= at <= most:
                    return 0.0
                continue
            a, b = (least - at) / along, (most - at) / along
            low, high = max(low, min(a, b)), min(high, max(a, b))
        return max(0.0, high - low)

    def findings(self) -> tuple[dict, dict]:
        """What the run says by itself."""
        return {}, {}


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
