//! Reference lines across a Bode pane (targets, bounds, quantiles and envelopes): painting,
//! picking, labels.
//!
//! A line's `Level` gives its value at every frequency; a note continues its label.

use egui::{Pos2, Ui};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::responses::{Level, ReferenceLine};

use super::drawn_curves::Pane;
use super::end_labels::EndLabel;
use super::nearest_curve::closest_point;
use crate::gui::widgets::palette::Palette;

/// Offset between a note and its label \[pt\]. End labels are sorted by height and spread, so that
/// the note comes directly below its label.
const BELOW: f32 = 0.1;

/// A pane's reference lines.
#[derive(Clone, Copy)]
pub(super) struct PaneLines<'a> {
    /// Lines for both panes; only those for `pane` are used.
    pub(super) lines: &'a [ReferenceLine],
    pub(super) pane: Pane,
    pub(super) transform: &'a PlotTransform,
}

impl<'a> PaneLines<'a> {
    fn iter(self) -> impl Iterator<Item = &'a ReferenceLine> {
        self.lines.iter().filter(move |line| line.pane == self.pane)
    }

    pub(super) fn paint(self, ui: &Ui, palette: &Palette) {
        let frame = self.transform.frame().shrink(1.0);
        let mut shapes = Vec::new();
        for line in self.iter() {
            for path in screen_paths(&line.level, self.transform) {
                palette
                    .curve_style(line.kind.line())
                    .add_shapes(path, &mut shapes);
            }
        }
        ui.painter().with_clip_rect(frame).extend(shapes);
    }

    /// Returns the distance between `pointer` and the nearest line \[pt\]; `None` if no line is
    /// within [`PICK_RADIUS`](super::nearest_curve::PICK_RADIUS) horizontally.
    pub(super) fn distance(self, pointer: Pos2) -> Option<f32> {
        let mut least: Option<f32> = None;
        for line in self.iter() {
            let points = visible_points(&line.level, self.transform);
            if let Some(closest) = closest_point(points.into_iter(), pointer, self.transform) {
                least = Some(match least {
                    Some(least) => least.min(closest.distance),
                    None => closest.distance,
                });
            }
        }
        least
    }

    /// Returns the labels, each at the height at which its line leaves the plot, with any note
    /// below; none for lines outside the frame.
    pub(super) fn labels(self, palette: &Palette) -> Vec<EndLabel> {
        let frame = *self.transform.frame();
        let mut labels = Vec::new();
        for line in self.iter() {
            let paths = screen_paths(&line.level, self.transform);
            let Some(end) = paths.iter().flatten().rev().find(|at| frame.contains(**at)) else {
                continue;
            };
            let color = palette.curve_style(line.kind.line()).color.to_opaque();
            labels.push(EndLabel {
                y: end.y,
                text: line.label.clone(),
                color: palette.label_color(color),
            });
            // The note continues the label on paper; here it is a separate label.
            let note = line.note.trim_start_matches([',', ':', ' ']);
            if !note.is_empty() {
                labels.push(EndLabel {
                    y: end.y + BELOW,
                    text: note.to_owned(),
                    color: palette.dim_text,
                });
            }
        }
        labels
    }
}

/// Returns a line's points `[log10 omega, value]` over the visible frequencies.
fn visible_points(level: &Level, transform: &PlotTransform) -> Vec<[f64; 2]> {
    let bounds = transform.bounds();
    level.points(bounds.min()[0], bounds.max()[0])
}

/// Returns a line's paths on the screen. Parts far outside the frame, whose many dashes would take
/// time to draw, are skipped; the line is divided there.
fn screen_paths(level: &Level, transform: &PlotTransform) -> Vec<Vec<Pos2>> {
    near_paths(visible_points(level, transform), transform)
}

/// Returns the paths of the points that are not far outside the frame.
fn near_paths(points: Vec<[f64; 2]>, transform: &PlotTransform) -> Vec<Vec<Pos2>> {
    let frame = transform.frame();
    let mut paths = vec![Vec::new()];
    for point in points {
        let at = transform.position_from_point(&PlotPoint::from(point));
        let is_near_frame = (at.y - frame.center().y).abs() < 2.0 * frame.height();
        let was_near_frame = paths.last().is_some_and(|path| !path.is_empty());
        if is_near_frame {
            if let Some(path) = paths.last_mut() {
                path.push(at);
            }
        } else if was_near_frame {
            paths.push(Vec::new());
        }
    }
    paths.retain(|path| path.len() > 1);
    paths
}

#[cfg(test)]
mod tests {
    use egui::{Rect, pos2};
    use egui_plot::PlotBounds;

    use super::*;

    #[test]
    fn a_line_is_divided_where_it_leaves_the_plot_far_behind() {
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        let bounds = PlotBounds::from_min_max([0.0, -1.0], [3.0, 1.0]);
        let transform = PlotTransform::new(frame, bounds, [false, false]);
        // Inside, 50 plot heights above, inside again.
        let values = [0.0, 0.0, 100.0, 100.0, 0.0, 0.0];
        let points: Vec<[f64; 2]> = values
            .iter()
            .enumerate()
            .map(|(index, value)| [0.5 * index as f64, *value])
            .collect();
        let paths = near_paths(points, &transform);
        assert_eq!(paths.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    }
}
