"""Milling machines drawn at random: what is drawn keeps to what it says of itself."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import drawn_mills, experiment  # noqa: E402
from truecut_reference import scenario as scenario_file  # noqa: E402


def test_verify_sizes_of_what_is_drawn(tmp_path):
    """The scenario as the reference reads it: a mode of the tool is lighter than 15 % of what carries it and its cut does
    not chatter by the averaged chip; flanks damp by 0.15 to 0.8 of what the machine does."""
    drawn = 0
    for seed in range(900, 930):
        machine = drawn_mills._draw(np.random.default_rng([seed, 0]), f"drawn_mill_{seed}", tmp_path)
        if machine is None:
            continue
        drawn += 1
        scenario = scenario_file.load(machine.experiment.path, {})
        cut, robot = scenario.process, scenario.robot
        mass = drawn_mills.MASS_KG * robot.inertia_scale
        damping = drawn_mills.DAMPING_N_S_PER_M * robot.damping_scale
        mode = machine.of("tool_mode").values
        moved = 1.0 / (mode["compliance_m_per_n"] * (2.0 * math.pi * mode["frequency_hz"]) ** 2)
        assert moved < 0.1501 * mass
        chip = cut.tangential_pa * cut.axial_depth_m
        assert chip * mode["compliance_m_per_n"] < mode["damping_ratio"]
        slope = machine.of("milling_process_damping").values["per_slope_n_per_m"]
        damper = slope * cut.axial_depth_m / (0.5 * cut.diameter_m * cut.spindle_rad_per_s)
        assert 0.149 < damper / damping < 0.801
        assert math.isclose(cut.tooth_period_s, machine.experiment.tooth_period_s, rel_tol=1e-4)
        assert cut.length_m > cut.feed_m_per_s * machine.experiment.duration_s
        stiffness = robot.stiffness_scale * drawn_mills.STIFFNESS_N_PER_M
        own_hz = math.sqrt(stiffness / mass) / (2.0 * math.pi)
        assert 2.5 * own_hz < mode["frequency_hz"] * (1.0 + 1e-4)
    assert drawn > 5


def test_verify_tools_of_fast_machines(tmp_path):
    """As the literature has them, and with a cut that does not chatter by the averaged chip."""
    for seed in range(900, 930):
        machine = drawn_mills._draw_fast(np.random.default_rng([seed, 0]), f"drawn_mill_fast_{seed}", tmp_path)
        cut = scenario_file.load(machine.experiment.path, {}).process
        mode = machine.of("tool_mode").values
        assert 5e6 <= 1.0 / mode["compliance_m_per_n"] <= 40e6
        assert 400.0 <= mode["frequency_hz"] <= 3000.0 < 0.4 * machine.experiment.rate_hz
        assert 0.02 <= mode["damping_ratio"] <= 0.05
        chip = cut.tangential_pa * cut.axial_depth_m * mode["compliance_m_per_n"]
        assert 0.2999 < chip / mode["damping_ratio"] < 0.9001
        assert 0.01 <= cut.diameter_m <= 0.025
        assert cut.length_m > cut.feed_m_per_s * machine.experiment.duration_s


def test_each_draw_has_runs_of_its_own(tmp_path):
    """Attempts of one seed differ, and so do the files that their runs are kept by."""
    names = [f"drawn_mill_fast_1_{attempt}" for attempt in range(2)]
    draws = [drawn_mills._draw_fast(np.random.default_rng([1, i]), name, tmp_path) for i, name in enumerate(names)]
    first, second = (str(machine.experiment) + experiment._sources(machine.experiment.path) for machine in draws)
    assert first != second


def test_verify_samples_beside_jumps(tmp_path):
    """By the angle of each tooth at each sample; a line is bridged by itself, and the slide is left alone."""
    for seed in range(900, 915):
        machine = drawn_mills._draw_fast(np.random.default_rng([seed, 0]), f"drawn_mill_fast_{seed}", tmp_path)
        mill = machine.experiment
        cut = mill.table["process"]["milling"]
        speed, teeth = cut["spindle_rpm"] * 2.0 * math.pi / 60.0, cut["cutter"]["teeth"]
        wall_deg, reach = (0.0, 1.0) if cut["engagement"] == "up" else (180.0, -1.0)
        face = reach * (1.0 - 2.0 * cut["radial_depth_mm"] / cut["cutter"]["diameter_mm"])
        expected = np.zeros(mill.time_s.size, dtype=bool)
        for tooth in range(teeth):
            angle = math.radians(cut["start_angle_deg"]) + speed * mill.time_s - 2.0 * math.pi * tooth / teeth
            for jump in (math.radians(wall_deg), math.acos(face)):
                apart = np.abs(np.angle(np.exp(1j * (angle - jump))))
                expected |= apart < 1.5 / mill.rate_hz * speed
        assert (mill.beside_jumps() != expected).sum() <= 2  # by rounding of the speed in the file
        assert 0.0 < expected.mean() < 0.5
        line = np.outer(1.0 + 3.0 * mill.time_s, np.ones(3))
        inner = slice(4, -4)
        assert np.allclose(mill.seen(line)[inner], line[inner])
        noise = np.random.default_rng(seed).standard_normal(line.shape)
        assert np.array_equal(mill.seen(noise)[:, 2], noise[:, 2])
        kept = ~mill.beside_jumps()
        assert np.array_equal(mill.seen(noise)[kept], noise[kept])


def test_verify_the_reference_errs_less_than_sensors(tmp_path, monkeypatch):
    """A diagnosis of clean data must not find the step of the program that made them: what is left of it, by a run of twice
    the step, is below a tenth of what the quietest sensors err by."""
    monkeypatch.setattr(experiment, "CACHE", tmp_path / "cache")
    for draw, seed in ((drawn_mills._draw_fast, 930), (drawn_mills._draw, 932)):
        machine = draw(np.random.default_rng([seed, 0]), f"drawn_mill_{seed}", tmp_path)
        mill = machine.experiment
        fine, coarse = (replace(mill, step_s=k * mill.step_s).outputs_of() for k in (1.0, 2.0))
        noise = drawn_mills._with_noise(machine, fine, np.random.default_rng(seed)).experiment.reference_noise
        # of second order: twice the step errs by three times as much more
        left = np.sqrt(np.mean(((fine - coarse)[~mill.beside_jumps()] / 3.0) ** 2, axis=0))
        assert np.all(left < 0.1 * 0.5 * np.array(noise)), (left, noise)
