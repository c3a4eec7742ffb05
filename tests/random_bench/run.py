#!/usr/bin/env python3
"""The random bench: `python tests/random_bench/run.py --report` draws experiments that nobody has seen, asks
`truecut diagnose` about each, and says how often it was right.

Seeds of a report come from the hash of the commit, so that nothing can be tuned to them; every report is added to
`tests/random_bench/reports.jsonl`. `--seed N` draws others, to look at; these are not logged there.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shlex
import shutil
import subprocess
import sys
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import mujoco

sys.path.insert(0, str(Path(__file__).resolve().parent))

from drawn import ROOT  # noqa: E402
from drawn.case import FAMILIES, draw_case  # noqa: E402
from drawn.experiment import MODES  # noqa: E402
from drawn.judge import ask, judge, markdown, summary  # noqa: E402
from drawn.oracle import Oracle  # noqa: E402

LOG = Path(__file__).resolve().parent / "reports.jsonl"
PROGRAM = str(ROOT / "target" / "release" / "truecut")
# of twelve sets in a mode
SHARES = {"clean": 3, "strong": 2, "middle": 2, "pair": 2, "outside": 2, "all joints": 1}


def git(*words: str) -> str:
    """What git says."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def seed_of_commit(commit: str) -> int:
    """The first seed of a report on this commit."""
    return int(hashlib.sha256(f"random bench {commit}".encode()).hexdigest()[:8], 16)


def plan(first: int, count: int, modes: list[str], families: list[str]) -> list[tuple[int, str, str]]:
    """Seeds with modes and families, in turns."""
    turns = [f for f in families for _ in range(SHARES[f])]
    pairs = [(mode, family) for family in turns for mode in modes]
    # friction of all joints at once is what inverse dynamics are for
    pairs = [(mode, family) for mode, family in pairs if family != "all joints" or mode == "inverse"]
    return [(first + i, *pairs[i % len(pairs)]) for i in range(count)]


def one_set(
    seed: int, mode: str, family: str, work: Path, program: list[str], threads: int, kind: str | None = None
) -> dict | None:
    """Draws, labels, asks and judges one set."""
    folder = work / f"{seed}_{mode}"
    # runs that diverge are met where they end
    mujoco.set_mju_user_warning(lambda _message: None)
    shutil.rmtree(folder, ignore_errors=True)
    try:
        case = draw_case(seed, mode, family, folder, kind)
        label = Oracle(case).label()
        answer = ask(program, case, threads)
        found = judge(case, label, answer).as_dict()
        if answer.diagnosis is None:
            found["messages"] = answer.messages[-300:]
        (folder / "verdict.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
        return found
    except Exception:
        # a set that cannot be made says nothing of the program; it is counted
        (work / f"{seed}_{mode}_failed.txt").write_text(traceback.format_exc(), encoding="utf-8")
        return None


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--report", action="store_true", help="seeds from the hash of the commit; the report is logged")
    which.add_argument("--seed", type=int, help="the first seed, to look at")
    parser.add_argument("--count", type=int, default=120, help="how many sets (default 120)")
    parser.add_argument("--skip", type=int, default=0, help="leave out so many of the plan, to go on with a report")
    parser.add_argument("--mode", action="append", choices=sorted(MODES), default=[], help="only these (default all)")
    parser.add_argument("--family", action="append", choices=FAMILIES, default=[], help="only these (default all)")
    parser.add_argument("--kind", help="what is hidden, of single effects; not for a report")
    parser.add_argument("--jobs", type=int, default=2, help="sets at once")
    parser.add_argument("--threads", type=int, default=1, help="threads of each diagnosis")
    parser.add_argument("--program", default=PROGRAM, help="truecut, or a command")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "random_bench")
    options = parser.parse_args(arguments)
    if options.report and options.kind:
        parser.error("a report draws every kind")
    commit, changed, first = None, None, options.seed
    if options.report:
        try:
            commit = git("rev-parse", "HEAD")
            but_log = f":(exclude,top){LOG.relative_to(ROOT).as_posix()}"
            changed = bool(git("status", "--porcelain", "--untracked-files=no", "--", ".", but_log))
        except subprocess.CalledProcessError as error:
            parser.error(f"a report takes its seeds from the commit: {error.stderr.strip()}")
        first = seed_of_commit(commit)
    jobs = plan(first, options.skip + options.count, options.mode or list(MODES), options.family or list(FAMILIES))
    work = ROOT / "target" / "random_bench" / str(first)
    work.mkdir(parents=True, exist_ok=True)
    program, found, failed = shlex.split(options.program), [], 0
    with ProcessPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(one_set, *job, work, program, options.threads, options.kind) for job in jobs[options.skip :]]
        for done in as_completed(waiting):
            verdict = done.result()
            failed += verdict is None
            if verdict is not None:
                found.append(verdict)
                told = "right" if verdict["right"] else "WRONG"
                told += "" if verdict["counts"] else " (not separable)"
                hidden, named = (" + ".join(verdict[which]) or "nothing" for which in ("truth", "named"))
                place = f"{verdict['seed']} {verdict['mode']}, {verdict['family']}"
                print(f"{place}: {hidden} -> {verdict['told']}: {named}; {told}; {verdict['seconds']} s", flush=True)
    found.sort(key=lambda verdict: verdict["seed"])
    figures = summary(found)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "verdicts.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    text = markdown(figures)
    (options.out / "report.md").write_text(text, encoding="utf-8")
    print(text)
    print(f"{failed} sets could not be made")
    if options.report:
        line = {"commit": commit, "changed": changed, "seed": first, "skip": options.skip, "failed": failed} | figures
        with LOG.open("a", encoding="utf-8") as log:
            log.write(json.dumps(line) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
