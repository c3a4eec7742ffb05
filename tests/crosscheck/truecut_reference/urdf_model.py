"""A MuJoCo model from the URDF and robot.toml by MuJoCo's own URDF reader: what the exported model must equal."""

from __future__ import annotations

import math
import re

import mujoco
import numpy as np

from .scenario import LinkAdjustment, Robot, ScenarioError

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

KEEP_LINKS = '<mujoco><compiler fusestatic="false" discardvisual="true" balanceinertia="false"/></mujoco>'
PRISMATIC = mujoco.mjtJoint.mjJNT_SLIDE


def from_urdf(robot: Robot) -> mujoco.MjModel:
    """Model of the scenario's robot, with joint springs and dampers and the sites flange, tool and foot."""
    config = tomllib.loads(robot.config.read_text(encoding="utf-8")) if robot.config.exists() else {}
    return specification(robot, robot.urdf.read_text(encoding="utf-8"), config).compile()


def specification(robot: Robot, urdf: str, config: dict) -> mujoco.MjSpec:
    """The same before it is compiled, from the texts of `robot.urdf` and the tables of `robot.toml`."""
    text = re.sub(r"(<robot\b[^>]*>)", r"\1" + KEEP_LINKS, urdf, count=1)
    spec = mujoco.MjSpec.from_string(text)
    entries = {entry["name"]: entry for entry in config.get("joint", [])}
    for joint in spec.joints:
        entry = entries[joint.name]
        linear = joint.type == PRISMATIC
        stiffness = entry["stiffness_n_per_m" if linear else "stiffness_nm_per_rad"]
        damping = entry["damping_n_s_per_m" if linear else "damping_nm_s_per_rad"]
        stiffness *= robot.stiffness_scale * robot.stiffness_factors.get(joint.name, 1.0)
        damping *= robot.damping_scale * robot.damping_factors.get(joint.name, 1.0)
        joint.stiffness = [stiffness, 0.0, 0.0]  # linear term of a polynomial
        joint.damping = [damping, 0.0, 0.0]
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        joint.frictionloss = 0.0
    for body in spec.bodies[1:]:
        body.mass *= robot.inertia_scale
        body.inertia *= robot.inertia_scale
        body.fullinertia *= robot.inertia_scale
    for name, adjustment in robot.links.items():
        body = spec.body(name)
        if body is None or not body.joints:
            raise ScenarioError(f"robot.link: no joint moves a link \"{name}\"")
        _adjust(body, adjustment, np.array(adjustment.center_m))
    flange = spec.body(robot.tip) if robot.tip else _last_body(spec.worldbody)
    frames = config.get("frames", {})
    for name in ("flange", "tool", "foot"):
        frame = frames.get(name, {})
        flange.add_site(name=name, pos=frame.get("xyz_m", [0.0] * 3), quat=_quaternion(frame.get("rpy_deg", [0.0] * 3)))
    return spec


def rotor_inertia(robot: Robot, joint_names: list[str]) -> np.ndarray:
    """Inertia of each joint's rotor on the joint's side of the gear, as robot.toml and the scenario have it."""
    config = tomllib.loads(robot.config.read_text(encoding="utf-8"))
    entries = {entry["name"]: entry for entry in config.get("joint", [])}
    unknown = set(robot.rotor_factors) - set(joint_names)
    if unknown:
        raise ScenarioError(f"robot.joint: no joint is called {sorted(unknown)}")
    return np.array([entries[n]["rotor_inertia_kg_m2"] * robot.rotor_factors.get(n, 1.0) for n in joint_names])


def _adjust(body, adjustment: LinkAdjustment, shift_m: np.ndarray) -> None:
    """A link is its body and all that is fixed to it: each is heavier by the factor and moves by the same shift.

    `shift_m` is in the body's own frame.
    """
    body.mass *= adjustment.mass_factor
    body.inertia *= adjustment.mass_factor
    body.fullinertia *= adjustment.mass_factor
    body.ipos = np.array(body.ipos) + shift_m
    for child in body.bodies:
        if not child.joints:
            rotation = np.zeros(9)
            mujoco.mju_quat2Mat(rotation, np.array(child.quat))
            _adjust(child, adjustment, rotation.reshape(3, 3).T @ shift_m)


def _last_body(body):
    while body.bodies:
        body = body.bodies[-1]
    return body


def _quaternion(rpy_deg) -> list[float]:
    """Quaternion (w, x, y, z) of URDF roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(0.5 * math.radians(a)), math.sin(0.5 * math.radians(a))) for a in rpy_deg)
    return [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]
