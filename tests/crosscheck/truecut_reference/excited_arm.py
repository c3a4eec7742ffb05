"""Arms for planned motions: their limits from the URDF, drive forces by MuJoCo with friction and rotors written here, random
motions within the same limits, and estimates by the program from noisy data of either."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np

SHARE = 0.9


def drawn_urdf(seed: int, joints: int) -> str:
    """A chain of revolute joints with random frames, links and limits, whose drives hold it twice in any posture."""
    draw = np.random.default_rng(seed)
    masses = np.sort(draw.uniform(0.8, 9, joints))[::-1]
    places = draw.uniform(-0.3, 0.3, (joints, 3))
    text = ['<robot name="drawn"><link name="base"/>']
    for joint in range(joints):
        mass, centre = masses[joint], draw.uniform(-0.12, 0.12, 3)
        sides = draw.uniform(0.05, 0.4, 3) ** 2
        moments = mass / 12 * (sides.sum() - sides)
        beyond = np.linalg.norm(places[joint + 1 :], axis=1).sum() + 0.25
        effort = 2 * 9.81 * masses[joint:].sum() * beyond + 10
        lower, upper = -draw.uniform(1, 3), draw.uniform(1, 3)
        text.append(
            f'<link name="link_{joint + 1}"><inertial><origin xyz="{centre[0]} {centre[1]} {centre[2]}"/>'
            f'<mass value="{mass}"/><inertia ixx="{moments[0]}" iyy="{moments[1]}" izz="{moments[2]}" ixy="0" ixz="0" '
            f'iyz="0"/></inertial></link><joint name="joint_{joint + 1}" type="revolute"><origin xyz="{places[joint][0]} '
            f'{places[joint][1]} {places[joint][2]}" rpy="{draw.choice([-0.5, 0.5]) * np.pi} 0 {draw.uniform(-1, 1)}"/>'
            f'<parent link="{f"link_{joint}" if joint else "base"}"/><child link="link_{joint + 1}"/><axis xyz="0 0 1"/>'
            f'<limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="{draw.uniform(1, 4)}"/></joint>'
        )
    return "".join(text) + "</robot>"


class Machine:
    """What stands for the real arm."""

    def __init__(self, urdf: str, limits: np.ndarray, rotors: np.ndarray, seed: int, **keys: float) -> None:
        """`limits`: range, speed, acceleration, effort of each joint."""
        self.model = mujoco.MjModel.from_xml_string(urdf)
        # Neither joint limits nor shapes that touch are to push.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.data = mujoco.MjData(self.model)
        self.joints, self.limits, self.rotors = self.model.nv, limits, rotors
        draw = np.random.default_rng(seed)
        effort = np.minimum(limits[:, 4], 300.0)
        self.viscous, self.coulomb = (effort * draw.uniform(0.01, 0.03, self.joints) for _ in range(2))
        self.noise = 0.005 * effort
        self.keys = {"duration_s": 10, "rate_hz": 100, "harmonics": 5} | keys

    def rigid(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Drive forces without friction."""
        forces = np.empty_like(q)
        for k in range(len(q)):
            self.data.qpos[:], self.data.qvel[:], self.data.qacc[:] = q[k], v[k], a[k]
            mujoco.mj_inverse(self.model, self.data)
            forces[k] = self.data.qfrc_inverse
        return forces + self.rotors * a

    def forces(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        return self.rigid(q, v, a) + self.viscous * v + self.coulomb * np.sign(v)

    @property
    def time(self) -> np.ndarray:
        count = round(self.keys["duration_s"] * self.keys["rate_hz"])
        return np.linspace(0, self.keys["duration_s"], count + 1)

    def random_motion(self, draw: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A Fourier series from rest to rest whose joints use all of their limits, as far as the drives allow."""
        low, high, speed, acceleration, effort = (SHARE * self.limits).T
        middle = self.limits[:, :2].mean(1)
        half = SHARE * np.diff(self.limits[:, :2]).ravel() / 2
        low, high = middle - half, middle + half
        rate = 2 * np.pi * np.arange(1, self.keys["harmonics"] + 1) / self.keys["duration_s"]
        angle = self.time[:, None] * rate
        while True:
            sines, cosines = draw.normal(size=(2, len(rate), self.joints))
            order = np.arange(1, len(rate) + 1)[:, None]
            sines, cosines = (sines - sines.mean(0)) / order, (cosines - cosines.mean(0)) / order**2
            q = np.sin(angle) @ sines + np.cos(angle) @ cosines
            v = np.cos(angle) @ (rate[:, None] * sines) - np.sin(angle) @ (rate[:, None] * cosines)
            a = -np.sin(angle) @ (rate[:, None] ** 2 * sines) - np.cos(angle) @ (rate[:, None] ** 2 * cosines)
            size = np.minimum((high - low) / np.ptp(q, axis=0), speed / np.abs(v).max(0))
            size = np.minimum(size, acceleration / np.abs(a).max(0))
            left = (high - low - size * np.ptp(q, axis=0)) * draw.random(self.joints)
            centre = low + left - size * q.min(0)
            for part in np.linspace(1, 0.05, 20):
                moved = centre + part * size * q, part * size * v, part * size * a
                if (np.abs(self.rigid(*moved)) <= effort).all():
                    return moved

    def write(self, folder: Path, head: str, unknowns: str, search: str = "") -> Path:
        """The scenario, without data; noise is stated."""
        channels = "".join(
            f'[[data.channel]]\ncolumn = "joint{j}.angle"\nchannel = "joint{j}.angle"\nunit = "rad"\nrole = "input"\n'
            f'[[data.channel]]\ncolumn = "joint{j}.drive_torque"\nchannel = "joint{j}.drive_torque"\nunit = "N m"\n'
            f"noise = {self.noise[j - 1]}\n"
            for j in range(1, self.joints + 1)
        )
        keys = "".join(f"{key} = {value}\n" for key, value in self.keys.items())
        text = (
            f'name = "arm"\n{head}[process.replay]\nmode = "inverse"\n[data]\ntime = "time_s"\n{channels}'
            f"[fit]\nunknowns = {unknowns}\n[excite]\n{keys}{search}"
        )
        scenario = folder / "arm.toml"
        scenario.write_text(text, encoding="utf-8")
        return scenario

    def save(self, file: Path, q: np.ndarray, forces: np.ndarray) -> None:
        names = [f"joint{j + 1}.{what}" for what in ("angle", "drive_torque") for j in range(self.joints)]
        table = np.column_stack([self.time, q, forces])
        np.savetxt(file, table, delimiter=",", header=",".join(["time_s", *names]), comments="", fmt="%.10g")

    def estimates(self, truecut, scenario: Path, q: np.ndarray, forces: np.ndarray) -> dict[str, float]:
        """What `truecut fit` finds in data."""
        file = scenario.parent / "data.csv"
        self.save(file, q, forces)
        truecut.call("fit", scenario, "--data", file, "--out", scenario.parent / "fits")
        report = json.loads((scenario.parent / "fits" / scenario.stem / "fit.json").read_text(encoding="utf-8"))
        return {one["name"]: one["value"] for one in report["parameters"]}

    def deviations(self, truecut, scenario: Path, motion, repeats: int, draw: np.random.Generator) -> np.ndarray:
        """By how much noise moves the estimates, a row a repeat."""
        q, v, a = motion
        clean = self.forces(q, v, a)
        without = self.estimates(truecut, scenario, q, clean)
        noisy = [
            self.estimates(truecut, scenario, q, clean + self.noise * draw.normal(size=clean.shape)) for _ in range(repeats)
        ]
        return np.array([[one[name] - value for name, value in without.items()] for one in noisy])


def motion_of(file: Path, joints: int, duration_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates of a motion's file, and their derivatives by its harmonics: the motion is periodic."""
    table = np.genfromtxt(file, delimiter=",", names=True, deletechars="")
    q = np.column_stack([table[f"joint{j + 1}.angle"] for j in range(joints)])
    spectrum = np.fft.rfft(q[:-1], axis=0)
    rate = 2j * np.pi * np.arange(len(spectrum))[:, None] / duration_s
    # Digits of the file, not motion.
    spectrum[40:] = 0
    back = [np.fft.irfft(spectrum * rate**order, len(q) - 1, axis=0) for order in (1, 2)]
    v, a = (np.vstack([one, one[:1]]) for one in back)
    return q, v, a
