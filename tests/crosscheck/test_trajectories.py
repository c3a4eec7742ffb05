"""The same scenario in truecut and in MuJoCo with the reference's laws: smooth forces first, then contact and cutting.

Bounds: tool displacement NRMSE 0.1 % under time-known forces, 1 % in chamfering and wheel passes, over the whole run and while
sliding; stick and slip (3 ms or longer) at the same times within 2 ms; after regenerative vibration has left the cut the
RMS within 3 %. The reference itself must move by less than a third of the bound when its step is halved.
"""

from __future__ import annotations

import pytest
from conftest import ROBOTS, scenarios
from truecut_reference import compare, models, run, scenario as scenario_file

SMOOTH = {
    "free_decay": "release_n = [500.0, 300.0, -400.0]",
    "static_load": "constant_n = [200.0, -100.0, 150.0]",
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
[run]
duration_s = 3.0
[process.load]
{load}
"""


def check(truecut, path) -> dict:
    """Report of the cross-check of one scenario file."""
    recording = compare.Recording.read(truecut.record(path))
    report = run.crosscheck(scenario_file.load(path), truecut.mjcf(path), recording)
    tool = report["quantities"]["tool.displacement"]
    print(f"{path.name}: NRMSE {tool['nrmse']:.5%}, {report['wall_s']['half_step']:.1f} s at {report['step_s'] * 1e6:.1f} us")
    return report


@pytest.mark.parametrize("robot", ["irb6600_175_255", "rig_planar"])
@pytest.mark.parametrize("name", SMOOTH)
def test_crosscheck_mujoco_smooth_forces(truecut, tmp_path, name, robot):
    """Time-known forces, 0.1 %: they separate the plant from the process laws."""
    posture = list(models.SOURCE_A_POSTURE_DEG) if robot.startswith("irb") else []
    path = tmp_path / f"{name}.toml"
    urdf = ROBOTS / robot / "robot.urdf"
    path.write_text(SCENARIO.format(name=name, urdf=urdf, posture=posture, load=SMOOTH[name]), encoding="utf-8")
    report = check(truecut, path)
    assert report["tolerance"] == 1e-3
    assert report["agrees"], report["failures"]


def shipped(folder: str) -> list:
    """The shipped scenarios of one folder. An empty folder fails at collection instead of testing nothing."""
    found = scenarios(folder)
    assert found, f"scenarios/{folder} holds no single run"
    return [pytest.param(path, id=path.stem) for path in found]


@pytest.mark.parametrize("path", shipped("arm"))
def test_crosscheck_mujoco_arm_scenarios(truecut, path):
    """Free decay, static load and frequency sweep as shipped."""
    report = check(truecut, path)
    assert report["agrees"], report["failures"]


@pytest.mark.parametrize("path", shipped("chamfer"))
def test_crosscheck_mujoco_chamfer_scenarios(truecut, path):
    """Every chamfering scenario: displacement, stick and slip, what is left of the rim."""
    report = check(truecut, path)
    assert report["agrees"], report["failures"]
    width = report["scalars"]["chamfer.width_mean"]
    if report["left_cut_s"]["reference"] is None:
        assert width["recording"] == pytest.approx(width["reference"], rel=0.01)


@pytest.mark.parametrize("path", shipped("wheel"))
def test_crosscheck_mujoco_wheel_scenarios(truecut, path):
    """One pass of the compliant wheel: displacement, normal force, removed volume."""
    report = check(truecut, path)
    assert report["agrees"], report["failures"]
    for name in ("wheel.normal_force", "wheel.friction_force"):
        assert report["quantities"][name]["nrmse"] <= 0.01
    volume = report["scalars"]["wheel.removed_volume"]
    assert volume["recording"] == pytest.approx(volume["reference"], rel=0.01)


def test_crosscheck_mujoco_command_line_reports_disagreement(truecut, tmp_path):
    """Exit 0 for a true recording; exit 4 and a reason when the reference is given another friction coefficient."""
    path = scenarios("chamfer")[0]
    mjcf, out = tmp_path / "model.xml", tmp_path / "crosscheck.json"
    mjcf.write_text(truecut.mjcf(path), encoding="utf-8")
    arguments = [str(path), "--mjcf", str(mjcf), "--recording", str(truecut.record(path)), "--out", str(out)]
    assert run.main(arguments) == 0
    assert run.main([*arguments, "--set", "process.chamfer.foot.friction.mu=0.05"]) == run.DISAGREES
    assert out.exists()
