"""Whether an answer is right, and figures of many answers."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import asdict, dataclass, field

from bench import runner
from bench.effects import KINDS
from bench.score import Answer, is_cause, name_of
from scipy.stats import beta

from .case import Case
from .oracle import Label

MOST_ALTERNATIVES = 3
# how many of its Cramér-Rao deviations a friction of an arm whose joints all rub must have to count
SURE = 6.0
FRICTIONS = ("joint_viscous", "joint_coulomb")


@dataclass
class Verdict:
    """One set and its answer, as it is logged."""

    seed: int
    mode: str
    family: str
    joints: int
    truth: list[str]
    levels: list[float]
    colour: str
    nuisances: list[str]
    detectable: bool
    separable: bool
    evidence: float
    rivals: list[str]
    told: str
    named: list[str]
    right: bool
    counts: bool
    """Whether it counts in its family: the oracle can tell the truth from all others."""
    extra: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    alternatives: int = 0
    inside: list[bool] = field(default_factory=list)
    floors: list[float] = field(default_factory=list)
    sources: list[str] = field(default_factory=list)
    frictions: list[int] = field(default_factory=lambda: [0, 0])
    seconds: float = 0.0

    def as_dict(self) -> dict:
        """For the log."""
        return asdict(self)


def ask(program: list[str], case: Case, threads: int, limit_s: float = runner.TIME_LIMIT_S) -> Answer:
    """One diagnosis."""
    return runner.ask(program, case.scenario, case.data, case.scenario.parent / "answer", threads, limit_s)


def judge(case: Case, label: Label, answer: Answer) -> Verdict:
    """The judgement."""
    known = [e for e in case.truth if e.kind in KINDS]
    missing = [e.name for e in known if not any(is_cause(c, e) for c in answer.causes)]
    extra = [name_of(c) for c in answer.causes if not any(is_cause(c, e) for e in known)]
    found = Verdict(
        case.seed,
        case.mode,
        case.family,
        case.experiment.joints,
        [e.name for e in case.truth],
        [round(x, 2) for x in case.levels],
        case.noise[0].colour,
        case.nuisances,
        label.detectable,
        label.separable,
        round(label.evidence, 1),
        label.rivals,
        answer.verdict,
        [name_of(c) for c in answer.causes],
        _is_right(case, label, answer, known, missing, extra),
        label.separable if case.truth else True,
        extra,
        missing,
        seconds=round(answer.seconds, 2),
    )
    if answer.diagnosis is not None:
        found.alternatives = len(answer.diagnosis.get("alternatives") or []) if answer.verdict == "ambiguous" else 0
        _figures(case, label, answer, known, found)
    return found


def _is_right(case: Case, label: Label, answer: Answer, known, missing, extra) -> bool:
    verdict = answer.verdict
    if answer.contradicts_itself:
        return False
    if case.family == "clean":
        return verdict == "nothing_beyond_noise"
    if case.family == "outside":
        return verdict == "unknown_cause"
    if case.family == "all joints":
        sure = [e.name for e in known if _is_sure(e, label)]
        seen = sum(name not in missing for name in sure)
        return seen >= 0.9 * len(sure) and not extra
    if verdict == "named" and label.separable:
        return not missing and not extra
    if verdict == "ambiguous":
        members = answer.members
        listed = all(any(is_cause(c, e) for c in members) for e in known)
        return listed and len(answer.diagnosis.get("alternatives") or []) < MOST_ALTERNATIVES
    return not label.detectable and verdict == "nothing_beyond_noise"


def _is_sure(effect, label: Label) -> bool:
    """Whether a friction stands out of what noise does to it, at best."""
    if effect.kind not in FRICTIONS:
        return False
    (key, size), *_ = effect.sizes.items()
    return abs(size) >= SURE * label.deviations[f"{effect.name} {key}"]


def _figures(case: Case, label: Label, answer: Answer, known, found: Verdict) -> None:
    """Coverage of intervals, floor over truth, frictions named."""
    for effect in known:
        cause = next((c for c in answer.causes if is_cause(c, effect)), None)
        if cause is None:
            continue
        for key, true in effect.values.items():
            told = cause.get("parameters", {}).get(key)
            if told is not None and told.get("low") is not None and told.get("high") is not None:
                found.inside.append(bool(told["low"] <= true <= told["high"]))
    for name, channel in answer.diagnosis["channels"].items():
        truth, floor = case.floor_rms.get(name), channel.get("noise_floor")
        if truth and floor:
            found.floors.append(round(floor / truth, 4))
            found.sources.append(str(channel.get("noise_source") or ""))
    if case.family == "all joints":
        sure = [e.name for e in known if _is_sure(e, label)]
        found.frictions = [sum(name not in found.missing for name in sure), len(sure)]


def interval(hits: int, count: int) -> tuple[float, float]:
    """Clopper and Pearson's 95 % interval of a share."""
    low = float(beta.ppf(0.025, hits, count - hits + 1)) if hits else 0.0
    high = float(beta.ppf(0.975, hits + 1, count - hits)) if hits < count else 1.0
    return low, high


def share(hits: int, count: int) -> str:
    """As in a table."""
    if not count:
        return "0 of 0"
    low, high = interval(hits, count)
    return f"{hits} of {count} = {100.0 * hits / count:.0f} % ({100.0 * low:.0f} to {100.0 * high:.0f})"


def summary(verdicts: list[dict]) -> dict:
    """Counts of a report, for the log and for the table."""
    rows = {}
    for mode in sorted({v["mode"] for v in verdicts}):
        for family in dict.fromkeys(v["family"] for v in verdicts):
            mine = [v for v in verdicts if (v["mode"], v["family"]) == (mode, family)]
            counted = [v for v in mine if v["counts"]]
            unclear = [v for v in mine if not v["counts"]]
            if mine:
                rows[f"{mode}, {family}"] = {
                    "right": sum(v["right"] for v in counted),
                    "of": len(counted),
                    "interval": interval(sum(v["right"] for v in counted), len(counted)) if counted else None,
                    "inseparable right": sum(v["right"] for v in unclear),
                    "inseparable": len(unclear),
                }
    inside = [x for v in verdicts for x in v["inside"]]
    pairs = [pair for v in verdicts for pair in zip(v["floors"], v["sources"], strict=True)]
    floors = sorted(x for x, source in pairs if source != "bound")
    bounds = [x for x, source in pairs if source == "bound"]
    quantile = lambda part: floors[min(int(part * len(floors)), len(floors) - 1)] if floors else math.nan  # noqa: E731
    lists = [v["alternatives"] + 1 for v in verdicts if v["told"] == "ambiguous"]
    return {
        "sets": len(verdicts),
        "rows": rows,
        "frictions": [sum(v["frictions"][i] for v in verdicts) for i in range(2)],
        "intervals": [sum(inside), len(inside)],
        "floor within 0.8 to 1.3": [sum(0.8 <= x <= 1.3 for x in floors), len(floors)],
        "bound above 0.9": [sum(x >= 0.9 for x in bounds), len(bounds)],
        "floor over truth, 5, 50, 95 %": [quantile(p) for p in (0.05, 0.5, 0.95)],
        "mean length of lists": sum(lists) / len(lists) if lists else None,
        "median seconds": sorted(v["seconds"] for v in verdicts)[len(verdicts) // 2] if verdicts else None,
        "confusions": confusions(verdicts),
    }


def confusions(verdicts: list[dict]) -> dict[str, int]:
    """What was hidden and what was told instead, of sets that count; without targets."""
    kinds = lambda names: " + ".join(sorted(name.split(" ")[0] for name in names)) or "nothing"  # noqa: E731
    wrong = (v for v in verdicts if v["counts"] and not v["right"] and v["family"] != "all joints")
    found = Counter(f"{v['mode']}: {kinds(v['truth'])} -> {v['told']}: {kinds(v['named'])}" for v in wrong)
    return dict(found.most_common())


def markdown(found: dict) -> str:
    """The table."""
    lines = ["| | right | 95 % interval | not separable: right |", "| --- | --- | --- | --- |"]
    for name, row in found["rows"].items():
        told = share(row["right"], row["of"])
        text, _, between = told.partition(" (")
        lines.append(f"| {name} | {text} | {between.rstrip(')')} | {row['inseparable right']} of {row['inseparable']} |")
    lines += [
        "",
        f"frictions of all-joint sets that are 6 deviations large: {share(*found['frictions'])} named",
        f"95 % intervals that hold the truth: {share(*found['intervals'])}",
        f"noise floor 0.8 to 1.3 of the truth: {share(*found['floor within 0.8 to 1.3'])}; 5, 50, 95 %: "
        + ", ".join(f"{x:.2f}" for x in found["floor over truth, 5, 50, 95 %"]),
        f"noise known to a bound alone, which is at least 0.9 of the truth: {share(*found['bound above 0.9'])}",
        f"sets {found['sets']}, median time of an answer {found['median seconds']} s, mean length of a list "
        f"{found['mean length of lists']}",
        "",
        *(f"- {count} x {text}" for text, count in found["confusions"].items()),
    ]
    return "\n".join(lines) + "\n"
