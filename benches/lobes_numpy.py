"""Wall time of a straightforward NumPy semi-discretisation, to set beside `cargo bench -p truecut-core --bench chatter`.

First order: the delayed displacement runs straight between stored values, the directional factor is averaged over each
step, and the monodromy matrix is the product of k dense step matrices. Same machine constants, resolution and range of
speeds and depths as the bench's diagrams of one and two modes; a grid of 20 x 20 points is timed and its time
multiplied by 25.

    python benches/lobes_numpy.py
    python benches/lobes_numpy.py --short    (one point of each diagram: whether it runs, not how fast)
"""

import sys
import time

import numpy as np
from scipy.linalg import expm

TEETH, K_T, RATIO, STEPS = 2, 6e8, 1 / 3, 40
MODES = {
    "one mode": [(2 * np.pi * 922.0, 0.011, np.array([1.0, 0.0]) / np.sqrt(0.03993))],
    "two modes": [
        (2 * np.pi * 603.0, 0.039, np.array([1.0, 0.0]) * 2 * np.pi * 603.0 / np.sqrt(5.59e6)),
        (2 * np.pi * 666.0, 0.035, np.array([0.0, 1.0]) * 2 * np.pi * 666.0 / np.sqrt(5.715e6)),
    ],
}


def directional(step):
    """Force per depth and displacement (Pa), averaged over a step of a slot's tooth period by 50 samples."""
    total = np.zeros((2, 2))
    for sample in range(50):
        phi = np.pi * (step + (sample + 0.5) / 50) / STEPS
        for tooth in range(TEETH):
            angle = (phi + 2 * np.pi * tooth / TEETH) % (2 * np.pi)
            if angle < np.pi:
                s, c = np.sin(angle), np.cos(angle)
                force = np.array([-c - RATIO * s, s - RATIO * c]) * K_T
                total += np.outer(force, [s, c]) / 50
    return total


def multiplier(modes, matrices, period, depth):
    """|mu| of the monodromy matrix over the states (q, v, delayed q's)."""
    n = len(modes)
    h = period / STEPS
    shapes = np.array([m[2] for m in modes]).T
    size = 2 * n + n * STEPS
    monodromy = np.eye(size)
    for matrix in matrices:
        modal = depth * shapes.T @ matrix @ shapes
        a = np.zeros((2 * n, 2 * n))
        a[:n, n:] = np.eye(n)
        for j, (omega, zeta, _) in enumerate(modes):
            a[n + j, j] = -omega * omega
            a[n + j, n + j] = -2 * zeta * omega
        a[n:, :n] += modal
        b = np.zeros((2 * n, n))
        b[n:] = -modal
        # exp of [[A, B, 0], [0, 0, I/h], [0, 0, 0]] holds the integrals of both ramps.
        big = np.zeros((4 * n, 4 * n))
        big[: 2 * n, : 2 * n] = a
        big[: 2 * n, 2 * n : 3 * n] = b
        big[2 * n : 3 * n, 3 * n :] = np.eye(n) / h
        exponential = expm(big * h)
        whole, rising = exponential[: 2 * n, 2 * n : 3 * n], exponential[: 2 * n, 3 * n :]
        step = np.zeros((size, size))
        step[: 2 * n, : 2 * n] = exponential[: 2 * n, : 2 * n]
        step[: 2 * n, size - n :] = whole - rising
        step[: 2 * n, size - 2 * n : size - n] = rising
        step[2 * n : 3 * n, :n] = np.eye(n)
        step[3 * n :, 2 * n : size - n] = np.eye(size - 3 * n)
        monodromy = step @ monodromy
    return np.abs(np.linalg.eigvals(monodromy)).max()


def main():
    points = 1 if "--short" in sys.argv else 20
    matrices = [directional(i) for i in range(STEPS)]
    for name, modes in MODES.items():
        started = time.perf_counter()
        total = 0.0
        for i in range(points):
            period = 6e-3 / (1 + 4 * (i * 5) / 100)
            for j in range(points):
                total += multiplier(modes, matrices, period, 4e-3 * (j * 5 + 1) / 100)
        seconds = (100 / points) ** 2 * (time.perf_counter() - started)
        print(f"{name}, 100 x 100: {seconds:.1f} s (sum over {points} x {points} points {total:.6f})")


if __name__ == "__main__":
    main()
