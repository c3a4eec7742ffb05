//! An end mill whose axis turns as it goes, in a body of stock.
//!
//! Layers across the axis ([`layered`](super::layered)) are of no use to a tool that leans one way
//! here and another there. The stock is kept at the nodes of a grid in space: how far each lies
//! beyond what teeth have cut, negative where it is cut, linear between nodes along each axis.
//! Distances are true outside of what a body cuts on its way, within they are bounds: of a node
//! that is cut beside one that is not, it is extrapolated from outside how deep it lies. So a
//! surface is known to h²/8r (h the grid, r its radius of curvature), at edges where two cuts meet
//! to h.
//!
//! Chips are measured as everywhere else, against the stored motion: along the ray from the axis
//! through a piece of an edge the material begins where the outermost of earlier passes ends. Of a
//! tool that turns, axis and tip are stored, and an earlier pass is looked at where its axis met
//! the plane of the ray. That its circle is an ellipse there is left out: of the radius by half of
//! the squared angle that the axis turns through in two revolutions, at a radian a second and
//! 12 000 rpm 5e-5.
//!
//! Angles of teeth are counted about the axis from a direction that turns with it and not about it.
//! The edge is as long as the stock is deep, and no shank is wider than it. Flat ends and those of
//! bull noses stand clear: a path may not lead them down along their axis in stock.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`field`] | stock as distances on a grid in space |
//! | [`way`] | the path as written: what it must not do, the part that it means |
//! | [`cut`] | forces of a vibrating tool |
//! | `patch` | the part of a chip within the block |
//! | `teeth` | the stock as teeth pass |
//! | [`surface`] | volume, mesh, what is left |

pub mod cut;
pub mod field;
mod patch;
pub mod surface;
mod teeth;
pub mod way;

#[cfg(test)]
mod tests;
