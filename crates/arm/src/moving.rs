//! What moves along a chain: the links of its joints, and those of followers between them.

use nalgebra::{DMatrix, Isometry3, Matrix6xX, Translation3, Unit, UnitQuaternion, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{Chain, Joint, JointKind, Limits, Link, Robot};

/// A joint that another one of the chain takes along (`<mimic>` of a URDF), as gears or rods do:
/// its coordinate is `multiplier` times that of the other, and `offset`. It has no transmission of
/// its own; what gives way is the joint that it follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    pub name: String,
    pub kind: JointKind,
    /// Joint frame at coordinate zero, in the frame of the link before.
    pub parent_from_joint: Isometry3<f64>,
    /// In the joint frame.
    pub axis: Unit<Vector3<f64>>,
    pub limits: Option<Limits>,
    /// How many joints of the chain come before it.
    pub after: usize,
    /// Which of the chain's joints it follows.
    pub follows: usize,
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
    /// What it moves.
    pub link: Link,
}

/// A link that moves, with its joint; coordinate `multiplier q[coordinate] + offset`.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    pub joint: &'a str,
    pub kind: JointKind,
    pub parent_from_joint: &'a Isometry3<f64>,
    pub axis: &'a Unit<Vector3<f64>>,
    pub limits: Option<&'a Limits>,
    pub link: &'a Link,
    pub coordinate: usize,
    pub multiplier: f64,
    pub offset: f64,
}

impl Moving<'_> {
    /// The joint's own coordinate at posture `q`.
    #[must_use]
    pub fn value(&self, q: &[f64]) -> f64 {
        self.multiplier * q[self.coordinate] + self.offset
    }

    /// The link before from this link at posture `q`.
    #[must_use]
    pub fn parent_from_link(&self, q: &[f64]) -> Isometry3<f64> {
        self.parent_from_joint * motion(self.kind, self.axis, self.value(q))
    }
}

/// The joint frame from the link, at a coordinate (rad or m).
pub(crate) fn motion(kind: JointKind, axis: &Unit<Vector3<f64>>, q: f64) -> Isometry3<f64> {
    match kind {
        JointKind::Revolute => Isometry3::from_parts(
            Translation3::identity(),
            UnitQuaternion::from_axis_angle(axis, q),
        ),
        JointKind::Prismatic => Isometry3::from_parts(
            Translation3::from(axis.into_inner() * q),
            UnitQuaternion::identity(),
        ),
    }
}

impl Joint {
    /// Counts the coordinate from `by` beyond where it was counted from, rad (m): at every
    /// coordinate the link stands where it stood at `by` more.
    pub fn shift_zero(&mut self, by: f64) {
        self.parent_from_joint *= motion(self.kind, &self.axis, by);
    }
}

impl Robot {
    /// Refuses a chain with followers, for what takes every joint by itself.
    ///
    /// # Errors
    /// Names the first follower; `purpose` says what takes none.
    pub fn refuse_followers(&self, purpose: &'static str) -> Result<(), ArmError> {
        let Some(own) = self.chain.followers.first() else {
            return Ok(());
        };
        Err(ArmErrorKind::Follows {
            joint: own.name.clone(),
            leader: self.chain.joints[own.follows].name.clone(),
            multiplier: own.multiplier,
            purpose,
        }
        .into())
    }
}

impl Chain {
    /// All links that move, from the base to the tip: those of the joints and of their followers.
    pub fn moving(&self) -> impl Iterator<Item = Moving<'_>> {
        let followers = |after: usize| {
            let own = self.followers.iter().filter(move |own| own.after == after);
            own.map(|own| Moving {
                joint: &own.name,
                kind: own.kind,
                parent_from_joint: &own.parent_from_joint,
                axis: &own.axis,
                limits: own.limits.as_ref(),
                link: &own.link,
                coordinate: own.follows,
                multiplier: own.multiplier,
                offset: own.offset,
            })
        };
        let joints = self.joints.iter().zip(&self.links).enumerate();
        let joints = joints.flat_map(move |(index, (joint, link))| {
            let own = Moving {
                joint: &joint.name,
                kind: joint.kind,
                parent_from_joint: &joint.parent_from_joint,
                axis: &joint.axis,
                limits: joint.limits.as_ref(),
                link,
                coordinate: index,
                multiplier: 1.0,
                offset: 0.0,
            };
            followers(index).chain([own])
        });
        joints.chain(followers(self.joints.len()))
    }

    /// A Jacobian with a column for each link that moves, as one for the joints' coordinates.
    pub(crate) fn folded(&self, by_link: Matrix6xX<f64>) -> Matrix6xX<f64> {
        if self.followers.is_empty() {
            return by_link;
        }
        let mut jacobian = Matrix6xX::zeros(self.joints.len());
        for (body, column) in self.moving().zip(by_link.column_iter()) {
            let mut own = jacobian.column_mut(body.coordinate);
            own += column * body.multiplier;
        }
        jacobian
    }

    /// A matrix over the links that move, as one over the joints' coordinates: Eᵀ A E, with E the
    /// coordinates of all joints over those of the chain.
    pub(crate) fn folded_square(&self, by_link: DMatrix<f64>) -> DMatrix<f64> {
        if self.followers.is_empty() {
            return by_link;
        }
        let mut folded = DMatrix::zeros(self.joints.len(), self.joints.len());
        for (i, one) in self.moving().enumerate() {
            for (j, other) in self.moving().enumerate() {
                folded[(one.coordinate, other.coordinate)] +=
                    one.multiplier * by_link[(i, j)] * other.multiplier;
            }
        }
        folded
    }
}
