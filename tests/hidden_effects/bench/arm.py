"""An arm in MuJoCo on commanded joint coordinates, with effects in its joints, at its flange and under its base.

Linear springs and dampers of the joints are MuJoCo's own (RK4). What the command, and every effect, adds to them is
evaluated at mid-step and held over the step; dry friction is an impulse, bounded by its level, that brings a joint to
rest within the step where it can.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
import scipy.interpolate
from scipy.spatial.transform import Rotation
from truecut_reference import urdf_model
from truecut_reference.scenario import Robot

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

from .effects import Effect
from .joint_law import JointLaw, stopping

GRAVITY_M_PER_S2 = 9.81
TILT = "base_tilt"


def model_of(robot: Robot, effects: list[Effect]) -> mujoco.MjModel:
    """The scenario's robot with what effects add to its build."""
    urdf = robot.urdf.read_text(encoding="utf-8")
    config = tomllib.loads(robot.config.read_text(encoding="utf-8"))
    tilt = next((e for e in effects if e.kind == "base_compliance" and _compliance(e) > 0.0), None)
    if tilt is not None:
        urdf = _on_a_tilting_base(urdf, tilt.target)
        joint = {"name": TILT, "stiffness_nm_per_rad": 1.0 / _compliance(tilt), "damping_nm_s_per_rad": 0.0}
        config["joint"].insert(0, joint)
    spec = urdf_model.specification(robot, urdf, config)
    if tilt is not None:
        spec.joint(TILT).stiffness = [1.0 / _compliance(tilt), 0.0, 0.0]
        base = next(body for body in spec.bodies if body.name == "base")
        _give_mass(base, 1e-6, 1e-9)
    own = [joint for joint in spec.joints if joint.name != TILT]
    for effect in effects:
        if effect.kind == "joint_zero":
            # the coordinate at which the links stand as the file draws them
            own[effect.target - 1].ref = -effect.values["offset_rad"]
    flange = next(site.parent for site in spec.sites if site.name == "flange")
    for effect in effects:
        v = effect.values
        if effect.kind == "payload" and v["mass_kg"] != 0.0:
            body = flange.add_body(name="payload", pos=[v["center_x_m"], v["center_y_m"], v["center_z_m"]])
            _give_mass(body, v["mass_kg"], 1e-9)
        elif effect.kind == "outside_absorber":
            body = flange.add_body(name="absorber")
            _give_mass(body, v["mass_kg"], 1e-6)
            rate = 2.0 * math.pi * v["frequency_hz"]
            damping = 2.0 * v["damping_ratio"] * rate * v["mass_kg"]
            slide = mujoco.mjtJoint.mjJNT_SLIDE
            # along the flange's path: a radial one would go with it as a plain mass
            joint = body.add_joint(name="absorber", type=slide, axis=[0.0, 1.0, 0.0])
            joint.stiffness, joint.damping = [v["mass_kg"] * rate * rate, 0.0, 0.0], [damping, 0.0, 0.0]
    return spec.compile()


def _give_mass(body, mass_kg: float, inertia_kg_m2: float) -> None:
    """A mass at the body's origin (where MuJoCo would not put it by itself)."""
    body.mass, body.inertia, body.ipos, body.explicitinertial = mass_kg, [inertia_kg_m2] * 3, [0.0] * 3, True


def _compliance(effect: Effect) -> float:
    return effect.values["compliance_rad_per_n_m"]


def _on_a_tilting_base(urdf: str, axis: str) -> str:
    xyz = " ".join("1" if a == axis else "0" for a in "xyz")
    joint = (
        f'<link name="ground"/><joint name="{TILT}" type="revolute"><parent link="ground"/><child link="base"/>'
        f'<axis xyz="{xyz}"/><limit lower="-1" upper="1" velocity="0" effort="0"/></joint></robot>'
    )
    return urdf.replace("</robot>", joint)


def gravity_on_base(effects: list[Effect]) -> np.ndarray:
    """Gravity in the frame of a base that stands turned about an axis."""
    turn = np.zeros(3)
    for effect in effects:
        if effect.kind == "base_tilt":
            turn["xyz".index(effect.target)] += effect.values["angle_rad"]
    return Rotation.from_rotvec(-turn).apply([0.0, 0.0, -GRAVITY_M_PER_S2])


class Arm:
    """One run. Joints of the chain are numbers 0 .. n - 1; MuJoCo may have one before and one after them."""

    def __init__(self, robot: Robot, effects: list[Effect], time_s: np.ndarray, command: np.ndarray, step_s: float):
        self.model = m = model_of(robot, effects)
        self.data = mujoco.MjData(m)
        m.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        m.opt.timestep = step_s
        m.opt.gravity[:] = gravity_on_base(effects) if robot.gravity else (0.0, 0.0, 0.0)
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.h = step_s
        self.n = command.shape[1]
        names = [m.joint(i).name for i in range(m.njnt)]
        self.first = 1 if names[0] == TILT else 0
        self.all_stiffness = m.jnt_stiffness.reshape(m.nv, -1)[:, 0].copy()
        own = slice(self.first, self.first + self.n)
        self.linear_stiffness = self.all_stiffness[own]
        self.linear_damping = m.dof_damping.reshape(m.nv, -1)[own, 0].copy()
        on_joint = [[e for e in effects if e.target == i + 1] for i in range(self.n)]
        self.laws = [
            JointLaw.of(float(k), float(d), of_one)
            for k, d, of_one in zip(self.linear_stiffness, self.linear_damping, on_joint)
        ]
        self.command = scipy.interpolate.CubicSpline(time_s, command)
        self.command_rate = self.command.derivative()
        self.duration_s = float(time_s[-1])
        m.qpos_spring[:] = 0.0

    def extra(self, theta, theta_rate, q, q_rate, moves_memory: bool) -> list[float]:
        """What the joints exert beyond MuJoCo's springs to zero and its dampers."""
        found = []
        for i, law in enumerate(self.laws):
            w, rate = law.windup(theta[i], theta_rate[i], q[i], q_rate[i])
            torque = law.transmission(w, rate) if moves_memory else law.static(w, rate)
            passive = -self.linear_stiffness[i] * q[i] - self.linear_damping[i] * q_rate[i]
            found.append(torque + law.link(q[i], q_rate[i]) - passive)
        return found

    def pushed_at_rest(self) -> np.ndarray | float:
        """What else acts on all of MuJoCo's joints before the run."""
        return 0.0

    def pushed(self, t: float) -> np.ndarray | float:
        """The same in the run."""
        return 0.0

    def handed_on(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The command and its rate as springs and dampers hand them on over the steps that begin at these times."""
        middle = t + 0.5 * self.h
        return self.command(middle), self.command_rate(middle)

    def before(self, t: float, rate: list[float]) -> None:
        """Tells what else changes with time the instant and the rates for which torques are asked next."""

    def settle(self) -> None:
        """Rest under gravity on the first command, nothing wound up by friction."""
        m, d = self.model, self.data
        theta, still = self.command(0.0), [0.0] * self.n
        d.qpos[self.first : self.first + self.n] = theta
        for _ in range(500):
            q = d.qpos[self.first : self.first + self.n]
            d.qfrc_applied[:] = self.pushed_at_rest()
            d.qfrc_applied[self.first : self.first + self.n] += self.extra(theta, still, q, still, False)
            mujoco.mj_forward(m, d)
            change = (d.qfrc_passive + d.qfrc_applied - d.qfrc_bias) / self.all_stiffness
            d.qpos[:] += 0.7 * change
            if np.max(np.abs(change)) < 1e-13:
                break
        else:
            raise RuntimeError("static equilibrium not found")
        mujoco.mj_forward(m, d)
        for i, law in enumerate(self.laws):
            law.start(law.windup(theta[i], 0.0, d.qpos[self.first + i], 0.0)[0])

    def run(self, every: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Times and channels at every step that is a multiple of `every`."""
        self.settle()
        m, d, h = self.model, self.data, self.h
        count = round(self.duration_s / h)
        t = h * np.arange(count + 1)
        at, at_rate = self.command(t).tolist(), self.command_rate(t).tolist()
        led, led_rate = (values.tolist() for values in self.handed_on(t))
        own = slice(self.first, self.first + self.n)
        tool = d.site("tool")
        rubbing = [i for i, law in enumerate(self.laws) if law.rubs]
        rows = []
        for k in range(count + 1):
            q, v, a = d.qpos[own].tolist(), d.qvel[own].tolist(), d.qacc[own].tolist()
            torque = []
            for i, law in enumerate(self.laws):
                torque.append(law.transmission(*law.windup(at[k][i], at_rate[k][i], q[i], v[i])))
            if k % every == 0:
                rows.append((*q, *torque, *tool.xpos))
            middle = [x + 0.5 * h * y + 0.125 * h * h * z for x, y, z in zip(q, v, a)]
            rate = [y + 0.5 * h * z for y, z in zip(v, a)]
            self.before(t[k] + 0.5 * h, rate)
            applied = np.array(self.extra(led[k], led_rate[k], middle, rate, True))
            if rubbing:
                applied += self.friction(k * h, applied, q, v, torque, rubbing)
            d.qfrc_applied[:] = self.pushed(t[k] + 0.5 * h)
            d.qfrc_applied[own] += applied
            mujoco.mj_step(m, d)
        return t[::every], self._channels(np.array(rows))

    def friction(self, t: float, applied: np.ndarray, q, v, torque, rubbing: list[int]) -> np.ndarray:
        """Torque of dry friction over the coming step."""
        d, h, own = self.data, self.h, slice(self.first, self.first + self.n)
        mass = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, d, mass)
        mobility = np.linalg.inv(mass)[own, own]
        # the acceleration at hand holds what was applied over the last step
        free = d.qvel[own] + h * (d.qacc[own] + mobility @ (applied - d.qfrc_applied[own]))
        bounds = {i: self.laws[i].friction_bounds(t, q[i], v[i], torque[i]) for i in rubbing}
        return stopping(free, mobility, bounds, h)

    def _channels(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        found = {}
        for i in range(self.n):
            found[f"joint{i + 1}.angle"] = rows[:, i]
            found[f"joint{i + 1}.transmission_torque"] = rows[:, self.n + i]
        for i, axis in enumerate("xyz"):
            found[f"tool.position_{axis}"] = rows[:, 2 * self.n + i]
        return found
