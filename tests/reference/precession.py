"""A wheel in precession at the edges of a block: docs/physics/precession.md.

Lengths in mm, the block 100 × 60 with its corner in the origin; angles count from x. Velocities are
per rad/s of spin.
"""

import numpy as np

RADIUS, DEPTH, TILT = 20.0, 0.6, np.radians(20.0)
PATCH = np.sqrt(2 * RADIUS * DEPTH - DEPTH**2)
LEVER = (RADIUS - DEPTH) * np.tan(TILT)
BLOCK = np.array([100.0, 60.0])
# Outward normals of the four edges and the coordinate along each.
NORMALS = np.array([[1, 0], [-1, 0], [0, 1], [0, -1]], float)


def edges(point):
    """Distance, normal and the ends of the chord (whole and clipped to the block) for each edge
    within the patch.

    The chord's coordinate runs along the normal turned by −90°.
    """
    found = []
    for normal in NORMALS:
        axis = int(abs(normal[1]))
        outward = normal[axis]
        distance = BLOCK[axis] - point[axis] if outward > 0 else point[axis]
        if distance >= PATCH:
            continue
        along = np.array([normal[1], -normal[0]])
        half = np.sqrt(PATCH**2 - distance**2)
        ends = sorted(along[1 - axis] * (end - point[1 - axis]) for end in (0.0, BLOCK[1 - axis]))
        found.append((distance, normal, (-half, half), (max(-half, ends[0]), min(half, ends[1]))))
    return found


def epsilon(distance):
    """Least cosine that keeps the whole chord outward."""
    return np.sqrt(PATCH**2 - distance**2) / LEVER


def outward_mm(angle, normal, s):
    """v·n at s along an edge; β lies between n and the centre's velocity (−sin α, cos α)."""
    cosine = -np.sin(angle) * normal[0] + np.cos(angle) * normal[1]
    return np.cos(TILT) * (s + LEVER * cosine)


def allowed(point, rule):
    """Interval (from, to) of allowed angles, or None for all; rule: "none", "whole", "clipped" or a
    number ε.
    """
    arcs = []
    for distance, normal, whole, clipped in edges(point):
        if rule == "none":
            continue
        least = {"whole": -whole[0] / LEVER, "clipped": -clipped[0] / LEVER}.get(rule, rule)
        middle = np.arctan2(-normal[0], normal[1])
        half = np.arccos(np.clip(least, -1, 1))
        arcs.append((middle - half, middle + half))
    if not arcs:
        return None
    low, high = arcs[0]
    for other_low, other_high in arcs[1:]:
        shift = 2 * np.pi * np.round((low + high - other_low - other_high) / (4 * np.pi))
        low, high = max(low, other_low + shift), min(high, other_high + shift)
    assert low <= high
    return low, high


def nearest(angle, interval):
    """The allowed angle nearest to one wanted."""
    if interval is None:
        return angle
    turned = lambda a: (a + np.pi) % (2 * np.pi) - np.pi
    low, high = interval
    if (angle - low) % (2 * np.pi) <= high - low:
        return angle
    return low if abs(turned(angle - low)) < abs(turned(angle - high)) else high


def raster():
    """4151 points of a serpentine of 16 lines along x, 4 mm apart, at 20 mm/s every 0.02 s."""
    way = 0.4 * np.arange(4151)
    line = np.minimum(way // 104, 15)
    along = way - 104 * line
    x = np.minimum(along, 100)
    return np.column_stack(
        [np.where(line % 2 == 0, x, 100 - x), 4 * line + np.maximum(along - 100, 0)]
    )


def table(rule):
    """Points with inward motion (%), mean inward share of the chord, fastest change of the angle
    (rad/s).
    """
    zone = inward = share = fastest = 0.0
    before = None
    for k, point in enumerate(raster()):
        angle = nearest(1.5 * 0.02 * k, allowed(point, rule))
        if before is not None:
            fastest = max(fastest, abs((angle - before + np.pi) % (2 * np.pi) - np.pi) / 0.02)
        before = angle
        shares, met = [], edges(point)
        for _, normal, _, (start, end) in met:
            zero = -outward_mm(angle, normal, 0.0) / np.cos(TILT)
            if outward_mm(angle, normal, start) < -1e-9:
                shares.append((min(zero, end) - start) / (end - start))
        zone += bool(met)
        inward += bool(shares)
        share += max(shares, default=0.0)
    return zone, 100 * inward / zone, share / zone, fastest
