//! The path as it is written, and what it means for the stock.

use super::cut::Cut;
use nalgebra::Vector3;
use truecut_core::cutting::milling::layered::cut::{LayeredCut, ToolPlace};
use truecut_core::cutting::milling::layered::walls::Walls;
use truecut_core::cutting::milling::layered::way::{Leg, Meant};
use truecut_core::cutting::milling::swivel::cut::SwivelCut;
use truecut_core::cutting::milling::swivel::way::{SwivelLeg, SwivelMeant};
use truecut_scenario::PathMillingSpec;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Written {
    /// Of a tool that stands upright all the way.
    Upright { legs: Vec<Leg>, meant: Box<Meant> },
    /// Of one that leans somewhere.
    Swivel {
        legs: Vec<SwivelLeg>,
        meant: Box<SwivelMeant>,
    },
}

impl Written {
    /// A cut of the whole stock.
    pub fn cut(&self, spec: &PathMillingSpec, start: &ToolPlace) -> Cut {
        let (cutter, coefficients) = (spec.cutter, spec.coefficients);
        match self {
            Self::Upright { meant, .. } => {
                let walls = Walls::new(meant.stations.clone(), cutter.radius_m);
                let stock = meant.stock.clone();
                let cut = LayeredCut::new(cutter, coefficients, stock, walls, start.place_m);
                Cut::Upright(Box::new(cut))
            }
            Self::Swivel { meant, .. } => {
                let cut = SwivelCut::new(cutter, coefficients, meant.stock.clone(), start);
                Cut::Swivel(Box::new(cut))
            }
        }
    }

    /// Ends of each leg, and the point that it leads to.
    pub fn legs(&self) -> Vec<([Vector3<f64>; 2], usize)> {
        match self {
            Self::Upright { legs, .. } => {
                let each = legs.iter();
                each.map(|leg| ([leg.from_m, leg.to_m], leg.point))
                    .collect()
            }
            Self::Swivel { legs, .. } => {
                let each = legs.iter();
                each.map(|leg| {
                    let ends = [&leg.from, &leg.to].map(|pose| pose.translation.vector);
                    (ends, leg.point)
                })
                .collect()
            }
        }
    }

    /// Volumes of the stock, and of what the path leaves of it, m³.
    pub fn volumes_m3(&self) -> [f64; 2] {
        match self {
            Self::Upright { meant, .. } => [&meant.stock, &meant.target].map(|one| one.volume_m3()),
            Self::Swivel { meant, .. } => {
                [&meant.stock, &meant.target].map(|one| one.surface().volume_m3())
            }
        }
    }
}
