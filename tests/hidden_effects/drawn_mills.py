#!/usr/bin/env python3
"""Diagnosis of milling machines drawn at random: `python tests/hidden_effects/drawn_mills.py [--machines N] [--seed S]`.

Each machine gives clean sets, and sets with a mode of the tool and (slow ones) with worn flanks, at two levels each. Prints how
often the answer is right, with 95 % intervals, and writes every answer to a CSV file.
"""

from __future__ import annotations

import argparse
import csv
import shlex
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, drawn_mills, report, runner  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=12)
    parser.add_argument("--seed", type=int, default=50_000, help="of the first machine")
    parser.add_argument("--clean", type=int, default=3, help="clean sets of a machine")
    parser.add_argument("--fast", action="store_true", help="machines with a spindle's tool, sampled at 10 kHz")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=runner.TIME_LIMIT_S, help="longest diagnosis, s")
    parser.add_argument("--family", action="append", default=[], help="only families whose names hold this")
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "truecut"))
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "drawn_mills")
    options = parser.parse_args(arguments)
    runner.TIME_LIMIT_S = options.limit
    sort = "fast" if options.fast else "slow"
    work = ROOT / "target" / "hidden_effects" / f"drawn_mills_{sort}_{options.seed}"
    seeds = range(options.seed, options.seed + options.machines)
    with ProcessPoolExecutor(options.jobs) as pool:
        folder = ROOT / "target" / "hidden_effects" / "scenarios"
        machines = list(pool.map(drawn_mills.draw, seeds, [folder] * len(seeds), [options.fast] * len(seeds)))
    cases = []
    for seed, machine in zip(seeds, machines):
        cases += drawn_mills.cases_of(machine, seed, options.clean)
    if options.family:
        cases = [case for case in cases if any(part in case.family for part in options.family)]
    sets = runner.write_all(cases, work, options.seed, options.jobs)
    answers = runner.diagnose_all(shlex.split(options.program), sets, work, options.jobs)
    judged = runner.judge_all(sets, answers, work, options.jobs)
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / f"answers_{sort}_{options.seed}.csv", "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["set", "family", "machine", "noise", "right", "verdict", "named", "reason", "errors", "seconds"])
        for name, case, score, seconds in sorted(judged, key=lambda row: (row[1].family, row[1].experiment)):
            errors = {kind: round(error, 3) for kind, error in score.parameter_errors.items()}
            row = [name, case.family, case.experiment, case.colour, score.right, score.verdict]
            rows.writerow([*row, "; ".join(score.named), score.reason, errors, f"{seconds:.1f}"])
    for family in sorted({case.family for case in cases}):
        hits = [score.right for _, case, score, _ in judged if case.family == family]
        low, high = report.interval(sum(hits), len(hits))
        print(f"{family}: right {sum(hits)} of {len(hits)}, 95 % interval {low:.1%} to {high:.1%}")
    seconds = sorted(seconds for *_, seconds in judged)
    print(f"seconds: median {seconds[len(seconds) // 2]:.1f}, at most {seconds[-1]:.1f}")
    return 0 if all(score.right for _, _, score, _ in judged) else 1


if __name__ == "__main__":
    sys.exit(main())
