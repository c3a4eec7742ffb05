"""Play that a load crosses a few times, in mode "forward", with motion by an integrator that stands here: a link that swings
over the top hangs on either side of its play, and rings where it crosses."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
GRAVITY = 9.81
DURATION_S, STEP_S, EVERY = 9.0, 2e-5, 200
REST_S = 0.6
SEEDS = range(69_300, 69_308)
# what was named in its place; damping, which it shakes, was named beside it in two of eight
STAND_INS = {"joint_zero", "joint_ripple", "joint_stiffness", "joint_cubic_stiffness"}


class Swing:
    """A link that a motor leads over the top through a spring, a damper and play."""

    def __init__(self, seed: int):
        draw = np.random.default_rng(seed)
        self.mass, self.lever, self.reach = draw.uniform(8, 25), draw.uniform(0.15, 0.4), draw.uniform(0.4, 0.8)
        self.inertia = draw.uniform(0.2, 1.0)
        load = self.mass * GRAVITY * self.lever
        self.stiffness = load / draw.uniform(0.5e-3, 2e-3)
        about_axis = self.inertia + self.mass * self.lever**2
        self.damping = 2 * draw.uniform(0.02, 0.1) * math.sqrt(self.stiffness * about_axis)
        # of what the load winds up
        self.gap = draw.uniform(0.3, 3.0) * load / self.stiffness
        self.swing, self.pace_hz = draw.uniform(0.4, 0.9), draw.uniform(0.15, 0.35)
        self.about_axis, self.load = about_axis, load

    def command(self, time: float) -> tuple[float, float]:
        """Of the motor: angle and speed."""
        share = min(max((time - REST_S) / 1.5, 0.0), 1.0)
        rise, rate = share**3 * (10 - 15 * share + 6 * share**2), 30 * share**2 * (1 - share) ** 2 / 1.5
        turn = 2 * math.pi * self.pace_hz
        sine, cosine = math.sin(turn * (time - REST_S) + 0.4), math.cos(turn * (time - REST_S) + 0.4)
        start = -math.pi / 2 + 0.5 * self.swing
        return start + self.swing * rise * sine, self.swing * (rate * sine + rise * turn * cosine)

    def torque(self, time: float, angle: float, speed: float) -> float:
        """Through the transmission: nothing within the play."""
        led, led_speed = self.command(time)
        windup = led - angle
        if abs(windup) <= self.gap / 2:
            return 0.0
        beyond = windup - math.copysign(self.gap / 2, windup)
        return self.stiffness * beyond + self.damping * (led_speed - speed)

    def moved(self) -> np.ndarray:
        """Rows of time, command, torque and angle."""

        def rate(time: float, angle: float, speed: float) -> tuple[float, float]:
            torque = self.torque(time, angle, speed) + self.load * math.cos(angle)
            return speed, torque / self.about_axis

        angle, speed = self.command(0.0)[0], 0.0
        for _ in range(50):
            pull = self.load * math.cos(angle)
            angle = self.command(0.0)[0] + pull / self.stiffness + math.copysign(self.gap / 2, pull)
        rows, h = [], STEP_S
        for step in range(round(DURATION_S / h) + 1):
            time = step * h
            if step % EVERY == 0:
                rows.append((time, self.command(time)[0], self.torque(time, angle, speed), angle))
            a = rate(time, angle, speed)
            b = rate(time + h / 2, angle + h / 2 * a[0], speed + h / 2 * a[1])
            c = rate(time + h / 2, angle + h / 2 * b[0], speed + h / 2 * b[1])
            d = rate(time + h, angle + h * c[0], speed + h * c[1])
            angle += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            speed += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        return np.array(rows)

    def write(self, folder: Path, seed: int) -> Path:
        """Robot, configuration, scenario and data; with noise of the torque and of the tool's height."""
        rows = self.moved()
        time, command, torque, angle = rows.T
        draw = np.random.default_rng(seed + 1)
        torque = torque + draw.normal(0, 2e-3 * np.std(torque), len(time))
        height = -self.reach * np.sin(angle) + draw.normal(0, 10e-6, len(time))
        table = np.column_stack([time, command, torque, height])
        np.savetxt(folder / "data.csv", table, delimiter=",", header="t,led,torque,z", comments="", fmt="%.9g")
        (folder / "robot.urdf").write_text(
            f"""<robot name="swing"><link name="base"/><link name="arm"><inertial><origin xyz="{self.lever!r} 0 0"/>
<mass value="{self.mass!r}"/><inertia ixx="0.05" iyy="{self.inertia!r}" izz="{self.inertia!r}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"/><joint name="axis" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-4" upper="1" effort="2000" velocity="6"/></joint><joint name="end" type="fixed"><parent link="arm"/>
<child link="tip"/><origin xyz="{self.reach!r} 0 0"/></joint></robot>""",
            encoding="utf-8",
        )
        (folder / "robot.toml").write_text(
            f"""[[joint]]
name = "axis"
stiffness_nm_per_rad = {self.stiffness!r}
damping_nm_s_per_rad = {self.damping!r}
dry_friction_nm = 0
rotor_inertia_kg_m2 = 0.1
source = {{ stiffness = "set", damping = "set", dry_friction = "set", rotor_inertia = "set" }}
""",
            encoding="utf-8",
        )
        channels = [
            ("led", "joint1.command", "rad", 'role = "input"'),
            ("torque", "joint1.transmission_torque", "N m", ""),
            ("z", "tool.position_z", "m", ""),
        ]
        told = "".join(
            f'[[data.channel]]\ncolumn = "{column}"\nchannel = "{channel}"\nunit = "{unit}"\n{role}\n'
            for column, channel, unit, role in channels
        )
        scenario = folder / "swing.toml"
        scenario.write_text(
            f"""name = "A link that swings over the top"
[robot]
urdf = "robot.urdf"
config = "robot.toml"
posture_deg = [{math.degrees(command[0])!r}]
drive = "position"
hold_against_sag = false
[process.replay]
mode = "forward"
[data]
file = "data.csv"
time = "t"
{told}""",
            encoding="utf-8",
        )
        return scenario


@pytest.mark.parametrize("seed", some(SEEDS, 3))
def test_crosscheck_play_that_a_load_crosses_a_few_times_is_named(seed, tmp_path):
    """It was named as a zero that is off by half of it, or as a softer joint."""
    swing = Swing(seed)
    scenario = swing.write(tmp_path, seed)
    call = [PROGRAM, "diagnose", scenario, "--out", tmp_path / "out"]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    answer = json.loads((tmp_path / "out" / "swing" / "diagnosis.json").read_text(encoding="utf-8"))
    causes = {cause["kind"]: cause for cause in answer["causes"]}
    assert "joint_backlash" in causes and not STAND_INS & causes.keys(), answer["reason"]
    found = causes["joint_backlash"]["parameters"]["gap_rad"]["value"]
    assert found == pytest.approx(swing.gap, rel=0.03)
    for other in answer["alternatives"]:
        assert not STAND_INS & {cause["kind"] for cause in other["causes"]}
