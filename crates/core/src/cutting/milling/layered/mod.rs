//! An end mill on any path in a body of stock, its axis along z.
//!
//! The stock is a block in layers between the depths of the path. Each layer holds, at the nodes of
//! a plane grid, how far the node lies beyond what teeth have cut: the distance from the nearest
//! arc that a tooth ran on, negative where it is cut. Between nodes it is bilinear, so that a wall
//! is known to h²/8r (h the grid, r the cutter's radius) and not to a part of h; at edges where
//! two cuts meet to h.
//!
//! Micrometres do not come from the grid: chips are measured against the stored motion of the axis
//! ([`cut`]), as in a straight cut, and walls are kept on rays ([`walls`]). The grid follows by two
//! revolutions; it says where a ray is still in stock that no tooth has been to.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`block`] | a box of stock, holes through it |
//! | [`stock`] | layers, cutting by arcs and by legs of a path |
//! | [`way`] | the path as written: depths, what it must not do, the walls that it means |
//! | [`cut`] | forces of a vibrating tool, where its rim is in stock |
//! | [`immersion`] | where a rim is in stock |
//! | `ends` | forces of the ends of teeth on plunges and ramps |
//! | `round` | round corners of cutters: chips of their edges, layers, floors |
//! | `sinking` | legs on which the depth changes: their layers and floors |
//! | [`solid`] | stock from a closed mesh: sections by layer |
//! | [`walls`] | rays on which walls are measured |
//! | [`outline`] | areas, volume, mesh |

mod arc;
pub mod block;
pub mod cut;
mod ends;
pub mod immersion;
pub mod outline;
pub(super) mod round;
mod sinking;
pub mod solid;
pub mod stock;
mod sweep;
pub mod walls;
pub mod way;

#[cfg(test)]
mod tests;
