//! Lane above the time charts with the displayed record's parts: their ends can be dragged, and a
//! drag over free space makes a new part. Without parts, the bar is the whole record, and dragging
//! one of its ends makes the first part.
//!
//! A drag lasts several frames: it is kept in egui's memory ([`LaneDrag`]), drawn in each frame,
//! and becomes a command when the pointer is released.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{
    Align2, Button, CursorIcon, Id, Label, PopupCloseBehavior, Rect, RichText, Role, Sense, Stroke,
    StrokeKind, Ui, UiBuilder, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_model::units::telling;

use super::histories::TimeView;
use super::page::Page;
use super::record_parts::{part_ui, span_ui};
use super::record_span::RecordSpan;
use super::time_charts::READOUT_WIDTH;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, small};

/// Bar height \[pt\].
const BAR: f32 = 14.0;
/// Handle width \[pt\].
const HANDLE: f32 = 4.0;
/// Width of the area in which a handle can be caught \[pt\].
const HANDLE_AREA: f32 = 12.0;
/// Length of the shortest part that a drag can make \[s\].
const LEAST_PART_S: f64 = 0.5;

/// Drag in the lane, kept between frames.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LaneDrag {
    /// Row of the part whose end is dragged; `None` for a new part.
    row: Option<usize>,
    /// Time at the end that stays \[s\].
    fixed_s: f64,
    /// Time at the dragged end \[s\].
    moved_s: f64,
}

impl LaneDrag {
    fn ends_s(self) -> [f64; 2] {
        [
            self.fixed_s.min(self.moved_s),
            self.fixed_s.max(self.moved_s),
        ]
    }
}

#[derive(Clone, Copy, Debug)]
struct Bar {
    /// Row of the part; `None` for the whole record.
    row: Option<usize>,
    ends_s: [f64; 2],
    is_used: bool,
    is_chosen: bool,
}

/// Draws the lane, the menu at its left, and the cursor's time at its right.
pub(super) fn parts_lane_ui(
    ui: &mut Ui,
    page: Page<'_>,
    record: &RecordSpan,
    place: Rect,
    view: &TimeView,
    commands: &mut Vec<Command>,
) {
    let frame = *view.transform.frame();
    menu_ui(ui, page, place.with_max_x(frame.left() - 2.0), commands);
    let lane = Lane {
        page,
        record,
        place: Rect::from_center_size(
            pos2(frame.center().x, place.center().y),
            vec2(frame.width(), BAR),
        ),
        transform: &view.transform,
        id: Id::unique(("parts of the record", record.whole_row)),
    };
    lane.show(ui, commands);
    let text = format!("t = {} s", telling(view.cursor_s, 2));
    let right = Rect::from_min_max(
        pos2(frame.right() + 10.0, place.top()),
        pos2(frame.right() + READOUT_WIDTH, place.bottom()),
    );
    painted_text(ui, right, 0.0, &text, small(), page.palette.text);
}

/// Draws the menu with the field for a new part, the displayed row's time span and, for a part, the
/// button that removes it.
fn menu_ui(ui: &mut Ui, page: Page<'_>, place: Rect, commands: &mut Vec<Command>) {
    let builder = UiBuilder::new().max_rect(place);
    ui.scope_builder(builder, |ui| {
        let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let text = RichText::new("parts")
            .size(SMALL_SIZE)
            .color(page.palette.accent);
        let button = MenuButton::from_button(Button::new(text).frame(false)).config(config);
        let (response, _) = button.ui(ui, |ui| {
            ui.set_min_width(260.0);
            ui.horizontal(|ui| part_ui(ui, page, commands));
            span_ui(ui, page);
            let chosen = page.records.rows.get(page.records.chosen);
            if chosen.is_some_and(|row| row.table.part_s.is_some())
                && ui.button("Remove this part").clicked()
            {
                commands.push(RecordsCommand::RemovePart(page.records.chosen).into());
                ui.close();
            }
            let hint = "Parts are used as separate records instead of the whole record. Drag over \
                the lane for a new part, or drag the ends of a part";
            ui.add(Label::new(page.palette.small(hint)).wrap());
        });
        named(response, Role::Button, "Parts of the record");
    });
}

/// Lane with a bar for each part.
struct Lane<'a> {
    page: Page<'a>,
    record: &'a RecordSpan,
    place: Rect,
    transform: &'a PlotTransform,
    id: Id,
}

impl Lane<'_> {
    fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let palette = self.page.palette;
        ui.painter().rect_filled(self.place, 3.0, palette.raised);
        self.free_room_ui(ui, commands);
        let drag = ui.data(|data| data.get_temp::<LaneDrag>(self.id));
        let bars = self.bars();
        for bar in &bars {
            let mut shown = *bar;
            if let Some(drag) = drag
                && drag.row == bar.row
                && drag.row.is_some()
            {
                shown.ends_s = drag.ends_s();
            }
            self.bar_ui(ui, shown, commands);
            self.handles_ui(ui, *bar, commands);
        }
        if let Some(drag) = drag
            && drag.row.is_none()
        {
            let new = Bar {
                row: None,
                ends_s: drag.ends_s(),
                is_used: true,
                is_chosen: true,
            };
            self.paint_bar(ui, new, palette);
        }
    }

    /// Returns the bars: the parts, or the whole record if it has no parts.
    fn bars(&self) -> Vec<Bar> {
        if self.record.parts.is_empty() {
            return vec![Bar {
                row: None,
                ends_s: self.record.span_s,
                is_used: self.record.is_whole_used,
                is_chosen: true,
            }];
        }
        let mut bars = Vec::new();
        for part in &self.record.parts {
            bars.push(Bar {
                row: Some(part.row),
                ends_s: part.ends_s,
                is_used: part.is_used,
                is_chosen: part.is_chosen,
            });
        }
        bars
    }

    fn x_of(&self, time_s: f64) -> f32 {
        self.transform
            .position_from_point(&PlotPoint::new(time_s, 0.0))
            .x
    }

    /// Returns the time \[s\] under the pointer, within the record.
    fn pointed_s(&self, ui: &Ui) -> Option<f64> {
        let pointer = ui.input(|input| input.pointer.latest_pos())?;
        let [first, last] = self.record.span_s;
        Some(
            self.transform
                .value_from_position(pointer)
                .x
                .clamp(first, last),
        )
    }

    /// Makes a new part from a drag over free space.
    fn free_room_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let response = ui.interact(self.place, self.id.with("room"), Sense::drag());
        let response = named(response, Role::Button, "Lane of the parts")
            .on_hover_text("Drag: use this part as a separate record instead of the whole record");
        if response.drag_started()
            && let Some(pressed) = ui.input(|input| input.pointer.press_origin())
        {
            let [first, last] = self.record.span_s;
            let fixed_s = self
                .transform
                .value_from_position(pressed)
                .x
                .clamp(first, last);
            let drag = LaneDrag {
                row: None,
                fixed_s,
                moved_s: fixed_s,
            };
            ui.data_mut(|data| data.insert_temp(self.id, drag));
        }
        self.follow(ui, &response, commands);
    }

    /// Moves the dragged end to the pointer, and pushes the command when the drag ends: moves the
    /// end of a part, or adds a part. Nothing changes if the part would be shorter than
    /// [`LEAST_PART_S`].
    fn follow(&self, ui: &Ui, response: &egui::Response, commands: &mut Vec<Command>) {
        if !response.dragged() && !response.drag_stopped() {
            return;
        }
        let Some(mut drag) = ui.data(|data| data.get_temp::<LaneDrag>(self.id)) else {
            return;
        };
        if let Some(pointed_s) = self.pointed_s(ui) {
            drag.moved_s = pointed_s;
        }
        if !response.drag_stopped() {
            ui.data_mut(|data| data.insert_temp(self.id, drag));
            return;
        }
        ui.data_mut(|data| data.remove::<LaneDrag>(self.id));
        let ends_s = drag.ends_s();
        if ends_s[1] - ends_s[0] < LEAST_PART_S {
            return;
        }
        match drag.row {
            Some(row) => commands.push(RecordsCommand::MovePart(row, ends_s).into()),
            None => {
                let whole = self.record.whole_row;
                commands.push(RecordsCommand::AddPart(whole, ends_s).into());
            }
        }
    }

    fn bar_rect(&self, ends_s: [f64; 2]) -> Rect {
        let [left, right] = ends_s.map(|end| self.x_of(end));
        self.place.with_min_x(left).with_max_x(right)
    }

    /// Draws a bar; a click on a part displays it.
    fn bar_ui(&self, ui: &Ui, bar: Bar, commands: &mut Vec<Command>) {
        self.paint_bar(ui, bar, self.page.palette);
        let Some(row) = bar.row else { return };
        let rect = self.bar_rect(bar.ends_s).intersect(self.place);
        if !rect.is_positive() {
            return;
        }
        let response = ui.interact(rect, self.id.with(("part", row)), Sense::click());
        let name = &self.page.records.rows[row].table.name;
        let response = named(response, Role::Button, format!("Part {name}"));
        if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
            commands.push(RecordsCommand::ChooseRecord(row).into());
        }
    }

    fn paint_bar(&self, ui: &Ui, bar: Bar, palette: &Palette) {
        let painter = ui
            .painter()
            .with_clip_rect(self.place.expand2(vec2(HANDLE, 1.0)));
        let rect = self.bar_rect(bar.ends_s);
        let fill = if bar.is_used {
            palette.selected
        } else {
            palette.line
        };
        let outline = if bar.is_chosen && bar.is_used {
            Stroke::new(1.0, palette.accent)
        } else {
            Stroke::new(1.0, palette.line)
        };
        painter.rect(rect, 3.0, fill, outline, StrokeKind::Inside);
        for end in [rect.left(), rect.right()] {
            let handle = Rect::from_center_size(
                pos2(end, rect.center().y),
                vec2(HANDLE, rect.height() + 2.0),
            );
            painter.rect_filled(handle, 2.0, palette.accent);
        }
        let text = self.bar_text(bar);
        let visible = rect.intersect(self.place);
        if text_width(ui, &text, small()) < visible.width() - 2.0 * HANDLE_AREA {
            painter.text(
                visible.center(),
                Align2::CENTER_CENTER,
                text,
                small(),
                palette.text,
            );
        }
    }

    fn bar_text(&self, bar: Bar) -> String {
        let [from, to] = bar.ends_s.map(|time_s| telling(time_s, 1));
        let is_whole = bar.row.is_none() && bar.ends_s == self.record.span_s;
        match (is_whole, bar.is_used) {
            (true, true) => format!("whole record, {from} to {to} s"),
            (true, false) => format!("whole record not used, {from} to {to} s"),
            (false, true) => format!("part used, {from} to {to} s"),
            (false, false) => format!("part not used, {from} to {to} s"),
        }
    }

    /// Adds the areas at a bar's ends in which its handles are caught.
    fn handles_ui(&self, ui: &Ui, bar: Bar, commands: &mut Vec<Command>) {
        for (end, words) in ["start", "end"].into_iter().enumerate() {
            let time_s = bar.ends_s[end];
            let center = pos2(self.x_of(time_s), self.place.center().y);
            if !self.place.expand(1.0).contains(center) {
                continue;
            }
            let size = vec2(HANDLE_AREA, self.place.height() + 4.0);
            let area = Rect::from_center_size(center, size);
            let id = self.id.with(("end", bar.row, end));
            let response = ui.interact(area, id, Sense::drag());
            let name = match bar.row {
                Some(row) => {
                    let name = &self.page.records.rows[row].table.name;
                    format!("Move the {words} of {name}")
                }
                None => format!("Cut the record at the {words}"),
            };
            let response =
                named(response, Role::Slider, name).on_hover_cursor(CursorIcon::ResizeHorizontal);
            if response.drag_started() {
                let drag = LaneDrag {
                    row: bar.row,
                    fixed_s: bar.ends_s[1 - end],
                    moved_s: time_s,
                };
                ui.data_mut(|data| data.insert_temp(self.id, drag));
            }
            self.follow(ui, &response, commands);
        }
    }
}
