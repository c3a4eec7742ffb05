"""Runs every shipped scenario and sweep as a user would: its claims must hold.

Those that a document's command runs as they are need no second run. Path jobs, identifications and replays of measured data, which hold no claims, run with the documents' commands
(`test_commands.py`) and the tests on measured data.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from test_commands import BLOCKS

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
LONGEST_S = 900


def has_claims(scenario: Path) -> bool:
    """Whether a file is a scenario that claims something."""
    return re.search(r"^\[\[(claim|sweep\.claim)\]\]", scenario.read_text(encoding="utf-8"), re.MULTILINE) is not None


def run_by_documents() -> set[Path]:
    """Scenarios that a document's command runs, or checks with their folder, with nothing set otherwise."""
    found: set[Path] = set()
    for block in BLOCKS:
        commands = {"short": block.text, "skip": ""}.get(block.note, block.commands)
        for line in commands.replace("\\\n", " ").splitlines():
            if not line.startswith(("truecut run ", "truecut check ")) or " --set " in line:
                continue
            words = shlex.split(line, comments=True)
            for path in (ROOT / word for word in words[2:] if word.startswith("scenarios/")):
                found.update(path.rglob("*.toml") if path.is_dir() else [path])
    return found


ALL = sorted((ROOT / "scenarios").rglob("*.toml"))
CLAIMING = [scenario for scenario in ALL if has_claims(scenario)]
ELSEWHERE = run_by_documents()


@pytest.mark.parametrize("scenario", [it for it in CLAIMING if it not in ELSEWHERE], ids=lambda path: str(path.relative_to(ROOT)))
def test_claims_hold(scenario, tmp_path):
    """It ends with exit code 0."""
    variables = os.environ | {"NO_COLOR": "1"}
    command = [PROGRAM, "run", scenario, "--out", tmp_path]
    done = subprocess.run(command, env=variables, capture_output=True, text=True, timeout=LONGEST_S, check=False)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}\n{done.stderr}"


def test_scenarios_are_found():
    """Chamfering, finishing, milling, wheel and arm claim something."""
    assert len(CLAIMING) >= 25, [str(scenario) for scenario in CLAIMING]
