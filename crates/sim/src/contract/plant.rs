//! Laws that every [`Plant`] keeps, asked of arms that nobody would build: one to seven joints of
//! either kind, oblique axes, off-centre masses, all from seeds.

use crate::loads::Attachment;
use crate::plant::{Command, Drive, JointLaw, Plant, WorldWrench};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Translation3};
use nalgebra::{Unit, UnitQuaternion, Vector3, Vector6};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::ops::Range;
use truecut_arm::{Chain, Frames, Joint, JointKind, Link, Robot, Transmission};
use truecut_scenario::DriveKind;

/// Steps of a run.
const STEPS: usize = 400;
/// Arms of each number of joints.
const SEEDS: u64 = 3;
/// Steps in which a scheme finds its way: the first is half a step.
const START: usize = 3;
const MOST_JOINTS: usize = 7;
/// Short beside the fastest mode of these arms, s.
const TIME_STEP_S: f64 = 1e-4;

/// What a plant is to be made of: an arm at rest, its links at `q`, its motors at `command`, driven
/// in position.
pub struct Case {
    pub robot: Robot,
    /// rad or m.
    pub q: Vec<f64>,
    /// rad or m.
    pub command: Vec<f64>,
    pub gravity_m_s2: Vector3<f64>,
    pub time_step_s: f64,
}

impl Case {
    /// Drives that follow the command exactly, through linear transmissions.
    pub fn drive(&self) -> Drive {
        let laws = vec![JointLaw::default(); self.robot.dof()];
        Drive::new(DriveKind::Position, &self.robot, 0, &laws, self.time_step_s)
    }

    fn begin(&self, plant: &mut dyn Plant, wrenches: &[WorldWrench]) {
        let zeros = vec![0.0; self.q.len()];
        let command = Command {
            position: &self.command,
            velocity: &zeros,
            force: &zeros,
        };
        plant.begin(command, wrenches);
    }

    fn step(&self, plant: &mut dyn Plant, wrenches: &[WorldWrench]) {
        self.begin(plant, wrenches);
        plant.finish(&[], &DVector::zeros(self.q.len()));
        plant.drift();
    }
}

/// Makes the plant under test.
pub type Make = fn(&Case) -> Box<dyn Plant>;

struct Random(ChaCha8Rng);

impl Random {
    fn within(&mut self, range: Range<f64>) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 * 2f64.powi(-53);
        range.start + unit * (range.end - range.start)
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.within(-size..size))
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let place = Translation3::from(self.vector(0.6));
        Isometry3::from_parts(place, UnitQuaternion::new(self.vector(3.0)))
    }

    /// Stiff enough to ring within a run, soft enough to be resolved by its steps.
    fn joint(&mut self, index: usize) -> Joint {
        let revolute = self.within(0.0..1.0) < 0.75;
        let stiffness = 10f64.powf(self.within(2.5..3.5));
        Joint {
            name: format!("joint_{index}"),
            kind: if revolute {
                JointKind::Revolute
            } else {
                JointKind::Prismatic
            },
            parent_from_joint: self.pose(),
            axis: Unit::new_normalize(self.vector(1.0) + Vector3::new(0.0, 0.0, 1.5)),
            limits: None,
            transmission: Transmission {
                stiffness: Some(stiffness),
                damping: 1e-4 * stiffness,
                ..Transmission::default()
            },
            urdf_damping: 0.0,
            urdf_friction: 0.0,
        }
    }

    /// A box, somewhere in the link, in any orientation.
    fn link(&mut self, index: usize) -> Link {
        let mass_kg = self.within(5.0..50.0);
        let [x, y, z] = [(); 3].map(|()| self.within(0.2..0.5).powi(2));
        let moments = Vector3::new(y + z, x + z, x + y) * (mass_kg / 12.0);
        let turn = UnitQuaternion::new(self.vector(3.0)).to_rotation_matrix();
        let inertia = turn * Matrix3::from_diagonal(&moments) * turn.transpose();
        Link {
            com_m: self.vector(0.4),
            ..link(format!("link_{index}"), mass_kg, inertia)
        }
    }
}

fn link(name: String, mass_kg: f64, inertia_about_com_kg_m2: Matrix3<f64>) -> Link {
    Link {
        name,
        mass_kg,
        com_m: Vector3::zeros(),
        inertia_about_com_kg_m2,
        visuals: Vec::new(),
        meshes: Vec::new(),
        solids: Default::default(),
    }
}

fn robot(joints: Vec<Joint>, links: Vec<Link>, frames: [Isometry3<f64>; 3]) -> Robot {
    Robot {
        name: "random".into(),
        chain: Chain {
            name: "random".into(),
            joints,
            links,
            followers: Vec::new(),
            base: link("base".into(), 0.0, Matrix3::zeros()),
            tip: "tip".into(),
            notes: Vec::new(),
            motion_doubts: Vec::new(),
            estimated_masses: Vec::new(),
            placeholders: None,
        },
        frames: Frames {
            last_link_from_flange: frames[0],
            flange_from_tool: frames[1],
            flange_from_foot: frames[2],
        },
        urdf_path: "random.urdf".into(),
        config_path: None,
        damping_ratios: Vec::new(),
        tool_load: None,
    }
}

/// Arms of one to seven joints, wound up by some milliradians (tenths of millimetres).
fn cases() -> impl Iterator<Item = Case> {
    (1..=MOST_JOINTS).flat_map(|n| (0..SEEDS).map(move |seed| case(n, seed)))
}

fn case(joints: usize, seed: u64) -> Case {
    let mut random = Random(ChaCha8Rng::seed_from_u64(100 * joints as u64 + seed));
    let parts = (0..joints).map(|i| (random.joint(i), random.link(i)));
    let (joints, links): (Vec<_>, Vec<_>) = parts.collect();
    let q: Vec<f64> = joints.iter().map(|_| random.within(-2.0..2.0)).collect();
    let windup: Vec<f64> = joints.iter().map(|_| random.within(-2e-4..2e-4)).collect();
    Case {
        command: q.iter().zip(&windup).map(|(q, w)| q + w).collect(),
        q,
        gravity_m_s2: Vector3::zeros(),
        time_step_s: TIME_STEP_S,
        robot: robot(joints, links, [(); 3].map(|()| random.pose())),
    }
}

/// A force and a moment on the tool that sway.
fn load(step: usize) -> WorldWrench {
    let (sin, cos) = (0.05 * step as f64).sin_cos();
    let wrench = Vector6::new(20.0 * sin, -10.0 * cos, 15.0, 1.0 * cos, 2.0 * sin, -0.5);
    (Attachment::Tool, wrench)
}

/// `M⁻¹` as the plant sees it, column by column.
fn mobility(plant: &mut dyn Plant) -> DMatrix<f64> {
    let n = plant.dof();
    let unit = |i| DVector::from_fn(n, |row, _| f64::from(u8::from(row == i)));
    let columns: Vec<_> = (0..n).map(|i| plant.mobility(&unit(i))).collect();
    DMatrix::from_columns(&columns)
}

/// What is solved for contacts is what the step then does.
pub fn free_velocity_is_what_finish_gives(make: Make) {
    for case in cases() {
        let mut plant = make(&case);
        for step in 0..STEPS {
            case.begin(plant.as_mut(), &[load(step)]);
            let free = plant.free_velocity().clone();
            plant.finish(&[], &DVector::zeros(case.q.len()));
            let error = (plant.half_step_velocity() - &free).amax();
            // A scheme may need its first steps to find its way.
            let size = free.amax().max(1e-3);
            assert!(step < START || error < 1e-5 * size, "step {step}: {error}");
            plant.drift();
        }
    }
}

/// A mass is symmetric and positive, and so is what an impulse changes.
pub fn mobility_is_symmetric_and_positive(make: Make) {
    for case in cases() {
        let mut plant = make(&case);
        for step in 0..10 {
            case.begin(plant.as_mut(), &[load(step)]);
            plant.free_velocity();
            let mobility = mobility(plant.as_mut());
            let apart = (&mobility - mobility.transpose()).amax();
            assert!(apart < 1e-9 * mobility.amax(), "{apart}: {mobility}");
            let least = mobility.symmetric_eigenvalues().min();
            assert!(least > 0.0, "{least}: {mobility}");
            plant.finish(&[], &DVector::zeros(case.q.len()));
            plant.drift();
        }
    }
}

/// A contact's force over the step moves the arm by `M⁻¹ Jᵀ F Δt`, a joint's torque by `M⁻¹ τ Δt`.
pub fn an_impulse_changes_the_velocity_by_its_mobility(make: Make) {
    for case in cases() {
        let n = case.q.len();
        let mut plant = make(&case);
        (0..5).for_each(|step| case.step(plant.as_mut(), &[load(step)]));
        case.begin(plant.as_mut(), &[]);
        let free = plant.free_velocity().clone();
        let (frame, wrench) = load(3);
        let torque = DVector::from_fn(n, |i, _| 5.0 - i as f64);
        let jacobian = plant.frame(frame).jacobian.clone();
        let impulse = (jacobian.tr_mul(&wrench) + &torque) * case.time_step_s;
        let expected = &free + plant.mobility(&impulse);
        plant.finish(&[(frame, wrench)], &torque);
        let error = (plant.half_step_velocity() - &expected).amax();
        assert!(error < 1e-5 * expected.amax(), "{error} of {expected}");
    }
}

/// Positions move by the velocity that belongs to the middle of the step.
pub fn positions_follow_the_half_step_velocity(make: Make) {
    for case in cases() {
        let mut plant = make(&case);
        for step in 0..50 {
            let before = plant.joints().position.clone();
            case.begin(plant.as_mut(), &[load(step)]);
            plant.finish(&[], &DVector::zeros(case.q.len()));
            let half = plant.half_step_velocity().clone();
            plant.drift();
            let after = &plant.joints().position;
            for ((before, after), half) in before.iter().zip(after).zip(half.iter()) {
                let error = (after - before - half * case.time_step_s).abs();
                assert!(error < 1e-12, "step {step}: {error}");
            }
        }
    }
}

/// What the arm loses of its energy, its transmissions have turned into heat.
pub fn energy_is_balanced(make: Make) {
    for case in cases() {
        let mut plant = make(&case);
        let (mut first, mut exchanged, mut worst, mut lost) = (None, 0.0f64, 0.0f64, 0.0);
        let mut power = 0.0;
        for _ in 0..STEPS {
            case.begin(plant.as_mut(), &[]);
            plant.finish(&[], &DVector::zeros(case.q.len()));
            let (kinetic, potential) = plant.energy_j();
            let now = plant.dissipation_w() - plant.drive_power_w();
            // Power at whole steps, by the trapezoidal rule.
            lost += 0.5 * (power + now) * case.time_step_s;
            power = now;
            let total = kinetic + potential + lost;
            let start = *first.get_or_insert(total);
            exchanged = exchanged.max(kinetic);
            worst = worst.max((total - start).abs());
            plant.drift();
        }
        assert!(exchanged > 0.0, "nothing moves");
        assert!(worst < 2e-3 * exchanged, "{worst} J of {exchanged} J");
    }
}

/// Two plants made alike and loaded alike are alike to the bit.
pub fn the_same_state_gives_the_same_step(make: Make) {
    for case in cases() {
        let mut pair = [make(&case), make(&case)];
        for step in 0..50 {
            for plant in &mut pair {
                case.step(plant.as_mut(), &[load(step)]);
            }
            let [one, other] = pair.each_ref().map(|plant| plant.joints());
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&one.position), bits(&other.position), "step {step}");
            assert_eq!(bits(&one.velocity), bits(&other.velocity), "step {step}");
        }
    }
}

/// No load, no gravity, no wind-up: nothing moves.
pub fn an_arm_without_load_stays_at_rest(make: Make) {
    for mut case in cases() {
        case.command.clone_from(&case.q);
        let mut plant = make(&case);
        (0..50).for_each(|_| case.step(plant.as_mut(), &[]));
        let joints = plant.joints();
        for (before, after) in case.q.iter().zip(&joints.position) {
            assert!((before - after).abs() < 1e-14, "{before} {after}");
        }
        assert!(
            joints.velocity.iter().all(|v| v.abs() < 1e-12),
            "{joints:?}"
        );
    }
}

/// All joints held by the impulses that take their free velocities away, whatever loads the arm.
pub fn locked_joints_stand_still(make: Make) {
    for case in cases() {
        let mut plant = make(&case);
        for step in 0..20 {
            case.begin(plant.as_mut(), &[load(step)]);
            let free = plant.free_velocity().clone();
            let impulse = mobility(plant.as_mut())
                .cholesky()
                .expect("positive")
                .solve(&free);
            plant.finish(&[], &(impulse / -case.time_step_s));
            let left = plant.half_step_velocity().amax();
            assert!(
                step < START || left < 1e-5 * free.amax(),
                "step {step}: {left} of {free}"
            );
            plant.drift();
        }
    }
}

/// 100 kg on 1e6 N/m with a damping ratio of 2 %, released 1 mm off:
/// `x = x0 exp(-ζωt) (cos ω_d t + ζω/ω_d sin ω_d t)`.
pub fn one_joint_decays_as_its_closed_form(make: Make) {
    let (mass_kg, omega, zeta, x0) = (100.0, 100.0f64, 0.02, 1e-3);
    let joint = Joint {
        name: "slide".into(),
        kind: JointKind::Prismatic,
        parent_from_joint: Isometry3::identity(),
        axis: Vector3::x_axis(),
        limits: None,
        transmission: Transmission {
            stiffness: Some(mass_kg * omega * omega),
            damping: 2.0 * zeta * omega * mass_kg,
            ..Transmission::default()
        },
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    };
    let carriage = link("carriage".into(), mass_kg, Matrix3::identity());
    let case = Case {
        robot: robot(vec![joint], vec![carriage], [Isometry3::identity(); 3]),
        q: vec![x0],
        command: vec![0.0],
        gravity_m_s2: Vector3::zeros(),
        time_step_s: TIME_STEP_S,
    };
    let mut plant = make(&case);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    for step in 1..=3000 {
        case.step(plant.as_mut(), &[]);
        let t = f64::from(step) * case.time_step_s;
        let (sin, cos) = (damped * t).sin_cos();
        let exact = x0 * (-zeta * omega * t).exp() * (cos + zeta * omega / damped * sin);
        let error = (plant.joints().position[0] - exact).abs();
        // A leapfrog's frequency is off by (ω Δt)²/24, so its phase by that times ω t.
        assert!(error < 3e-4 * x0, "{t} s: {error}");
    }
}
