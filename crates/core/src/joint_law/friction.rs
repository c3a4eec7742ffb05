//! Friction between a link and its bearings: dry, growing with the load, viscous by direction,
//! higher at low speed, by curves over place and speed.

use std::sync::Arc;

use super::Curve;
use crate::roots::newton_within;

/// Friction of one joint, by direction (0: while the coordinate grows, 1: while it falls):
/// `F_s + c_s |v| + E exp(-(v / v_s)²)` and what curves over place and speed add, against the
/// motion; never with it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkFriction {
    /// Dry friction F_s, N m (N).
    pub dry: [f64; 2],
    /// Dry friction per torque (force) that the transmission passes on; see
    /// [`LinkFriction::under`].
    pub load_share: f64,
    /// Viscous friction c_s, N m s/rad (N s/m).
    pub viscous: [f64; 2],
    /// Excess E at standstill (Stribeck), N m (N).
    pub excess: f64,
    /// Speed v_s by which the excess has fallen to 1/e, rad/s (m/s).
    pub stribeck_speed: f64,
    /// Dry friction over the coordinate, N m (N); see [`LinkFriction::at`].
    pub by_position: Option<Arc<Curve>>,
    /// Friction over the speed, N m (N).
    pub by_speed: Option<Arc<Curve>>,
}

impl LinkFriction {
    /// Dry friction of one level.
    pub fn coulomb(level: f64) -> Self {
        Self {
            dry: [level; 2],
            load_share: 0.0,
            viscous: [0.0; 2],
            excess: 0.0,
            stribeck_speed: 1.0,
            by_position: None,
            by_speed: None,
        }
    }

    /// Whether it never does anything.
    pub fn is_none(&self) -> bool {
        let dry = self.dry == [0.0; 2] && self.load_share == 0.0;
        let curved = self.by_position.is_some() || self.by_speed.is_some();
        dry && self.viscous == [0.0; 2] && self.excess == 0.0 && !curved
    }

    /// The law at a place of the link: what the curve over the coordinate adds there is dry
    /// friction.
    pub fn at(&self, position: f64) -> Self {
        let Some(curve) = &self.by_position else {
            return self.clone();
        };
        let added = curve.value(position);
        Self {
            dry: self.dry.map(|dry| dry + added),
            by_position: None,
            ..self.clone()
        }
    }

    /// The law while the transmission passes on `load`, N m (N): tooth forces and bearings press
    /// harder then, and dry friction is `F_s + share |load|`.
    pub fn under(&self, load: f64) -> Self {
        let pressed = self.load_share * load.abs();
        Self {
            dry: self.dry.map(|dry| dry + pressed),
            ..self.clone()
        }
    }

    /// Torque (force) that the transmission passes on to a link which needs `needed` of it against
    /// all but this share, while the coordinate moves in the direction of `sign`: the `x` of `x =
    /// needed + share |x| sign`, which forward simulation finds by itself.
    pub fn passed_on(share: f64, needed: f64, sign: f64) -> f64 {
        needed / (1.0 - share * sign * needed.signum())
    }

    /// What a drive must give against the friction that grows with the load alone, of a link that
    /// needs `needed` against all else and moves at `velocity`, N m (N).
    pub fn of_load(share: f64, needed: f64, velocity: f64) -> f64 {
        if velocity == 0.0 {
            return 0.0;
        }
        let sign = velocity.signum();
        share * Self::passed_on(share, needed, sign).abs() * sign
    }

    /// Size of the friction at a speed in one direction, N m (N).
    pub fn level(&self, direction: usize, speed: f64) -> f64 {
        self.sum(direction, speed).max(0.0)
    }

    /// All parts together, which curves may lead below zero.
    fn sum(&self, direction: usize, speed: f64) -> f64 {
        let mut level = self.dry[direction] + self.viscous[direction] * speed;
        if self.excess != 0.0 {
            level += self.excess * (-(speed / self.stribeck_speed).powi(2)).exp();
        }
        if let Some(curve) = &self.by_speed {
            level += curve.value(speed);
        }
        level
    }

    /// What a drive must give against the friction of a link that moves at `velocity`, N m (N);
    /// nothing at rest. The share of the load is not in it, nor the place: see
    /// [`LinkFriction::under`] and [`LinkFriction::at`].
    pub fn force(&self, velocity: f64) -> f64 {
        if velocity == 0.0 {
            return 0.0;
        }
        let direction = usize::from(velocity < 0.0);
        velocity.signum() * self.level(direction, velocity.abs())
    }

    /// Slope of the level over the speed.
    fn slope(&self, direction: usize, speed: f64) -> f64 {
        if self.by_speed.is_some() && self.sum(direction, speed) < 0.0 {
            return 0.0;
        }
        let x = speed / self.stribeck_speed;
        let falling = if self.excess == 0.0 {
            0.0
        } else {
            -2.0 * self.excess * x / self.stribeck_speed * (-x * x).exp()
        };
        let curved = self
            .by_speed
            .as_ref()
            .map_or(0.0, |curve| curve.slope(speed));
        self.viscous[direction] + falling + curved
    }
}

/// Impulse of the friction on the link over one step, N m s (N s).
///
/// `inverse_mass` is the joint's velocity per impulse, `before` its velocity at the start of the
/// step, `free` the one that it would end with without friction, all other forces taken as constant
/// over the step. While the joint moves, the friction of the speed in the middle of the motion acts
/// against it, as in [`crate::friction`]. Where it comes to rest within the step, it stays there if
/// the friction at standstill can hold it, else it leaves with the rest of the step, against the
/// friction of its new direction: a reversal costs no order of convergence.
pub fn solve_link_friction(
    inverse_mass: f64,
    before: f64,
    free: f64,
    law: &LinkFriction,
    dt_s: f64,
) -> f64 {
    let stopping = -free / inverse_mass;
    if before != 0.0
        && let Some(slid) = slide(inverse_mass, before, free, law, dt_s)
    {
        return slid;
    }
    let force = (free - before) / (inverse_mass * dt_s);
    let direction = usize::from(force < 0.0);
    if force.abs() <= law.level(direction, 0.0) {
        return stopping;
    }
    let moving_s = if before == 0.0 {
        0.0
    } else {
        let against = law.level(usize::from(before < 0.0), 0.5 * before.abs());
        let braking = inverse_mass * (against - before.signum() * force);
        if braking * dt_s > before.abs() {
            before.abs() / braking
        } else {
            dt_s
        }
    };
    let left_s = dt_s - moving_s;
    let free_from_rest = inverse_mass * force * left_s;
    match slide(inverse_mass, 0.0, free_from_rest, law, left_s) {
        Some(slid) => (free_from_rest - free) / inverse_mass + slid,
        None => stopping,
    }
}

/// Impulse of the friction on a link that moves in one direction for all of `dt_s`, that of
/// `before`, or if this is zero, of `free`; `None` if it comes to rest.
fn slide(inverse_mass: f64, before: f64, free: f64, law: &LinkFriction, dt_s: f64) -> Option<f64> {
    let sign = if before == 0.0 { free } else { before }.signum();
    let direction = usize::from(sign < 0.0);
    let most = sign * free / inverse_mass;
    // Size p of the impulse: p = dt level(u), u = max(0, u0 - W p / 2) the speed at mid-step.
    let speed_at = |p: f64| (0.5 * sign * (before + free) - 0.5 * inverse_mass * p).max(0.0);
    let defect = |p: f64| p - dt_s * law.level(direction, speed_at(p));
    if most <= 0.0 || defect(most) <= 0.0 {
        return None;
    }
    if law.viscous == [0.0; 2] && law.excess == 0.0 && law.by_speed.is_none() {
        return Some(-sign * law.level(direction, 0.0) * dt_s);
    }
    let start = dt_s * law.level(direction, speed_at(0.0));
    let p = newton_within([0.0, most], start, 1e-15 * most, |p| {
        let speed = speed_at(p);
        let turning = if speed > 0.0 {
            0.5 * inverse_mass * dt_s * law.slope(direction, speed)
        } else {
            0.0
        };
        (defect(p), 1.0 + turning)
    });
    Some(-sign * p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn verify_dry_friction_is_the_bounded_impulse() {
        let law = LinkFriction {
            dry: [4.0, 1.0],
            ..LinkFriction::coulomb(0.0)
        };
        assert_eq!(solve_link_friction(0.5, 10.0, 10.0, &law, 0.25), -1.0);
        assert_eq!(solve_link_friction(0.5, -10.0, -10.0, &law, 0.25), 0.25);
        assert_eq!(
            solve_link_friction(0.5, 0.0, 0.01, &law, 0.25),
            -0.02,
            "held"
        );
    }

    /// Over one step the mid-step rule is the trapezoid: `v⁺ = v (1 - x) / (1 + x)`, `x = c dt /
    /// 2M`.
    #[test]
    fn verify_viscous_friction_by_direction_is_the_trapezoid() {
        let law = LinkFriction {
            viscous: [30.0, 90.0],
            ..LinkFriction::coulomb(0.0)
        };
        let (mass, dt) = (2.0, 1e-3);
        for (v, c) in [(0.7, 30.0), (-0.7, 90.0)] {
            let p = solve_link_friction(1.0 / mass, v, v, &law, dt);
            let x = c * dt / (2.0 * mass);
            assert!(
                (v + p / mass - v * (1.0 - x) / (1.0 + x)).abs() < 1e-14,
                "{v}"
            );
        }
    }

    #[test]
    fn verify_a_joint_breaks_away_at_the_stribeck_peak() {
        let law = LinkFriction {
            excess: 5.0,
            stribeck_speed: 0.02,
            ..LinkFriction::coulomb(10.0)
        };
        let (mass, dt) = (100.0, 1e-3);
        let pushed = |force: f64| {
            let free = force * dt / mass;
            free + solve_link_friction(1.0 / mass, 0.0, free, &law, dt) / mass
        };
        assert_eq!(pushed(14.99), 0.0);
        assert!(pushed(15.01) > 0.0);
        assert!((law.level(0, 0.02) - 10.0 - 5.0 * (-1f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn verify_load_presses_on_dry_friction() {
        let law = LinkFriction {
            dry: [4.0, 1.0],
            load_share: 0.1,
            ..LinkFriction::coulomb(0.0)
        };
        assert!(!law.is_none());
        assert_eq!(law.under(0.0).dry, law.dry);
        assert_eq!(law.under(-20.0).dry, [6.0, 3.0]);
        for (needed, sign) in [(30.0, 1.0), (30.0, -1.0), (-30.0, 1.0), (-30.0, -1.0)] {
            let x = LinkFriction::passed_on(0.1, needed, sign);
            assert!((x - (needed + 0.1 * x.abs() * sign)).abs() < 1e-13, "{x}");
        }
    }

    proptest! {
        /// Friction takes energy, never drives the link on, and lies on its curve.
        #[test]
        fn verify_friction_lies_on_its_curve(
            before in -1.0..1.0f64, change in -0.1..0.1f64, mass in 0.1..100.0f64,
            f0 in 0.0..50.0f64, f1 in 0.0..50.0f64, c0 in 0.0..500.0f64, c1 in 0.0..500.0f64,
            excess in 0.0..50.0f64, v_s in 1e-3..1.0f64,
        ) {
            let law = LinkFriction {
                dry: [f0, f1],
                load_share: 0.0,
                viscous: [c0, c1],
                excess,
                stribeck_speed: v_s,
                by_position: None,
                by_speed: None,
            };
            let (dt, free) = (2.5e-4, before + change);
            let p = solve_link_friction(1.0 / mass, before, free, &law, dt);
            let after = free + p / mass;
            prop_assert!(after.abs() <= before.abs().max(free.abs()).max(change.abs()));
            if before * after > 1e-9 {
                let direction = usize::from(before < 0.0);
                let expected = dt * law.level(direction, 0.5 * (before + after).abs());
                prop_assert!(p * before <= 0.0);
                prop_assert!((p.abs() - expected).abs() <= 1e-9 * expected + 1e-15, "{p} {expected}");
            } else if after.abs() > 1e-9 {
                prop_assert!(after * change > 0.0 && after.abs() <= change.abs());
            }
        }

        /// A step in which a link under dry friction turns round or comes to rest ends as a
        /// thousand small ones by Moreau's rule, p = clamp(-m v_free, ±F h), do.
        #[test]
        fn verify_a_reversal_within_a_step(
            before in -0.05..0.05f64, change in -0.1..0.1f64, mass in 0.1..10.0f64,
            f0 in 0.0..500.0f64, f1 in 0.0..500.0f64,
        ) {
            let law = LinkFriction { dry: [f0, f1], ..LinkFriction::coulomb(0.0) };
            let (dt, parts) = (2.5e-4, 1000.0);
            let p = solve_link_friction(1.0 / mass, before, before + change, &law, dt);
            let after = before + change + p / mass;
            let mut v = before;
            for _ in 0..parts as usize {
                let free = v + change / parts;
                let most = law.dry.map(|f| f * dt / parts);
                v = free + (-free * mass).clamp(-most[0], most[1]) / mass;
            }
            let one = (f0.max(f1) * dt / mass + change.abs()) / parts;
            prop_assert!((after - v).abs() <= 2.0 * one + 1e-15, "{after} {v}");
        }
    }
}
