"""Chamfering and polishing with effects in them: the reference's runs, other laws in the places of the nominal ones.

Cutting, for edge e at the angle phi, over the feed depth d and with the hole's centre at (y, z):

    depth    d + offset + (rho_e - y cos phi - z sin phi) / tan(theta) - recess (first edge only)
    rho_e    cosine cos(2 pi e / n) + sine sin(2 pi e / n): runout, seen by the edge that turns with it
    forces   factor (1 + growth s_e) on all of them, s_e the path that the edge has cut; more per edge length

The robot feeds as commanded whatever the spindle does; with another speed the feed per tooth is another.
Foot: friction times factor (1 - drop (1 - exp(-v / speed))); gauge pressure times exp(-rate t), and with it preload and
gas spring; wider stiction of the seals. Wheel: set down to the commanded force at the mean of its eccentricity, whatever its
stiffness; the arm rests at the angle at which the wheel starts to turn.
"""

from __future__ import annotations

import dataclasses
import math
from functools import partial

import numpy as np
from truecut_reference import urdf_model
from truecut_reference.chamfer import ChamferProcess
from truecut_reference.foot import FootNormal
from truecut_reference.friction import FootFriction
from truecut_reference.scenario import ATMOSPHERE_PA, Chamfer, Milling, Scenario, Wheel
from truecut_reference.simulate import Laws, Result, simulate
from truecut_reference.tool_modes import with_modes
from truecut_reference.wheel import Command, WheelProcess

from .effects import Effect
from .hidden_joints import HiddenJoints

RUN_UP_S = 0.1
# Effects with a law here, beside those of joints.
IN_CHAMFERS = (
    "cutting_coefficient",
    "cutting_edge_force",
    "cutting_runout",
    "cutting_hole_offset",
    "cutting_worn_tooth",
    "cutting_wear",
    "cutting_depth_offset",
    "spindle_speed",
    "foot_friction",
    "foot_friction_falling",
    "foot_pressure_loss",
    "foot_seal_stiction",
)
IN_WHEELS = ("wheel_stiffness", "wheel_eccentricity")
IN_MILLING = ("milling_process_damping", "tool_mode")
Values = dict[str, dict[str, float]]


class HiddenChamfer(ChamferProcess):
    """The cutter with effects."""

    def __init__(self, spec: Chamfer, longest_step_s: float, effects: Values) -> None:
        self.nominal = spec
        speed = effects.get("spindle_speed", {"factor": 1.0})["factor"]
        turning = dataclasses.replace(
            spec, spindle_rad_per_s=spec.spindle_rad_per_s * speed, feed_m_per_rev=spec.feed_m_per_rev / speed
        )
        super().__init__(turning, longest_step_s)
        factor = effects.get("cutting_coefficient", {"factor": 1.0})["factor"]
        self.coefficients = [factor * k for k in (self.k_axial, self.k_radial, self.k_tangential)]
        edge = effects.get("cutting_edge_force", {})
        more = [edge.get(f"{name}_n_per_m", 0.0) for name in ("axial", "radial", "tangential")]
        self.edge_forces = tuple(a + b for a, b in zip(self.edge_forces, more))
        self.growth = effects.get("cutting_wear", {"growth_per_m": 0.0})["growth_per_m"]
        self.path_m = [0.0] * spec.edges
        self.path_step_m = turning.spindle_rad_per_s * 0.5 * spec.hole_diameter_m * self.step_s
        hole = effects.get("cutting_hole_offset", {"y_m": 0.0, "z_m": 0.0})
        self.hole = hole["y_m"], hole["z_m"]
        offset = effects.get("cutting_depth_offset", {"depth_m": 0.0})["depth_m"]
        runout = effects.get("cutting_runout", {"cosine_m": 0.0, "sine_m": 0.0})
        recess = effects.get("cutting_worn_tooth", {"recess_m": 0.0})["recess_m"]
        self.offsets = []
        for e in range(spec.edges):
            at = 2.0 * math.pi * e / spec.edges
            rho = runout["cosine_m"] * math.cos(at) + runout["sine_m"] * math.sin(at)
            self.offsets.append(offset + rho / self.tan - (recess if e == 0 else 0.0))
        self.rim = [max(0.0, self._left_before_m(cell)) for cell in range(self.cells)]

    def _left_before_m(self, cell: int) -> float:
        """Depth at a cell of the rim before the run: the tool came down turning, each edge on its own helix."""
        first, late = divmod(cell, self.per_tooth)
        edges, tooth_s = self.spec.edges, self.spec.revolution_s / self.spec.edges
        angle = self.spec.start_angle_rad + (cell + 0.5) * 2.0 * math.pi / self.cells
        hole = self._hole_m(math.cos(angle), math.sin(angle))
        t = (late + 0.5) * self.step_s
        passes = range(1, edges + 1)
        return max(self.edge_depth_m(t - n * tooth_s) + self.offsets[(first + n) % edges] + hole for n in passes)

    def _hole_m(self, cos: float, sin: float) -> float:
        """How much deeper an edge at this angle meets the rim for the place of the hole."""
        return -(self.hole[0] * cos + self.hole[1] * sin) / self.tan

    def edge_depth_m(self, t: float) -> float:
        """Depth at which the robot holds the edges at time t."""
        s = self.nominal
        return min(s.feed_rate_m_per_s * t, s.depth_m - s.feed_per_tooth_m) + s.feed_per_tooth_m

    def tool_force(self, t: float, x, _v) -> tuple[float, float, float]:
        """Force of the workpiece on the tool (N, process frame) at time t and tool displacement x (m)."""
        s = self.spec
        turn = s.start_angle_rad + s.spindle_rad_per_s * t
        fx = fy = fz = area_of_all = 0.0
        for edge in range(s.edges):
            cell = (self._count + edge * self.per_tooth) % self.cells
            angle = turn + 2.0 * math.pi * edge / s.edges
            cos, sin = math.cos(angle), math.sin(angle)
            depth = self.edge_depth_m(t) + self.offsets[edge] + self._hole_m(cos, sin)
            if self.mode > 0:
                depth += self.sign * x[0]
            if self.mode > 1:
                depth += (x[1] * cos + x[2] * sin) / self.tan
            left = self.rim[cell]
            if depth <= left or depth <= 0.0:
                continue
            area = 0.5 * self.tan * (depth * depth - left * left)
            self.rim[cell] = depth
            length = depth * self.per_length
            worn = 1.0 + self.growth * self.path_m[edge]
            self.path_m[edge] += self.path_step_m
            axial, radial, tangential = (
                worn * (k * area + per_length * length) for k, per_length in zip(self.coefficients, self.edge_forces)
            )
            fx -= self.sign * axial
            fy -= radial * cos - tangential * sin
            fz -= radial * sin + tangential * cos
            area_of_all += area
        self._count += 1
        self.row = (self.feed_depth_m(t), 0.0, area_of_all, turn, 0.0)
        return fx, fy, fz


class HiddenFootNormal(FootNormal):
    """The foot's normal force with effects. Called once a step."""

    def __init__(self, foot, arm_stiffness_n_per_m: float, effects: Values, step_s: list[float]) -> None:
        super().__init__(foot, arm_stiffness_n_per_m)
        self.limit_n = max(0.0, self.limit_n + effects.get("foot_seal_stiction", {"force_n": 0.0})["force_n"])
        self.full_n, self.full_n_per_m = self.preload_n, self.gas_n_per_m
        # a spring that is given as a share of the force is no gas
        absolute = foot.pressure_pa + ATMOSPHERE_PA
        self.gauge_share = foot.pressure_pa / absolute if foot.axial_share is None else 0.0
        self.rate_per_s = effects.get("foot_pressure_loss", {"rate_per_s": 0.0})["rate_per_s"]
        self.step_s = step_s
        self.calls = 0

    def advance_to(self, advance_m: float) -> float:
        """As the nominal one, with the preload of the moment."""
        t = (self.calls + 0.5) * self.step_s[0]
        self.calls += 1
        if self.rate_per_s:
            lost = -math.expm1(-self.rate_per_s * t)
            self.preload_n = self.full_n * (1.0 - lost)
            self.gas_n_per_m = self.full_n_per_m * (1.0 - self.gauge_share * lost)
        return super().advance_to(advance_m)


class HiddenFootFriction(FootFriction):
    """The foot's friction with effects."""

    def __init__(self, friction, effects: Values) -> None:
        super().__init__(friction)
        self.factor = effects.get("foot_friction", {"factor": 1.0})["factor"]
        falling = effects.get("foot_friction_falling", {"drop": 0.0, "speed_m_per_s": 1.0})
        self.drop, self.falls_over = falling["drop"], falling["speed_m_per_s"]

    def coefficient(self, slip_speed_m_per_s: float) -> float:
        """Friction coefficient at the given slip speed."""
        left = 1.0 - self.drop * (1.0 - math.exp(-slip_speed_m_per_s / self.falls_over))
        return super().coefficient(slip_speed_m_per_s) * self.factor * left


class HiddenWheel(WheelProcess):
    """The wheel with effects."""

    def __init__(self, spec, duration_s, longest_step_s, plant, command, effects: Values) -> None:
        factor = effects.get("wheel_stiffness", {"factor": 1.0})["factor"]
        spec = dataclasses.replace(spec, stiffness_n_per_m=spec.stiffness_n_per_m * factor)
        super().__init__(spec, duration_s, longest_step_s, plant, command)
        more = effects.get("wheel_eccentricity", {"cosine_m": 0.0, "sine_m": 0.0})
        self.cosine_m, self.sine_m = more["cosine_m"], more["sine_m"]

    def start_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """At rest under the force at the angle at which the wheel starts, without friction."""
        swing = self.spec.stiffness_n_per_m * self.cosine_m
        return np.array([-max(0.0, self.spec.normal_force_n + swing), 0.0, 0.0]), np.zeros(3)

    def tool_force(self, t: float, x, v) -> tuple[float, float, float]:
        """Force of the plate on the wheel (N, process frame)."""
        if self.cosine_m or self.sine_m:
            w = self.spec.speed_rad_per_s
            cos, sin = math.cos(w * t), math.sin(w * t)
            x = (x[0] + self.cosine_m * cos + self.sine_m * sin, *x[1:])
            v = (v[0] + w * (self.sine_m * cos - self.cosine_m * sin), *v[1:])
        return super().tool_force(t, x, v)


def straight_path(wheel: Wheel, start: np.ndarray, duration_s: float) -> Command:
    """Command of the planar rig along its second slide: speed rises as 3u^2 - 2u^3 within the run-up, then holds."""
    t = np.linspace(0.0, duration_s, round(duration_s / 1e-3) + 1)
    u = np.minimum(t / RUN_UP_S, 1.0)
    ramped = RUN_UP_S * (u**3 - 0.5 * u**4) + np.maximum(t - RUN_UP_S, 0.0)
    joints = np.tile(start, (t.size, 1))
    joints[:, 1] += wheel.feed_m_per_s * ramped
    return Command(t, joints)


# Width of the hidden wear land: with it the resistance of the workpiece follows from the effect's size.
WEAR_LAND_M = 0.1e-3


def _known(effects: Values, kinds: tuple[str, ...]) -> None:
    """Refuses an effect that a run would leave out."""
    left_out = sorted(set(effects) - set(kinds))
    if left_out:
        raise ValueError(f"no law for {', '.join(left_out)} in this process")


def run_milling(scenario: Scenario, effects: Values, in_joints: list[Effect], step_s: float) -> Result:
    """A pass fed along a single slide. The reference lets the land overlap what its edge left, and its modes are bodies
    on springs."""
    _known(effects, IN_MILLING)
    spec = scenario.process
    damping = effects.get("milling_process_damping", {"per_slope_n_per_m": 0.0})["per_slope_n_per_m"]
    if damping:
        resistance = 4.0 * damping / WEAR_LAND_M**2
        spec = dataclasses.replace(spec, wear_land_m=WEAR_LAND_M, indentation_n_per_m3=resistance)
        scenario = dataclasses.replace(scenario, process=spec)
    robot = scenario.robot
    config = urdf_model.tomllib.loads(robot.config.read_text(encoding="utf-8"))
    arm = urdf_model.specification(robot, robot.urdf.read_text(encoding="utf-8"), config)
    model, modes = arm.compile(), []
    mode = effects.get("tool_mode", {"compliance_m_per_n": 0.0})
    if mode["compliance_m_per_n"]:
        stiffness, omega = 1.0 / mode["compliance_m_per_n"], 2.0 * math.pi * mode["frequency_hz"]
        alike = {
            "stiffness": stiffness,
            "mass": stiffness / omega**2,
            "damping": 2.0 * mode["damping_ratio"] * stiffness / omega,
        }
        modes = [alike | {"direction": np.array(direction)} for direction in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])]
        model = with_modes(arm.to_xml(), modes, turns=False)
    t = np.linspace(0.0, scenario.duration_s, round(scenario.duration_s / 1e-3) + 1)
    joints = np.zeros((t.size, 1 + len(modes)))
    joints[:, 0] = spec.feed_m_per_s * t
    command, laws = Command(t, joints), Laws()
    if in_joints:
        laws.plant = partial(HiddenJoints, effects=in_joints, command=command)
    return simulate(scenario, model, step_s, command=command, laws=laws)


def run(scenario: Scenario, effects: list[Effect], step_s: float) -> Result:
    """The scenario's run with the effects; sensors are not among them."""
    in_joints = [effect for effect in effects if effect.kind.startswith("joint_")]
    values = {effect.kind: effect.values for effect in effects if effect not in in_joints}
    if isinstance(scenario.process, Milling):
        return run_milling(scenario, values, in_joints, step_s)
    _known(values, IN_WHEELS if isinstance(scenario.process, Wheel) else IN_CHAMFERS)
    model = urdf_model.from_urdf(scenario.robot)
    actual_step_s = [0.0]
    laws = Laws()
    laws.wheel = partial(HiddenWheel, effects=values)
    laws.foot_normal = partial(HiddenFootNormal, effects=values, step_s=actual_step_s)
    laws.foot_friction = partial(HiddenFootFriction, effects=values)

    def chamfer(spec: Chamfer, longest_step_s: float) -> HiddenChamfer:
        process = HiddenChamfer(spec, longest_step_s, values)
        actual_step_s[0] = process.step_s
        return process

    laws.chamfer = chamfer
    command = None
    if isinstance(scenario.process, Wheel):
        start = np.array(scenario.robot.posture_m)
        command = straight_path(scenario.process, start, scenario.duration_s)
    if in_joints:
        laws.plant = partial(HiddenJoints, effects=in_joints, command=command)
    return simulate(scenario, model, step_s, command=command, laws=laws)
