//! The text form of a [`RobotReport`].

use std::fmt::{self, Display, Formatter};

use crate::model::JointKind;
use crate::report::{DirectionalReport, JointReport, RobotReport};

impl RobotReport {
    /// The report as plain text, several lines, in workshop units (degrees, mm, N/µm).
    #[must_use]
    pub fn to_text(&self) -> String {
        self.to_string()
    }
}

impl Display for RobotReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  URDF    {}", self.urdf)?;
        match &self.config {
            Some(path) => writeln!(f, "  config  {path}")?,
            None => writeln!(
                f,
                "  config  none: no transmission stiffness, the tool is the flange"
            )?,
        }
        writeln!(
            f,
            "  chain   {} joints from \"{}\" to flange \"{}\", {:.6} kg moving",
            self.joints.len(),
            self.base.name,
            self.tip,
            self.moving_mass_kg
        )?;
        for note in &self.notes {
            writeln!(f, "  note    {note}")?;
        }
        self.joint_table(f)?;
        self.transmission_table(f)?;
        self.link_table(f)?;
        self.at_posture(f)
    }
}

impl RobotReport {
    fn joint_table(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let width = self.name_width();
        writeln!(f, "\nJoints")?;
        writeln!(
            f,
            "  {:width$}  {:9}  {:>26}  {:>25}  {:>12}  {:>12}",
            "name", "kind", "axis", "limits", "speed", "effort"
        )?;
        for joint in &self.joints {
            let [x, y, z] = joint.axis;
            let (unit, scale) = workshop(joint.kind);
            let bound = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{:.2}", v * scale));
            let range = format!("{} .. {} {unit}", bound(joint.lower), bound(joint.upper));
            let speed = format!("{} {unit}/s", bound(joint.velocity));
            let effort = joint
                .effort
                .map_or("-".to_owned(), |v| format!("{v} {}", joint.effort_unit));
            let kind = match joint.kind {
                JointKind::Revolute => "revolute",
                JointKind::Prismatic => "prismatic",
            };
            writeln!(
                f,
                "  {:width$}  {kind:9}  {x:8.4} {y:8.4} {z:8.4}  {range:>25}  {speed:>12}  {effort:>12}",
                joint.name
            )?;
        }
        Ok(())
    }

    fn transmission_table(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let width = self.name_width();
        writeln!(f, "\nTransmissions")?;
        for joint in &self.joints {
            let per = match joint.kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            let effort = joint.effort_unit;
            let inertia = match joint.kind {
                JointKind::Revolute => "kg m^2",
                JointKind::Prismatic => "kg",
            };
            let stiffness = match joint.stiffness {
                Some(k) => format!("{k:.4e} {effort}/{per}"),
                None => "stiffness not given".to_owned(),
            };
            writeln!(
                f,
                "  {:width$}  {stiffness}, damping {} {effort} s/{per}, dry friction {} {effort}, rotor {} {inertia}",
                joint.name, joint.damping, joint.dry_friction, joint.rotor_inertia
            )?;
            if let Some(servo) = &joint.servo {
                writeln!(
                    f,
                    "  {:width$}    servo: position gain {} 1/s, velocity gain {} {effort} s/{per}, limit {} {effort}; static stiffness {:.4e} {effort}/{per} in series",
                    "",
                    servo.position_gain_per_s,
                    servo.velocity_gain,
                    servo.torque_limit,
                    servo.static_stiffness
                )?;
            }
        }
        let named = |pick: fn(&JointReport) -> &String| {
            let joints = self.joints.iter();
            joints.map(move |joint| (joint.name.clone(), pick(joint).clone()))
        };
        write_sources(f, "stiffness", named(|j| &j.sources.stiffness))?;
        write_sources(f, "spring's range", named(|j| &j.sources.linear_to))?;
        write_sources(f, "damping", named(|j| &j.sources.damping))?;
        write_sources(f, "dry friction", named(|j| &j.sources.dry_friction))?;
        write_sources(f, "rotor", named(|j| &j.sources.rotor_inertia))?;
        write_sources(f, "servo", named(|j| &j.sources.servo))
    }

    fn link_table(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let names = self.links.iter().map(|link| link.name.len());
        let width = names.max().unwrap_or(4).max(4);
        writeln!(
            f,
            "\nLinks (centre of mass in link axes, principal inertia about it)"
        )?;
        for link in &self.links {
            let [x, y, z] = link.com_m.map(|v| v * 1e3);
            let [a, b, c] = link.principal_inertia_kg_m2;
            writeln!(
                f,
                "  {:width$}  {:10.4} kg  at {x:8.1} {y:8.1} {z:8.1} mm  {a:.4e} {b:.4e} {c:.4e} kg m^2",
                link.name, link.mass_kg
            )?;
        }
        Ok(())
    }

    fn at_posture(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let values: Vec<_> = (self.joints.iter().zip(&self.posture))
            .map(|(joint, q)| {
                let (unit, scale) = workshop(joint.kind);
                format!("{:.2} {unit}", q * scale)
            })
            .collect();
        writeln!(f, "\nAt posture ({})", values.join(", "))?;
        if !self.outside_limits.is_empty() {
            writeln!(
                f,
                "  outside the limits of {}",
                self.outside_limits.join(", ")
            )?;
        }
        for (name, pose) in [
            ("flange", &self.flange),
            ("tool", &self.tool),
            ("foot", &self.foot),
        ] {
            let [x, y, z] = pose.position_m.map(|v| v * 1e3);
            let [i, j, k] = pose.rotation.map(|row| row[2]);
            writeln!(
                f,
                "  {name:6} at {x:10.3} {y:10.3} {z:10.3} mm, z axis ({i:.5}, {j:.5}, {k:.5})"
            )?;
        }
        if let Some(modes) = &self.modes {
            writeln!(f, "  modes (no gravity)")?;
            for (i, mode) in modes.iter().enumerate() {
                let (hz, zeta) = (mode.frequency_hz, 100.0 * mode.damping_ratio);
                writeln!(f, "    {:2}  {hz:10.4} Hz  damping {zeta:.3} %", i + 1)?;
            }
        }
        if let Some(stiffness) = &self.stiffness {
            writeln!(
                f,
                "  stiffness at the tool, N/um (X along the tool, Y horizontal, Z = X x Y)"
            )?;
            directional(f, "rotation free", &stiffness.free)?;
            match &stiffness.clamped {
                Some(clamped) => directional(f, "rotation clamped", clamped)?,
                None => writeln!(
                    f,
                    "    rotation clamped   not defined here: the arm cannot be loaded in all six directions"
                )?,
            }
            if let Some([y, z]) = stiffness.axial_lateral_coupling {
                writeln!(
                    f,
                    "    a tool held laterally carries Y {y:.4}, Z {z:.4} N per N along X (norm {:.4})",
                    y.hypot(z)
                )?;
            }
        }
        self.estimate_table(f)?;
        for missing in &self.missing {
            writeln!(f, "  {missing}")?;
        }
        Ok(())
    }

    fn estimate_table(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some(first) = self.estimates.first() else {
            return Ok(());
        };
        let width = self.name_width();
        writeln!(
            f,
            "  if an estimated stiffness is {0} times lower or higher: first mode, softest stiffness at \
             the tool",
            first.factor
        )?;
        for estimate in &self.estimates {
            let ([low_hz, high_hz], [low, high]) =
                (estimate.first_mode_hz, estimate.softest_n_per_m);
            writeln!(
                f,
                "    {:width$}  {low_hz:8.3} to {high_hz:8.3} Hz, {} to {} N/um",
                estimate.joint,
                micro(low),
                micro(high)
            )?;
        }
        Ok(())
    }

    fn name_width(&self) -> usize {
        let names = self.joints.iter().map(|joint| joint.name.len());
        names.max().unwrap_or(4).max(4)
    }
}

/// Unit for people and factor from SI.
fn workshop(kind: JointKind) -> (&'static str, f64) {
    match kind {
        JointKind::Revolute => ("deg", 180.0 / std::f64::consts::PI),
        JointKind::Prismatic => ("mm", 1e3),
    }
}

/// Each source once, with the joints that it stands for.
fn write_sources(
    f: &mut Formatter<'_>,
    what: &str,
    sources: impl Iterator<Item = (String, String)>,
) -> fmt::Result {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for (joint, text) in sources.filter(|(_, text)| !text.is_empty()) {
        match groups.iter_mut().find(|(known, _)| *known == text) {
            Some((_, joints)) => joints.push(joint),
            None => groups.push((text, vec![joint])),
        }
    }
    for (text, joints) in groups {
        writeln!(f, "  {what} of {}: {text}", joints.join(", "))?;
    }
    Ok(())
}

/// A stiffness in N/µm; beyond 1e6 N/µm nothing but rounding gives way.
fn micro(k_n_per_m: f64) -> String {
    if k_n_per_m.is_finite() && k_n_per_m < 1e12 {
        format!("{:.5}", k_n_per_m * 1e-6)
    } else {
        "rigid".to_owned()
    }
}

fn directional(f: &mut Formatter<'_>, name: &str, report: &DirectionalReport) -> fmt::Result {
    writeln!(
        f,
        "    {name:17}  X {}  Y {}  Z {}  lateral {} to {}, stiffest {:.3} deg from Y to Z",
        micro(report.x_n_per_m),
        micro(report.y_n_per_m),
        micro(report.z_n_per_m),
        micro(report.lateral.k_min_n_per_m),
        micro(report.lateral.k_max_n_per_m),
        report.lateral.k_max_angle_rad.to_degrees()
    )
}
