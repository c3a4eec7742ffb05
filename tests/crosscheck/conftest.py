"""What the cross-checks share: the program, scenario files, one run of each per session, and the figures at the end."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ROBOTS = ROOT / "assets" / "robots"
sys.path.insert(0, str(HERE))

# One line for each trajectory that was compared, for the summary.
FIGURES: list[str] = []


class Truecut:
    """The program under test. `TRUECUT_BIN` names another binary than the release build."""

    def __init__(self, work: Path) -> None:
        self.binary = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
        self.work = work
        self._recorded: dict[tuple, Path] = {}

    def run(self, *arguments: object, **environment: str) -> subprocess.CompletedProcess:
        """A call from the project's folder, however it ends."""
        command = [self.binary, *map(str, arguments)]
        variables = os.environ | environment
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=variables, check=False)

    def call(self, *arguments: object, accept: tuple[int, ...] = (0,)) -> str:
        """Output of a call; fails the test on any exit code not in `accept`."""
        done = self.run(*arguments)
        assert done.returncode in accept, f"truecut {arguments}: exit {done.returncode}\n{done.stdout}{done.stderr}"
        return done.stdout

    def mjcf(self, scenario: Path, changes: dict | None = None) -> str:
        """The exported model of a scenario."""
        target = self.work / f"{scenario.stem}.xml"
        self.call("export-mjcf", scenario, "-o", target, *_sets(changes))
        return target.read_text(encoding="utf-8")

    def record(self, scenario: Path, changes: dict | None = None) -> Path:
        """Path of the Parquet recording of one run (a claim that fails or a drive that is overloaded is no matter here)."""
        sets = _sets(changes)
        key = (scenario.resolve(), *sets)
        if key not in self._recorded:
            out = self.work / f"out-{len(self._recorded)}"
            self.call("run", scenario, "--out", out, "--no-rrd", *sets, accept=(0, 1, 6))
            self._recorded[key] = out / scenario.stem / "recording.parquet"
        return self._recorded[key]


def _sets(changes: dict | None) -> list[str]:
    """`--set` arguments; strings and numbers are written as TOML reads them."""
    return [part for key, value in (changes or {}).items() for part in ("--set", f"{key}={_toml(value)}")]


def _toml(value: float | str) -> str:
    return f'"{value}"' if isinstance(value, str) else repr(value)


@pytest.fixture(scope="session")
def truecut(tmp_path_factory) -> Truecut:
    """The program, with a folder for what it writes."""
    program = Truecut(tmp_path_factory.mktemp("truecut"))
    if not program.binary.exists():
        pytest.fail(f"{program.binary} is missing: cargo build --release -p truecut-cli")
    return program


def scenarios(folder: str) -> list[Path]:
    """Scenario files of one process that are single runs, not sweeps."""
    found = sorted((ROOT / "scenarios" / folder).glob("*.toml"))
    return [path for path in found if "sweep" not in tomllib.loads(path.read_text(encoding="utf-8"))]


def pytest_sessionfinish(session) -> None:
    """Where tests run side by side, each process hands its figures to the one that sums up."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["figures"] = FIGURES


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node) -> None:
    """Takes them."""
    FIGURES.extend(getattr(node, "workeroutput", {}).get("figures", []))


def pytest_terminal_summary(terminalreporter) -> None:
    """How far truecut and MuJoCo are apart, scenario by scenario: the margin says more than a passed test."""
    if FIGURES:
        terminalreporter.section("truecut against MuJoCo")
        for line in FIGURES:
            terminalreporter.write_line(line)
