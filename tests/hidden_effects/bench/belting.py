"""A belt with effects in it: the reference's contact on a Cartesian machine, its way written here.

The wheel's middle comes down on a line at the feed and is led along it, at the height at which the undeformed wheel reaches into the
plane by the job's indentation.

Effects:

    stiffness     the rubber's modulus times the factor
    eccentricity  the wheel reaches further by C cos phi + S sin phi, phi the belt's way over its radius
    friction      mu times the factor
    removal       Preston's coefficient times the factor
    offset        the carrier holds that much more
    stiction      what is missing of the force is made up for beyond that much only
"""

from __future__ import annotations

import copy
import dataclasses
import math
from pathlib import Path

import numpy as np
from truecut_reference import urdf_model
from truecut_reference.belt import BeltRun, Tool
from truecut_reference.plant import Plant
from truecut_reference.scenario import _robot, read, tomllib
from truecut_reference.wheel import Command

from .effects import Effect
from .led_way import led


def hidden_tool(table: dict, job: dict, outside: tuple[float, float, float], values: dict[str, dict[str, float]]) -> Tool:
    """Wheel, belt and plane of the scenario with effects."""
    job = copy.deepcopy(job)
    job["wheel"]["modulus_mpa"] *= values.get("wheel_stiffness", {"factor": 1.0})["factor"]
    tool = Tool.of(table, job, outside)
    control = tool.control
    if control is not None:
        more = values.get("wheel_force_offset", {"force_n": 0.0})["force_n"]
        control = (control[0] + more, *control[1:])
    mu = tool.mu * values.get("wheel_friction", {"factor": 1.0})["factor"]
    return dataclasses.replace(tool, mu=mu, control=control)


class HiddenBelt(BeltRun):
    """The belt with what a nominal one does not have: eccentricity, and a carrier that sticks."""

    def __init__(self, tool: Tool, plant: Plant, command: Command, values: dict[str, dict[str, float]]) -> None:
        super().__init__(tool, plant, command)
        at = values.get("wheel_eccentricity", {"cosine_m": 0.0, "sine_m": 0.0})
        self.cosine_m, self.sine_m = at["cosine_m"], at["sine_m"]
        self.stiction_n = values.get("wheel_force_stiction", {"force_n": 0.0})["force_n"]
        if tool.control is not None:
            self.out = tool.control[3]  # it comes from the air

    def eccentricity(self, t: float) -> tuple[float, float]:
        """The wheel's, by the way of the belt."""
        spin = self.tool.speed / self.tool.radius
        cos, sin = math.cos(spin * t), math.sin(spin * t)
        return self.cosine_m * cos + self.sine_m * sin, spin * (self.sine_m * cos - self.cosine_m * sin)

    def missing(self, force: float) -> float:
        """What is missing beyond the stiction."""
        missing = super().missing(force)
        return math.copysign(max(abs(missing) - self.stiction_n, 0.0), missing)


def line_command(job: dict, patch: dict, tool: Tool, plant: Plant, duration_s: float) -> Command:
    """Slides along world x, y and z lead the wheel's middle down onto the first line and along it."""
    path, wheel = job["path"], job["wheel"]
    feed, lift = path["feed_mm_per_s"] * 1e-3, path["lift_mm"] * 1e-3
    corner = (np.array(job["surface"]["xyz_mm"]) + np.array(patch["corner_mm"])) * 1e-3
    side_u, side_v = (np.array(patch[f"side_{x}_mm"]) * 1e-3 for x in "uv")
    along = side_u / np.linalg.norm(side_u)
    # the wheel's width keeps within the border, and half the contact it was planned for within the line's ends
    inset_v = 0.5 * wheel["width_mm"] * 1e-3
    line_load, modulus = wheel["line_load_n_per_mm"] * 1e3, wheel["modulus_mpa"] * 1e6
    inset_u = math.sqrt(4.0 * line_load * tool.radius / (math.pi * modulus))
    start = corner + inset_u * along + inset_v * side_v / np.linalg.norm(side_v)
    height = tool.radius - wheel["indentation_mm"] * 1e-3

    def place_of(clock_s: np.ndarray) -> np.ndarray:
        way = feed * clock_s
        above = height + np.maximum(lift - way, 0.0)
        return start + np.maximum(way - lift, 0.0)[:, None] * along + above[:, None] * tool.normal

    t, places = led(duration_s, place_of)
    return Command(t, plant.q0 + places - plant.tool_position0)


def run(path: Path, overrides: dict[str, float], effects: list[Effect], step_s: float):
    """Times and values of the channels, SI."""
    whole = read(path, overrides)
    table, duration_s = whole["process"]["belt"], whole["run"]["duration_s"]
    job_path = path.parent / table["job"]
    job = tomllib.loads(job_path.read_text(encoding="utf-8"))
    patch = tomllib.loads((job_path.parent / job["surface"]["patch"]).read_text(encoding="utf-8"))
    whole["robot"]["posture_mm"] = job["robot"]["posture_mm"]
    values = {effect.kind: effect.values for effect in effects}
    robot = _robot(whole["robot"], path.parent)
    tool = hidden_tool(table, job, tuple(patch["outside"]), values)
    model = urdf_model.from_urdf(robot)
    # a state at the very end, too
    until_s = duration_s + step_s
    command = line_command(job, patch, tool, Plant(model, robot), until_s)
    plant = Plant(model, robot, command.joints[0])
    preston = table["preston_per_pa"] * values.get("wheel_removal", {"factor": 1.0})["factor"]
    states, places, forces, told = HiddenBelt(tool, plant, command, values).run(step_s, until_s)
    channels = {
        "belt.normal_force": (forces, told[:, 0]),
        "belt.friction_run": (forces, told[:, 1]),
        # what was taken off by the end of each step
        "belt.removed_volume": (states + step_s, preston * step_s * np.cumsum(told[:, 2])),
        "tool.position_x": (states, places[:, 0]),
        "tool.position_z": (states, places[:, 2]),
    }
    return {name: t for name, (t, _) in channels.items()}, {name: x for name, (_, x) in channels.items()}
