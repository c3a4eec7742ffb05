//! Friction of a layer that slides over an edge.

use nalgebra::Vector2;

/// Force in the plane on an edge per force along the face's normal, where a layer slides over it at
/// `v` and the bisector of its two directions is turned from the face by `tilt`, down outwards.
///
/// The corner presses on the layer square to that bisector, and friction acts along it. A layer
/// that lies on the face and leaves with the kink φ has the tilt φ/2: across the edge the force is
/// `tan(ψ + φ/2)` inwards where it runs inward and `tan(ψ - φ/2)` outwards where it runs outward,
/// `ψ = atan μ`. That is what the tensions `T` and `T e^{±μφ}` on both sides of a rounded corner
/// (capstan) leave, to second order in φ.
pub(super) fn friction(
    outward: &Vector2<f64>,
    tilt_rad: f64,
    mu: f64,
    v: Vector2<f64>,
) -> Vector2<f64> {
    let speed = v.norm();
    let along = if speed > 0.0 { v / speed } else { v };
    let across = along.dot(outward);
    let (sine, cosine) = tilt_rad.sin_cos();
    let pressed = cosine + mu * across * sine;
    let outwards = (mu * across * cosine - sine) / pressed;
    outwards * outward + (along - across * outward) * (mu / pressed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wheel::face::Face;
    use crate::wheel::patch::Sliding;
    use crate::wheel::pneumatic::tests::wheel;
    use crate::wheel::quadrature::Quadrature;
    use nalgebra::{Isometry2, Point2};

    /// Resultant of the tensions on both sides of a rounded corner.
    fn capstan(mu: f64, kink: f64, inward: bool) -> f64 {
        let rise = (mu * kink).exp();
        // A layer that runs inward is pulled in: the tension on the face is the larger.
        let (on_face, outside) = if inward { (rise, 1.0) } else { (1.0, rise) };
        let down = outside * kink.sin();
        let inwards = on_face - outside * kink.cos();
        inwards / down
    }

    #[test]
    fn verify_friction_round_a_corner_is_the_capstan_s() {
        let outward = Vector2::x();
        for (mu, kink) in [(0.3, 0.1), (0.3, 0.3), (0.5, 0.3), (0.8, 0.2)] {
            for sense in [-1.0, 1.0] {
                let f = friction(&outward, 0.5 * kink, mu, Vector2::new(0.7 * sense, 0.0));
                let closed = sense * (mu.atan() - 0.5 * kink * sense).tan();
                assert!((f.x - closed).abs() < 1e-12 && f.y == 0.0, "{f} {closed}");
                let rope = -capstan(mu, kink, sense < 0.0);
                assert!((f.x / rope - 1.0).abs() < 0.02, "{mu} {kink}: {f} {rope}");
            }
        }
    }

    #[test]
    fn verify_a_flat_layer_has_coulomb_s_friction_and_sliding_along_only_the_tilt() {
        let v = Vector2::new(0.3, -0.4);
        let flat = friction(&Vector2::y(), 0.0, 0.3, v);
        assert!((flat - 0.3 * v / 0.5).norm() < 1e-15);
        let along = friction(&Vector2::x(), 0.15, 0.3, Vector2::new(0.0, 2.0));
        assert!((along.x + 0.15_f64.tan()).abs() < 1e-12);
        assert!((along.y - 0.3 / 0.15_f64.cos()).abs() < 1e-12);
    }

    /// On a patch whose middle lies over an edge: half the kink is what friction across it has more
    /// inward than outward.
    #[test]
    fn verify_friction_of_a_patch_at_an_edge_is_larger_inward_by_the_kink() {
        let face = Face::rectangle(0.1, 0.06).unwrap();
        let wheel = wheel();
        let patch = wheel.patch(&wheel.shell(), 0.8e-3);
        let from_face = Isometry2::translation(-0.1, -0.03);
        let rules = Quadrature::new(24);
        let loads = |sliding: &Sliding| patch.loads(&face, &from_face, sliding, &rules, |_| ());
        // about a point far below the surface moves along x all over the patch
        let across = |spin: f64| {
            let l = loads(&Sliding::about(Point2::new(0.0, -70.0), spin, 0.3));
            (l.friction_n.x + 0.3 * (l.normal_n - l.edge_n) * spin.signum()) / l.edge_n
        };
        let (inward, outward, psi) = (across(0.01), across(-0.01), 0.3_f64.atan());
        let half = (-inward).atan() - psi;
        assert!(half > 0.05 && half < 0.25, "{half}");
        assert!(
            ((psi - outward.atan()) / half - 1.0).abs() < 0.05,
            "{inward} {outward}"
        );
        // a bent layer at rest pulls the edge inwards
        assert!(loads(&Sliding::default()).friction_n.x < 0.0);
    }
}
