"""Forces of an end mill: docs/physics/milling_forces.md."""

import numpy as np


def mean_force_n(teeth, feed, depth, k, edge, entry, exit, points=200_001):
    """Mean force over a revolution by the midpoint rule; k and edge are (tangential, radial,
    axial).
    """
    ends = np.linspace(entry, exit, points)
    phi = 0.5 * (ends[1:] + ends[:-1])
    h = feed * np.sin(phi)
    t, r, a = (depth * (coefficient * h + per_length) for coefficient, per_length in zip(k, edge))
    x = -t * np.cos(phi) - r * np.sin(phi)
    y = t * np.sin(phi) - r * np.cos(phi)
    step = (exit - entry) / (points - 1)
    return teeth / (2 * np.pi) * step * np.array([x.sum(), y.sum(), a.sum()])


def mean_force_closed_n(teeth, feed, depth, k, edge, entry, exit):
    """The same from antiderivatives (`altintas2012`)."""

    def at(phi):
        sine2, square = 0.5 * phi - 0.25 * np.sin(2 * phi), 0.5 * np.sin(phi) ** 2
        x = (
            -k[0] * feed * square
            - k[1] * feed * sine2
            - edge[0] * np.sin(phi)
            + edge[1] * np.cos(phi)
        )
        y = (
            k[0] * feed * sine2
            - k[1] * feed * square
            - edge[0] * np.cos(phi)
            - edge[1] * np.sin(phi)
        )
        z = -k[2] * feed * np.cos(phi) + edge[2] * phi
        return np.array([x, y, z])

    return teeth * depth / (2 * np.pi) * (at(exit) - at(entry))
