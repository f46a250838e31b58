//! Labelled lines across a pane: what a figure of the fit is at every frequency.

use egui::{Color32, Rect, Ui, vec2};
use egui_plot::{FilledArea, PlotBounds, PlotPoint, PlotTransform, PlotUi};

pub use gdcm_files::figure::{BodeBand, Level, Pane, ReferenceKind, ReferenceLine};

use crate::view::palette::Palette;

/// Draws the rules of a pane into the plot that was drawn as `transform` says.
pub(super) fn rules_ui(ui: &Ui, rules: &[ReferenceLine], pane: Pane, transform: &PlotTransform, palette: &Palette) {
    let painter = ui.painter().with_clip_rect(transform.frame().shrink(1.0));
    let mut shapes = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        palette.curve_style(rule.kind.line()).add_shapes(path(&rule.level, transform), &mut shapes);
    }
    painter.extend(shapes);
}

/// The labels of the rules of a pane, each at the height where its line leaves the plot, what is said besides below it.
pub(super) fn rule_ends(
    rules: &[ReferenceLine],
    pane: Pane,
    transform: &PlotTransform,
    palette: &Palette,
) -> Vec<(f32, String, Color32)> {
    let frame = *transform.frame();
    let mut ends = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        let path = path(&rule.level, transform);
        let Some(end) = path.iter().rev().find(|at| frame.contains(**at)) else { continue };
        let color = palette.name_of(palette.curve_style(rule.kind.line()).color.to_opaque());
        ends.push((end.y, rule.label.clone(), color));
        let note = rule.note.trim_start_matches([',', ':', ' ']);
        ends.extend((!note.is_empty()).then(|| (end.y + 0.1, note.to_owned(), palette.dim_text)));
    }
    ends
}

fn path(level: &Level, transform: &PlotTransform) -> Vec<egui::Pos2> {
    let points = level.points(transform.bounds().min()[0], transform.bounds().max()[0]);
    let position = |[x, y]: [f64; 2]| transform.position_from_point(&PlotPoint::new(x, y));
    // Far outside the frame a line is not drawn; so long a way in dashes would take its time.
    let frame = transform.frame();
    let is_near = |at: &egui::Pos2| (at.y - frame.center().y).abs() < 2.0 * frame.height();
    points.into_iter().map(position).filter(is_near).collect()
}

/// Draws the frequencies of `ranges` \[rad/s\] as strips along the lower edge of a plot.
pub(super) fn strips_ui(ui: &Ui, ranges: &[(f64, f64)], transform: &PlotTransform, palette: &Palette) {
    let frame = *transform.frame();
    let x = |omega: f64| transform.position_from_point_x(omega.log10());
    for (from, to) in ranges {
        let strip = Rect::from_x_y_ranges(x(*from)..=x(*to), frame.bottom() - STRIP_HEIGHT..=frame.bottom());
        ui.painter().with_clip_rect(frame).rect_filled(strip.shrink2(vec2(0.0, 1.0)), 0.0, palette.warning);
    }
}

/// Height of a strip along the lower edge \[pt\].
const STRIP_HEIGHT: f32 = 5.0;

/// Draws what is in `view` of the band in a pane, stretch by stretch: where a value is not finite, or a wrapped phase jumps, it has
/// a gap.
pub(super) fn draw_band(plot: &mut PlotUi<'_>, band: &BodeBand, pane: Pane, view: &PlotBounds, palette: &Palette) {
    let values = match pane {
        Pane::Magnitude => &band.magnitude_db,
        Pane::Phase => &band.phase_deg,
    };
    let points: Vec<[f64; 3]> =
        band.omega.iter().zip(values).map(|(omega, [lower, upper])| [omega.log10(), *lower, *upper]).collect();
    for run in points.chunk_by(|from, to| is_in_view(from, to, view)).filter(|run| run.len() > 1) {
        let column = |index: usize| run.iter().map(|point| point[index]).collect::<Vec<f64>>();
        let fill = palette.identified.gamma_multiply(0.22);
        plot.add(FilledArea::new("", &column(0), &column(1), &column(2)).fill_color(fill).allow_hover(false));
    }
}

/// Whether something of the band between two points, each a place with its lower and its upper value, is in view.
fn is_in_view(from: &[f64; 3], to: &[f64; 3], view: &PlotBounds) -> bool {
    let ([min_x, min_y], [max_x, max_y]) = (view.min(), view.max());
    let is_finite = from.iter().chain(to).all(|value| value.is_finite());
    is_finite && to[0] >= min_x && from[0] <= max_x && from[2].max(to[2]) >= min_y && from[1].min(to[1]) <= max_y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_counts_where_it_reaches_into_the_view() {
        let view = PlotBounds::from_min_max([0.0, 0.0], [1.0, 10.0]);
        let is_seen = |from, to| is_in_view(&from, &to, &view);
        assert!(is_seen([0.2, 1.0, 2.0], [0.3, 1.0, 2.0]));
        assert!(is_seen([-1.0, -5.0, -3.0], [2.0, 12.0, 15.0]), "it may pass through");
        assert!(!is_seen([-2.0, 1.0, 2.0], [-1.0, 1.0, 2.0]) && !is_seen([2.0, 1.0, 2.0], [3.0, 1.0, 2.0]));
        assert!(!is_seen([0.2, 11.0, 12.0], [0.3, 11.0, 12.0]) && !is_seen([0.2, -2.0, -1.0], [0.3, -2.0, -1.0]));
        assert!(!is_seen([0.2, f64::NAN, 2.0], [0.3, 1.0, 2.0]), "there is a gap");
    }
}
