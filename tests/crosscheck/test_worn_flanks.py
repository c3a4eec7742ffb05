"""Process damping by worn flanks: growth rates of runs against MuJoCo with the wear land's own geometry.

The reference knows no damper: a land of the given width stands where its edge is, and what it overlaps of the surface
that the edge has left pushes it off. The mode has 300 kg at 7 Hz, damped by 2 %; four teeth on 16 mm cut a slot in 45
steel along the mode (K_t 2 GPa, K_r 0.6 GPa), 0.1 mm a tooth. Bound: 1.5 % of the rate.
"""

from __future__ import annotations

import pytest

from conftest import ROOT
from test_milling import check

SCENARIO = """
name = "worn flanks"
[robot]
urdf = "{robots}/rig_milling/robot.urdf"
gravity = false
inertia_scale = 7513.148
stiffness_scale = 0.433079
damping_scale = 103.72
[process.milling]
spindle_rpm = {rpm}
feed_mm_per_tooth = 0.1
axial_depth_mm = {depth_mm}
engagement = "slot"
start_angle_deg = 1
[process.milling.cutter]
diameter_mm = 16
teeth = 4
wear_land_mm = 0.1
[process.milling.cutting]
tangential_mpa = 2000
radial_mpa = 600
indentation_n_per_mm3 = 1.5e5
flank_friction = 0.3
[process.milling.path]
direction = [1, 0, 0]
length_mm = {length_mm}
"""
CASES = [(300, 0.06), (600, 0.2), (2400, 0.6)]


@pytest.mark.parametrize(("rpm", "depth_mm"), CASES)
def test_crosscheck_mujoco_worn_flanks(truecut, tmp_path, rpm, depth_mm):
    """The land takes 0.16, 0.27 and 0.19 1/s off; sharp edges have -1.95, -5.33 and -4.62 1/s."""
    path = tmp_path / f"worn_{rpm}.toml"
    length_mm = 4.0 * rpm / 60.0 * 4 * 0.1
    robots = ROOT / "assets" / "robots"
    text = SCENARIO.format(robots=robots, rpm=rpm, depth_mm=depth_mm, length_mm=length_mm)
    path.write_text(text, encoding="utf-8")
    here, there = check(truecut, f"worn flanks, {rpm} rpm", path)
    assert here == pytest.approx(there, rel=0.015)
