#!/usr/bin/env python3
"""A sweep over two workers of a HyperQueue server beside the same sweep on two threads: `python benches/cluster.py`.

`--short` takes few rows, to see that it runs. Needs `pip install hyperqueue` and `cargo build --release`.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
SCENARIO = ROOT / "scenarios" / "arm" / "uncertain_arm.toml"
WORKERS = 2


def swept(out: str, rows: int, *words: str) -> float:
    """Seconds that a sweep takes."""
    call = [PROGRAM, "sweep", SCENARIO, "--engine", "reduced", "--set", f"sweep.sample.count={rows}"]
    variables = os.environ | {"TRUECUT_PYTHON": sys.executable}
    begun = time.perf_counter()
    subprocess.run([*call, "--out", out, *words], check=True, env=variables, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begun


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="few rows")
    parser.add_argument("--rows", type=int, default=10_000)
    options = parser.parse_args()
    try:
        from hyperqueue.cluster import LocalCluster, WorkerConfig
    except ImportError as error:
        print(f"not measured: {error}")
        return 0
    rows = 100 if options.short else options.rows
    with tempfile.TemporaryDirectory() as folder, LocalCluster(f"{folder}/server") as cluster:
        for _ in range(WORKERS):
            cluster.start_worker(WorkerConfig(cores=1))
        server = cluster.cluster.server_dir
        here = swept(f"{folder}/here", rows, "--jobs", str(WORKERS))
        there = swept(f"{folder}/there", rows, "--workers-on", "hyperqueue", "--server", server)
        same = [Path(folder, where, "uncertain_arm", "sweep.parquet").read_bytes() for where in ("here", "there")]
        print(f"{rows} rows: {here:.1f} s on {WORKERS} threads, {there:.1f} s on {WORKERS} workers")
        print(f"efficiency {here / there:.2f}, {'the same' if same[0] == same[1] else 'NOT THE SAME'} to the bit")
        return int(same[0] != same[1])


if __name__ == "__main__":
    sys.exit(main())
