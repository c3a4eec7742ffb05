"""Laws that the library of effects does not have, made at random; and those of a joint in inverse dynamics."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from bench.effects import KINDS, Effect
from bench.joint_law import JointLaw


@dataclass(frozen=True)
class Foreign:
    """What no effect of the library is. `size` scales it; `form` says which, `numbers` shape it.

    Torque on the link of joint `target`, over its place q (about `place`, within `travel`), its velocity v (within
    `speed`), the time t (of `length`) and another joint's velocity u; or, of a sensor, what it adds to a channel of
    the spread `travel` about `place`.
    """

    form: str
    target: int | str
    size: float
    numbers: tuple[float, ...]
    place: float
    travel: float
    speed: float
    length: float
    other: int = 0

    kind = "outside"

    @property
    def name(self) -> str:
        """As in a table."""
        return f"outside_{self.form} {self.target}"

    @property
    def is_sensor(self) -> bool:
        """Whether it acts on a channel."""
        return isinstance(self.target, str)

    def at(self, size: float) -> Foreign:
        """The same law, larger or smaller."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return Foreign(**(fields | {"size": size}))

    def torque(self, t, q, v, u):
        """On the link."""
        a, b, c, d = self.numbers
        x, y = (q - self.place) / self.travel, v / self.speed
        smooth = np.tanh(y / 0.03)
        found = {
            # drag of another power than the first
            "powered_drag": lambda: -np.sign(y) * np.abs(y) ** (1.7 + 1.3 * a),
            # friction that goes with the place, periodically or about one spot
            "place_friction": lambda: -smooth * (1.0 + np.sin((4.0 + 10.0 * a) * x + 6.3 * b)),
            "hard_spot": lambda: -smooth * np.exp(-(((x - 1.2 * (a - 0.5)) / (0.1 + 0.2 * b)) ** 2)),
            # a force that goes with the place
            "cogging": lambda: np.sin((6.0 + 12.0 * a) * x + 6.3 * b),
            # viscous friction of a gear that warms up
            "warming": lambda: -y * np.exp(-t / self.length * (2.0 + 3.0 * a)),
            # a wrist whose motors are coupled
            "coupling": lambda: -u / self.speed,
            # a product of two waves, one over the place, one over the velocity
            "surface": lambda: np.sin((1.0 + 3.0 * a) * x + 6.3 * b) * np.sin((1.0 + 3.0 * c) * y + 6.3 * d),
        }[self.form]()
        return self.size * found

    def sensed(self, values: np.ndarray) -> np.ndarray:
        """What it adds to the values of a channel."""
        x = (values - self.place) / self.travel
        a = self.numbers[0]
        found = {
            "bent_gain": lambda: x * np.abs(x) ** (0.5 + a),
            "saturating": lambda: -np.maximum(np.abs(x) - 0.6 - a, 0.0) * np.sign(x),
        }
        return self.size * self.travel * found[self.form]()


JOINT_FORMS = ("powered_drag", "place_friction", "hard_spot", "cogging", "warming", "coupling", "surface")
SENSOR_FORMS = ("bent_gain", "saturating")
IN_INVERSE = (
    "joint_viscous",
    "joint_coulomb",
    "joint_load_friction",
    "joint_asymmetric_viscous",
    "joint_asymmetric_coulomb",
    "joint_stribeck",
    "joint_counterbalance",
    "joint_offset",
)


class ForeignLaw(JointLaw):
    """A joint's law with what is outside the library; `now` is the time and the other joint's velocity."""

    foreign: Foreign | None = None
    now: tuple[float, float] = (0.0, 0.0)

    def link(self, q: float, rate: float) -> float:
        """Torque on the link beside transmission and dry friction."""
        found = super().link(q, rate)
        return found if self.foreign is None else found + float(self.foreign.torque(self.now[0], q, rate, self.now[1]))


def against(effects: list, needed: np.ndarray, t, q, v, velocities) -> np.ndarray:
    """What the drive of a joint gives beyond `needed`, with these effects on its link; friction slides at all times."""
    more, share = np.zeros_like(needed), 0.0
    sign = np.sign(v)
    for effect in effects:
        if isinstance(effect, Foreign):
            more -= effect.torque(t, q, v, velocities[:, effect.other])
            continue
        x = effect.values
        if effect.kind == "joint_viscous":
            more += x["viscous_n_m_s_per_rad"] * v
        elif effect.kind == "joint_asymmetric_viscous":
            positive, negative = x["viscous_positive_n_m_s_per_rad"], x["viscous_negative_n_m_s_per_rad"]
            more += np.where(v > 0.0, positive, negative) * v
        elif effect.kind == "joint_coulomb":
            more += x["friction_n_m"] * sign
        elif effect.kind == "joint_asymmetric_coulomb":
            more += np.where(v > 0.0, x["friction_positive_n_m"], x["friction_negative_n_m"]) * sign
        elif effect.kind == "joint_stribeck":
            more += x["excess_n_m"] * np.exp(-((v / x["speed_rad_per_s"]) ** 2)) * sign
        elif effect.kind == "joint_counterbalance":
            more -= x["cosine_n_m"] * np.cos(q) + x["sine_n_m"] * np.sin(q)
        elif effect.kind == "joint_offset":
            more -= x["force_n_m"]
        elif effect.kind == "joint_load_friction":
            share = x["share"]
        else:
            raise ValueError(f"{effect.kind} plays no part in inverse dynamics")
    if share:
        # what passes the transmission, T, is what is needed and the share of itself against the motion
        rest = needed + more
        more = rest / (1.0 - share * sign * np.sign(rest)) - needed
    return more


def sized(kind: str, target: int | str | None, sizes: list[float], shapes: tuple[float, ...] = ()) -> Effect:
    """An effect whose sizes, counted from what changes nothing, are these."""
    neutral, names = KINDS[kind]
    values = {key: at + size for (key, at), size in zip(neutral.items(), sizes, strict=True)}
    return Effect(kind, target, values | dict(zip(names, shapes, strict=True)))


def is_at_work(effect) -> bool:
    """Whether it changes anything."""
    return isinstance(effect, Foreign) or math.hypot(*effect.sizes.values()) > 0.0
