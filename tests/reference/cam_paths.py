"""Paths of G-code and APT computed anew, without the program: each statement as an exact line or arc.

Laws: ISO 6983 (G-code: modal codes, G2 and G3 seen against the plane's normal, I, J, K from the start of the arc, a
negative R the long way round) and ISO 4343 (APT: CIRCLE gives centre, axis and radius of the arc that the next GOTO
ends, right-handed about the axis). Lengths in mm, feeds in mm/min.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

INCH = 25.4
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


@dataclass
class Piece:
    """A line, or an arc of `sweep` rad about `centre` in the plane of the axes `first` and `second`.

    Files round their centres, so that the radii at both ends differ: between them it grows evenly with the angle.
    """

    line: int
    start: np.ndarray
    end: np.ndarray
    feed: float | None
    centre: np.ndarray | None = None
    first: np.ndarray | None = None
    second: np.ndarray | None = None
    sweep: float = 0.0

    def place(self, share: float) -> np.ndarray:
        """The exact place at a share of the way."""
        if self.centre is None:
            return self.start + share * (self.end - self.start)
        spoke, last = self.start - self.centre, self.end - self.centre
        angle = math.atan2(spoke @ self.second, spoke @ self.first) + share * self.sweep
        begin, close = (math.hypot(at @ self.first, at @ self.second) for at in (spoke, last))
        radius = begin + share * (close - begin)
        normal = np.cross(self.first, self.second)
        rise = normal * (normal @ (self.start - self.centre) + share * (normal @ (self.end - self.start)))
        return self.centre + radius * (math.cos(angle) * self.first + math.sin(angle) * self.second) + rise

    def distance(self, place: np.ndarray) -> float:
        """How far a place lies off the piece."""
        if self.centre is None:
            way = self.end - self.start
            length = float(way @ way)
            share = 0.0 if length == 0 else float(np.clip((place - self.start) @ way / length, 0, 1))
            return float(np.linalg.norm(place - self.place(share)))
        spoke, there = self.start - self.centre, place - self.centre
        begin = math.atan2(spoke @ self.second, spoke @ self.first)
        turned = math.atan2(there @ self.second, there @ self.first) - begin
        turned = math.copysign(1, self.sweep) * (math.copysign(1, self.sweep) * turned % (2 * math.pi))
        shares = [turned / self.sweep, (turned - math.copysign(2 * math.pi, self.sweep)) / self.sweep, 0.0, 1.0]
        return min(float(np.linalg.norm(place - self.place(share))) for share in shares if -1e-9 <= share <= 1 + 1e-9)


def gcode(text: str) -> list[Piece]:
    """The pieces of a G-code program whose tool is upright.

    An axis has no place (nan) until an absolute word gives one, nor after the machine moved it in its own coordinates
    (G28, G30, G53): from there the tool goes up to the greatest Z of the file, and across at it to the next place that
    is known. Until the pieces are whole that height is written as infinity.
    """
    pieces: list[Piece] = []
    place, unit, absolute, plane, mode, feed, left = np.full(3, np.nan), 1.0, True, 17, None, None, None
    for number, raw in enumerate(text.splitlines(), 1):
        block = re.sub(r"\(.*?\)|;.*|^%.*", "", raw).upper()
        words = [(a, float(b)) for a, b in re.findall(r"([A-Z])\s*([-+]?\d*\.?\d+\.?)", block)]
        codes = [value for letter, value in words if letter == "G"]
        values = {letter: value for letter, value in words if letter not in "GMN"}
        for code in codes:
            match code:
                case 20 | 21:
                    unit = INCH if code == 20 else 1.0
                case 90 | 91:
                    absolute = code == 90
                case 17 | 18 | 19:
                    plane = int(code)
                case 0 | 1 | 2 | 3:
                    mode = int(code)
        if "F" in values:
            feed = values["F"] * unit
        end = place.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in values:
                end[axis] = values[letter] * unit + (0 if absolute else place[axis])
        if any(code in (28, 30, 53) for code in codes):
            if pieces and left is None:
                if 53 not in codes and np.any(end != place):
                    pieces.append(Piece(number, place, end, None))
                    place = end
                left = np.array([place[0], place[1], np.inf])
                pieces.append(Piece(number, place, left, None))
            moved = [axis for axis, letter in enumerate("XYZ") if letter in values] or [0, 1, 2]
            place = place.copy()
            place[moved] = np.nan
        elif 4 not in codes and (any(letter in values for letter in "XYZABC") or mode in (2, 3) and set("IJKR") & set(values)):
            known = not np.any(np.isnan(end))
            if known and left is not None:
                over = np.array([end[0], end[1], np.inf])
                pieces += [Piece(number, left, over, None), Piece(number, over, end, None)]
                left = None
            elif known:
                piece = Piece(number, place if pieces else end, end, None if mode == 0 else feed)
                if mode in (2, 3):
                    bend(piece, values, unit, PLANES[plane], mode == 2)
                pieces.append(piece)
            place = end
        if any(letter == "M" and value in (2, 30) for letter, value in words):
            break
    return at_height(pieces)


def at_height(pieces: list[Piece]) -> list[Piece]:
    """The pieces with the greatest height in the place of infinity; none where the tool is there already."""
    heights = [float(place[2]) for piece in pieces for place in (piece.start, piece.end)]
    greatest = max((height for height in heights if math.isfinite(height)), default=0.0)
    kept = []
    for piece in pieces:
        own = math.isinf(piece.start[2]) or math.isinf(piece.end[2])
        piece.start, piece.end = (np.where(np.isinf(place), greatest, place) for place in (piece.start, piece.end))
        if not own or np.any(piece.start != piece.end):
            kept.append(piece)
    return kept


def bend(piece: Piece, values: dict[str, float], unit: float, axes: tuple[int, int, int], clockwise: bool) -> None:
    """Makes a piece an arc."""
    u, v, _ = axes
    piece.first, piece.second = np.eye(3)[u], np.eye(3)[v]
    start, end = piece.start[[u, v]], piece.end[[u, v]]
    if "R" in values:
        radius = values["R"] * unit
        chord = end - start
        length = float(np.hypot(*chord))
        height = math.sqrt(max(radius**2 - length**2 / 4, 0.0))
        side = math.copysign(1, radius) * (-1 if clockwise else 1)
        centre = (start + end) / 2 + side * height * np.array([-chord[1], chord[0]]) / length
    else:
        centre = start + unit * np.array([values.get("IJK"[u], 0.0), values.get("IJK"[v], 0.0)])
    piece.centre = piece.start.copy()
    piece.centre[[u, v]] = centre
    begin, stop = (math.atan2(*(p - centre)[::-1]) for p in (start, end))
    sweep = (stop - begin) % (2 * math.pi)
    if np.allclose(start, end, atol=1e-9):
        sweep = 2 * math.pi
    elif clockwise:
        sweep -= 2 * math.pi
    piece.sweep = -2 * math.pi if clockwise and sweep == 2 * math.pi else sweep


def apt(text: str) -> list[Piece]:
    """The pieces of APT cutter locations; the first point is a piece without length."""
    pieces: list[Piece] = []
    unit, feed, rapid, place, circle = 1.0, None, False, None, None
    joined = re.sub(r"\$\$.*", "", text)
    statements, open_at, open_text = [], None, ""
    for number, line in enumerate(joined.splitlines(), 1):
        open_at = open_at or number
        open_text += line.strip()
        if open_text.endswith("$"):
            open_text = open_text[:-1]
            continue
        statements.append((open_at, open_text))
        open_at, open_text = None, ""
    for number, statement in statements:
        word, _, rest = statement.partition("/")
        numbers = [float(part) for part in rest.split(",") if re.fullmatch(r"\s*[-+]?[\d.]+(E[-+]?\d+)?\s*", part)]
        match word.strip():
            case "UNITS":
                unit = INCH if rest.strip() == "INCHES" else 1.0
            case "FEDRAT":
                feed, rapid = numbers[0] * (INCH if "IPM" in rest else 1.0), False
            case "RAPID":
                rapid = True
            case "CIRCLE":
                circle = np.array(numbers[:7])
            case "GOTO" | "FROM":
                end = np.array(numbers[:3]) * unit
                start = end if place is None else place
                piece = Piece(number, start, end, None if rapid or word == "FROM" else feed)
                if circle is not None:
                    around(piece, circle, unit)
                pieces.append(piece)
                rapid, place, circle = False, end, None
            case "FINI" | "END":
                break
    return pieces


def around(piece: Piece, circle: np.ndarray, unit: float) -> None:
    """Makes a piece an arc, right-handed about the circle's axis."""
    axis = circle[3:6] / np.linalg.norm(circle[3:6])
    piece.centre = circle[:3] * unit
    spoke, stop = ((p - piece.centre) - axis * (axis @ (p - piece.centre)) for p in (piece.start, piece.end))
    piece.first = spoke / np.linalg.norm(spoke)
    piece.second = np.cross(axis, piece.first)
    sweep = math.atan2(stop @ piece.second, stop @ piece.first) % (2 * math.pi)
    piece.sweep = sweep if sweep > 1e-9 else 2 * math.pi
