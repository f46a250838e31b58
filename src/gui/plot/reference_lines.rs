//! Reference lines across a Bode pane: painting, picking, labels.

use egui::{Pos2, Ui};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::responses::{Level, ReferenceLine};

use super::drawn_curves::Pane;
use super::end_labels::EndLabel;
use super::picking::closest_point;
use crate::gui::widgets::palette::Palette;

/// Draws a pane's reference lines.
pub(super) fn paint_reference_lines(
    ui: &Ui,
    lines: &[ReferenceLine],
    pane: Pane,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(transform.frame().shrink(1.0));
    let mut shapes = Vec::new();
    for line in lines.iter().filter(|line| line.pane == pane) {
        palette
            .curve_style(line.kind.line())
            .add_shapes(path(&line.level, transform), &mut shapes);
    }
    painter.extend(shapes);
}

/// Returns the distance between `pointer` and a pane's nearest reference line \[pt\]; `None` if
/// none is near.
pub(super) fn distance_to_lines(
    lines: &[ReferenceLine],
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<f32> {
    let mut least: Option<f32> = None;
    for line in lines.iter().filter(|line| line.pane == pane) {
        let points = visible_points(&line.level, transform);
        if let Some(closest) = closest_point(points.into_iter(), pointer, transform) {
            least = Some(match least {
                Some(least) => least.min(closest.distance),
                None => closest.distance,
            });
        }
    }
    least
}

/// Returns the labels for a pane's reference lines, each at the height where its line leaves
/// the plot, with any further text below.
pub(super) fn line_labels(
    lines: &[ReferenceLine],
    pane: Pane,
    transform: &PlotTransform,
    palette: &Palette,
) -> Vec<EndLabel> {
    let frame = *transform.frame();
    let mut labels = Vec::new();
    for line in lines.iter().filter(|line| line.pane == pane) {
        let path = path(&line.level, transform);
        let Some(end) = path.iter().rev().find(|at| frame.contains(**at)) else {
            continue;
        };
        let color = palette.curve_style(line.kind.line()).color.to_opaque();
        labels.push(EndLabel {
            y: end.y,
            text: line.label.clone(),
            color: palette.name_of(color),
        });
        let note = line.note.trim_start_matches([',', ':', ' ']);
        if !note.is_empty() {
            labels.push(EndLabel {
                y: end.y + 0.1,
                text: note.to_owned(),
                color: palette.dim_text,
            });
        }
    }
    labels
}

/// Returns a line's points over the visible frequencies.
fn visible_points(level: &Level, transform: &PlotTransform) -> Vec<[f64; 2]> {
    let bounds = transform.bounds();
    level.points(bounds.min()[0], bounds.max()[0])
}

/// Returns a line's path on the screen. Parts far outside the frame are skipped, because their
/// many dashes would take time.
fn path(level: &Level, transform: &PlotTransform) -> Vec<Pos2> {
    let frame = transform.frame();
    let mut path = Vec::new();
    for point in visible_points(level, transform) {
        let at = transform.position_from_point(&PlotPoint::from(point));
        if (at.y - frame.center().y).abs() < 2.0 * frame.height() {
            path.push(at);
        }
    }
    path
}
