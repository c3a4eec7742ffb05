"""The bench's cases: what is hidden in each data set, how noisy it is, and what a right answer is.

The seed shifts everything that is drawn: sizes, nominal deviations, noise. Thresholds are tuned on other seeds than
those whose results are reported.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from .effects import Effect
from .experiment import ALL
from .library import (
    ANGLE,
    BELT,
    BELT_PAIR,
    BRUSH,
    BRUSH_PAIR,
    CLOCK,
    INSEPARABLE,
    MILLING,
    MILLING_PAIR,
    PAIRS,
    POLISHING,
    POLISHING_EDGE,
    POLISHING_PAIR,
    SINGLES,
    STRANGERS,
    TILT,
    TORQUE,
    single,
)
from .noise import COLOURS

SEEDS = {"report": 30_000, "tune": 20_000}
LEVELS = {"strong": 10.0, "middle": 2.0, "weak": 0.5}
CLEAN_SETS = 300
LED_CLEAN_SETS = 12
CLEAN_EXPERIMENTS = ("axis", "two_joint", "chamfer", "teeth", "wheel")
NOMINAL_VARIANTS = 4


@dataclass(frozen=True)
class Case:
    """One data set. `level` is effect over noise; without an effect, `noise` is that of the reference times itself."""

    family: str
    experiment: str
    truth: tuple[Effect, ...]
    expected: str
    """named | pair | contains | nothing | unknown | ambiguous | not_identifiable | not_named | refused"""
    shifts: tuple[float, ...]
    colour: str
    seed: int
    level: float | None = None
    noise: float = 1.0
    size: float = 1.0
    partner: Effect | None = None
    damage: str = ""
    still: float | None = None


def base_of(seeds: str) -> int:
    """The number that all seeds of a named bench start from; a number names a bench of its own."""
    return SEEDS[seeds] if seeds in SEEDS else int(seeds)


class _Draw:
    """Counts cases and draws what differs between them."""

    def __init__(self, seeds: str) -> None:
        self.base = base_of(seeds)
        self.count = 0
        self.variants = {name: self._shifts(i, len(e.uncertain)) for i, (name, e) in enumerate(ALL.items())}

    def _shifts(self, number: int, count: int) -> list[tuple[float, ...]]:
        draw = np.random.default_rng([self.base, 1, number])
        found = np.clip(draw.standard_normal((NOMINAL_VARIANTS, count)), -1.5, 1.5)
        return [tuple(float(round(x, 3)) for x in row) for row in found]

    def size(self, around: float, *key: int) -> float:
        """A size near the given one."""
        return round(around * float(np.random.default_rng([self.base, 2, *key]).uniform(0.85, 1.18)), 3)

    def case(
        self, family: str, experiment: str, truth: tuple[Effect, ...], expected: str, variant: int, **more
    ) -> Case:
        """The next case: noise colours take turns, every case has noise of its own."""
        self.count += 1
        shifts = self.variants[experiment][variant % NOMINAL_VARIANTS]
        colour = more.pop("colour", COLOURS[self.count % len(COLOURS)])
        return Case(family, experiment, truth, expected, shifts, colour, self.base + self.count, **more)


def all_cases(seeds: str) -> list[Case]:
    """Every case of the bench."""
    draw = _Draw(seeds)
    makers = (_clean, _singles, _pairs, _strangers, _inseparable, _excitation, _late, _damaged, _units)
    makers += (_polishing, _belt, _brush, _edge, _milling, _clock, _tilt)
    return [case for maker in makers for case in maker(draw)]


def _clean(draw: _Draw) -> list[Case]:
    found = []
    for i in range(CLEAN_SETS):
        experiment = CLEAN_EXPERIMENTS[i % len(CLEAN_EXPERIMENTS)]
        noise = (0.5, 1.0, 2.0)[(i // 5) % 3]
        found.append(draw.case("clean", experiment, (), "nothing", i // 15, noise=noise, colour=COLOURS[(i // 45) % 3]))
    return found


def _singles(draw: _Draw) -> list[Case]:
    found = []
    for n, template in enumerate(SINGLES):
        for s, around in enumerate((0.6, 1.2)):
            size = draw.size(around, 10, n, s)
            truth = (template.at(size),)
            # the middle level carries the bench's main figure: another realisation of the larger size
            for level in (*LEVELS, *(("middle",) if s else ())):
                more = {"level": LEVELS[level], "size": size}
                found.append(draw.case(f"single {level}", template.experiment, truth, "named", n + s, **more))
    return found


def _pairs(draw: _Draw) -> list[Case]:
    found = []
    for n, (one, other) in enumerate(PAIRS):
        size = draw.size(1.0, 20, n)
        truth = (one.at(size), other.at(size))
        for level in (10.0, 10.0, 5.0):
            found.append(draw.case("pair", one.experiment, truth, "pair", n, level=level, size=size))
    return found


def _strangers(draw: _Draw) -> list[Case]:
    found = []
    for n, template in enumerate(STRANGERS):
        for s, around in enumerate((0.7, 1.3)):
            truth = (template.at(draw.size(around, 30, n, s)),)
            for level in (10.0, 10.0, 5.0):
                found.append(draw.case("outside", template.experiment, truth, "unknown", n + s, level=level))
    return found


def _inseparable(draw: _Draw) -> list[Case]:
    found = []
    for n, pair in enumerate(INSEPARABLE):
        for truth, partner in (pair, pair[::-1]):
            for level in (10.0, 3.0):
                more = {"level": level, "partner": partner.at(1.0)}
                case = draw.case("inseparable", truth.experiment, (truth.at(1.0),), "ambiguous", n, **more)
                # no deviation of nominal parameters: the angle between the two is that of these very sizes
                found.append(dataclasses.replace(case, shifts=(0.0,) * len(case.shifts)))
    return found


def _excitation(draw: _Draw) -> list[Case]:
    found = []
    for i in range(4):
        experiment = ("axis", "two_joint")[i % 2]
        found.append(draw.case("constant command", experiment, (), "not_identifiable", i, still=0.0))
        found.append(draw.case("faint motion", experiment, (), "not_identifiable", i, still=1e-4))
    return found


def _late(draw: _Draw) -> list[Case]:
    found = []
    for i, size in enumerate((0.8, 1.0, 1.2)):
        kinds = ("joint_coulomb", "joint_asymmetric_coulomb")
        for kind in kinds:
            whole = single(kind).at(draw.size(size, 50, i))
            late = Effect(whole.kind, whole.target, whole.values, from_s=0.82 * ALL["axis"].duration_s)
            found.append(draw.case("test part only", "axis", (late,), "not_named", i, level=5.0))
    return found


def _damaged(draw: _Draw) -> list[Case]:
    hidden = [
        single("joint_coulomb"),
        single("joint_backlash"),
        single("payload", "two_joint"),
        single("foot_friction", "chamfer"),
        single("joint_viscous"),
        single("wheel_eccentricity", "wheel"),
        single("joint_counterbalance", "two_joint"),
        single("cutting_hole_offset", "chamfer"),
    ]
    found = []
    for n, template in enumerate(hidden):
        truth = (template.at(draw.size(1.0, 60, n)),)
        for damage in ("quantised", "gappy"):
            found.append(draw.case(damage, template.experiment, truth, "named", n, level=5.0, damage=damage))
    delays = ((ANGLE, 0.003), (TORQUE, 0.006))
    for n, kind in enumerate(("joint_coulomb", "joint_backlash", "joint_viscous")):
        for channel, delay_s in delays:
            delay = Effect("sensor_delay", channel, {"delay_s": delay_s})
            truth = (single(kind).at(draw.size(1.0, 61, n)), delay)
            found.append(draw.case("delayed", "axis", truth, "pair", n, level=10.0))
    return found


def _units(draw: _Draw) -> list[Case]:
    wrong = (("axis", "angle_1_deg"), ("axis", "torque_1_n_m"), ("two_joint", "height_mm"), ("wheel", "normal_n"))
    damage = {"angle_1_deg": "in rad", "torque_1_n_m": "in kN m", "height_mm": "in m", "normal_n": "in kN"}
    return [
        draw.case("wrong unit", experiment, (), "refused", n, damage=f"{column} {damage[column]}")
        for n, (experiment, column) in enumerate(wrong)
    ]


def _polishing(draw: _Draw) -> list[Case]:
    return _led(draw, "polishing", POLISHING, POLISHING_PAIR, 70)


def _belt(draw: _Draw) -> list[Case]:
    return _led(draw, "belt", BELT, BELT_PAIR, 80)


def _brush(draw: _Draw) -> list[Case]:
    return _led(draw, "brush", BRUSH, BRUSH_PAIR, 90)


def _edge(draw: _Draw) -> list[Case]:
    return _led_singles(draw, "edge", POLISHING_EDGE, 100)


def _milling(draw: _Draw) -> list[Case]:
    return _led(draw, "milling", MILLING, MILLING_PAIR, 110)


def _clock(draw: _Draw) -> list[Case]:
    return _led_singles(draw, "clock", CLOCK, 120)


def _tilt(draw: _Draw) -> list[Case]:
    return _led_singles(draw, "tilt", TILT, 130)


def _led_singles(draw: _Draw, name: str, templates: tuple, key: int) -> list[Case]:
    found = []
    for n, template in enumerate(templates):
        for s, (around, levels) in enumerate(((0.6, ("middle", "weak")), (1.2, ("strong", "middle", "middle")))):
            size = draw.size(around, key, n, s)
            for level in levels:
                more = {"level": LEVELS[level], "size": size}
                truth = (template.at(size),)
                found.append(draw.case(f"{name} {level}", template.experiment, truth, "named", n + s, **more))
    return found


def _led(draw: _Draw, name: str, templates: tuple, pair: tuple, key: int) -> list[Case]:
    """A process whose tool is led over a face: single effects, a pair of them, and clean sets."""
    found = _led_singles(draw, name, templates, key)
    size = draw.size(1.0, key + 1, 0)
    truth = tuple(template.at(size) for template in pair)
    one = pair[0].experiment
    found += [draw.case("pair", one, truth, "pair", 0, level=level, size=size) for level in (10.0, 10.0, 5.0)]
    experiments = sorted({template.experiment for template in templates})
    for i in range(LED_CLEAN_SETS):
        experiment = experiments[i % len(experiments)]
        found.append(draw.case("clean", experiment, (), "nothing", i // 2, noise=(0.5, 1.0, 2.0)[(i // 2) % 3]))
    return found


def fast_cases(seeds: str) -> list[Case]:
    """A dozen cases that touch every kind of answer."""
    cases = all_cases(seeds)

    def first(family: str, experiment: str, kind: str = "", skip: int = 0) -> Case:
        fitting = [c for c in cases if c.family == family and c.experiment == experiment]
        return [c for c in fitting if not kind or c.truth[0].kind == kind][skip]

    return [
        first("clean", "axis"),
        first("clean", "two_joint"),
        first("clean", "chamfer"),
        first("single strong", "axis", "joint_coulomb"),
        first("single middle", "axis", "joint_backlash"),
        first("single middle", "two_joint", "payload"),
        first("single strong", "chamfer", "foot_friction"),
        first("single strong", "wheel", "wheel_eccentricity"),
        first("polishing strong", "polish", "wheel_eccentricity"),
        first("pair", "axis", "joint_coulomb"),
        first("outside", "axis", "outside_place_dependent_friction"),
        first("inseparable", "teeth_three"),
        first("constant command", "axis"),
        first("wrong unit", "axis"),
    ]
