"""Paths of CAM files as `truecut path` reads them, beside an interpreter written apart (tests/reference/cam_paths.py).

Files are drawn from seeds, and a few are written by hand in the style of usual CAM posts.
"""

from __future__ import annotations

import csv
import math
import random
import sys
from pathlib import Path

import numpy as np
import pytest

from conftest import ROBOTS, ROOT

sys.path.insert(0, str(ROOT / "tests" / "reference"))
import cam_paths

SAMPLES = sorted((ROOT / "tests" / "crosscheck" / "cam").iterdir())
SEEDS = range(24)
# what is asked for: a micrometre, in mm
APART_MM = 1e-3
CHORD_MM = 0.01


def rows(truecut, file: Path, out: Path) -> list[tuple[int, np.ndarray, str]]:
    """Line, place in the work frame and feed of each point that the program takes."""
    done = truecut.run(
        "path", file, "--robot", ROBOTS / "hp20" / "robot.urdf", "--work-xyz-mm", "900,0,350", "--dialect", "urscript",
        "--out", out,
    )  # fmt: skip
    # 1 says that the arm would be too fast somewhere: its path is read all the same
    assert done.returncode in (0, 1), done.stdout + done.stderr
    with (out / file.stem / "path.csv").open(encoding="utf-8") as text:
        return [
            (int(row["line"]), np.array([float(row[f"work_{axis}_mm"]) for axis in "xyz"]), row["feed_mm_per_s"])
            for row in csv.DictReader(text)
        ]


def compare(found: list[tuple[int, np.ndarray, str]], pieces: list[cam_paths.Piece]) -> None:
    """Every point lies on the piece of its line, in order; every piece is ended; chords keep to their tolerance."""
    at = 0
    for piece, after in zip(pieces, [*pieces[1:], None]):
        mine = []
        # several pieces of one line are rapids, of one point each
        alone = after is None or after.line != piece.line
        while at < len(found) and found[at][0] == piece.line and (alone or not mine):
            mine.append(found[at])
            at += 1
        assert mine, f"no point of line {piece.line}"
        for _, place, _ in mine:
            assert piece.distance(place) <= APART_MM, f"line {piece.line}: {place}"
        assert np.linalg.norm(mine[-1][1] - piece.end) <= APART_MM, f"line {piece.line} ends at {mine[-1][1]}"
        if piece is not pieces[0] and piece.feed is not None:
            assert all(abs(float(feed) - piece.feed / 60) <= 6e-4 for *_, feed in mine), f"line {piece.line}: feed"
        if piece.centre is not None:
            spoke = piece.start - piece.centre
            radius = math.hypot(spoke @ piece.first, spoke @ piece.second)
            step = abs(piece.sweep) / len(mine)
            assert radius * (1 - math.cos(step / 2)) <= CHORD_MM * 1.001, f"line {piece.line}: chords"
    assert at == len(found), f"{len(found) - at} points too many"


def drawn_gcode(seed: int) -> str:
    """A program of lines, arcs in the three planes, helices and whole turns, in mm or inches, absolute or in steps."""
    draw = random.Random(seed)
    unit = draw.choice([1.0, 25.4])
    digits = 4 if unit == 1.0 else 6
    place = [0.0, 0.0, 20.0]

    def show(mm: float) -> str:
        text = f"{mm / unit:.{digits}f}"
        return draw.choice([text, text.rstrip("0"), f"+{text}" if mm >= 0 else text])

    lines = [f"O{draw.randint(1, 9999)} (drawn)", f"N10 G{20 if unit != 1 else 21} G90 G17 G40 G80"]
    lines += [f"G0 X{show(0)} Y{show(0)} Z{show(20)}", f"F{draw.randint(200, 900) / unit:.3f} S8000 M3"]
    absolute = True
    for number in range(40):
        head = draw.choice(["", f"N{20 + number} ", "/"])
        if draw.random() < 0.15:
            absolute = not absolute
            lines.append(f"{head}G{90 if absolute else 91} (change)")
        # as the control sees it: rounded to what is printed
        place = [round(value / unit, digits) * unit for value in place]
        end = [draw.uniform(-30, 30), draw.uniform(-30, 30), draw.uniform(0, 30)]
        plane, (u, v, w) = draw.choice([(17, (0, 1, 2)), (18, (2, 0, 1)), (19, (1, 2, 0))])
        kind = draw.choice(["rapid", "line", "line", "radius", "centre", "whole"])
        words = ""
        if kind in ("rapid", "line"):
            words = "G0" if kind == "rapid" else "G1"
            moved = draw.sample(range(3), draw.randint(1, 3))
            end = [end[k] if k in moved else place[k] for k in range(3)]
        else:
            sense = draw.choice([2, 3])
            words = f"G{plane} G{sense}"
            if draw.random() < 0.5:
                end[w] = place[w]
            if kind == "radius":
                half = math.hypot(end[u] - place[u], end[v] - place[v]) / 2
                tail = f" R{draw.choice([1, -1]) * half * draw.uniform(1.01, 2) / unit:.{digits}f}"
            else:
                radius, angle = draw.uniform(3, 20), draw.uniform(0, 2 * math.pi)
                centre = [place[u] + radius * math.cos(angle), place[v] + radius * math.sin(angle)]
                centre = [round((c - p) / unit, digits) * unit + p for c, p in zip(centre, (place[u], place[v]))]
                radius = math.hypot(centre[0] - place[u], centre[1] - place[v])
                angle = draw.uniform(0, 2 * math.pi)
                if kind == "whole":
                    end[u], end[v] = place[u], place[v]
                else:
                    end[u], end[v] = centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)
                tail = f" {'IJK'[u]}{show(centre[0] - place[u])} {'IJK'[v]}{show(centre[1] - place[v])}"
        end = [round(value / unit, digits) * unit for value in end]
        for k, letter in enumerate("XYZ"):
            if end[k] != place[k] or kind == "radius":
                words += f" {letter}{show(end[k] if absolute else end[k] - place[k])}"
        if kind not in ("rapid", "line"):
            words += tail
        lines.append(head + words.lower() if draw.random() < 0.1 else head + words)
        place = end
    return "\n".join([*lines, "M5", "M30", "G0 X99"]) + "\n"


def drawn_apt(seed: int) -> str:
    """Cutter locations: lines, arcs about axes of any direction, rapid moves, axes of the tool."""
    draw = random.Random(1000 + seed)
    inches = draw.random() < 0.5
    unit = 25.4 if inches else 1.0
    lines = ["PARTNO/DRAWN", f"UNITS/{'INCHES' if inches else 'MM'}", "MULTAX/ON", "LOADTL/1", "SPINDL/8000,CLW"]
    place = np.array([0.0, 0.0, 30.0])

    def goto(word: str, mm: np.ndarray) -> str:
        tilt = [draw.uniform(-0.15, 0.15), draw.uniform(-0.15, 0.15), 1.0]
        text = ",".join(f"{value:.9f}" for value in [*(mm / unit), *tilt])
        return f"{word}/{text[: len(text) // 2]}$\n  {text[len(text) // 2 :]}" if draw.random() < 0.3 else f"{word}/{text}"

    lines += [goto("FROM", place), f"FEDRAT/{draw.randint(200, 900)},MMPM $$ feed"]
    for _ in range(30):
        if draw.random() < 0.4:
            axis = np.array([draw.gauss(0, 1) for _ in range(3)])
            axis /= np.linalg.norm(axis)
            spoke = np.cross(axis, [draw.gauss(0, 1) for _ in range(3)])
            spoke *= draw.uniform(3, 12) / np.linalg.norm(spoke)
            angle = draw.uniform(0.1, 6.0)
            end = place - spoke + math.cos(angle) * spoke + math.sin(angle) * np.cross(axis, spoke)
            numbers = [*((place - spoke) / unit), *axis, np.linalg.norm(spoke) / unit]
            lines.append("CIRCLE/" + ",".join(f"{value:.9f}" for value in numbers))
            place = end
        else:
            if draw.random() < 0.2:
                lines.append("RAPID")
            place = np.array([draw.uniform(-30, 30), draw.uniform(-30, 30), draw.uniform(0, 30)])
        lines.append(goto("GOTO", place))
    return "\n".join([*lines, "SPINDL/OFF", "FINI"]) + "\n"


@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_gcode_is_the_path_of_another_interpreter(truecut, tmp_path, seed):
    """A micrometre at every point, the feed of every line."""
    text = drawn_gcode(seed)
    file = tmp_path / f"drawn_{seed}.nc"
    file.write_text(text, encoding="utf-8")
    compare(rows(truecut, file, tmp_path / "out"), cam_paths.gcode(text))


@pytest.mark.parametrize("seed", SEEDS[:12])
def test_drawn_apt_is_the_path_of_another_interpreter(truecut, tmp_path, seed):
    """As with G-code."""
    text = drawn_apt(seed)
    file = tmp_path / f"drawn_{seed}.apt"
    file.write_text(text, encoding="utf-8")
    compare(rows(truecut, file, tmp_path / "out"), cam_paths.apt(text))


@pytest.mark.parametrize("file", SAMPLES, ids=lambda file: file.name)
def test_files_in_the_style_of_cam_posts(truecut, tmp_path, file):
    """Written by hand, as usual posts write."""
    text = file.read_text(encoding="utf-8")
    read = cam_paths.apt if file.suffix in (".apt", ".cls") else cam_paths.gcode
    compare(rows(truecut, file, tmp_path / "out"), read(text))
