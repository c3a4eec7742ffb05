"""Draws the cover of `cover.stl`: `python cover.py`, with Python alone.

A plate of 110 by 76 mm with rounded corners, 14 to 21 mm high, whose top waves and has a round hole of 16 mm. Rings of
triangles run from the hole to the outline.
"""

import math
import struct
from pathlib import Path

SECTORS, RINGS = 120, 14
HALF, HOLE, EXPONENT = (55.0, 38.0), 8.0, 6.0


def top(x, y):
    """Height of the top, mm."""
    bow = 18.0 - x * x / 600.0 - y * y / 500.0
    return bow + 1.2 * math.sin(2 * math.pi * x / 90) * math.cos(2 * math.pi * y / 80)


def place(ring, sector):
    """A corner of the rings, from the hole to a rounded rectangle, mm."""
    angle = 2 * math.pi * (sector % SECTORS) / SECTORS
    cosine, sine = math.cos(angle), math.sin(angle)
    outer = (abs(cosine / HALF[0]) ** EXPONENT + abs(sine / HALF[1]) ** EXPONENT) ** (-1 / EXPONENT)
    radius = HOLE + (outer - HOLE) * ring / RINGS
    return radius * cosine, radius * sine


def quad(a, b, c, d):
    """Two triangles, counter-clockwise seen from outside."""
    return [(a, b, c), (a, c, d)]


def upper(ring, sector):
    """A corner of the top."""
    x, y = place(ring, sector)
    return x, y, top(x, y)


def lower(ring, sector):
    """A corner of the bottom."""
    return (*place(ring, sector), 0.0)


triangles = []
for s in range(SECTORS):
    for r in range(RINGS):
        triangles += quad(upper(r, s), upper(r + 1, s), upper(r + 1, s + 1), upper(r, s + 1))
    triangles += quad(lower(0, s), lower(0, s + 1), lower(RINGS, s + 1), lower(RINGS, s))
    triangles += quad(lower(RINGS, s), lower(RINGS, s + 1), upper(RINGS, s + 1), upper(RINGS, s))
    triangles += quad(lower(0, s), upper(0, s), upper(0, s + 1), lower(0, s + 1))

data = bytearray(80) + struct.pack("<I", len(triangles))
for corners in triangles:
    data += struct.pack("<12fH", 0, 0, 0, *(x for corner in corners for x in corner), 0)
Path(__file__).with_name("cover.stl").write_bytes(data)
