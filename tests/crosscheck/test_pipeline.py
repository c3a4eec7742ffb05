"""Before any trajectory: is it the same machine? Masses and inertias, frames, command, mass matrix, modes, in order.

Three descriptions meet here: the model that truecut exports, MuJoCo's own reading of the same URDF (with robot.toml),
and what `truecut robot --json` says of itself. The arm also meets a model written by hand from `docs/physics/arm.md`.
"""

from __future__ import annotations

import json
import math
import random

import mujoco
import numpy as np
import pytest

from conftest import ROBOTS
from truecut_reference import models
from truecut_reference import scenario as scenario_file
from truecut_reference.plant import Plant, modes_hz
from truecut_reference.urdf_model import from_urdf

SOURCE_A = list(models.SOURCE_A_POSTURE_DEG)
POSTURES = [SOURCE_A] + [[round(random.Random(seed).uniform(-60.0, 60.0), 3) for _ in range(6)] for seed in range(1, 6)]
# rotary joints in degrees, prismatic in millimetres
CASES = [("irb6600_175_255", p, []) for p in POSTURES] + [("rig_planar", [], [3.0, -2.0, 5.0]), ("rig_1dof", [], [4.0])]
SCENARIO = """
name = "pipeline"
[robot]
urdf = "{urdf}"
posture_deg = {deg}
posture_mm = {mm}
inertia_scale = {scale}
{adjusted}
[run]
duration_s = 0.01
[process.load]
"""


# a link amid the chain, and the last one, to which the end effector is fixed
ADJUSTED = """
[[robot.link]]
name = "link_3"
mass_factor = 1.15
center_x_mm = 25.0
center_y_mm = -40.0
[[robot.link]]
name = "link_6"
mass_factor = 0.8
center_x_mm = 3.0
center_z_mm = 60.0
"""


class Machine:
    """One robot at one posture as truecut exports it, as MuJoCo reads it, and as truecut describes it."""

    def __init__(self, truecut, folder, name, deg, mm, scale=1.0, adjusted=""):
        urdf = ROBOTS / name / "robot.urdf"
        path = folder / "pipeline.toml"
        text = SCENARIO.format(urdf=urdf, deg=deg, mm=mm, scale=scale, adjusted=adjusted)
        path.write_text(text, encoding="utf-8")
        self.scenario = scenario_file.load(path)
        self.path = path
        exported = truecut.mjcf(path)
        self.exported_springref = mujoco.MjModel.from_xml_string(exported).qpos_spring.copy()
        self.exported = Plant(exported, self.scenario.robot)
        self.read = Plant(from_urdf(self.scenario.robot), self.scenario.robot)
        # one list for both kinds of joint: degrees or millimetres
        posture = ",".join(map(str, deg + mm))
        self.told = json.loads(truecut.call("robot", urdf, "--json", f"--posture-deg={posture}"))


@pytest.fixture(params=CASES, ids=[f"{c[0]}-{i}" for i, c in enumerate(CASES)])
def machine(request, truecut, tmp_path):
    """Every robot asset; the arm at six postures."""
    return Machine(truecut, tmp_path, *request.param)


def moving_links(model: mujoco.MjModel) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Mass, centre of mass and inertia about it, world axes, of all that moves with each joint rigidly."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = []
    for joint in range(model.njnt):
        owner = model.jnt_bodyid[joint]
        bodies = [b for b in range(1, model.nbody) if model.body_weldid[b] == owner]
        mass = sum(model.body_mass[b] for b in bodies)
        com = sum(model.body_mass[b] * data.xipos[b] for b in bodies) / mass
        inertia = np.zeros((3, 3))
        for b in bodies:
            axes = data.ximat[b].reshape(3, 3)
            arm = data.xipos[b] - com
            inertia += axes @ np.diag(model.body_inertia[b]) @ axes.T
            inertia += model.body_mass[b] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        found.append((float(mass), com, inertia))
    return found


def test_crosscheck_mujoco_masses_and_inertias(machine):
    """Merging of fixed links included: mass, centre of mass and inertia of every moving link, 1e-9 relative."""
    told = machine.told["links"]
    pairs = zip(moving_links(machine.exported.model), moving_links(machine.read.model), told, strict=True)
    for exported, read, link in pairs:
        assert exported[0] == pytest.approx(read[0], rel=1e-9)
        assert link["mass_kg"] == pytest.approx(read[0], rel=1e-9)
        assert exported[1] == pytest.approx(read[1], abs=1e-9)
        size = np.abs(read[2]).max()
        assert np.abs(exported[2] - read[2]).max() <= 1e-9 * size
        principal = np.linalg.eigvalsh(read[2])
        assert link["principal_inertia_kg_m2"] == pytest.approx(principal, rel=1e-9, abs=1e-12)


def test_crosscheck_mujoco_forward_kinematics(machine):
    """Position and orientation of flange, tool and foot, 1e-9 m and 1e-9."""
    for site in ("flange", "tool", "foot"):
        expected = machine.read.data.site(site)
        exported = machine.exported.data.site(site)
        told = machine.told[site]
        for position, rotation in (
            (exported.xpos, exported.xmat.reshape(3, 3)),
            (np.array(told["position_m"]), np.array(told["rotation"])),
        ):
            assert position == pytest.approx(expected.xpos, abs=1e-9)
            assert np.abs(rotation - expected.xmat.reshape(3, 3)).max() <= 1e-9


def test_crosscheck_mujoco_springs_dampers_and_command(machine):
    """Transmission data of robot.toml, and the command that makes up for the sag."""
    assert machine.exported.stiffness == pytest.approx(machine.read.stiffness, rel=1e-12)
    assert machine.exported.damping == pytest.approx(machine.read.damping, rel=1e-12)
    assert machine.exported_springref == pytest.approx(machine.read.command0, abs=1e-10)


def test_crosscheck_mujoco_mass_matrix(machine):
    """1e-6 of the largest entry, truecut's own matrix and that of the exported model."""
    expected = machine.read.mass_matrix()
    bound = 1e-6 * np.abs(expected).max()
    assert np.abs(np.array(machine.told["mass_matrix"]) - expected).max() <= bound
    assert np.abs(machine.exported.mass_matrix() - expected).max() <= bound


def test_crosscheck_mujoco_modes(machine):
    """Natural frequencies without the gravity term, 0.01 %."""
    expected = modes_hz(machine.read.stiffness, machine.read.mass_matrix())
    assert [mode["frequency_hz"] for mode in machine.told["modes"]] == pytest.approx(expected, rel=1e-4)


def test_crosscheck_mujoco_stiffness_at_the_tool(machine):
    """Directional stiffness with free rotation, process axes, from MuJoCo's Jacobian; 1e-9 relative.

    A direction in which the joints cannot yield has none: what rounding leaves there is not compared.
    """
    told = machine.told["stiffness"]
    assert np.array(told["process_axes"]) == pytest.approx(machine.read.axes, abs=1e-9)
    compliance = np.diag(machine.read.compliance("tool"))
    yields = compliance > 1e-12 * compliance.max()
    assert np.count_nonzero(yields) == min(3, machine.read.nv)
    for axis in np.flatnonzero(yields):
        assert told["free"][f"{'xyz'[axis]}_n_per_m"] == pytest.approx(1.0 / compliance[axis], rel=1e-9)


def test_crosscheck_mujoco_arm_is_the_specified_one(truecut, tmp_path):
    """The asset against the hand-written surrogate of `docs/physics/arm.md`, masses times 0.82: mass, tool, modes."""
    machine = Machine(truecut, tmp_path, "irb6600_175_255", SOURCE_A, [])
    by_hand = Plant(models.irb6600(inertia_scale=0.82), machine.scenario.robot)
    difference = np.abs(machine.exported.mass_matrix() - by_hand.mass_matrix()).max()
    assert difference <= 1e-6 * np.abs(by_hand.mass_matrix()).max()
    assert machine.exported.tool_position0 == pytest.approx(by_hand.tool_position0, abs=1e-9)
    assert modes_hz(machine.exported.stiffness, machine.exported.mass_matrix())[0] == pytest.approx(6.672, abs=1e-3)


def test_crosscheck_mujoco_inertia_scale_reaches_the_export(truecut, tmp_path):
    """`inertia_scale` multiplies the mass matrix: the control that the comparisons above can fail."""
    plain = Machine(truecut, tmp_path, "irb6600_175_255", SOURCE_A, [])
    heavy = Machine(truecut, tmp_path, "irb6600_175_255", SOURCE_A, [], scale=1.5)
    assert heavy.exported.mass_matrix() == pytest.approx(1.5 * plain.exported.mass_matrix(), rel=1e-9)
    assert math.isclose(heavy.read.mass_matrix()[0, 0], heavy.exported.mass_matrix()[0, 0], rel_tol=1e-9)


def test_crosscheck_mujoco_adjusted_links_reach_the_export(truecut, tmp_path):
    """`[[robot.link]]`: mass, centre and inertia of every moving link, 1e-9 relative, what is fixed to a link included.

    Without the adjustments the mass matrix is 1 % off and more: the control that this can fail.
    """
    plain = Machine(truecut, tmp_path, "irb6600_175_255", SOURCE_A, [])
    other = Machine(truecut, tmp_path, "irb6600_175_255", SOURCE_A, [], adjusted=ADJUSTED)
    for exported, read in zip(moving_links(other.exported.model), moving_links(other.read.model), strict=True):
        assert exported[0] == pytest.approx(read[0], rel=1e-9)
        assert exported[1] == pytest.approx(read[1], abs=1e-9)
        assert np.abs(exported[2] - read[2]).max() <= 1e-9 * np.abs(read[2]).max()
    expected = other.read.mass_matrix()
    size = np.abs(expected).max()
    assert np.abs(other.exported.mass_matrix() - expected).max() <= 1e-6 * size
    assert np.abs(plain.exported.mass_matrix() - expected).max() >= 1e-2 * size
    assert other.exported_springref == pytest.approx(other.read.command0, abs=1e-10)
