"""Experiments drawn at random: an arm, a motion or a force, what is measured, and what is not known exactly."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from bench import motion, sensors
from bench.arm import gravity_on_base, model_of
from bench.effects import Effect
from scipy.interpolate import CubicSpline
from scipy.signal import butter, filtfilt
from truecut_reference import scenario as scenario_file

from .arms import ArmDraw, draw_arm, draw_urdf
from .laws import Foreign, against
from .moving import STILL_SAMPLES, Moving

# what an arm is with, rather than what acts in its joints
BUILT_IN = ("payload", "base_tilt", "joint_zero")
# of the noise, what outputs of data may be off by their steps; and how much smaller these may be made for it
LARGEST_ERROR = 0.1
MOST_FINER = 8


@dataclass(frozen=True)
class Uncertain:
    """A nominal number that may be refitted: its key, and one standard deviation."""

    key: str
    word: str
    deviation: float


class Experiment:
    """What all have: `outputs` with their units, `uncertain`, times of samples, and `predict`."""

    mode = ""
    band_hz: float
    outputs: list[tuple[str, str]]
    uncertain: list[Uncertain]

    # where nothing is stepped there is none
    step_s = 0.0

    def __init__(self, draw: np.random.Generator, folder: Path) -> None:
        self.folder = folder
        self.kept: dict[tuple, tuple[np.ndarray, np.ndarray]] = {}
        # coarser steps, where only differences of runs are asked for
        self.fast = False
        # what every unit has as an effect of the scenario, to be refitted: a lag of all that is measured
        self.lag_s, self.lag_deviation_s = 0.0, 0.0

    @property
    def joints(self) -> int:
        """Of the arm."""
        return self.arm.joints

    def draw_times(self, draw: np.random.Generator, irregular: bool) -> None:
        """When samples are taken: at equal distances, or off them by up to a fifth of one."""
        count = round(self.duration_s * self.rate_hz) + 1
        off = draw.uniform(-0.2, 0.2, count) if irregular else np.zeros(count)
        off[[0, -1]] = 0.0
        self.time = (np.arange(count) + off) / self.rate_hz

    def predict(self, effects: tuple = (), shifts: tuple[float, ...] = ()) -> np.ndarray:
        """Outputs at the samples (SI), without noise; nominal numbers shifted by so many deviations."""
        shifts = tuple(shifts) or (0.0,) * self.shifts
        acts_on_channels = lambda e: e.is_sensor if isinstance(e, Foreign) else sensors.is_sensor(e)  # noqa: E731
        physical = tuple(e for e in effects if not acts_on_channels(e))
        lag_s = self.lag_s + (self.lag_deviation_s * shifts[-1] if self.lag_deviation_s else 0.0)
        own = shifts[: len(self.uncertain)]
        key = (repr(physical), own, self.fast, self.step_s)
        if key not in self.kept:
            if len(self.kept) > 60:
                self.kept.pop(next(iter(self.kept)))
            self.kept[key] = self.run(physical, own)
        time_s, fine = self.kept[key]
        known = [e for e in effects if not isinstance(e, Foreign)]
        found = []
        for i, (channel, _) in enumerate(self.outputs):
            values = fine[:, i]
            for effect in effects:
                if isinstance(effect, Foreign) and effect.target == channel:
                    values = values + effect.sensed(values)
            of_channel = [e for e in known if e.kind == sensors.CLOCK]
            of_channel += [e for e in known if sensors.is_sensor(e) and e.target == channel]
            found.append(sensors.measured(time_s, values, of_channel, self.time - lag_s))
        return np.stack(found, axis=1)

    def converged(self, effects: tuple, shifts: tuple[float, ...], noise_rms: np.ndarray) -> np.ndarray:
        """Outputs as data are made of: at steps so small that what is left of their error is lost in the noise.

        Dry friction and flanks that meet are of first order in the step: at the step that does for an arm on its springs
        alone they may be off by as much as the noise, and a diagnosis would be asked for that.
        """
        whole, coarse = self.step_s, self.predict(effects, shifts)
        try:
            while whole and self.step_s > whole / MOST_FINER:
                self.step_s *= 0.5
                fine = self.predict(effects, shifts)
                off = float(np.max(np.sqrt(np.mean((fine - coarse) ** 2, axis=0)) / noise_rms))
                coarse = fine
                if off < LARGEST_ERROR:
                    return fine
        finally:
            self.step_s = whole
        if whole:
            raise RuntimeError(f"steps {MOST_FINER} times smaller still change an output by {off:.2f} of its noise")
        return coarse

    @property
    def shifts(self) -> int:
        """How many numbers are refitted."""
        return len(self.uncertain) + (self.lag_deviation_s > 0.0)

    def compared(self, values: np.ndarray) -> np.ndarray:
        """What of a series the program compares."""
        return values

    def inputs(self) -> dict[str, tuple[str, str, np.ndarray]]:
        """Columns that drive the replay: channel, unit, values."""
        return {}

    def tables(self) -> str:
        """The scenario without its data."""
        raise NotImplementedError

    def write(self, stated_noise: list[float] | None) -> Path:
        """The scenario, with what is uncertain; noise of the outputs where it is stated."""
        text = self.tables()
        text += '[data]\nfile = "data.csv"\ntime = "t"\n'
        for column, (channel, unit, _) in self.inputs().items():
            text += f'[[data.channel]]\ncolumn = "{column}"\nchannel = "{channel}"\nunit = "{unit}"\nrole = "input"\n'
        for i, (channel, unit) in enumerate(self.outputs):
            text += f'[[data.channel]]\ncolumn = "y{i + 1}"\nchannel = "{channel}"\nunit = "{unit}"\n'
            text += f"noise = {stated_noise[i]:.6g}\n" if stated_noise else ""
        if self.lag_deviation_s:
            text += f'[[effect]]\nkind = "clock_delay"\ndelay_s = {self.lag_s:.6g}\n'
            text += f'[[uncertain]]\nkey = "effect.0.delay_s"\nabsolute = {self.lag_deviation_s:.6g}\n'
        for one in self.uncertain:
            text += f'[[uncertain]]\nkey = "{one.key}"\n{one.word} = {one.deviation:.6g}\n'
        path = self.folder / "drawn.toml"
        path.write_text(text, encoding="utf-8")
        return path

    def signals(self) -> list[dict[str, float]]:
        """Of each joint without effects: effort, speed, travel, place, wind-up; sizes of effects go by them."""
        raise NotImplementedError


class Inverse(Experiment):
    """Drive torques of a motion that was measured."""

    mode = "inverse"

    def __init__(self, draw: np.random.Generator, folder: Path, joints: int | None = None) -> None:
        super().__init__(draw, folder)
        joints = joints or int(draw.integers(1, 8))
        self.rate_hz = float(draw.choice([100.0, 125.0, 200.0]))
        self.duration_s = float(draw.uniform(8.0, 20.0))
        base, harmonics = draw.uniform(0.08, 0.2), int(draw.integers(4, 8))
        self.top_hz = base * harmonics
        self.band_hz = round(float(draw.uniform(3.5, 7.0) * max(self.top_hz, 1.0)), 1)
        # a record holds at least so many independent samples
        self.duration_s = max(self.duration_s, 100.0 / self.band_hz)
        self.base_hz = base
        number = np.arange(1, harmonics + 1)[:, None]
        self.waves = draw.normal(0.0, 1.0, (2, harmonics, joints)) / number
        self.places = draw.uniform(-1.5, 1.5, joints)
        self.reach = draw.uniform(0.3, 0.9, joints)
        urdf = draw_urdf(draw, joints)
        self.draw_times(draw, bool(draw.random() < 0.3))
        self.arm = draw_arm(draw, urdf, self.motion(self.time)[0][::20], 10.0, 30.0)
        self.outputs = [(f"joint{j + 1}.drive_torque", "N m") for j in range(joints)]
        self.uncertain = [Uncertain("robot.inertia_scale", "relative", 0.02)]
        self.links = bool(draw.random() < 0.4)
        if self.links:
            self.uncertain = [Uncertain(f"robot.link.{j}.mass_factor", "relative", 0.03) for j in range(joints)]
        self.arm.write(folder)
        # earlier and later for delays; straight lines between these err by some 1e-5
        self.fine = np.linspace(-0.1, self.duration_s + 0.1, round((self.duration_s + 0.2) * 4.0 * self.rate_hz))
        self.q, self.v, self.a = self.motion(self.fine)

    def motion(self, time_s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places, velocities and accelerations of the joints."""
        rate = 2.0 * np.pi * self.base_hz * np.arange(1, self.waves.shape[1] + 1)
        turn = rate[None, :] * time_s[:, None]
        sine, cosine = self.waves * self.reach
        q = np.sin(turn) @ sine + np.cos(turn) @ cosine
        v = (np.cos(turn) * rate) @ sine - (np.sin(turn) * rate) @ cosine
        a = -(np.sin(turn) * rate**2) @ sine - (np.cos(turn) * rate**2) @ cosine
        return self.places + q, v, a

    @functools.cached_property
    def robot(self):
        """As the reference reads it."""
        return scenario_file.load(self.write(None), {}).robot

    def needed(self, effects: list[Effect], mass_factors: np.ndarray) -> np.ndarray:
        """Torques without friction."""
        model = model_of(self.robot, effects)
        model.opt.gravity[:] = gravity_on_base(effects)
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        model.jnt_stiffness[:] = 0.0
        model.dof_damping[:] = 0.0
        model.qpos_spring[:] = 0.0
        own = [model.body(f"link_{j + 1}").id for j in range(self.joints)]
        model.body_mass[own] *= mass_factors
        model.body_inertia[own] *= mass_factors[:, None]
        data, found = mujoco.MjData(model), np.empty_like(self.q)
        for k in range(self.fine.size):
            data.qpos[:], data.qvel[:], data.qacc[:] = self.q[k], self.v[k], self.a[k]
            mujoco.mj_inverse(model, data)
            found[k] = data.qfrc_inverse
        return found

    def run(self, effects: tuple, shifts: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Fine times and torques."""
        of_one = np.array([1.0 + one.deviation * shift for one, shift in zip(self.uncertain, shifts)])
        factors = of_one if self.links else np.full(self.joints, of_one[0])
        built = [e for e in effects if e.kind in BUILT_IN]
        key = ("needed", repr(built), tuple(factors))
        if key not in self.kept:
            self.kept[key] = (self.fine, self.needed(built, factors))
        # rotors are inertias, too; masses of links are not
        rotor = self.arm.rotor * (1.0 if self.links else of_one[0])
        found = self.kept[key][1].copy()
        for j in range(self.joints):
            mine = [e for e in effects if e.target == j + 1 and e not in built]
            if mine:
                found[:, j] += against(mine, found[:, j], self.fine, self.q[:, j], self.v[:, j], self.v)
        # the drive turns its rotor itself: that does not pass through the transmission
        return self.fine, found + rotor * self.a

    def compared(self, values: np.ndarray) -> np.ndarray:
        """Below the cutoff, as the program filters drive forces."""
        b, a = butter(4, self.band_hz, fs=self.rate_hz)
        return filtfilt(b, a, values, axis=0)

    def inputs(self):
        """Angles."""
        q, _, _ = self.motion(self.time)
        return {f"q{j + 1}": (f"joint{j + 1}.angle", "rad", q[:, j]) for j in range(self.joints)}

    def tables(self) -> str:
        """Mode "inverse", forces below the band."""
        text = 'name = "drawn"\n[robot]\nurdf = "robot.urdf"\n'
        if self.links:
            text += "".join(f'[[robot.link]]\nname = "link_{j + 1}"\nmass_factor = 1.0\n' for j in range(self.joints))
        cut_hz = min(2.0 * self.band_hz, 0.4 * self.rate_hz)
        text += f'[process.replay]\nmode = "inverse"\ndifferentiate_cutoff_hz = {cut_hz}\n'
        return text + f"compare_cutoff_hz = {self.band_hz}\n"

    def motion_of(self, joint: int) -> tuple[np.ndarray, np.ndarray]:
        """Coordinate and velocity of a joint, counted from 1."""
        return self.q[:, joint - 1], self.v[:, joint - 1]

    def signals(self) -> list[dict[str, float]]:
        """Sizes that effects go by."""
        _, torque = self.run((), (0.0,) * len(self.uncertain))
        q, v = self.q, self.v
        return [
            {
                "effort": float(np.std(torque[:, j]) + 0.1 * np.abs(torque[:, j]).max()),
                "speed": float(np.std(v[:, j])),
                "travel": float(np.std(q[:, j])),
                "place": float(np.mean(q[:, j])),
            }
            for j in range(self.joints)
        ]


class Sprung(Experiment):
    """An arm on its springs."""

    step_s = 0.25e-3
    oracle_step_s = 0.8e-3

    def __init__(self, draw: np.random.Generator, folder: Path, joints: int | None = None) -> None:
        super().__init__(draw, folder)
        self.count = joints or int(draw.choice([1, 2, 3, 4, 5, 6, 7], p=[0.35, 0.35, 0.18, 0.06, 0.02, 0.02, 0.02]))
        self.rate_hz = float(draw.choice([200.0, 250.0, 400.0]))
        self.duration_s = float(draw.uniform(2.5, 3.5))
        self.band_hz = 30.0
        self.uncertain = [Uncertain("robot.inertia_scale", "relative", 0.02)]
        if draw.random() < 0.3:
            self.uncertain.append(Uncertain("robot.stiffness_scale", "relative", 0.03))

    def draw_lag(self, draw: np.random.Generator) -> None:
        """All that is measured comes late, by about this much."""
        self.lag_s, self.lag_deviation_s = float(draw.uniform(0.002, 0.008)), 0.001

    def force(self, _t: float) -> np.ndarray | None:
        """On the tool, N, world."""
        return None

    release = None
    pushed = False

    def run(self, effects: tuple, shifts: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Fine times and outputs."""
        path = self.folder / "drawn.toml"
        if not path.exists():
            self.write(None)
        overrides = {one.key: 1.0 + one.deviation * shift for one, shift in zip(self.uncertain, shifts)}
        robot = scenario_file.load(path, overrides).robot
        step = self.oracle_step_s if self.fast else self.step_s
        force = self.force if self.pushed else None
        arm = Moving(robot, list(effects), self.command_time, self.command, step, force, self.release)
        time_s, channels = arm.run(every=1)
        self.last = channels
        return time_s, np.stack([channels[name] for name, _ in self.outputs], axis=1)

    def motion_of(self, joint: int) -> tuple[np.ndarray, np.ndarray]:
        """Coordinate and velocity of a joint, counted from 1, as it ran last."""
        q = self.last[f"joint{joint}.angle"]
        return q, np.gradient(q) / (self.duration_s / q.size)

    def signals(self) -> list[dict[str, float]]:
        """Sizes that effects go by."""
        self.run((), (0.0,) * len(self.uncertain))
        found = []
        for j in range(self.joints):
            q, torque = (self.last[f"joint{j + 1}.{name}"] for name in ("angle", "transmission_torque"))
            speed = np.gradient(q) / (self.duration_s / q.size)
            one = {
                "effort": float(np.std(torque) + 0.1 * np.abs(torque).max()),
                "speed": float(np.std(speed)),
                "travel": float(np.std(q)),
                "place": float(np.mean(q)),
                "windup": float(np.std(torque) / self.arm.stiffness[j]),
                "most_windup": float(np.abs(torque).max() / self.arm.stiffness[j]),
            }
            found.append(one)
        return found


class Forward(Sprung):
    """Commands lead the motors; torques and a place of the tool are measured, sometimes joint angles."""

    mode = "forward"

    def __init__(self, draw: np.random.Generator, folder: Path, joints: int | None = None) -> None:
        super().__init__(draw, folder, joints)
        self.command_time = np.arange(round(self.duration_s * self.rate_hz) + 1) / self.rate_hz
        t = self.command_time
        top = draw.uniform(1.5, 4.0)
        self.command = np.stack(
            [
                draw.uniform(-1.5, 1.5)
                + motion.at_rest_outside(
                    t, draw.uniform(0.2, 0.7) * motion.multisine(t, 0.4, top, 8, int(draw.integers(1 << 30)))
                )
                for _ in range(self.count)
            ],
            axis=1,
        )
        self.arm = draw_arm(draw, draw_urdf(draw, self.count), self.command[::25], 12.0, 30.0)
        self.draw_times(draw, bool(draw.random() < 0.3))
        self.outputs = [(f"joint{j + 1}.transmission_torque", "N m") for j in range(self.count)]
        self.outputs += [(f"tool.position_{axis}", "m") for axis in "xyz" if draw.random() < 0.5]
        if draw.random() < 0.4:
            self.outputs += [(f"joint{j + 1}.angle", "rad") for j in range(self.count)]
        self.arm.write(folder)

    def inputs(self):
        """Commands."""
        at = CubicSpline(self.command_time, self.command)(self.time)
        return {f"c{j + 1}": (f"joint{j + 1}.command", "rad", at[:, j]) for j in range(self.count)}

    def tables(self) -> str:
        """Mode "forward"."""
        robot = 'name = "drawn"\n[robot]\nurdf = "robot.urdf"\ndrive = "position"\nhold_against_sag = false\n'
        return robot + '[process.replay]\nmode = "forward"\n'


class Load(Sprung):
    """A force at the tool is let go, or swept in frequency; places of the tool are measured, sometimes torques."""

    mode = "load"

    def __init__(self, draw: np.random.Generator, folder: Path, joints: int | None = None) -> None:
        super().__init__(draw, folder, joints)
        self.posture = draw.uniform(-1.5, 1.5, self.count)
        self.arm = draw_arm(draw, draw_urdf(draw, self.count), self.posture, 6.0, 20.0)
        self.command_time = np.linspace(0.0, self.duration_s, STILL_SAMPLES)
        self.command = np.tile(self.posture, (STILL_SAMPLES, 1))
        direction = draw.normal(size=3)
        direction /= np.linalg.norm(direction)
        # as much as moves the joints' springs by some milliradians
        reach = 0.3 * self.count
        force = draw.uniform(2e-3, 8e-3) * float(np.min(self.arm.stiffness)) / reach
        self.amplitude = np.round(force * direction, 6)
        self.to_hz = float(np.round(draw.uniform(15.0, 30.0), 1))
        self.pushed = bool(draw.random() < 0.5)
        self.release = None if self.pushed else self.amplitude
        self.draw_times(draw, bool(draw.random() < 0.3))
        self.outputs = [(f"tool.position_{axis}", "m") for axis in "xyz"]
        if draw.random() < 0.5:
            self.outputs += [(f"joint{j + 1}.transmission_torque", "N m") for j in range(self.count)]
        self.arm.write(folder)

    def force(self, t: float) -> np.ndarray:
        """The sweep, linear in frequency from 1 Hz."""
        rate = (self.to_hz - 1.0) / self.duration_s
        return self.amplitude * np.sin(2.0 * np.pi * (1.0 + 0.5 * rate * t) * t)

    def tables(self) -> str:
        """`[process.load]`."""
        text = (
            'name = "drawn"\n[robot]\nurdf = "robot.urdf"\nhold_against_sag = false\n'
            f"posture_deg = {np.degrees(self.posture).tolist()}\n[run]\nduration_s = {self.duration_s!r}\n"
            '[process.load]\nframe = "world"\n'
        )
        amplitude = self.amplitude.tolist()
        if self.pushed:
            return text + f"[process.load.sweep]\namplitude_n = {amplitude}\nfrom_hz = 1\nto_hz = {self.to_hz}\n"
        return text + f"release_n = {amplitude}\n"


MODES = {"inverse": Inverse, "forward": Forward, "load": Load}
__all__ = ["ArmDraw", "Experiment", "Inverse", "Forward", "Load", "MODES"]
