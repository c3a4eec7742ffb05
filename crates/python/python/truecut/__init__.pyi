from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Path: TypeAlias = str | PathLike[str]
Value: TypeAlias = bool | int | float | str | Sequence["Value"]
Overrides: TypeAlias = Mapping[str, Value]
Progress: TypeAlias = Callable[[float], object]
Frame: TypeAlias = Literal["flange", "tool", "foot"]
Array: TypeAlias = NDArray[np.float64]

__version__: str

class TruecutError(Exception):
    """What is wrong with a scenario, a robot or data."""

    file: str | None
    line: int | None
    key: str | None
    rule: str
    help: str | None

def load(path: Path, overrides: Overrides | None = None) -> Scenario:
    """Reads a scenario file; `overrides` are in the keys' own units."""

def lobes(
    scenario: Scenario,
    spindle_rad_s: tuple[float, float] | None = None,
    deepest_m: float | None = None,
    *,
    size: int = 100,
    at_m: float = 0.0,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """The stability diagram of a milling scenario, SI. N speeds, M depths: `spindle_rad_s` (N), `depth_m` (M),
    `multiplier` (NxM, stable below 1), `limit_m`, `limit_error_m`, `frequency_hz`, `zero_order_m` (N; NaN where there
    is none), `mode_coupling_m`, `known_to_rad_s` (or None), `notes`."""

class Scenario:
    @property
    def name(self) -> str: ...
    @property
    def path(self) -> Any: ...
    @property
    def text(self) -> str:
        """The file as TOML, with the overrides."""
    def run(
        self,
        overrides: Overrides | None = None,
        engine: Literal["rapier", "reduced"] | None = None,
        progress: Progress | None = None,
        *,
        data: Path | None = None,
    ) -> Recording:
        """Runs the scenario and judges its claims."""
    def check(self, overrides: Overrides | None = None) -> None:
        """Builds what would run and checks claims and metrics, without a run."""
    def sweep(self, overrides: Overrides | None = None, progress: Progress | None = None) -> SweepTable:
        """Runs the scenario's sweep on all cores."""
    def compare(
        self, data: Path | None = None, overrides: Overrides | None = None, progress: Progress | None = None
    ) -> dict[str, Any]:
        """Runs the scenario beside measured data and says what it gets wrong, SI."""
    def diagnose(
        self,
        data: Path | None = None,
        overrides: Overrides | None = None,
        progress: Progress | None = None,
        *,
        max_runs: int | None = None,
        max_causes: int | None = None,
    ) -> dict[str, Any]:
        """Looks for what the scenario lacks against measured data, SI."""
    def with_overrides(self, overrides: Overrides) -> Scenario:
        """The scenario with keys changed, in their own units."""

class Scalar:
    @property
    def value(self) -> float:
        """SI; NaN if the run gave none."""
    @property
    def unit(self) -> str: ...
    @property
    def description(self) -> str: ...
    def __float__(self) -> float: ...

class Profile:
    @property
    def axis(self) -> Array:
        """Places, ascending, SI."""
    @property
    def values(self) -> Array:
        """One for each place, SI."""
    @property
    def axis_name(self) -> str: ...
    @property
    def axis_unit(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def description(self) -> str: ...

class Recording:
    """Channels over time, SI, and what was computed from them; an Arrow table without a copy."""

    @property
    def channels(self) -> dict[str, str]:
        """Names with units."""
    @property
    def scalars(self) -> dict[str, Scalar]: ...
    @property
    def profiles(self) -> dict[str, Profile]: ...
    @property
    def claims(self) -> list[dict[str, Any]]: ...
    @property
    def holds(self) -> bool:
        """Whether the run came to its end and every claim holds."""
    @property
    def outcome(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def scenario_text(self) -> str: ...
    @property
    def time_step_s(self) -> float: ...
    @property
    def run_s(self) -> float: ...
    def write_parquet(self, path: Path) -> None: ...
    def __getitem__(self, name: str) -> Array:
        """A channel, SI; "time" in s."""
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object = None) -> object: ...

class SweepTable:
    """Rows of a sweep, axes first in their keys' own units; an Arrow table without a copy."""

    @property
    def columns(self) -> dict[str, str]:
        """Names with units."""
    @property
    def faults(self) -> list[str | None]: ...
    def __getitem__(self, name: str) -> Array: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object = None) -> object: ...

class Robot:
    """A robot. Postures in rad (m for slides), poses as 4x4 arrays from the world to the frame, m."""

    def __init__(self, path: Path, config: Path | None = None, tip: str | None = None) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def default_posture(self) -> list[float]: ...
    def forward(self, posture: Sequence[float] | None = None, frame: Frame = "flange") -> Array: ...
    def inverse(self, pose: Array | Sequence[Sequence[float]], frame: Frame = "flange") -> list[Array]:
        """All postures within limits."""
    def jacobian(self, posture: Sequence[float] | None = None, frame: Frame = "tool") -> Array:
        """6xN, world axes: m/s and rad/s per joint velocity."""
    def compliance(self, posture: Sequence[float] | None = None, frame: Frame = "tool") -> Array:
        """6x6, world axes: m/N, rad/N, rad/(N m)."""
    def stiffness(self, posture: Sequence[float] | None = None, frame: Frame = "tool") -> Array:
        """6x6, world axes: N/m, N/rad, N m/rad."""
    def mass(self, posture: Sequence[float] | None = None) -> Array:
        """NxN, kg m^2 (kg for slides)."""
    def modes(self, posture: Sequence[float] | None = None) -> dict[str, Array]:
        """`frequency_hz`, `damping_ratio`, `shapes`."""
