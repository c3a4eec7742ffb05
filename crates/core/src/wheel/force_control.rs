//! How the normal force of a tool is held: as functions from one state to the next.

/// Law by which the tool moves along the normal relative to the commanded path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ForceControl {
    /// The arm keeps its path: no offset.
    Position,
    /// The path is shifted until the measured force is the desired one: `ẋ = (F_set - F)/c`, c in N
    /// s/m, no faster than a limit.
    ConstantForce {
        force_n: f64,
        damping_n_s_per_m: f64,
        fastest_m_per_s: f64,
        /// Stroke to either side, m; infinite where none is given.
        stroke_m: f64,
        /// Force that is missing (or too much) before anything moves, N.
        stiction_n: f64,
    },
    /// The tool rides on a spring and damper with a preload: `m ẍ + c ẋ + k x = F_preload - F`, x
    /// towards the workpiece.
    Compliant {
        mass_kg: f64,
        stiffness_n_per_m: f64,
        damping_n_s_per_m: f64,
        preload_n: f64,
        /// Stroke to either side, m.
        stroke_m: f64,
        /// Dry friction of the guide, N.
        stiction_n: f64,
    },
}

/// Where a carrier stands, towards the workpiece along the normal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Offset {
    pub offset_m: f64,
    /// Mean rate over the last step, m/s; of a mass the velocity half a step ago.
    pub rate_m_per_s: f64,
    /// Of a mass, the velocity another step before; none at rest, and where nothing has a mass.
    pub before_m_per_s: Option<f64>,
    /// Friction of the guide on the carrier over the last step, towards the workpiece, N.
    pub friction_n: f64,
}

impl Offset {
    /// A carrier at rest.
    pub fn at(offset_m: f64) -> Self {
        Self {
            offset_m,
            ..Self::default()
        }
    }

    /// Rate at this instant, m/s: of a mass extrapolated from its half steps.
    pub fn rate_now_m_per_s(&self) -> f64 {
        match self.before_m_per_s {
            Some(before) => 1.5 * self.rate_m_per_s - 0.5 * before,
            None => self.rate_m_per_s,
        }
    }
}

impl ForceControl {
    /// Stroke of the carrier to either side, m; none without a carrier.
    pub fn stroke_m(&self) -> Option<f64> {
        match *self {
            Self::Position => None,
            Self::ConstantForce { stroke_m, .. } | Self::Compliant { stroke_m, .. } => {
                Some(stroke_m)
            }
        }
    }

    /// The force that is held, or the preload, N; none where the path alone presses.
    pub fn force_n(&self) -> Option<f64> {
        match *self {
            Self::Position => None,
            Self::ConstantForce { force_n, .. } => Some(force_n),
            Self::Compliant { preload_n, .. } => Some(preload_n),
        }
    }

    /// The same law with its held force off by `offset_n`, and dry friction in its guide, both in
    /// N.
    pub fn disturbed(mut self, offset_n: f64, friction_n: f64) -> Self {
        match &mut self {
            Self::Position => {}
            Self::ConstantForce {
                force_n,
                stiction_n,
                ..
            } => (*force_n, *stiction_n) = (*force_n + offset_n, friction_n),
            Self::Compliant {
                preload_n,
                stiction_n,
                ..
            } => (*preload_n, *stiction_n) = (*preload_n + offset_n, friction_n),
        }
        self
    }

    /// Time in which the carrier follows a contact of this stiffness (N/m), s: `c/k` for the
    /// constant force, `1/ω` of the mass between both springs; none where nothing follows. Steps
    /// beyond twice of it would swing up.
    pub fn quickest_s(&self, contact_n_per_m: f64) -> Option<f64> {
        match *self {
            Self::Position => None,
            Self::ConstantForce {
                damping_n_s_per_m, ..
            } => Some(damping_n_s_per_m / contact_n_per_m),
            Self::Compliant {
                mass_kg,
                stiffness_n_per_m,
                ..
            } => Some((mass_kg / (stiffness_n_per_m + contact_n_per_m)).sqrt()),
        }
    }

    /// Whether the carrier stands at an end of its stroke.
    pub fn is_at_stop(&self, state: &Offset) -> bool {
        match *self {
            Self::Position => false,
            Self::ConstantForce { stroke_m, .. } | Self::Compliant { stroke_m, .. } => {
                state.offset_m.abs() >= stroke_m
            }
        }
    }

    /// Where the carrier comes to rest off the workpiece, m: at the end of its stroke, or where its
    /// spring balances the preload.
    pub fn lifted_m(&self) -> f64 {
        match *self {
            Self::Position => 0.0,
            Self::ConstantForce {
                force_n, stroke_m, ..
            } => stroke_m.copysign(force_n),
            Self::Compliant {
                stiffness_n_per_m,
                preload_n,
                stroke_m,
                ..
            } if stiffness_n_per_m > 0.0 => {
                (preload_n / stiffness_n_per_m).clamp(-stroke_m, stroke_m)
            }
            // A preload alone drives it to its stop.
            Self::Compliant {
                preload_n,
                stroke_m,
                ..
            } => stroke_m.copysign(preload_n),
        }
    }

    /// Force that the carrier hands to the tool while its wheel is pressed with `contact_n`, N,
    /// both along the normal: a massless one all of it, one with a mass what its spring, damper,
    /// guide and preload give; at its stops all.
    pub fn carried_n(&self, state: &Offset, contact_n: f64) -> f64 {
        match *self {
            Self::Compliant {
                stiffness_n_per_m,
                damping_n_s_per_m,
                preload_n,
                ..
            } if !self.is_at_stop(state) => {
                preload_n
                    - stiffness_n_per_m * state.offset_m
                    - damping_n_s_per_m * state.rate_now_m_per_s()
                    + state.friction_n
            }
            _ => contact_n,
        }
    }

    /// The state a step later. `contact_n` is the normal force that presses on the workpiece now. A
    /// carrier without mass follows it, held over the step. One with a mass goes from half step to
    /// half step as the arm does (leapfrog: no numerical damping, stable up to `ω dt = 2` on the
    /// contact's spring), its own spring as the mean of neighbours (trapezoidal rule), at any
    /// stiffness.
    pub fn step(&self, state: &Offset, contact_n: f64, dt: f64) -> Offset {
        match *self {
            Self::Position => Offset::default(),
            Self::ConstantForce {
                force_n,
                damping_n_s_per_m,
                fastest_m_per_s,
                stroke_m,
                stiction_n,
            } => {
                let missing_n = force_n - contact_n;
                let friction_n = -missing_n.clamp(-stiction_n, stiction_n);
                let rate = (missing_n + friction_n) / damping_n_s_per_m;
                let rate_m_per_s = rate.clamp(-fastest_m_per_s, fastest_m_per_s);
                let offset_m = state.offset_m + rate_m_per_s * dt;
                if offset_m.abs() > stroke_m {
                    return Offset::at(stroke_m.copysign(offset_m));
                }
                Offset {
                    offset_m,
                    rate_m_per_s,
                    friction_n,
                    ..Offset::default()
                }
            }
            Self::Compliant {
                mass_kg,
                stiffness_n_per_m: k,
                damping_n_s_per_m: c,
                preload_n,
                stroke_m,
                stiction_n,
            } => {
                let (x, before) = (state.offset_m, state.rate_m_per_s);
                // (u - u⁻) m/h + c (u + u⁻)/2 + k (x + (u - u⁻) dt/4) = F, h half a step from rest
                let from_rest = state.before_m_per_s.is_none();
                let h = if from_rest { 0.5 * dt } else { dt };
                let inertia = mass_kg / h + 0.5 * c + 0.25 * k * dt;
                let kept = mass_kg / h - 0.5 * c + 0.25 * k * dt;
                let mut rate = (preload_n - contact_n - k * x + kept * before) / inertia;
                let mut friction_n = 0.0;
                if stiction_n > 0.0 {
                    // as much as brings the carrier to rest, where it can
                    friction_n = (-inertia * rate).clamp(-stiction_n, stiction_n);
                    rate += friction_n / inertia;
                }
                let offset_m = x + rate * dt;
                if offset_m.abs() > stroke_m {
                    // at its stop, which takes the momentum
                    return Offset::at(stroke_m.copysign(offset_m));
                }
                Offset {
                    offset_m,
                    rate_m_per_s: rate,
                    // Half a step before rest it moved as fast the other way.
                    before_m_per_s: Some(if from_rest { -rate } else { before }),
                    friction_n,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
