"""The random bench's own parts against closed forms, and a few sets of it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.stats import chi2

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from drawn import ROOT  # noqa: E402, F401
from bench.dataset import write_csv  # noqa: E402
from drawn.case import draw_case  # noqa: E402
from drawn.experiment import MODES, Forward, Inverse, Load  # noqa: E402
from drawn.judge import interval, summary  # noqa: E402
from drawn.laws import IN_INVERSE, Foreign, against, sized  # noqa: E402
from bench.joint_law import JointLaw  # noqa: E402
from drawn.library import is_possible, resized, stiffening  # noqa: E402
from drawn.moving import Moving  # noqa: E402
from drawn.noise import COLOURS, draw_noise  # noqa: E402
from drawn.oracle import DECISIVE, Oracle, cramer_rao  # noqa: E402
from truecut_reference import scenario as scenario_file  # noqa: E402

PROGRAM = os.environ.get("TRUECUT_BIN", run.PROGRAM)
SEED = 424_200


@pytest.mark.parametrize("colour", COLOURS)
def test_verify_spectrum_of_the_noise(colour):
    """Transforms over the stated density have mean square 1, and the RMS in the band is the one asked for."""
    draw = np.random.default_rng(SEED)
    noise = draw_noise(draw, 0.7, 200.0, 30.0, 1500, colour)
    hz = np.fft.rfftfreq(noise.count, 1.0 / noise.rate_hz)
    power = np.zeros(hz.size)
    runs = 60
    for _ in range(runs):
        power += np.abs(np.fft.rfft(noise.sample(draw))) ** 2 / noise.count / runs
    inside = (hz > 0.5) & (hz < 90.0)
    ratio = (power / noise.density(hz))[inside]
    assert abs(np.mean(ratio) - 1.0) < 4.0 / np.sqrt(runs * inside.sum()) + 0.03
    # by the octave, so that a wrong slope shows
    for low in (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0):
        octave = (hz > low) & (hz <= 2.0 * low)
        assert abs(np.mean((power / noise.density(hz))[octave]) - 1.0) < 5.0 / np.sqrt(runs * octave.sum()) + 0.03, low
    assert np.sqrt(2.0 * np.sum(power[hz <= 30.0]) / noise.count) == pytest.approx(0.7, rel=0.1)


@pytest.mark.parametrize("seed", range(3))
def test_verify_drive_torques_are_those_that_move_the_arm(seed, tmp_path):
    """Forward dynamics under the torques predicted give the accelerations of the motion, friction included."""
    experiment = Inverse(np.random.default_rng([SEED, seed]), tmp_path)
    joint = experiment.joints
    effects = (sized("joint_coulomb", joint, [3.0]), sized("joint_load_friction", joint, [0.2]))
    shifts = (0.5,) * experiment.shifts
    _, torque = experiment.run(effects, shifts)
    model = mujoco.MjModel.from_xml_string(experiment.arm.urdf)
    own = [model.body(f"link_{j + 1}").id for j in range(experiment.joints)]
    factor = 1.0 + 0.5 * experiment.uncertain[0].deviation
    model.body_mass[own] *= factor
    model.body_inertia[own] *= factor
    model.dof_armature[:] = experiment.arm.rotor * (1.0 if experiment.links else factor)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    for k in range(0, experiment.fine.size, 97):
        data.qpos[:], data.qvel[:] = experiment.q[k], experiment.v[k]
        passed = torque[k, joint - 1] - model.dof_armature[joint - 1] * experiment.a[k, joint - 1]
        friction = np.zeros(experiment.joints)
        # of what passes the transmission, which is all but the rotor's, a fifth rubs; and three more
        friction[-1] = np.sign(experiment.v[k, -1]) * (3.0 + 0.2 * abs(passed))
        data.qfrc_applied[:] = torque[k] - friction
        mujoco.mj_forward(model, data)
        assert data.qacc == pytest.approx(experiment.a[k], rel=1e-6, abs=1e-6)


def test_verify_a_force_at_the_tool_moves_springs_as_far_as_it_should(tmp_path):
    """Under a force that is held, torques of the springs are those of gravity and J^T F."""
    experiment = Load(np.random.default_rng([SEED, 9]), tmp_path, 3)
    robot = scenario_file.load(experiment.write(None), {}).robot
    arm = Moving(robot, [], experiment.command_time, experiment.command, 1e-3, None, experiment.amplitude)
    arm.settle()
    mujoco.mj_forward(arm.model, arm.data)
    needed = arm.data.qfrc_bias - arm.at_tool(experiment.amplitude)
    windup = experiment.posture - arm.data.qpos
    assert experiment.arm.stiffness * windup == pytest.approx(needed, rel=1e-6)


@pytest.mark.parametrize("kind", [Forward, Load])
def test_verify_step_of_the_drawn_arms(kind, tmp_path):
    """Half the step moves what is measured by less than a tenth of the least noise that is drawn."""
    experiment = kind(np.random.default_rng([SEED, 4]), tmp_path, 2)
    experiment.duration_s = 1.2
    experiment.draw_times(np.random.default_rng(1), False)
    if kind is Load:
        experiment.command_time = np.linspace(0.0, 1.2, 5)
    else:
        keep = experiment.command_time <= 1.2001
        experiment.command_time, experiment.command = experiment.command_time[keep], experiment.command[keep]
    one = experiment.predict()
    experiment.kept.clear()
    experiment.step_s *= 0.5
    other = experiment.predict()
    assert (np.std(one - other, axis=0) < 1e-3 * np.std(other, axis=0) + 1e-12).all()


@pytest.mark.parametrize("mode", sorted(MODES))
def test_verify_the_oracle_weighs_noise_as_noise(mode, tmp_path):
    """What the truth leaves is chi squared: the oracle's slopes, weights and priors are those of the measurement."""
    seed = {"inverse": 11, "forward": 12, "load": 13}[mode]
    case = draw_case(SEED + seed, mode, "middle", tmp_path)
    oracle = Oracle(case)
    tangents, _ = oracle.tangents()
    left = oracle.own_residual()
    basis, _ = np.linalg.qr(tangents)
    left = left - basis @ (basis.T @ left)
    free = oracle.rows - tangents.shape[1]
    low, high = chi2.ppf([1e-4, 1.0 - 1e-4], free)
    assert low < left @ left < high, (left @ left, free)


def test_verify_the_oracle_finds_what_no_one_can_tell_apart(tmp_path):
    """A torque's offset is the joint's or the sensor's: no noise and no motion tells them apart."""
    for seed in range(2):
        case = draw_case(SEED + seed, "inverse", "strong", tmp_path, "joint_offset")
        label = Oracle(case).label()
        assert not label.separable
        assert label.evidence < DECISIVE
        assert any(rival.startswith("sensor_offset") for rival in label.rivals), label.rivals


def test_verify_deviations_are_those_of_the_normal_matrix():
    """Cramér and Rao's bound is the inverse of the normal matrix; what moves nothing, or as others do, has none."""
    draw = np.random.default_rng(SEED + 31)
    for _ in range(20):
        tangents = draw.normal(0.0, 1.0, (200, 4)) * np.exp(draw.uniform(-12.0, 12.0, 4))
        # of the columns scaled to one length, whose normal matrix can be inverted
        length = np.linalg.norm(tangents, axis=0)
        expected = np.sqrt(np.diag(np.linalg.inv((tangents / length).T @ (tangents / length)))) / length
        assert np.allclose(cramer_rao(tangents), expected, rtol=1e-8)
        idle = np.column_stack([tangents, np.zeros(200), tangents[:, 0] * 3.0])
        found = cramer_rao(idle)
        assert np.isinf(found[[0, 4, 5]]).all() and np.isfinite(found[1:4]).all(), found


def test_verify_the_oracle_tells_what_can_be_told(tmp_path):
    """Viscous friction, six times the noise or more, stands alone; a hundredth of it is not seen."""
    for seed in range(2):
        case = draw_case(SEED + seed, "inverse", "strong", tmp_path, "joint_viscous")
        label = Oracle(case).label()
        assert label.detectable and label.separable, label
        faint = tuple(resized(case.experiment, effect, 1e-2 / case.levels[0]) for effect in case.truth)
        noise = case.noisy - case.clean
        case.truth, case.clean = faint, case.experiment.predict(faint, case.shifts)
        case.noisy = case.clean + noise
        assert not Oracle(case).label().detectable


@pytest.mark.parametrize("mode", sorted(MODES))
def test_crosscheck_mujoco_drawn_arms_move_as_the_program_says(mode, tmp_path):
    """Without noise and with the nominal numbers as they truly are, a scenario misses its data by 2e-3 at most."""
    for seed in range(3):
        experiment = MODES[mode](np.random.default_rng([SEED, 30 + seed]), tmp_path / str(seed), 1 + seed)
        if mode == "forward":
            experiment.draw_lag(np.random.default_rng(seed))
        shifts = tuple(np.random.default_rng(seed).uniform(-1.5, 1.5, experiment.shifts))
        outputs = experiment.predict((), shifts)
        moves = np.std(outputs, axis=0) > 1e-3 * np.std(outputs, axis=0).max()
        experiment.outputs = [one for one, does in zip(experiment.outputs, moves) if does]
        columns = {"t": experiment.time} | {name: values for name, (_, _, values) in experiment.inputs().items()}
        columns |= {f"y{i + 1}": values for i, values in enumerate(outputs[:, moves].T)}
        scenario = experiment.write(None)
        data = scenario.with_name("data.csv")
        write_csv(data, columns)
        words = []
        for one, shift in zip(experiment.uncertain, shifts):
            words += ["--set", f"{one.key}={1.0 + one.deviation * shift:.12g}"]
        if experiment.lag_deviation_s:
            delay_s = experiment.lag_s + experiment.lag_deviation_s * shifts[-1]
            words += ["--set", f"effect.0.delay_s={delay_s:.12g}"]
        out = tmp_path / str(seed) / "out"
        command = [PROGRAM, "compare", scenario, "--data", data, "--out", out, *words]
        subprocess.run(command, check=True, capture_output=True)
        found = json.loads(next(out.rglob("compare.json")).read_text(encoding="utf-8"))
        for channel in found["channels"]:
            name = channel["channel"]
            spread = float(np.std(outputs[:, moves][:, [n for n, _ in experiment.outputs].index(name)]))
            assert channel["level"]["rms_error"] < 2e-3 * spread, (seed, name, channel["level"], shifts)


def _write_evenly(case, outputs: np.ndarray) -> None:
    """Outputs of a case at even times in place of its data."""
    inputs = {name: values for name, (_, _, values) in case.experiment.inputs().items()}
    columns = {"t": case.experiment.time} | inputs | {f"y{i + 1}": values for i, values in enumerate(outputs.T)}
    write_csv(case.data, columns)


def _compared(scenario: Path, data: Path, out: Path) -> dict:
    """What `truecut compare` writes."""
    subprocess.run([PROGRAM, "compare", scenario, "--data", data, "--out", out], check=True, capture_output=True)
    return json.loads(next(out.rglob("compare.json")).read_text(encoding="utf-8"))


# new ones at the end: the place says which case is drawn
ACT_ON_TORQUES = (*sorted((*IN_INVERSE, "payload", "sensor_gain", "sensor_delay", "clock_delay")), "base_tilt", "joint_zero")


@pytest.mark.parametrize("kind", ACT_ON_TORQUES)
def test_crosscheck_mujoco_effects_of_drive_torques_are_those_of_the_program(kind, tmp_path):
    """A scenario that has the effect misses data without noise by less than a tenth of what the effect changes."""
    seed = ACT_ON_TORQUES.index(kind)
    case = draw_case(SEED + 50 + seed, "inverse", "strong", tmp_path, kind)
    experiment = case.experiment
    experiment.time = np.arange(experiment.time.size) / experiment.rate_hz
    outputs, nominal = experiment.predict(case.truth), experiment.predict()
    _write_evenly(case, outputs)
    (effect,) = case.truth
    text = f'[[effect]]\nkind = "{effect.kind}"\n'
    if effect.target is not None:
        key = "axis" if kind == "base_tilt" else "channel"
        text += f"joint = {effect.target}\n" if isinstance(effect.target, int) else f'{key} = "{effect.target}"\n'
    text += "".join(f"{key} = {float(value)!r}\n" for key, value in effect.values.items())
    scenario = case.scenario.with_name("with_effect.toml")
    scenario.write_text(case.scenario.read_text(encoding="utf-8") + text, encoding="utf-8")
    found = _compared(scenario, case.data, tmp_path / "out")
    change = experiment.compared(outputs - nominal)
    names = [name for name, _ in experiment.outputs]
    shown = False
    for channel in found["channels"]:
        own = float(np.std(change[:, names.index(channel["channel"])]))
        spread = float(np.std(outputs[:, names.index(channel["channel"])]))
        assert channel["level"]["rms_error"] < 0.1 * own + 2e-3 * spread, (channel, own, spread)
        # without what the reversals of friction leave
        shown |= channel["level"]["rms_error"] < 0.1 * own
    assert shown or kind in ("sensor_gain", "sensor_delay", "clock_delay", "joint_offset")


def test_crosscheck_mujoco_filtered_noise_has_no_lines(tmp_path):
    """Drive torques of drawn arms with white noise of 2 % and nothing else, low-passed by the program: what is left holds no
    line in 19 of 20 channels. With all samples of the filtered series all channels were told to have some. Short records,
    of which more samples are kept than the filter leaves worth of information, are not counted."""
    with_lines, channels = 0, 0
    for k in range(30):
        folder = tmp_path / str(k)
        folder.mkdir()
        case = draw_case(940_000 + k, "inverse", "clean", folder)
        experiment = case.experiment
        experiment.time = np.arange(experiment.time.size) / experiment.rate_hz
        outputs = experiment.predict()
        noise = np.random.default_rng([SEED, k]).standard_normal(outputs.shape) * 0.02 * outputs.std(axis=0)
        _write_evenly(case, outputs + noise)
        found = _compared(case.scenario, case.data, folder / "out")
        if any("the record is short" in note for note in found["notes"]):
            continue
        channels += len(found["channels"])
        with_lines += sum(bool(channel["lines"]) for channel in found["channels"])
    assert channels > 15
    assert with_lines <= max(1, channels // 20), (with_lines, channels)


@pytest.mark.parametrize("seed", [910_000, 910_001])
def test_crosscheck_mujoco_a_payload_off_the_flange_is_named(seed, tmp_path):
    """Light, its centre a hand's breadth off a light last link: by its mass alone, at the flange, it is not seen."""
    found = run.one_set(seed, "inverse", "strong", tmp_path, [PROGRAM], 2, "payload")
    assert found is not None and found["separable"]
    assert (found["told"], found["named"]) == ("named", ["payload"]), found


def test_seeds_say_everything(tmp_path):
    """The same seed gives the same files; another one does not."""
    one, same, other = (
        draw_case(seed, "inverse", "pair", tmp_path / str(i)) for i, seed in enumerate((SEED, SEED, SEED + 1))
    )
    assert one.data.read_text() == same.data.read_text()
    assert one.scenario.read_text() == same.scenario.read_text()
    assert one.data.read_text() != other.data.read_text()


def test_foreign_laws_are_none_of_the_library(tmp_path):
    """Each law outside leaves more than a tenth of itself when all friction of its joint is fitted to it."""
    draw = np.random.default_rng(SEED)
    experiment = Inverse(draw, tmp_path, 2)
    q, v = experiment.q, experiment.v
    t, zero = experiment.fine, np.zeros(experiment.fine.size)
    for form in ("powered_drag", "place_friction", "hard_spot", "cogging", "warming", "coupling", "surface"):
        numbers = tuple(draw.uniform(0.0, 1.0, 4))
        place, travel, speed = float(q[:, 0].mean()), float(q[:, 0].std()), float(v[:, 0].std())
        law = Foreign(form, 1, 1.0, numbers, place, travel, speed, t[-1], 1)
        torque = against([law], zero, t, q[:, 0], v[:, 0], v)
        positive = v[:, 0] > 0
        viscous, spring = (positive * v[:, 0], ~positive * v[:, 0]), (np.cos(q[:, 0]), np.sin(q[:, 0]))
        known = np.stack([np.ones_like(t), positive, *viscous, *spring], axis=1)
        left = torque - known @ np.linalg.lstsq(known, torque, rcond=None)[0]
        assert np.std(left) > 0.1 * np.std(torque), form


def test_verify_intervals_of_shares():
    """Clopper and Pearson (1934): 0 of 10 is at most 30.85 %, 5 of 10 lies between 18.71 and 81.29 %."""
    assert interval(0, 10) == pytest.approx((0.0, 0.3085), abs=5e-5)
    assert interval(5, 10) == pytest.approx((0.1871, 0.8129), abs=5e-5)


def test_seeds_of_a_report_come_from_the_commit():
    """Two commits, two seeds; and every family and mode has its turn."""
    assert run.seed_of_commit("a" * 40) != run.seed_of_commit("b" * 40)
    planned = run.plan(5, 100, list(MODES), ["clean", "all joints", "strong"])
    assert {mode for _, mode, family in planned if family == "all joints"} == {"inverse"}
    assert {(m, f) for _, m, f in planned} >= {(m, f) for m in MODES for f in ("clean", "strong")}
    assert len({seed for seed, _, _ in planned}) == 100


def test_a_few_sets_from_end_to_end(tmp_path):
    """The program answers, and what comes out can be counted. Which answers are right is for the report to say."""
    found = []
    drawn = [("inverse", "clean"), ("inverse", "all joints"), ("inverse", "strong"), ("load", "clean")]
    for seed, (mode, family) in enumerate(drawn):
        verdict = run.one_set(SEED + seed, mode, family, tmp_path, [PROGRAM], 2)
        assert verdict is not None, (tmp_path / f"{SEED + seed}_{mode}_failed.txt").read_text()
        assert verdict["told"] in ("named", "ambiguous", "unknown_cause", "nothing_beyond_noise"), verdict
        found.append(verdict)
    figures = summary(json.loads(json.dumps(found)))
    assert figures["sets"] == 4
    assert figures["frictions"][1] >= 2


def test_verify_stiffening_is_the_slope_of_the_law(tmp_path):
    """Largest slope of what a transmission passes on, over the nominal one, within the nominal run's wind-up."""
    experiment = Forward(np.random.default_rng([SEED, 7]), tmp_path, joints=1)
    experiment.fast = True
    experiment.signals_kept = experiment.signals()
    stiffness, most = float(experiment.arm.stiffness[0]), experiment.signals_kept[0]["most_windup"]
    cubic = sized("joint_cubic_stiffness", 1, [2.0 * stiffness / most**2])
    loop = sized("joint_hysteresis", 1, [3.0 * stiffness * most], (0.5 * most,))
    for effect in (cubic, loop):
        law = JointLaw.of(stiffness, 0.0, [effect])
        law.start(-most)
        torque = np.array([law.transmission(w, 0.0) for w in np.linspace(-most, most, 4001)])
        slope = np.diff(torque).max() / (2.0 * most / 4000) / stiffness
        assert stiffening(effect, experiment) == pytest.approx(slope, rel=2e-3)
        assert is_possible(effect, experiment)
        factor = 9.5 / (stiffening(effect, experiment) - 1.0)
        assert not is_possible(resized(experiment, effect, factor), experiment)
