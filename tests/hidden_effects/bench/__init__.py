"""The hidden-effects bench: measurements made in MuJoCo with something hidden in them, and a judge.

The effects are written here anew from their definitions in the scenario format. Nothing here reads truecut's own code.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# the plant and the nominal process laws are those of the cross-checks
sys.path.insert(0, str(ROOT / "tests" / "crosscheck"))
