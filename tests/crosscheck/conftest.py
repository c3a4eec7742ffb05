"""What the cross-checks share: the program, scenario files, and one run of each per session."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ROBOTS = ROOT / "assets" / "robots"
sys.path.insert(0, str(HERE))


class Truecut:
    """The program under test. `TRUECUT_BIN` names another binary than the release build."""

    def __init__(self, work: Path) -> None:
        self.binary = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
        self.work = work
        self._recorded: dict[str, Path] = {}

    def call(self, *arguments: object, accept: tuple[int, ...] = (0,)) -> str:
        """Output of a call; fails the test on any exit code not in `accept`."""
        done = subprocess.run([self.binary, *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode in accept, f"truecut {arguments}: exit {done.returncode}\n{done.stdout}{done.stderr}"
        return done.stdout

    def mjcf(self, scenario: Path) -> str:
        """The exported model of a scenario."""
        target = self.work / f"{scenario.stem}.xml"
        self.call("export-mjcf", scenario, "-o", target)
        return target.read_text(encoding="utf-8")

    def record(self, scenario: Path) -> Path:
        """Path of the Parquet recording of one run (a claim that fails is no matter here)."""
        key = str(scenario.resolve())
        if key not in self._recorded:
            out = self.work / f"out-{len(self._recorded)}"
            self.call("run", scenario, "--out", out, "--no-rrd", accept=(0, 1))
            self._recorded[key] = out / scenario.stem / "recording.parquet"
        return self._recorded[key]


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
