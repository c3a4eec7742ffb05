"""A brush with effects in it: the reference's bristles on a Cartesian machine, its way and the burr's removal written here.

The taught places are slides alone, so that the brush stays parallel to the block's edge and within its ends: one slice stands for all. A
burr that outlasts the run bears every bristle whose tip is over any part of it, of the tips' density rho a strip as wide as tip and burr
together: its section falls by k_p (tip + burr) rho n v per second, n the force of a bristle that is held at the edge and v its tip's speed.

Effects:

    stiffness     the modulus of the bristles times the factor
    eccentricity  the brush reaches further all around by C cos phi + S sin phi, phi its turn
    friction      mu times the factor
    removal       Preston's coefficient times the factor
"""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path

import numpy as np
from truecut_reference import urdf_model
from truecut_reference.brush import BrushRun, Tool
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot, read
from truecut_reference.wheel import Command

from .effects import Effect
from .led_way import led

# of the mesh that the scenario names
BLOCK_M = (0.1, 0.06, 0.02)
# a ray that comes under the edge or leaves it is 2e-4 of the force
ANGLES = 4 * 3840


class HiddenBrush(BrushRun):
    """The brush with what a nominal one does not have: eccentricity; and the edge under it."""

    def __init__(self, tool: Tool, plant: Plant, command: Command, edge: np.ndarray, eccentricity: tuple[float, float]) -> None:
        super().__init__(tool, plant, command)
        self.edge, self.eccentricity = edge, eccentricity

    def wrench(self, t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Told: the sum of the bristles' forces, friction, and rho n v on the edge."""
        place, axes, velocity, turning = self.tool_at(q, v)
        tool, phi = self.tool, self.tool.spin * t
        tool = dataclasses.replace(tool, radius=tool.radius + self.eccentricity[0] * math.cos(phi) + self.eccentricity[1] * math.sin(phi))
        way = self.edge[0] - place
        way -= way @ axes[:, 1] * axes[:, 1]
        held = float(np.linalg.norm(way))
        if held >= tool.radius:
            return np.zeros(3), np.zeros(3), np.zeros(3)
        inside = 0.5 * tool.width
        assert self.edge[0][1] + inside < place[1] < self.edge[1][1] - inside
        found = tool.loads(place, axes, velocity, turning)
        tip = velocity + np.cross(turning + tool.spin * axes[:, 1], way)
        tip -= tip @ way / held**2 * way
        density = tool.bristles / (2.0 * math.pi * held * tool.width)
        dose = density * float(tool.bristle(tool.radius - held)) * float(np.linalg.norm(tip))
        return found[:3], found[3:6], np.array([*found[6:], dose])


def taught_command(rows_m: np.ndarray, feed: float, until_s: float) -> Command:
    """All slides move together from posture to posture, as long as the way takes at the feed."""
    lengths = np.linalg.norm(np.diff(rows_m, axis=0), axis=1)
    at_s = np.concatenate([[0.0], np.cumsum(lengths)]) / feed
    t, places = led(until_s, lambda clock_s: np.stack([np.interp(clock_s, at_s, rows_m[:, k]) for k in range(3)], axis=1))
    return Command(t, places)


def run(path: Path, overrides: dict[str, float], effects: list[Effect], step_s: float):
    """Times and values of the channels, SI."""
    whole = read(path, overrides)
    values = {effect.kind: effect.values for effect in effects}

    def factor(kind: str) -> float:
        return values.get(kind, {"factor": 1.0})["factor"]

    table, duration_s = whole["process"]["brush"], whole["run"]["duration_s"]
    with (path.parent / table["taught"]).open(encoding="utf-8") as file:
        rows_m = 1e-3 * np.array([[float(x) for x in row] for row in list(csv.reader(file))[1:]])
    whole["robot"]["posture_mm"] = (1e3 * rows_m[0]).tolist()
    robot = _robot(whole["robot"], path.parent)
    table["youngs_modulus_mpa"] *= factor("wheel_stiffness")
    table["mu"] *= factor("wheel_friction")
    tool = dataclasses.replace(Tool.of(table, BLOCK_M), slices=1, angles=ANGLES)
    (edge,) = table["edge"]
    ends = tool.corner + 1e-3 * np.array(edge["points_mm"])
    model = urdf_model.from_urdf(robot)
    # a state at the very end, too
    until_s = duration_s + step_s
    command = taught_command(rows_m, table["feed_mm_per_s"] * 1e-3, until_s)
    plant = Plant(model, robot, command.joints[0])
    at = values.get("wheel_eccentricity", {"cosine_m": 0.0, "sine_m": 0.0})
    brush = HiddenBrush(tool, plant, command, ends, (at["cosine_m"], at["sine_m"]))
    states, places, forces, told = brush.run(step_s, until_s)
    burr, tip = edge["burr_thickness_mm"] * 1e-3, table["bristle_diameter_mm"] * 1e-3
    section = table["preston_per_pa"] * factor("wheel_removal") * (tip + burr) * step_s * np.cumsum(told[:, 2])
    # no place is under the brush for longer than the whole run
    assert section[-1] < burr * edge["burr_height_mm"] * 1e-3
    channels = {
        "brush.bristle_force": (forces, told[:, 0]),
        "brush.friction_force": (forces, told[:, 1]),
        # what was taken off by the end of each step
        "brush.removed_volume": (states + step_s, tool.width * section),
        "tool.position_x": (states, places[:, 0]),
        "tool.position_z": (states, places[:, 2]),
    }
    return {name: t for name, (t, _) in channels.items()}, {name: x for name, (_, x) in channels.items()}
