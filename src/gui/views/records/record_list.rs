//! The displayed condition's records: a row for each record and each part. From left to right: box
//! that takes the record into use, name, length \[s\], cost of the model's fit (χ²/dof), caution
//! sign, lock that holds the record out of the fit, and for a part the button that removes the
//! part.

use std::sync::Arc;

use egui::{Align2, Checkbox, Galley, Rect, Role, Sense, Stroke, StrokeKind, Ui};
use egui::{pos2, vec2};

use gdcm_model::units::number;
use gdcm_sysid::records::LaidOutRecord;

use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
pub(super) use crate::gui::state::condition_fit::BAD_FIT;
use crate::gui::widgets::controls::{Asks, hint_right_of, named, named_switch};
use crate::gui::widgets::list_row::{ROW_HEIGHT, RowLook};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Tooltip on fit costs.
pub(super) const CHI_SQUARED: &str = "Cost per degree of freedom of the recommended model; 1 if \
    only noise remains (docs/identification.md)";

/// Left edge of record names \[pt\].
const NAME_LEFT: f32 = 20.0;
/// Indentation of parts below their record \[pt\].
const INDENT: f32 = 18.0;
/// Right end of the lengths, from the row's right edge \[pt\].
const LENGTH_END: f32 = 88.0;
/// Width of the lengths \[pt\].
const LENGTH_WIDTH: f32 = 26.0;
/// Right end of the costs, from the row's right edge \[pt\].
const COST_END: f32 = 46.0;
/// Centre of the caution signs, from the row's right edge \[pt\].
const CAUTION_CENTER: f32 = 36.0;
/// Centre of the locks, from the row's right edge \[pt\].
const LOCK_CENTER: f32 = 20.0;
/// Centre of the buttons that remove parts, from the row's right edge \[pt\].
const REMOVE_CENTER: f32 = 5.0;
/// Minimum width to which a text is wrapped \[pt\].
const LEAST_WRAPPED: f32 = 40.0;

/// Shows a row for each record, its parts below it.
pub(super) fn record_rows_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let names = whole_names(page);
    let prefix = common_prefix(&names);
    headings_ui(ui, page, prefix);
    // Check boxes must not be higher than a row.
    ui.spacing_mut().interact_size.y = 16.0;
    for (index, row) in page.records.rows.iter().enumerate() {
        let row = RecordRow {
            page,
            index,
            row,
            shown_name: shown_name(row, prefix),
        };
        row.ui(ui, commands);
    }
}

/// Returns the names of whole records (not of parts), in row order.
fn whole_names(page: Page<'_>) -> Vec<&str> {
    let mut names = Vec::new();
    for row in &page.records.rows {
        if row.table.part_s.is_none() {
            names.push(row.table.name.as_str());
        }
    }
    names
}

/// Returns the prefix that all names share, up to a separator; empty for a single name. No name
/// consists of the prefix alone.
fn common_prefix<'n>(names: &[&'n str]) -> &'n str {
    const SEPARATORS: [char; 6] = ['_', '-', ' ', '.', '/', ','];
    let [first, others @ ..] = names else {
        return "";
    };
    if others.is_empty() {
        return "";
    }
    let mut end = 0;
    for (start, letter) in first.char_indices() {
        let next = start + letter.len_utf8();
        let is_shared = others.iter().all(|name| name.starts_with(&first[..next]));
        if !is_shared {
            break;
        }
        let is_all_of_a_name = names.iter().any(|name| name.len() == next);
        if SEPARATORS.contains(&letter) && !is_all_of_a_name {
            end = next;
        }
    }
    &first[..end]
}

/// Returns a record's name without the common prefix, or "4 to 52 s" for a part.
fn shown_name(row: &LaidOutRecord, prefix: &str) -> String {
    if let Some([from, to]) = row.table.part_s {
        return format!("{} to {} s", number(from), number(to));
    }
    let name = &row.table.name;
    name.strip_prefix(prefix).unwrap_or(name).to_owned()
}

/// Draws the headings: the names' common prefix, "s" above the lengths, and "χ²/dof" above the
/// costs; once records or settings have changed, "outdated" instead.
fn headings_ui(ui: &mut Ui, page: Page<'_>, prefix: &str) {
    let palette = page.palette;
    let prefix_text = if prefix.is_empty() {
        String::new()
    } else {
        format!("{prefix}…")
    };
    let room = ui.available_width() - NAME_LEFT - LENGTH_END - LENGTH_WIDTH;
    let galley = wrapped(ui, &prefix_text, room, false, palette.dim_text);
    let height = galley.size().y.max(18.0);
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    ui.painter().galley(
        pos2(
            row.left() + NAME_LEFT,
            row.center().y - 0.5 * galley.size().y,
        ),
        galley,
        palette.dim_text,
    );
    let lengths = row.with_max_x(row.right() - LENGTH_END);
    painted_text(ui, lengths, AT_RIGHT_END, "s", small(), palette.dim_text);
    let costs = row.with_max_x(row.right() - COST_END);
    let is_outdated = page.is_outdated();
    let heading_area = if is_outdated {
        painted_text(ui, row, AT_RIGHT_END, "outdated", small(), palette.warning)
    } else {
        painted_text(ui, costs, AT_RIGHT_END, "χ²/dof", small(), palette.dim_text)
    };
    let heading = ui.interact(
        heading_area,
        ui.scope_id().with("cost heading"),
        Sense::hover(),
    );
    heading.on_hover_text(if is_outdated {
        "χ²/dof of the latest fit; records or settings have changed since"
    } else {
        CHI_SQUARED
    });
}

/// Row for a record or a part.
struct RecordRow<'a> {
    page: Page<'a>,
    index: usize,
    row: &'a LaidOutRecord,
    /// Name without the prefix that all records share, or a part's time span.
    shown_name: String,
}

impl RecordRow<'_> {
    fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Page {
            records, palette, ..
        } = self.page;
        let name = &self.row.table.name;
        let width = ui.available_width();
        let left = NAME_LEFT + self.indent();
        let is_selected = self.index == records.chosen;
        // Wrap a long name: if its end were cut off, its number could be mistaken for another
        // record's.
        let room = width - left - LENGTH_END - LENGTH_WIDTH;
        let galley = wrapped(
            ui,
            &self.shown_name,
            room,
            is_selected,
            self.name_color(palette),
        );
        let look = RowLook {
            is_selected,
            is_pointed: false,
            height: (galley.size().y + 4.0).max(ROW_HEIGHT),
        };
        let (rect, response) = look.row_ui(ui, palette, &format!("Record {name}"));
        ui.painter().galley(
            pos2(rect.left() + left, rect.center().y - 0.5 * galley.size().y),
            galley,
            palette.text,
        );
        self.use_ui(ui, rect, commands);
        self.paint_length(ui, rect);
        self.cost_ui(ui, rect);
        self.cautions_ui(ui, rect);
        self.hold_out_ui(ui, rect, commands);
        self.remove_ui(ui, rect, commands);
        response.asks(RecordsCommand::ChooseRecord(self.index), commands);
    }

    fn is_part(&self) -> bool {
        self.row.table.part_s.is_some()
    }

    fn indent(&self) -> f32 {
        if self.is_part() { INDENT } else { 0.0 }
    }

    fn name_color(&self, palette: &Palette) -> egui::Color32 {
        if !self.row.problems.is_empty() {
            palette.warning
        } else if self.row.used {
            palette.text
        } else {
            palette.quiet_text
        }
    }

    /// Draws the check box that takes the record into use, disabled until its columns are assigned.
    fn use_ui(&self, ui: &mut Ui, rect: Rect, commands: &mut Vec<Command>) {
        let name = &self.row.table.name;
        let mut used = self.row.used && self.row.flight.is_some();
        let corner = rect.min + vec2(self.indent(), 0.0);
        let place = Rect::from_min_size(corner, vec2(16.0, rect.height()));
        let response = ui
            .add_enabled_ui(self.row.flight.is_some(), |ui| {
                ui.put(place, Checkbox::without_text(&mut used))
            })
            .inner;
        let response = named_switch(response, Role::CheckBox, used, format!("Use {name}"));
        if response.changed() {
            commands.push(RecordsCommand::SetUsed(self.index, used).into());
        }
        response.on_hover_text("Use the record for identification or validation");
    }

    fn paint_length(&self, ui: &Ui, rect: Rect) {
        let palette = self.page.palette;
        let words = match self.row.span_s() {
            Some([first_s, last_s]) => format!("{:.0}", last_s - first_s),
            None => "–".to_owned(),
        };
        let lengths = rect.with_max_x(rect.right() - LENGTH_END);
        painted_text(ui, lengths, AT_RIGHT_END, &words, body(), palette.dim_text);
    }

    /// Paints the record's χ²/dof: dim if outdated, in the warning colour if the fit is bad.
    fn cost_ui(&self, ui: &Ui, rect: Rect) {
        let Page {
            palette, records, ..
        } = self.page;
        let Some(cost) = records.fit_cost(&self.row.table.name) else {
            return;
        };
        let color = if self.page.is_outdated() {
            palette.quiet_text
        } else if cost > BAD_FIT {
            palette.warning
        } else {
            palette.text
        };
        let costs = rect.with_max_x(rect.right() - COST_END);
        painted_text(
            ui,
            costs,
            AT_RIGHT_END,
            &format!("{cost:.2}"),
            body(),
            color,
        );
    }

    /// Draws a sign if cautions about the identification or the columns concern the record.
    fn cautions_ui(&self, ui: &Ui, rect: Rect) {
        let Page {
            records, palette, ..
        } = self.page;
        let mut cautions: Vec<String> = records
            .cautions()
            .filter(|(rows, _)| rows.contains(&self.index))
            .map(|(_, note)| note.text)
            .collect();
        for caution in &self.row.cautions {
            cautions.push(caution.to_string());
        }
        if cautions.is_empty() {
            return;
        }
        let center = pos2(rect.right() - CAUTION_CENTER, rect.center().y);
        ui.painter()
            .text(center, Align2::CENTER_CENTER, "⚠", small(), palette.warning);
        let place = Rect::from_center_size(center, vec2(14.0, rect.height()));
        let id = ui.scope_id().with(("cautions", self.index));
        let mark = ui.interact(place, id, Sense::hover());
        named(
            hint_right_of(mark, rect, &cautions.join("\n\n")),
            Role::Label,
            format!("Cautions of {}", self.row.table.name),
        );
    }

    /// Draws the lock that holds the record out of the fit; a row that is not held out shows it
    /// only under the pointer or with the focus.
    fn hold_out_ui(&self, ui: &Ui, rect: Rect, commands: &mut Vec<Command>) {
        if self.row.flight.is_none() {
            return;
        }
        let palette = self.page.palette;
        let is_held_out = self.row.guess.held_out;
        let center = pos2(rect.right() - LOCK_CENTER, rect.center().y);
        let place = Rect::from_center_size(center, vec2(15.0, rect.height()));
        let id = ui.scope_id().with(("hold out", self.index));
        let response = ui.interact(place, id, Sense::click());
        let is_pointed = response.hovered() || response.has_focus();
        if is_held_out {
            paint_lock(ui, rect, palette.text);
        } else if is_pointed || ui.rect_contains_pointer(rect) {
            paint_lock(ui, rect, palette.quiet_mark);
        }
        let name = format!("Hold out {}", self.row.table.name);
        let response = named_switch(response, Role::CheckBox, is_held_out, name);
        let command = RecordsCommand::SetHeldOut(self.index, !is_held_out);
        response.asks(command, commands);
        response.on_hover_text(if is_held_out {
            "Held out: not fitted, so that it tests the model; click to fit it"
        } else {
            "Hold out: not fitted, so that it tests the model"
        });
    }

    /// Draws the button that removes a part.
    fn remove_ui(&self, ui: &Ui, rect: Rect, commands: &mut Vec<Command>) {
        if !self.is_part() {
            return;
        }
        let palette = self.page.palette;
        let center = pos2(rect.right() - REMOVE_CENTER, rect.center().y);
        let place = Rect::from_center_size(center, vec2(13.0, rect.height()));
        let id = ui.scope_id().with(("remove", self.index));
        let response = ui.interact(place, id, Sense::click());
        let color = if response.hovered() || response.has_focus() {
            palette.text
        } else {
            palette.dim_text
        };
        ui.painter()
            .text(center, Align2::CENTER_CENTER, "×", body(), color);
        let name = format!("Remove {}", self.row.table.name);
        let response = named(response, Role::Button, name);
        response.asks(RecordsCommand::RemovePart(self.index), commands);
        response.on_hover_text("Remove the part");
    }
}

/// Paints a closed lock in its column of a row.
fn paint_lock(ui: &Ui, row: Rect, color: egui::Color32) {
    let center = pos2(row.right() - LOCK_CENTER, row.center().y + 1.5);
    let body = Rect::from_center_size(center, vec2(8.0, 6.0));
    let stroke = Stroke::new(1.2, color);
    ui.painter()
        .rect_stroke(body, 1.0, stroke, StrokeKind::Middle);
    let shackle = Rect::from_center_size(pos2(center.x, body.top() - 0.5), vec2(5.0, 7.0));
    let rounded_top = egui::CornerRadius {
        nw: 3,
        ne: 3,
        sw: 0,
        se: 0,
    };
    // Only the upper part of the shackle shows above the body.
    let above_body = row.with_max_y(body.top());
    ui.painter()
        .with_clip_rect(above_body.intersect(ui.clip_rect()))
        .rect_stroke(shackle, rounded_top, stroke, StrokeKind::Middle);
}

/// Lays out a text within `room` \[pt\], wrapped between words or after punctuation.
fn wrapped(ui: &Ui, text: &str, room: f32, is_strong: bool, color: egui::Color32) -> Arc<Galley> {
    let font = if is_strong { medium(BODY_SIZE) } else { body() };
    ui.fonts_mut(|fonts| fonts.layout(text.to_owned(), font, color, room.max(LEAST_WRAPPED)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_beginning_up_to_a_separator_is_left_out_of_the_names() {
        let names = [
            "cond10_sweep_COL_1",
            "cond10_sweep_LON_1",
            "cond10_validation",
        ];
        assert_eq!(common_prefix(&names), "cond10_");
        // The digits that distinguish the records stay whole.
        assert_eq!(common_prefix(&["run_121", "run_122"]), "run_");
        assert_eq!(common_prefix(&["flight12", "flight13"]), "");
        assert_eq!(common_prefix(&["run_1", "run_"]), "", "no name is empty");
        assert_eq!(common_prefix(&["a_1_x", "a_1_y", "a_12"]), "a_");
        assert_eq!(common_prefix(&["only_one"]), "");
        assert_eq!(common_prefix(&[]), "");
    }
}
