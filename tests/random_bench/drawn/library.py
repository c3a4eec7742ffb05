"""Which effects of the library act in a mode, with sizes that an experiment's signals suggest; and laws outside it."""

from __future__ import annotations

import numpy as np
from bench.effects import KINDS, Effect

from .experiment import Experiment
from .laws import IN_INVERSE, JOINT_FORMS, SENSOR_FORMS, Foreign, sized

IN_TRANSMISSIONS = ("joint_stiffness", "joint_damping", "joint_backlash", "joint_hysteresis", "joint_cubic_stiffness")
IN_JOINTS = (*IN_INVERSE, *IN_TRANSMISSIONS)
PUSHED_JOINTS = tuple(kind for kind in IN_JOINTS if kind not in ("joint_counterbalance", "joint_stribeck"))
SIGNED = (
    "base_tilt",
    "joint_offset",
    "joint_zero",
    "sensor_offset",
    "sensor_drift",
    "sensor_gain",
    "joint_stiffness",
)
SENSORS = ("sensor_delay", "sensor_gain", "sensor_offset")
MORE_SENSORS = (*SENSORS, "sensor_drift", "sensor_low_pass")
# the second holds the first as a special case: it explains what the first does, and that is no error
GENERAL = {
    "joint_viscous": ("joint_asymmetric_viscous",),
    "joint_coulomb": ("joint_asymmetric_coulomb",),
}


def kinds(experiment: Experiment) -> list[tuple[str, int | str | None]]:
    """Kinds and targets that act."""
    joints = range(1, experiment.joints + 1)
    if experiment.mode == "inverse":
        of_joints, of_channels = IN_INVERSE, SENSORS
    else:
        of_joints = (*IN_JOINTS, "joint_ripple") if experiment.mode == "forward" else PUSHED_JOINTS
        of_channels = MORE_SENSORS
    found: list[tuple[str, int | str | None]] = [(kind, joint) for kind in of_joints for joint in joints]
    found += [("joint_zero", joint) for joint in joints]
    found.append(("payload", None))
    # gravity points along z
    found += [("base_tilt", axis) for axis in "xy"]
    if experiment.mode != "inverse":
        found += [("base_compliance", axis) for axis in "xyz"]
    if len(experiment.outputs) > 1 and not experiment.lag_deviation_s:
        found.append(("clock_delay", None))
    return found + [(kind, channel) for kind in of_channels for channel, _ in experiment.outputs]


def scales(experiment: Experiment, kind: str, target) -> list[float]:
    """A size of each size parameter that changes an output by some per cent."""
    s = experiment.signals_kept
    if isinstance(target, int):
        one = s[target - 1]
        effort, speed, windup = 0.1 * one["effort"], max(one["speed"], 1e-9), one.get("windup", 0.0)
        return {
            "joint_viscous": [effort / speed],
            "joint_coulomb": [effort],
            "joint_load_friction": [0.05],
            "joint_asymmetric_viscous": [effort / speed] * 2,
            "joint_asymmetric_coulomb": [effort] * 2,
            "joint_stribeck": [effort],
            "joint_counterbalance": [effort] * 2,
            "joint_offset": [effort],
            "joint_zero": [0.01],
            "joint_stiffness": [-0.1],
            "joint_damping": [1.0],
            "joint_backlash": [0.2 * windup],
            "joint_hysteresis": [effort],
            "joint_cubic_stiffness": [effort / max(one.get("most_windup", 1.0), 1e-12) ** 3],
            "joint_ripple": [0.05 * windup] * 2,
        }[kind]
    if kind == "payload":
        return [0.05 * experiment.moving_mass_kg]
    if kind == "base_tilt":
        return [0.01]
    if kind == "base_compliance":
        return [0.05 / float(np.max(experiment.arm.stiffness))]
    if kind in ("clock_delay", "sensor_delay"):
        return [0.004]
    spread = 1.0 if target is None else experiment.spread_kept[[c for c, _ in experiment.outputs].index(target)]
    return {
        "sensor_gain": [0.05],
        "sensor_offset": [0.1 * spread],
        "sensor_drift": [0.2 * spread],
        "sensor_low_pass": [0.005],
    }[kind]


def shapes(experiment: Experiment, kind: str, target, draw: np.random.Generator | None = None) -> list[tuple[float, ...]]:
    """Values of the parameters that only shape an effect: one drawn, or a few that the oracle tries."""

    def pick(around: float, factors: tuple[float, ...]) -> list[tuple[float, ...]]:
        if draw is None:
            return [(around * factor,) for factor in factors]
        return [(around * float(np.exp(draw.uniform(np.log(factors[0]), np.log(factors[-1])))),)]

    if kind == "payload":
        if draw is None:
            return [(0.0, 0.0, 0.0), (0.15, 0.0, 0.0), (0.0, 0.15, 0.0), (0.0, 0.0, 0.15)]
        return [tuple(float(x) for x in draw.uniform(-0.2, 0.2, 3))]
    if kind == "joint_stribeck":
        return pick(experiment.signals_kept[target - 1]["speed"], (0.08, 0.4))
    if kind == "joint_hysteresis":
        return pick(max(experiment.signals_kept[target - 1]["windup"], 1e-9), (0.5, 2.0))
    if kind == "joint_ripple":
        return pick(1.0 / max(experiment.signals_kept[target - 1]["travel"], 1e-9), (2.5, 6.0, 14.0))
    if kind == "sensor_drift":
        return pick(experiment.duration_s, (0.2, 0.7))
    return [()]


def effect_at(experiment: Experiment, kind: str, target, amount: list[float], shape: tuple[float, ...]) -> Effect:
    """Sizes in units of the scale."""
    return sized(kind, target, [a * s for a, s in zip(amount, scales(experiment, kind, target))], shape)


def draw_known(draw: np.random.Generator, experiment: Experiment, kind: str, target, size: float) -> Effect:
    """An effect of the library, `size` times as large as its scale."""
    count = len(KINDS[kind][0])
    amount = np.ones(count)
    if kind in ("joint_asymmetric_viscous", "joint_asymmetric_coulomb"):
        low = draw.uniform(0.2, 0.6)
        amount = np.array([1.0, low] if draw.random() < 0.5 else [low, 1.0]) * 1.4
    elif kind in ("joint_counterbalance", "joint_ripple"):
        turn = draw.uniform(0.0, 2.0 * np.pi)
        amount = 1.4 * np.array([np.cos(turn), np.sin(turn)])
    elif kind in SIGNED:
        amount *= draw.choice([-1.0, 1.0])
    (shape,) = shapes(experiment, kind, target, draw)
    return effect_at(experiment, kind, target, list(size * amount), shape)


def resized(experiment: Experiment, effect, factor: float):
    """The same effect, so many times as large."""
    if isinstance(effect, Foreign):
        return effect.at(effect.size * factor)
    names = KINDS[effect.kind][1]
    return sized(
        effect.kind,
        effect.target,
        [factor * size for size in effect.sizes.values()],
        tuple(effect.values[name] for name in names),
    )


def is_possible(effect, experiment: Experiment) -> bool:
    """Whether a size is one that a machine can have."""
    v = getattr(effect, "values", {})
    if "factor" in v:
        return 0.3 < v["factor"] < 10.0
    if abs(v.get("angle_rad", v.get("offset_rad", 0.0))) > 0.3:
        return False
    if stiffening(effect, experiment) >= 10.0:
        return False
    return v.get("share", 0.0) < 0.5 and abs(v.get("delay_s", 0.0)) < 0.05


def stiffening(effect, experiment: Experiment) -> float:
    """What an effect that is no factor makes of a transmission's stiffness, as a factor, at its largest wind-up.

    Of a loop where it starts from rest, of a cubic spring where it is wound up most.
    """
    kind, v = effect.kind, getattr(effect, "values", {})
    if kind not in ("joint_hysteresis", "joint_cubic_stiffness"):
        return 1.0
    i = effect.target - 1
    stiffness = float(experiment.arm.stiffness[i])
    if kind == "joint_hysteresis":
        return 1.0 + v["amplitude_n_m"] / v["yield_windup_rad"] / stiffness
    return 1.0 + 3.0 * v["cubic_n_m_per_rad3"] * experiment.signals_kept[i]["most_windup"] ** 2 / stiffness


def draw_foreign(draw: np.random.Generator, experiment: Experiment, only: str | None = None) -> Foreign:
    """A law outside the library, on a joint or on a channel; of a form, on a joint, if one is asked for."""
    joints = experiment.joints
    numbers = tuple(float(x) for x in draw.uniform(0.0, 1.0, 4))
    if draw.random() < 0.15 and only is None:
        i = int(draw.integers(len(experiment.outputs)))
        place, spread = experiment.place_kept[i], experiment.spread_kept[i]
        form = str(draw.choice(SENSOR_FORMS))
        return Foreign(form, experiment.outputs[i][0], 0.05, numbers, place, spread, 1.0, experiment.duration_s)
    forms = [form for form in JOINT_FORMS if joints > 1 or form != "coupling"]
    target = int(draw.integers(1, joints + 1))
    one = experiment.signals_kept[target - 1]
    other = int(draw.choice([j for j in range(joints) if j != target - 1])) if joints > 1 else 0
    form = str(draw.choice(forms)) if only is None else only.removeprefix("outside_")
    speed = experiment.signals_kept[other]["speed"] if form == "coupling" else one["speed"]
    return Foreign(
        form, target, 0.1 * one["effort"], numbers, one["place"], one["travel"], speed, experiment.duration_s, other
    )
