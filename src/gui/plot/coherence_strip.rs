//! Coherence strip below the panes, for measured responses.
//!
//! The coherence γ² lies between 0 and 1. A dashed line marks the minimum at which a frequency
//! counts (`BodeScene::least_coherence`).

use egui::{Align2, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::bode::CoherenceCurve;

use super::bode_scene::BodeScene;
use super::panel_text::caption_font;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::palette::Palette;

/// Coherence at the strip's upper edge.
const HIGHEST: f64 = 1.05;
/// Distance between the tick labels and the strip \[pt\].
const BESIDE: f32 = 6.0;

/// Coherence over a pane's frequencies.
pub(super) struct CoherenceStrip<'a> {
    pub(super) place: Rect,
    pub(super) scene: &'a BodeScene<'a>,
    /// Transform of the pane above, which defines the horizontal positions.
    pub(super) transform: &'a PlotTransform,
}

impl CoherenceStrip<'_> {
    /// Draws the coherence, and the minimum coherence that counts.
    pub(super) fn ui(&self, ui: &Ui, palette: &Palette) {
        let Self {
            place,
            scene,
            transform,
        } = *self;
        let frame = *transform.frame();
        let strip = place.with_min_x(frame.left()).with_max_x(frame.right());
        let painter = ui.painter();
        let outline = Stroke::new(1.0, palette.line);
        painter.rect_stroke(strip, 0.0, outline, StrokeKind::Inside);
        paint_axis(painter, strip, palette);
        let y = height_of(strip, scene.least_coherence);
        let least = [pos2(strip.left(), y), pos2(strip.right(), y)];
        let dashes = Stroke::new(1.0, palette.dim_text);
        painter.extend(Shape::dashed_line(&least, dashes, 4.0, 3.0));
        let painter = painter.with_clip_rect(strip.intersect(ui.clip_rect()));
        for curve in scene.coherence {
            let mut shapes = Vec::new();
            palette
                .role_style(curve.role, curve.rejected)
                .in_miniature()
                .add_shapes(path(curve, strip, transform), &mut shapes);
            painter.extend(shapes);
        }
        let name = format!(
            "Coherence of {}{}",
            scene.pair_title,
            scene.quantity.label_suffix()
        );
        let response = ui.interact(strip, Id::unique(&name), Sense::hover());
        named(response, egui::Role::Label, name).on_hover_text(
            "Coherence γ²; frequencies at which it is below the dashed line are not used, or are \
            unreliable if no minimum coherence is set",
        );
    }
}

/// Paints the axis at the left: its symbol and limits.
fn paint_axis(painter: &Painter, strip: Rect, palette: &Palette) {
    for value in [0.0, 1.0] {
        let y = height_of(strip, value).clamp(strip.top() + 5.0, strip.bottom() - 5.0);
        painter.text(
            pos2(strip.left() - BESIDE, y),
            Align2::RIGHT_CENTER,
            format!("{value}"),
            caption_font(),
            palette.dim_text,
        );
    }
    painter.text(
        pos2(strip.left() - BESIDE, height_of(strip, 0.5)),
        Align2::RIGHT_CENTER,
        "γ²",
        caption_font(),
        palette.text,
    );
}

/// Returns the vertical screen position for a coherence \[pt\].
fn height_of(strip: Rect, coherence: f64) -> f32 {
    strip.bottom() - strip.height() * (coherence / HIGHEST) as f32
}

fn path(curve: &CoherenceCurve, strip: Rect, transform: &PlotTransform) -> Vec<Pos2> {
    let mut path = Vec::with_capacity(curve.points.len());
    for [omega, coherence] in &curve.points {
        let at = transform.position_from_point(&PlotPoint::new(omega.log10(), 0.0));
        path.push(pos2(at.x, height_of(strip, *coherence)));
    }
    path
}
