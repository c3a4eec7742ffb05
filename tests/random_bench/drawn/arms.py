"""Arms drawn at random: a URDF with its `robot.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

VALUES = ("stiffness", "damping", "dry_friction", "rotor_inertia")


@dataclass(frozen=True)
class ArmDraw:
    """A chain of revolute joints: its URDF and what its `robot.toml` says, on the joints' side of the gears."""

    urdf: str
    stiffness: np.ndarray
    damping: np.ndarray
    rotor: np.ndarray

    @property
    def joints(self) -> int:
        """How many."""
        return self.stiffness.size

    def write(self, folder: Path) -> None:
        """The two files."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "robot.urdf").write_text(self.urdf, encoding="utf-8")
        text = 'name = "drawn"\n[frames.tool]\nxyz_m = [0.05, 0.0, 0.2]\nrpy_deg = [0.0, 0.0, 0.0]\n'
        for j in range(self.joints):
            text += (
                f'[[joint]]\nname = "joint_{j + 1}"\nstiffness_nm_per_rad = {float(self.stiffness[j])!r}\n'
                f"damping_nm_s_per_rad = {float(self.damping[j])!r}\ndry_friction_nm = 0.0\n"
                f"rotor_inertia_kg_m2 = {float(self.rotor[j])!r}\n[joint.source]\n"
                + "".join(f'{what} = "drawn"\n' for what in VALUES)
            )
        (folder / "robot.toml").write_text(text, encoding="utf-8")


def draw_urdf(draw: np.random.Generator, joints: int) -> str:
    """Links of random size, mass and direction. One of the first two joints lies across gravity."""
    text = ['<robot name="drawn"><link name="base"/>']
    total = draw.uniform(4.0, 40.0)
    shrink = draw.uniform(0.5, 1.0)
    for joint in range(joints):
        mass = total / joints * shrink**joint * draw.uniform(0.6, 1.5)
        reach = draw.uniform(0.15, 0.55) * shrink**joint
        centre = np.array([draw.uniform(0.2, 0.7) * reach, *draw.uniform(-0.1, 0.1, 2) * reach])
        sides = (np.array([reach, *draw.uniform(0.1, 0.5, 2) * reach]) + 0.03) ** 2
        moments = mass / 12 * (sides.sum() - sides)
        place = [0.0, 0.0, draw.uniform(0.1, 0.6)] if joint == 0 else [length, draw.uniform(-0.1, 0.1), 0.0]
        length = reach
        axis = draw.integers(0, 3)
        if joint == min(1, joints - 1):
            axis = draw.integers(0, 2)
        turn = draw.uniform(-0.4, 0.4, 3) if joint and draw.random() < 0.3 else np.zeros(3)
        xyz = " ".join("1" if a == axis else "0" for a in range(3))
        parent = f"link_{joint}" if joint else "base"
        text.append(
            f'<link name="link_{joint + 1}"><inertial><origin xyz="{centre[0]} {centre[1]} {centre[2]}"/>'
            f'<mass value="{mass}"/><inertia ixx="{moments[0]}" iyy="{moments[1]}" izz="{moments[2]}" '
            f'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="joint_{joint + 1}" type="revolute">'
            f'<origin xyz="{place[0]} {place[1]} {place[2]}" rpy="{turn[0]} {turn[1]} {turn[2]}"/>'
            f'<parent link="{parent}"/><child link="link_{joint + 1}"/><axis xyz="{xyz}"/>'
            '<limit lower="-6.2" upper="6.2" effort="1e5" velocity="50"/></joint>'
        )
    return "".join(text) + "</robot>"


def mass_diagonal(urdf: str, postures: np.ndarray) -> np.ndarray:
    """The largest inertia that each joint sees on these postures."""
    model = mujoco.MjModel.from_xml_string(urdf)
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    most = np.zeros(model.nv)
    for row in np.atleast_2d(postures):
        data.qpos[:] = row
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        most = np.maximum(most, np.diag(mass))
    return most


def draw_arm(draw: np.random.Generator, urdf: str, postures: np.ndarray, from_hz: float, to_hz: float) -> ArmDraw:
    """Springs that put each joint's own mode between these frequencies; rotors beside what the links weigh."""
    inertia = mass_diagonal(urdf, postures)
    rate = 2.0 * np.pi * draw.uniform(from_hz, to_hz, inertia.size)
    damping = 2.0 * draw.uniform(0.02, 0.08, inertia.size) * inertia * rate
    rotor = draw.uniform(0.0, 0.6, inertia.size) * inertia
    return ArmDraw(urdf, inertia * rate * rate, damping, rotor)
