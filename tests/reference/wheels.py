"""Contacts of soft wheels drawn from a seed: docs/physics/wheel_contact.md.

A belt over bonded rubber as an obstacle problem on a line, a shell under air ring by ring, and a
point patch that an edge cuts as an obstacle problem in two dimensions (a layer on Hertz's bed).
None of them takes the program's expansions; the first two solve the elasticity by
`truecut_reference`, the third the layer's equation by Newton's iteration on an active set.

    python tests/reference/wheels.py > crates/core/tests/wheels.csv
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

sys.path.append(str(Path(__file__).parents[1] / "crosscheck"))
from truecut_reference.bonded import Layer, line_load  # noqa: E402
from truecut_reference.polish import Tool  # noqa: E402
from truecut_reference.shell import Shell  # noqa: E402

SEED = 20_261_124
BELTS, SHELLS, EDGES, WIDER = 16, 12, 6, 12


def belt(rng):
    """Relative radius, rubber, Poisson's ratio, contact modulus, tension per width, indentation, force per width; SI."""
    radius, rubber = rng.uniform(10e-3, 60e-3), rng.uniform(4e-3, 25e-3)
    poisson, modulus = rng.choice([0.0, 0.3, rng.uniform(0.4, 0.495)]), rng.uniform(2e6, 20e6)
    wide = rng.uniform(0.05, 1.0)
    depth = Layer(poisson).patch(wide)[1] * (wide * rubber) ** 2 / (2 * radius)
    tension = rng.choice([0.0, rng.uniform(200, 3000)])
    force = line_load(depth, radius, modulus, rubber, poisson, tension, 4096)
    return radius, rubber, poisson, modulus, tension, depth, force


def shell(rng):
    """Radius, shell, Poisson's ratio, modulus, pressure, indentation, force."""
    radius, poisson, young = rng.uniform(10e-3, 40e-3), rng.uniform(0.3, 0.495), rng.uniform(1e6, 10e6)
    thickness, pressure = rng.choice([rng.uniform(0.05, 0.3), rng.uniform(0.3, 0.95)]), rng.uniform(0, 0.2e6)
    part = 10 ** rng.uniform(-2.5, -1.2)
    plane = young / (1 - poisson**2)
    tension = pressure * (radius * (1 - thickness)) ** 2 / (2 * radius * (1 - thickness / 2))
    found = Shell(thickness, poisson, tension / (plane * radius), part)
    force = found.contact(part)[0] * plane * radius**2
    return radius, thickness * radius, poisson, young, pressure, part * radius, force


def cut(tool, depth, edge, nodes=75):
    """Force on a face that ends at `edge`: of the whole patch, so that its bed need not be right, only what the edge takes."""
    whole = tool.shell.at(depth / tool.radius)[0] * tool.modulus * tool.radius**2
    far = 10.0 * tool.radius
    return whole * obstacle(tool, depth, edge, nodes) / obstacle(tool, depth, far, nodes)


def obstacle(tool, depth, edge, nodes=75):
    """What a face that ends at `edge` presses: a layer at least as deep as the wheel on the face, free beyond.

    `nodes` to the overlap's length; the grid reaches as far as the stretched layer is moved.
    """
    u0, _, _, log_tread = tool.patch(depth)
    tread, half = np.exp(log_tread), np.sqrt(2 * tool.radius * u0)
    reach = half * (1.3 + 2.9 * np.sqrt(tool.tension / (2 * tool.radius) * np.sqrt(tread / u0)))
    nodes = 2 * int(np.ceil(0.5 * nodes * reach / half)) + 1
    line = np.linspace(-reach, reach, nodes)
    h = line[1] - line[0]
    # a row of nodes on the edge
    x, y = np.meshgrid(line + min(edge, reach) - line[np.argmin(np.abs(line - edge))], line, indexing="ij")
    asked, face = (u0 - (x**2 + y**2) / (2 * tool.radius)).ravel(), (x <= edge + 1e-9).ravel()
    one, second = sparse.identity(nodes), sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(nodes, nodes))
    pulls = (sparse.kron(second, one) + sparse.kron(one, second)).tocsr() * tool.tension / h**2
    # the root of the bed is rounded off where it begins
    soft = 1e-4 * u0
    w, touches = np.maximum(asked, 0.0), face & (asked > 0)
    for _ in range(60):
        free = ~touches
        w[touches] = asked[touches]
        for _ in range(40):
            grows = 1 / np.sqrt(tread * (np.abs(w) + soft))
            bed = w * grows
            slope = grows - 0.5 * np.abs(w) * grows / (np.abs(w) + soft)
            system = (pulls - sparse.diags(slope))[free][:, free]
            step = spsolve(system.tocsc(), -(pulls @ w - bed)[free])
            w[free] += step
            if np.abs(step).max() < 1e-9 * u0:
                break
        pressed = bed_pa(w, tread, soft) - pulls @ w
        now = np.where(touches, pressed > 0, face & (w < asked))
        if (now == touches).all():
            return float(pressed[touches].sum() * h * h)
        touches = now
    raise RuntimeError("no contact was found")


def bed_pa(w, tread, soft):
    """The bed's pressure."""
    return w / np.sqrt(tread * (np.abs(w) + soft))


def wheel(radius, thickness, poisson, young, pressure):
    """A wheel of `truecut_reference/polish.py` on a large face."""
    rubber = {"radius_mm": radius * 1e3, "shell_thickness_mm": thickness * 1e3, "poisson": poisson}
    rubber |= {"youngs_modulus_mpa": young * 1e-6, "pressure_mpa": pressure * 1e-6}
    face = {"origin_mm": [0, 0, 0], "length_mm": 1000, "width_mm": 1000}
    return Tool.of({"wheel": rubber, "face": face, "control": {"law": "position"}, "spin_rpm": 0, "mu": 0.3})


def edge(rng):
    """Radius, shell, Poisson's ratio, modulus, pressure, indentation, where the face ends from the middle, force."""
    radius, poisson, young = rng.uniform(12e-3, 30e-3), rng.uniform(0.4, 0.49), rng.uniform(2e6, 8e6)
    thickness, pressure = radius * rng.uniform(0.08, 0.4), rng.uniform(0.03e6, 0.2e6)
    depth = radius * rng.uniform(0.022, 0.06)
    tool = wheel(radius, thickness, poisson, young, pressure)
    at = rng.uniform(-0.5, 0.9) * tool.patch(depth)[2]
    return radius, thickness, poisson, young, pressure, depth, at, cut(tool, depth, at)


def wider(rng):
    """The same from softer wheels under more air, that hang farther off the face."""
    radius, poisson, young = rng.uniform(10e-3, 40e-3), rng.uniform(0.3, 0.495), 10 ** rng.uniform(6.0, 7.0)
    thickness, pressure = radius * rng.uniform(0.05, 0.4), rng.uniform(0.03e6, 0.3e6)
    depth = radius * 10 ** rng.uniform(-2.3, -1.2)
    tool = wheel(radius, thickness, poisson, young, pressure)
    at = rng.uniform(-0.9, 0.8) * tool.patch(depth)[2]
    return radius, thickness, poisson, young, pressure, depth, at, cut(tool, depth, at)


if __name__ == "__main__":
    rng, other = np.random.default_rng(SEED), np.random.default_rng(SEED + 1)
    print("# python tests/reference/wheels.py > crates/core/tests/wheels.csv")
    drawn = (("belt", belt, BELTS, rng), ("shell", shell, SHELLS, rng), ("edge", edge, EDGES, rng), ("edge", wider, WIDER, other))
    for kind, draw, count, rng in drawn:
        for _ in range(count):
            print(kind, *(f"{value:.6g}" for value in draw(rng)), sep=",", flush=True)
