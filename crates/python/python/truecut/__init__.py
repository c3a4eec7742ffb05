"""Physics-backed simulation of robotic machining.

    import truecut

    recording = truecut.load("scenarios/chamfer/backward_sufficient.toml").run()
    recording.holds                      # every claim
    recording["tool.displacement_y"]     # a NumPy array, m

A recording is an Arrow table without a copy: `pyarrow.table(recording)`, `polars.DataFrame(recording)`. All numbers are
SI, but those of `overrides`, which are in their keys' own units. Work goes on without the interpreter's lock, Ctrl-C
stops it, and what is wrong with a file is a `TruecutError` with `file`, `line`, `key` and `rule`.

Neither NumPy nor pyarrow is imported before it is used.
"""

from ._truecut import (
    VERSION as __version__,
    Profile,
    Recording,
    Robot,
    Scalar,
    Scenario,
    SweepTable,
    TruecutError,
    load,
    lobes,
)

__all__ = ["Profile", "Recording", "Robot", "Scalar", "Scenario", "SweepTable", "TruecutError", "load", "lobes"]
