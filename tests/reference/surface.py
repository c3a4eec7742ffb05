"""A freeform spoke under a contact wheel: docs/physics/surfaces.md.

z = 25 sin πu − 0.006 (1 − u/2) y² (mm) over x = 200 u, y = 80 (v − ½). Derivatives are typed in;
curvatures are the roots of det(II − κ I) = 0, convex counted positive.
"""

import numpy as np
from scipy.linalg import eigh


def derivatives(u, v):
    """Point, first (r_u, r_v) and second (r_uu, r_uv, r_vv) derivatives, mm."""
    y, s = 80 * (v - 0.5), 0.006 * (1 - u / 2)
    point = np.array([200 * u, y, 25 * np.sin(np.pi * u) - s * y**2])
    r_u = np.array([200, 0, 25 * np.pi * np.cos(np.pi * u) + 0.003 * y**2])
    r_v = np.array([0, 80, -2 * s * y * 80])
    r_uu = np.array([0, 0, -25 * np.pi**2 * np.sin(np.pi * u)])
    r_uv = np.array([0, 0, 0.006 * y * 80])
    r_vv = np.array([0, 0, -2 * s * 80**2])
    return point, (r_u, r_v), (r_uu, r_uv, r_vv)


def forms(u, v):
    """Normal, first and second fundamental forms (E, F, G) and (L, M, N)."""
    _, (a, b), second = derivatives(u, v)
    normal = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    return normal, (a @ a, a @ b, b @ b), tuple(r @ normal for r in second)


def curvatures(u, v):
    """Principal curvatures, the smaller first (1/mm), and the unit direction of the smaller."""
    _, (a, b), _ = derivatives(u, v)
    _, (e, f, g), (l, m, n) = forms(u, v)
    values, vectors = eigh(-np.array([[l, m], [m, n]]), np.array([[e, f], [f, g]]))
    axis = vectors[0, 0] * a + vectors[1, 0] * b
    return values, axis / np.linalg.norm(axis)


def hertz_line(force_n_per_mm, radius_mm, curvature_per_mm, modulus_mpa):
    """Half width (mm) and largest pressure (MPa) of a cylinder on a curved face."""
    reduced = 1 / (1 / radius_mm + curvature_per_mm)
    b = np.sqrt(4 * force_n_per_mm * reduced / (np.pi * modulus_mpa))
    return b, 2 * force_n_per_mm / (np.pi * b)
