//! Random programs, from seeds.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, OpwGeometry, ToolLoad};

use super::Subject;
use crate::program::dialect::TurntableUnit;
use crate::program::moves::{Motion, Move, Program, SpindleSwitch, Tool, Zone};
use crate::singularity::SingularityLimits;

impl Subject {
    pub(super) fn program(&self, random: &mut Random, count: usize) -> Program {
        let name = self.dialect.tool(&self.robot, &self.options);
        let tool = Tool {
            flange_from_tool: random.pose(0.2),
            load: Some(ToolLoad {
                mass_kg: 2.5,
                centre_m: random.vector(0.1),
            }),
            ..name.expect("the tool's name")
        };
        let world_from_base = random.pose(0.4);
        let turntable = random.below(2) == 1 && self.dialect.turntable() != TurntableUnit::None;
        let mut path_point = random.below(3);
        let postures = self.postures(random, count).into_iter();
        let moves = postures.map(|posture| {
            let flange = (self.robot).world_from_frame(&posture, FrameId::Flange);
            let step = Move {
                path_point,
                base_from_tool: world_from_base.inverse() * flange * tool.flange_from_tool,
                motion: random.motion(),
                zone: match random.below(3) {
                    0 => Zone::Stop,
                    _ => Zone::Within(random.between(0.0005, 0.02)),
                },
                turntable_rad: turntable.then(|| random.between(-6.0, 6.0)),
                posture,
            };
            path_point += 1 + random.below(3);
            step
        });
        Program {
            name: "PROBE".to_owned(),
            comment: String::new(),
            world_from_base,
            moves: moves.collect(),
            spindle: vec![
                SpindleSwitch {
                    before: count / 2,
                    on: true,
                },
                SpindleSwitch {
                    before: count,
                    on: false,
                },
            ],
            notes: Vec::new(),
            tool,
        }
    }

    /// A walk in joint space, small steps and wide ones.
    fn postures(&self, random: &mut Random, count: usize) -> Vec<Vec<f64>> {
        let limits: Vec<[f64; 2]> = (self.robot.chain.joints.iter())
            .map(|joint| joint.limits.map_or([-3.0, 3.0], |l| [l.lower, l.upper]))
            .collect();
        let mut walk: Vec<Vec<f64>> = Vec::with_capacity(count);
        while walk.len() < count {
            let wide = walk.is_empty() || random.below(4) == 0;
            let step = |(joint, [lower, upper]): (usize, &[f64; 2])| match walk.last() {
                Some(before) if !wide => before[joint] + random.between(-0.05, 0.05),
                _ => random.between(*lower, *upper),
            };
            let q: Vec<f64> = limits.iter().enumerate().map(step).collect();
            if self.regular(&q, &limits) {
                walk.push(q);
            } else if random.below(20) == 0 {
                // The walk may have led into a corner.
                walk.pop();
            }
        }
        walk
    }

    fn regular(&self, q: &[f64], limits: &[[f64; 2]]) -> bool {
        let mut each = q.iter().zip(limits);
        let inside = each.all(|(q, [lower, upper])| {
            let quarter = q.to_degrees() / 90.0;
            *q > lower + 1e-3 && *q < upper - 1e-3 && (quarter - quarter.round()).abs() > 0.01
        });
        let clear = |geometry: OpwGeometry| {
            SingularityLimits::default().allow(&geometry.singularity_distance(q))
        };
        inside && OpwGeometry::of(&self.robot).is_none_or(clear)
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014): small, and the same everywhere.
pub(super) struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self, most: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-most, most))
    }

    fn pose(&mut self, most_m: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_scaled_axis(self.vector(1.5));
        Isometry3::from_parts(Translation3::from(self.vector(most_m)), rotation)
    }

    fn motion(&mut self) -> Motion {
        if self.below(3) == 0 {
            let share = self.between(0.01, 1.0);
            return Motion::Joint { share };
        }
        let speed_m_per_s = self.between(0.001, 1.4);
        Motion::Linear { speed_m_per_s }
    }
}
