"""A corner of a pocket in truecut and in MuJoCo, engagement and chips written a second time.

The tool comes out of a hole, cuts a slot and turns by a right angle in it; the arm swings and yields. Bounds: the tool's place off a
rigid arm's, and what the cut alone adds to it (the same run in air taken off on either side), 1 % of their range.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import scipy.interpolate

from conftest import FIGURES, ROOT, tomllib
from led_pass import nrmse
from truecut_reference import compare
from truecut_reference.led_run import LedRun
from truecut_reference.path_milling import Pocket, PocketRun
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot
from truecut_reference.wheel import Command, CommandedPath

SCENARIO = ROOT / "tests" / "crosscheck" / "path_corner.toml"
STEP_S = 62.5e-6
BOUND = 0.01
AIR = {"process.path_milling.cutting.tangential_mpa": 1e-9, "process.path_milling.cutting.radial_mpa": 1e-9}


class InAir(LedRun):
    """Nothing acts on the tool."""

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.zeros(3), np.zeros(3), np.zeros(3)


def plant_of(model: str, table: dict, command: Command) -> Plant:
    """The arm at the command's start."""
    robot = _robot(table["robot"], SCENARIO.parent)
    first = Plant(model, robot)
    return Plant(model, robot, first.rigid_posture(command.joints[0]))


def reference(model: str, table: dict, command: Command, h: float, cuts: bool) -> tuple[np.ndarray, np.ndarray]:
    """Times and places of the tool in MuJoCo."""
    plant = plant_of(model, table, command)
    pocket = Pocket.of(table["process"]["path_milling"])
    run = PocketRun(pocket, plant, command) if cuts else InAir(plant, command)
    times, places, _, _ = run.run(h, float(command.time_s[-1]))
    return times, places


def test_crosscheck_mujoco_a_pocket_corner_with_an_arm(truecut):
    """Within 1 %; the reference moves by less than a third of that at half its step."""
    table = tomllib.loads(SCENARIO.read_text(encoding="utf-8"))
    cut, air = (compare.Recording.read(truecut.record(SCENARIO, changes)) for changes in ({}, AIR))
    command, model = cut.command(), truecut.mjcf(SCENARIO)
    jobs = [(0.5 * STEP_S, True), (STEP_S, True), (STEP_S, False)]
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
        runs = list(pool.map(reference, *zip(*[(model, table, command, *job) for job in jobs])))
    rows = (cut.time_s > STEP_S) & (cut.time_s < cut.time_s[-1] - STEP_S)
    time_s = cut.time_s[rows]
    fine, coarse, still = (scipy.interpolate.CubicSpline(*run)(time_s) for run in runs)
    place, without = (np.array([one.channels[f"tool.position_{a}"][rows] for a in "xyz"]).T for one in (cut, air))
    plant = plant_of(model, table, command)
    rigid = CommandedPath(plant, command).displacement_m(time_s) @ plant.axes + plant.tool_position0
    for name, found, expected, rough in (
        ("deflection", place - rigid, fine - rigid, coarse - rigid),
        ("what the cut adds", place - without, fine - still, coarse - still),
    ):
        apart, halving = nrmse(found, expected), nrmse(rough, expected)
        sizes = np.ptp(expected, axis=0) * 1e6
        FIGURES.append(f"{f'corner of a pocket, {name}':40} {apart:8.4%} halving {halving:8.4%} of {np.linalg.norm(sizes):.1f} um")
        assert halving < BOUND / 3.0, (name, halving)
        assert apart < BOUND, (name, apart)
    # the slot pushes along and across its feed, one after the other in x and y: the corner was passed
    assert np.all(np.ptp(fine - still, axis=0)[:2] > 10e-6)
    assert cut.channels["path_milling.teeth_in_cut"].max() > 0
