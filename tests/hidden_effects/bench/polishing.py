"""Polishing with effects in it: the reference's contact on a Cartesian machine, its path and force control written here.

A wheel whose axis leans steadily follows the first line of a raster over a face. Its middle is led along the line at the
height at which the undeformed wheel reaches into the face by what is commanded; the way along it grows with a clock whose
rate rises as 3u^2 - 2u^3 over the run-up, and is smoothed by Hann's window.

Effects:

    stiffness     all of the wheel's pressures times the factor: c1 / f, c2 / f^2, N f
    eccentricity  the middle stands at e + (C, S) in the tool's axes at the start
    friction      mu times the factor
    removal       Preston's coefficient times the factor
    edge grains   edges that are run over inward are held along the sliding, by that share of its force times the sine of the angle to it
    offset        the control holds that much more
    stiction      what is missing of the force is made up for beyond that much only
"""

from __future__ import annotations

import cmath
import copy
import dataclasses
import math
from pathlib import Path

import numpy as np
from truecut_reference import urdf_model
from truecut_reference.plant import Plant
from truecut_reference.polish import PolishRun, Tool
from truecut_reference.scenario import _robot, read
from truecut_reference.wheel import Command

from .effects import Effect

RUN_UP_S = 0.5
WINDOW_S = 0.1
WINDOW_SAMPLES = 20
COMMAND_EVERY_S = 1e-3
# The longest indentation that is looked for, as a part of the radius.
DEEPEST = 0.2


def hidden_tool(table: dict, values: dict[str, dict[str, float]]) -> Tool:
    """Wheel and face of the scenario with effects."""
    plain = copy.deepcopy(table)
    plain["control"] = {"law": "position"}
    tool = Tool.of(plain)
    factor = values.get("wheel_stiffness", {"factor": 1.0})["factor"]
    more = values.get("wheel_eccentricity", {"cosine_m": 0.0, "sine_m": 0.0})
    middle = cmath.rect(tool.eccentricity, tool.start_angle) + complex(more["cosine_m"], more["sine_m"])
    return dataclasses.replace(
        tool,
        tension=tool.tension * factor,
        modulus=tool.modulus * factor,
        jamming=values.get("wheel_edge_grains", {"share": 0.0})["share"],
        mu=tool.mu * values.get("wheel_friction", {"factor": 1.0})["factor"],
        eccentricity=abs(middle),
        start_angle=cmath.phase(middle),
        table=[],
    )


def pressed_force_n(tool: Tool, depth_m: float) -> float:
    """Force at rest at an indentation, far from edges."""
    return tool.shell.at(depth_m / tool.radius)[0] * tool.modulus * tool.radius**2


def commanded_depth_m(table: dict) -> float:
    """How far the path reaches into the face: as asked for, or what the nominal wheel needs for the force."""
    control = table["control"]
    if control["law"] == "position":
        return control["indentation_mm"] * 1e-3
    nominal = hidden_tool(table, {})
    low, high = 0.0, DEEPEST * nominal.radius
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pressed_force_n(nominal, middle) < control["force_n"] else (low, middle)
    return 0.5 * (low + high)


def way_m(feed_m_per_s: float, t: np.ndarray) -> np.ndarray:
    """Way along the line at times."""

    def clock(at):
        u = np.clip(at / RUN_UP_S, 0.0, 1.0)
        return RUN_UP_S * (u**3 - 0.5 * u**4) + np.maximum(at - RUN_UP_S, 0.0)

    share = (np.arange(WINDOW_SAMPLES) + 0.5) / WINDOW_SAMPLES
    weights = (1.0 - np.cos(2.0 * np.pi * share)) / WINDOW_SAMPLES
    smooth = sum(w * clock(t + (s - 0.5) * WINDOW_S) for s, w in zip(share, weights))
    return feed_m_per_s * smooth


def line_command(table: dict, tool: Tool, plant: Plant, duration_s: float) -> Command:
    """Slides along world x, y and z lead the wheel's middle along the first line."""
    height = tool.radius - commanded_depth_m(table)
    inset = table["path"].get("inset_mm", 0.0) * 1e-3
    t = np.linspace(0.0, duration_s, round(duration_s / COMMAND_EVERY_S) + 1)
    along = inset + way_m(table["path"]["feed_mm_per_s"] * 1e-3, t)
    in_face = np.stack([along, np.full_like(t, inset), np.full_like(t, height)], axis=1)
    places = tool.origin + in_face @ tool.axes
    return Command(t, plant.q0 + places - plant.tool_position0)


class Carrier:
    """The force control: a carrier without mass that moves the wheel along the normal."""

    def __init__(self, control: dict, values: dict[str, dict[str, float]]) -> None:
        assert control["law"] == "constant_force"
        self.force_n = control["force_n"] + values.get("wheel_force_offset", {"force_n": 0.0})["force_n"]
        self.stiction_n = values.get("wheel_force_stiction", {"force_n": 0.0})["force_n"]
        self.damping = control["damping_n_s_per_mm"] * 1e3
        self.fastest = control["fastest_mm_per_s"] * 1e-3

    def rate(self, pressed_n: float) -> float:
        """Speed towards the face."""
        missing = self.force_n - pressed_n
        beyond = math.copysign(max(abs(missing) - self.stiction_n, 0.0), missing)
        return max(-self.fastest, min(self.fastest, beyond / self.damping))


def run(path: Path, overrides: dict[str, float], effects: list[Effect], step_s: float):
    """Times and values of the channels, SI."""
    whole = read(path, overrides)
    table, duration_s = whole["process"]["polish"], whole["run"]["duration_s"]
    values = {effect.kind: effect.values for effect in effects}
    tool, robot = hidden_tool(table, values), _robot(whole["robot"], path.parent)
    model = urdf_model.from_urdf(robot)
    first = Plant(model, robot)
    command = line_command(table, tool, first, duration_s)
    plant = Plant(model, robot, command.joints[0])
    carrier = None if table["control"]["law"] == "position" else Carrier(table["control"], values)
    preston = table["preston_per_pa"] * values.get("wheel_removal", {"factor": 1.0})["factor"]
    wheel = PolishRun(tool, plant, command)
    wheel.settle()
    moved, at_rate = command.spline(), command.spline().derivative()
    d, places, told = plant.data, [], []
    count = math.ceil(duration_s / step_s - 1e-9)
    for i in range(count):
        half = (i + 0.5) * step_s
        places.append(d.site_xpos[plant.site["tool"]].copy())
        middle = d.qpos + 0.5 * step_s * d.qvel + 0.125 * step_s**2 * d.qacc
        start_m = wheel.offset
        wheel.offset = start_m + 0.5 * step_s * wheel.rate
        force, moment, found = wheel.wrench(half, middle, d.qvel + 0.5 * step_s * d.qacc)
        told.append(found)
        if carrier is not None:
            wheel.rate = carrier.rate(float(found[0]))
            wheel.offset = start_m + step_s * wheel.rate
        torque = plant.stiffness * (moved(half) - plant.command0) + plant.damping * at_rate(half)
        plant.apply(plant.axes @ force, np.zeros(3), torque, plant.axes @ moment)
        plant.step(step_s)
    states = step_s * np.arange(count)
    forces = states + 0.5 * step_s
    told, places = np.array(told), np.array(places)
    channels = {
        "polish.normal_force": (forces, told[:, 0]),
        "polish.friction_x": (forces, -told[:, 2]),
        "polish.friction_y": (forces, -told[:, 3]),
        # what was taken off by the end of each step
        "polish.removed_volume": (states + step_s, preston * step_s * np.cumsum(told[:, 4])),
        "tool.position_x": (states, places[:, 0]),
        "tool.position_z": (states, places[:, 2]),
    }
    return {name: t for name, (t, _) in channels.items()}, {name: x for name, (_, x) in channels.items()}
