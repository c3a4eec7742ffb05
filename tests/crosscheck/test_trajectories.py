"""The same scenario in truecut and in MuJoCo with the reference's laws: smooth forces first, then contact and cutting.

Bounds: tool displacement NRMSE 0.1 % under time-known forces, 1 % in chamfering and wheel passes, over the whole run
and while sliding; stick and slip (3 ms or longer) at the same times within 2 ms; after regenerative vibration has left
the cut the RMS within 3 %. The reference itself must move by less than a third of the bound when its step is halved.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from conftest import FIGURES, ROBOTS, ROOT, scenarios, tomllib
from truecut_reference import compare, models, run
from truecut_reference import scenario as scenario_file

SMOOTH = {
    "free_decay": "release_n = [500.0, 300.0, -400.0]",
    "step_1_kn_along_feed": "constant_n = [1000.0, 0.0, 0.0]",
    "step_1_kn_across": "constant_n = [0.0, 600.0, 800.0]",
    "world_load": 'frame = "world"\nconstant_n = [0.0, 0.0, -1000.0]',
    "sweep_1_to_60_hz": "[process.load.sweep]\namplitude_n = [100.0, 100.0, 100.0]\nfrom_hz = 1\nto_hz = 60",
    "rotating": "[process.load.rotating]\namplitude_n = 110.0\nfrequency_hz = 5.0\nstart_angle_deg = 30.0",
}
SCENARIO = """
name = "{name}"
[robot]
urdf = "{urdf}"
posture_deg = {posture}
{robot}
[run]
duration_s = {duration_s}
[process.load]
{load}
"""
FOOT = """
[process.load.rotating]
amplitude_n = 110.0
frequency_hz = 5.0
[process.load.foot]
pressure_mpa = 0.3
bore_mm = 32
cylinders = 2
seal_stiction_n = 97
[process.load.foot.friction]
law = "{law}"
{mu}
"""
# From here the arm may fall for 0.6 s before a joint meets its limit.
RAISED_POSTURE_DEG = [0.0, -12.6, -102.8, -49.0, -41.2, 0.0]
CHAMFER = ROOT / "scenarios" / "chamfer"
# Laws that no shipped scenario uses: the shipped one that comes nearest, and what is changed in it.
LAWS = {
    "full_regeneration": ("backward_low", {"regeneration": "full"}),
    # No dwell: without a chip the edge forces vanish at once, and an edge that rubs there flickers in either engine.
    "two_edges_with_edge_forces": (
        "forward_400",
        {
            "regeneration": "axial",
            "edges": 2,
            "start_angle_deg": 70.0,
            "half_angle_deg": 30.0,
            "dwell_revolutions": 0.0,
            "cutting.edge_axial_n_per_mm": 12.0,
            "cutting.edge_radial_n_per_mm": 8.0,
            "cutting.edge_tangential_n_per_mm": 5.0,
        },
    ),
    "stribeck": (
        "backward_low",
        {
            "foot.friction.law": "stribeck",
            "foot.friction.mu": 0.12,
            "foot.friction.mu_static": 0.15,
            "foot.friction.stribeck_speed_mm_per_s": 1.0,
        },
    ),
    "share_of_the_axial_force": ("forward_300", {"foot.axial_share": 0.5, "foot.seal_stiction_n": 0.0}),
}


def load_scenario(
    folder: Path, name: str, robot: str, load: str, duration_s: float = 2.0, keys: str = "", posture: list | None = None
) -> Path:
    """A scenario file with given forces; the arm stands at the posture of Dong et al. unless another is given."""
    if posture is None:
        posture = list(models.SOURCE_A_POSTURE_DEG) if robot.startswith("irb") else []
    path = folder / f"{name}.toml"
    text = SCENARIO.format(
        name=name, urdf=ROBOTS / robot / "robot.urdf", posture=posture, robot=keys, duration_s=duration_s, load=load
    )
    path.write_text(text, encoding="utf-8")
    return path


def check(truecut, name: str, path: Path, changes: dict | None = None) -> dict:
    """Report of the cross-check of one scenario file, after the verdict has been asserted."""
    recording = compare.Recording.read(truecut.record(path, changes))
    report = run.crosscheck(scenario_file.load(path, changes), truecut.mjcf(path, changes), recording)
    FIGURES.append(figures(name, report))
    assert report["agrees"], report["failures"]
    return report


def figures(name: str, report: dict) -> str:
    """NRMSE of the tool, over the run and while sliding; events; what halving the reference's step moves."""
    halving = report["halving_the_step"]
    text = f"{name:40} {report['quantities'][report['judged']]['nrmse']:8.4%} halving {halving['nrmse']:8.4%}"
    if "while_sliding" in report:
        text += f" sliding {report['while_sliding']['nrmse']:8.4%}"
    events = report.get("stick_slip")
    if events:
        text += (
            f" events {len(events['reference']):2} apart {events['largest_difference_s'] * 1e3:.3f} ms"
            f" halving {halving['events_moved_s'] * 1e3:.3f} ms"
        )
    after = report.get("after_leaving_the_cut")
    return text + (f" RMS after leaving the cut {after['rms_ratio']:.4f}" if after else "")


@pytest.mark.parametrize("robot", ["irb6600_175_255", "rig_planar"])
@pytest.mark.parametrize("name", SMOOTH)
def test_crosscheck_mujoco_smooth_forces(truecut, tmp_path, name, robot):
    """Time-known forces, 0.1 %: they separate the plant from the process laws."""
    report = check(truecut, f"{robot} {name}", load_scenario(tmp_path, name, robot, SMOOTH[name]))
    assert report["tolerance"] == 1e-3


@pytest.mark.parametrize(
    ("name", "keys", "load"),
    [
        ("sagging", "hold_against_sag = false", "constant_n = [0.0, 0.0, 500.0]"),
        (
            "weightless_soft_heavy",
            "gravity = false\ninertia_scale = 1.3\nstiffness_scale = 0.7\ndamping_scale = 2.0",
            "constant_n = [0.0, 500.0, 0.0]",
        ),
        (
            "adjusted_links_and_drives",
            '[[robot.link]]\nname = "link_2"\nmass_factor = 1.4\ncenter_x_mm = -80.0\n'
            '[[robot.link]]\nname = "link_6"\nmass_factor = 0.6\ncenter_z_mm = 120.0\n'
            '[[robot.joint]]\nname = "joint_2"\nrotor_inertia_factor = 3.0\nstiffness_factor = 0.6\n'
            '[[robot.joint]]\nname = "joint_3"\nstiffness_factor = 1.5\ndamping_factor = 2.5',
            "release_n = [300.0, 500.0, 0.0]",
        ),
    ],
)
def test_crosscheck_mujoco_plant_variants(truecut, tmp_path, name, keys, load):
    """Plants other than the default, 0.1 %: every key of `[robot]` must mean the same on both sides."""
    path = load_scenario(tmp_path, name, "irb6600_175_255", load, keys=keys)
    assert check(truecut, f"irb6600_175_255 {name}", path)["tolerance"] == 1e-3


def test_crosscheck_mujoco_falling_arm(truecut, tmp_path):
    """Gross motion, 0.1 %: free joints under gravity and a side force. Wrong Coriolis terms show only here."""
    load, keys = "constant_n = [0.0, 2000.0, 0.0]", 'drive = "force"'
    path = load_scenario(tmp_path, "falling", "irb6600_175_255", load, 0.6, keys, RAISED_POSTURE_DEG)
    report = check(truecut, "irb6600_175_255 falling", path)
    assert report["tolerance"] == 1e-3
    assert report["quantities"]["tool.displacement"]["largest"] < 1e-3


@pytest.mark.parametrize(("law", "mu"), [("coulomb", "mu = 0.12"), ("none", "")])
def test_crosscheck_mujoco_rotating_force_on_a_foot(truecut, tmp_path, law, mu):
    """A given force on a foot, with and without dry friction: contact without a cutting law."""
    load = FOOT.format(law=law, mu=mu)
    path = load_scenario(tmp_path, f"foot_{law}", "irb6600_175_255", load, duration_s=3.0)
    check(truecut, f"irb6600_175_255 foot, friction {law}", path)


def test_crosscheck_mujoco_foot_beside_the_tool(truecut, tmp_path):
    """Tool tilted, foot off its axis: forces at different points and a process frame that is not the flange's."""
    described = (ROBOTS / "irb6600_175_255" / "robot.toml").read_text(encoding="utf-8")
    tool, foot = (
        "xyz_m = [0.04, -0.03, 0.25]\nrpy_deg = [10.0, 5.0, 30.0]",
        "xyz_m = [0.0, 0.08, 0.2]\nrpy_deg = [0, 0, 0]",
    )
    joints = described[described.index("[[joint]]") :]
    config = tmp_path / "tilted.toml"
    config.write_text(f'name = "tilted"\n[frames.tool]\n{tool}\n[frames.foot]\n{foot}\n{joints}', encoding="utf-8")
    check(truecut, "foot_beside_the_tool", CHAMFER / "forward_300.toml", {"robot.config": str(config)})


def shipped(folder: str) -> list:
    """The shipped scenarios of one folder. An empty folder fails at collection instead of testing nothing."""
    found = scenarios(folder)
    assert found, f"scenarios/{folder} holds no single run"
    return [pytest.param(path, id=path.stem) for path in found]


def at_rest(path) -> bool:
    """Whether the drives stand still: an arm that a file leads is held beside MuJoCo in `test_path_file.py`."""
    return "path" not in tomllib.loads(path.read_text(encoding="utf-8"))["process"]["load"]


@pytest.mark.parametrize("path", [param for param in shipped("arm") if at_rest(*param.values)])
def test_crosscheck_mujoco_arm_scenarios(truecut, path):
    """Free decay, static load and frequency sweep as shipped."""
    check(truecut, f"arm/{path.stem}", path)


@pytest.mark.parametrize("path", shipped("chamfer"))
def test_crosscheck_mujoco_chamfer_scenarios(truecut, path):
    """Every chamfering scenario: displacement, stick and slip, what is left of the rim."""
    check(truecut, f"chamfer/{path.stem}", path)


@pytest.mark.parametrize("name", LAWS)
def test_crosscheck_mujoco_chamfer_laws(truecut, name):
    """What the format offers and no shipped scenario uses is wrong just as easily."""
    scenario, changes = LAWS[name]
    check(truecut, name, CHAMFER / f"{scenario}.toml", {f"process.chamfer.{k}": v for k, v in changes.items()})


@pytest.mark.parametrize("path", shipped("wheel"))
@pytest.mark.parametrize("spin", ["climb", "against"])
def test_crosscheck_mujoco_wheel_scenarios(truecut, path, spin):
    """One pass of the compliant wheel: how the arm yields, normal force, friction, what is left of the strip."""
    report = check(truecut, f"wheel/{path.stem} {spin}", path, {"process.wheel.spin": spin})
    for name in ("wheel.normal_force", "wheel.friction_force", "wheel.indentation"):
        assert report["quantities"][name]["nrmse"] <= 0.01
    for name in ("wheel.removed_volume", "wheel.preston_volume"):
        volume = report["scalars"][name]
        assert volume["recording"] == pytest.approx(volume["reference"], rel=0.01)


def test_crosscheck_mujoco_program_agrees(truecut, tmp_path):
    """`truecut crosscheck` from scenario to verdict: exit 0, a table to read, NRMSE by channel in crosscheck.json."""
    path = load_scenario(tmp_path, "step", "rig_planar", SMOOTH["step_1_kn_across"], duration_s=0.3)
    out = tmp_path / "out"
    done = truecut.run(
        "crosscheck", path, "--out", out, "--set", "robot.damping_scale=3", TRUECUT_PYTHON=sys.executable
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "agrees with MuJoCo" in done.stdout
    assert "tool displacement, NRMSE" in done.stdout
    report = json.loads((out / "step" / "crosscheck.json").read_text(encoding="utf-8"))
    assert report["agrees"]
    assert report["channels"]["tool.displacement_y"] < 1e-3
    assert report["channels"]["joint2.position"] < 1e-3


def test_crosscheck_mujoco_reports_disagreement(truecut, tmp_path, capsys):
    """Another friction coefficient in the reference: exit 4 and the reason in words. The control of all the above."""
    path = CHAMFER / "planar_low.toml"
    mjcf, out = tmp_path / "model.xml", tmp_path / "crosscheck.json"
    mjcf.write_text(truecut.mjcf(path), encoding="utf-8")
    arguments = [str(path), "--mjcf", str(mjcf), "--recording", str(truecut.record(path)), "--out", str(out)]
    assert run.main([*arguments, "--set", "process.chamfer.foot.friction.mu=0.14"]) == run.DISAGREES
    assert "DISAGREES" in capsys.readouterr().out
    assert not json.loads(out.read_text(encoding="utf-8"))["agrees"]
