#!/usr/bin/env python3
"""How often a change between two recordings is named: `python tests/random_bench/between.py --seed N --pairs 100` draws
machines at random that lack one or two things in both recordings (of the library, or outside it), between which one thing
changes or nothing, on the same motion or on another; MuJoCo makes the measurements. `--report` takes the seeds from the hash
of the commit.
"""

from __future__ import annotations

import argparse
import json
import shlex
import shutil
import sys
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

import mujoco

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from drawn import ROOT  # noqa: E402
from drawn.judge import share  # noqa: E402
from drawn.pair import ask, draw_pair, judge, label  # noqa: E402

# of six pairs
FAMILIES = ("nothing", "strong", "middle", "nothing", "strong", "middle")
MODES = ("inverse", "forward", "inverse", "load")


def plan(first: int, count: int, modes: tuple[str, ...], families: tuple[str, ...]) -> list[tuple[int, str, str]]:
    """Seeds with modes and families, in turns."""
    return [(first + i, modes[(i // len(families)) % len(modes)], families[i % len(families)]) for i in range(count)]


def one(seed: int, mode: str, family: str, work: Path, program: list[str], threads: int, repeats: bool | None) -> dict | None:
    """Draws, labels, asks, judges."""
    mujoco.set_mju_user_warning(lambda _message: None)
    folder = work / f"{seed}_{mode}_{family}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        pair = draw_pair(seed, mode, family, folder, repeats)
        answer, messages, seconds = ask(program, pair, threads)
        told = asdict(judge(pair, answer, messages, seconds, label(pair)))
        (folder / "told.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
        return told
    except Exception:
        # a pair that cannot be made says nothing of the program; it is counted
        (folder / "failed.txt").write_text(traceback.format_exc(), encoding="utf-8")
        return None


def table(all_told: list[dict]) -> str:
    """Rates with exact 95 % intervals; of changes, those that the oracle tells apart."""
    rows = ["| | named, or silent | not separable: right |", "| --- | --- | --- |"]
    groups = {
        "something changed": lambda t: t["family"] != "nothing",
        "strong": lambda t: t["family"] == "strong",
        "middle": lambda t: t["family"] == "middle",
        "nothing changed": lambda t: t["family"] == "nothing",
    }
    for name, is_of in groups.items():
        for motion, wanted in (("", None), (", same motion", True), (", other motion", False)):
            own = [t for t in all_told if is_of(t) and (wanted is None or t["repeats"] is wanted)]
            counted = [t for t in own if t["separable"]]
            others = [t for t in own if not t["separable"]]
            if own:
                told = share(sum(t["right"] for t in counted), len(counted))
                rows.append(f"| {name}{motion} | {told} | {sum(t['right'] for t in others)} of {len(others)} |")
    inside = [x for t in all_told for x in t["inside"]]
    claimed = [t for t in all_told if t["family"] == "nothing" and t["named"]]
    rows += ["", f"95 % intervals that hold the true change: {share(sum(inside), len(inside))}"]
    rows += [f"of pairs in which nothing changed, something was named in {len(claimed)}"]
    seconds = sorted(t["seconds"] for t in all_told)
    rows += [f"an answer takes {seconds[len(seconds) // 2]} s in the median, {seconds[-1]} s at most"] if seconds else []
    return "\n".join(rows)


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--report", action="store_true", help="seeds from the hash of the commit")
    which.add_argument("--seed", type=int, help="the first seed, to look at")
    parser.add_argument("--pairs", type=int, default=120, help="how many (default 120)")
    parser.add_argument("--mode", action="append", choices=sorted(set(MODES)), default=[], help="only these")
    parser.add_argument("--family", action="append", choices=sorted(set(FAMILIES)), default=[], help="only these")
    parser.add_argument("--motion", choices=["same", "other"], help="only this")
    parser.add_argument("--jobs", type=int, default=2, help="pairs at once")
    parser.add_argument("--threads", type=int, default=1, help="threads of each diagnosis")
    parser.add_argument("--program", default=run.PROGRAM, help="truecut, or a command")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "between", help="folder for the pairs")
    options = parser.parse_args(arguments)
    first = run.seed_of_commit(run.git("rev-parse", "HEAD")) if options.report else options.seed
    jobs = plan(first, options.pairs, tuple(options.mode) or MODES, tuple(options.family) or FAMILIES)
    repeats = None if options.motion is None else options.motion == "same"
    work, program = options.out / str(first), shlex.split(options.program)
    found, failed = [], 0
    with ProcessPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(one, *job, work, program, options.threads, repeats) for job in jobs]
        for done in as_completed(waiting):
            told = done.result()
            failed += told is None
            if told is not None:
                found.append(told)
                right = ("right" if told["right"] else "WRONG") + ("" if told["separable"] else " (not separable)")
                motion = "same" if told["repeats"] else "other"
                common, change, named = (" + ".join(told[key]) or "nothing" for key in ("common", "change", "named"))
                print(
                    f"{told['seed']} {told['mode']}, {told['family']}, {motion} motion: {common} | {change}"
                    f"{' grown' if told['grown'] else ''}{' gone' if told['gone'] else ''} -> {told['verdict']}: {named} "
                    f"(+{told['alternatives']}); {right}; {told['seconds']} s",
                    flush=True,
                )
    print(table(found))
    print(f"seeds from {first} on; {failed} pairs could not be made")
    return 0


if __name__ == "__main__":
    sys.exit(main())
