"""Grains at an edge: along one line they are all but what friction is, a second line away from the edge tells them apart."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench import ROOT, drawn_wheels  # noqa: E402
from bench.effects import Effect  # noqa: E402
from bench.experiment import POLISH_EDGE  # noqa: E402
from bench.noise import in_band, rms, unit_noise  # noqa: E402
from truecut_reference.sampled import some  # noqa: E402

PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
RATE_HZ, BAND_HZ = POLISH_EDGE.rate_hz, POLISH_EDGE.band_hz
SHARE = 0.7
LEVEL = 2.0
# With two lines of 24 mm, at 15 mm/s.
TWO_LINES_S = 5.5
COLOURS = ("white", "ar1")


def test_crosscheck_mujoco_odds_of_grains_along_one_line():
    """At the middle level the data hold the grains clearly, and hardly tell them from more friction: minus twice the
    log-likelihood must fall by 6 for odds of 20 to 1, and by 12 for 400 to 1. At the strong level they do tell."""
    grains = Effect("wheel_edge_grains", None, {"share": SHARE})
    machine = drawn_wheels.Machine(POLISH_EDGE, grains, (0.0, 0.0))
    for colour in COLOURS:
        energy, beyond = drawn_wheels.energies(machine, colour, LEVEL)
        assert energy > 200.0
        assert max(beyond["wheel_friction"], beyond["sensor_gain"]) < 12.0
        _, beyond = drawn_wheels.energies(machine, colour, 10.0)
        assert min(beyond.values()) > 100.0


def test_verify_noise_is_whitened():
    """By its own recursion noise of either colour becomes white of one size."""
    for colour in COLOURS:
        noise = unit_noise(colour, 40_000, 1, RATE_HZ, BAND_HZ, 5)
        white = drawn_wheels.whitened(noise, colour)[200:, 0] / drawn_wheels._whole_over_band(POLISH_EDGE, colour)
        assert np.std(white) == pytest.approx(1.0, rel=0.02)
        assert abs(np.mean(white[1:] * white[:-1])) < 0.02


class Lines:
    """A wheel led along the edge, once or also back in the middle of the face, and measured by the program's own run."""

    def __init__(self, folder: Path, two: bool) -> None:
        text = POLISH_EDGE.path.read_text(encoding="utf-8").replace("../../../", f"{ROOT}/")
        if two:
            text = text.replace("length_mm = 78", "length_mm = 24")
            text = text.replace(f"duration_s = {2.45}", f"duration_s = {TWO_LINES_S}")
            assert f"duration_s = {TWO_LINES_S}" in text
        else:
            # so round that its load hardly varies
            text = text.replace("eccentricity_um = 50", "eccentricity_um = 10")
            assert "eccentricity_um = 10" in text
        self.folder, self.columns = folder, POLISH_EDGE.outputs
        self.time_s = np.arange(0.0, (TWO_LINES_S if two else 2.45) - 0.05, 1.0 / RATE_HZ)
        self.scenario = folder / "nominal.toml"
        self.scenario.write_text(text, encoding="utf-8")
        hidden = f'\n[[effect]]\nkind = "wheel_edge_grains"\nshare = {SHARE}\n'
        (folder / "hidden.toml").write_text(text + hidden, encoding="utf-8")
        self.nominal, self.true = self._run("nominal"), self._run("hidden")

    def _run(self, name: str) -> np.ndarray:
        out = self.folder / "out"
        command = [PROGRAM, "run", self.folder / f"{name}.toml", "--no-rrd", "--out", out]
        subprocess.run(command, check=True, capture_output=True)
        table = pyarrow.parquet.read_table(next(out.rglob(f"{name}/recording.parquet"))).to_pydict()
        time_s = np.array([t.total_seconds() if hasattr(t, "total_seconds") else t for t in table["time"]])
        found = []
        for column in self.columns:
            values = np.array(table[column.channel], float)
            told = np.isfinite(values)
            found.append(np.interp(self.time_s, time_s[told], values[told]))
        return np.stack(found, axis=1)

    def diagnosed(self, colour: str, seed: int) -> dict:
        """The answer at the middle level."""
        reference = np.array(POLISH_EDGE.reference_noise)
        size = rms(in_band((self.true - self.nominal) / reference, RATE_HZ, BAND_HZ)).max()
        noise = unit_noise(colour, *self.true.shape, RATE_HZ, BAND_HZ, seed) * size / LEVEL * reference
        measured = (self.true + noise) / np.array([column.si for column in self.columns])
        data = self.folder / f"{colour}.csv"
        lines = [",".join(["t_s", *(column.name for column in self.columns)])]
        lines += [",".join(f"{x:.9g}" for x in (t, *row)) for t, row in zip(self.time_s, measured)]
        data.write_text("\n".join(lines) + "\n", encoding="utf-8")
        out = self.folder / f"answer_{colour}"
        command = [PROGRAM, "diagnose", self.scenario, "--data", data, "--out", out]
        subprocess.run(command, check=True, capture_output=True)
        return json.loads(next(out.rglob("diagnosis.json")).read_text(encoding="utf-8"))


def kinds(answer: dict) -> set[str]:
    """Kinds of all that is put forward."""
    others = [cause for other in answer["alternatives"] for cause in other.get("causes", [other])]
    return {cause["kind"] for cause in answer["causes"] + others}


@pytest.mark.parametrize("colour", some(COLOURS, 1))
def test_one_line_leaves_grains_and_friction_alike(colour, tmp_path):
    """Of a wheel that runs true the answer says so, instead of naming one of them."""
    answer = Lines(tmp_path, two=False).diagnosed(colour, 91_001)
    assert answer["verdict"] == "ambiguous"
    assert {"wheel_edge_grains", "wheel_friction"} <= kinds(answer)


@pytest.mark.parametrize("colour", some(COLOURS, 1))
def test_a_second_line_away_from_the_edge_tells_grains(colour, tmp_path):
    """In the middle of the face friction would show as well, and grains do not."""
    answer = Lines(tmp_path, two=True).diagnosed(colour, 91_002)
    assert answer["verdict"] == "named"
    assert [cause["kind"] for cause in answer["causes"]] == ["wheel_edge_grains"]
    assert answer["causes"][0]["parameters"]["share"]["value"] == pytest.approx(SHARE, rel=0.15)
