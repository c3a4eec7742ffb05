"""The bench's own milling machine: sets that were answered wrongly."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, runner  # noqa: E402
from bench.cases import all_cases  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))


def test_crosscheck_mujoco_a_mode_whose_signature_lies_at_another_frequency(tmp_path):
    """What a mode does to the cut is not linear in its compliance: of 64 frequencies the signatures of other ones explain
    more than those beside its own, from which no fit was started (process damping was named)."""
    cases = [c for c in all_cases("report") if c.family == "milling middle" and c.colour == "white"]
    cases = [c for c in cases if c.truth[0].kind == "tool_mode"]
    assert cases
    sets = runner.write_all(cases, tmp_path / "work", 1, 2)
    answers = runner.diagnose_all([str(PROGRAM)], sets, tmp_path / "work", len(sets))
    for name, answer in answers.items():
        (cause,) = answer.causes
        truth = sets[name].truth[0].values
        assert cause["kind"] == "tool_mode", answer.diagnosis["reason"]
        found = {key: entry["value"] for key, entry in cause["parameters"].items()}
        assert found["frequency_hz"] == pytest.approx(truth["frequency_hz"], rel=0.01)
        assert found["compliance_m_per_n"] == pytest.approx(truth["compliance_m_per_n"], rel=0.1)
