"""Contacts of soft wheels drawn from a seed: docs/physics/wheel_contact.md.

A belt over bonded rubber as an obstacle problem on a line, a shell under air ring by ring, and a
point patch that an edge cuts as an obstacle problem in two dimensions (a layer on Hertz's bed).
None of them takes the program's expansions; the first two solve the elasticity by
`truecut_reference`, the third the layer's equation (`edge_share.py`).

    python tests/reference/wheels.py > crates/core/tests/wheels.csv
"""

import sys
from pathlib import Path

import numpy as np
from edge_share import FAR, obstacle

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
    """Force on a face that ends at `edge`: of the whole patch, so that its bed need not be right, only what the edge takes.

    `nodes` to the overlap's length.
    """
    u0, _, _, log_tread = tool.patch(depth)
    whole = tool.shell.at(depth / tool.radius)[0] * tool.modulus * tool.radius**2
    layer = tool.tension / (2 * tool.radius) * np.sqrt(np.exp(log_tread) / u0)
    at, h = edge / np.sqrt(2 * tool.radius * u0), 2.0 / nodes
    return whole * obstacle(layer, at, h) / obstacle(layer, FAR, h)


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
