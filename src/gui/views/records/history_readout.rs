//! Read-out at the right of a time chart: channel name and unit, the identified model's fit, and
//! each role's value at the cursor.
//!
//! *Fit* and Theil's coefficient compare a simulated output with the measured one (M14.6:
//! docs/identification.md).

use egui::{Grid, Rect, RichText, Role as WidgetRole, Sense, Ui, pos2, vec2};

use gdcm_model::dataset::Channel;
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::Range;

use super::caution_marks::channel_caution_marks;
use super::page::Page;
use super::simulation::Simulated;
use super::value_range::{decimals_in, value_text};
use crate::gui::plot::curve_style::CurveStyle;
use crate::gui::state::records::TimeRole;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};

/// Height of the name line \[pt\].
const NAME: f32 = 16.0;
/// Usual line height for a role \[pt\].
const LINE: f32 = 15.0;
/// Length of a curve sample \[pt\].
const SAMPLE: f32 = 10.0;
const SAMPLE_GAP: f32 = 6.0;
/// Length of the dashes in a sample \[pt\].
const SAMPLE_DASH: f32 = 4.0;
/// Theil's coefficient (M14.6) below which a model's fit counts as good.
const GOOD_THEIL: f64 = 0.25;

/// A role's value at the cursor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RoleValue {
    pub(super) role: TimeRole,
    /// `None` where the role has no curve.
    pub(super) value: Option<f64>,
}

pub(super) struct ChannelReadout<'a> {
    pub(super) channel: &'a Channel,
    /// Output index; `None` for an input.
    pub(super) output: Option<usize>,
    /// Range on the value axis, which determines how many decimals are shown.
    pub(super) range: Range,
    /// Values, in the order of the role chips.
    pub(super) values: Vec<RoleValue>,
    pub(super) models: &'a [Simulated<'a>],
    pub(super) page: Page<'a>,
}

impl ChannelReadout<'_> {
    pub(super) fn show(&self, ui: &mut Ui, place: Rect) {
        let Page { palette, .. } = self.page;
        let name = &self.channel.name;
        let mut line = place.with_max_y(place.top() + NAME);
        let shown = painted_text(ui, line, 0.0, name, medium(BODY_SIZE), palette.text);
        let unit_at = shown.right() - place.left() + 5.0;
        painted_text(
            ui,
            line,
            unit_at,
            &self.channel.unit,
            small(),
            palette.dim_text,
        );
        let marks = channel_caution_marks(self.page, name);
        if !marks.is_empty() {
            painted_text(ui, line, AT_RIGHT_END, "⚠", small(), palette.warning);
        } else if let Some(fit) = self.identified_fit() {
            let fit = format!("fit {fit:.0} %");
            painted_text(ui, line, AT_RIGHT_END, &fit, small(), palette.dim_text);
        }
        let count = self.values.len().max(1) as f32;
        let pitch = LINE.min((place.height() - NAME) / count);
        line = line.translate(vec2(0.0, NAME));
        line.max.y = line.min.y + pitch;
        let digits = decimals_in(self.range);
        for value in &self.values {
            value.paint(ui, line, digits, self.page, palette);
            line = line.translate(vec2(0.0, pitch));
        }
        let id = ui.scope_id().with(("read-out", name));
        let response = named(
            ui.interact(place, id, Sense::hover()),
            WidgetRole::Label,
            self.sentence(digits),
        );
        if self.output.is_some() {
            response.on_hover_ui(|ui| self.tooltip_ui(ui, palette));
        }
    }

    /// Returns the identified model's fit \[%\].
    fn identified_fit(&self) -> Option<f64> {
        let output = self.output?;
        self.models
            .iter()
            .find(|model| model.role == TimeRole::Identified)?
            .fit_percent(output)
    }

    /// Returns the values as a sentence, for screen readers.
    fn sentence(&self, digits: usize) -> String {
        let mut parts = Vec::new();
        for RoleValue { role, value } in &self.values {
            parts.push(format!("{} {}", role.name(), value_text(*value, digits)));
        }
        format!(
            "{} [{}] at the cursor: {}",
            self.channel.name,
            self.channel.unit,
            parts.join(", ")
        )
    }

    /// Shows the channel's cautions, every model's fit and Theil's coefficient, the reasons for
    /// failed simulations, and the output's χ²/dof.
    fn tooltip_ui(&self, ui: &mut Ui, palette: &Palette) {
        let Some(output) = self.output else { return };
        for mark in channel_caution_marks(self.page, &self.channel.name) {
            ui.label(RichText::new(mark).color(palette.warning));
        }
        Grid::new("fit of the output")
            .num_columns(3)
            .show(ui, |ui| {
                for heading in ["", "fit %", "Theil"] {
                    ui.label(palette.small(heading));
                }
                ui.end_row();
                for model in self.models {
                    ui.label(RichText::new(model.role.name()).color(model.role.color(palette)));
                    ui.label(value_text(model.fit_percent(output), 1));
                    ui.label(theil_text(model.theil(output), palette));
                    ui.end_row();
                }
            });
        for model in self.models {
            if let Some(failure) = model.failure() {
                ui.label(palette.small_warning(failure));
            }
        }
        if let Some(identification) = self.page.current_identification()
            && let Some(cost) = identification.output_costs.get(output)
        {
            ui.label(palette.small(format!("χ²/dof of the output: {}", decimals(*cost, 2))));
        }
        ui.label(palette.small(
            "Simulated in windows of at most 10 s, each with its own initial state and offsets; \
            rank models by χ²/dof of the held-out record",
        ));
    }
}

impl RoleValue {
    fn paint(&self, ui: &Ui, line: Rect, digits: usize, page: Page<'_>, palette: &Palette) {
        let is_shown = !page.state.records.hidden_roles.contains(&self.role);
        let opacity = if is_shown { 1.0 } else { 0.4 };
        let y = line.center().y;
        let ends = vec![pos2(line.left(), y), pos2(line.left() + SAMPLE, y)];
        let style = self.role.style(palette);
        let sample = CurveStyle {
            color: style.color.gamma_multiply(opacity),
            width: 1.6,
            length: style.length.min(SAMPLE_DASH),
            ..style
        };
        let mut shapes = Vec::new();
        sample.add_shapes(ends, &mut shapes);
        ui.painter().extend(shapes);
        let dim = palette.dim_text.gamma_multiply(opacity);
        painted_text(
            ui,
            line,
            SAMPLE + SAMPLE_GAP,
            self.role.name(),
            small(),
            dim,
        );
        let value = value_text(self.value, digits);
        let color = palette.text.gamma_multiply(opacity);
        painted_text(ui, line, AT_RIGHT_END, &value, small(), color);
    }
}

/// Formats Theil's coefficient, in the warning colour unless it is below [`GOOD_THEIL`].
fn theil_text(theil: Option<f64>, palette: &Palette) -> RichText {
    let color = match theil {
        Some(theil) if theil < GOOD_THEIL => palette.text,
        Some(_) => palette.warning,
        None => palette.dim_text,
    };
    RichText::new(value_text(theil, 3)).color(color)
}
