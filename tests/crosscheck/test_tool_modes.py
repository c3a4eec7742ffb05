"""The arm with modes of its tool in truecut and in MuJoCo, where they are bodies on springs that the last link carries.

The masses of the bodies are taken from the last link at its tool point, so that the arm weighs what it weighed. The
bodies slide one on the other, the heavier mode first: with directions square to each other that is the system of
docs/physics/tool_modes.md. Bounds: motion of the tip 0.1 % of its range where forces are given by the nominal surface,
growth rates 2 %.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.interpolate

from conftest import FIGURES, ROOT
from truecut_reference import compare
from truecut_reference import scenario as scenario_file
from truecut_reference.milling import MillingProcess, _cut_axes, growth_rate
from truecut_reference.plant import Plant
from truecut_reference.simulate import simulate
from truecut_reference.tool_modes import with_modes
from truecut_reference.wheel import Command

SCENARIO = ROOT / "scenarios" / "milling" / "end_mill_12.toml"
TIP = ("milling.deflection_x", "milling.deflection_y", "milling.deflection_z")
# Tooth periods over which a level of vibration is taken.
WINDOW = 4.0


def written(folder, lines: dict[str, str]):
    """The scenario in a folder with some of its lines in other words; without gravity, so that nothing sags."""
    text = SCENARIO.read_text(encoding="utf-8").replace("../../assets", str(ROOT / "assets"))
    for old, new in ({"[run]": "gravity = false\n\n[run]"} | lines).items():
        assert text.count(f"\n{old}\n") == 1, old
        text = text.replace(f"\n{old}\n", f"\n{new}\n")
    path = folder / SCENARIO.name
    path.write_text(text, encoding="utf-8")
    return path


def modes_of(path) -> list[dict]:
    """Modes of the tool in SI, the heaviest first."""
    modes = []
    document = scenario_file.tomllib.loads(path.read_text(encoding="utf-8"))
    tool = document["tool"] if "tool" in document else document["process"]["milling"]["cutter"]
    for table in tool["mode"]:
        omega, stiffness = 2.0 * math.pi * table["frequency_hz"], table["stiffness_n_per_um"] * 1e6
        direction = np.array(table["direction"], dtype=float)
        modes.append(
            {
                "stiffness": stiffness,
                "mass": stiffness / omega**2,
                "damping": 2.0 * table["damping_ratio"] * stiffness / omega,
                "direction": direction / np.linalg.norm(direction),
            }
        )
    return sorted(modes, key=lambda mode: -mode["mass"])


class Both:
    """One scenario in truecut and, at a step and at half of it, in MuJoCo; tips in the milling frame, m."""

    def __init__(self, truecut, path) -> None:
        recording = compare.Recording.read(truecut.record(path))
        scenario = scenario_file.load(path)
        modes = modes_of(path)
        model = with_modes(truecut.mjcf(path), modes)
        joints = recording.command().joints
        command = Command(recording.time_s, np.hstack([joints, np.zeros((len(joints), len(modes)))]))
        self.spec = scenario.process
        self.time_s = recording.time_s
        self.here = np.array([recording.channels[name] for name in TIP]).T
        fine, coarse = (simulate(scenario, model, step_s, self.time_s[-1], command) for step_s in (50e-6, 100e-6))
        self.fine, self.coarse = (self._tip(result, scenario, model, command) for result in (fine, coarse))
        # Of the modes alone: they have no part in the slow motion of the arm.
        own = [recording.channels[f"milling.tool_mode{n}_deflection"] for n in range(1, len(modes) + 1)]
        first = joints.shape[1] + 1
        other = [fine.channels[f"joint{n}.position"] for n in range(first, first + len(modes))]
        self.modes_here = np.array(own).T
        self.modes_there = scipy.interpolate.CubicSpline(fine.state_time_s, np.array(other).T)(
            np.minimum(self.time_s, fine.state_time_s[-1])
        )

    def _tip(self, result, scenario, model, command) -> np.ndarray:
        """Deflection from the path at the recording's times; the first one is that of the arm at rest."""
        plant = Plant(model, scenario.robot)
        plant = Plant(model, scenario.robot, plant.rigid_posture(command.joints[0]))
        process = MillingProcess(self.spec, 100e-6, plant, command)
        plant.settle(*process.start_loads(), process.moment)
        process.settled()
        to_cut = _cut_axes(plant, self.spec) @ plant.axes.T
        moved = np.array([result.channels[f"tool.displacement_{axis}"] for axis in "xyz"]).T @ to_cut.T
        moved[:, 0] -= self.spec.feed_m_per_s * result.state_time_s
        spline = scipy.interpolate.CubicSpline(result.state_time_s, process.offset + moved)
        return spline(np.minimum(self.time_s, result.state_time_s[-1]))

    def apart(self, a: np.ndarray, b: np.ndarray) -> float:
        """NRMSE of two tips."""
        return float(np.sqrt(np.mean(np.sum((a - b) ** 2, axis=1))) / np.linalg.norm(np.ptp(b, axis=0)))

    def growth(self, modes: np.ndarray) -> float:
        """Growth rate of the modes' vibration once the cut has settled, 1/s."""
        rows = self.time_s >= self.spec.settled_s
        tooth_s, linear_m = self.spec.tooth_period_s, 0.05 * self.spec.feed_per_tooth_m
        return growth_rate(self.time_s[rows], modes[rows], tooth_s, WINDOW * tooth_s, linear_m)


def test_crosscheck_mujoco_tool_modes_forced(truecut, tmp_path):
    """Teeth that meet a nominal surface force the tip at 400 Hz and its harmonics, near the modes at 1000 and 1040 Hz."""
    lines = {
        "duration_s = 0.5": "duration_s = 0.12\ntime_step_ms = 0.0125",
        "axial_depth_mm = 0.5": "axial_depth_mm = 0.2\nregeneration = false",
        "ramp_mm = 2": "",
    }
    both = Both(truecut, written(tmp_path, lines))
    apart, halving = both.apart(both.here, both.fine), both.apart(both.coarse, both.fine)
    FIGURES.append(f"{'tool modes, forced':40} {apart:8.4%} halving {halving:8.4%}")
    assert halving < 1e-3 / 3.0
    assert apart < 1e-3


@pytest.mark.parametrize(("kind", "depth_mm"), [("stable", 1.1), ("unstable", 1.5)])
def test_crosscheck_mujoco_tool_modes_growth(truecut, tmp_path, kind, depth_mm):
    """Teeth that meet their own surface: below and above the limit of 1.21 mm."""
    lines = {
        "duration_s = 0.5": "duration_s = 0.2\ntime_step_ms = 0.0125",
        "axial_depth_mm = 0.5": f"axial_depth_mm = {depth_mm}",
        "ramp_mm = 2": "ramp_mm = 0.2",
    }
    both = Both(truecut, written(tmp_path, lines))
    here, there = both.growth(both.modes_here), both.growth(both.modes_there)
    FIGURES.append(
        f"{'tool modes, ' + kind:40} {both.apart(both.here, both.fine):8.4%}"
        f" growth {here:.3f} /s, MuJoCo {there:.3f} /s"
    )
    assert (here > 0.0) == (kind == "unstable")
    assert here == pytest.approx(there, rel=0.02)


CHAMFER = f"""
name = "chamfering with a tool that bends"
[robot]
urdf = "{ROOT}/assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
gravity = false
[run]
time_step_ms = 0.025
[process.chamfer]
direction = "forward"
spindle_rpm = 600
feed_mm_per_rev = 0.05
depth_mm = 0.5
half_angle_deg = 45
hole_diameter_mm = 42
edges = 3
dwell_revolutions = 1
[process.chamfer.cutting]
axial_mpa = 1960
in_plane_mpa = 2140
in_plane_angle_deg = 20
[[tool.mode]]
frequency_hz = 569
damping_ratio = 0.03
stiffness_n_per_um = 20
direction = [0.6, 0.0, 0.8]
[[tool.mode]]
frequency_hz = 1012
damping_ratio = 0.02
stiffness_n_per_um = 40
direction = [0.8, 0.0, -0.6]
"""


def test_crosscheck_mujoco_a_chamfering_tool_bends(truecut, tmp_path):
    """Three edges on a tool with two modes across its axis and along it: tip and modes."""
    path = tmp_path / "chamfer_bends.toml"
    path.write_text(CHAMFER, encoding="utf-8")
    recording = compare.Recording.read(truecut.record(path))
    scenario, modes = scenario_file.load(path), modes_of(path)
    model = with_modes(truecut.mjcf(path), modes)
    fine, coarse = (simulate(scenario, model, step_s, recording.time_s[-1]) for step_s in (50e-6, 100e-6))
    plant = Plant(model, scenario.robot)
    # Rows of `axes` are the process's, columns of the rotation the tool's.
    directions = [plant.axes @ plant.tool_rotation0 @ mode["direction"] for mode in modes]
    own = [recording.channels[f"chamfer.tool_mode{n}_deflection"] for n in (1, 2)]
    here = np.array([recording.channels[f"tool.displacement_{axis}"] for axis in "xyz"]).T
    here = here + sum(np.outer(deflection, direction) for deflection, direction in zip(own, directions))
    until = min(recording.time_s[-1], fine.state_time_s[-1], coarse.state_time_s[-1])
    rows = recording.time_s <= until

    def at_rows(result, names) -> np.ndarray:
        spline = scipy.interpolate.CubicSpline(result.state_time_s, np.array([result.channels[n] for n in names]).T)
        return spline(recording.time_s[rows])

    def apart(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.sqrt(np.mean(np.sum((a - b) ** 2, axis=1))) / np.linalg.norm(np.ptp(b, axis=0)))

    tip = [f"tool.displacement_{axis}" for axis in "xyz"]
    there, halving = at_rows(fine, tip), apart(at_rows(coarse, tip), at_rows(fine, tip))
    slides = at_rows(fine, ["joint7.position", "joint8.position"])
    of_modes = apart(np.array(own).T[rows], slides)
    FIGURES.append(f"{'a chamfering tool that bends, tip':40} {apart(here[rows], there):8.4%} halving {halving:8.4%}")
    FIGURES.append(f"{'a chamfering tool that bends, modes':40} {of_modes:8.4%}")
    assert halving < 1e-3 / 3.0
    assert apart(here[rows], there) < 1e-3
    assert of_modes < 1e-3
    # The modes have a part that the bound would not miss.
    assert np.ptp(slides, axis=0).max() > 0.01 * np.linalg.norm(np.ptp(there, axis=0))
