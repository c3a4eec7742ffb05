"""A pocket milled along a commanded path, written a second time: no grid, no layers, no distances.

The stock is the box, less its hole, less all discs about places where the axis has been more than two revolutions ago.
Of the ray from the axis to a tooth's tip counts what is left of that beyond the arcs of the last teeth: each crossing
is found by Newton's method on the places of the axis, joined by straight lines. Teeth are straight and run true.
Frame: the path's work frame, whose axes are the world's; a tooth at phi points along (sin phi, cos phi).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .led_run import LedRun
from .plant import Plant
from .wheel import Command

PARTS = 2
# earlier teeth whose arcs are solved: two revolutions of two teeth
TEETH_BACK = 4
# discs of older places stand so far apart; their scallops are s^2/8r = 0.01 um deep
APART_M = 20e-6


@dataclass(frozen=True)
class Pocket:
    """Cutter, law and stock, SI; places in the work frame."""

    radius: float
    teeth: int
    spin: float
    tangential: float
    radial: float
    work: np.ndarray
    least: np.ndarray
    most: np.ndarray
    # centre and radius
    hole: tuple[np.ndarray, float]

    @staticmethod
    def of(t: dict) -> Pocket:
        """From `[process.path_milling]` with one hole and a path without turn."""
        cutter, stock = t["cutter"], t["stock"]
        assert not cutter.get("helix_deg") and not cutter.get("mode") and len(stock["hole"]) == 1
        least = np.array(stock["corner_mm"]) * 1e-3
        hole = stock["hole"][0]
        return Pocket(
            radius=0.5e-3 * cutter["diameter_mm"],
            teeth=cutter["teeth"],
            spin=t["spindle_rpm"] / 60 * math.tau,
            tangential=t["cutting"]["tangential_mpa"] * 1e6,
            radial=t["cutting"]["radial_mpa"] * 1e6,
            work=np.array(t["path"]["work_xyz_mm"]) * 1e-3,
            least=least,
            most=least + np.array(stock["size_mm"]) * 1e-3,
            hole=(np.array(hole["xy_mm"]) * 1e-3, 0.5e-3 * hole["diameter_mm"]),
        )


class PocketRun(LedRun):
    """Tells the force on the tool, work frame."""

    def __init__(self, pocket: Pocket, plant: Plant, command: Command) -> None:
        super().__init__(plant, command)
        self.pocket = pocket
        # axis by step: middle of the step, place in the plane
        self.times: list[float] = []
        self.places: list[tuple[float, float]] = []
        self._step = 0.0
        self._old = np.zeros((4096, 2))
        self._old_count, self._next = 0, 0

    def run(self, h: float, until_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        self._step = h
        return super().run(h, until_s)

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        place, _, velocity, _ = self.tool_at(q, v)
        place = place - self.pocket.work
        force, moment = np.zeros(3), np.zeros(3)
        if t > 0.0:
            self._note(t, place)
            for part in range(PARTS):
                ahead = ((part + 0.5) / PARTS - 0.5) * self._step
                f, m = self._cut(t + ahead, place + velocity * ahead)
                force += f / PARTS
                moment += m / PARTS
        return force, moment, force

    def _note(self, t: float, place: np.ndarray) -> None:
        """The axis has come here; what lies two revolutions back becomes old."""
        self.times.append(t)
        self.places.append((float(place[0]), float(place[1])))
        if place[2] >= self.pocket.most[2]:
            # in air nothing is swept
            self._next = len(self.places)
            return
        limit = t - TEETH_BACK * math.tau / (self.pocket.teeth * self.pocket.spin)
        while self._next < len(self.times) and self.times[self._next] < limit:
            here = self.places[self._next]
            last = self._old[self._old_count - 1]
            if not self._old_count or math.hypot(here[0] - last[0], here[1] - last[1]) >= APART_M:
                if self._old_count == len(self._old):
                    self._old = np.concatenate((self._old, np.zeros_like(self._old)))
                self._old[self._old_count] = here
                self._old_count += 1
            self._next += 1

    def _cut(self, t: float, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        p = self.pocket
        force, moment = np.zeros(3), np.zeros(3)
        depth = p.most[2] - place[2]
        if depth <= 0.0:
            return force, moment
        for tooth in range(p.teeth):
            phi = p.spin * t - math.tau / p.teeth * tooth
            sin, cos = math.sin(phi), math.cos(phi)
            chip = self._chip(t, float(place[0]), float(place[1]), phi, sin, cos)
            if chip <= 0.0:
                continue
            tangential, radial = p.tangential * chip * depth, p.radial * chip * depth
            f = np.array([-tangential * cos - radial * sin, tangential * sin - radial * cos, 0.0])
            force += f
            moment += np.cross([p.radius * sin, p.radius * cos, 0.5 * depth], f)
        return force, moment

    def _chip(self, t: float, x: float, y: float, phi: float, sin: float, cos: float) -> float:
        """Material along the ray at phi between the arcs of the last teeth and the tip."""
        p = self.pocket
        surface = max(self._arc(t, x, y, phi, sin, cos, m) for m in range(1, TEETH_BACK + 1))
        low, high = surface, p.radius
        for at, along, least, most in ((x, sin, p.least[0], p.most[0]), (y, cos, p.least[1], p.most[1])):
            if along != 0.0:
                a, b = sorted(((least - at) / along, (most - at) / along))
                low, high = max(low, a), min(high, b)
        if low >= high:
            return 0.0
        centre, radius = p.hole
        gone = [_within(np.array([centre]) - (x, y), sin, cos, radius)]
        if self._old_count:
            gone.append(_within(self._old[: self._old_count] - (x, y), sin, cos, p.radius))
        spans = np.clip(np.concatenate(gone), low, high)
        spans = spans[spans[:, 1] > spans[:, 0]]
        if not len(spans):
            return high - low
        spans = spans[np.argsort(spans[:, 0])]
        ends = np.maximum.accumulate(spans[:, 1])
        starts = np.concatenate((spans[1:, 0], [high]))
        return float(spans[0, 0] - low + np.maximum(starts - ends, 0.0).sum())

    def _arc(self, t: float, x: float, y: float, phi: float, sin: float, cos: float, m: int) -> float:
        """Distance from the axis at which the tooth that came m pitches earlier cut the ray at phi."""
        p = self.pocket
        then = t - m * math.tau / (p.teeth * p.spin)
        for _ in range(6):
            cx, cy, rx, ry = self._axis(then)
            psi = phi + p.spin * (then - t) + m * math.tau / p.teeth
            dx, dy = math.sin(psi), math.cos(psi)
            off = (cx + p.radius * dx - x) * cos - (cy + p.radius * dy - y) * sin
            change = off / ((rx + p.radius * dy * p.spin) * cos - (ry - p.radius * dx * p.spin) * sin)
            then -= change
            if abs(change) < 1e-12:
                break
        return (cx + p.radius * dx - x) * sin + (cy + p.radius * dy - y) * cos

    def _axis(self, t: float) -> tuple[float, float, float, float]:
        """Place and velocity of the axis at a time."""
        count = len(self.times)
        if count < 2 or t <= self.times[0]:
            return (*self.places[0], 0.0, 0.0)
        step = self.times[1] - self.times[0]
        k = min(int((t - self.times[0]) / step), count - 2)
        (ax, ay), (bx, by) = self.places[k], self.places[k + 1]
        u = (t - self.times[k]) / step
        return ax + u * (bx - ax), ay + u * (by - ay), (bx - ax) / step, (by - ay) / step


def _within(centres: np.ndarray, sin: float, cos: float, radius: float) -> np.ndarray:
    """Where a ray from the origin runs through discs: from and to along it, a row each."""
    along = centres[:, 0] * sin + centres[:, 1] * cos
    beside = centres[:, 0] * cos - centres[:, 1] * sin
    square = radius * radius - beside * beside
    half = np.sqrt(square[square > 0.0])
    along = along[square > 0.0]
    return np.stack((along - half, along + half), axis=1)
