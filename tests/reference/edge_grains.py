"""Grains of a soft wheel that run over a corner, one by one: docs/physics/edge_grains.md.

A grain is a ball on a spring along the face's normal and one across it, without mass. Its middle stays outside the workpiece by its
radius: outside the curve of a face, a fillet and a wall moved out by that. The foot of its springs is led past; each small step the
grain sticks, slides by Coulomb's law, lifts off or, at its strength, comes free. Lengths in µm, forces in mN, stiffness in mN/µm (N/mm).
"""

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm


class Corner:
    """Where a grain's middle may be: q runs along the face (q < 0), round the fillet, down the wall."""

    def __init__(self, grain, fillet):
        self.grain, self.fillet, self.reach = grain, fillet, grain + fillet
        self.round = 0.5 * np.pi * self.reach

    def at(self, q):
        """Place x outwards, height z, and the angle of the normal from the vertical."""
        angle = np.clip(q / self.reach, 0, np.pi / 2)
        x = -self.fillet + self.reach * np.sin(angle) + np.minimum(q, 0)
        z = -self.fillet + self.reach * np.cos(angle) - np.maximum(q - self.round, 0)
        return x, z, angle

    def inside(self, x, z):
        """Whether a middle there would be in the workpiece."""
        x, z = x + self.fillet, z + self.fillet
        over, beside = (x <= 0) & (z < self.reach), (z <= 0) & (x < self.reach)
        return over | beside | ((x > 0) & (z > 0) & (np.hypot(x, z) < self.reach))

    def nearest(self, x, z):
        """q of the nearest place."""
        x, z = x + self.fillet, z + self.fillet
        return np.where(z <= 0, self.round - z, np.where(x <= 0, x, self.reach * np.arctan2(x, z)))


def run(depths, corner, stiffness, mu, sense, strength=np.inf, slope=0.0, step=0.25):
    """Forces across (outwards) and down on the workpiece of grains that run straight over the edge, each step, and who came free. Inward
    for sense -1. Outside the edge the rubber falls away with `slope`.
    """
    kn, kt = stiffness
    start = corner.grain + 2 if sense < 0 else -corner.fillet - mu * np.max(kn * depths) / kt - 5
    stretch = strength / kt if np.isfinite(strength) else 150
    way = 2 * corner.reach + stretch + 60
    x = np.full(len(depths), float(start))
    touching = (depths > 0) & (sense > 0)
    q = x - mu * kn * depths / kt + corner.fillet
    free = np.zeros(len(depths), bool)
    across, down = [], []
    for _ in range(int(way / step)):
        x = x + sense * step
        foot = corner.grain - depths - slope * np.maximum(x, 0)
        new = corner.inside(x, foot) & ~touching & ~free & (depths > 0)
        q, touching = np.where(new, corner.nearest(x, foot), q), touching | new

        def pull(q):
            cx, cz, angle = corner.at(q)
            sx, sz = kt * (x - cx), kn * (foot - cz)
            return sx, sz, -(sx * np.sin(angle) + sz * np.cos(angle)), sx * np.cos(angle) - sz * np.sin(angle)

        for _ in range(8):  # slides until friction holds it: Newton's iteration
            _, _, pressed, along = pull(q)
            slides = touching & (pressed > 0) & (np.abs(along) > mu * pressed * (1 + 1e-9))
            if not slides.any():
                break
            excess = lambda at, sign=np.sign(along): pull(at)[3] - sign * mu * pull(at)[2]
            rate = (excess(q + 1e-4) - excess(q)) / 1e-4
            rate = np.where(rate < -0.05 * kn, rate, -kn)
            q = q + np.where(slides, np.clip(-excess(q) / rate, -1, 1), 0)
        sx, sz, pressed, _ = pull(q)
        touching = touching & (pressed >= 0)
        across.append(np.where(touching, sx, 0))
        down.append(np.where(touching, -sz, 0))
        broken = touching & (np.hypot(sx, sz) >= strength)
        free, touching = free | broken, touching & ~broken
    return np.array(across), np.array(down), free


def jam_depth(corner, stiffness, mu, oblique, strength, depths, step=0.4):
    """Least of the depths that jams where grains run inward at an angle to the edge's normal. Friction and stretch have two directions."""
    kn, kt = stiffness
    inwards, sideways = np.cos(oblique), np.sin(oblique)
    x, y = np.full(len(depths), corner.grain + 2.0), np.zeros(len(depths))
    q, side = np.zeros(len(depths)), np.zeros(len(depths))
    touching, free = np.zeros(len(depths), bool), np.zeros(len(depths), bool)
    foot = corner.grain - depths
    for _ in range(int((2 * corner.grain + strength / kt + 40) / step / inwards)):
        x, y = x - step * inwards, y + step * sideways
        new = corner.inside(x, foot) & ~touching & ~free
        q, side, touching = np.where(new, corner.nearest(x, foot), q), np.where(new, y, side), touching | new
        for _ in range(60):  # slides back along the excess of its pull by half of what would take it away
            cx, cz, angle = corner.at(q)
            sx, sz, sy = kt * (x - cx), kn * (foot - cz), kt * (y - side)
            pressed = -(sx * np.sin(angle) + sz * np.cos(angle))
            along = sx * np.cos(angle) - sz * np.sin(angle)
            size = np.maximum(np.hypot(along, sy), 1e-12)
            excess = np.where(touching, np.maximum(size - mu * np.maximum(pressed, 0), 0), 0)
            if not (excess > 1e-8).any():
                break
            q, side = q + 0.5 * excess / kn * along / size, side + 0.5 * excess / kn * sy / size
        touching = touching & (pressed >= 0)
        broken = touching & (np.hypot(sx, sy) >= strength)
        free, touching = free | broken, touching & ~broken
    return depths[free].min() if free.any() else np.inf


def gap(grains, pressure):
    """Distance of the rubber from the face at which grains bear the pressure (mN/µm²), none where the rubber touches."""
    mean, spread, number, kn = grains
    bears = lambda s: number * kn * norm.expect(lambda g: np.maximum(g - s, 0), loc=mean, scale=spread, lb=s, ub=mean + 12 * spread)
    return 0.0 if bears(0.0) < pressure else brentq(lambda s: bears(s) - pressure, 0, mean + 6 * spread)


def level(forces, step, speed, rate, low=200.0, high=20e3):
    """Deviation of the sum of such forces at a rate of events (1/s) between two frequencies, by Campbell's theorem: S = 2 rate |F|². Forces
    may end at another value than they begin with. Speed in µm/s.
    """
    jumps = np.diff(forces, axis=0, prepend=forces[:1])
    times = np.arange(len(forces)) * step / speed
    hz = np.geomspace(low, high, 120)
    spectrum = np.exp(-2j * np.pi * np.outer(hz, times)) @ jumps
    density = 2 * rate * np.mean(np.abs(spectrum) ** 2, axis=1) / (2 * np.pi * hz) ** 2
    return np.sqrt(np.trapezoid(density, hz))


def corner_of_a_mould(modulus_mpa, mu, fillet=5.0, pressure_mpa=0.12, strength=40.0, slope=0.0, count=20_000, ratio=0.75, poisson=0.5):
    """Grains of 40 µm, 30 ± 8 µm out of the rubber, 16 per mm², at 0.7 m/s over 9 mm of edge: share that jams inward and outward; force
    across the edge inward and outward (mN, 0.2 to 20 kHz); their ratio; the ratio with what acts along the normal.
    """
    grain, mean, spread, number, speed = 40.0, 30.0, 8.0, 16e-6, 0.7e6
    kn = 2 * modulus_mpa / (1 - poisson**2) * grain * 1e-3
    stiffness, corner = (kn, ratio * kn), Corner(grain, fillet)
    s = gap((mean, spread, number, kn), pressure_mpa * 1e-3)
    drawn = np.maximum(np.random.default_rng(1).normal(mean, spread, count) - s, 0)
    grid = np.arange(0.125, 62, 0.25)
    weights = np.bincount(np.searchsorted(grid + 0.125, drawn).clip(0, len(grid) - 1), minlength=len(grid))
    met = weights > 0
    depths, weights = grid[met], weights[met] / count
    found = {}
    for sense in (-1, 1):
        across, down, free = run(depths, corner, stiffness, mu, sense, strength, slope)
        scaled = np.sqrt(weights * len(weights))
        rate = number * 9e3 * speed
        found[sense] = [float(weights[free].sum())] + [level(f * scaled, 0.25, speed, rate) for f in (across, down)]
    inward, outward = found[-1], found[1]
    total = np.hypot(*inward[1:]) / np.hypot(*outward[1:])
    return inward[0], outward[0], inward[1], outward[1], inward[1] / outward[1], total


def share_of_law(modulus_mpa, mu, fillet=5.0, pressure_mpa=0.12, poisson=0.5):
    """Share of those grains that are pressed in by (a + r)(1 - sin atan mu) and more."""
    kn = 2 * modulus_mpa / (1 - poisson**2) * 40e-3
    s = gap((30.0, 8.0, 16e-6, kn), pressure_mpa * 1e-3)
    depth = (40 + fillet) * (1 - np.sin(np.arctan(mu)))
    return norm.sf((depth + s - 30) / 8)
