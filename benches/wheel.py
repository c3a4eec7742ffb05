#!/usr/bin/env python3
"""What the Python package costs beside the program: `python benches/wheel.py`.

Builds the wheel, installs it into a fresh environment, and tells how long `import truecut` takes there, processor time of
a run through Python beside the same run by the program, and memory over many runs. `--python` names an interpreter that
has the package already; `--short` takes few of each, to see that it runs. Needs `pip install maturin` and
`cargo build --release`.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "wheel"))
from built import PROGRAM, made  # noqa: E402

SCENARIO = "scenarios/arm/free_decay.toml"
IMPORT = "import time; begun = time.perf_counter(); import truecut; print(time.perf_counter() - begun)"
RUN = """
import sys, truecut
scenario = truecut.load(sys.argv[1], {"run.duration_s": float(sys.argv[2])})
print(len(scenario.run()))
"""
MEMORY = """
import sys, truecut
def used_kb():
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmRSS")).split()[1])
scenario = truecut.load(sys.argv[1])
for run in range(int(sys.argv[2]) + 1):
    if run % (int(sys.argv[2]) // 5) == 0:
        print(run, used_kb())
    scenario.run()
"""


def output(call: list) -> str:
    """What a program prints."""
    ended = subprocess.run(list(map(str, call)), cwd=ROOT, capture_output=True, text=True)
    if ended.returncode != 0:
        sys.exit(f"{ended.stderr}\n{call} ended with {ended.returncode}")
    return ended.stdout


def used_s(call: list) -> float:
    """Processor time of a program with its threads, from its start on."""
    process = subprocess.Popen(list(map(str, call)), cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{call} ended with the status {status}")
    return used.ru_utime + used.ru_stime


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="few runs, short ones")
    parser.add_argument("--python", type=Path, help="an interpreter that has the package; else the wheel is built")
    options = parser.parse_args()
    short = options.short
    turns, length_s, runs = (2, 8, 10) if short else (9, 60, 100)
    with tempfile.TemporaryDirectory() as folder:
        python = options.python or made(Path(folder))
        imports = [float(output([python, "-c", IMPORT])) for _ in range(turns)]
        print(f"import: {statistics.median(imports):.3f} s in the median of {turns}, at most {max(imports):.3f} s", flush=True)
        through, program = [], []
        ours = [python, "-c", RUN, SCENARIO, length_s]
        theirs = [PROGRAM, "run", SCENARIO, "--set", f"run.duration_s={length_s}", "--out", Path(folder, "out")]
        for _ in range(turns):
            through.append(used_s(ours))
            program.append(used_s([*theirs, "--no-rrd"]))
        ratio = statistics.median(a / b for a, b in zip(through, program))
        print(
            f"a run of {length_s} s: {statistics.median(through):.2f} s of processor time through Python with its start, "
            f"{statistics.median(program):.2f} s by the program with its files: {ratio:.3f} in the median of {turns} turns",
            flush=True,
        )
        for line in output([python, "-c", MEMORY, "scenarios/arm/static_load.toml", runs]).splitlines():
            after, kb = map(int, line.split())
            print(f"after {after:3d} runs: {kb / 1000:.1f} MB", flush=True)


if __name__ == "__main__":
    main()
