//! Dot under the pointer: the nearest one, not the topmost.

use egui::Pos2;
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::Panel;
use gdcm_plot::figure::figure::Dot;
use gdcm_plot::figure::marks::MarkId;

/// Maximum distance between the pointer and a picked dot \[pt\].
const DOT_RADIUS: f32 = 10.0;

/// Dot or column under the pointer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PointedMark {
    pub(super) id: MarkId,
    /// Axis coordinates of the dot; for a column, its place and zero.
    pub(super) at: [f64; 2],
}

/// Returns the nearest dot with an id within [`DOT_RADIUS`]; among equally near dots, the topmost,
/// which is drawn last.
pub(super) fn nearest_dot(
    panel: &Panel,
    transform: &PlotTransform,
    pointer: Pos2,
) -> Option<PointedMark> {
    let mut nearest: Option<(f32, &Dot, &MarkId)> = None;
    for dot in panel.dots() {
        let Some(id) = &dot.id else { continue };
        let distance = transform
            .position_from_point(&PlotPoint::new(dot.x, dot.y))
            .distance(pointer);
        let is_nearest = nearest.is_none_or(|(least, ..)| distance <= least);
        if distance <= DOT_RADIUS && is_nearest {
            nearest = Some((distance, dot, id));
        }
    }
    let (_, dot, id) = nearest?;
    Some(PointedMark {
        id: id.clone(),
        at: [dot.x, dot.y],
    })
}
