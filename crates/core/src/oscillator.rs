//! One damped oscillator, stepped exactly.
//!
//! `z'' + 2ζω z' + ω² z = r`. With r held over the steps before and after an instant the motion
//! over one step h forwards and backwards is known in closed form; eliminating the velocity between
//! both leaves, with the mean velocity over a step `u = (z⁺ − z)/h`,
//!
//! `u⁺ = Q u⁻ + G (r − ω² z)`, `z⁺ = z + h u⁺`,
//!
//! the method of `gautschi1961` (`hairer2006`, XIII.1) for a damped oscillator. Free motion and
//! motion under a constant r are met exactly at any step but whole half periods; an r of frequency
//! w to (w h)²/12.

/// Coefficients of the recurrence at one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactStep {
    step_s: f64,
    square_per_s2: f64,
    /// Over the step ahead: displacement and velocity by a velocity of 1, displacement by an
    /// acceleration of 1.
    ahead: Flow,
    /// The same over the step before.
    before: Flow,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Flow {
    from_velocity_s: f64,
    velocity_from_velocity: f64,
    from_acceleration_s2: f64,
}

impl Flow {
    fn over(time_s: f64, omega_rad_s: f64, damping_ratio: f64) -> Self {
        let damped = omega_rad_s * (1.0 - damping_ratio * damping_ratio).sqrt();
        let decay = (-damping_ratio * omega_rad_s * time_s).exp();
        let (sin, cos) = (damped * time_s).sin_cos();
        let share = damping_ratio * omega_rad_s / damped;
        Self {
            from_velocity_s: decay * sin / damped,
            velocity_from_velocity: decay * (cos - share * sin),
            from_acceleration_s2: (1.0 - decay * (cos + share * sin)) / omega_rad_s.powi(2),
        }
    }
}

/// Where an oscillator stands at an instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OscillatorState {
    /// z.
    pub position: f64,
    /// z' at the same instant, foreseen from the instant before.
    pub velocity: f64,
    /// Mean velocity over the step before; none before the first step.
    mean: Option<f64>,
}

impl OscillatorState {
    /// At the start of a run.
    pub fn new(position: f64, velocity: f64) -> Self {
        Self {
            position,
            velocity,
            mean: None,
        }
    }
}

impl ExactStep {
    /// ω in rad/s, ζ below 1, a step shorter than half a period.
    pub fn new(omega_rad_s: f64, damping_ratio: f64, step_s: f64) -> Self {
        Self {
            step_s,
            square_per_s2: omega_rad_s * omega_rad_s,
            ahead: Flow::over(step_s, omega_rad_s, damping_ratio),
            before: Flow::over(-step_s, omega_rad_s, damping_ratio),
        }
    }

    /// The state a step later; `drive` is r at the instant (in z's unit per s²).
    pub fn next(&self, state: &OscillatorState, drive: f64) -> OscillatorState {
        let (h, ahead, before) = (self.step_s, &self.ahead, &self.before);
        let pull = drive - self.square_per_s2 * state.position;
        let velocity = match state.mean {
            // z⁻ = z + S₋ z' + F₋ (r − ω² z), and z⁻ = z − h u⁻.
            Some(mean) => -(h * mean + before.from_acceleration_s2 * pull) / before.from_velocity_s,
            None => state.velocity,
        };
        let shift = ahead.from_velocity_s * velocity + ahead.from_acceleration_s2 * pull;
        OscillatorState {
            position: state.position + shift,
            velocity: ahead.velocity_from_velocity * velocity + ahead.from_velocity_s * pull,
            mean: Some(shift / h),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Released under a constant force: position and velocity at every instant, up to a step of
    /// nearly half a period.
    #[test]
    fn verify_a_step_response_is_exact_at_any_step() {
        let (omega, zeta, drive) = (200.0_f64, 0.03_f64, 7.0);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let rest = drive / (omega * omega);
        for step_s in [1e-5, 1e-3, 7e-3, 0.015] {
            let exact_step = ExactStep::new(omega, zeta, step_s);
            let mut state = OscillatorState::new(3.0 * rest, 0.0);
            for i in 0..500 {
                let t = f64::from(i) * step_s;
                let decay = 2.0 * rest * (-zeta * omega * t).exp();
                let (sin, cos) = (damped * t).sin_cos();
                let exact = rest + decay * (cos + zeta * omega / damped * sin);
                let speed = -decay * omega * omega / damped * sin;
                assert!((state.position - exact).abs() < 1e-9 * rest, "{step_s} {t}");
                assert!((state.velocity - speed).abs() < 1e-9 * rest * omega);
                state = exact_step.next(&state, drive);
            }
        }
    }

    /// Under a force of a fifth of its own frequency, what the start has excited having died away:
    /// to (w h)²/12 of the answer.
    #[test]
    fn verify_a_slow_force_is_met_to_second_order() {
        let (omega, zeta) = (200.0_f64, 0.05_f64);
        let w = 0.2 * omega;
        let (a, b) = (omega * omega - w * w, 2.0 * zeta * omega * w);
        let gain = 1.0 / (a * a + b * b);
        let exact = |t: f64| gain * (a * (w * t).cos() + b * (w * t).sin());
        let step_s = std::f64::consts::TAU / omega / 40.0;
        let step = ExactStep::new(omega, zeta, step_s);
        let mut state = OscillatorState::new(exact(0.0), gain * b * w);
        let mut worst = 0.0_f64;
        for i in 0..2000 {
            let t = f64::from(i) * step_s;
            if i > 1000 {
                worst = worst.max((state.position - exact(t)).abs());
            }
            state = step.next(&state, (w * t).cos());
        }
        let bound = (w * step_s).powi(2) / 12.0 * gain.sqrt();
        assert!(worst < 1.2 * bound, "{worst} {bound}");
    }
}
