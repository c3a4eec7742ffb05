"""Arms drawn from seeds, each with a motion in which all joints move, and their drive forces by MuJoCo, with friction
and rotors written here."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

RATE_HZ, DURATION_S, CUTOFF_HZ = 200.0, 24.0, 10.0


class Arm:
    """A chain of revolute joints (the second may slide) with random frames, links, rotors and friction."""

    def __init__(self, seed: int, rotors: float = 0.3, duration_s: float = DURATION_S) -> None:
        draw = np.random.default_rng(seed)
        self.joints = int(draw.integers(2, 7))
        self.slides = [joint == 1 and draw.random() < 0.4 for joint in range(self.joints)]
        text = ['<robot name="drawn"><link name="base"/>']
        self.truth: dict[str, float] = {}
        for joint in range(self.joints):
            mass = float(draw.uniform(1, 12))
            centre = draw.uniform(-0.2, 0.2, 3)
            # Moments of a body: of three box sides.
            sides = draw.uniform(0.05, 0.5, 3) ** 2
            moments = mass / 12 * (sides.sum() - sides)
            about = np.diag(moments) + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
            place, turn = draw.uniform(-0.4, 0.4, 3), draw.choice([-1.5708, 0.0, 1.5708, 0.7], 3)
            kind = "prismatic" if self.slides[joint] else "revolute"
            parent = f"link_{joint}" if joint else "base"
            text.append(
                f'<link name="link_{joint + 1}"><inertial><origin xyz="{centre[0]} {centre[1]} {centre[2]}"/>'
                f'<mass value="{mass}"/><inertia ixx="{moments[0]}" iyy="{moments[1]}" izz="{moments[2]}" '
                f'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="joint_{joint + 1}" type="{kind}">'
                f'<origin xyz="{place[0]} {place[1]} {place[2]}" rpy="{turn[0]} {turn[1]} {turn[2]}"/>'
                f'<parent link="{parent}"/><child link="link_{joint + 1}"/><axis xyz="0 0 1"/>'
                '<limit lower="-6" upper="6" effort="1000" velocity="20"/></joint>'
            )
            own = {"mass": mass} | {f"m {axis}": mass * x for axis, x in zip("xyz", centre, strict=True)}
            for a, b in ("xx", "yy", "zz", "xy", "xz", "yz"):
                own[f"I {a}{b}"] = about["xyz".index(a), "xyz".index(b)]
            self.truth |= {f"link {joint + 1} {name}": value for name, value in own.items()}
            self.truth |= {
                f"rotor {joint + 1}": float(draw.uniform(0, 1)) * rotors,
                f"viscous {joint + 1}": float(draw.uniform(1, 10)),
                f"coulomb {joint + 1}": float(draw.uniform(2, 15)),
                f"offset {joint + 1}": float(draw.uniform(-3, 3)),
            }
        self.urdf = "".join(text) + "</robot>"
        self.time = time = np.arange(0, duration_s, 1 / RATE_HZ)
        reach = np.where(self.slides, 0.3, 1.0)
        self.waves = [
            [draw.normal(0, 0.5 / harmonic, self.joints) * reach for _ in range(2)] for harmonic in range(1, 6)
        ]
        self.q, self.v, self.a = self.moved(time)
        self.noise = np.zeros_like(self.q)
        size, colour = draw.uniform(0.3, 1.5), draw.uniform(0, 0.9)
        for k in range(1, len(time)):
            self.noise[k] = colour * self.noise[k - 1] + size * draw.normal(size=self.joints)

    def moved(self, time: np.ndarray) -> list[np.ndarray]:
        """Coordinates, velocities and accelerations: five harmonics of 0.125 Hz."""
        moved = [np.zeros((len(time), self.joints)) for _ in range(3)]
        for harmonic, (sine, cosine) in enumerate(self.waves, 1):
            rate = 2 * np.pi * 0.125 * harmonic
            wave, other = np.sin(rate * time[:, None]), np.cos(rate * time[:, None])
            moved[0] += sine * wave + cosine * other
            moved[1] += rate * (sine * other - cosine * wave)
            moved[2] -= rate**2 * (sine * wave + cosine * other)
        return moved

    def drive_forces(self) -> np.ndarray:
        model = mujoco.MjModel.from_xml_string(self.urdf)
        data = mujoco.MjData(model)
        v, a = self.v, self.a
        forces = np.empty_like(self.q)
        for k in range(len(self.time)):
            data.qpos[:], data.qvel[:], data.qacc[:] = self.q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            forces[k] = data.qfrc_inverse
        number = np.arange(1, self.joints + 1)
        of = lambda name: np.array([self.truth[f"{name} {joint}"] for joint in number])  # noqa: E731
        return forces + of("rotor") * a + of("viscous") * v + of("coulomb") * np.sign(v) - of("offset") + self.noise

    def write(self, folder: Path) -> Path:
        (folder / "robot.urdf").write_text(self.urdf, encoding="utf-8")
        forces = self.drive_forces()
        table = np.column_stack([self.time, self.q, forces])
        names = [f"q{j + 1}" for j in range(self.joints)] + [f"f{j + 1}" for j in range(self.joints)]
        header = ",".join(["t", *names])
        np.savetxt(folder / "data.csv", table, delimiter=",", header=header, comments="", fmt="%.12g")
        units = [("position", "m", "force", "N") if slides else ("angle", "rad", "torque", "N m") for slides in self.slides]
        channels = [
            f'[[data.channel]]\ncolumn = "q{j}"\nchannel = "joint{j}.{coordinate}"\nunit = "{unit}"\nrole = "input"\n'
            f'[[data.channel]]\ncolumn = "f{j}"\nchannel = "joint{j}.drive_{force}"\nunit = "{force_unit}"\n'
            for j, (coordinate, unit, force, force_unit) in enumerate(units, 1)
        ]
        text = (
            'name = "drawn"\n[robot]\nurdf = "robot.urdf"\n[process.replay]\nmode = "inverse"\n'
            f'differentiate_cutoff_hz = 40\ncompare_cutoff_hz = {CUTOFF_HZ}\n[data]\nfile = "data.csv"\ntime = "t"\n'
            + "".join(channels)
            + '[fit]\nunknowns = ["links", "rotors", "viscous", "coulomb", "offset"]\nblocks = 12\n'
        )
        scenario = folder / "drawn.toml"
        scenario.write_text(text, encoding="utf-8")
        return scenario
