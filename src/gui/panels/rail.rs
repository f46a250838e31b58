//! Narrow form of the left panel: conditions, and buttons that open the bundles or the records in
//! sheets.
//!
//! A bundle is all physics models, or all identified models, in a condition. A sheet is drawn
//! beside the rail.

use egui::{Rect, Role, Sense, Stroke, StrokeKind, Ui, vec2};

use gdcm_model::dataset::BundleKind;

use super::condition_rows::ConditionRows;
use super::record_conditions::record_rail_rows_ui;
use super::table_menu::table_menu_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws the conditions as a narrow strip: number, airspeed, highest cost among the constrained
/// responses; buttons open the physics and the identified models. Beside the Records view, the
/// strip shows the fits, and a button opens the records.
pub fn rail_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    pin_ui(ui, palette, commands);
    if state.display.layout.arrangement.view() == View::Records {
        record_rail_rows_ui(ui, state, palette, commands);
        ui.add_space(12.0);
        region_ui(ui, Region::Models, |ui| {
            records_button(state).ui(ui, palette, commands)
        });
        return;
    }
    region_ui(ui, Region::Conditions, |ui| {
        let (head, heading) =
            ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
        // "no." and "kt" end where the rows' numbers and airspeeds end (`RAIL` in
        // condition_rows.rs); "J" is at the left edge of the cells.
        for (right, words) in [(20.0, "no."), (50.0, "kt"), (64.0, "J")] {
            let upto = head.with_max_x(head.left() + right);
            painted_text(ui, upto, AT_RIGHT_END, words, small(), palette.dim_text);
        }
        table_menu_ui(ui, &heading, TableKind::Conditions, commands);
        let rows = ConditionRows::rail(state);
        for condition in state.dataset().conditions() {
            rows.row_ui(ui, condition, palette, commands);
        }
    });
    ui.add_space(12.0);
    region_ui(ui, Region::Models, |ui| {
        let suggested = match state.shown() {
            Some(shown) => state.open_suggestions(shown).len(),
            None => 0,
        };
        let physics = ListButton {
            name: "Models",
            counts: state.kept_words(BundleKind::Physics),
            suggested,
            sheet: Sheet::Models,
        };
        physics.ui(ui, palette, commands);
        let identified = ListButton {
            name: "Identified",
            counts: state.kept_words(BundleKind::Identified),
            // Outliers are found by their perturbations (M5), which identified models lack.
            suggested: 0,
            sheet: Sheet::Identified,
        };
        identified.ui(ui, palette, commands);
    });
}

/// Returns the button that opens the displayed condition's records.
fn records_button(state: &State) -> ListButton {
    let counts = state.condition_fit(state.condition().id()).counts;
    ListButton {
        name: "Records",
        counts: format!("{} + {}", counts.fitted, counts.held_out),
        suggested: 0,
        sheet: Sheet::Records,
    }
}

/// Draws the pin that replaces the rail with the full panel.
fn pin_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
    let (rect, response) = ui.allocate_exact_size(vec2(32.0, 32.0), Sense::click());
    let symbol = Rect::from_center_size(rect.center(), vec2(14.0, 12.0));
    let color = if response.hovered() {
        palette.text
    } else {
        palette.dim_text
    };
    ui.painter()
        .rect_stroke(symbol, 2.0, Stroke::new(1.3, color), StrokeKind::Inside);
    ui.painter().vline(
        symbol.left() + 5.0,
        symbol.y_range(),
        Stroke::new(1.3, color),
    );
    let response = named(response, Role::Button, "Show the left panel");
    response
        .on_hover_text("Shows conditions, cost map and models beside the plots (Ctrl+B)")
        .asks(LayoutCommand::ShowLeft(true), commands);
}

/// Button in the rail that opens a list in a sheet.
struct ListButton {
    name: &'static str,
    /// Kept and total model count, "16 of 19"; for records, those used in the fit and those
    /// held out, "8 + 1".
    counts: String,
    /// Number of models suggested as outliers and not rejected.
    suggested: usize,
    sheet: Sheet,
}

impl ListButton {
    fn ui(self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let height = if self.suggested > 0 { 58.0 } else { 42.0 };
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
        if response.hovered() {
            ui.painter().rect_filled(rect, 4.0, palette.raised);
        }
        let first = Rect::from_min_size(rect.min + vec2(4.0, 4.0), vec2(rect.width(), 17.0));
        let second = first.translate(vec2(0.0, 17.0));
        let third = first.translate(vec2(0.0, 34.0));
        painted_text(ui, first, 0.0, self.name, medium(BODY_SIZE), palette.text);
        painted_text(ui, second, 0.0, &self.counts, small(), palette.dim_text);
        if self.suggested > 0 {
            let words = format!("{} suggested", self.suggested);
            painted_text(ui, third, 0.0, &words, small(), palette.warning);
        }
        named(
            response,
            Role::Button,
            format!("Open the list: {}", self.name),
        )
        .on_hover_text(match self.sheet {
            Sheet::Records => format!("{}: {} (used + held out)", self.name, self.counts),
            _ => format!("{}: {} kept", self.name, self.counts),
        })
        .asks(LayoutCommand::ShowSheet(Some(self.sheet)), commands);
    }
}
