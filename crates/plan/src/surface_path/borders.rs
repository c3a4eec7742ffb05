//! Lines along the borders of a patch, beside others that run askew to them.

use super::contact::Contact;
use super::error::SurfacePathError;
use super::graph::Turned;
use super::layout::Layout;
use super::lines::to_and_fro;

/// The lines next to the four borders.
pub(super) fn lines(layout: &Layout<'_>) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let mut lines = outermost(layout)?;
    let turned = Turned(layout.surface);
    let mut others = outermost(&Layout {
        surface: &turned,
        ..*layout
    })?;
    turned.all_back(&mut others);
    lines.extend(others);
    Ok(lines)
}

/// Those v = const.
fn outermost(layout: &Layout<'_>) -> Result<Vec<Vec<Contact>>, SurfacePathError> {
    let places = layout.outermost()?;
    let graphs = places.iter().map(|v| layout.constant(*v));
    to_and_fro(layout, graphs)
}
