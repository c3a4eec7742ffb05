"""Reads a scenario file and the robot description beside its URDF, and turns both into SI units.

The file format is truecut's; the reading is written anew, so that a mistaken unit on either side shows up
as a disagreement. Keys that only concern claims, sweeps or the viewer are ignored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

MM = 1e-3
MPA = 1e6
RPM = 2.0 * math.pi / 60.0
ATMOSPHERE_PA = 101325.0


class ScenarioError(ValueError):
    """The scenario asks for something that this reference does not model, or lacks a key."""


@dataclass(frozen=True)
class LinkAdjustment:
    """How a moving link differs from the URDF: factor on mass and inertia, shift of the centre in the link's frame."""

    mass_factor: float = 1.0
    center_m: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Robot:
    """The arm, its posture and what drives it. Posture lists follow the chain."""

    urdf: Path
    config: Path
    tip: str | None
    posture_rad: list[float]
    posture_m: list[float]
    gravity: bool
    drive: str
    inertia_scale: float
    stiffness_scale: float
    damping_scale: float
    hold_against_sag: bool
    links: dict[str, LinkAdjustment] = field(default_factory=dict)
    rotor_factors: dict[str, float] = field(default_factory=dict)
    stiffness_factors: dict[str, float] = field(default_factory=dict)
    damping_factors: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Friction:
    """Friction of the foot on the workpiece; `mu` is the kinetic coefficient."""

    law: str
    mu: float
    mu_static: float = 0.0
    stribeck_speed_m_per_s: float = 0.0


@dataclass(frozen=True)
class Foot:
    """Pneumatic pressure foot: gas spring, sealed rod and friction. Pressure is gauge pressure."""

    pressure_pa: float
    bore_m: float
    cylinders: int
    gas_length_m: float
    polytropic_exponent: float
    axial_share: float | None
    seal_stiction_n: float
    rod_stiffness_n_per_m: float
    friction: Friction

    @property
    def area_m2(self) -> float:
        """Piston area of one cylinder."""
        return 0.25 * math.pi * self.bore_m**2

    @property
    def preload_n(self) -> float:
        """Force of all cylinders at touch-down."""
        return self.cylinders * self.pressure_pa * self.area_m2

    def gas_stiffness_n_per_m(self, arm_stiffness_n_per_m: float) -> float:
        """Stiffness of the enclosed gas (`docs/physics/pressure_foot.md`), or that which gives the stated axial share."""
        if self.axial_share is not None:
            return arm_stiffness_n_per_m * self.axial_share / (1.0 - self.axial_share)
        absolute_pa = self.pressure_pa + ATMOSPHERE_PA
        return self.cylinders * self.polytropic_exponent * absolute_pa * self.area_m2 / self.gas_length_m


@dataclass(frozen=True)
class Cutting:
    """Specific cutting forces (Pa) and edge forces (N per metre of engaged edge)."""

    axial_pa: float
    in_plane_pa: float
    in_plane_angle_rad: float
    edge_axial_n_per_m: float
    edge_radial_n_per_m: float
    edge_tangential_n_per_m: float


@dataclass(frozen=True)
class Chamfer:
    """Chamfering of one hole by feeding a conical cutter along the hole axis."""

    direction: str
    spindle_rad_per_s: float
    feed_m_per_rev: float
    depth_m: float
    half_angle_rad: float
    hole_diameter_m: float
    edges: int
    start_angle_rad: float
    dwell_revolutions: float
    regeneration: str
    cutting: Cutting
    foot: Foot | None

    @property
    def revolution_s(self) -> float:
        """Time of one spindle revolution."""
        return 2.0 * math.pi / self.spindle_rad_per_s

    @property
    def feed_per_tooth_m(self) -> float:
        """Feed between the passes of two successive edges."""
        return self.feed_m_per_rev / self.edges

    @property
    def feed_rate_m_per_s(self) -> float:
        """Feed speed during the ramp."""
        return self.feed_m_per_rev / self.revolution_s

    @property
    def ramp_s(self) -> float:
        """Time after which the feed stops: the edge then stands at full depth."""
        return (self.depth_m - self.feed_per_tooth_m) / self.feed_rate_m_per_s

    @property
    def duration_s(self) -> float:
        """Default length of a run: ramp and dwell."""
        return self.ramp_s + self.dwell_revolutions * self.revolution_s


@dataclass(frozen=True)
class Wheel:
    """Compliant wheel that travels over a flat plate."""

    radius_m: float
    width_m: float
    speed_rad_per_s: float
    spin: str
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    normal_force_n: float
    mu: float
    eccentricity_m: float
    feed_m_per_s: float
    strip_length_m: float
    strip_cells: int
    preston_per_pa: float


@dataclass(frozen=True)
class Milling:
    """A straight pass of an end mill; angles are counted from +y towards the feed."""

    spindle_rad_per_s: float
    feed_m_per_s: float
    axial_depth_m: float
    engagement_rad: tuple[float, float]
    regeneration: bool
    start_angle_rad: float
    lead_in_m: float | None
    ramp_m: float
    diameter_m: float
    teeth: int
    helix_rad: float
    runout_m: float
    tangential_pa: float
    radial_pa: float
    axial_pa: float
    edge_tangential_n_per_m: float
    edge_radial_n_per_m: float
    edge_axial_n_per_m: float
    indentation_n_per_m3: float
    flank_friction: float
    wear_land_m: float
    direction: tuple[float, float, float]
    length_m: float

    @property
    def tooth_period_s(self) -> float:
        """Time from one tooth to the next."""
        return 2.0 * math.pi / (self.spindle_rad_per_s * self.teeth)

    @property
    def feed_per_tooth_m(self) -> float:
        """Way from one tooth to the next."""
        return self.feed_m_per_s * self.tooth_period_s

    @property
    def settled_s(self) -> float:
        """When the cut has its full width and depth."""
        entry_m = 0.0 if self.lead_in_m is None else self.lead_in_m + 0.5 * self.diameter_m
        return (entry_m + self.ramp_m) / self.feed_m_per_s


@dataclass(frozen=True)
class Load:
    """Forces given in advance, at the tool. Vectors are in the process frame or the world frame."""

    frame: str
    constant_n: list[float]
    release_n: list[float]
    sweep_amplitude_n: list[float] = field(default_factory=lambda: [0.0] * 3)
    sweep_from_hz: float = 0.0
    sweep_to_hz: float = 0.0
    rotating_amplitude_n: float = 0.0
    rotating_frequency_hz: float = 0.0
    rotating_start_angle_rad: float = 0.0
    foot: Foot | None = None


@dataclass(frozen=True)
class Replay:
    """Measured inputs drive the arm."""

    mode: str


@dataclass(frozen=True)
class Scenario:
    """One scenario in SI units."""

    path: Path | None
    name: str
    robot: Robot
    duration_s: float
    process: Chamfer | Wheel | Milling | Load | Replay


def load(path: Path | str, overrides: dict[str, float] | None = None) -> Scenario:
    """Reads a scenario file. `overrides` maps dotted keys to values, as `truecut run --set` does."""
    path = Path(path)
    return from_table(read(path, overrides or {}), path)


def read(path: Path, overrides: dict[str, float]) -> dict:
    """A scenario file's document with these dotted keys set."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    for key, value in overrides.items():
        _set(table, key, value)
    return table


def from_table(table: dict, path: Path | None = None) -> Scenario:
    """Builds a scenario from a parsed TOML document."""
    processes = table.get("process", {})
    if len(processes) != 1:
        raise ScenarioError(f"{path}: exactly one process table is needed, found {sorted(processes)}")
    ((kind, body),) = processes.items()
    folder = path.parent if path else Path()
    readers = {"chamfer": _chamfer, "milling": _milling, "wheel": _wheel, "load": _load, "replay": _replay}
    if kind not in readers:
        known = ", ".join(sorted(readers))
        raise ScenarioError(f"{path}: this command knows no [process.{kind}], only {known}; tests/crosscheck checks others")
    process = readers[kind](body, folder)
    run = table.get("run", {})
    default_s = {
        Chamfer: lambda: process.duration_s,
        Wheel: lambda: process.strip_length_m / process.feed_m_per_s,
        Milling: lambda: process.length_m / process.feed_m_per_s,
        Load: lambda: run["duration_s"],
        Replay: lambda: math.inf,
    }[type(process)]
    return Scenario(
        path=path,
        name=table.get("name", ""),
        robot=_robot(table["robot"], path.parent if path else Path()),
        duration_s=float(run["duration_s"]) if "duration_s" in run else default_s(),
        process=process,
    )


def _set(table: dict, key: str, value: float) -> None:
    *parents, last = key.split(".")
    for name in parents:
        table = table.setdefault(name, {})
    table[last] = value


def _robot(t: dict, folder: Path) -> Robot:
    urdf = folder / t["urdf"]
    config = folder / t["config"] if "config" in t else urdf.with_name("robot.toml")
    return Robot(
        urdf=urdf,
        config=config,
        tip=t.get("tip"),
        posture_rad=[math.radians(a) for a in t.get("posture_deg", [])],
        posture_m=[a * MM for a in t.get("posture_mm", [])],
        gravity=t.get("gravity", True),
        drive=t.get("drive", "position"),
        inertia_scale=t.get("inertia_scale", 1.0),
        stiffness_scale=t.get("stiffness_scale", 1.0),
        damping_scale=t.get("damping_scale", 1.0),
        hold_against_sag=t.get("hold_against_sag", True),
        links={row["name"]: _link(row) for row in t.get("link", [])},
        rotor_factors=_joint_factors(t, "rotor_inertia_factor"),
        stiffness_factors=_joint_factors(t, "stiffness_factor"),
        damping_factors=_joint_factors(t, "damping_factor"),
    )


def _joint_factors(t: dict, key: str) -> dict[str, float]:
    return {row["name"]: row.get(key, 1.0) for row in t.get("joint", [])}


def _link(t: dict) -> LinkAdjustment:
    center_m = tuple(t.get(f"center_{axis}_mm", 0.0) * MM for axis in "xyz")
    return LinkAdjustment(mass_factor=t.get("mass_factor", 1.0), center_m=center_m)


def _foot(t: dict | None) -> Foot | None:
    if t is None:
        return None
    f = t.get("friction", {})
    mu = f.get("mu", 0.15)
    return Foot(
        pressure_pa=t["pressure_mpa"] * MPA,
        bore_m=t.get("bore_mm", 32.0) * MM,
        cylinders=t.get("cylinders", 2),
        gas_length_m=t.get("gas_length_mm", 50.0) * MM,
        polytropic_exponent=t.get("polytropic_exponent", 1.4),
        axial_share=t.get("axial_share"),
        seal_stiction_n=t.get("seal_stiction_n", 97.0),
        rod_stiffness_n_per_m=t.get("rod_stiffness_n_per_um", 50.0) * 1e6,
        friction=Friction(
            law=f.get("law", "coulomb"),
            mu=mu,
            mu_static=f.get("mu_static", mu),
            stribeck_speed_m_per_s=f.get("stribeck_speed_mm_per_s", 0.0) * MM,
        ),
    )


def _of_milling(material: dict, half_angle_rad: float) -> dict:
    """Keys of [process.chamfer.cutting] from those of an end mill's edge, turned towards the spindle."""
    out, up = math.cos(half_angle_rad), math.sin(half_angle_rad)
    tangential, across = material["tangential_mpa"], material["radial_mpa"]
    return {
        "axial_mpa": up * across,
        "in_plane_mpa": math.hypot(tangential, out * across),
        "in_plane_angle_deg": math.degrees(math.atan2(out * across, tangential)),
        "edge_axial_n_per_mm": up * material.get("edge_radial_n_per_mm", 0.0),
        "edge_radial_n_per_mm": out * material.get("edge_radial_n_per_mm", 0.0),
        "edge_tangential_n_per_mm": material.get("edge_tangential_n_per_mm", 0.0),
    }


def _chamfer(t: dict, folder: Path) -> Chamfer:
    if "cutting" in t:
        c = t["cutting"]
    else:
        c = _of_milling(_material(t["material"], folder), math.radians(t["half_angle_deg"]))
    return Chamfer(
        direction=t["direction"],
        spindle_rad_per_s=t["spindle_rpm"] * RPM,
        feed_m_per_rev=t["feed_mm_per_rev"] * MM,
        depth_m=t["depth_mm"] * MM,
        half_angle_rad=math.radians(t["half_angle_deg"]),
        hole_diameter_m=t["hole_diameter_mm"] * MM,
        edges=t.get("edges", 1),
        start_angle_rad=math.radians(t.get("start_angle_deg", 0.0)),
        dwell_revolutions=t.get("dwell_revolutions", 2.0),
        regeneration=t.get("regeneration", "axial"),
        cutting=Cutting(
            axial_pa=c["axial_mpa"] * MPA,
            in_plane_pa=c["in_plane_mpa"] * MPA,
            in_plane_angle_rad=math.radians(c.get("in_plane_angle_deg", 0.0)),
            edge_axial_n_per_m=c.get("edge_axial_n_per_mm", 0.0) / MM,
            edge_radial_n_per_m=c.get("edge_radial_n_per_mm", 0.0) / MM,
            edge_tangential_n_per_m=c.get("edge_tangential_n_per_mm", 0.0) / MM,
        ),
        foot=_foot(t.get("foot")),
    )


def _wheel(t: dict, _folder: Path) -> Wheel:
    return Wheel(
        radius_m=t["radius_mm"] * MM,
        width_m=t["width_mm"] * MM,
        speed_rad_per_s=t["speed_rpm"] * RPM,
        spin=t["spin"],
        stiffness_n_per_m=t["stiffness_n_per_mm"] / MM,
        damping_n_s_per_m=t.get("damping_n_s_per_mm", 0.0) / MM,
        normal_force_n=t["normal_force_n"],
        mu=t["mu"],
        eccentricity_m=t.get("eccentricity_um", 0.0) * 1e-6,
        feed_m_per_s=t["feed_mm_per_s"] * MM,
        strip_length_m=t["strip_length_mm"] * MM,
        strip_cells=t.get("strip_cells", 400),
        preston_per_pa=t["preston_per_pa"],
    )


def _milling(t: dict, folder: Path) -> Milling:
    cutter, path = t["cutter"], t["path"]
    cutting = t["cutting"] if "cutting" in t else _material(t["material"], folder)
    diameter_mm, teeth = cutter["diameter_mm"], cutter["teeth"]
    spindle = t["spindle_rpm"] * RPM
    if "feed_mm_per_s" in t:
        feed = t["feed_mm_per_s"] * MM
    else:
        feed = t["feed_mm_per_tooth"] * MM * teeth * spindle / (2.0 * math.pi)
    along = [b - a for a, b in zip(path["start_mm"], path["end_mm"])] if "end_mm" in path else path["direction"]
    length = math.hypot(*along)
    lead = t.get("lead_in_mm")
    part = t.get("radial_depth_mm", diameter_mm) / diameter_mm
    engagement = {
        "slot": (0.0, math.pi),
        "up": (0.0, math.acos(1.0 - 2.0 * part)),
        "down": (math.acos(2.0 * part - 1.0), math.pi),
        "between": (math.radians(t.get("entry_deg", 0.0)), math.radians(t.get("exit_deg", 0.0))),
    }[t["engagement"]]
    return Milling(
        spindle_rad_per_s=spindle,
        feed_m_per_s=feed,
        axial_depth_m=t["axial_depth_mm"] * MM,
        engagement_rad=engagement,
        regeneration=t.get("regeneration", True),
        start_angle_rad=math.radians(t.get("start_angle_deg", 0.0)),
        lead_in_m=None if lead is None else lead * MM,
        ramp_m=t.get("ramp_mm", 0.0) * MM,
        diameter_m=diameter_mm * MM,
        teeth=teeth,
        helix_rad=math.radians(cutter.get("helix_deg", 0.0)),
        runout_m=cutter.get("runout_um", 0.0) * 1e-6,
        tangential_pa=cutting["tangential_mpa"] * MPA,
        radial_pa=cutting["radial_mpa"] * MPA,
        axial_pa=cutting.get("axial_mpa", 0.0) * MPA,
        edge_tangential_n_per_m=cutting.get("edge_tangential_n_per_mm", 0.0) / MM,
        edge_radial_n_per_m=cutting.get("edge_radial_n_per_mm", 0.0) / MM,
        edge_axial_n_per_m=cutting.get("edge_axial_n_per_mm", 0.0) / MM,
        indentation_n_per_m3=cutting.get("indentation_n_per_mm3", 0.0) / MM**3,
        flank_friction=cutting.get("flank_friction", 0.0),
        wear_land_m=cutter.get("wear_land_mm", cutting.get("wear_land_mm", 0.0)) * MM,
        direction=tuple(a / length for a in along),
        length_m=length * MM if "end_mm" in path else path["length_mm"] * MM,
    )


def _material(t: dict, folder: Path) -> dict:
    """The set of coefficients that a material file holds under a name, or its only one."""
    sets = tomllib.loads((folder / t["file"]).read_text(encoding="utf-8"))["set"]
    chosen = [one for one in sets if one["id"] == t.get("set", sets[0]["id"])]
    if len(chosen) != 1 or ("set" not in t and len(sets) > 1):
        raise ScenarioError(f"{t['file']}: no set {t.get('set')}")
    return chosen[0]


def _load(t: dict, _folder: Path) -> Load:
    sweep = t.get("sweep", {})
    rotating = t.get("rotating", {})
    return Load(
        frame=t.get("frame", "process"),
        constant_n=t.get("constant_n", [0.0] * 3),
        release_n=t.get("release_n", [0.0] * 3),
        sweep_amplitude_n=sweep.get("amplitude_n", [0.0] * 3),
        sweep_from_hz=sweep.get("from_hz", 0.0),
        sweep_to_hz=sweep.get("to_hz", 0.0),
        rotating_amplitude_n=rotating.get("amplitude_n", 0.0),
        rotating_frequency_hz=rotating.get("frequency_hz", 0.0),
        rotating_start_angle_rad=math.radians(rotating.get("start_angle_deg", 0.0)),
        foot=_foot(t.get("foot")),
    )


def _replay(t: dict, _folder: Path) -> Replay:
    return Replay(mode=t.get("mode", "forward"))
