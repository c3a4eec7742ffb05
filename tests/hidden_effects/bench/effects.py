"""Effects as a scenario file names them: kinds, parameters in SI, values at which they change nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

# Size parameters with their neutral values, then parameters that only shape the effect. Rotary joints.
KINDS: dict[str, tuple[dict[str, float], tuple[str, ...]]] = {
    "joint_stiffness": ({"factor": 1.0}, ()),
    "joint_damping": ({"factor": 1.0}, ()),
    "joint_viscous": ({"viscous_n_m_s_per_rad": 0.0}, ()),
    "joint_coulomb": ({"friction_n_m": 0.0}, ()),
    "joint_load_friction": ({"share": 0.0}, ()),
    "joint_asymmetric_viscous": ({"viscous_positive_n_m_s_per_rad": 0.0, "viscous_negative_n_m_s_per_rad": 0.0}, ()),
    "joint_asymmetric_coulomb": ({"friction_positive_n_m": 0.0, "friction_negative_n_m": 0.0}, ()),
    "joint_stribeck": ({"excess_n_m": 0.0}, ("speed_rad_per_s",)),
    "joint_backlash": ({"gap_rad": 0.0}, ()),
    "joint_hysteresis": ({"amplitude_n_m": 0.0}, ("yield_windup_rad",)),
    "joint_cubic_stiffness": ({"cubic_n_m_per_rad3": 0.0}, ()),
    "joint_ripple": ({"cosine_rad": 0.0, "sine_rad": 0.0}, ("cycles",)),
    "joint_counterbalance": ({"cosine_n_m": 0.0, "sine_n_m": 0.0}, ()),
    "joint_offset": ({"force_n_m": 0.0}, ()),
    "joint_zero": ({"offset_rad": 0.0}, ()),
    "link_mass": ({"factor": 1.0}, ()),
    "link_center": ({"x_m": 0.0, "y_m": 0.0, "z_m": 0.0}, ()),
    "link_length": ({"x_m": 0.0, "y_m": 0.0, "z_m": 0.0}, ()),
    "joint_rotor": ({"inertia_kg_m2": 0.0}, ()),
    "payload": ({"mass_kg": 0.0}, ("center_x_m", "center_y_m", "center_z_m")),
    "base_compliance": ({"compliance_rad_per_n_m": 0.0}, ()),
    "base_tilt": ({"angle_rad": 0.0}, ()),
    "cutting_coefficient": ({"factor": 1.0}, ()),
    "cutting_edge_force": ({"axial_n_per_m": 0.0, "radial_n_per_m": 0.0, "tangential_n_per_m": 0.0}, ()),
    "cutting_runout": ({"cosine_m": 0.0, "sine_m": 0.0}, ()),
    "cutting_hole_offset": ({"y_m": 0.0, "z_m": 0.0}, ()),
    "cutting_worn_tooth": ({"recess_m": 0.0}, ()),
    "cutting_wear": ({"growth_per_m": 0.0}, ()),
    "cutting_depth_offset": ({"depth_m": 0.0}, ()),
    "spindle_speed": ({"factor": 1.0}, ()),
    "milling_process_damping": ({"per_slope_n_per_m": 0.0}, ()),
    "tool_mode": ({"compliance_m_per_n": 0.0}, ("frequency_hz", "damping_ratio")),
    "foot_friction": ({"factor": 1.0}, ()),
    "foot_friction_falling": ({"drop": 0.0}, ("speed_m_per_s",)),
    "foot_pressure_loss": ({"rate_per_s": 0.0}, ()),
    "foot_seal_stiction": ({"force_n": 0.0}, ()),
    "wheel_stiffness": ({"factor": 1.0}, ()),
    "wheel_eccentricity": ({"cosine_m": 0.0, "sine_m": 0.0}, ()),
    "wheel_friction": ({"factor": 1.0}, ()),
    "wheel_removal": ({"factor": 1.0}, ()),
    "wheel_edge_grains": ({"share": 0.0}, ()),
    "wheel_force_offset": ({"force_n": 0.0}, ()),
    "wheel_force_stiction": ({"force_n": 0.0}, ()),
    "clock_delay": ({"delay_s": 0.0}, ()),
    "clock_rate": ({"factor": 1.0}, ()),
    "sensor_delay": ({"delay_s": 0.0}, ()),
    "sensor_gain": ({"factor": 1.0}, ()),
    "sensor_offset": ({"offset": 0.0}, ()),
    "sensor_drift": ({"amplitude": 0.0}, ("time_constant_s",)),
    "sensor_low_pass": ({"time_constant_s": 0.0}, ()),
}

# What the library does not know, with parameters of the generator's own.
OUTSIDE: dict[str, tuple[str, ...]] = {
    # dead time of a force sensor that grows with the load: t - delay |value| / scale
    "outside_load_dependent_delay": ("delay_s", "scale"),
    # drag that grows with the square of the speed
    "outside_quadratic_drag": ("drag_n_m_s2_per_rad2",),
    # a mass on a spring at the flange, along its x axis
    "outside_absorber": ("mass_kg", "frequency_hz", "damping_ratio"),
    # dry friction between none and twice the level, by the joint's place: level (1 + sin(cycles q))
    "outside_place_dependent_friction": ("level_n_m", "cycles"),
}


@dataclass(frozen=True)
class Effect:
    """One effect. `target` is None, a joint (from 1), an axis ("x") or a channel's name."""

    kind: str
    target: int | str | None = None
    values: dict[str, float] = field(default_factory=dict)
    from_s: float = -math.inf
    """Before this time it does not act (joint friction only)."""

    def __post_init__(self) -> None:
        known = OUTSIDE[self.kind] if self.kind in OUTSIDE else (*KINDS[self.kind][0], *KINDS[self.kind][1])
        if set(self.values) != set(known):
            raise ValueError(f"{self.kind} takes {sorted(known)}, not {sorted(self.values)}")

    @property
    def name(self) -> str:
        """Kind and target, as in a table."""
        return self.kind if self.target is None else f"{self.kind} {self.target}"

    @property
    def sizes(self) -> dict[str, float]:
        """Parameters that measure the effect, less their neutral values."""
        neutral = KINDS[self.kind][0]
        return {key: self.values[key] - neutral[key] for key in neutral}

    def neutral(self) -> Effect:
        """The effect at the size at which it changes nothing; only for kinds of the library."""
        return Effect(self.kind, self.target, self.values | KINDS[self.kind][0])

    def as_dict(self) -> dict:
        """For label files and as a key of the cache."""
        found = {"kind": self.kind, "target": self.target, "parameters": self.values}
        return found if self.from_s == -math.inf else found | {"from_s": self.from_s}
