"""What is hidden: every kind of the library on an experiment that shows it, at a size of 1; pairs; strangers."""

from __future__ import annotations

from dataclasses import dataclass, field

from .effects import KINDS, OUTSIDE, Effect

ANGLE, TORQUE = "joint1.angle", "joint1.transmission_torque"


@dataclass(frozen=True)
class Template:
    """An effect at size 1: `change` is what the size scales, beyond the neutral values."""

    experiment: str
    kind: str
    target: int | str | None
    change: dict[str, float]
    shape: dict[str, float] = field(default_factory=dict)

    def at(self, size: float) -> Effect:
        """The effect at another size. Factors above 1 grow from it, factors below 1 shrink from it."""
        if self.kind in OUTSIDE:
            scaled = {key: value * size for key, value in self.change.items()}
            return Effect(self.kind, self.target, scaled | self.shape)
        neutral = KINDS[self.kind][0]
        values = {}
        for key, at_neutral in neutral.items():
            if key == "factor":
                values[key] = self.change[key] ** size
            else:
                values[key] = at_neutral + size * self.change.get(key, 0.0)
        return Effect(self.kind, self.target, values | self.shape)


def _axis(
    kind: str, change: dict[str, float], shape: dict[str, float] | None = None, target: int | str = 1
) -> Template:
    return Template("axis", kind, target, change, shape or {})


SINGLES = (
    _axis("joint_stiffness", {"factor": 0.75}),
    _axis("joint_damping", {"factor": 3.0}),
    _axis("joint_viscous", {"viscous_n_m_s_per_rad": 8.0}),
    _axis("joint_coulomb", {"friction_n_m": 8.0}),
    _axis("joint_asymmetric_viscous", {"viscous_positive_n_m_s_per_rad": 12.0, "viscous_negative_n_m_s_per_rad": 4.0}),
    _axis("joint_asymmetric_coulomb", {"friction_positive_n_m": 12.0, "friction_negative_n_m": 4.0}),
    _axis("joint_stribeck", {"excess_n_m": 12.0}, {"speed_rad_per_s": 0.08}),
    _axis("joint_backlash", {"gap_rad": 6e-4}),
    _axis("joint_hysteresis", {"amplitude_n_m": 15.0}, {"yield_windup_rad": 3e-4}),
    _axis("joint_cubic_stiffness", {"cubic_n_m_per_rad3": 2e8}),
    _axis("joint_ripple", {"cosine_rad": 1.2e-4, "sine_rad": 0.9e-4}, {"cycles": 50.0}),
    _axis("joint_ripple", {"cosine_rad": 4e-4, "sine_rad": -3e-4}, {"cycles": 10.0}),
    _axis("joint_counterbalance", {"cosine_n_m": 20.0, "sine_n_m": 40.0}),
    _axis("joint_offset", {"force_n_m": 15.0}),
    _axis("sensor_delay", {"delay_s": 0.008}, target=TORQUE),
    _axis("sensor_delay", {"delay_s": 0.004}, target=ANGLE),
    _axis("sensor_gain", {"factor": 1.15}, target=TORQUE),
    _axis("sensor_offset", {"offset": 15.0}, target=TORQUE),
    _axis("sensor_drift", {"amplitude": 25.0}, {"time_constant_s": 2.0}, target=TORQUE),
    _axis("sensor_low_pass", {"time_constant_s": 0.010}, target=TORQUE),
    Template("two_joint", "joint_counterbalance", 2, {"cosine_n_m": 8.0, "sine_n_m": 5.0}),
    Template(
        "two_joint", "payload", None, {"mass_kg": 1.5}, {"center_x_m": 0.04, "center_y_m": 0.0, "center_z_m": 0.10}
    ),
    Template("two_joint", "base_compliance", "y", {"compliance_rad_per_n_m": 2e-6}),
    Template("two_joint", "joint_coulomb", 2, {"friction_n_m": 3.0}),
    Template("two_joint", "joint_viscous", 1, {"viscous_n_m_s_per_rad": 10.0}),
    Template("two_joint", "joint_backlash", 2, {"gap_rad": 1.5e-3}),
    Template("two_joint", "joint_stiffness", 2, {"factor": 0.7}),
    Template("chamfer", "cutting_coefficient", None, {"factor": 1.25}),
    Template(
        "chamfer",
        "cutting_edge_force",
        None,
        {"axial_n_per_m": 8e3, "radial_n_per_m": 4e3, "tangential_n_per_m": 8e3},
    ),
    Template("chamfer", "cutting_hole_offset", None, {"y_m": 6e-5, "z_m": 4e-5}),
    Template("chamfer", "cutting_wear", None, {"growth_per_m": 0.12}),
    Template("chamfer", "cutting_depth_offset", None, {"depth_m": 6e-5}),
    Template("chamfer", "spindle_speed", None, {"factor": 1.02}),
    Template("chamfer", "foot_friction", None, {"factor": 0.75}),
    Template("chamfer", "foot_friction_falling", None, {"drop": 0.35}, {"speed_m_per_s": 0.001}),
    Template("chamfer", "foot_pressure_loss", None, {"rate_per_s": 0.04}),
    Template("chamfer", "foot_seal_stiction", None, {"force_n": 40.0}),
    Template("teeth", "cutting_runout", None, {"cosine_m": 3e-6, "sine_m": 2e-6}),
    Template("teeth", "cutting_worn_tooth", None, {"recess_m": 5e-6}),
    Template("wheel", "wheel_stiffness", None, {"factor": 1.35}),
    Template("wheel", "wheel_eccentricity", None, {"cosine_m": 2e-5, "sine_m": 1e-5}),
    Template("two_joint", "joint_load_friction", 2, {"share": 0.08}),
)


# Another process, in a part of the bench of its own.
POLISHING = (
    Template("polish", "wheel_stiffness", None, {"factor": 1.15}),
    Template("polish", "wheel_eccentricity", None, {"cosine_m": 2e-5, "sine_m": 1.2e-5}),
    Template("polish", "wheel_friction", None, {"factor": 1.2}),
    Template("polish", "wheel_removal", None, {"factor": 1.15}),
    Template("polish_force", "wheel_force_offset", None, {"force_n": 0.6}),
    Template("polish_force", "wheel_force_stiction", None, {"force_n": 0.15}),
)
# the same line nearer to an edge, which the wheel runs over inward
POLISHING_EDGE = (Template("polish_edge", "wheel_edge_grains", None, {"share": 0.7}),)
# friction and removal are also what a sensor's gain would be
POLISHING_PAIR = (POLISHING[0], POLISHING[1])

# Friction of a belt, too, is what a gain of the friction's own sensor would be. The eccentricity is seen once a turn of the contact wheel.
BELT = (
    Template("belt", "wheel_stiffness", None, {"factor": 1.15}),
    Template("belt", "wheel_eccentricity", None, {"cosine_m": 1e-5, "sine_m": 6e-6}),
    Template("belt", "wheel_friction", None, {"factor": 1.2}),
    Template("belt", "wheel_removal", None, {"factor": 1.15}),
    Template("belt_force", "wheel_force_offset", None, {"force_n": 0.8}),
    Template("belt_force", "wheel_force_stiction", None, {"force_n": 0.5}),
)
BELT_PAIR = (BELT[0], BELT[1])

BRUSH = (
    Template("brush", "wheel_stiffness", None, {"factor": 1.15}),
    Template("brush", "wheel_eccentricity", None, {"cosine_m": 2e-4, "sine_m": 1.2e-4}),
    Template("brush", "wheel_friction", None, {"factor": 1.2}),
    Template("brush", "wheel_removal", None, {"factor": 1.15}),
)
BRUSH_PAIR = (BRUSH[0], BRUSH[1])


# On a machine that gives way along the feed; forces and its place are measured.
MILLING = (
    Template("mill", "milling_process_damping", None, {"per_slope_n_per_m": 6e5}),
    Template("mill", "tool_mode", None, {"compliance_m_per_n": 7e-7}, {"frequency_hz": 135.0, "damping_ratio": 0.03}),
)
MILLING_PAIR = (MILLING[0], MILLING[1])

# One delay of all that is measured.
CLOCK = (
    Template("axis", "clock_delay", None, {"delay_s": 0.004}),
    Template("two_joint", "clock_delay", None, {"delay_s": 0.004}),
)

# The base does not stand level.
TILT = (Template("two_joint", "base_tilt", "y", {"angle_rad": 0.05}),)

# The zeros of both joints are off.
ZERO = (
    Template("two_joint", "joint_zero", 1, {"offset_rad": 0.03}),
    Template("two_joint", "joint_zero", 2, {"offset_rad": -0.04}),
)


def single(kind: str, experiment: str = "axis") -> Template:
    """The first template of a kind on an experiment."""
    return next(t for t in SINGLES if t.kind == kind and t.experiment == experiment)


# Both at size 1. The first four: one hides the other, or they pull in opposite directions.
PAIRS: tuple[tuple[Template, Template], ...] = (
    (single("joint_stiffness"), _axis("joint_cubic_stiffness", {"cubic_n_m_per_rad3": 3e8})),
    (single("joint_coulomb"), _axis("joint_damping", {"factor": 3.0})),
    (
        _axis("joint_offset", {"force_n_m": 20.0}),
        _axis("sensor_drift", {"amplitude": 25.0}, {"time_constant_s": 2.0}, TORQUE),
    ),
    (
        Template(
            "two_joint", "payload", None, {"mass_kg": 1.5}, {"center_x_m": 0.0, "center_y_m": 0.0, "center_z_m": 0.1}
        ),
        Template("two_joint", "joint_counterbalance", 2, {"cosine_n_m": 10.0, "sine_n_m": 0.0}),
    ),
    (single("joint_coulomb"), _axis("joint_viscous", {"viscous_n_m_s_per_rad": 8.0})),
    (single("joint_backlash"), _axis("joint_viscous", {"viscous_n_m_s_per_rad": 10.0})),
    (single("cutting_wear", "chamfer"), Template("chamfer", "foot_friction", None, {"factor": 0.75})),
    (single("cutting_hole_offset", "chamfer"), Template("chamfer", "foot_pressure_loss", None, {"rate_per_s": 0.05})),
)

STRANGERS = (
    _axis("outside_load_dependent_delay", {"delay_s": 0.03}, {"scale": 300.0}, TORQUE),
    _axis("outside_quadratic_drag", {"drag_n_m_s2_per_rad2": 8.0}),
    Template("axis", "outside_absorber", None, {"mass_kg": 4.0}, {"frequency_hz": 2.5, "damping_ratio": 0.03}),
    _axis("outside_place_dependent_friction", {"level_n_m": 8.0}, {"cycles": 40.0}),
)

# Each with what cannot be told from it, at a size at which both leave the same trace.
INSEPARABLE: tuple[tuple[Template, Template], ...] = (
    (
        Template("teeth_three", "cutting_worn_tooth", None, {"recess_m": 4.5e-6}),
        Template("teeth_three", "cutting_runout", None, {"cosine_m": -3e-6, "sine_m": 0.0}),
    ),
    (
        Template("axis_single_tone", "joint_viscous", 1, {"viscous_n_m_s_per_rad": 15.0}),
        Template("axis_single_tone", "sensor_delay", ANGLE, {"delay_s": 0.0004}),
    ),
    (
        Template("axis_single_tone", "sensor_gain", ANGLE, {"factor": 1.02}),
        Template("axis_single_tone", "joint_stiffness", 1, {"factor": 0.6}),
    ),
    (
        Template("axis_small", "joint_offset", 1, {"force_n_m": 2.0}),
        Template("axis_small", "joint_counterbalance", 1, {"cosine_n_m": 2.0, "sine_n_m": 0.0}),
    ),
)
