"""A result that is spread over the workpiece: depth along a strip, width around a rim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Profile:
    """Values over a place on the workpiece; `period` closes it to a ring."""

    axis: np.ndarray
    values: np.ndarray
    period: float | None = None

    def at(self, axis: np.ndarray) -> np.ndarray:
        """Values at other places."""
        return np.interp(axis, self.axis, self.values, period=self.period)
