"""The same milling pass in truecut and in MuJoCo, the cut written a second time: teeth on true circles.

Bounds, while vibration is small beside the feed per tooth: deflection of the tool 1 % of its range, growth rate 3 %.
One pass grows and one does not, on a machine of one mode, whose teeth meet their own surface, and on the arm.
"""

from __future__ import annotations

import pytest

from conftest import FIGURES, ROOT
from truecut_reference import compare, run
from truecut_reference import scenario as scenario_file

MILLING = ROOT / "scenarios" / "milling"
RIG = """
name = "benchmark"
[robot]
urdf = "{robots}/rig_milling/robot.urdf"
gravity = false
[process.milling]
spindle_rpm = 5000
feed_mm_per_tooth = 0.02
axial_depth_mm = {depth_mm}
engagement = "down"
radial_depth_mm = 10
start_angle_deg = 1
ramp_mm = 0.4
[process.milling.cutter]
diameter_mm = 20
teeth = 2
[process.milling.cutting]
tangential_mpa = 600
radial_mpa = 200
edge_radial_n_per_mm = 1
[process.milling.path]
direction = [1, 0, 0]
length_mm = 1.0
"""


def check(truecut, name: str, path, changes=None) -> tuple[float, float]:
    """Cross-checks one scenario; growth rates of recording and reference, 1/s."""
    recording = compare.Recording.read(truecut.record(path, changes))
    report = run.crosscheck(scenario_file.load(path, changes), truecut.mjcf(path, changes), recording)
    rates = report["growth_rate"]
    nrmse = report["quantities"][report["judged"]]["nrmse"]
    FIGURES.append(
        f"{name:40} {nrmse:8.4%} halving {report['halving_the_step']['nrmse']:8.4%}"
        f" growth {rates['recording']:.3f} /s, MuJoCo {rates['reference']:.3f} /s"
    )
    assert report["agrees"], report["failures"]
    return rates["recording"], rates["reference"]


@pytest.mark.parametrize(("kind", "depth_mm"), [("stable", 0.6), ("unstable", 1.1)])
def test_crosscheck_mujoco_milling_rig(truecut, tmp_path, kind, depth_mm):
    """One mode at 922 Hz, limit 0.852 mm: every tooth meets what the teeth before it left."""
    path = tmp_path / f"rig_{kind}.toml"
    path.write_text(RIG.format(robots=ROOT / "assets" / "robots", depth_mm=depth_mm), encoding="utf-8")
    # At the default step truecut's mode is out of tune by 5e-4, a twentieth of a turn in a hundred: too much where
    # vibration is all there is.
    here, there = check(truecut, f"milling rig, {kind}", path, {"run.time_step_ms": 0.006})
    assert (here > 0.0) == (kind == "unstable")
    assert here == pytest.approx(there, rel=0.03)


def test_crosscheck_mujoco_milling_arm_own_surface(truecut):
    """The arm enters a slot and goes on without chatter."""
    check(truecut, "milling arm, own surface", MILLING / "own_surface.toml", {"run.duration_s": 1.0})


def test_crosscheck_mujoco_milling_arm_nominal_surface(truecut):
    """Teeth meet a surface without waves: the arm, at rest under the mean force, begins to flutter.

    Vibration is still small where the run ends.
    """
    changes = {"run.duration_s": 0.9, "process.milling.axial_depth_mm": 0.2}
    here, there = check(truecut, "milling arm, nominal surface", MILLING / "nominal_surface.toml", changes)
    assert here > 0.0
    assert here == pytest.approx(there, rel=0.03)
