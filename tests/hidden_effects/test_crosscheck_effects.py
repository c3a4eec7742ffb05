"""Every effect in truecut and in the generator: the same effect must leave the same trace in both."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, dataset  # noqa: E402
from bench.cases import Case  # noqa: E402
from bench.experiment import ALL, Experiment  # noqa: E402
from bench.library import BELT, BRUSH, CLOCK, POLISHING, POLISHING_EDGE, SINGLES, TILT, ZERO  # noqa: E402
from bench.noise import rms  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
TARGET_KEY = {int: "joint", str: "channel"}
TEMPLATES = SINGLES + POLISHING + BELT + BRUSH + POLISHING_EDGE + CLOCK + TILT + ZERO


def recorded(experiment: Experiment, effects: tuple, folder: Path) -> np.ndarray:
    """Outputs of truecut's run of a bench scenario with effects, at the samples."""
    silent = Case("clean", experiment.name, (), "nothing", (0.0,) * len(experiment.uncertain), "white", 1, noise=0.0)
    columns, _ = dataset.measurement(silent)
    dataset.write_csv(folder / "data.csv", columns)
    text = experiment.path.read_text(encoding="utf-8").replace("../../../assets", str(ROOT / "assets"))
    for key in ("job", "taught"):
        text = text.replace(f'{key} = "', f'{key} = "{experiment.path.parent}/')
    for effect in effects:
        text += f'\n[[effect]]\nkind = "{effect.kind}"\n'
        if effect.kind in ("base_compliance", "base_tilt"):
            text += f'axis = "{effect.target}"\n'
        elif effect.target is not None:
            target = effect.target if isinstance(effect.target, int) else f'"{effect.target}"'
            text += f"{TARGET_KEY[type(effect.target)]} = {target}\n"
        text += "".join(f"{key} = {value!r}\n" for key, value in effect.values.items())
    path = folder / "scenario.toml"
    path.write_text(text, encoding="utf-8")
    command = [PROGRAM, "run", path, "--out", folder / "out", "--no-rrd"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    table = pyarrow.parquet.read_table(folder / "out" / "scenario" / "recording.parquet")
    time_s = table["time"].to_numpy()
    at_s = experiment.pass_time_s
    one = np.stack([np.interp(at_s, time_s, table[c.channel].to_numpy()) for c in experiment.outputs], 1)
    return np.concatenate([one] * experiment.passes)


@pytest.mark.parametrize("name", sorted({t.experiment for t in TEMPLATES}))
def test_crosscheck_mujoco_clean_data_is_the_nominal_run(name, tmp_path):
    """Clean data and truecut's nominal run differ by less than a fifth of the reference noise."""
    experiment = ALL[name]
    apart = rms(recorded(experiment, (), tmp_path) - experiment.outputs_of()) / np.array(experiment.reference_noise)
    assert apart.max() < 0.2, apart


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda t: f"{t.experiment}-{t.kind}-{t.target}")
def test_crosscheck_mujoco_effects_leave_the_same_trace(template, tmp_path):
    """The two sides differ by less than 5 % of what the effect changes, or a fifth of the reference noise."""
    experiment = ALL[template.experiment]
    effect = template.at(1.0)
    noise = np.array(experiment.reference_noise)
    mine = experiment.outputs_of((effect,))
    change = rms((mine - experiment.outputs_of()) / noise)
    apart = rms((recorded(experiment, (effect,), tmp_path) - mine) / noise)
    assert np.all(apart < np.maximum(0.05 * change.max(), 0.2)), (apart, change)
