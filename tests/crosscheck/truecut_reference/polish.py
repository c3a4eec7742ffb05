"""A pneumatic wheel in precession on a rectangular face, written a second time: forces by sums over the patch, edges included.

The wheel is a sphere about the tool point, whose middle runs around the spin axis (the tool's z axis, which points towards the face).
Reaching into the face by d it presses on a whole patch with the force of a hollow sphere (`shell.py`), which also gives the overlap in the
middle, u0 = a^2/2R. Spread out it is the root of the overlap u = u0 - r^2/2R, as Hertz has it, with the tension's 2N/R beside it and,
moving, with the bed's damping. The patch ends where the layer leaves without a kink; along an edge the layer bends and is held by a
reaction per length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import scipy.interpolate
import scipy.optimize

from .edge_share import edge_share
from .led_run import LedRun
from .plant import Plant
from .shell import Shell
from .wheel import Command

# indentations that a run may meet, over the radius
LEAST, MOST = 0.02, 0.1
# Gauss's rule for a row of the patch
RULE = np.polynomial.legendre.leggauss(20)


@dataclass(frozen=True)
class Tool:
    """Wheel, spin and face, SI, from the table of a scenario."""

    radius: float
    tension: float
    modulus: float
    shell: Shell
    damping: float
    spin: float
    mu: float
    eccentricity: float
    start_angle: float
    origin: np.ndarray
    axes: np.ndarray
    size: tuple[float, float]
    # mean force with which grains hold an edge that is run over inward, square on, per its normal force
    jamming: float = 0.0
    table: list = field(default_factory=list)

    @staticmethod
    def of(t: dict) -> Tool:
        """From `[process.polish]`, whose wheel keeps its place on the tool."""
        wheel, face = t["wheel"], t["face"]
        radius, poisson = wheel["radius_mm"] * 1e-3, wheel.get("poisson", 0.49)
        plane = wheel["youngs_modulus_mpa"] * 1e6 / (1.0 - poisson**2)
        thickness = wheel["shell_thickness_mm"] * 1e-3
        # what holds the air's pressure on the hollow's section
        hollow = math.pi * (radius - thickness) ** 2
        tension = wheel["pressure_mpa"] * 1e6 * hollow / (2.0 * math.pi * (radius - thickness / 2.0))
        x = np.array(face.get("x_axis", [1.0, 0.0, 0.0]), dtype=float)
        z = np.array(face.get("normal", [0.0, 0.0, 1.0]), dtype=float)
        x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
        assert t["control"]["law"] == "position"
        return Tool(
            radius=radius,
            tension=tension,
            modulus=plane,
            shell=Shell(thickness / radius, poisson, tension / (plane * radius), 2.0 * MOST),
            damping=wheel.get("damping_pa_s_per_m", 0.0),
            spin=t["spin_rpm"] * 2.0 * math.pi / 60.0,
            mu=t["mu"],
            eccentricity=t.get("eccentricity_um", 0.0) * 1e-6,
            start_angle=math.radians(t.get("eccentricity_angle_deg", 0.0)),
            origin=np.array(face["origin_mm"], dtype=float) * 1e-3,
            axes=np.array([x, np.cross(z, x), z]),
            size=(face["length_mm"] * 1e-3, face["width_mm"] * 1e-3),
        )

    # -- the bed and its layer ---------------------------------------------------------------------------------

    @staticmethod
    def bed(u, tread: float):
        """Pressure of the bed at overlaps: u = tread q^2."""
        return np.sqrt(np.maximum(u, 0.0) / tread)

    def leaving(self, u, tread: float, fall: float | None, curvature: float, inward):
        """N |w'| of the layer that leaves at the overlap u: off a disc (curvature) or along an edge on which u falls (fall)."""
        straight = 4.0 / 3.0 * self.tension * u * self.bed(u, tread)
        bending = 8.0 / 7.0 * self.tension * u * np.sqrt(straight)
        if fall is None:
            square = straight + bending * curvature
        else:
            k = bending * self.tension * fall
            square = _largest_root(straight, k) ** 2
        viscous = self.damping * inward * u
        return 0.5 * (viscous + np.sqrt(viscous**2 + 4.0 * square))

    # -- the patch ---------------------------------------------------------------------------------------------

    def patch(self, depth: float) -> tuple[float, float, float, float]:
        """Overlap in the middle, its rate per indentation, radius of the patch, logarithm of the bed's tread."""
        force, half_square, rate = self.shell.at(depth / self.radius)
        u0, force = half_square * self.radius, force * self.modulus * self.radius**2
        whole = math.sqrt(2.0 * self.radius * u0)

        def rim(tread: float) -> float:
            def kink(c: float) -> float:
                u = u0 - c * c / (2.0 * self.radius)
                return float(self.leaving(u, tread, None, 1.0 / c, 0.0)) - self.tension * c / self.radius

            return scipy.optimize.brentq(kink, 1e-6 * whole, (1.0 - 1e-9) * whole, xtol=1e-10)

        def pressed(log_tread: float) -> float:
            """Of the bed, by its energy in the middle less that at the rim, and of the layer."""
            tread = math.exp(log_tread)
            c = rim(tread)
            u = u0 - c * c / (2.0 * self.radius)
            bed = 4.0 / 3.0 * math.pi * self.radius * (u0**1.5 - u**1.5) / math.sqrt(tread)
            return bed + 2.0 * self.tension / self.radius * math.pi * c * c - force

        hertz = math.log((math.pi * self.radius / (2.0 * self.modulus)) ** 2 / (2.0 * self.radius))
        log_tread = scipy.optimize.brentq(pressed, hertz - 1.0, hertz + 8.0, xtol=1e-8)
        return u0, rate, rim(math.exp(log_tread)), log_tread

    def _patches(self, depth: float) -> scipy.interpolate.CubicSpline:
        """The patch over the indentations that a run meets, made once."""
        if not self.table:
            depths = np.linspace(LEAST, MOST, 65) * self.radius
            self.table.append(scipy.interpolate.CubicSpline(depths, [self.patch(d) for d in depths]))
        if not LEAST * self.radius <= depth <= MOST * self.radius:
            raise ValueError(f"an indentation of {depth} m is outside the table")
        return self.table[0]

    def loads(self, middle: np.ndarray, velocity: np.ndarray, turning: np.ndarray) -> np.ndarray:
        """Force and moment on the wheel about the patch's middle, face axes, the part along edges, and power of sliding over mu."""
        depth = self.radius - middle[2]
        if depth <= 0.0:
            return np.zeros(8)
        u0, rate, c, log_tread = (float(part) for part in self._patches(depth)(depth))
        tread = math.exp(log_tread)
        slide = np.array([velocity[0] - turning[1] * middle[2], velocity[1] + turning[0] * middle[2]])
        x, y, pressed = self._inside(middle, u0, tread, rate, c, slide, turning[2], -velocity[2])
        ex, ey, along, tilt, ox, oy = self._edges(middle, u0, tread, slide, turning[2])
        inside = np.zeros(len(x))
        tilt, ox, oy = (np.concatenate([inside, part]) for part in (tilt, ox, oy))
        x, y, force = np.concatenate([x, ex]), np.concatenate([y, ey]), np.concatenate([pressed, along])
        vx, vy = slide[0] - turning[2] * y, slide[1] + turning[2] * x
        speed = np.hypot(vx, vy)
        # what presses stands square to a plane turned by the tilt about the edge, friction runs in that plane
        across = (vx * ox + vy * oy) / speed
        pressing = force / (np.cos(tilt) + self.mu * across * np.sin(tilt))
        outwards = pressing * (self.mu * across * (np.cos(tilt) - 1.0) - np.sin(tilt))
        held = self.jamming * force * np.maximum(-(vx * ox + vy * oy) / speed, 0.0)
        fx = -(self.mu * pressing + held) * vx / speed - outwards * ox
        fy = -(self.mu * pressing + held) * vy / speed - outwards * oy
        on_wheel = [fx.sum(), fy.sum(), force.sum()]
        moment = [(y * force).sum(), -(x * force).sum(), (x * fy - y * fx).sum()]
        return np.array([*on_wheel, *moment, along.sum(), (force * speed).sum()])

    def _inside(self, middle, u0, tread, rate, c, slide, spin, approach):
        """Points of the patch on the face and the forces there: strips along x, both by Gauss's rule in an angle."""
        nodes, weights = RULE
        low, high = (max(-c, -middle[1]), min(c, self.size[1] - middle[1]))
        if low >= high:
            return np.zeros(0), np.zeros(0), np.zeros(0)
        a, b = math.asin(low / c), math.asin(high / c)
        angle = 0.5 * (a + b) + 0.5 * (b - a) * nodes
        y, wy = c * np.sin(angle), 0.5 * (b - a) * weights * c * np.cos(angle)
        half = np.sqrt(c * c - y * y)
        left, right = np.maximum(-half, -middle[0]), np.minimum(half, self.size[0] - middle[0])
        right = np.maximum(left, right)
        a, b = np.arcsin(np.clip(left / half, -1, 1)), np.arcsin(np.clip(right / half, -1, 1))
        angle = 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * nodes[None, :]
        x = half[:, None] * np.sin(angle)
        area = wy[:, None] * 0.5 * (b - a)[:, None] * weights[None, :] * half[:, None] * np.cos(angle)
        y = np.broadcast_to(y[:, None], x.shape)
        pressure = self.bed(u0 - (x * x + y * y) / (2.0 * self.radius), tread) + 2.0 * self.tension / self.radius
        outflow = (slide[0] - spin * y) * x + (slide[1] + spin * x) * y
        pressure = pressure + self.damping * (rate * approach - outflow / self.radius)
        return x.ravel(), y.ravel(), (np.maximum(pressure, 0.0) * area).ravel()

    def _edges(self, middle, u0, tread, slide, spin):
        """Points along edges under the overlap, the reactions there, half of what the layer falls in all, the outward normals."""
        nodes, weights = RULE
        whole = math.sqrt(2.0 * self.radius * u0)
        length, width = self.size
        sides = [
            (np.array([0.0, -1.0]), middle[1], -middle[0], length - middle[0]),
            (np.array([0.0, 1.0]), width - middle[1], -middle[0], length - middle[0]),
            (np.array([-1.0, 0.0]), middle[0], -middle[1], width - middle[1]),
            (np.array([1.0, 0.0]), length - middle[0], -middle[1], width - middle[1]),
        ]
        found = [np.zeros((0, 6))]
        for outward, distance, begin, end in sides:
            if abs(distance) >= whole:
                continue
            half = math.sqrt(whole**2 - distance**2)
            low, high = max(begin, -half), min(end, half)
            if low >= high:
                continue
            a, b = math.asin(low / half), math.asin(high / half)
            angle = 0.5 * (a + b) + 0.5 * (b - a) * nodes
            t, piece = half * np.sin(angle), 0.5 * (b - a) * weights * half * np.cos(angle)
            at = distance * outward[None, :] + t[:, None] * np.abs(outward[::-1])[None, :]
            u = u0 - (distance**2 + t * t) / (2.0 * self.radius)
            inward = -((slide[0] - spin * at[:, 1]) * outward[0] + (slide[1] + spin * at[:, 0]) * outward[1])
            overhang = self.leaving(u, tread, 1.0 / self.radius, 0.0, inward)
            rising = np.full_like(t, -self.tension * distance / self.radius)
            on_face = rising
            if rising[0] > 0.0:
                on_face = np.minimum(rising, self.leaving(u, tread, 1.0 / self.radius, 0.0, -inward))
            reaction = np.maximum(overhang + on_face, 0.0)
            # outside it falls by overhang + rising, inside by what the face does not hold of the rise
            tilt = 0.5 * (overhang + rising + (rising - on_face)) / self.tension
            layer = 0.5 * self.tension / self.radius * math.sqrt(tread / u0)
            reaction = edge_share(layer, distance / whole) * reaction
            normals = np.broadcast_to(outward, at.shape)
            found.append(np.column_stack([at, reaction * piece, tilt, normals]))
        return np.concatenate(found).T


def _largest_root(a, b):
    """Largest root of s^3 - a s - b for a, b > 0: Cardano's, by the cosine where there are three."""
    discriminant = 0.25 * b * b - a**3 / 27.0
    root = np.sqrt(np.maximum(discriminant, 0.0))
    single = np.cbrt(0.5 * b + root) + np.cbrt(0.5 * b - root)
    angle = np.arccos(np.clip(1.5 * b / a * np.sqrt(3.0 / a), -1.0, 1.0))
    return np.where(discriminant >= 0.0, single, 2.0 * np.sqrt(a / 3.0) * np.cos(angle / 3.0))


class PolishRun(LedRun):
    """The arm in MuJoCo under the wheel's loads, from rest on the face along the recorded command."""

    def __init__(self, tool: Tool, plant: Plant, command: Command) -> None:
        super().__init__(plant, command)
        self.tool = tool
        # place and rate of a force control's carrier, towards the face
        self.offset = self.rate = 0.0

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Told: normal force, part along edges, force along the face's length and width, power of sliding over mu."""
        tool = self.tool
        at, axes, velocity, turning = self.tool_at(q, v)
        place = at - tool.origin
        turning = turning - tool.spin * axes[:, 2]
        angle = tool.start_angle - tool.spin * t
        arm = tool.eccentricity * (math.cos(angle) * axes[:, 0] + math.sin(angle) * axes[:, 1])
        swing = tool.eccentricity * tool.spin * (math.sin(angle) * axes[:, 0] - math.cos(angle) * axes[:, 1])
        point = tool.axes @ place
        middle = tool.axes @ (place + arm)
        middle[2] -= self.offset
        moving = tool.axes @ (velocity + swing)
        moving[2] -= self.rate
        found = tool.loads(middle, moving, tool.axes @ turning)
        force, moment = found[:3], found[3:6]
        lever = np.array([middle[0], middle[1], 0.0]) - point
        moment = moment + np.cross(lever, force)
        told = np.array([found[2], found[6], found[0], found[1], found[7]])
        return tool.axes.T @ force, tool.axes.T @ moment, told
