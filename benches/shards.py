#!/usr/bin/env python3
"""What 10^6 rows on a cluster cost beside the runs: `python benches/shards.py`.

Ten sweeps of 100 000 rows each (the most that one has), in parts of 100 rows. Their runs are not made: in the place of each
part a task of HyperQueue sleeps, and moves a file of that many rows to where the part belongs. What is left are the
overheads: of the scheduler for each task, of files, and of `truecut sweep`, which reads all parts, puts them together and
writes the table. `--short` takes few rows. Needs `pip install hyperqueue` and `cargo build --release`.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
SCENARIO = ROOT / "scenarios" / "arm" / "uncertain_arm.toml"


def call(seed: int, rows: int) -> list:
    """The sweep of a seed: rows at random, of which there may be as many as a sweep has."""
    sets = ["sweep.sample.method=random", f"sweep.sample.count={rows}", f"sweep.sample.seed={seed}"]
    return [PROGRAM, "sweep", SCENARIO, "--engine", "reduced", *(word for one in sets for word in ("--set", one))]


def prepared(folder: Path, seed: int, rows: int, of_part: int) -> tuple[list[Path], int]:
    """Files of the form of parts with numbers that nobody computed, and their bytes."""
    one = folder / "one.jsonl"
    one.unlink(missing_ok=True)
    subprocess.run([*call(seed, rows), "--rows", "0..1", "-o", one], check=True, capture_output=True)
    head, first = one.read_text().splitlines()
    row = json.loads(first)
    parts, size = [], 0
    for start in range(0, rows, of_part):
        end = min(start + of_part, rows)
        lines = [head]
        for index in range(start, end):
            values = [repr(float(value) * (1 + 1e-6 * index)) for value in row["values"]]
            lines.append(json.dumps(row | {"row": index, "values": values}, separators=(",", ":")))
        parts.append(folder / f"rows_{start:07}_{end:07}.jsonl")
        parts[-1].write_text("\n".join(lines) + "\n")
        size += parts[-1].stat().st_size
    return parts, size


def slept(client, parts: list[Path], folder: Path, sleep_s: float) -> float:
    """Seconds until tasks that sleep have moved all parts to their folder."""
    from hyperqueue import Job

    job = Job(max_fails=None)
    for part in parts:
        job.program(["sh", "-c", f"sleep {sleep_s}; mv '{part}' '{folder / part.name}'"], stdout=None, stderr=None)
    begun = time.perf_counter()
    submitted = client.submit(job)
    client.wait_for_jobs([submitted], raise_on_error=True)
    took_s = time.perf_counter() - begun
    client.forget(submitted)
    return took_s


def merged(words: list) -> tuple[float, float]:
    """Seconds that a call takes, and the most memory that it has, MB."""
    begun = time.perf_counter()
    variables = os.environ | {"TRUECUT_PYTHON": sys.executable}
    process = subprocess.Popen(words, env=variables, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    errors = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    # 1: a claim fails, which is about numbers that nobody computed
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        sys.exit(errors)
    return time.perf_counter() - begun, used.ru_maxrss / 1e3


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="one sweep of few rows")
    parser.add_argument("--sweeps", type=int, default=10)
    parser.add_argument("--rows", type=int, default=100_000, help="of each sweep")
    parser.add_argument("--part-rows", type=int, default=100)
    parser.add_argument("--sleep-s", type=float, default=0.5, help="of a part")
    parser.add_argument("--cores", type=int, default=32, help="of the worker: parts that sleep side by side")
    options = parser.parse_args()
    try:
        from hyperqueue.cluster import LocalCluster, WorkerConfig
    except ImportError as error:
        print(f"not measured: {error}")
        return 0
    if options.short:
        options.sweeps, options.rows, options.sleep_s = 1, 2000, 0.05
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        with LocalCluster(f"{folder}/server") as cluster:
            cluster.start_worker(WorkerConfig(cores=options.cores))
            client = cluster.client()
            for seed in range(options.sweeps):
                parts, size = prepared(folder, seed, options.rows, options.part_rows)
                out = folder / f"out{seed}"
                place = out / SCENARIO.stem / "parts"
                place.mkdir(parents=True)
                took_s = slept(client, parts, place, options.sleep_s)
                ideal_s = -(-len(parts) // options.cores) * options.sleep_s
                words = [*call(seed, options.rows), "--workers-on", "hyperqueue", "--server", cluster.cluster.server_dir]
                merge_s, memory_mb = merged([*words, "--part-rows", str(options.part_rows), "--out", out])
                table = out / SCENARIO.stem
                left = {file.name: file.stat().st_size / 1e6 for file in table.iterdir()}
                print(
                    f"{options.rows} rows in {len(parts)} parts of {size / 1e6:.1f} MB: slept in {took_s:.1f} s "
                    f"({ideal_s:.1f} s without a scheduler, {1e3 * (took_s - ideal_s) / len(parts):.1f} ms a part); "
                    f"read, put together and written in {merge_s:.1f} s with {memory_mb:.0f} MB; "
                    + ", ".join(f"{name} {mb:.1f} MB" for name, mb in sorted(left.items())),
                    flush=True,
                )
                if "parts" in left or len((table / "sweep.csv").read_text().splitlines()) != options.rows + 1:
                    print("NOT WHOLE")
                    return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
