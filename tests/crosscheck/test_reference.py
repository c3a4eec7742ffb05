"""The reference itself against closed forms and the figures of `docs/physics/vibration.md`.

A second opinion is worth what it is checked by: each law below is held to a formula before it is used to judge truecut.
Nothing here needs the truecut program.
"""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pytest

from truecut_reference import compare, models, run
from truecut_reference import scenario as scenario_file
from truecut_reference.chamfer import ChamferProcess
from truecut_reference.foot import FootNormal
from truecut_reference.friction import coulomb_impulse
from truecut_reference.plant import Plant, modes_hz
from truecut_reference.simulate import simulate
from truecut_reference.wheel import Command, CommandedPath

IN_PLANE_N = 109.68  # M at 1 mm depth, 300 rpm, 0.05 mm/rev
PRELOAD_N = 2 * 0.3e6 * 0.25 * math.pi * 0.032**2


def chamfer(robot=None, **changes) -> scenario_file.Scenario:
    """The published forward chamfer with the given keys changed; `foot` and `cutting` are merged."""
    foot = {"pressure_mpa": 0.3, "seal_stiction_n": 0.0} | changes.pop("foot", {})
    body = {
        "direction": "forward",
        "spindle_rpm": 300,
        "feed_mm_per_rev": 0.05,
        "depth_mm": 1.0,
        "half_angle_deg": 45,
        "hole_diameter_mm": 42,
        "regeneration": "off",
        "foot": foot,
        "cutting": {"axial_mpa": 1960, "in_plane_mpa": 2140} | changes.pop("cutting", {}),
    } | changes
    if body["foot"] is None or changes.get("no_foot"):
        del body["foot"]
    body.pop("no_foot", None)
    return scenario_file.from_table({"robot": robot or {"urdf": "none"}, "process": {"chamfer": body}})


def rotating(friction_ratio: float, frequency_hz: float, duration_s: float) -> scenario_file.Scenario:
    """A rotating force of size M on the planar rig, with friction of `friction_ratio` M at constant normal force."""
    foot = {
        "pressure_mpa": 0.3,
        "axial_share": 0.0,
        "seal_stiction_n": 0.0,
        "friction": {"mu": friction_ratio * IN_PLANE_N / PRELOAD_N},
    }
    load = {"rotating": {"amplitude_n": IN_PLANE_N, "frequency_hz": frequency_hz}, "foot": foot}
    return scenario_file.from_table(
        {"robot": {"urdf": "none"}, "run": {"duration_s": duration_s}, "process": {"load": load}}
    )


def test_verify_friction_impulse_either_holds_or_opposes_sliding():
    """Complementarity: within the cone the end velocity is zero, on the cone it is opposite to the impulse."""
    rng = random.Random(1)
    slid = held = 0
    for _ in range(2000):
        a, b, c = (rng.gauss(0.0, 1.0) for _ in range(3))
        wyy, wyz, wzz = a * a + 0.01, a * b, b * b + c * c + 0.01
        vy, vz, limit = rng.gauss(0.0, 1.0), rng.gauss(0.0, 1.0), rng.expovariate(1.0)
        py, pz, slides = coulomb_impulse(vy, vz, wyy, wyz, wzz, limit)
        ey, ez = vy + wyy * py + wyz * pz, vz + wyz * py + wzz * pz
        if slides:
            slid += 1
            assert math.hypot(py, pz) == pytest.approx(limit, rel=1e-9)
            speed = math.hypot(ey, ez)
            assert py * ey + pz * ez == pytest.approx(-limit * speed, rel=1e-9, abs=1e-12)
        else:
            held += 1
            assert math.hypot(py, pz) <= limit * (1 + 1e-12)
            assert math.hypot(ey, ez) < 1e-9 * (1.0 + math.hypot(vy, vz))
    assert slid > 200 and held > 200


@pytest.mark.parametrize(
    ("ratio", "y_um", "z_um"), [(0.0, 207.38, 129.84), (0.5, 172.3, 110.7), (0.785, 115.3, 79.2), (0.9, 73.9, 56.5)]
)
def test_verify_steady_amplitudes_under_dry_friction(ratio, y_um, z_um):
    """Table of section 1, 300 rpm, k2 != k3, damping ratio 0.02; 0.5 % as the table has three or four digits."""
    result = simulate(rotating(ratio, 5.0, 10.0), models.planar_rig(), 1e-4)
    rows = result.state_time_s > 9.6
    for axis, expected in (("y", y_um), ("z", z_um)):
        x = result.channels[f"tool.displacement_{axis}"][rows]
        assert 0.5e6 * np.ptp(x) == pytest.approx(expected, rel=5e-3)


def test_verify_friction_of_the_force_itself_holds_the_foot():
    """mu N just above M: stuck for good. A smoothed law would creep by micrometres here."""
    result = simulate(rotating(1.001, 5.0, 4.0), models.planar_rig(), 1e-4)
    assert not result.channels["foot.sliding"].any()
    assert max(np.abs(result.channels[f"tool.displacement_{a}"]).max() for a in "yz") < 1e-12


@pytest.mark.parametrize(
    ("rpm", "foot", "expected_um"),
    [
        (300, False, (53, 104, 154, 205)),
        (300, True, (0, 0, 34, 142)),
        (400, False, (189, 481, 737, 964)),
        (400, True, (0, 0, 28, 288)),
    ],
)
def test_verify_ramp_radii_per_quarter(rpm, foot, expected_um):
    """Section 1: largest radius in each quarter of the ramp to D = 1 mm. The table is rounded to 1 um.

    The force's start angle matters at this level: the table is that of a tangential force alone (angle 0).
    """
    spec = chamfer(spindle_rpm=rpm, depth_mm=1.05, dwell_revolutions=0.0, foot={"axial_share": 0.0}, no_foot=not foot)
    result = simulate(spec, models.planar_rig(), 1e-4, until_s=1200.0 / rpm)
    radius_um = 1e6 * np.hypot(result.channels["tool.displacement_y"], result.channels["tool.displacement_z"])
    found = [float(q.max()) for q in np.array_split(radius_um, 4)]
    assert found == pytest.approx(expected_um, rel=5e-3, abs=0.6)


def test_verify_handwritten_arm_has_the_published_stiffness_and_modes():
    """IRB6600-cal and the test vector: stiffness within 0.02 %, modes within their digits, FK to ten digits."""
    posture = {"urdf": "none", "posture_deg": list(models.SOURCE_A_POSTURE_DEG)}
    plant = Plant(models.irb6600(inertia_scale=1.0), chamfer(robot=posture).robot)
    flange = plant.data.site("flange")
    assert flange.xpos == pytest.approx((1.3043301285, -1.2351738406, 0.4886557433), abs=1e-10)
    assert plant.axes[0] == pytest.approx((0.1571794943, 0.9875691603, -0.0013267225), abs=1e-10)
    compliance = plant.compliance("tool")
    assert 1.0 / np.diag(compliance) == pytest.approx((0.86476e6, 1.37290e6, 1.09067e6), rel=2e-4)
    assert 1.0 / np.linalg.eigvalsh(compliance[1:, 1:]) == pytest.approx((1.39384e6, 1.07780e6), rel=2e-4)
    assert modes_hz(plant.stiffness, plant.mass_matrix()) == pytest.approx(
        (6.042, 9.985, 19.056, 25.445, 39.275, 79.924), abs=6e-4
    )


def test_verify_chip_area_is_source_a_equation_1():
    """Held tool: A = (D + f/2) f tan(theta) in the ramp, nothing after one revolution of dwell; the rim is at depth."""
    for mode in ("off", "axial", "full"):
        spec = chamfer(regeneration=mode, half_angle_deg=30).process
        cut = ChamferProcess(spec, 1e-3)
        steps = round(spec.duration_s / cut.step_s)
        for i in range(steps):
            t = (i + 0.5) * cut.step_s
            force = cut.tool_force(t, (0.0, 0.0, 0.0), None)
            feed, _, area, _, torque = cut.row
            if t < spec.ramp_s:
                expected = (feed + 0.5 * spec.feed_m_per_rev) * spec.feed_m_per_rev * math.tan(spec.half_angle_rad)
                assert area == pytest.approx(expected, rel=1e-9)
                assert force[0] == pytest.approx(-1960e6 * expected, rel=1e-9)
                assert math.hypot(force[1], force[2]) == pytest.approx(2140e6 * expected, rel=1e-9)
                assert torque == pytest.approx(2140e6 * expected * 0.021, rel=1e-9)
        assert cut.row[2] == 0.0
        widths, _ = cut.findings()
        assert widths["chamfer.width_mean"] == pytest.approx(spec.depth_m * math.tan(spec.half_angle_rad), rel=1e-9)
        assert widths["chamfer.width_spread"] < 1e-12
        # cone of the tool's half angle less the hole, both cut off at the depth
        r, w, d = 0.021, spec.depth_m * math.tan(spec.half_angle_rad), spec.depth_m
        frustum = math.pi * d / 3.0 * (r * r + r * (r + w) + (r + w) ** 2)
        assert widths["chamfer.removed_volume"] == pytest.approx(frustum - math.pi * r * r * d, rel=1e-9)


def test_verify_two_equal_edges_cancel_in_the_plane():
    """Section 1: with two or more equispaced edges the rotating resultant vanishes, the axial force stays."""
    spec = chamfer(edges=2).process
    two = ChamferProcess(spec, 1e-3)
    for i in range(500):
        t = (i + 0.5) * two.step_s
        pair = two.tool_force(t, (0.0,) * 3, None)
        assert math.hypot(pair[1], pair[2]) < 1e-9 * abs(pair[0])
        tooth = 0.5 * spec.feed_m_per_rev
        assert pair[0] == pytest.approx(-2.0 * 1960e6 * (spec.feed_rate_m_per_s * t + 0.5 * tooth) * tooth, rel=1e-9)


def test_verify_regeneration_returns_the_wave_of_the_last_revolution():
    """An axial displacement that repeats each revolution leaves the chip unchanged after the first one.

    One of another frequency does not: the chip is the difference to what the last revolution left.
    """
    spec = chamfer(regeneration="axial").process
    steady, moving = ChamferProcess(spec, 1e-3), ChamferProcess(spec, 1e-3)
    held = ChamferProcess(spec, 1e-3)
    for i in range(600):
        t = (i + 0.5) * held.step_s
        wave = 1e-6 * math.sin(2.0 * math.pi * 5.0 * t)
        other = 1e-6 * math.sin(2.0 * math.pi * 7.5 * t)
        held.tool_force(t, (0.0, 0.0, 0.0), None)
        steady.tool_force(t, (wave, 0.0, 0.0), None)
        moving.tool_force(t, (other, 0.0, 0.0), None)
        if t > 0.2:
            # d(d^2) with both depths shifted by the wave: relative change wave / mean depth
            depth = held.row[0] + 0.5 * spec.feed_m_per_rev
            assert steady.row[2] == pytest.approx(held.row[2] * (1.0 + wave / depth), rel=1e-9)
            previous = 1e-6 * math.sin(2.0 * math.pi * 7.5 * (t - 0.2))
            new, old = held.row[0] + spec.feed_m_per_rev + other, held.row[0] + previous
            assert moving.row[2] == pytest.approx(0.5 * (new**2 - old**2), rel=1e-9)


def test_verify_foot_is_a_gas_spring_with_a_seal_that_breaks_away():
    """Section 1.3: Ø32, 50 mm, 0.3 MPa gives k_g = 1.8e4 N/m and a share of 0.02; the seal adds +-97 N."""
    spec = chamfer(foot={"seal_stiction_n": 97.0}).process.foot
    foot = FootNormal(spec, 0.8646e6)
    assert foot.gas_n_per_m == pytest.approx(1.4 * 2 * (0.3e6 + 101325) * spec.area_m2 / 0.05, rel=1e-12)
    assert foot.gas_n_per_m == pytest.approx(1.8e4, rel=5e-3) and foot.axial_share == pytest.approx(0.02, abs=1e-3)
    assert foot.advance_to(0.0) == pytest.approx(PRELOAD_N)
    assert foot.advance_to(1e-6) == pytest.approx(PRELOAD_N + 50.0 + foot.gas_n_per_m * 1e-6)
    assert foot.advance_to(1e-5) == pytest.approx(PRELOAD_N + 97.0 + foot.gas_n_per_m * 1e-5)
    assert foot.advance_to(9e-6) == pytest.approx(PRELOAD_N + 47.0 + foot.gas_n_per_m * 9e-6)
    assert foot.advance_to(-0.1) == 0.0, "lifted"


@pytest.mark.parametrize(("spin", "friction_sign"), [("climb", 1.0), ("against", -1.0)])
def test_verify_wheel_removes_prestons_depth_and_yields_to_friction(spin, friction_sign):
    """Steady pass over the planar rig: N = N0 without eccentricity, depth k_p v_s N / (w v_f), deflection mu N / k2.

    "climb" moves the rim against the travel over the plate, so friction pushes the wheel on.
    """
    feed, normal, radius, width, preston = 0.05, 30.0, 0.075, 0.025, 4e-11
    table = {
        "radius_mm": 75,
        "width_mm": 25,
        "speed_rpm": 1200,
        "spin": spin,
        "stiffness_n_per_mm": 40,
        "normal_force_n": normal,
        "mu": 0.4,
        "feed_mm_per_s": 50,
        "strip_length_mm": 100,
        "strip_cells": 200,
        "preston_per_pa": preston,
    }
    robot = {"urdf": "none", "gravity": False}
    spec = scenario_file.from_table({"robot": robot, "process": {"wheel": table}})
    time_s = np.linspace(0.0, spec.duration_s, 501)
    command = Command(time_s, np.outer(feed * time_s, [0.0, 1.0, 0.0]))
    result = simulate(spec, models.planar_rig(damping_ratio=0.5), 1e-4, command=command)
    late = result.state_time_s > 1.5
    assert result.channels["wheel.normal_force"][late] == pytest.approx(normal, rel=1e-3)
    assert result.channels["wheel.friction_force"][late] == pytest.approx(friction_sign * 0.4 * normal, rel=1e-3)
    lead = result.channels["tool.displacement_y"][late] - feed * result.state_time_s[late]
    assert lead == pytest.approx(friction_sign * 0.4 * normal / 1.078e6, rel=5e-3)
    sliding = 2.0 * math.pi * 20.0 * radius - friction_sign * feed
    middle = result.profiles["wheel.removed_depth"].values[80:120]
    assert middle == pytest.approx(preston * sliding * normal / (width * feed), rel=2e-3)


def test_verify_commanded_path_is_seen_from_the_flange():
    """A command that leaves its line by 10 um, and one that turns the tool, are told from a straight one."""
    plant = Plant(models.planar_rig(), chamfer(robot={"urdf": "none", "gravity": False}).robot)
    time_s = np.linspace(0.0, 2.0, 101)
    straight = CommandedPath(plant, Command(time_s, np.outer(time_s, [0.0, 0.05, 0.0])))
    assert np.abs(straight.places_m - np.outer(straight.time_s, [0.0, 0.05, 0.0])).max() < 1e-12
    assert straight.rotation_rad < 1e-12
    skew = CommandedPath(plant, Command(time_s, np.outer(time_s, [5e-6, 0.05, 0.0])))
    assert np.abs(skew.places_m[:, 0]).max() == pytest.approx(1e-5)
    posture = {"urdf": "none", "posture_deg": list(models.SOURCE_A_POSTURE_DEG)}
    arm = Plant(models.irb6600(), chamfer(robot=posture).robot)
    sixth = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    turned = CommandedPath(arm, Command(time_s, arm.command0 + np.outer(1e-3 * time_s, sixth)))
    assert turned.rotation_rad == pytest.approx(2e-3, rel=1e-3)


def test_verify_scheme_is_of_second_order():
    """Halving the step quarters the error on a swept force: a force held from the step's start would only halve it."""
    table = {
        "robot": {"urdf": "none"},
        "run": {"duration_s": 0.5},
        "process": {"load": {"sweep": {"amplitude_n": [0, 100, 50], "from_hz": 1, "to_hz": 60}}},
    }
    spec = scenario_file.from_table(table)
    runs = [simulate(spec, models.planar_rig(), h) for h in (4e-4, 2e-4, 1e-4)]
    ends = [np.array([r.channels[f"tool.displacement_{a}"][:: 2**i] for a in "yz"]) for i, r in enumerate(runs)]
    n = min(e.shape[1] for e in ends)
    first, second = (np.abs(a[:, :n] - b[:, :n]).max() for a, b in itertools.pairwise(ends))
    assert math.log2(first / second) > 1.8


def recorded(result, every: int = 20, **wrong) -> compare.Recording:
    """A recording as truecut would write it, from a reference run, with the given faults."""
    time_s = result.state_time_s[::every]
    channels = {n: np.interp(time_s, result.time_of(n), v) for n, v in result.channels.items()}
    channels["foot.sliding"] = (channels["foot.sliding"] > 0.5).astype(float)
    if "factor" in wrong:
        channels["tool.displacement_y"] = channels["tool.displacement_y"] * wrong["factor"]
    if "late_s" in wrong:
        channels["foot.sliding"] = np.interp(time_s - wrong["late_s"], time_s, channels["foot.sliding"])
    keep = time_s <= wrong.get("until_s", math.inf)
    channels = {n: v[keep] for n, v in channels.items()}
    return compare.Recording(time_s[keep], channels, dict(result.scalars), result.profiles)


@pytest.fixture(scope="module")
def sliding_run():
    """The published forward chamfer on the planar rig, coarse."""
    spec = chamfer()
    return spec, simulate(spec, models.planar_rig(), 1e-4)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({}, None),
        ({"factor": 1.1}, "tool displacement while sliding differs"),
        ({"late_s": 4e-3}, "stick and slip differ"),
        ({"until_s": 3.0}, "the recording ends after"),
    ],
)
def test_verify_comparison_accepts_the_truth_and_names_each_fault(sliding_run, wrong, reason):
    """The judge is judged: its own run passes; 10 % in one component, 4 ms of delay, a third missing do not."""
    spec, result = sliding_run
    report = run.crosscheck(spec, models.planar_rig(), recorded(result, **wrong), 1e-4)
    assert report["halving_the_step"]["counts"]
    if reason is None:
        assert report["agrees"], report["failures"]
    else:
        assert any(reason in line for line in report["failures"]), report["failures"]


def test_verify_short_events_join_their_surroundings():
    """1 ms of stick within a slip is not an event; 4 ms is."""
    t = np.arange(0.0, 0.1, 1e-4)
    slides = (t > 0.02).astype(float)
    slides[(t > 0.05) & (t < 0.051)] = 0.0
    assert [e[0] for e in compare.events(t, slides)] == ["stick", "slip"]
    slides[(t > 0.05) & (t < 0.054)] = 0.0
    assert [e[0] for e in compare.events(t, slides)] == ["stick", "slip", "stick", "slip"]
