"""Stability of milling: docs/physics/stability.md.

Milling frame: x the feed, φ from +y towards +x. A directional matrix B (Pa) is the force on the
tool per axial depth and displacement. Everything here is dense and slow on purpose: eigenvalues of
whole matrices, scans in place of root finding.
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq


def alpha(angle, k_r):
    """Antiderivative of the directional factors (`altintas1995`), 2×2, axes as published."""
    c, s = np.cos(2 * angle), np.sin(2 * angle)
    xx = c - 2 * k_r * angle + k_r * s
    xy = -s - 2 * angle + k_r * c
    yx = -s + 2 * angle + k_r * c
    yy = -c - 2 * k_r * angle - k_r * s
    return 0.5 * np.array([[xx, xy], [yx, yy]])


def average_pa(teeth, k_t, k_r, entry, exit):
    """B averaged over a revolution: ½ K_t (N/2π) [α]."""
    return 0.5 * k_t * teeth / (2 * np.pi) * (alpha(exit, k_r) - alpha(entry, k_r))


def instant_pa(angle, teeth, k_t, k_r, entry, exit):
    """B at an angle of the first tooth: −Σ (force directions) (chip direction)ᵀ over the teeth in
    cut.
    """
    b = np.zeros((2, 2))
    for k in range(teeth):
        phi = (angle + 2 * np.pi * k / teeth) % (2 * np.pi)
        if entry <= phi <= exit:
            s, c = np.sin(phi), np.cos(phi)
            force = k_t * np.array([-c - k_r * s, s - k_r * c])
            b += np.outer(force, [s, c])
    return b


def rightmost(mass, damping, stiffness):
    """Rightmost eigenvalue of M ẍ + C ẋ + K x = 0."""
    n = len(mass)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    values = np.linalg.eigvals(state)
    return values[np.argmax(values.real)]


def receptance(omega, modes):
    """2×2 receptance; modes as (angular frequency, damping ratio, mass-normalised shape (2,))."""
    total = np.zeros((len(omega), 2, 2), complex)
    for w, zeta, shape in modes:
        total += np.outer(shape, shape) / (w**2 - omega**2 + 2j * zeta * w * omega)[:, None, None]
    return total


def crossings(omega, modes, b, period=None):
    """Depths > 0 and frequencies at which det(1 − a κ G B) = 0, κ = 1 or 1 − e^{−iωT}.

    Both eigenvalues λ of κGB are followed over the frequencies; a = 1/λ where λ is real.
    """
    kappa = 1.0 if period is None else 1.0 - np.exp(-1j * omega * period)
    values = np.linalg.eigvals(receptance(omega, modes) @ b) * np.reshape(kappa, (-1, 1))
    for i in range(1, len(omega)):  # keep each branch in its column
        if abs(values[i] - values[i - 1]).sum() > abs(values[i][::-1] - values[i - 1]).sum():
            values[i] = values[i][::-1]
    found = []
    for branch in values.T:
        change = np.nonzero(np.diff(np.sign(branch.imag)) != 0)[0]
        for i in change:
            share = branch.imag[i] / (branch.imag[i] - branch.imag[i + 1])
            real = branch.real[i] + share * (branch.real[i + 1] - branch.real[i])
            if real > 0:
                found.append((1.0 / real, omega[i] + share * (omega[i + 1] - omega[i])))
    return found


def lowest_limit(hertz, modes, b, period=None, points=60_000):
    """Smallest depth (m) and its frequency (Hz) within a range of frequencies."""
    omega = 2 * np.pi * np.linspace(*hertz, points)
    depth, w = min(crossings(omega, modes, b, period))
    return depth, w / (2 * np.pi)


def step_means_pa(steps, teeth, k_t, k_r, entry, exit):
    """Means of B over equal steps of a tooth period, exact by the antiderivative."""
    pitch = 2 * np.pi / teeth
    found = []
    for k in range(steps):
        b = np.zeros((2, 2))
        for tooth in range(teeth):
            begin = tooth * pitch + pitch * k / steps
            ends = np.clip([begin, begin + pitch / steps], entry, exit)
            b += alpha(ends[1], k_r) - alpha(ends[0], k_r)
        found.append(0.5 * k_t * b * steps / pitch)
    return found


def multiplier(modes, process, period, depth, steps):
    """Dominant Floquet multiplier by first-order semi-discretisation (`insperger2011`), dense.

    process: (teeth, k_t, k_r, entry, exit). Within a step B is its mean and the delayed position
    runs straight from one stored value to the next. The state is followed by the positions of the
    tip 1 … `steps` steps ago.
    """
    n, h = len(modes), period / steps
    shapes = np.array([shape for *_, shape in modes]).T
    moves = np.any(shapes != 0.0, axis=1)
    shapes, m = shapes[moves], np.count_nonzero(moves)  # m × n
    frequencies = np.array([w for w, *_ in modes])
    ratios = np.array([z for _, z, _ in modes])
    free = np.zeros((2 * n, 2 * n))
    free[:n, n:] = np.eye(n)
    free[n:, :n] = -np.diag(frequencies**2)
    free[n:, n:] = -np.diag(2 * ratios * frequencies)
    state = np.eye(2 * n, 2 * n + m * steps)
    past = np.eye(m * steps, 2 * n + m * steps, 2 * n).reshape(steps, m, -1)
    for mean in step_means_pa(steps, *process):
        coupling = shapes.T @ (depth * mean)[np.ix_(moves, moves)]
        # x' = a x + delayed (old + (new − old) s/h): one exponential gives all the integrals.
        big = np.zeros((2 * n + 2 * m, 2 * n + 2 * m))
        big[: 2 * n, : 2 * n] = free * h
        big[n : 2 * n, :n] += coupling @ shapes * h
        big[n : 2 * n, 2 * n : 2 * n + m] = -coupling * h
        big[2 * n : 2 * n + m, 2 * n + m :] = np.eye(m)
        e = expm(big)[: 2 * n]
        old, new = past[-1], past[-2]
        begin = shapes @ state[:n]
        state = (
            e[:, : 2 * n] @ state + e[:, 2 * n : 2 * n + m] @ old + e[:, 2 * n + m :] @ (new - old)
        )
        past = np.concatenate([begin[None], past[:-1]])
    values = np.linalg.eigvals(np.vstack([state, past.reshape(m * steps, -1)]))
    return values[np.argmax(abs(values))]


def first_limit(modes, process, period, deepest, steps, points=60):
    """First depth (m) at which the multiplier passes 1, and the multiplier there."""
    size = lambda a: abs(multiplier(modes, process, period, a, steps)) - 1.0
    depths = np.linspace(deepest / points, deepest, points)
    below = depths[0]
    for above in depths[1:]:
        if size(above) > 0:
            limit = brentq(size, below, above, xtol=1e-3 * deepest)
            return limit, multiplier(modes, process, period, limit, steps)
        below = above
    raise ValueError("stable throughout")


def down(immersion):
    """Entry and exit of down-milling at radial depth over diameter."""
    return np.arccos(2 * immersion - 1), np.pi


def benchmark_1():
    """One direction: 0.03993 kg, 922 Hz, ζ 0.011."""
    return [(2 * np.pi * 922.0, 0.011, np.array([1.0, 0.0]) / np.sqrt(0.03993))]


def benchmark_2():
    """Two directions, of given stiffness."""
    mode = lambda hz, zeta, k, axis: (
        2 * np.pi * hz,
        zeta,
        np.array(axis) * 2 * np.pi * hz / np.sqrt(k),
    )
    return [mode(603.0, 0.039, 5.59e6, [1.0, 0.0]), mode(666.0, 0.035, 5.715e6, [0.0, 1.0])]
