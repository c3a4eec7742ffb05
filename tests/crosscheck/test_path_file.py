"""Scenarios that a G-code file leads: the tool of the commanded arm in MuJoCo beside the file's path, computed anew.

The path is that of an interpreter written apart (tests/reference/cam_paths.py), run through exactly at its feeds, with the ramps
and the filter that `docs/cam_files.md` states; files are drawn from seeds.
"""

from __future__ import annotations

import math
import random
import sys

import mujoco
import numpy as np
import pytest

from conftest import FIGURES, ROBOTS, ROOT, tomllib
from truecut_reference import compare
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot

sys.path.insert(0, str(ROOT / "tests" / "reference"))
import cam_paths

WORK_M = np.array([0.9, -0.04, 0.4])
RAPID_MM_S = 250.0
RAMP_S = 0.3
WINDOW_S = 0.1
# chords of 0.1 um are shorter than their arcs by some 3e-6 of them, which a rapid line afterwards shows ten times as large
BOUND_MM = 0.02


def drawn(seed: int) -> str:
    """Lines, arcs and helices in three planes at feeds of 20 to 60 mm/s, in a box of some 60 mm."""
    draw = random.Random(7000 + seed)
    place = np.array([0.0, 0.0, 20.0])
    lines = ["G21 G90 G94 G17", "G0 X0 Y0 Z20", f"G1 X0 Y0 Z10 F{draw.randint(1200, 3600)}"]
    place[2] = 10.0
    for _ in range(7):
        kind = draw.choice(["line", "line", "rapid", "arc", "helix"])
        feed = f" F{draw.randint(1200, 3600)}"
        if kind in ("line", "rapid"):
            place = np.round([draw.uniform(0, 60), draw.uniform(0, 60), draw.uniform(0, 20)], 3)
            lines.append(("G0" if kind == "rapid" else "G1") + " X{:.3f} Y{:.3f} Z{:.3f}".format(*place) + feed)
            continue
        plane, (u, v, w) = draw.choice([(17, (0, 1, 2)), (18, (2, 0, 1)), (19, (1, 2, 0))])
        spoke = np.round([draw.uniform(5, 15), draw.uniform(5, 15)], 3)
        angle = draw.uniform(0.5, 5.5)
        radius, begin = math.hypot(*spoke), math.atan2(-spoke[1], -spoke[0])
        end = place.copy()
        end[u] += spoke[0] + radius * math.cos(begin + angle)
        end[v] += spoke[1] + radius * math.sin(begin + angle)
        if kind == "helix":
            end[w] += draw.uniform(-4, 4)
        place = np.round(end, 3)
        offsets = f" {'IJK'[u]}{spoke[0]:.3f} {'IJK'[v]}{spoke[1]:.3f}"
        lines.append(f"G{plane} G{draw.choice([2, 3])} X{place[0]:.3f} Y{place[1]:.3f} Z{place[2]:.3f}{offsets}{feed}")
    return "\n".join([*lines, "M30"]) + "\n"


def expected_mm(pieces: list[cam_paths.Piece], time_s: np.ndarray) -> np.ndarray:
    """Where the tool is at these times: pieces at their feeds, from rest to rest, then Hann's mean over the window."""
    lengths = [np.linalg.norm(np.diff([p.place(s) for s in np.linspace(0, 1, 4001)], axis=0), axis=1).sum() for p in pieces]
    takes = [one / (RAPID_MM_S if p.feed is None else p.feed / 60) for one, p in zip(lengths, pieces)]
    ends = np.cumsum(takes)
    own_s = ends[-1]
    ramp = min(RAMP_S, own_s)

    def led_in(t: float) -> float:
        x = min(max(t / ramp, 0.0), 1.0)
        return ramp * (x**3 - 0.5 * x**4) + max(t - ramp, 0.0)

    def at(t: float) -> np.ndarray:
        left = own_s + ramp - t
        own = min(max(led_in(t) if t < left else own_s - led_in(left), 0.0), own_s)
        k = min(int(np.searchsorted(ends, own)), len(pieces) - 1)
        return pieces[k].place((own - (ends[k] - takes[k])) / takes[k])

    share = (np.arange(40) + 0.5) / 40
    weights = (1 - np.cos(2 * math.pi * share)) / 40

    def mean(t: float) -> np.ndarray:
        # half a window is spent at rest before the start
        return sum(w * at(t - 0.5 * WINDOW_S + (s - 0.5) * WINDOW_S) for s, w in zip(share, weights))

    return np.array([mean(t) for t in time_s])


@pytest.mark.parametrize("seed", range(5))
def test_crosscheck_mujoco_a_drawn_file_leads_the_tool(truecut, tmp_path, seed):
    """The commanded arm's tool in MuJoCo within 0.02 mm of the file's path at every row, from its first point to its last."""
    text = drawn(seed)
    (tmp_path / "drawn.nc").write_text(text, encoding="utf-8")
    scenario = tmp_path / f"drawn_{seed}.toml"
    scenario.write_text(
        f"""name = "drawn"
[robot]
urdf = "{ROBOTS / "hp20" / "robot.urdf"}"
gravity = false
[run]
record_interval_ms = 10
time_step_ms = 0.5
[process.load.path]
file = "drawn.nc"
work_xyz_mm = {[round(1e3 * float(x), 3) for x in WORK_M]}
chord_mm = 0.0001
""",
        encoding="utf-8",
    )
    recording = compare.Recording.read(truecut.record(scenario))
    plant = Plant(truecut.mjcf(scenario), _robot(tomllib.loads(scenario.read_text(encoding="utf-8"))["robot"], tmp_path))
    command = recording.command()
    places = []
    for joints in command.joints:
        plant.data.qpos[:] = joints
        mujoco.mj_kinematics(plant.model, plant.data)
        places.append(1e3 * (plant.data.site("tool").xpos - WORK_M))
    pieces = cam_paths.gcode(text)
    first, pieces = pieces[0], pieces[1:]
    pieces = [one for one in pieces if np.linalg.norm(one.place(0.5) - one.start) > 1e-9]
    assert np.linalg.norm(places[0] - first.end) < 1e-3
    assert np.linalg.norm(places[-1] - pieces[-1].end) < 1e-3
    apart = np.linalg.norm(np.array(places) - expected_mm(pieces, command.time_s), axis=1).max()
    FIGURES.append(f"{f'led by a drawn file, {seed}':40} {apart:8.4f} mm off")
    assert apart < BOUND_MM, apart
