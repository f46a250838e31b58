//! Labelled lines across a pane: what a figure of the fit is at every frequency.

use egui::{Align2, FontId, Rangef, Rect, Ui, pos2, vec2};
use egui_plot::{FilledArea, PlotBounds, PlotPoint, PlotTransform, PlotUi};

pub use gdcm_files::figure::{BodeBand, Level, Pane, ReferenceKind, ReferenceLine};

use crate::view::palette::Palette;

/// Font of the labels.
const FONT: FontId = FontId::proportional(10.5);
/// Least distance between two labels \[pt\].
const LABEL_GAP: f32 = 12.0;

/// Draws the rules of a pane into the plot that was drawn as `transform` says, with their labels at the left, beside one another where
/// the lines are close. A label without room is left out.
pub(super) fn rules_ui(ui: &Ui, rules: &[ReferenceLine], pane: Pane, transform: &PlotTransform, palette: &Palette) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame.shrink(1.0));
    let mut shapes = Vec::new();
    let mut labels = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        let path = path(&rule.level, transform);
        let left = frame.left() + LABEL_LEFT;
        let at = path.iter().find(|at| at.x >= left).or(path.first());
        let look = palette.curve_style(rule.kind.line());
        if let Some(at) = at.filter(|at| frame.y_range().contains(at.y)) {
            labels.push((rule.kind, at.y, format!("{}{}", rule.label, rule.note), look.color));
        }
        look.add_shapes(path, &mut shapes);
    }
    painter.extend(shapes);
    labels.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut taken = Vec::new();
    for (_, y, label, color) in labels {
        let Some(bottom) = free_place(y - 1.0, frame.y_range(), &taken) else { continue };
        taken.push(bottom);
        let galley = painter.layout_no_wrap(label, FONT, color);
        let place: Rect = Align2::LEFT_BOTTOM.anchor_size(pos2(frame.left() + LABEL_LEFT, bottom), galley.size());
        painter.rect_filled(place.expand(1.0), 2.0, palette.background.gamma_multiply(0.75));
        painter.galley(place.min, galley, color);
    }
}

/// The lower edge of a label nearest to `wanted` that keeps clear of those placed already, and of the ends of the plot; at most two
/// labels away, where it still is seen to belong to its line.
fn free_place(wanted: f32, frame: Rangef, taken: &[f32]) -> Option<f32> {
    let steps = [0.0, 1.0, -1.0, 2.0, -2.0];
    let is_free = |bottom: &f32| {
        let is_within = *bottom - LABEL_GAP >= frame.min && *bottom <= frame.max;
        is_within && taken.iter().all(|other| (bottom - other).abs() >= LABEL_GAP)
    };
    steps.into_iter().map(|step| wanted + step * LABEL_GAP).find(is_free)
}

/// Distance of the labels from the left edge \[pt\].
const LABEL_LEFT: f32 = 8.0;

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
    fn labels_keep_clear_of_one_another_and_one_without_room_is_left_out() {
        let frame = Rangef::new(0.0, 30.0);
        let mut taken = Vec::new();
        for _ in 0..4 {
            taken.extend(free_place(20.0, frame, &taken));
        }
        assert_eq!(taken, [20.0], "there is room for two, but not for one above and one below this one");
        assert_eq!(free_place(29.0, Rangef::new(0.0, 40.0), &[29.0]), Some(17.0));
    }
}

#[cfg(test)]
mod tests2 {
    use super::super::rule::*;

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
