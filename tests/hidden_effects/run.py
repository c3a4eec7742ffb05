#!/usr/bin/env python3
"""The hidden-effects bench: `python tests/hidden_effects/run.py [--fast | --whole] [--seeds report | tune | N]`.

Makes measurements in MuJoCo with something hidden in them, asks `truecut diagnose` about each, and writes how often it
was right to `out/hidden_effects/` (report.md, report.json). Exit code 0 if every goal is met, 1 if not. The fast part
is too small for the goals; it ends with 0 if every answer is right.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, report, runner  # noqa: E402
from bench.cases import SEEDS, all_cases, base_of, fast_cases  # noqa: E402


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--fast", action="store_true", help="a dozen sets, one for each kind of answer (default)")
    size.add_argument("--whole", action="store_true", help="all sets")
    parser.add_argument("--family", action="append", default=[], help="of the whole bench, only this family")
    parser.add_argument("--every", type=int, default=1, help="of the whole bench, only every n-th set")
    parser.add_argument("--jobs", type=int, default=2, help="diagnoses at once")
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "truecut"), help="truecut, or a command")
    known = " or ".join(SEEDS)
    parser.add_argument("--seeds", default="report", help=f"{known} (thresholds are tuned on others), or a number")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "hidden_effects")
    parser.add_argument("--generate-only", action="store_true", help="write the data and stop")
    options = parser.parse_args(arguments)
    if options.seeds not in SEEDS and not options.seeds.isdigit():
        parser.error(f"--seeds {options.seeds} is neither {known} nor a number")
    began = time.perf_counter()
    whole = options.whole or bool(options.family)
    cases = all_cases(options.seeds) if whole else fast_cases(options.seeds)
    if options.family:
        cases = [case for case in cases if case.family in options.family]
        if not cases:
            parser.error(f"no family is called {' or '.join(options.family)}")
    if whole and options.every > 1:
        cases = cases[:: options.every]
    work = ROOT / "target" / "hidden_effects" / (options.seeds if whole else f"{options.seeds}_fast")
    sets = runner.write_all(cases, work, base_of(options.seeds), options.jobs)
    print(f"{len(sets)} sets in {work}, {time.perf_counter() - began:.0f} s", flush=True)
    if options.generate_only:
        return 0
    answers = runner.diagnose_all(shlex.split(options.program), sets, work, options.jobs)
    judged = runner.judge_all(sets, answers, work, options.jobs)
    wall_s = time.perf_counter() - began
    options.out.mkdir(parents=True, exist_ok=True)
    text = report.as_markdown(judged, options.seeds, wall_s)
    (options.out / "report.md").write_text(text, encoding="utf-8")
    found = report.as_json(judged, options.seeds, wall_s)
    (options.out / "report.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    print(text.partition("## What was named")[0])
    print(options.out / "report.md")
    if options.whole:  # of a part, too, the goals are judged; its intervals are wider
        return 0 if all(row["met"] for row in found["goals"].values()) else 1
    return 0 if all(score.right for _, _, score, _ in judged) else 1


if __name__ == "__main__":
    sys.exit(main())
