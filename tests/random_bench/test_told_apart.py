"""Causes whose traces are much alike, and none where there is none. Drawn arms in MuJoCo."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from drawn.case import Case, _measure, draw_case  # noqa: E402
from drawn.judge import ask  # noqa: E402
from drawn.laws import sized  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

PROGRAM = shlex.split(os.environ.get("TRUECUT_BIN", run.PROGRAM))


@pytest.mark.parametrize("seed", some([9_710_002, 9_710_004, 9_710_007], 1))
def test_crosscheck_mujoco_friction_under_an_even_load_is_told_from_dry_friction(seed, tmp_path):
    """The load varies by less than a fifth, and still more than what is measured errs by."""
    case = draw_case(seed, "forward", "strong", tmp_path, "joint_load_friction")
    (hidden,) = case.truth
    answer = ask(PROGRAM, case, 2)
    print(hidden, answer.verdict, answer.diagnosis["reason"])
    (found,) = answer.diagnosis["causes"]
    assert (found["kind"], found["target"]) == ("joint_load_friction", f"joint{hidden.target}")
    assert found["parameters"]["share"]["value"] == pytest.approx(hidden.values["share"], rel=0.1)


@pytest.mark.parametrize("seed", some([9_792_000, 9_792_001], 1))
def test_crosscheck_mujoco_a_softer_joint_of_a_pushed_arm_is_no_balancing_spring(seed, tmp_path):
    """About one posture such a spring is a stiffness, with an amplitude that no joint carries."""
    case = draw_case(seed, "load", "strong", tmp_path, "joint_stiffness")
    (hidden,) = case.truth
    answer = ask(PROGRAM, case, 2)
    print(hidden, answer.verdict, answer.diagnosis["reason"])
    (found,) = answer.diagnosis["causes"]
    assert (found["kind"], found["target"]) == ("joint_stiffness", f"joint{hidden.target}")
    told = answer.diagnosis["alternatives"]
    assert not [one for other in told for one in other["causes"] if one["kind"] == "joint_counterbalance"]


def hidden_in(case: Case, draw: np.random.Generator, effects: tuple) -> Case:
    """A clean set, measured again with these effects in it."""
    case.truth = effects
    case.clean = case.experiment.converged(effects, case.shifts, np.array([one.rms for one in case.noise]))
    _measure(draw, case)
    return case


@pytest.mark.parametrize("seed", some([9_795_104, 9_795_101], 1))
def test_crosscheck_mujoco_an_offset_larger_than_the_dry_friction_is_named_with_it(seed, tmp_path):
    """A friction of its own in either direction would be both in one, and drive in one of them."""
    case, draw = draw_case(seed, "forward", "clean", tmp_path), np.random.default_rng(seed)
    names = [name for name, _ in case.experiment.outputs if name.endswith("transmission_torque")]
    name = str(draw.choice(names))
    joint, noise = int(name[5]), dict(zip((n for n, _ in case.experiment.outputs), case.noise))[name].rms
    friction = noise * draw.uniform(6.0, 12.0)
    offset = friction * draw.uniform(1.3, 2.5) * draw.choice([-1.0, 1.0])
    case = hidden_in(case, draw, (sized("joint_coulomb", joint, [friction]), sized("joint_offset", joint, [offset])))
    answer = ask(PROGRAM, case, 2)
    print(case.truth, case.nuisances, answer.verdict, answer.diagnosis["reason"])
    told = [answer.diagnosis, *answer.diagnosis["alternatives"]]
    told = [{(one["kind"], one["target"]): one["parameters"] for one in other["causes"]} for other in told]
    # where the arm hardly gives way, an offset of the sensor is the same with the other sign
    assert all(("joint_coulomb", f"joint{joint}") in other and len(other) == 2 for other in told), told
    both = [other for other in told if ("joint_offset", f"joint{joint}") in other]
    assert both, told
    assert both[0]["joint_coulomb", f"joint{joint}"]["friction_n_m"]["value"] == pytest.approx(friction, rel=0.1)
    assert both[0]["joint_offset", f"joint{joint}"]["force_n_m"]["value"] == pytest.approx(offset, rel=0.1)


def test_crosscheck_mujoco_offset_and_friction_are_found_where_either_hides_the_other(tmp_path):
    """Noise that is stated, and an offset of 45 times that, which an autoregression follows as a slow noise."""
    case = draw_case(9_700_008, "forward", "pair", tmp_path)
    _, friction = case.truth
    answer = ask(PROGRAM, case, 2)
    print(case.truth, answer.verdict, answer.diagnosis["reason"])
    told = [answer.diagnosis, *answer.diagnosis["alternatives"]]
    kinds = [{(one["kind"], one["target"]) for one in other["causes"]} for other in told]
    assert {("joint_offset", "joint1"), ("joint_coulomb", "joint1")} in kinds
    dry = next(one for one in answer.diagnosis["causes"] if one["kind"] == "joint_coulomb")
    assert dry["parameters"]["friction_n_m"]["value"] == pytest.approx(friction.values["friction_n_m"], rel=0.05)


def test_crosscheck_mujoco_what_makes_up_for_a_fit_that_had_not_ended_is_no_cause(tmp_path):
    """Stiffness, inertia and lag of a pushed arm lie along one valley: a first cause helped them along it."""
    case = draw_case(9_750_112, "load", "clean", tmp_path)
    answer = ask(PROGRAM, case, 2)
    print(answer.verdict, answer.diagnosis["reason"])
    assert answer.verdict == "nothing_beyond_noise"


def test_data_are_made_at_steps_that_are_lost_in_the_noise(tmp_path):
    """A load friction, which at the step of the nominal arm is off by as much as the noise."""
    case = draw_case(9_740_001, "forward", "strong", tmp_path, "joint_load_friction")
    experiment, noise = case.experiment, np.array([one.rms for one in case.noise])

    def error(values: np.ndarray) -> float:
        return float(np.max(np.sqrt(np.mean((values - finest) ** 2, axis=0)) / noise))

    coarse = experiment.predict(case.truth, case.shifts)
    experiment.step_s /= 16.0
    finest = experiment.predict(case.truth, case.shifts)
    print(error(coarse), error(case.clean))
    assert error(coarse) > 0.5
    assert error(case.clean) < 0.1


@pytest.mark.parametrize("seed", some([1_167_589_510, 9_930_001, 1_167_589_595, 9_930_003], 2))
def test_crosscheck_mujoco_a_payload_is_found_wherever_it_is(seed, tmp_path):
    """Far from the flange of a small arm its inertia counts for more than its weight."""
    case = draw_case(seed, "inverse", "strong", tmp_path, None if seed > 10**9 else "payload")
    (hidden,) = case.truth
    answer = ask(PROGRAM, case, 2)
    print(hidden, answer.verdict, answer.diagnosis["reason"])
    (found,) = answer.diagnosis["causes"]
    assert hidden.kind == found["kind"] == "payload"
    mass = found["parameters"]["mass_kg"]["value"]
    assert mass == pytest.approx(hidden.values["mass_kg"], rel=0.15)
    for axis in "xyz":
        told = found["parameters"][f"center_{axis}_m"]
        if told["low"] is not None:
            assert told["value"] == pytest.approx(hidden.values[f"center_{axis}_m"], abs=0.05)


@pytest.mark.parametrize("seed", some([1_167_589_575, 1_167_589_346], 1))
def test_crosscheck_mujoco_a_late_clock_is_told_beside_what_else_is_there(seed, tmp_path):
    """All channels are late, and one is later, or a payload is there: two causes, not four."""
    case = draw_case(seed, "inverse", "pair", tmp_path)
    hidden = {(one.kind, one.target) for one in case.truth}
    answer = ask(PROGRAM, case, 2)
    print(hidden, answer.verdict, answer.diagnosis["reason"])
    told = {(one["kind"], one["target"]) for one in answer.diagnosis["causes"]}
    assert told == hidden


@pytest.mark.parametrize("seed", some([1_167_589_446, 1_167_589_638, 1_167_589_002], 1))
def test_crosscheck_mujoco_a_joint_that_rubs_all_round_has_dry_friction_and_an_offset(seed, tmp_path):
    """Beside viscous friction, a dry one that differs between the directions is told as both."""
    case = draw_case(seed, "inverse", "all joints", tmp_path)
    hidden = {(one.kind, f"joint{one.target}") for one in case.truth}
    answer = ask(PROGRAM, case, 2)
    print(hidden, answer.verdict, answer.diagnosis["reason"])
    assert {(one["kind"], one["target"]) for one in answer.diagnosis["causes"]} == hidden
