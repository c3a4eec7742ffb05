#!/usr/bin/env python3
"""Diagnosis of wheels with grains at an edge, drawn at random: `python tests/hidden_effects/drawn_wheels.py [--wheels N] [--seed S]`.

Each wheel gives a clean set and sets with grains at two levels, in white and in autoregressive noise. Beside every answer
stands by how much the data favour the grains over each rival, which no search can better. Writes a CSV file.
"""

from __future__ import annotations

import argparse
import csv
import shlex
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, drawn_wheels, report, runner  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheels", type=int, default=12)
    parser.add_argument("--seed", type=int, default=60_000, help="of the first wheel")
    parser.add_argument("--eccentricity", type=float, help="over the indentation; else drawn")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=runner.TIME_LIMIT_S, help="longest diagnosis, s")
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "truecut"))
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "drawn_wheels")
    options = parser.parse_args(arguments)
    runner.TIME_LIMIT_S = options.limit
    folder = ROOT / "target" / "hidden_effects" / "scenarios"
    seeds = range(options.seed, options.seed + options.wheels)
    machines = {seed: drawn_wheels.draw(seed, folder, options.eccentricity) for seed in seeds}
    cases = [case for seed, machine in machines.items() for case in drawn_wheels.cases_of(machine, seed)]
    work = ROOT / "target" / "hidden_effects" / f"drawn_wheels_{options.seed}_{options.eccentricity}"
    sets = runner.write_all(cases, work, options.seed, 1)
    answers = runner.diagnose_all(shlex.split(options.program), sets, work, options.jobs)
    judged = runner.judge_all(sets, answers, work, 1)
    by_name = {machine.experiment.name: machine for machine in machines.values()}
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / f"answers_{options.seed}.csv", "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["set", "family", "wheel", "right", "verdict", "members", "reason", "errors", "energy", "beyond", "seconds"])
        for name, case, score, seconds in sorted(judged, key=lambda row: (row[1].family, row[1].experiment)):
            energy, beyond = 0.0, {}
            if case.level is not None:
                energy, beyond = drawn_wheels.energies(by_name[case.experiment], case.colour, case.level)
            members = "; ".join(f"{m['kind']} {m.get('target') or ''}".strip() for m in answers[name].members)
            row = [name, case.family, case.experiment, score.right, score.verdict, members, score.reason]
            least = {kind: round(value, 1) for kind, value in beyond.items()}
            errors = {kind: round(error, 3) for kind, error in score.parameter_errors.items()}
            rows.writerow([*row, errors, round(energy, 1), least, f"{seconds:.1f}"])
    for family in sorted({case.family for case in cases}):
        hits = [score.right for _, case, score, _ in judged if case.family == family]
        low, high = report.interval(sum(hits), len(hits))
        print(f"{family}: right {sum(hits)} of {len(hits)}, 95 % interval {low:.1%} to {high:.1%}")
    return 0 if all(score.right for _, _, score, _ in judged) else 1


if __name__ == "__main__":
    sys.exit(main())
