"""The program, as a user calls it."""

import functools
import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))


def truecut(*arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Runs the program."""
    command = [PROGRAM, *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"NO_COLOR": "1"}, timeout=300)
    assert ended.returncode == code, ended.stderr + ended.stdout
    return ended


ELBOW = ROOT / "scenarios" / "diagnosis" / "elbow.toml"


def diagnosed(scenario: Path, out: Path) -> dict:
    """What `truecut diagnose` says."""
    truecut("diagnose", scenario, "--out", out)
    (report,) = out.rglob("diagnosis.json")
    return json.loads(report.read_text())


@functools.cache
def diagnosed_of_csv() -> dict:
    """Of the shipped scenario and its table."""
    with tempfile.TemporaryDirectory() as out:
        return diagnosed(ELBOW, Path(out))


def assert_same_diagnosis(found: dict, expected: dict) -> None:
    """Verdict and causes, each with its place, and their sizes well within what the data leave open."""
    assert found["verdict"] == expected["verdict"] == "named"
    assert expected["causes"], "a cause is named"
    named = [[(one["kind"], one["target"]) for one in report["causes"]] for report in (found, expected)]
    assert named[0] == named[1]
    for ours, theirs in zip(found["causes"], expected["causes"]):
        assert ours["parameters"].keys() == theirs["parameters"].keys()
        for name, size in theirs["parameters"].items():
            open_by = size["high"] - size["low"]
            assert abs(ours["parameters"][name]["value"] - size["value"]) < 0.1 * open_by, (name, ours, size)
