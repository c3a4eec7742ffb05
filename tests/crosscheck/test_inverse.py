"""Drive forces of a measured motion: truecut's inverse dynamics against MuJoCo's, where no trajectory is integrated.

The motion is a sum of sines that ends where it begins to be filtered away: it holds nothing above 2 Hz, and the
filters at 50 Hz change it by (2/50)^8, 7e-12. Central differences at 1 kHz leave (2 pi 2 Hz 1 ms)^2 / 6, 3e-5. The
first and the last half second belong to the filters' ends.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from conftest import FIGURES, ROBOTS
from truecut_reference import compare, models
from truecut_reference import scenario as scenario_file
from truecut_reference.plant import Plant
from truecut_reference.urdf_model import from_urdf, rotor_inertia

ROBOT = "irb6600_175_255"
JOINTS = 6
RATE_HZ, DURATION_S, ENDS_S = 1000, 4.0, 0.5
BOUND = 1e-4
HEAD = """
name = "inverse"
[robot]
urdf = "{urdf}"
posture_deg = {posture}
{adjusted}
[process.replay]
mode = "inverse"
differentiate_cutoff_hz = 50
compare_cutoff_hz = 50
[data]
file = "motion.csv"
time = "t_s"
"""
CHANNEL = """
[[data.channel]]
column = "{quantity}_{number}"
channel = "joint{number}.{channel}"
unit = "{unit}"
{role}
"""
ADJUSTED = """
[[robot.link]]
name = "link_3"
mass_factor = 1.15
center_x_mm = 25.0
center_y_mm = -40.0
[[robot.joint]]
name = "joint_2"
rotor_inertia_factor = 1.8
[[robot.joint]]
name = "joint_6"
rotor_inertia_factor = 0.0
"""


def motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates, velocities and accelerations of all joints, a row per instant."""
    found = [np.zeros((t.size, JOINTS)) for _ in range(3)]
    for joint, start in enumerate(models.SOURCE_A_POSTURE_DEG):
        found[0][:, joint] = math.radians(start)
        for part, hz in enumerate((0.4 + 0.07 * joint, 1.1 + 0.05 * joint, 1.7 + 0.03 * joint)):
            w, phase = 2.0 * math.pi * hz, 0.9 * joint + 2.1 * part
            size = 0.12 / (1.0 + part)
            found[0][:, joint] += size * np.sin(w * t + phase)
            found[1][:, joint] += size * w * np.cos(w * t + phase)
            found[2][:, joint] -= size * w**2 * np.sin(w * t + phase)
    return tuple(found)


def drive_torques(plant: Plant, rotors: np.ndarray, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """MuJoCo's inverse dynamics of the rigid arm, and what turns the rotors."""
    model, data = plant.model, plant.data
    model.dof_armature[:] = rotors
    model.dof_damping[:] = 0.0
    model.jnt_stiffness[:] = 0.0
    found = np.zeros_like(q)
    for row in range(q.shape[0]):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[row], v[row], a[row]
        mujoco.mj_inverse(model, data)
        found[row] = data.qfrc_inverse
    return found


@pytest.mark.parametrize(("name", "adjusted"), [("as_filed", ""), ("adjusted", ADJUSTED)])
def test_crosscheck_mujoco_inverse_dynamics(truecut, tmp_path, name, adjusted):
    """Torque of every joint, 0.01 % of its RMS, also with `[[robot.link]]` and `[[robot.joint]]`."""
    channels = [("q", "angle", "rad", 'role = "input"'), ("torque", "drive_torque", "N m", "")]
    rows = [
        CHANNEL.format(quantity=quantity, number=number, channel=channel, unit=unit, role=role)
        for quantity, channel, unit, role in channels
        for number in range(1, JOINTS + 1)
    ]
    posture = list(models.SOURCE_A_POSTURE_DEG)
    path = tmp_path / "inverse.toml"
    head = HEAD.format(urdf=ROBOTS / ROBOT / "robot.urdf", posture=posture, adjusted=adjusted)
    path.write_text(head + "".join(rows), encoding="utf-8")
    robot = scenario_file.load(path).robot
    plant = Plant(from_urdf(robot), robot)
    names = [plant.model.joint(i).name for i in range(JOINTS)]
    t = np.arange(round(DURATION_S * RATE_HZ) + 1) / RATE_HZ
    q, v, a = motion(t)
    expected = drive_torques(plant, rotor_inertia(robot, names), q, v, a)
    head = ["t_s"] + [f"{c[0]}_{n}" for c in channels for n in range(1, JOINTS + 1)]
    np.savetxt(
        tmp_path / "motion.csv",
        np.column_stack([t, q, expected]),
        delimiter=",",
        header=",".join(head),
        comments="",
        fmt="%.15g",
    )
    recorded = compare.Recording.read(truecut.record(path))
    inner = (t >= ENDS_S) & (t <= DURATION_S - ENDS_S)
    errors = []
    for joint in range(JOINTS):
        told = np.interp(t, recorded.time_s, recorded.channels[f"joint{joint + 1}.drive_torque"])
        error = (told - expected[:, joint])[inner]
        errors.append(float(np.sqrt(np.mean(error**2) / np.mean(expected[inner, joint] ** 2))))
    FIGURES.append(f"inverse dynamics {name:23} {max(errors):8.4%} of the torque's RMS at most")
    assert max(errors) <= BOUND, errors
