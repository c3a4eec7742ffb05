"""The generator against closed forms and itself, the judge against made-up answers, and the bench's fast part."""

from __future__ import annotations

import dataclasses
import math
import os
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import example  # noqa: E402
from bench import ROOT, dataset, report, runner  # noqa: E402
from bench.cases import SEEDS, all_cases, fast_cases  # noqa: E402
from bench.effects import KINDS, Effect  # noqa: E402
from bench.experiment import ALL, AXIS, CHAMFER, TWO_JOINT  # noqa: E402
from bench.library import (  # noqa: E402
    ANGLE,
    BELT,
    BRUSH,
    CLOCK,
    INSEPARABLE,
    MILLING,
    PAIRS,
    POLISHING,
    POLISHING_EDGE,
    SINGLES,
    STRANGERS,
    TILT,
    TORQUE,
)
from bench.noise import COLOURS, in_band, rms, unit_noise  # noqa: E402
from bench.score import SAME_TRACE_DEG, Answer  # noqa: E402
from bench.score import score as score_of  # noqa: E402
from bench.signature import angle_deg, change_of, left_after_refit, scaled, size_of  # noqa: E402
from truecut_reference import scenario as scenario_file  # noqa: E402
from truecut_reference import urdf_model  # noqa: E402
from truecut_reference.simulate import simulate  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
TEMPLATES = SINGLES + POLISHING + BELT + BRUSH + POLISHING_EDGE + MILLING + CLOCK + TILT
EACH_TEMPLATE = pytest.mark.parametrize("template", TEMPLATES, ids=lambda t: f"{t.experiment}-{t.kind}-{t.target}")


def test_verify_every_kind_is_hidden_somewhere():
    """Each kind of the library has a template, and three things outside it have one. Zeros of joints are hidden on
    the drawn arms (`tests/random_bench`) alone, links, rotors and clocks that run fast on those of the cross-check."""
    elsewhere = {"joint_zero", "link_mass", "link_center", "link_length", "joint_rotor", "clock_rate"}
    assert {t.kind for t in TEMPLATES} == set(KINDS) - elsewhere
    assert len({t.kind for t in STRANGERS}) >= 3


@EACH_TEMPLATE
def test_verify_off_switch_of_the_generator(template):
    """At its neutral size an effect leaves every bit as it is."""
    experiment = ALL[template.experiment]
    neutral = template.at(1.0).neutral()
    assert np.array_equal(experiment.outputs_of((neutral,)), experiment.outputs_of())


@EACH_TEMPLATE
def test_verify_every_effect_shows(template):
    """Beyond what nominal parameters explain, an effect of size 1 stands out of an ordinary sensor's noise."""
    assert size_of(ALL[template.experiment], (template.at(1.0),)) > 2.0


STEPS_OF = ("axis", "two_joint", "chamfer", "teeth", "wheel", "polish", "polish_force", "belt", "belt_force", "brush", "mill")


@pytest.mark.parametrize("name", STEPS_OF)
def test_verify_step_of_the_generator(name):
    """Half the step moves the outputs by less than a fifth of the reference noise, or 5 % of what is hidden."""
    coarse = ALL[name]
    fine = dataclasses.replace(coarse, step_s=0.5 * coarse.step_s)
    hidden = {"axis": "joint_coulomb", "two_joint": "joint_backlash"}.get(name)
    effects = tuple(t.at(1.0) for t in SINGLES if (t.experiment, t.kind) == (name, hidden))
    moved = rms(fine.outputs_of(effects) - coarse.outputs_of(effects)) / np.array(coarse.reference_noise)
    change = rms(change_of(coarse, effects)) / np.array(coarse.reference_noise)
    assert np.all(moved < np.maximum(0.2, 0.05 * change))


def test_verify_dry_friction_holds_a_joint():
    """Friction above all torques keeps the link at rest: what is left of the motion is the spring's wind-up."""
    held = AXIS.outputs_of((Effect("joint_coulomb", 1, {"friction_n_m": 5e4}),))
    assert np.ptp(held[:, 0]) < 1e-9
    command = AXIS.command()[:, 0]
    inner = slice(100, -100)
    # K theta + D theta', the latter by central differences
    torque = 45e3 * command + 60.0 * np.gradient(command, 1.0 / AXIS.rate_hz)
    assert rms((held[:, 1] - torque)[inner]) < 1e-3 * rms(torque[inner])


def test_verify_offset_and_friction_in_the_torque():
    """Newton on the link: what the transmission gives is inertia plus what friction and offset take."""
    for effect, expected, divisor in (
        (Effect("joint_offset", 1, {"force_n_m": 15.0}), -15.0, np.ones_like),
        (Effect("joint_viscous", 1, {"viscous_n_m_s_per_rad": 8.0}), 8.0, np.array),
        (Effect("joint_coulomb", 1, {"friction_n_m": 8.0}), 8.0, np.sign),
        (Effect("joint_load_friction", 1, {"share": 0.1}), 0.1, None),
    ):
        found = AXIS.outputs_of((effect,))
        velocity = np.gradient(found[:, 0], 1.0 / AXIS.rate_hz)
        taken = found[:, 1] - 8.0 * np.gradient(velocity, 1.0 / AXIS.rate_hz)
        rows = np.abs(velocity) > 0.5
        by = np.sign(velocity) * np.abs(found[:, 1]) if divisor is None else divisor(velocity)
        # where the load goes through zero its share is rounding
        rows &= np.abs(by) > 0.1 * np.max(np.abs(by))
        assert np.median(taken[rows] / by[rows]) == pytest.approx(expected, rel=0.01), effect.kind


def test_verify_payload_weighs():
    """At rest the torque of the first joint rises by m g times the payload's lever, less what the arm sinks by."""
    payload = Effect("payload", None, {"mass_kg": 1.5, "center_x_m": 0.0, "center_y_m": 0.0, "center_z_m": 0.1})
    first, second = TWO_JOINT.command()[0]
    # turning about +y lowers the arm; the flange points along the second link
    lever = 0.7 * math.cos(first) + 0.7 * math.cos(first + second)
    change = change_of(TWO_JOINT, (payload,))[0, 0]
    assert change == pytest.approx(-1.5 * 9.81 * lever, rel=2e-3)


def test_verify_base_tilts_under_the_weight():
    """At rest the tool sinks by compliance times moment times its distance from the base's axis."""
    compliance = 2e-6
    base = Effect("base_compliance", "y", {"compliance_rad_per_n_m": compliance})
    first, second = TWO_JOINT.command()[0]
    elbow = 0.7 * math.cos(first)
    moment = 9.81 * (18.0 * 0.32 * math.cos(first) + 9.0 * (elbow + 0.25 * math.cos(first + second)))
    reach = elbow + 0.7 * math.cos(first + second)
    sunk = change_of(TWO_JOINT, (base,))[0, 2]
    assert sunk == pytest.approx(-compliance * moment * reach, rel=0.02)


def test_verify_sensor_effects():
    """Gain, offset, delay and low pass on a channel, against the channel itself."""
    true = AXIS.outputs_of()
    t = AXIS.time_s

    def found(kind: str, **values: float) -> np.ndarray:
        return AXIS.outputs_of((Effect(kind, TORQUE, values),))[:, 1]

    assert np.allclose(found("sensor_gain", factor=1.2), 1.2 * true[:, 1])
    assert np.allclose(found("sensor_offset", offset=3.0), true[:, 1] + 3.0)
    assert np.allclose(found("sensor_delay", delay_s=0.008)[2:], true[:-2, 1])
    drift = found("sensor_drift", amplitude=5.0, time_constant_s=2.0) - true[:, 1]
    assert np.allclose(drift, 5.0 * (1.0 - np.exp(-t / 2.0)))
    # a slow signal passes a first-order filter late by its time constant
    slow = found("sensor_low_pass", time_constant_s=0.002)
    late = found("sensor_delay", delay_s=0.002)
    assert rms(slow - late) < 0.15 * rms(late - true[:, 1])


@pytest.mark.parametrize("colour", COLOURS)
def test_verify_noise(colour):
    """RMS 1 in band, another seed another noise, and the colour that its name says."""
    noise = unit_noise(colour, 4096, 2, 250.0, 30.0, 1)
    assert rms(in_band(noise, 250.0, 30.0)) == pytest.approx(np.ones(2))
    assert not np.allclose(noise, unit_noise(colour, 4096, 2, 250.0, 30.0, 2))
    follows = np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]
    assert (
        {"white": -0.05, "ar1": 0.75, "one_over_f": 0.5}[colour]
        < follows
        < {"white": 0.05, "ar1": 0.85, "one_over_f": 1.0}[colour]
    )


@pytest.mark.parametrize("name", ["axis", "two_joint", "chamfer", "wheel"])
def test_verify_refit_takes_up_nominal_parameters(name):
    """A deviation of uncertain parameters is no effect: what the linear refit leaves hides in ordinary noise."""
    experiment = ALL[name]
    shifts = (0.8, -0.6)[: len(experiment.uncertain)]
    change = experiment.outputs_of((), shifts) - experiment.outputs_of()
    left = left_after_refit(experiment, change)
    assert rms(left).max() < 0.7
    assert np.linalg.norm(left) < 0.25 * np.linalg.norm(scaled(experiment, change))


@pytest.mark.parametrize("pair", INSEPARABLE, ids=lambda p: f"{p[0].kind}-{p[1].kind}")
def test_verify_inseparable_pairs_leave_one_trace(pair):
    """Their signatures lie within the angle that counts as the same."""
    one, other = pair
    assert angle_deg(ALL[one.experiment], (one.at(1.0),), (other.at(1.0),)) < SAME_TRACE_DEG


def test_verify_pairs_can_be_told_apart():
    """A pair that must be named is none that cannot be."""
    for one, other in PAIRS:
        angle = angle_deg(ALL[one.experiment], (one.at(1.0),), (other.at(1.0),))
        assert 2.0 * SAME_TRACE_DEG < angle < 180.0 - 2.0 * SAME_TRACE_DEG, (one.kind, other.kind)


def test_verify_effect_over_noise():
    """The noise in a set is the level's: effect over noise in band, in the channel that shows it best."""
    case = next(c for c in all_cases("report") if c.family == "single middle" and c.truth[0].kind == "joint_coulomb")
    scale = dataset.noise_scale(case)
    trace = rms(left_after_refit(AXIS, change_of(AXIS, case.truth, case.shifts))).max()
    assert trace / scale == pytest.approx(2.0)


def test_verify_labels_are_apart_from_the_data(tmp_path):
    """The program's folder holds the data alone; reporting and tuning share neither noise nor sizes."""
    case = fast_cases("report")[3]
    name = dataset.write(case, 7, tmp_path)
    assert [p.name for p in (tmp_path / "data" / name).iterdir()] == ["data.csv"]
    text = (tmp_path / "data" / name / "data.csv").read_text(encoding="utf-8")
    assert case.truth[0].kind not in text
    report_cases, tune_cases = all_cases("report"), all_cases("tune")
    assert not {c.seed for c in report_cases} & {c.seed for c in tune_cases}
    pairs = zip(report_cases, tune_cases)
    assert all(a.shifts != b.shifts for a, b in pairs if a.family.startswith("single"))


def test_regress_shipped_example():
    """The example's data is what its maker makes, and so is that of the worn elbow."""
    for path, columns in ((example.DATA, example.columns()), (example.LATER, example.columns(example.WORN, 2025))):
        told = np.genfromtxt(path, delimiter=",", names=True)
        assert list(told.dtype.names) == list(columns)
        for name, values in columns.items():
            # the last place may round differently on another machine
            assert np.abs(told[name] - values).max() <= 1.01 * 10.0 ** -example.DECIMALS[name], name
        assert path.stat().st_size < 200_000


def _answer(verdict: str, *causes: tuple, alternatives=(), after: float = 1.0) -> Answer:
    def entry(kind, target, **values):
        return {"kind": kind, "target": target, "parameters": {k: {"value": v} for k, v in values.items()}}

    diagnosis = {
        "verdict": verdict,
        "causes": [entry(k, t, **v) for k, t, v in causes],
        "alternatives": [entry(k, t, **v) for k, t, v in alternatives],
        "channels": {ANGLE: {"before": 5.0, "after": after, "noise_floor": 1.0}},
    }
    return Answer(0, diagnosis, "", 1.0)


def score(case, answer: Answer):
    """The judgement where the measurement errs by 1.25 in the channel that the answers speak of."""
    return score_of(case, answer, {"floor_rms": {ANGLE: 1.25}})


def _case(family: str, kind: str = ""):
    return next(c for c in all_cases("report") if c.family == family and (not kind or c.truth[0].kind == kind))


def test_verify_judge_of_single_effects():
    """Named first is right, whatever way the target is written; named second, elsewhere or not at all is wrong."""
    case = _case("single strong", "joint_coulomb")
    level = case.truth[0].values["friction_n_m"]
    coulomb = ("joint_coulomb", {"joint": 1}, {"friction_n_m": 1.05 * level})
    viscous = ("joint_viscous", "joint 1", {"viscous_n_m_s_per_rad": 1.0})
    found = score(case, _answer("named", coulomb, viscous, after=1.1))
    assert found.right and found.parameter_errors["joint_coulomb"] == pytest.approx(0.05)
    assert found.gain_ratio == pytest.approx(1.1 / 1.25)
    assert found.floor_ratio == pytest.approx(0.8)
    assert not score(case, _answer("named", viscous, coulomb)).right
    assert not score(case, _answer("named", ("joint_coulomb", 2, {"friction_n_m": level}))).right
    assert not score(case, _answer("nothing_beyond_noise")).right
    assert not score(case, Answer(101, None, "", 1.0)).right
    beside = _answer("named", coulomb)
    for difference, angle, right in ((40.0, 60.0, True), (-1.0, 60.0, True), (-40.0, 1.3, True), (-40.0, 60.0, False)):
        beside.diagnosis["runner_up"] = {"causes": [], "criterion_difference": difference, "angle_deg": angle}
        assert score(case, beside).right == right


def test_verify_judge_of_ambiguous_answers():
    """A set with the truth counts if the generator cannot tell its members apart either."""
    case = next(c for c in all_cases("report") if c.family == "inseparable" and c.experiment == "teeth_three")
    truth, partner = (case.truth[0], case.partner)
    assert truth.kind == "cutting_worn_tooth"
    one = (truth.kind, None, truth.values)
    other = (partner.kind, "whole", partner.values)
    stranger = ("cutting_coefficient", None, {"factor": 1.3})
    assert score(case, _answer("ambiguous", one, alternatives=[other])).right
    assert not score(case, _answer("ambiguous", one, alternatives=[other, stranger])).right
    assert not score(case, _answer("ambiguous", other, alternatives=[stranger])).right
    assert not score(case, _answer("named", one)).right


def test_verify_judge_of_the_other_families():
    """What each family asks for, and what it does not take."""
    pair = _case("pair")
    both = [(e.kind, e.target, e.values) for e in pair.truth]
    for case, good, bad in (
        (
            _case("clean"),
            _answer("nothing_beyond_noise"),
            _answer("named", ("joint_coulomb", 1, {"friction_n_m": 1.0})),
        ),
        (pair, _answer("named", *both), _answer("named", both[0])),
        (_case("outside"), _answer("unknown_cause"), _answer("nothing_beyond_noise")),
        (_case("constant command"), _answer("not_identifiable"), _answer("nothing_beyond_noise")),
        (_case("faint motion"), _answer("not_identifiable"), Answer(2, None, "", 0.1)),
        (_case("test part only"), _answer("nothing_beyond_noise"), _answer("named", *both)),
        (_case("wrong unit"), Answer(2, None, "", 0.1), _answer("unknown_cause")),
    ):
        assert score(case, good).right, case.family
        assert not score(case, bad).right, case.family


def test_verify_interval_of_a_share():
    """Clopper-Pearson: 0 of 300 is at most 1.22 %, 6 of 300 at most 4.30 % (Clopper and Pearson 1934)."""
    assert report.interval(0, 300)[1] == pytest.approx(1.0 - 0.025 ** (1 / 300))
    low, high = report.interval(6, 300)
    assert (low, high) == pytest.approx((0.00738, 0.04304), abs=2e-5)


def test_verify_bench_with_a_program_that_finds_nothing(tmp_path):
    """From data to report, with a stand-in: right about clean sets only, and the report says so."""
    stand_in = tmp_path / "stand_in.py"
    stand_in.write_text(
        "import json, pathlib, sys\n"
        "assert sys.argv[1] == 'diagnose' and sys.argv[3] == '--data' and sys.argv[5] == '--out'\n"
        "assert pathlib.Path(sys.argv[4]).exists()\n"
        "out = pathlib.Path(sys.argv[6]); out.mkdir(parents=True)\n"
        "told = {'verdict': 'nothing_beyond_noise', 'causes': [], 'alternatives': [], 'channels': {}}\n"
        "(out / 'diagnosis.json').write_text(json.dumps(told))\n",
        encoding="utf-8",
    )
    cases = [fast_cases("report")[k] for k in (0, 3, -1)]
    sets = runner.write_all(cases, tmp_path / "work", 1, 1)
    answers = runner.diagnose_all([sys.executable, str(stand_in)], sets, tmp_path / "work", 1)
    judged = runner.judge_all(sets, answers, tmp_path / "work", 1)
    assert {case.family: found.right for _, case, found, _ in judged} == {
        "clean": True,
        "single strong": False,
        "wrong unit": False,
    }
    text = report.as_markdown(judged, "report", 1.0)
    assert "| clean | 1 of 1 |" in text and "| single strong | 0 of 1 |" in text
    assert report.as_json(judged, "report", 1.0)["goals"]["false alarms on clean data"]["hits"] == 0


def test_verify_fast_part(tmp_path):
    """Every answer about the sets of the fast part is right: one for each kind of answer."""
    cases = fast_cases("report")
    sets = runner.write_all(cases, tmp_path / "work", SEEDS["report"], 2)
    answers = runner.diagnose_all([str(PROGRAM)], sets, tmp_path / "work", 2)
    judged = runner.judge_all(sets, answers, tmp_path / "work", 2)
    wrong = [(case.family, case.truth, found.reason) for _, case, found, _ in judged if not found.right]
    assert not wrong, wrong
    errors = [found.gain_ratio for _, _, found, _ in judged if found.gain_ratio is not None]
    assert errors and max(errors) < 1.15, errors


def test_verify_chamfer_of_the_generator_is_the_reference():
    """Without effects the generator's cutter is that of the cross-checks."""
    spec = scenario_file.load(CHAMFER.path)
    known = simulate(spec, urdf_model.from_urdf(spec.robot), CHAMFER.step_s, until_s=2.0)
    found = CHAMFER.outputs_of()
    at = CHAMFER.time_s <= 1.9
    for i, column in enumerate(CHAMFER.outputs):
        expected = np.interp(CHAMFER.time_s[at], known.time_of(column.channel), known.channels[column.channel])
        assert np.abs(found[at, i] - expected).max() < 1e-6 * CHAMFER.reference_noise[i], column.channel
