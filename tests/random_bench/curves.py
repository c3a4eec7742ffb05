#!/usr/bin/env python3
"""How often a law without a name is shown as a curve: `python tests/random_bench/curves.py --seed N --sets 40` hides a law
outside the library in one joint of each drawn arm, whose measurement MuJoCo or its inverse dynamics make, and asks
`truecut diagnose`. Told are the joint and what the law follows, whether the truth lies in the curve's band, place by place,
and what the extended model leaves on data that nothing was fitted to, over the true noise.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from drawn import ROOT  # noqa: E402
from drawn.case import Case, draw_case  # noqa: E402
from drawn.judge import ask, interval  # noqa: E402

PROGRAM = str(ROOT / "target" / "release" / "truecut")
# a machine that does other things besides is no reason for a refusal
TIME_LIMIT_S = 600.0
FORMS = {
    "powered_drag": "joint_friction_by_speed",
    "place_friction": "joint_friction_by_position",
    "hard_spot": "joint_friction_by_position",
    "cogging": "joint_position_curve",
}


@dataclass
class Shown:
    """What became of one law."""

    seed: int
    form: str
    joint: int
    verdict: str
    kind: str | None = None
    right: bool = False
    """The joint, and what the law follows."""
    inside: int = 0
    """Places at which the truth lies in the band."""
    places: int = 0
    left: float = np.inf
    """Error on held-out data over the true noise, in the channel where it is largest."""
    left_nominal: float = np.inf
    seconds: float = 0.0


def truth(case: Case, kind: str, x: np.ndarray) -> np.ndarray:
    """The law where a curve is told."""
    law = case.truth[0]
    if kind == "joint_position_curve":
        return np.array([law.torque(0.0, q, 0.0, 0.0) for q in x])
    if kind == "joint_friction_by_position":
        return np.array([-law.torque(0.0, q, law.speed, 0.0) for q in x])
    return np.array([-law.torque(0.0, law.place, v, 0.0) for v in x])


def visited(case: Case, kind: str, x: np.ndarray) -> np.ndarray:
    """Places that the motion passes: between its 2 % and 98 % quantiles."""
    law = case.truth[0]
    signals = case.experiment.motion_of(law.target)
    of = np.abs(signals[1]) if kind == "joint_friction_by_speed" else signals[0]
    low, high = np.quantile(of, [0.02, 0.98])
    return (x >= low) & (x <= high)


def one(seed: int, mode: str, form: str, folder: Path, program: list[str], threads: int = 1) -> Shown:
    """Draws, asks, judges."""
    mujoco.set_mju_user_warning(lambda _message: None)
    case = draw_case(seed, mode, "outside", folder, f"outside_{form}")
    answer = ask(program, case, threads, TIME_LIMIT_S)
    found = Shown(seed, form, case.truth[0].target, "refused", seconds=answer.seconds)
    if answer.diagnosis is None:
        return found
    found.verdict = answer.diagnosis["verdict"]
    errors = answer.diagnosis["channels"]
    over = {name: (e["after"] / case.floor_rms[name], e["before"] / case.floor_rms[name]) for name, e in errors.items()}
    found.left, found.left_nominal = max(a for a, _ in over.values()), max(b for _, b in over.values())
    curve = answer.diagnosis["curve"]
    if curve is None:
        return found
    found.kind = curve["kind"]
    found.right = curve["kind"] == FORMS[form] and curve["target"] == f"joint{found.joint}"
    if found.right:
        x = np.array(curve["x"])
        low, high = (np.array([np.nan if v is None else v for v in curve[end]]) for end in ("low", "high"))
        kept = visited(case, curve["kind"], x)
        law = truth(case, curve["kind"], x)
        found.places = int(kept.sum())
        found.inside = int(((law >= low) & (law <= high) & kept).sum())
    return found


def table(all_found: list[Shown]) -> str:
    """Rates with exact 95 % intervals."""
    rows = ["| law | shown | held-out error <= 1.3 x noise | places in the band |", "| --- | --- | --- | --- |"]
    for form in [*FORMS, "all"]:
        own = [f for f in all_found if form in ("all", f.form)]
        if not own:
            continue
        shown = [f for f in own if f.right]
        explained = sum(f.left <= 1.3 for f in own)
        inside, places = sum(f.inside for f in shown), sum(f.places for f in shown)
        low, high = interval(len(shown), len(own))
        lowest, highest = interval(explained, len(own))
        rows.append(
            f"| {form} | {len(shown)} of {len(own)} [{100 * low:.0f}, {100 * high:.0f}] % "
            f"| {explained} of {len(own)} [{100 * lowest:.0f}, {100 * highest:.0f}] % "
            f"| {inside} of {places} = {100 * inside / max(places, 1):.0f} % |"
        )
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True, help="first seed")
    parser.add_argument("--sets", type=int, default=40, help="number of laws")
    parser.add_argument("--mode", choices=["inverse", "forward", "load"], default="inverse")
    parser.add_argument("--program", default=PROGRAM, help="truecut")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "curves", help="folder for the sets")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    forms = list(FORMS)
    with ProcessPoolExecutor(2) as pool:
        jobs = [
            pool.submit(
                one,
                arguments.seed + i,
                arguments.mode,
                forms[i % len(forms)],
                arguments.out / f"{arguments.mode}_{arguments.seed + i}",
                [arguments.program],
            )
            for i in range(arguments.sets)
        ]
        found = []
        for job in jobs:
            try:
                found.append(job.result())
                print(asdict(found[-1]), flush=True)
            except Exception as error:  # a set that cannot be drawn says nothing of the program
                print(f"not drawn: {error}", flush=True)
    print(table(found))


if __name__ == "__main__":
    main()
