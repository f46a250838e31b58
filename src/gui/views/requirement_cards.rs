//! Cards in the requirement details: heading with its accent line, and the model colours.

use egui::{Color32, Label, Rect, RichText, Stroke, Ui, vec2};

use gdcm_plot::figure::drawing::{Color, Hue};
use gdcm_study::results::requirement_role::RequirementRole;

use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Heading height \[pt\].
const HEADING: f32 = 22.0;
/// Width of the line above the selected requirement's card \[pt\].
const ACCENT_LINE: f32 = 2.0;
/// Width of the line above other cards \[pt\].
const LINE: f32 = 1.0;

pub(super) struct CardHeading<'a> {
    pub(super) title: &'a str,
    /// Subject, drawn dim and cut at the end.
    pub(super) subject: &'a str,
    /// Whether the card belongs to the selected requirement.
    pub(super) is_accented: bool,
}

/// Draws a card's heading: a line, title and subject, controls at the right; returns the content
/// area.
pub(super) fn card_ui(
    ui: &mut Ui,
    area: Rect,
    heading: &CardHeading<'_>,
    palette: &Palette,
    controls: impl FnOnce(&mut Ui),
) -> Rect {
    let stroke = if heading.is_accented {
        Stroke::new(ACCENT_LINE, palette.accent)
    } else {
        Stroke::new(LINE, palette.line)
    };
    ui.painter().hline(area.x_range(), area.top() + 1.0, stroke);
    let row = Rect::from_min_size(area.min + vec2(0.0, 3.0), vec2(area.width(), HEADING));
    let from_right = true;
    let right = in_line_ui(ui, row, from_right, controls).response.rect;
    let end = if right.width() > 0.0 {
        right.left() - 6.0
    } else {
        row.right()
    };
    in_line_ui(ui, row.with_max_x(end), !from_right, |ui| {
        ui.label(RichText::new(heading.title).font(medium(BODY_SIZE)));
        ui.add(Label::new(palette.dim(heading.subject)).truncate());
    });
    area.with_min_y(row.bottom())
}

/// Returns the colour for texts about a role's model; the corrected and the scheduled model share a
/// colour.
pub(super) fn role_color(palette: &Palette, role: RequirementRole) -> Color32 {
    let hue = match role {
        RequirementRole::Physics => Hue::Perturbed,
        RequirementRole::Corrected | RequirementRole::Scheduled => Hue::Corrected,
        RequirementRole::Identified => Hue::Identified,
    };
    palette.label_color(palette.color(Color::new(hue)))
}
