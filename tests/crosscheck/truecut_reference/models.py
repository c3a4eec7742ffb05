"""MJCF models written by hand from `docs/physics/arm.md`, not from a URDF: an independent check of the export.

The arm is the reference model of that page (OPW dimensions, link data and stiffness of
"IRB6600-cal"); the rigs are masses on springs.
"""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

A1, A2, B, C1, C2, C3, C4 = 0.320, -0.200, 0.0, 0.780, 1.075, 1.142, 0.200
ARM_STIFFNESS_NM_PER_RAD = (2.117e6, 4.829e6, 3.001e6, 0.855e6, 0.439e6, 0.450e6)
DAMPING_PER_STIFFNESS_S = 9.5e-4
SOURCE_A_POSTURE_DEG = (-48.38, 54.82, 6.86, 54.16, 107.43, -21.95)
TOOL_BEYOND_FLANGE_M = 0.30
# mass kg, centre of mass m, principal inertia kg m^2, all in the OPW link frames
LINKS = (
    (400.0, (0.15, 0.0, -0.25), (25.0, 25.0, 30.0)),
    (250.0, (0.0, 0.0, 0.5), (30.0, 32.0, 6.0)),
    (280.0, (-0.1, 0.0, 0.2), (18.0, 20.0, 10.0)),
    (60.0, (0.0, 0.0, -0.35), (5.0, 5.0, 0.6)),
    (35.0, (0.0, 0.0, 0.03), (0.5, 0.5, 0.4)),
    (20.0, (0.0, 0.0, 0.17), (0.3, 0.3, 0.3)),
)
END_EFFECTOR = (120.0, (0.0, 0.0, C4 + 0.20), (4.0, 4.0, 1.5))
# position of each link frame in its parent, rotation about y, joint axis
CHAIN = (
    ((0.0, 0.0, C1), 0.0, "0 0 1"),
    ((A1, 0.0, 0.0), 0.0, "0 1 0"),
    ((0.0, 0.0, C2), 0.5 * math.pi, "0 1 0"),
    ((A2, B, C3), 0.0, "0 0 1"),
    ((0.0, 0.0, 0.0), 0.0, "0 1 0"),
    ((0.0, 0.0, 0.0), 0.0, "0 0 1"),
)

HEAD = """<mujoco model={name}>
  <compiler angle="radian" autolimits="false"/>
  <option gravity="0 0 {gravity}" integrator="RK4"><flag contact="disable" constraint="disable"/></option>
  <worldbody>
"""
TAIL = "  </worldbody>\n</mujoco>\n"


def _numbers(values) -> str:
    return " ".join(repr(float(v)) for v in values)


def _body(name: str, pos, about_y: float) -> str:
    quat = (math.cos(0.5 * about_y), 0.0, math.sin(0.5 * about_y), 0.0)
    return f'<body name="{name}" pos="{_numbers(pos)}" quat="{_numbers(quat)}">'


def _inertial(mass_kg: float, com_m, inertia_kg_m2, scale: float) -> str:
    return (
        f'<inertial pos="{_numbers(com_m)}" mass="{mass_kg * scale!r}" '
        f'diaginertia="{_numbers(i * scale for i in inertia_kg_m2)}"/>'
    )


def _sites(flange_z_m: float, tool_z_m: float, foot_z_m: float) -> str:
    named = (("flange", flange_z_m), ("tool", tool_z_m), ("foot", foot_z_m))
    return "".join(f'<site name="{n}" pos="0 0 {z!r}"/>' for n, z in named)


def irb6600(inertia_scale: float = 0.82) -> str:
    """The arm of the chamfering scenarios; springs without command (the plant sets it)."""
    text = HEAD.format(name=quoteattr("irb6600_175_255"), gravity=-9.81)
    for n, ((pos, about_y, axis), (mass, com, inertia)) in enumerate(zip(CHAIN, LINKS), start=1):
        k = ARM_STIFFNESS_NM_PER_RAD[n - 1]
        text += _body(f"link_{n}", pos, about_y)
        text += _inertial(mass, com, inertia, inertia_scale)
        text += (
            f'<joint name="joint_{n}" type="hinge" axis="{axis}" stiffness="{k!r}" '
            f'damping="{k * DAMPING_PER_STIFFNESS_S!r}"/>\n'
        )
    text += '<body name="end_effector">' + _inertial(*END_EFFECTOR, inertia_scale) + "</body>"
    text += _sites(C4, C4 + TOOL_BEYOND_FLANGE_M, C4 + TOOL_BEYOND_FLANGE_M)
    return text + "</body>" * len(CHAIN) + "\n" + TAIL


def spring_rig(stiffness_n_per_m, mass_kg: float, damping_ratio: float) -> str:
    """A mass on springs along world x, y, z (as many as stiffnesses are given); the tool's z axis lies along x."""
    text = HEAD.format(name=quoteattr("spring_rig"), gravity=0.0)
    last = len(stiffness_n_per_m)
    for n, k in enumerate(stiffness_n_per_m, start=1):
        axis = _numbers(1.0 if i == n else 0.0 for i in (1, 2, 3))
        mass = mass_kg if n == last else 1e-4
        damping = 2.0 * damping_ratio * math.sqrt(k * mass_kg)
        text += _body(f"link_{n}", (0.0, 0.0, 0.0), 0.0) + _inertial(mass, (0, 0, 0), (mass,) * 3, 1.0)
        text += f'<joint name="joint_{n}" type="slide" axis="{axis}" stiffness="{k!r}" damping="{damping!r}"/>\n'
    quat = _numbers((math.cos(0.25 * math.pi), 0.0, math.sin(0.25 * math.pi), 0.0))
    text += "".join(f'<site name="{n}" quat="{quat}"/>' for n in ("flange", "tool", "foot"))
    return text + "</body>" * last + "\n" + TAIL


PLANAR_STIFFNESS_N_PER_M = (8.646e5, 1.078e6, 1.394e6)
PLANAR_MASS_KG = 557.3


def planar_rig(damping_ratio: float = 0.02) -> str:
    """Three decoupled springs: feed k1, horizontal k2, vertical k3 of Dong et al.."""
    return spring_rig(PLANAR_STIFFNESS_N_PER_M, PLANAR_MASS_KG, damping_ratio)
