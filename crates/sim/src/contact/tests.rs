use super::*;
use crate::loads::Attachment;
use crate::plant::{Command, FrameState, JointState};
use nalgebra::{DMatrix, Isometry3, Matrix6xX};
use truecut_core::friction::FrictionLaw;

const DT_S: f64 = 1e-3;

/// A body on three slides along x, y and z that are coupled through their inverse mass.
struct Slides {
    inverse_mass: DMatrix<f64>,
    before: DVector<f64>,
    free: DVector<f64>,
    joints: JointState,
    tool: FrameState,
}

impl Slides {
    fn new(inverse_mass: DMatrix<f64>, before: [f64; 3], free: [f64; 3]) -> Self {
        Self {
            inverse_mass,
            before: DVector::from_column_slice(&before),
            free: DVector::from_column_slice(&free),
            joints: JointState::at_rest(&[0.0; 3], &[0.0; 3]),
            tool: FrameState {
                world_from_frame: Isometry3::identity(),
                jacobian: Matrix6xX::from_fn(3, |row, column| f64::from(row == column)),
            },
        }
    }
}

impl Plant for Slides {
    fn dof(&self) -> usize {
        3
    }
    fn time_step_s(&self) -> f64 {
        DT_S
    }
    fn joints(&self) -> &JointState {
        &self.joints
    }
    fn frame(&self, _: Attachment) -> &FrameState {
        &self.tool
    }
    fn half_step_velocity(&self) -> &DVector<f64> {
        &self.before
    }
    fn free_velocity(&mut self) -> &DVector<f64> {
        &self.free
    }
    fn mobility(&mut self, impulse: &DVector<f64>) -> DVector<f64> {
        &self.inverse_mass * impulse
    }
    fn begin(&mut self, _: Command<'_>, _: &[WorldWrench]) {
        unreachable!("contacts are all that is asked for")
    }
    fn finish(&mut self, _: &[WorldWrench], _: &DVector<f64>) {
        unreachable!("contacts are all that is asked for")
    }
    fn drift(&mut self) {
        unreachable!("contacts are all that is asked for")
    }
    fn energy_j(&mut self) -> (f64, f64) {
        unreachable!("contacts are all that is asked for")
    }
    fn drive_power_w(&self) -> f64 {
        unreachable!("contacts are all that is asked for")
    }
    fn dissipation_w(&self) -> f64 {
        unreachable!("contacts are all that is asked for")
    }
    fn link_poses(&self) -> Vec<Isometry3<f64>> {
        unreachable!("contacts are all that is asked for")
    }
}

/// The contact creeps along z while the joint along y is held, and both push against what drives y.
/// Swept one by one, each gives way to the other by less the slower the contact slides: two hundred
/// sweeps do not do.
fn creeping(mu: f64, dry_n: f64) -> (Slides, ContactSolver, ContactRequest) {
    let inverse_mass = DMatrix::from_row_slice(
        3,
        3,
        &[
            2e-2, 1e-3, 0.0, //
            1e-3, 1e-2, -2e-3, //
            0.0, -2e-3, 1.5e-2,
        ],
    );
    // A tenth of a micrometre a second more than what contact and held joint together bring to
    // rest.
    let stopping = 20.0 * mu * DT_S * (1.5e-2 - 2e-3 * 0.2) - 3e-5 * 0.2;
    let plant = Slides::new(inverse_mass, [0.0, 0.0, 3e-8], [0.0, 3e-5, stopping + 1e-7]);
    let friction = [0.0, dry_n, 0.0].map(LinkFriction::coulomb);
    let request = ContactRequest {
        frame: Attachment::Tool,
        normal_force_n: 20.0,
        law: FrictionLaw::Coulomb { mu },
    };
    (plant, ContactSolver::new(friction.to_vec()), request)
}

#[test]
fn verify_a_contact_that_slides_over_a_held_joint_meets_both_laws() {
    for (mu, dry_n) in [(0.1, 5.0), (0.1, 3.6), (0.05, 4.0), (0.02, 4.0)] {
        let (mut plant, mut solver, request) = creeping(mu, dry_n);
        solver.solve(&mut plant, &[request], &Matrix3::identity());
        let contact = &solver.outcomes[0];
        let impulse = contact.friction_n * DT_S;
        // What the impulses do to the free velocity, both together.
        let all = DVector::from_column_slice(&[
            0.0,
            impulse.x + solver.joint_torques[1] * DT_S,
            impulse.y,
        ]);
        let velocity = &plant.free + &plant.inverse_mass * all;
        let scale = plant.free.amax();
        let bound = mu * request.normal_force_n * DT_S;
        assert!(contact.sliding, "{mu} {dry_n}");
        assert!((impulse.norm() / bound - 1.0).abs() < 1e-12, "{mu} {dry_n}");
        let middle = 0.5 * Vector2::new(velocity[1], velocity[2] + plant.before[2]);
        let off = (impulse.normalize() + middle.normalize()).norm();
        assert!(off < 1e-9, "{mu} {dry_n}: {off}");
        let joint = solver.joint_torques[1].abs();
        assert!(joint < dry_n, "{mu} {dry_n}: {joint}");
        assert!(
            velocity[1].abs() < 1e-12 * scale,
            "{mu} {dry_n}: {velocity}"
        );
    }
}

/// Joint and contact move the same way and nothing else can: however the two share it, the body is
/// held.
#[test]
fn verify_a_contact_and_a_joint_that_hold_the_same_way_hold() {
    let inverse_mass = DMatrix::from_diagonal(&DVector::from_column_slice(&[1e-2, 1e-2, 1e-9]));
    let mut plant = Slides::new(inverse_mass, [0.0; 3], [0.0, 3e-5, 0.0]);
    let friction = [0.0, 2.0, 0.0].map(LinkFriction::coulomb);
    let mut solver = ContactSolver::new(friction.to_vec());
    let request = ContactRequest {
        frame: Attachment::Tool,
        normal_force_n: 20.0,
        law: FrictionLaw::Coulomb { mu: 0.1 },
    };
    solver.solve(&mut plant, &[request], &Matrix3::identity());
    let shared = solver.outcomes[0].friction_n.x + solver.joint_torques[1];
    assert!((shared + 3.0).abs() < 1e-9, "{shared}");
}
