"""The bench's figures: a report to read, and the same as JSON."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import asdict
from statistics import median

import scipy.stats

from .cases import LEVELS, Case
from .score import Score

# Families of single effects; each has its levels.
SINGLE_FAMILIES = ("single", "polishing", "belt", "brush", "edge")

Judged = list[tuple[str, Case, Score, float]]
"""Name of the set, what it was, the judgement, seconds."""


def interval(hits: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Clopper-Pearson interval of a share."""
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if hits == 0 else float(scipy.stats.beta.ppf(tail, hits, count - hits + 1))
    high = 1.0 if hits == count else float(scipy.stats.beta.ppf(1.0 - tail, hits + 1, count - hits))
    return low, high


def share(hits: int, count: int) -> dict:
    """Hits of so many, with the interval."""
    if count == 0:
        return {"hits": 0, "of": 0, "share": None, "low": 0.0, "high": 1.0}
    low, high = interval(hits, count)
    return {"hits": hits, "of": count, "share": hits / count, "low": low, "high": high}


def goals(judged: Judged) -> dict:
    """Each goal of the bench: what was found, the bound, whether it is met."""

    def right(*families: str) -> dict:
        of = [s.right for _, c, s, _ in judged if c.family in families]
        return share(sum(of), len(of))

    clean = [s for _, c, s, _ in judged if c.family == "clean"]
    alarms = sum(s.verdict != "nothing_beyond_noise" for s in clean)
    errors = _errors(judged)
    gains = [s.gain_ratio for _, _, s, _ in judged if s.gain_ratio is not None]
    within = sum(g <= 1.15 for g in gains)
    found = {
        "single effects at the middle level": (right("single middle"), 0.95),
        "polishing, single effects at the middle level": (right("polishing middle"), 0.95),
        "belt, single effects at the middle level": (right("belt middle"), 0.95),
        "brush, single effects at the middle level": (right("brush middle"), 0.95),
        "pairs, both named": (right("pair"), 0.80),
        "outside the library: unknown": (right("outside"), 0.90),
        "inseparable: reported as such": (right("inseparable"), 0.90),
        "held-out residual within 1.15 of the noise floor": (share(within, len(gains)), 0.90),
    }
    rows = {
        name: value | {"bound": f">= {bound:.0%}", "met": value["share"] is not None and value["share"] >= bound}
        for name, (value, bound) in found.items()
    }
    rows["false alarms on clean data"] = share(alarms, len(clean)) | {
        "bound": "<= 2%",
        "met": bool(clean) and alarms <= 0.02 * len(clean),
    }
    middle = median(errors) if errors else None
    rows["median parameter error"] = {
        "share": middle,
        "of": len(errors),
        "bound": "<= 10%",
        "met": bool(errors) and middle <= 0.10,
    }
    return rows


def _errors(judged: Judged) -> list[float]:
    return [e for _, _, s, _ in judged for kind, e in s.parameter_errors.items() if not kind.endswith(", m")]


def confusion(judged: Judged) -> dict[str, Counter]:
    """For each hidden kind, single and at the middle level or stronger, what was named first (or the verdict)."""
    found: dict[str, Counter] = defaultdict(Counter)
    for _, case, score, _ in judged:
        if case.family in [f"{family} {level}" for family in SINGLE_FAMILIES for level in ("strong", "middle")]:
            told = score.named[0] if score.verdict == "named" else score.verdict
            found[case.truth[0].name][told] += 1
    return dict(found)


def power(judged: Judged) -> dict[str, dict[str, dict]]:
    """Share of sets in which anything is found, and in which it is right, by effect over noise and kind."""
    found: dict[str, dict[str, dict]] = {}
    for level in LEVELS:
        by_kind: dict[str, list[Score]] = defaultdict(list)
        for _, case, score, _ in judged:
            if case.family in [f"{family} {level}" for family in SINGLE_FAMILIES]:
                by_kind[case.truth[0].name].append(score)
                by_kind["all"].append(score)
        found[level] = {
            kind: {
                "detected": share(
                    sum(s.verdict not in ("nothing_beyond_noise", "not_identifiable") for s in of), len(of)
                ),
                "right": share(sum(s.right for s in of), len(of)),
            }
            for kind, of in by_kind.items()
        }
    return found


def as_json(judged: Judged, seeds: str, wall_s: float) -> dict:
    """Everything."""
    return {
        "seeds": seeds,
        "wall_s": wall_s,
        "goals": goals(judged),
        "confusion": {kind: dict(row) for kind, row in confusion(judged).items()},
        "power": power(judged),
        "cases": [
            {
                "set": name,
                "family": case.family,
                "experiment": case.experiment,
                "truth": [e.as_dict() for e in case.truth],
                "level": case.level,
                "colour": case.colour,
                "seconds": seconds,
                **asdict(score),
            }
            for name, case, score, seconds in judged
        ],
    }


def as_markdown(judged: Judged, seeds: str, wall_s: float) -> str:
    """The report to read."""
    seconds = sorted(s for *_, s in judged)
    lines = [
        "# Hidden effects",
        "",
        f"{len(judged)} data sets from MuJoCo, seeds `{seeds}`, {wall_s / 60.0:.1f} min. One diagnosis takes "
        f"{median(seconds):.2f} s (median), {seconds[-1]:.2f} s at most.",
        "",
        "| goal | found | 95 % interval | bound | met |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, row in goals(judged).items():
        if row["share"] is None:
            lines.append(f"| {name} | no sets | | {row['bound']} | no |")
            continue
        among = f"{row['hits']} of {row['of']} = {row['share']:.1%}" if "hits" in row else f"{row['share']:.1%}"
        spread = f"{row['low']:.1%} to {row['high']:.1%}" if "low" in row else ""
        lines.append(f"| {name} | {among} | {spread} | {row['bound']} | {'yes' if row['met'] else 'no'} |")
    floors = [s.floor_ratio for _, _, s, _ in judged if s.floor_ratio is not None]
    if floors:
        lines += [
            "",
            f"The noise floor that is reported is {median(floors):.2f} times the noise that was added (median).",
        ]
    lines += ["", "## By family", "", "| family | right | verdicts |", "| --- | --- | --- |"]
    for family in dict.fromkeys(c.family for _, c, _, _ in judged):
        of = [s for _, c, s, _ in judged if c.family == family]
        verdicts = ", ".join(f"{v} {n}" for v, n in Counter(s.verdict for s in of).most_common())
        lines.append(f"| {family} | {sum(s.right for s in of)} of {len(of)} | {verdicts} |")
    lines += _confusion_lines(judged) + _power_lines(judged) + _error_lines(judged) + _wrong_lines(judged)
    return "\n".join(lines) + "\n"


def _confusion_lines(judged: Judged) -> list[str]:
    lines = [
        "",
        "## What was named",
        "",
        "Single effects, middle and strong.",
        "",
        "| hidden | named first, or verdict |",
        "| --- | --- |",
    ]
    for kind, row in sorted(confusion(judged).items()):
        lines.append(f"| {kind} | {', '.join(f'{told} {n}' for told, n in row.most_common())} |")
    return lines


def _power_lines(judged: Judged) -> list[str]:
    table = power(judged)
    heads = " | ".join(f"{level} ({ratio:g})" for level, ratio in LEVELS.items())
    lines = ["", "## Detection power", "", "Detected / right, by effect over noise.", "", f"| hidden | {heads} |"]
    lines.append("| --- |" + " --- |" * len(LEVELS))
    for kind in sorted({k for row in table.values() for k in row}, key=lambda k: (k == "all", k)):
        cells = []
        for level in LEVELS:
            cell = table[level].get(kind)
            cells.append(
                f"{cell['detected']['hits']} / {cell['right']['hits']} of {cell['right']['of']}" if cell else ""
            )
        lines.append(f"| {kind} | {' | '.join(cells)} |")
    return lines


def _error_lines(judged: Judged) -> list[str]:
    by_kind: dict[str, list[float]] = defaultdict(list)
    for _, _, score, _ in judged:
        for kind, error in score.parameter_errors.items():
            by_kind[kind].append(error)
    lines = ["", "## Errors of estimates", "", "| effect | median | worst | sets |", "| --- | --- | --- | --- |"]
    for kind, errors in sorted(by_kind.items()):
        text = [f"{e * 1e3:.3g} mm" if kind.endswith(", m") else f"{e:.1%}" for e in (median(errors), max(errors))]
        lines.append(f"| {kind.removesuffix(', m')} | {text[0]} | {text[1]} | {len(errors)} |")
    return lines


def _wrong_lines(judged: Judged) -> list[str]:
    lines = ["", "## Not right", "", "| set | family | hidden | answer |", "| --- | --- | --- | --- |"]
    for name, case, score, _ in judged:
        if not score.right and not case.family.endswith(" weak"):
            hidden = " + ".join(e.name for e in case.truth) or "nothing"
            lines.append(f"| {name} | {case.family}, {case.colour} | {hidden} | {score.reason} |")
    return lines
