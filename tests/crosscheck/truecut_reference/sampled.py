"""How many of the cases that are drawn at random a run of the tests takes."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TypeVar

Case = TypeVar("Case")


def some(cases: Iterable[Case], most: int) -> list[Case]:
    """The first of them, all with `TRUECUT_WHOLE=1`: as `.ci/full` has it, for a night."""
    whole = os.environ.get("TRUECUT_WHOLE") == "1"
    return list(cases)[: None if whole else most]
