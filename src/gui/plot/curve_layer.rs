//! Curve layer: drawing order, styles and lines for a pane's curves.

use egui::{Pos2, Shape};
use egui_plot::{PlotPoint, PlotTransform};

use super::curve_style::{CurveStyle, Role};
use super::drawn_curves::{BodeCurve, CurveId};
use crate::gui::widgets::palette::Palette;

/// Opacity while curves are being recomputed.
pub(super) const STALE: f32 = 0.5;

/// Emphasis, dimming and line width for a pane's curves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CurveLooks<'a> {
    /// Curve under the pointer.
    pub(super) pointed: Option<&'a CurveId>,
    /// Role drawn above all others.
    pub(super) raised: Option<Role>,
    /// Whether the curves are being recomputed: they are dimmed.
    pub(super) is_stale: bool,
    /// Whether the pane is small: lines are narrower.
    pub(super) is_miniature: bool,
}

impl CurveLooks<'_> {
    /// Returns whether the curve is emphasized: the pointer is on it, here or in another view, or
    /// its model or condition is selected.
    pub(super) fn is_emphasized(&self, curve: &BodeCurve) -> bool {
        curve.highlighted || self.pointed == Some(&curve.id)
    }

    /// Returns the curve's style while it is neither emphasized nor being recomputed.
    pub(super) fn resting_style(&self, curve: &BodeCurve, palette: &Palette) -> CurveStyle {
        let style = palette.role_style(curve.role, curve.rejected);
        if self.is_miniature {
            style.in_miniature()
        } else {
            style
        }
    }

    pub(super) fn style(&self, curve: &BodeCurve, palette: &Palette) -> CurveStyle {
        let style = self.resting_style(curve, palette);
        if self.is_emphasized(curve) {
            style.emphasized()
        } else if self.is_stale {
            CurveStyle {
                color: style.color.gamma_multiply(STALE),
                ..style
            }
        } else {
            style
        }
    }

    /// Sorts curves from bottom to top: by the rank of their role (`Role::layer`), above these the
    /// raised role, and on top the emphasized curves.
    pub(super) fn sort(&self, curves: &mut [(usize, &BodeCurve)]) {
        curves.sort_by_key(|(_, curve)| {
            (
                self.is_emphasized(curve),
                self.raised == Some(curve.role.shown(curve.rejected)),
                curve.role.layer(curve.rejected),
            )
        });
    }
}

/// Adds the lines through point sequences to the shapes on the screen.
pub(super) fn add_curve_lines(
    runs: &[Vec<PlotPoint>],
    style: CurveStyle,
    transform: &PlotTransform,
    shapes: &mut Vec<Shape>,
) {
    for run in runs {
        let path: Vec<Pos2> = run
            .iter()
            .map(|point| transform.position_from_point(point))
            .collect();
        style.add_shapes(path, shapes);
    }
}

/// Returns whether a curve is in one of the lowest layers (rejected, perturbed, or coloured by
/// airspeed) and may be part of an image.
pub(super) fn lies_at_the_bottom(curve: &BodeCurve) -> bool {
    curve.role.layer(curve.rejected) <= Role::Perturbed.layer(false)
}
