"""Parts of another modeller: what STEP and STL files of build123d (Open CASCADE) hold, beside what the modeller says of them.

Needs `pip install build123d`, which is large and not among the tests' requirements: without it the tests are skipped.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import modelled_parts

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("TRUECUT_BIN", ROOT / "target" / "release" / "truecut"))
PARTS = ROOT / "assets" / "parts"
SEEDS = range(24)


def told(file: Path, out: Path) -> dict:
    """What `truecut part` says."""
    command = [PROGRAM, "part", file, "--json", "--out", out]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def area(face) -> float:
    """Of a prism's wall its outline times its height: Open CASCADE integrates it to 0.1 % only (seed 10: 2911.05 mm2, where
    the outline cut into 10 000 chords gives 2908.08)."""
    if face.geom_type.name != "EXTRUSION":
        return face.area
    outline = max(face.edges(), key=lambda edge: edge.length)
    return outline.length * min(edge.length for edge in face.edges() if edge.geom_type.name == "LINE")


@pytest.mark.parametrize("seed", SEEDS)
def test_crosscheck_faces_of_drawn_step_files_have_the_modellers_areas(seed, tmp_path):
    """All faces of parts of eight families to 0.1 %, and bodies that are closed, with the volume."""
    modeller = pytest.importorskip("build123d", reason="build123d is not installed")
    _, part = modelled_parts.drawn(seed)
    file = tmp_path / "part.step"
    modeller.export_step(part, str(file))
    found = told(file, tmp_path)
    own = sorted(face["area_m2"] * 1e6 for face in found["step_faces"])
    known = sorted(area(face) for face in part.faces())
    assert len(own) == len(known)
    assert max(abs(a / b - 1) for a, b in zip(own, known, strict=True)) < 1e-3
    assert abs(found["volume_m3"] * 1e9 / part.volume - 1) < 2e-3
    box = part.bounding_box()
    for mine, its in zip(found["low_m"] + found["high_m"], [*box.min, *box.max], strict=True):
        assert abs(mine * 1e3 - its) < 0.1


@pytest.mark.parametrize("name", ["bracket", "plate", "flange"])
def test_crosscheck_stl_and_step_of_a_part_are_the_same_body(name, tmp_path):
    """The shipped files, without the modeller: volume and area to the chords of the mesh, 0.04 mm on the flange's dome."""
    meshed, modelled = [told(PARTS / f"{name}.{ending}", tmp_path) for ending in ("stl", "step")]
    for key in ("volume_m3", "area_m2"):
        assert abs(meshed[key] / modelled[key] - 1) < 4e-3, key
    assert len(meshed["faces"]) == len(modelled["faces"])
    assert len(meshed["edges"]) == len(modelled["edges"])
    closed = [sum(edge["closed"] for edge in part["edges"]) for part in (meshed, modelled)]
    assert closed[0] == closed[1] > 0


def test_crosscheck_the_shipped_parts_are_those_of_their_script(tmp_path):
    """`draw.py` makes them anew."""
    pytest.importorskip("build123d", reason="build123d is not installed")
    subprocess.run([sys.executable, PARTS / "draw.py", tmp_path], check=True, timeout=300, capture_output=True)
    for name in ("bracket", "plate", "flange"):
        for ending in ("stl", "step"):
            file = f"{name}.{ending}"
            made, shipped = told(tmp_path / file, tmp_path), told(PARTS / file, tmp_path)
            for key in ("volume_m3", "area_m2"):
                assert abs(made[key] / shipped[key] - 1) < 1e-4, (file, key)
