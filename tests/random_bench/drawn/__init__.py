"""Experiments drawn at random, measured in MuJoCo, with an oracle that says what their data can tell.

Laws of effects are those of the bench of hidden effects (`tests/hidden_effects/bench`), which know nothing of truecut's
code; laws outside its library are made here at random.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "hidden_effects"))
