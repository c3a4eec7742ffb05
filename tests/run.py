#!/usr/bin/env python3
"""Runs every test: `cargo test` over the workspace, then the tests in Python: reference numbers computed anew,
cross-checks against MuJoCo, the fast part of the hidden-effects bench, the random bench's own parts, logs of robots,
reports as pages, the Python package, the commands that the documents show.

Of cases that are drawn alike from many seeds the first few run; all with `TRUECUT_WHOLE=1`, as in `.ci/full`.

Makes `.venv` with the packages of `tests/requirements.txt`, pinned by their hashes, on the first call. Tests that are
skipped are named with their reason. The last line sums up both parts as `N passed, N failed, N skipped`; the exit code
is 0 only if nothing failed.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
REQUIREMENTS = ROOT / "tests" / "requirements.txt"
ENVIRONMENT = ROOT / ".venv"
PYTHON_FOLDERS = ("reference", "crosscheck", "hidden_effects", "random_bench", "logs", "reports", "cluster", "wheel", "docs")
PYTHON_TESTS = tuple(ROOT / "tests" / folder for folder in PYTHON_FOLDERS)
OLDEST_PYTHON = (3, 10)


class Counts(NamedTuple):
    """How many tests passed and failed, and each that was skipped: its name, with the reason if one is given."""

    passed: int
    failed: int
    skipped: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.passed} passed, {self.failed} failed, {len(self.skipped)} skipped"

    def __add__(self, other: Counts) -> Counts:
        return Counts(self.passed + other.passed, self.failed + other.failed, self.skipped + other.skipped)


def find_python() -> str:
    """An interpreter that is new enough for the pinned packages: this one, or another on the PATH."""
    if sys.version_info >= OLDEST_PYTHON:
        return sys.executable
    for minor in range(14, OLDEST_PYTHON[1] - 1, -1):
        found = shutil.which(f"python3.{minor}")
        if found:
            return found
    sys.exit(f"Python {OLDEST_PYTHON[0]}.{OLDEST_PYTHON[1]} or newer is needed for the cross-checks")


def environment() -> Path:
    """The interpreter of `.venv`, which has the pinned packages. Made afresh when the pins change."""
    python = ENVIRONMENT / "bin" / "python"
    stamp = ENVIRONMENT / "requirements.sha256"
    pins = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()
    if python.exists() and stamp.exists() and stamp.read_text() == pins:
        return python
    made = subprocess.run([find_python(), "-m", "venv", "--clear", ENVIRONMENT])
    if made.returncode != 0:
        sys.exit("cannot make .venv (on Debian: apt install python3-venv)")
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    install = [*pip, "--require-hashes", "-r", REQUIREMENTS]
    if subprocess.run(install).returncode != 0:
        sys.exit(f"cannot install {REQUIREMENTS.relative_to(ROOT)} into .venv")
    stamp.write_text(pins)
    return python


# what `cargo test` prints of a suite, and of a test that was left out
SUITE = re.compile(r"^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored;")
IGNORED = re.compile(r"^test (.+?)\s+\.\.\. ignored(?:, | \()?(.*?)\)?$")


def count_cargo(lines: Iterable[str]) -> Counts:
    """Sums up the lines that `cargo test` prints, which are passed on."""
    passed = failed = ignored = 0
    skipped = []
    for line in lines:
        print(line, end="", flush=True)
        if suite := SUITE.match(line):
            passed, failed, ignored = (a + int(b) for a, b in zip((passed, failed, ignored), suite.groups()))
        elif left_out := IGNORED.match(line.rstrip("\n")):
            skipped.append(": ".join(filter(None, left_out.groups())))
    # one whose line could not be read is still counted
    skipped.extend(["a test of the Rust part"] * (ignored - len(skipped)))
    return Counts(passed, failed, tuple(skipped))


CARGO_TEST = ["cargo", "test", "--release", "--workspace"]


def prepare() -> Path:
    """The interpreter of `.venv`. Packages that are still to be installed come while the Rust tests are built."""
    with ThreadPoolExecutor(1) as other:
        python = other.submit(environment)
        # one that fails is counted by the call that runs the tests
        subprocess.run([*CARGO_TEST, "--no-run"], cwd=ROOT)
        return python.result()


def run_cargo(python: Path) -> Counts:
    """All Rust tests. A build that fails counts as one failure."""
    command = [*CARGO_TEST, "--no-fail-fast"]
    variables = os.environ | {"TRUECUT_PYTHON": str(python)}
    with subprocess.Popen(command, cwd=ROOT, env=variables, stdout=subprocess.PIPE, text=True) as process:
        counts = count_cargo(process.stdout)
    if process.returncode != 0:
        counts = counts._replace(failed=max(counts.failed, 1))
    return counts


def count_pytest(report: Path) -> Counts:
    """Sums up a JUnit report."""
    cases = list(ElementTree.parse(report).getroot().iter("testcase"))
    failed = sum(1 for case in cases if case.find("failure") is not None or case.find("error") is not None)
    found = [(case.get("name"), case.find("skipped")) for case in cases]
    skipped = tuple(f"{name}: {skip.get('message')}" for name, skip in found if skip is not None)
    return Counts(len(cases) - failed - len(skipped), failed, skipped)


def run_pytest(python: Path) -> Counts:
    """All Python tests."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        # MuJoCo runs on one core: tests run side by side, and a worker with nothing left takes some of the other's
        side_by_side = ["-n", "auto", "--dist", "worksteal"]
        # what a test wrote is of use only if it failed, and takes gigabytes
        kept = ["-o", "tmp_path_retention_policy=failed", "-o", "tmp_path_retention_count=1"]
        # which tests take longest is seen where time runs short
        told = ["-q", "--durations=20", f"--junitxml={report}"]
        command = [python, "-m", "pytest", *told, *side_by_side, *kept, *PYTHON_TESTS]
        # the cores are taken: threads of linear algebra beside them wait for each other, twelve times as long at worst
        ended = subprocess.run(command, cwd=ROOT, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
        counts = count_pytest(report) if report.exists() else Counts(0, 1)
    if ended.returncode != 0:
        counts = counts._replace(failed=max(counts.failed, 1))
    return counts


@contextmanager
def timed(part: str, times: list[str]) -> Iterator[None]:
    """Adds a line on how long a part took, and how many cores it kept busy: what time could be had by more side by side."""
    begun, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    yield
    wall, now = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
    times.append(f"{part}: {wall:.0f} s, {cpu / max(wall, 1e-3):.2f} cores")


def main() -> int:
    """Runs both parts, whatever comes of the first."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    times = []
    with timed("packages and build", times):
        python = prepare()
    with timed("Rust tests", times):
        rust = run_cargo(python)
    with timed("Python tests", times):
        scripts = run_pytest(python)
    total = rust + scripts
    print("", *times, f"cargo test: {rust}", f"Python: {scripts}", sep="\n")
    for test in total.skipped:
        print(f"skipped: {test}")
    print(total)
    return 0 if total.failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
