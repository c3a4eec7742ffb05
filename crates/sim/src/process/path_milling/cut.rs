//! The cut along a path: in layers for an upright tool, in space for one whose axis turns.

use nalgebra::Vector3;
use truecut_core::cutting::milling::cut::MillingLoads;
use truecut_core::cutting::milling::layered::cut::{LayeredCut, ToolPlace};
use truecut_core::cutting::milling::layered::immersion::Immersion;
use truecut_core::cutting::milling::swivel::cut::SwivelCut;

#[derive(Debug, Clone)]
pub(super) enum Cut {
    Upright(Box<LayeredCut>),
    Swivel(Box<SwivelCut>),
}

impl Cut {
    /// Loads on the tool at a state, work frame; changes nothing.
    pub fn evaluate(&self, at: &ToolPlace) -> MillingLoads {
        match self {
            Self::Upright(cut) => cut.evaluate(at),
            Self::Swivel(cut) => cut.evaluate(at),
        }
    }

    /// Where the tool was at a rotation not longer ago than a pitch, its vibration as now.
    pub fn place_at(&self, rotation_rad: f64, now: &ToolPlace) -> ToolPlace {
        match self {
            Self::Upright(cut) => cut.place_at(rotation_rad, now),
            Self::Swivel(cut) => cut.place_at(rotation_rad, now),
        }
    }

    /// Whether tip and root of a straight edge's chip lie in stock.
    pub fn ends_in_stock(&self, tooth: usize, at: &ToolPlace) -> [bool; 2] {
        match self {
            Self::Upright(cut) => cut.ends_in_stock(tooth, at),
            Self::Swivel(cut) => cut.ends_in_stock(tooth, at),
        }
    }

    /// Where the rim of a tool that is fed along `feed`, work frame, is in stock.
    pub fn immersion(&self, at: &ToolPlace, feed: &Vector3<f64>) -> Option<Immersion> {
        match self {
            Self::Upright(cut) => cut.immersion(at, &feed.xy()),
            Self::Swivel(cut) => cut.immersion(at, feed),
        }
    }

    /// Whether a tooth's tip in the stock has come no further on its way since the last state.
    pub fn turns_back(&self, at: &ToolPlace) -> bool {
        match self {
            Self::Upright(cut) => cut.turns_back(at),
            Self::Swivel(cut) => cut.turns_back(at),
        }
    }

    /// The tool has come to this state. To be called once a step, with rising rotation.
    pub fn commit(&mut self, at: &ToolPlace) {
        match self {
            Self::Upright(cut) => cut.commit(at),
            Self::Swivel(cut) => cut.commit(at),
        }
    }

    /// Cuts the stock by all of the motion.
    pub fn finish(&mut self) {
        match self {
            Self::Upright(cut) => cut.finish(),
            Self::Swivel(cut) => cut.finish(),
        }
    }

    /// Volume of what is left of the stock, m³.
    pub fn volume_m3(&self) -> f64 {
        match self {
            Self::Upright(cut) => cut.stock().volume_m3(),
            Self::Swivel(cut) => cut.stock().surface().volume_m3(),
        }
    }
}
