#!/usr/bin/env python3
"""A sweep over two workers of a HyperQueue server beside two threads, and with a worker killed: `python benches/cluster.py`.

First how long the same rows take on two threads and on two workers, turn by turn. Then trials: in each one of two workers
is killed at a time drawn at random, and the table must be that of the threads to the bit, no row made into a part twice.
`--short` takes few rows, to see that it runs. Needs `pip install hyperqueue` and `cargo build --release`.
"""

from __future__ import annotations

import argparse
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "cluster"))
from workers import Cluster, Watch, kill_later  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
SCENARIO = ROOT / "scenarios" / "arm" / "uncertain_arm.toml"
WORKERS = 2
# of those asked for, as many trials are made at most
MOST_ATTEMPTS = 3


def swept(out: Path, rows: int, *words: object) -> float:
    """Seconds that a sweep takes."""
    call = [PROGRAM, "sweep", SCENARIO, "--engine", "reduced", "--set", f"sweep.sample.count={rows}"]
    variables = os.environ | {"TRUECUT_PYTHON": sys.executable}
    begun = time.perf_counter()
    # it ends with 1 where a claim fails, which is about the scenario
    ended = subprocess.run([*call, "--out", out, *map(str, words)], env=variables, capture_output=True, text=True)
    took_s = time.perf_counter() - begun
    if ended.returncode not in (0, 1):
        sys.exit(f"{ended.stderr}\nthe sweep ended with {ended.returncode}")
    return took_s


def table(out: Path) -> list[bytes]:
    """The files of a sweep's table."""
    return [(out / "uncertain_arm" / name).read_bytes() for name in ("sweep.parquet", "sweep.csv")]


def efficiency(folder: Path, rows: int, turns: int) -> bool:
    """Tells times on threads and on workers; whether both tables are the same."""
    here_s, there_s, same = [], [], True
    with Cluster(folder, WORKERS) as cluster:
        on_workers = ("--workers-on", "hyperqueue", "--server", cluster.server)
        for turn in range(turns):
            here, there = folder / f"here{turn}", folder / f"there{turn}"
            here_s.append(swept(here, rows, "--jobs", WORKERS))
            there_s.append(swept(there, rows, *on_workers))
            same &= table(here) == table(there)
            print(f"{rows} rows: {here_s[-1]:.1f} s on {WORKERS} threads, {there_s[-1]:.1f} s on {WORKERS} workers", flush=True)
    share = statistics.median(here / there for here, there in zip(here_s, there_s))
    print(f"efficiency {share:.3f} in the median, {'the same' if same else 'NOT THE SAME'} to the bit", flush=True)
    return same


def trials(folder: Path, rows: int, count: int, seed: int) -> bool:
    """Kills a worker in each; whether all tables are those of the threads, and each row came once.

    A sweep that had ended before its worker was killed, on a machine that other work had slowed down until then, says
    nothing: the moment is drawn again.
    """
    draw = random.Random(seed)
    part_rows = max(1, rows // 40)
    swept(folder / "here", rows, "--jobs", WORKERS)
    words = ("--workers-on", "hyperqueue", "--part-rows", part_rows)
    with Cluster(folder / "quiet", WORKERS) as cluster:
        quiet_s = swept(folder / "quiet_out", rows, *words, "--server", cluster.server)
    print(f"{rows} rows in parts of {part_rows}, nobody killed: {quiet_s:.1f} s")
    good = table(folder / "here") == table(folder / "quiet_out")
    attempts, killed = 0, 0
    while killed < count and attempts < MOST_ATTEMPTS * count:
        trial, attempts = attempts, attempts + 1
        out, after_s = folder / f"out{trial}", draw.uniform(0.02, 0.95) * quiet_s
        parts = out / "uncertain_arm" / "parts"
        with Cluster(folder / f"cluster{trial}", WORKERS) as cluster, Watch(parts) as watch:
            victim = draw.choice(cluster.workers)
            timer = kill_later(victim, after_s)
            took_s = swept(out, rows, *words, "--server", cluster.server)
            timer.join()
            came = victim.poll() is not None and after_s < took_s
        same, once = table(out) == table(folder / "here"), watch.rows == list(range(rows))
        good &= same and once
        killed += came
        print(
            f"trial {trial + 1}: a worker killed after {after_s:.1f} s of {took_s:.1f} s{'' if came else ', too late: once more'}; "
            f"{'the same' if same else 'NOT THE SAME'} to the bit, {'no row twice' if once else 'ROWS TWICE OR UNSEEN'}",
            flush=True,
        )
    return good and killed == count


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="few rows, one turn, one trial")
    parser.add_argument("--rows", type=int, default=10_000, help="of the comparison with threads; 0 leaves it out")
    parser.add_argument("--turns", type=int, default=3, help="how often both are timed")
    parser.add_argument("--trials", type=int, default=10, help="in which a worker is killed")
    parser.add_argument("--trial-rows", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1, help="of the times and of the workers that are killed")
    options = parser.parse_args()
    try:
        import hyperqueue  # noqa: F401
    except ImportError as error:
        print(f"not measured: {error}")
        return 0
    if options.short:
        options.rows, options.turns, options.trials, options.trial_rows = 100, 1, 1, 100
    good = True
    with tempfile.TemporaryDirectory() as folder:
        if options.rows:
            good &= efficiency(Path(folder, "timed"), options.rows, options.turns)
        if options.trials:
            good &= trials(Path(folder, "killed"), options.trial_rows, options.trials, options.seed)
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
