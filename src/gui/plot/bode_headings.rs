//! Texts around the Bode panes: quantities, effect of the correction, curve names.
//!
//! ```text
//! heading       quantity [unit]        J before → after   leads +19.4 dB   matched
//! pane                                                         names beside the ends of curves
//! between       values at the cursor
//! below         frequency unit at the right; coherence strip
//! ```
//!
//! J is the cost of the response's mismatch, before and after the correction (M4: docs/method.md).
//! Leads are filters that advance the phase (M15: docs/lead.md); their price is the magnitude that
//! they add at the frequency at which the curves end, above the band and thus beyond the range in
//! which the corrected model is valid ([`InvalidRegion`](super::bode_scene::InvalidRegion)).
//! "matched" is the verdict on the correction.

use egui::{Align2, Rect, Ui, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use super::bode_layout::BodeLayout;
use super::bode_scene::{BodeScene, PaneNote};
use super::bode_view::BodeView;
use super::coherence_strip::CoherenceStrip;
use super::curve_style::Role;
use super::drawn_curves::{PANES, Pane};
use super::end_labels::{EndLabel, height_beside, labels_within, paint_end_labels};
use super::panel_axis::TICKS_HEIGHT;
use super::panel_text::{AT_RIGHT, caption_font};
use super::readout_strip::readout_strip_ui;
use super::reference_lines::PaneLines;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::{painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Gap between two texts in a heading \[pt\].
const GAP: f32 = 12.0;

/// Roles whose curves are named in the right margin.
const NAMED_ROLES: [Role; 5] = [
    Role::IdentifiedRepresentative,
    Role::Corrected,
    Role::WithoutLeads,
    Role::Variant,
    Role::Nominal,
];

/// Texts around the panes.
pub(super) struct BodeHeadings<'a> {
    pub(super) scene: &'a BodeScene<'a>,
    pub(super) view: &'a BodeView,
    pub(super) palette: &'a Palette,
}

impl BodeHeadings<'_> {
    /// Draws the texts, the read-out and the coherence strip. While the curves are older than the
    /// settings, the scene's message or "updating…" is above the magnitudes, unless a note is
    /// there.
    pub(super) fn ui(&self, ui: &Ui, layout: &BodeLayout) {
        let scene = self.scene;
        for pane in PANES {
            let line = layout.headings[pane as usize];
            let name_end = self.paint_quantity(ui, line, pane);
            if let Some(note) = scene.notes[pane as usize] {
                let room = line.with_min_x(name_end + 8.0);
                self.paint_note(ui, room, note, price_in_heading(scene, pane));
            } else if scene.stale && pane == Pane::Magnitude {
                let words = scene.message.unwrap_or("updating…");
                row_text(ui, line, AT_RIGHT, words, SMALL_SIZE, self.palette.dim_text);
            }
            if let Some(transform) = self.view.transform(pane)
                && has_margin_labels(scene)
            {
                let labels = self.pane_labels(pane, transform);
                paint_end_labels(ui, *transform.frame(), labels);
            }
        }
        let Some(transform) = self.view.transform(Pane::Phase) else {
            return;
        };
        paint_frequency_unit(ui, *transform.frame(), scene, self.palette);
        if let (Some(strip), Some(readout)) = (layout.readout, scene.readout) {
            readout_strip_ui(ui, strip, readout, self.palette);
        }
        if let Some(place) = layout.coherence {
            let strip = CoherenceStrip {
                place,
                scene,
                transform,
            };
            strip.ui(ui, self.palette);
        }
    }

    /// Paints quantity and unit; returns where the text ends at the right.
    fn paint_quantity(&self, ui: &Ui, line: Rect, pane: Pane) -> f32 {
        // The heading begins at the frame, so that the highest tick label does not touch it.
        let line = match self.view.frame(pane) {
            Some(frame) => line.with_min_x(frame.left()),
            None => line,
        };
        let label = self.scene.quantity.axis_label(pane);
        let (name, unit) = label.split_once(" [").unwrap_or((&label, ""));
        let font = medium(BODY_SIZE);
        let name = painted_text(ui, line, 0.0, name, font, self.palette.text);
        let unit = unit.trim_end_matches(']');
        let beside = name.right() - line.left() + 4.0;
        row_text(ui, line, beside, unit, BODY_SIZE, self.palette.dim_text).right()
    }

    /// Paints a note at the right of a heading, from right to left: verdict, leads' price, and J as
    /// far as there is room.
    fn paint_note(&self, ui: &Ui, room: Rect, note: &PaneNote, price: Option<String>) {
        let palette = self.palette;
        let color = if note.warns {
            palette.warning
        } else {
            palette.dim_text
        };
        let verdict = row_text(ui, room, AT_RIGHT, &note.verdict, BODY_SIZE, color);
        let mut rest = room.with_max_x(verdict.left() - GAP);
        if let Some(price) = price {
            let place = row_text(ui, rest, AT_RIGHT, &price, BODY_SIZE, palette.warning);
            rest = rest.with_max_x(place.left() - GAP);
        }
        let cost = elided(ui, &note.cost, rest.right() - rest.left(), BODY_SIZE);
        row_text(ui, rest, AT_RIGHT, &cost, BODY_SIZE, palette.dim_text);
    }

    /// Returns the labels in the right margin: names of roles, of groups of curves and of reference
    /// lines, and beside the magnitudes the price of the leads.
    fn pane_labels(&self, pane: Pane, transform: &PlotTransform) -> Vec<EndLabel> {
        let mut labels = Vec::new();
        if self.scene.names_roles {
            labels.extend(self.role_labels(pane, transform));
        }
        labels.extend(self.group_labels(pane, transform));
        let lines = PaneLines {
            lines: self.scene.reference_lines,
            pane,
            transform,
        };
        labels.extend(lines.labels(self.palette));
        if pane == Pane::Magnitude {
            labels.extend(self.price_label(transform));
        }
        labels
    }

    /// Returns the names of the [`NAMED_ROLES`], each at the visible end of the first curve in the
    /// role.
    fn role_labels(&self, pane: Pane, transform: &PlotTransform) -> Vec<EndLabel> {
        let frame = *transform.frame();
        let last_omega = self.view.omega_range().1;
        let mut labels = Vec::new();
        for role in NAMED_ROLES {
            let Some(end) = curve_end(self.scene, role, pane, last_omega) else {
                continue;
            };
            let at = transform.position_from_point(&end);
            let color = self.palette.role_style(role, false).color.to_opaque();
            labels.push(EndLabel {
                y: height_beside(frame, at.y),
                text: role.name().to_owned(),
                color: self.palette.label_color(color),
            });
        }
        labels
    }

    /// Returns the price of the leads, halfway between the magnitudes with and without them; `None`
    /// without leads.
    fn price_label(&self, transform: &PlotTransform) -> Option<EndLabel> {
        let [with_db, without_db] = self.scene.invalid?.ends_db?;
        // Only the height is used.
        let middle = PlotPoint::new(0.0, 0.5 * (with_db + without_db));
        let at = transform.position_from_point(&middle);
        Some(EndLabel {
            y: height_beside(*transform.frame(), at.y),
            text: self.scene.price_words()?,
            color: self.palette.warning,
        })
    }

    /// Returns the names of groups of curves, each at the mean height of the curves' ends; as many
    /// as fit into the pane.
    fn group_labels(&self, pane: Pane, transform: &PlotTransform) -> Vec<EndLabel> {
        let frame = *transform.frame();
        let last_omega = self.view.omega_range().1;
        let mut labels = Vec::new();
        for name in self.scene.group_names {
            let end_values = self.scene.curves.iter().filter_map(|curve| {
                if !name.curves.contains(&curve.id) {
                    return None;
                }
                curve.value_at(pane, curve.omega.last()?.min(last_omega))
            });
            let end_values: Vec<f64> = end_values.collect();
            if end_values.is_empty() {
                continue;
            }
            let mean = end_values.iter().sum::<f64>() / end_values.len() as f64;
            let at = transform.position_from_point(&PlotPoint::new(last_omega.log10(), mean));
            let color = self.palette.role_style(name.role, false).color.to_opaque();
            labels.push(EndLabel {
                y: height_beside(frame, at.y),
                text: name.text.clone(),
                color: self.palette.label_color(color),
            });
        }
        labels_within(frame, labels)
    }
}

fn has_margin_labels(scene: &BodeScene<'_>) -> bool {
    scene.names_roles || !scene.reference_lines.is_empty() || !scene.group_names.is_empty()
}

/// Returns the magnitude added by the leads as text for the heading above the magnitudes; `None`
/// above the phases, without leads, or if the right margin has labels, the price among them
/// (`pane_labels`).
fn price_in_heading(scene: &BodeScene<'_>, pane: Pane) -> Option<String> {
    if pane != Pane::Magnitude || has_margin_labels(scene) {
        return None;
    }
    Some(format!("leads {}", scene.price_words()?))
}

fn paint_frequency_unit(ui: &Ui, frame: Rect, scene: &BodeScene<'_>, palette: &Palette) {
    let at = pos2(frame.right() + 14.0, frame.bottom() + 0.5 * TICKS_HEIGHT);
    ui.painter().text(
        at,
        Align2::LEFT_CENTER,
        scene.unit.symbol(),
        caption_font(),
        palette.dim_text,
    );
}

/// Returns the last visible point on the first curve in a role; `None` without such a curve, or
/// without a value at its end.
fn curve_end(scene: &BodeScene<'_>, role: Role, pane: Pane, last_omega: f64) -> Option<PlotPoint> {
    let curve = scene.curves.iter().find(|curve| curve.role == role)?;
    let omega = curve.omega.last()?.min(last_omega);
    Some(PlotPoint::new(omega.log10(), curve.value_at(pane, omega)?))
}
