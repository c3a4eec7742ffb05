"""G-code beside LinuxCNC's own interpreter, `rs274`: files drawn from seeds, those of other people's CAM, and LinuxCNC's samples.

`TRUECUT_RS274` names that program, `TRUECUT_NC_FILES` a folder of G-code that other people's tools wrote (LinuxCNC installs one
as `share/linuxcnc/ncfiles`); without them the tests are skipped.
"""

from __future__ import annotations

import math
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from test_cam import SAMPLES, SEEDS, drawn_gcode, rows

RS274 = os.environ.get("TRUECUT_RS274")
NC_FILES = os.environ.get("TRUECUT_NC_FILES")
pytestmark = pytest.mark.skipif(RS274 is None, reason="TRUECUT_RS274 names no rs274")

CALL = re.compile(r"\d+ N\S* +(\w+)\((.*)\)")
PLANES = {"CANON_PLANE_XY": (0, 1, 2), "CANON_PLANE_YZ": (1, 2, 0), "CANON_PLANE_XZ": (2, 0, 1)}
UNITS = {"CANON_UNITS_MM": 1.0, "CANON_UNITS_INCHES": 25.4}
# what is asked for, a micrometre, in mm
APART_MM = 1e-3
# files that say a way, of LinuxCNC's samples; the others hold variables, subprograms or words of their machine alone
OTHERS = ["arcspiral.ngc", "cds.ngc", "tort.ngc"]


class Move:
    """A line or an arc, mm, each number of it rounded to four decimals of the file's unit."""

    def __init__(self, start: np.ndarray, end: np.ndarray, unit: float) -> None:
        self.start, self.end, self.arc = start, end, None
        # on an arc start, centre and end are rounded
        self.apart_mm = APART_MM + 3 * 0.5e-4 * unit * math.sqrt(2)

    def distance(self, place: np.ndarray) -> float:
        if self.arc is None:
            return float(np.linalg.norm(place - self.end))
        (first, second, _), centre = self.arc
        ends = (place, self.start, self.end)
        here, begun, ended = (float(np.hypot(at[first] - centre[0], at[second] - centre[1])) for at in ends)
        # files round their centres: the radius goes from that of the start to that of the end
        return max(0.0, here - max(begun, ended), min(begun, ended) - here)


# what says nothing and the interpreter refuses: a tape's mark with a name, a centre's zero out of the one plane of the file
SILENT = re.compile(r"^%.*$|^;.*$", re.MULTILINE)
ZERO_OUT_OF_XY = re.compile(r"\bK-?0\.0*\b")


def moves(file: Path, folder: Path) -> list[Move]:
    """What the interpreter makes of a file."""
    tools, out = folder / "t.tbl", folder / "canon.txt"
    tools.write_text("".join(f"T{k} P{k} D6\n" for k in range(1, 100)))
    plain = folder / "plain.ngc"
    words = SILENT.sub("", file.read_text(encoding="utf-8"))
    words = words if re.search("G18|G19", words) else ZERO_OUT_OF_XY.sub("", words)
    plain.write_text(words + "\nM2\n", encoding="utf-8")
    command = [RS274, "-t", tools, "-v", folder / "t.var", "-n", "0", "-g", plain, out]
    subprocess.run(command, check=True, capture_output=True, timeout=120, stdin=subprocess.DEVNULL)
    unit, plane, place, found = 1.0, PLANES["CANON_PLANE_XY"], np.zeros(3), []
    for line in out.read_text().splitlines():
        call = CALL.match(line.strip())
        if call is None:
            continue
        name, arguments = call.group(1), call.group(2).split(",")
        if name == "USE_LENGTH_UNITS":
            unit = UNITS[arguments[0]]
        elif name == "SELECT_PLANE":
            plane = PLANES[arguments[0]]
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            move = Move(place, np.array([float(text) * unit for text in arguments[:3]]), unit)
            found.append(move)
            place = move.end
        elif name == "ARC_FEED":
            ends = [float(text) * unit for text in (arguments[0], arguments[1], arguments[5])]
            end = np.zeros(3)
            end[list(plane)] = ends
            move = Move(place, end, unit)
            move.arc = plane, np.array([float(text) * unit for text in arguments[2:4]])
            found.append(move)
            place = end
    return found


def compare(file: Path, truecut, folder: Path) -> float:
    """Largest distance of the program's points from the interpreter's moves, mm."""
    pieces: list[list[np.ndarray]] = []
    before = None
    for line, place, _ in rows(truecut, file, folder / "out"):
        if line != before:
            pieces.append([])
        pieces[-1].append(place)
        before = line
    wanted = moves(file, folder)
    # the first point is where all axes have a place
    first = next(k for k, move in enumerate(wanted) if np.linalg.norm(move.end - pieces[0][-1]) <= move.apart_mm)
    # what goes nowhere is no move
    wanted = [move for move in wanted[first + 1 :] if move.arc or np.linalg.norm(move.end - move.start) > 1e-9]
    ends = [pieces[0][-1]] + [piece[-1] for piece in pieces]
    pieces = [p for k, p in enumerate(pieces) if k > 0 and (len(p) > 1 or np.linalg.norm(p[-1] - ends[k]) > 1e-9)]
    assert len(pieces) == len(wanted), f"{len(pieces)} moves, {len(wanted)} by the interpreter"
    most = 0.0
    for piece, move in zip(pieces, wanted):
        apart = [move.distance(place) for place in piece]
        apart.append(float(np.linalg.norm(piece[-1] - move.end)))
        assert max(apart) <= move.apart_mm, f"{piece[-1]} beside {move.end}"
        most = max(most, *apart)
    return most


@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_files_are_the_path_of_linuxcnc(truecut, tmp_path, seed):
    file = tmp_path / "drawn.ngc"
    file.write_text(drawn_gcode(seed))
    most = compare(file, truecut, tmp_path)
    print(f"seed {seed}: {most * 1e3:.3f} um")


def says_its_way(file: Path) -> bool:
    """Whether it is G-code of an upright tool without moves of the machine's own, of which the interpreter prints no place."""
    words = re.sub(r"\(.*?\)|;.*", "", file.read_text(encoding="utf-8").upper())
    return file.suffix not in (".cls", ".apt", ".mpf") and not re.search("G28|G30|G53", words)


@pytest.mark.parametrize("file", [file for file in SAMPLES if says_its_way(file)], ids=lambda file: file.name)
def test_files_of_cam_posts_are_the_path_of_linuxcnc(truecut, tmp_path, file):
    print(f"{file.name}: {compare(file, truecut, tmp_path) * 1e3:.3f} um")


@pytest.mark.skipif(NC_FILES is None, reason="TRUECUT_NC_FILES names no folder")
@pytest.mark.parametrize("name", OTHERS)
def test_files_of_other_people_are_the_path_of_linuxcnc(truecut, tmp_path, name):
    print(f"{name}: {compare(Path(NC_FILES) / name, truecut, tmp_path) * 1e3:.3f} um")


@pytest.mark.skipif(NC_FILES is None, reason="TRUECUT_NC_FILES names no folder")
@pytest.mark.parametrize("name", OTHERS)
def test_what_files_in_inches_are_apart_by_is_the_rounding_of_the_listing(truecut, tmp_path, name):
    # the listing has four decimals of an inch: 1.27 um in one axis, 1.80 in two; the same numbers in mm are listed to 0.05 um
    file = tmp_path / name
    file.write_text(re.sub(r"\bG20\b", "G21", (Path(NC_FILES) / name).read_text(encoding="utf-8"), flags=re.IGNORECASE))
    most = compare(file, truecut, tmp_path)
    print(f"{name} in mm: {most * 1e3:.3f} um")
    assert most <= 0.2 * APART_MM


@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_files_in_millimetres_are_the_path_of_linuxcnc(truecut, tmp_path, seed):
    file = tmp_path / "drawn.ngc"
    file.write_text(drawn_gcode(seed).replace("G20", "G21"))
    most = compare(file, truecut, tmp_path)
    print(f"seed {seed} in mm: {most * 1e3:.3f} um")
    assert most <= APART_MM
