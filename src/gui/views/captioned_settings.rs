//! Settings with a caption in a row of its own: a choice as joined segments below the caption, and
//! a number with a slider below. Both show the value at the time the settings panel was opened, if
//! it has changed since.

use egui::{Align2, Rect, Role, Sense, Slider, Stroke, StrokeKind, UiBuilder, WidgetInfo, vec2};

use gdcm_study::decisions::setting::{Kind, Setting};
use gdcm_study::decisions::setting_value::Value;
use gdcm_words::setting_words::setting_words;

use super::setting_controls::{SettingControls, number_field};
use crate::gui::commands::study::StudyCommand;
use crate::gui::widgets::controls::named_switch;
use crate::gui::widgets::number_field::NumberField;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{body, small};

/// Maximum value on a slider; larger values can be typed.
const SLIDER_END: f64 = 1e3;
/// Value below which a slider snaps to zero.
const SLIDER_START: f64 = 1e-3;

/// Width of a typed number beside a caption \[pt\].
const TYPED_WIDTH: f32 = 54.0;
/// Height of a row with a caption \[pt\].
const ROW: f32 = 20.0;
/// Height of a segmented control \[pt\].
const SEGMENTS: f32 = 24.0;
/// Slider handle radius relative to the slider height, as in egui.
const HANDLE_PART: f32 = 0.4;

impl SettingControls<'_, '_> {
    /// Draws the caption in its own row; if the setting has changed since the settings panel was
    /// opened, also its former value, `right_inset` points from the row's right edge. Returns the
    /// row's area.
    fn captioned_row_ui(&mut self, setting: &'static Setting, right_inset: f32) -> Rect {
        let width = self.ui.available_width();
        let (row, response) = self
            .ui
            .allocate_exact_size(vec2(width, ROW), Sense::hover());
        if response.contains_pointer() {
            *self.help = Some(setting_words(setting).help);
        }
        let caption = setting_words(setting).caption;
        let color = if self.state.previous_setting(setting).is_some() {
            self.palette.text
        } else {
            self.palette.dim_text
        };
        painted_text(self.ui, row, 0.0, caption, body(), color);
        if let Some(former_value) = self.was_text(setting) {
            let place = row.with_max_x(row.right() - right_inset);
            let dim = self.palette.dim_text;
            painted_text(self.ui, place, AT_RIGHT_END, &former_value, small(), dim);
        }
        row
    }

    /// Returns "was 1" if the setting has changed since the settings panel was opened.
    fn was_text(&self, setting: &'static Setting) -> Option<String> {
        let previous = self.state.previous_setting(setting)?;
        Some(format!("was {}", setting.text(previous)))
    }

    /// Draws a caption, and the choices as joined segments below; pointing at a segment explains
    /// it.
    pub fn segments_ui(&mut self, setting: &'static Setting) {
        let Kind::Choice { words: texts, .. } = setting.kind else {
            return;
        };
        let Value::Choice(chosen) = setting.value(&self.state.study.settings) else {
            return;
        };
        self.captioned_row_ui(setting, 0.0);
        let words = setting_words(setting);
        let size = vec2(self.ui.available_width(), SEGMENTS);
        let (frame, _) = self.ui.allocate_exact_size(size, Sense::hover());
        let palette = self.palette;
        let outline = Stroke::new(1.0, palette.line);
        let inside = StrokeKind::Inside;
        self.ui
            .painter()
            .rect(frame, 6.0, palette.background, outline, inside);
        let inner = frame.shrink(2.0);
        let width = inner.width() / texts.len() as f32;
        for (index, text) in texts.iter().enumerate() {
            let corner = inner.min + vec2(width * index as f32, 0.0);
            let place = Rect::from_min_size(corner, vec2(width, inner.height()));
            let id = self.ui.scope_id().with((words.label, index));
            let response = self.ui.interact(place, id, Sense::click());
            let is_chosen = index == chosen;
            if is_chosen || response.hovered() {
                self.ui.painter().rect_filled(place, 4.5, palette.raised);
            }
            if response.has_focus() {
                let focus = Stroke::new(1.0, palette.accent);
                self.ui.painter().rect_stroke(place, 4.5, focus, inside);
            }
            if response.contains_pointer() {
                *self.help = words.meanings.get(index).copied();
            }
            let color = if is_chosen {
                palette.text
            } else {
                palette.dim_text
            };
            let at = place.center();
            self.ui
                .painter()
                .text(at, Align2::CENTER_CENTER, text.option, body(), color);
            let name = format!("{}: {}", words.label, text.sentence);
            let response = named_switch(response, Role::RadioButton, is_chosen, name);
            if response.clicked() && !is_chosen {
                self.push_change(setting, Value::Choice(index));
                self.commands.push(StudyCommand::EndEdit.into());
            }
        }
    }

    /// Draws a number in a row with its caption and its value at the time the settings panel was
    /// opened, if that differs, and below a slider on which the former value is marked. Returns the
    /// slider rail's area; draws nothing and returns `None` unless the setting is a number.
    pub fn slider_ui(&mut self, setting: &'static Setting) -> Option<Rect> {
        let Kind::Number { range, .. } = setting.kind else {
            return None;
        };
        let Value::Number(present) = setting.value(&self.state.study.settings) else {
            return None;
        };
        let words = setting_words(setting);
        let field = NumberField {
            // A step changes the value by 1 %.
            step: 0.01 * present.max(0.01),
            width: TYPED_WIDTH,
            ..number_field(setting, words.label, range)
        };
        let row = self.captioned_row_ui(setting, TYPED_WIDTH + 8.0);
        let place = row.with_min_x(row.right() - TYPED_WIDTH);
        let typed = self
            .ui
            .scope_builder(UiBuilder::new().max_rect(place), |ui| field.ui(ui, present))
            .inner;
        let mut value = present;
        let slider = self.explained(words.help, |ui| {
            ui.spacing_mut().slider_width = ui.available_width();
            let slider = Slider::new(&mut value, 0.0..=SLIDER_END)
                .logarithmic(true)
                .smallest_positive(SLIDER_START)
                .show_value(false);
            ui.add(slider)
        });
        slider.widget_info(|| {
            WidgetInfo::labeled(Role::Slider, true, format!("{} slider", words.label))
        });
        let rail = slider
            .rect
            .shrink2(vec2(HANDLE_PART * slider.rect.height(), 0.0));
        if let Some(Value::Number(previous)) = self.state.previous_setting(setting) {
            let x = slider_place(rail, previous);
            let mark = Stroke::new(1.5, self.palette.text);
            let height = rail.y_range().shrink(0.15 * rail.height());
            self.ui.painter().vline(x, height, mark);
        }
        if slider.changed() {
            self.push_change(setting, value);
            if slider.dragged() {
                self.commands.push(StudyCommand::DragEdit.into());
            }
        }
        if slider.drag_stopped() || slider.lost_focus() {
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.apply_entry(setting, typed);
        Some(rail)
    }
}

/// Returns the horizontal position of a value on a slider rail, as egui's logarithmic slider places
/// its handle: zero and values below `SLIDER_START` are at the left end.
pub fn slider_place(rail: Rect, value: f64) -> f32 {
    let ends = [SLIDER_START.log10(), SLIDER_END.log10()];
    let log = value.max(SLIDER_START).log10().clamp(ends[0], ends[1]);
    let share = (log - ends[0]) / (ends[1] - ends[0]);
    rail.left() + share as f32 * rail.width()
}
