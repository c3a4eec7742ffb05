"""The step loop: one process on one plant, with the foot's contact, recorded at every step.

State (positions, velocities) belongs to the step's start t, forces to its middle t + h/2; the result keeps both
time bases, so that a comparison does not mistake half a step for a difference.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

import mujoco
import numpy as np

from .chamfer import ChamferProcess
from .foot import FootNormal
from .friction import FootFriction, coulomb_impulse
from .load import LoadProcess
from .milling import MillingProcess
from .plant import Plant
from .profile import Profile
from .scenario import Chamfer, Load, Milling, Scenario, Wheel
from .wheel import Command, WheelProcess

EVENT_S = 3e-3
MOBILITY_REFRESH_S = 1e-3

STATE_CHANNELS = (
    "tool.displacement_x",
    "tool.displacement_y",
    "tool.displacement_z",
    "tool.velocity_x",
    "tool.velocity_y",
    "tool.velocity_z",
)
FOOT_CHANNELS = (
    "foot.normal_force",
    "foot.friction_y",
    "foot.friction_z",
    "foot.sliding",
    "foot.slip_speed",
    "foot.lifted",
)


@dataclass
class Result:
    """Channels of one run, SI. `state_time_s` goes with tool and joint channels, `force_time_s` with the rest."""

    step_s: float
    state_time_s: np.ndarray
    force_time_s: np.ndarray
    channels: dict[str, np.ndarray]
    scalars: dict[str, float]
    profiles: dict[str, Profile]
    left_cut_s: float | None
    wall_s: float
    state_names: set[str] = field(default_factory=set)

    def time_of(self, name: str) -> np.ndarray:
        """Time base of a channel."""
        return self.state_time_s if name in self.state_names else self.force_time_s


class Laws:
    """Which law stands for which part of a run: the nominal ones. Subclasses put others in their place."""

    chamfer = ChamferProcess
    wheel = WheelProcess
    foot_normal = FootNormal
    foot_friction = FootFriction
    plant = Plant


def process_for(
    scenario: Scenario, plant: Plant, longest_step_s: float, command: Command | None, laws: type[Laws] | Laws = Laws
):
    """The process of the scenario, with a step that suits its geometry."""
    spec = scenario.process
    if isinstance(spec, Chamfer):
        return laws.chamfer(spec, longest_step_s)
    if isinstance(spec, Wheel):
        return laws.wheel(spec, scenario.duration_s, longest_step_s, plant, command)
    if isinstance(spec, Milling):
        return MillingProcess(spec, longest_step_s, plant, command)
    assert isinstance(spec, Load)
    return LoadProcess(spec, scenario.duration_s, longest_step_s, plant.axes)


def simulate(
    scenario: Scenario,
    model: str | mujoco.MjModel,
    longest_step_s: float,
    until_s: float = math.inf,
    command: Command | None = None,
    laws: type[Laws] | Laws = Laws,
) -> Result:
    """Runs the scenario in MuJoCo from static equilibrium, to its end or to `until_s`.

    `command` moves the joints of a process that travels; otherwise the command stands still.
    """
    began = time.perf_counter()
    plant = laws.plant(model, scenario.robot)
    if isinstance(scenario.process, Milling) and command is not None:
        # The path says where the arm begins, the command where on the path.
        plant = laws.plant(model, scenario.robot, plant.rigid_posture(command.joints[0]))
    process = process_for(scenario, plant, longest_step_s, command, laws)
    force_tool, force_foot = process.start_loads()
    plant.settle(force_tool, force_foot, getattr(process, "moment", None))
    if isinstance(process, MillingProcess):
        plant.start_moving(process.start_velocity())
        process.settled()
    has_foot = process.foot is not None
    normal = friction = None
    if has_foot:
        normal = laws.foot_normal(process.foot, 1.0 / plant.compliance("foot")[0, 0])
        friction = laws.foot_friction(process.foot.friction)
    h = process.step_s
    count = round(min(scenario.duration_s, until_s) / h)
    origin = plant.kinematics()[0].copy()
    refresh = max(1, round(MOBILITY_REFRESH_S / h))
    old = [*map(float, force_tool), *map(float, force_foot)]
    states, forces, joints = [], [], []
    half, eighth = 0.5 * h, 0.125 * h * h
    n_force, fy, fz, slides, slip_speed = 0.0, 0.0, 0.0, False, 0.0
    for i in range(count):
        t = i * h
        position, rates = plant.kinematics()
        x = (position - origin).tolist()
        (v0, a0), (v1, a1), (v2, a2), (v3, a3), (v4, a4), (v5, a5) = rates.tolist()
        if i % refresh == 0 and has_foot:
            w = plant.mobility().tolist()
            wy, wz = w[4], w[5]
        middle = (x[0] + half * v0 + eighth * a0, x[1] + half * v1 + eighth * a1, x[2] + half * v2 + eighth * a2)
        rate = (v0 + half * a0, v1 + half * a1, v2 + half * a2)
        tx, ty, tz = process.tool_force(t + half, middle, rate)
        if has_foot:
            n_force = normal.advance_to(x[3] + half * v3 + eighth * a3)
            dx, dy, dz, dn = tx - old[0], ty - old[1], tz - old[2], -n_force - old[3]
            ey, ez = -old[4], -old[5]
            free_y = v4 + h * (a4 + wy[0] * dx + wy[1] * dy + wy[2] * dz + wy[3] * dn + wy[4] * ey + wy[5] * ez)
            free_z = v5 + h * (a5 + wz[0] * dx + wz[1] * dy + wz[2] * dz + wz[3] * dn + wz[4] * ey + wz[5] * ez)
            limit = friction.coefficient(slip_speed) * n_force * h
            py, pz, slides = coulomb_impulse(free_y, free_z, wy[4], 0.5 * (wy[5] + wz[4]), wz[5], limit)
            fy, fz = py / h, pz / h
            slip = (free_y + wy[4] * py + wy[5] * pz, free_z + wz[4] * py + wz[5] * pz)
            slip_speed = math.hypot(*slip) if slides else 0.0
        old = [tx, ty, tz, -n_force, fy, fz]
        states.append((x[0], x[1], x[2], v0, v1, v2))
        joints.append(plant.data.qpos.copy())
        forces.append((tx, ty, tz, n_force, -fy, -fz, float(slides), slip_speed, float(n_force <= 0.0), *process.row))
        plant.apply((tx, ty, tz), (-n_force, fy, fz), process.joint_torque(t + half), getattr(process, "moment", None))
        plant.step(h)
    return _result(plant, process, states, forces, joints, h, time.perf_counter() - began)


def _result(plant, process, states, forces, joints, h, wall_s) -> Result:
    state = np.array(states)
    force = np.array(forces)
    joint = np.array(joints)
    t = h * np.arange(len(states))
    channels = {name: state[:, i] for i, name in enumerate(STATE_CHANNELS)}
    for n in range(joint.shape[1]):
        hinge = plant.model.jnt_type[n] == mujoco.mjtJoint.mjJNT_HINGE
        channels[f"joint{n + 1}.{'angle' if hinge else 'position'}"] = joint[:, n]
    state_names = set(channels)
    kind = "load" if isinstance(process, LoadProcess) else "cutting"
    if not isinstance(process, (WheelProcess, MillingProcess)):
        for i, axis in enumerate("xyz"):
            channels[f"{kind}.force_{axis}"] = force[:, i]
    if process.foot is not None:
        for i, name in enumerate(FOOT_CHANNELS):
            channels[name] = force[:, 3 + i]
    for i, name in enumerate(process.channels):
        channels[name] = force[:, 9 + i]
    if isinstance(process, ChamferProcess):
        foot = (force[:, 3], force[:, 4], force[:, 5])
        for i, axis in enumerate("xyz"):
            channels[f"dynamometer.force_{axis}"] = foot[i] - force[:, i]
    scalars, profiles = process.findings()
    if isinstance(process, ChamferProcess) and process.foot is not None:
        first = first_event(channels["foot.sliding"] > 0.5, h)
        if first is not None:
            scalars["chamfer.first_slip_depth"] = float(channels["cutting.depth"][first])
    return Result(
        step_s=h,
        state_time_s=t,
        force_time_s=t + 0.5 * h,
        channels=channels,
        scalars=scalars,
        profiles=profiles,
        left_cut_s=getattr(process, "left_cut_s", None),
        wall_s=wall_s,
        state_names=state_names,
    )


def first_event(active: np.ndarray, h: float) -> int | None:
    """Index at which `active` first begins to last at least 3 ms."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], active.astype(np.int8), [0]))))
    for start, stop in zip(edges[::2], edges[1::2]):
        if (stop - start) * h >= EVENT_S:
            return int(start)
    return None
