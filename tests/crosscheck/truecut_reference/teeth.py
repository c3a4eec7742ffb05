"""Forces of straight teeth on true circles, compiled: a pass asks for them some hundred thousand times.

Frame and notation of `milling`. A history is the times of steps and the place and velocity of the axis at each.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

# Earlier teeth whose arcs a tooth may meet; further back the surface lies deeper by the feed, while vibration is small.
REMEMBERED = 3
# A tooth whose edge would have to cut through so many feeds to reach stock is out of it.
OUT_OF_STOCK = 20.0
# Places of a wear land and their weights, both as parts of its width: Gauss's rule.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
LAND_PLACES, LAND_WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
# Points of the cut at which a step's force is taken.
PARTS = 2


class Pass(NamedTuple):
    """One straight pass, SI. `lead_in` is no number where the cut is under way from the start; `before` is where the axis
    stood that left the surface before the first step, or every surface where a pass does not regenerate."""

    radius: float
    teeth: int
    spin: float
    start: float
    feed: float
    feed_per_tooth: float
    tooth_s: float
    entry: float
    leave: float
    lead_in: float
    ramp: float
    depth: float
    pressures: tuple[float, float, float]
    edge: tuple[float, float, float]
    land: float
    indentation: float
    flank_friction: float
    regenerates: bool
    before: tuple[float, float]
    step: float


@njit(cache=True)
def step_load(p: Pass, times, places, count: int, t: float, place, rate):
    """Force (N) and moment (N m) on the tool in the frame of the cut, averaged over the step about t."""
    force, moment = np.zeros(3), np.zeros(3)
    for part in range(PARTS):
        ahead = ((part + 0.5) / PARTS - 0.5) * p.step
        here = place + ahead * rate
        _add_cut(p, times, places, count, t + ahead, here, force, moment)
    return force / PARTS, moment / PARTS


@njit(cache=True)
def _add_cut(p: Pass, times, places, count: int, t: float, here, force, moment) -> None:
    pitch = 2.0 * math.pi / p.teeth
    share = 1.0
    if p.ramp > 0.0:
        lead_in = 0.0 if math.isnan(p.lead_in) else p.lead_in
        share = min(max((p.feed * t - lead_in) / p.ramp, 0.0), 1.0)
    depth = p.depth * share - here[2]
    if depth <= 0.0:
        return
    turned = p.start + p.spin * t
    f, arm = np.zeros(3), np.zeros(3)
    for tooth in range(p.teeth):
        phi = turned - pitch * tooth
        sin, cos = math.sin(phi), math.cos(phi)
        if _in_stock(p, here, sin, cos, p.radius - OUT_OF_STOCK * p.feed_per_tooth, p.radius) <= 0.0:
            continue
        surface = -math.inf
        for m in range(1, REMEMBERED + 1):
            surface = max(surface, _arc(p, times, places, count, t, here, phi, sin, cos, m))
        chip = _in_stock(p, here, sin, cos, surface, p.radius)
        if chip <= 0.0:
            continue
        tangential = (p.pressures[0] * chip + p.edge[0]) * depth
        radial = (p.pressures[1] * chip + p.edge[1]) * depth
        axial = (p.pressures[2] * chip + p.edge[2]) * depth
        if p.land > 0.0:
            push = p.indentation * _overlap(p, times, places, count, t, here, phi) * depth
            radial += push
            tangential += p.flank_friction * push
        f[0], f[1], f[2] = -tangential * cos - radial * sin, tangential * sin - radial * cos, axial
        arm[0], arm[1], arm[2] = p.radius * sin, p.radius * cos, 0.5 * depth
        force += f
        moment += np.cross(arm, f)


@njit(cache=True)
def _overlap(p: Pass, times, places, count: int, t: float, here, phi: float) -> float:
    """Area (m^2) by which the wear land behind a tooth's edge overlaps what the edge left: the land stands where
    the edge is now, and the edge passed the places behind it earlier. The land is ground along the nominal path,
    so that the feed is no overlap."""
    speed = p.radius * p.spin
    area = 0.0
    for node, weight in zip(LAND_PLACES, LAND_WEIGHTS):
        ago = node * p.land / speed
        x, y, _, _ = _axis(p, times, places, count, t - ago)
        behind = phi - p.spin * ago
        dx, dy = here[0] - p.feed * ago - x, here[1] - y
        area += max(0.0, dx * math.sin(behind) + dy * math.cos(behind)) * weight * p.land
    return area


@njit(cache=True)
def _arc(p: Pass, times, places, count: int, t: float, here, phi: float, sin: float, cos: float, m: int) -> float:
    """Distance from the axis at which the tooth that came m pitches earlier cut the ray at phi."""
    pitch = 2.0 * math.pi / p.teeth
    then = t - m * p.tooth_s
    px, py = 0.0, 0.0
    for _ in range(4):
        cx, cy, rx, ry = _axis(p, times, places, count, then)
        psi = phi + p.spin * (then - t) + m * pitch
        px = cx + p.radius * math.sin(psi) - here[0]
        py = cy + p.radius * math.cos(psi) - here[1]
        off = px * cos - py * sin
        rate = (rx + p.radius * math.cos(psi) * p.spin) * cos - (ry - p.radius * math.sin(psi) * p.spin) * sin
        change = off / rate
        then -= change
        if abs(change) < 1e-13:
            break
    return px * sin + py * cos


@njit(cache=True)
def _axis(p: Pass, times, places, count: int, t: float):
    """Place and velocity of the axis that left the surface at a time."""
    if not p.regenerates or count == 0 or t <= times[0]:
        return p.before[0] + p.feed * t, p.before[1], p.feed, 0.0
    k = min(int((t - times[0]) / p.step), count - 2)
    if k < 0:
        return places[0, 0], places[0, 1], places[0, 2], places[0, 3]
    ax, ay, avx, avy = places[k, 0], places[k, 1], places[k, 2], places[k, 3]
    bx, by, bvx, bvy = places[k + 1, 0], places[k + 1, 1], places[k + 1, 2], places[k + 1, 3]
    u = (t - times[k]) / p.step
    h00, h10 = (1 + 2 * u) * (1 - u) ** 2, u * (1 - u) ** 2 * p.step
    h01, h11 = u * u * (3 - 2 * u), u * u * (u - 1) * p.step
    d = 6 * u * (u - 1) / p.step
    g0, g1 = (1 - u) * (1 - 3 * u), u * (3 * u - 2)
    return (
        h00 * ax + h10 * avx + h01 * bx + h11 * bvx,
        h00 * ay + h10 * avy + h01 * by + h11 * bvy,
        d * (ax - bx) + g0 * avx + g1 * bvx,
        d * (ay - by) + g0 * avy + g1 * bvy,
    )


@njit(cache=True)
def _in_stock(p: Pass, here, sin: float, cos: float, low: float, high: float) -> float:
    """Part of the ray between two distances from the axis that lies in the stock."""
    if low >= high:
        return 0.0
    if p.leave < math.pi - 1e-12:
        low, high = _clip(low, high, here[1], cos, p.radius * math.cos(p.leave), math.inf)
    if p.entry > 1e-12:
        low, high = _clip(low, high, here[1], cos, -math.inf, p.radius * math.cos(p.entry))
    if not math.isnan(p.lead_in):
        low, high = _clip(low, high, here[0], sin, p.lead_in + p.radius, math.inf)
    return max(0.0, high - low)


@njit(cache=True)
def _clip(low: float, high: float, at: float, along: float, least: float, most: float):
    """The part of a ray on which a coordinate lies within bounds."""
    if along == 0.0:
        return (low, high) if least <= at <= most else (0.0, 0.0)
    a, b = (least - at) / along, (most - at) / along
    return max(low, min(a, b)), min(high, max(a, b))
