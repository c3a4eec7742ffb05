"""Limits of stability drawn from a seed, by first-order semi-discretisation taken to its limit:
docs/physics/stability.md.

Steps end where teeth enter and leave, so that the error is a clean square of the step; the first
depth with a multiplier of 1 is found with k and with 2k steps a tooth period and extrapolated. What
the extrapolation from k/2 and k would have given tells how good that is.

    python tests/reference/limits.py > crates/core/tests/limits.csv
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from stability import alpha

SEED = 20_261_123
COUNT = 48
STEPS = 60


def edges(steps, teeth, entry, exit):
    """Angles of the first tooth at which steps end, over a pitch."""
    pitch = 2 * np.pi / teeth
    bounds = np.unique(np.round([0.0, pitch, entry % pitch, exit % pitch], 13))
    parts = [
        np.linspace(a, b, 2 * max(2, round(0.5 * steps * (b - a) / pitch)), endpoint=False)
        for a, b in zip(bounds[:-1], bounds[1:])
    ]
    return np.append(np.concatenate(parts), pitch)


def mean_pa(low, high, teeth, k_t, k_r, entry, exit):
    """B averaged between two angles of the first tooth."""
    total = np.zeros((2, 2))
    for tooth in range(-teeth, teeth):
        shift = 2 * np.pi * tooth / teeth
        a, b = max(low + shift, entry), min(high + shift, exit)
        if b - a > 1e-11:
            total += alpha(b, k_r) - alpha(a, k_r)
    return 0.5 * k_t * total / (high - low)


def kicks(process, period, edge, angles):
    """By steps that begin where a tooth enters or leaves at the wall: impulse per depth and displacement, N s/m2.

    `edge` is (K_te, K_re, feed per tooth). There the chip c sin(phi) + d.n goes through zero, so that a displacement d
    moves entry or exit by d.n/c, and the edge force acts that much longer."""
    teeth, _, _, entry, exit = process
    pitch = angles[-1]
    tangential, radial, feed = edge
    found = {}
    for end in (entry, exit):
        if abs(np.sin(end)) > 1e-9:
            continue
        s, c = round(np.sin(end)), round(np.cos(end))
        force = np.array([-tangential * c - radial * s, tangential * s - radial * c])
        step = int(np.argmin(abs((angles[:-1] - end + 0.5 * pitch) % pitch - 0.5 * pitch)))
        one = np.outer(force, [s, c]) / feed * period / pitch
        found[step] = found.get(step, 0.0) + one
    return found


def growth(modes, process, period, depth, angles, edge=None):
    """ln of the dominant multiplier's magnitude over a tooth period."""
    kick = kicks(process, period, edge, angles) if edge else {}
    n, pitch = len(modes), angles[-1]
    shapes = np.array([shape for *_, shape in modes]).T
    free = np.zeros((2 * n, 2 * n))
    free[:n, n:] = np.eye(n)
    free[n:, :n] = -np.diag([w**2 for w, *_ in modes])
    free[n:, n:] = -np.diag([2 * z * w for w, z, _ in modes])
    steps = len(angles) - 1
    whole = 2 * n + 2 * steps
    state = np.eye(2 * n, whole)
    before = np.eye(2 * steps, whole, 2 * n).reshape(steps, 2, whole)
    newest = shapes @ state[:n]
    after = []
    for i in range(steps):
        h = period * (angles[i + 1] - angles[i]) / pitch
        coupling = shapes.T @ mean_pa(angles[i], angles[i + 1], *process) * depth
        big = np.zeros((2 * n + 4, 2 * n + 4))
        big[: 2 * n, : 2 * n] = free * h
        big[n : 2 * n, :n] += coupling @ shapes * h
        big[n : 2 * n, 2 * n : 2 * n + 2] = -coupling * h
        big[2 * n : 2 * n + 2, 2 * n + 2 :] = np.eye(2)
        e = expm(big)[: 2 * n]
        old, new = before[i], before[i + 1] if i + 1 < steps else newest
        after.append(shapes @ state[:n])
        if i in kick:
            state = state.copy()
            state[n : 2 * n] += shapes.T @ kick[i] @ (after[-1] - old) * depth
        state = (
            e[:, : 2 * n] @ state + e[:, 2 * n : 2 * n + 2] @ old + e[:, 2 * n + 2 :] @ (new - old)
        )
    values = np.linalg.eigvals(np.vstack([state, np.concatenate(after)]))
    return np.log(abs(values).max())


def limit(modes, process, period, steps, guess):
    """Depth at which growth is zero, m; the first above a quarter of the guess."""
    angles = edges(steps, process[0], *process[3:])
    at = lambda depth: growth(modes, process, period, depth, angles)
    low = 0.05 * guess
    for high in guess * np.geomspace(0.06, 40.0, 60):
        if at(high) > 0.0:
            return brentq(at, low, high, rtol=1e-7)
        low = high
    return None


def near(modes, process, period, steps, about, edge=None):
    """The same close to a known limit."""
    angles = edges(steps, process[0], *process[3:])
    at = lambda depth: growth(modes, process, period, depth, angles, edge)
    low, high = 0.9 * about, 1.05 * about
    return brentq(at, low, high, rtol=1e-7) if at(low) < 0.0 < at(high) else None


def draw(random):
    """A cut: modes, process, tooth period, and what the lowest limit is about, m."""
    count = int(random.integers(1, 4))
    slowest = 10 ** random.uniform(1.5, 3.0)
    modes = []
    for j in range(count):
        w = 2 * np.pi * slowest * (1.0 if j == 0 else random.uniform(1.0, 4.0))
        angle, stiffness = random.uniform(0.0, np.pi), 10 ** random.uniform(6.0, 7.3)
        shape = np.array([np.cos(angle), np.sin(angle)]) * w / np.sqrt(stiffness)
        modes.append((w, random.uniform(0.008, 0.05), shape))
    teeth, immersion = int(random.integers(2, 6)), 10 ** random.uniform(-1.3, -0.05)
    if random.random() < 0.5:
        entry, exit = 0.0, np.arccos(1.0 - 2.0 * immersion)
    else:
        entry, exit = np.arccos(2.0 * immersion - 1.0), np.pi
    k_t, k_r = random.uniform(4e8, 2.4e9), random.uniform(0.1, 0.5)
    fastest = max(w for w, *_ in modes)
    period = random.uniform(0.4, 7.0) * 2 * np.pi / fastest
    lowest = min(z * (w / np.linalg.norm(u)) ** 2 for w, z, u in modes)
    share = teeth * (exit - entry) / (2 * np.pi)
    return modes, (teeth, k_t, k_r, entry, exit), period, 2.0 * lowest / (k_t * share)


def main():
    random = np.random.default_rng(SEED)
    print("period_s,teeth,tangential_pa,radial_ratio,entry_rad,exit_rad,limit_m,uncertainty,modes")
    found = 0
    while found < COUNT:
        modes, process, period, guess = draw(random)
        first = limit(modes, process, period, STEPS, guess)
        if first is None:
            continue
        levels = [first]
        for steps in (2 * STEPS, 4 * STEPS):
            levels.append(near(modes, process, period, steps, levels[-1]))
            if levels[-1] is None:
                break
        if levels[-1] is None:
            continue
        better = [(4 * b - a) / 3 for a, b in zip(levels[:-1], levels[1:])]
        uncertainty = abs(better[1] / better[0] - 1.0)
        numbers = [period, process[0], *process[1:], better[1]]
        shapes = ";".join(" ".join(f"{x:.10g}" for x in (w, z, *u)) for w, z, u in modes)
        print(",".join(f"{x:.10g}" for x in numbers), f"{uncertainty:.1e}", shapes, sep=",", flush=True)
        found += 1


if __name__ == "__main__":
    main()
