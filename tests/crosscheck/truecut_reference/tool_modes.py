"""Modes of a tool as bodies on springs that an arm's last link carries.

The masses of the bodies are taken from the last link at its tool point, so that the arm weighs what it weighed. The
bodies slide one on the other, the heavier mode first: with directions square to each other that is the system of
docs/physics/tool_modes.md.
"""

from __future__ import annotations

import mujoco
import numpy as np


def with_modes(mjcf: str, modes: list[dict], turns: bool = True) -> mujoco.MjModel:
    """The exported arm with a body on a spring for each mode; the site `tool` is on the last of them. The last link of an
    arm that does not turn keeps its inertia, which has no part."""
    plain = mujoco.MjModel.from_xml_string(mjcf)
    site = mujoco.mj_name2id(plain, mujoco.mjtObj.mjOBJ_SITE, "tool")
    last = int(plain.site_bodyid[site])
    spec = mujoco.MjSpec.from_string(mjcf)
    spec.site("tool").name = "arm_tool"
    body = spec.body(mujoco.mj_id2name(plain, mujoco.mjtObj.mjOBJ_BODY, last))
    if turns:
        _take_off(body, plain, last, modes[0]["mass"], plain.site_pos[site])
    else:
        # A flange without a mass of its own is fixed to the link that has one.
        carrier = last
        while plain.body_mass[carrier] == 0.0 and plain.body_jntnum[carrier] == 0:
            carrier = int(plain.body_parentid[carrier])
        rest = plain.body_mass[carrier] - modes[0]["mass"]
        if rest <= 0.0:
            raise ValueError(f"the modes weigh {modes[0]['mass']:.3g} kg, their link {plain.body_mass[carrier]:.3g} kg")
        link = spec.body(mujoco.mj_id2name(plain, mujoco.mjtObj.mjOBJ_BODY, carrier))
        link.explicitinertial, link.mass = True, rest
        link.ipos, link.inertia = plain.body_ipos[carrier], plain.body_inertia[carrier]
    place = {"pos": plain.site_pos[site], "quat": plain.site_quat[site]}
    for heavier, lighter in zip(modes, [*modes[1:], None]):
        # Modes alike in mass move one body; the engine wants the other to have some mass, too.
        mass = max(heavier["mass"] - (lighter["mass"] if lighter else 0.0), 1e-9)
        body = body.add_body(**place)
        body.explicitinertial, body.mass, body.inertia = True, mass, [1e-9] * 3
        body.add_joint(
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=heavier["direction"],
            stiffness=heavier["stiffness"],
            damping=heavier["damping"],
        )
        place = {}
    body.add_site(name="tool")
    return spec.compile()


def _take_off(body, plain: mujoco.MjModel, last: int, mass: float, point: np.ndarray) -> None:
    """Takes a point mass off a body."""

    def about(place: np.ndarray) -> np.ndarray:
        return np.dot(place, place) * np.eye(3) - np.outer(place, place)

    whole, centre = plain.body_mass[last], plain.body_ipos[last]
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, plain.body_iquat[last])
    turn = turn.reshape(3, 3)
    inertia = turn @ np.diag(plain.body_inertia[last]) @ turn.T + whole * about(centre) - mass * about(point)
    rest = whole - mass
    new_centre = (whole * centre - mass * point) / rest
    inertia -= rest * about(new_centre)
    body.explicitinertial, body.mass, body.ipos, body.iquat = True, rest, new_centre, [1, 0, 0, 0]
    body.inertia = [0.0, 0.0, 0.0]
    body.fullinertia = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
