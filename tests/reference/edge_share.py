"""What part of the line reaction that planes across an edge give a straight edge under a point patch bears.

In planes across the edge the layer's curvature along it is taken where the layer leaves, not on its way out, and the
layer may lie on the face where in truth it is lifted. The layer's equation in two dimensions, as an obstacle problem
(`q(w) = N lap w + p`, w at least the indentation on the face, p zero off it), has neither. With lengths in
sqrt(2 R u0), deflections in u0 and pressures in the bed's q(u0) two numbers are left: N/2Rq(u0), which is a quarter of
the layer's pressure over the bed's, and where the edge lies, positive with the patch's middle on the face.

    python tests/reference/edge_share.py

prints the table of `crates/core/src/wheel/patch/edge_share.rs`, a row for each stretch, in some twenty minutes.
"""

import math
import sys
from pathlib import Path

import numpy as np
import scipy.optimize
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

sys.path.append(str(Path(__file__).parents[1] / "crosscheck"))
from truecut_reference.edge_share import PLACES, STRETCHES  # noqa: E402

# Relative radius in lengths of the patch: u = 1 - r².
RADIUS = 0.5
# An edge so far out cuts nothing.
FAR = 3.0
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(160)
# An edge that bears less of the whole force says nothing.
LEAST = 0.01


def layer(stretch):
    """N/2Rq of a node of the table."""
    return (stretch / (1.0 - stretch)) ** 2


def leaving(n, w, fall):
    """N |w'| of a layer that leaves Hertz's bed at the deflection w along a line on which it falls off as w - fall y²/2."""
    straight = 2.0 * n * 2.0 / 3.0 * w**1.5
    bending = n * 8.0 / 7.0 * w * np.sqrt(straight) * n * fall
    s = np.sqrt(straight) + np.cbrt(bending)
    for _ in range(60):
        s = s - (s**3 - straight * s - bending) / (3.0 * s * s - straight)
    return s


def rim(n):
    """Radius of the free patch: the layer leaves it without a kink."""

    def kink(c):
        w = 1.0 - c * c
        straight = 2.0 * n * 2.0 / 3.0 * w**1.5
        return math.sqrt(straight + n * 8.0 / 7.0 * w * math.sqrt(straight) / c) - n * c / RADIUS

    return scipy.optimize.brentq(kink, 1e-6, 1.0 - 1e-12)


def planes(n, edge):
    """Force of the part of the patch on the face, and of the edge, found in planes across it."""
    c = rim(n)
    inside, bears = 0.0, 0.0
    high = min(c, edge)
    if high > -c:
        a, b = -0.5 * math.pi, math.asin(high / c)
        angle = 0.5 * (a + b) + 0.5 * (b - a) * _NODES
        for x, weight in zip(c * np.sin(angle), _WEIGHTS * 0.5 * (b - a) * c * np.cos(angle)):
            half = math.sqrt(max(c * c - x * x, 0.0))
            y = half * np.sin(0.5 * math.pi * _NODES)
            across = _WEIGHTS * 0.5 * math.pi * half * np.cos(0.5 * math.pi * _NODES)
            inside += weight * float(across @ (np.sqrt(1.0 - x * x - y * y) + 2.0 * n / RADIUS))
    if abs(edge) < 1.0:
        half = math.sqrt(1.0 - edge * edge)
        y = half * np.sin(0.5 * math.pi * _NODES)
        along = _WEIGHTS * 0.5 * math.pi * half * np.cos(0.5 * math.pi * _NODES)
        overhang = leaving(n, 1.0 - edge * edge - y * y, 1.0 / RADIUS)
        on_face = -n * edge / RADIUS
        knife = overhang if on_face > 0.0 else 0.0
        bears = float(along @ np.maximum(overhang + np.minimum(on_face, knife), 0.0))
    return inside, bears


def obstacle(n, edge, h):
    """What the face presses, on a grid of the spacing h, by Newton's iteration on an active set; half of it by symmetry."""
    reach = 1.05 + 2.9 * math.sqrt(n)
    count = math.ceil(2.0 * reach / h)
    # a row of nodes on the edge
    x = edge + h * (np.arange(count + 1) - math.floor((edge + reach) / h))
    y = h * np.arange(math.ceil(reach / h) + 1)
    xs, ys = np.meshgrid(x, y, indexing="ij")
    asked, face = (1.0 - xs**2 - ys**2).ravel(), (xs <= edge + 1e-9).ravel()

    def second(size, mirrored):
        lines = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(size, size)).tolil()
        if mirrored:
            lines[0, 1] = 2.0
        return lines.tocsr()

    one = sparse.identity
    pulls = sparse.kron(second(len(x), False), one(len(y))) + sparse.kron(one(len(x)), second(len(y), True))
    pulls = pulls.tocsr() * (n / h**2)
    area = np.where(ys == 0.0, 1.0, 2.0).ravel() * h * h
    # the root of the bed is rounded off where it begins
    soft = 1e-6
    w, touches = np.maximum(asked, 0.0), face & (asked > 0)
    for _ in range(80):
        free = ~touches
        w[touches] = asked[touches]
        inner = pulls[free][:, free]
        for _ in range(40):
            grows = 1.0 / np.sqrt(np.abs(w) + soft)
            slope = grows - 0.5 * np.abs(w) * grows / (np.abs(w) + soft)
            step = spsolve((inner - sparse.diags(slope[free])).tocsc(), -(pulls @ w - w * grows)[free])
            w[free] += step
            if np.abs(step).max() < 1e-8:
                break
        pressed = w / np.sqrt(np.abs(w) + soft) - pulls @ w
        now = np.where(touches, pressed > 0, face & (w < asked))
        if (now == touches).all():
            return float((pressed * area)[touches].sum())
        touches = now
    raise RuntimeError("no contact was found")


def limit(n, edge):
    """The force of two grids, extrapolated by the first power of the spacing: a jump of the pressure lies on the edge."""
    h = min(0.25 * math.sqrt(n), 0.05)
    coarse, fine = obstacle(n, edge, h), obstacle(n, edge, h / 1.5)
    return fine + 2.0 * (fine - coarse)


def share(n, edge, force=limit, whole=None):
    """Of the reaction in planes, so that the force falls from that of the whole patch as in two dimensions."""
    free = planes(n, FAR)[0]
    inside, bears = planes(n, edge)
    if bears < LEAST * free:
        return math.nan
    whole = force(n, FAR) if whole is None else whole
    return (force(n, edge) / whole * free - inside) / bears


if __name__ == "__main__":
    for stretch in STRETCHES[1:]:
        all_of_it = limit(layer(stretch), FAR)
        print(*(f"{share(layer(stretch), place, whole=all_of_it):.4f}" for place in PLACES), sep=", ", flush=True)
