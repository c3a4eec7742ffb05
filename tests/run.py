#!/usr/bin/env python3
"""Runs every test: `cargo test` over the workspace, then the cross-checks against MuJoCo and the fast part of the
hidden-effects bench.

Makes `.venv` with the pinned packages of `tests/requirements.txt` on the first call. The last line sums up both
parts as `N passed, M failed`; the exit code is 0 only if nothing failed.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
REQUIREMENTS = ROOT / "tests" / "requirements.txt"
ENVIRONMENT = ROOT / ".venv"
PYTHON_TESTS = (ROOT / "tests" / "crosscheck", ROOT / "tests" / "hidden_effects")
OLDEST_PYTHON = (3, 10)


class Counts(NamedTuple):
    """How many tests passed and failed."""

    passed: int
    failed: int

    def __str__(self) -> str:
        return f"{self.passed} passed, {self.failed} failed"


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
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", REQUIREMENTS]
    if subprocess.run(install).returncode != 0:
        sys.exit(f"cannot install {REQUIREMENTS.relative_to(ROOT)} into .venv")
    stamp.write_text(pins)
    return python


def run_cargo(python: Path) -> Counts:
    """All Rust tests. A build that fails counts as one failure."""
    command = ["cargo", "test", "--release", "--workspace", "--no-fail-fast"]
    variables = os.environ | {"TRUECUT_PYTHON": str(python)}
    result = re.compile(r"^test result: \w+\. (\d+) passed; (\d+) failed;")
    passed = failed = 0
    with subprocess.Popen(command, cwd=ROOT, env=variables, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            found = result.match(line)
            if found:
                passed += int(found[1])
                failed += int(found[2])
    if process.returncode != 0:
        failed = max(failed, 1)
    return Counts(passed, failed)


def run_pytest(python: Path) -> Counts:
    """The cross-checks. A test that is skipped counts as failed: nothing here may be left out quietly."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        # MuJoCo runs on one core: files of tests run side by side
        side_by_side = ["-n", "auto", "--dist", "loadfile"]
        command = [python, "-m", "pytest", "-q", *side_by_side, f"--junitxml={report}", *PYTHON_TESTS]
        ended = subprocess.run(command, cwd=ROOT)
        if not report.exists():
            return Counts(0, 1)
        suites = ElementTree.parse(report).getroot().iter("testsuite")
        counts = [{key: int(suite.get(key, 0)) for key in ("tests", "failures", "errors", "skipped")} for suite in suites]
    tests = sum(count["tests"] for count in counts)
    failed = sum(count["failures"] + count["errors"] + count["skipped"] for count in counts)
    if ended.returncode != 0:
        failed = max(failed, 1)
    return Counts(max(tests - failed, 0), failed)


def main() -> int:
    """Runs both parts, whatever comes of the first."""
    python = environment()
    rust = run_cargo(python)
    crosscheck = run_pytest(python)
    total = Counts(rust.passed + crosscheck.passed, rust.failed + crosscheck.failed)
    print(f"\ncargo test: {rust}\ncross-checks: {crosscheck}\n{total}")
    return 0 if total.failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
