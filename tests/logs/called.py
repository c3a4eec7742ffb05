"""The program, as a user calls it."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))


def truecut(*arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Runs the program."""
    command = [PROGRAM, *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"NO_COLOR": "1"}, timeout=300)
    assert ended.returncode == code, ended.stderr + ended.stdout
    return ended
