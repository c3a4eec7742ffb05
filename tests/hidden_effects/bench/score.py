"""Whether an answer is right.

A single effect is right when it is named first, or stands in an ambiguous set of which every other member, as the
program sized it, leaves a trace within 10 degrees of the truth's in the generator's own simulation, or is not told from
the truth by an oracle at odds of 20 to 1.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from .cases import Case
from .effects import KINDS, OUTSIDE, Effect
from .experiment import ALL
from .oracle import Oracle
from .signature import angle_deg

SAME_TRACE_DEG = 10.0
BAD_INPUT = 2
# Odds of 20 to 1, as a difference of minus twice the log-likelihood.
DECISIVE = 6.0
# Parameters of joints that slide, as the generator calls them on any joint.
ON_SLIDES = {
    "viscous_n_s_per_m": "viscous_n_m_s_per_rad",
    "viscous_positive_n_s_per_m": "viscous_positive_n_m_s_per_rad",
    "viscous_negative_n_s_per_m": "viscous_negative_n_m_s_per_rad",
    "friction_n": "friction_n_m",
    "friction_positive_n": "friction_positive_n_m",
    "friction_negative_n": "friction_negative_n_m",
    "excess_n": "excess_n_m",
    "speed_m_per_s": "speed_rad_per_s",
    "gap_m": "gap_rad",
    "amplitude_n": "amplitude_n_m",
    "yield_windup_m": "yield_windup_rad",
    "cubic_n_per_m3": "cubic_n_m_per_rad3",
    "cosine_m": "cosine_rad",
    "sine_m": "sine_rad",
    "offset_m": "offset_rad",
    "cosine_n": "cosine_n_m",
    "sine_n": "sine_n_m",
    "force_n": "force_n_m",
}
VERDICTS = ("nothing_beyond_noise", "named", "ambiguous", "unknown_cause", "not_identifiable", "fit_failed")


@dataclass
class Answer:
    """What the program said: its exit code, `diagnosis.json` if it wrote one, its messages, and how long it took."""

    code: int
    diagnosis: dict | None
    messages: str
    seconds: float

    @property
    def verdict(self) -> str:
        """The verdict, or how the program ended without one."""
        if self.diagnosis is not None:
            return self.diagnosis["verdict"]
        return "refused" if self.code == BAD_INPUT else f"exit {self.code}"

    @property
    def causes(self) -> list[dict]:
        """Causes in order."""
        return self.diagnosis["causes"] if self.diagnosis else []

    @property
    def members(self) -> list[dict]:
        """All explanations that are put forward: causes and alternatives."""
        others = self.diagnosis.get("alternatives", []) if self.diagnosis else []
        flat = []
        for other in others:
            flat += other["causes"] if "causes" in other else [other]
        return self.causes + flat

    @property
    def contradicts_itself(self) -> bool:
        """Whether causes are named although the next best explanation is likelier by odds of more than 20 to 1, and not
        the same with more parameters: a law that holds the one named as its limit lies on its trace."""
        next_best = (self.diagnosis or {}).get("runner_up")
        if self.verdict != "named" or next_best is None or next_best["angle_deg"] < SAME_TRACE_DEG:
            return False
        return next_best["criterion_difference"] < -DECISIVE


@dataclass
class Score:
    """The judgement of one answer."""

    right: bool
    reason: str
    verdict: str
    named: list[str]
    parameter_errors: dict[str, float] = field(default_factory=dict)
    gain_ratio: float | None = None
    """Held-out residual after extension over the errors that the measurement really has there, in the worst channel."""
    floor_ratio: float | None = None
    """The program's noise floor over the noise that was really added, in the channel where they differ most."""
    unexplained: float | None = None


def target_of(cause: dict) -> int | str | None:
    """Target as the generator writes it: a joint's number, an axis, a channel, or None."""
    target = cause.get("target")
    if isinstance(target, dict):
        target = next(iter(target.values()), None)
    if isinstance(target, str):
        for word in ("joint ", "axis ", "channel "):
            target = target.removeprefix(word)
        target = target.strip("`\"'")
        if target in ("", "whole"):
            return None
        joint = re.fullmatch(r"(?:joint)?(\d+)", target)
        return int(joint[1]) if joint else target
    return target


def name_of(cause: dict) -> str:
    """Kind and target."""
    target = target_of(cause)
    return cause["kind"] if target is None else f"{cause['kind']} {target}"


def is_cause(cause: dict, effect: Effect) -> bool:
    """Whether a cause is this effect."""
    return cause["kind"] == effect.kind and target_of(cause) == effect.target


def sized(cause: dict) -> Effect | None:
    """A cause as an effect of the generator; None if a parameter is missing or the kind is unknown."""
    if cause["kind"] not in KINDS:
        return None
    sizes, shapes = KINDS[cause["kind"]]
    values = {key: entry["value"] for key, entry in cause.get("parameters", {}).items()}
    if cause["kind"].startswith("joint_"):
        if "cosine_m" in values:
            values["cycles"] *= 2.0 * math.pi  # per metre; the generator's are radians per metre
        values = {ON_SLIDES.get(key, key): value for key, value in values.items()}
    if set(values) != {*sizes, *shapes}:
        return None
    return Effect(cause["kind"], target_of(cause), values)


def same_trace(case: Case, cause: dict) -> bool:
    """Whether the generator finds a cause, as sized by the program, within 10 degrees of the truth."""
    effect = sized(cause)
    if effect is None:
        return False
    try:
        return angle_deg(ALL[case.experiment], case.truth, (effect,)) <= SAME_TRACE_DEG
    except (RuntimeError, ValueError, KeyError, FloatingPointError):
        return False  # a size that the generator cannot simulate leaves no trace to compare


def told_apart(case: Case, causes: list[dict]) -> list[dict]:
    """Those causes, as sized by the program, that one who knows the noise's spectrum tells from the truth."""
    if not causes or case.damage:
        return causes
    oracle = Oracle(case)

    def is_told(cause: dict) -> bool:
        effect = sized(cause)
        try:
            return effect is None or oracle.tells((effect,))
        except (RuntimeError, ValueError, KeyError, FloatingPointError):
            return True  # what the generator cannot simulate is no explanation

    return [cause for cause in causes if is_told(cause)]


def _ambiguous(case: Case, answer: Answer) -> tuple[bool, str]:
    truth = case.truth[0]
    if not any(is_cause(cause, truth) for cause in answer.members):
        return False, f"{truth.name} is not among the alternatives"
    others = [cause for cause in answer.members if not is_cause(cause, truth)]
    if not others:
        return False, "ambiguous between nothing"
    apart = told_apart(case, [cause for cause in others if not same_trace(case, cause)])
    told = ", ".join(name_of(cause) for cause in apart)
    return (False, f"the generator tells {told} from {truth.name}") if apart else (True, "not told apart")


def judge(case: Case, answer: Answer) -> tuple[bool, str]:
    """Whether the answer is right, and why."""
    verdict, causes = answer.verdict, answer.causes
    if answer.contradicts_itself:
        return False, "named beside a likelier next best"
    if case.expected == "refused":
        return verdict == "refused", f"{verdict}, expected exit code 2"
    if case.expected == "nothing":
        return verdict == "nothing_beyond_noise", verdict
    if case.expected == "unknown":
        return verdict == "unknown_cause", verdict
    if case.expected == "not_identifiable":
        # a column that does not move at all may be refused as well
        fine = verdict == "not_identifiable" or (case.still == 0.0 and verdict == "refused")
        return fine, verdict
    if case.expected == "not_named":
        return verdict in ("nothing_beyond_noise", "unknown_cause"), verdict
    if case.expected == "ambiguous":
        return _ambiguous(case, answer) if verdict == "ambiguous" else (False, f"{verdict}, not ambiguous")
    if case.expected == "pair":
        missing = [e.name for e in case.truth if not any(is_cause(c, e) for c in causes)]
        if verdict != "named":
            return False, verdict
        return not missing, f"missing: {', '.join(missing)}" if missing else "both named"
    assert case.expected == "named"
    if verdict == "named":
        return is_cause(causes[0], case.truth[0]), f"named {name_of(causes[0])}"
    if verdict == "ambiguous":
        return _ambiguous(case, answer)
    return False, verdict


def parameter_errors(case: Case, answer: Answer) -> dict[str, float]:
    """Relative error of each named effect's size. Two components of one thing count as one vector."""
    found = {}
    for effect in case.truth:
        cause = next((c for c in answer.causes if is_cause(c, effect)), None)
        if cause is None or effect.kind in OUTSIDE:
            continue
        true, neutral = effect.sizes, KINDS[effect.kind][0]
        told = cause["parameters"]
        gaps = [told[key]["value"] - neutral[key] - size if key in told else -size for key, size in true.items()]
        found[effect.kind] = math.hypot(*gaps) / math.hypot(*true.values())
        if effect.kind == "payload":
            centre = [key for key in effect.values if key.startswith("center")]
            apart = [told[key]["value"] - effect.values[key] if key in told else math.inf for key in centre]
            found["payload centre, m"] = math.hypot(*apart)
    return found


def score(case: Case, answer: Answer, label: dict) -> Score:
    """Judges one answer. Of the label: the noise added to each channel, and the errors of the measurement in its last part, SI."""
    right, reason = judge(case, answer)
    found = Score(right, reason, answer.verdict, [name_of(cause) for cause in answer.causes])
    if answer.verdict == "named":
        channels = answer.diagnosis["channels"]
        told = {n: c for n, c in channels.items() if c.get("after") is not None and c.get("noise_floor")}
        truly = label["floor_rms"]
        found.gain_ratio = max((c["after"] / truly[n] for n, c in told.items() if truly.get(n)), default=None)
        floors = [c["noise_floor"] / truly[n] for n, c in told.items() if truly.get(n)]
        found.floor_ratio = max(floors, key=lambda ratio: abs(math.log(ratio)), default=None)
        if right:
            found.parameter_errors = parameter_errors(case, answer)
    if answer.diagnosis:
        found.unexplained = answer.diagnosis.get("unexplained_fraction")
    return found
