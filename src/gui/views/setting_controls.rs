//! Controls for the rows in the settings table, by kind of setting: flag, choice, number, slider,
//! threshold. Settings that the program may determine are in `automatic_settings`.
//!
//! A drag pushes a change in each frame; `StudyCommand::EndEdit` ends the undo step that they
//! share.
//!
//! A setting's value is in stored units, the control's in display units (`Setting::unit`). A
//! setting can also be *nothing*: a threshold is then off, and a value that the program may
//! determine is determined by it.

use egui::{
    Align2, ComboBox, Rect, RichText, Role, Sense, Slider, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, vec2,
};

use gdcm_study::decisions::setting::{Kind, Setting, Words};
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_value::Value;
use gdcm_words::setting_words::setting_words;

use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{named, named_switch};
use crate::gui::widgets::number_field::{Entered, NumberField};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{Palette, body, small};

/// Maximum value on a slider; larger values can be typed.
pub const SLIDER_END: f64 = 1e3;
/// Value below which a slider snaps to zero.
pub const SLIDER_START: f64 = 1e-3;

/// Width of a typed number beside a caption \[pt\].
const TYPED_WIDTH: f32 = 54.0;
/// Explanation shown if the choice of G's source has no effect.
const IDLE_SOURCE: &str = "With leads, G is computed from the difference between the representatives that \
    remains after the leads";

/// Height of a row with a caption \[pt\].
const ROW: f32 = 20.0;
/// Height of a segmented control \[pt\].
const SEGMENTS: f32 = 24.0;
/// Slider handle radius relative to the slider height, as in egui.
const HANDLE_PART: f32 = 0.4;

/// Context for drawing setting controls; collects the commands for changed settings. The entry
/// points are [`Self::controls_ui`], [`Self::control_ui`] and [`Self::slider_ui`].
pub struct SettingControls<'a, 'c> {
    pub ui: &'a mut Ui,
    pub state: &'a State,
    pub palette: &'a Palette,
    pub commands: &'c mut Vec<Command>,
    /// Receives the explanation for the control under the pointer.
    pub help: &'c mut Option<&'static str>,
}

impl SettingControls<'_, '_> {
    /// Pushes the command that changes a setting to a value in stored units.
    pub(super) fn set(&mut self, setting: &'static Setting, value: impl Into<Value>) {
        self.commands.push(setting.to(value).into());
    }

    /// Reports a refused entry, and ends the undo step when editing ends.
    pub(super) fn end(&mut self, entered: Entered) {
        if let Some(refusal) = entered.refusal {
            self.commands.push(FormCommand::Refuse(refusal).into());
        }
        if entered.is_ended {
            self.commands.push(StudyCommand::EndEdit.into());
        }
    }

    /// Draws a part of the panel; while the pointer is on that part, the panel shows `explanation`.
    pub(super) fn explained<T>(
        &mut self,
        explanation: &'static str,
        add: impl FnOnce(&mut Ui) -> T,
    ) -> T {
        let shown = self.ui.scope(add);
        if self.ui.rect_contains_pointer(shown.response.rect) {
            *self.help = Some(explanation);
        }
        shown.inner
    }

    /// Draws the caption, in the text colour if the setting has changed since the settings panel
    /// was opened, otherwise dim.
    pub fn caption_ui(&mut self, setting: &'static Setting) {
        let words = setting_words(setting);
        let text = self.caption(setting);
        self.explained(words.help, |ui| ui.label(text));
    }

    fn caption(&self, setting: &'static Setting) -> RichText {
        let caption = setting_words(setting).caption;
        if self.state.previous_setting(setting).is_some() {
            RichText::new(caption)
        } else {
            self.palette.dim(caption)
        }
    }

    /// Draws the caption in its own row; if the setting has changed since the settings panel was
    /// opened, also its former value, `end` points from the right. Returns the row's area.
    fn captioned_row_ui(&mut self, setting: &'static Setting, end: f32) -> Rect {
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
        if let Some(was) = self.was_text(setting) {
            let place = row.with_max_x(row.right() - end);
            let dim = self.palette.dim_text;
            painted_text(self.ui, place, AT_RIGHT_END, &was, small(), dim);
        }
        row
    }

    /// Returns "was 1" if the setting has changed since the settings panel was opened.
    fn was_text(&self, setting: &'static Setting) -> Option<String> {
        let previous = self.state.previous_setting(setting)?;
        Some(format!("was {}", setting.text(previous)))
    }

    pub(super) fn small_ui(&mut self, text: &str) {
        self.ui.label(self.palette.small(text));
    }

    /// Draws several settings in a line, each except the first with its caption in front.
    pub fn controls_ui(&mut self, line: &[&'static Setting]) {
        for (place, setting) in line.iter().enumerate() {
            if place > 0 && !setting_words(setting).caption.is_empty() {
                self.small_ui(setting_words(setting).caption);
            }
            self.control_ui(setting);
        }
    }

    /// Draws a grid row with a note if the setting has no effect at present: the gain source with
    /// leads.
    pub fn note_ui(&mut self, setting: &Setting) {
        let is_idle = self.state.study.settings.is_gain_source_idle();
        if *setting == setting_table::GAIN_SOURCE && is_idle {
            self.ui.label("");
            let text = self.palette.small_warning("No effect with leads");
            self.explained(IDLE_SOURCE, |ui| ui.label(text));
            self.ui.end_row();
        }
    }

    /// Draws the control that suits the kind of setting. An optional number with an initial value
    /// (`on`) is a threshold that can be switched off; without one, the program determines the
    /// number unless it is set by hand.
    pub fn control_ui(&mut self, setting: &'static Setting) {
        let value = setting.value(&self.state.study.settings);
        match (setting.kind, value) {
            (Kind::Number { range, .. }, Value::Number(value)) => {
                self.number_ui(setting, value, range);
            }
            (Kind::Optional { range, on, .. }, value) => match on {
                Some(initial) => self.threshold_ui(setting, value, initial, range),
                None => self.automatic_number_ui(setting, value, range),
            },
            (Kind::Range { .. } | Kind::Band { .. }, value) => self.range_ui(setting, value),
            (Kind::Flag { .. }, Value::Flag(flag)) => self.flag_ui(setting, flag),
            (Kind::Choice { words, .. }, Value::Choice(index)) => {
                self.list_ui(setting, index, words);
            }
            _ => {}
        }
    }

    fn flag_ui(&mut self, setting: &'static Setting, mut flag: bool) {
        let words = setting_words(setting);
        let response = self.explained(words.help, |ui| ui.checkbox(&mut flag, words.label));
        if response.changed() {
            self.set(setting, flag);
        }
    }

    /// Draws the choices in a list; pointing at a choice explains it.
    fn list_ui(&mut self, setting: &'static Setting, chosen: usize, texts: &[Words]) {
        let words = setting_words(setting);
        let mut clicked = None;
        let mut pointed = None;
        let current = match texts.get(chosen) {
            Some(text) => text.sentence,
            None => "…",
        };
        self.explained(words.help, |ui| {
            let list = ComboBox::from_id_salt(words.label)
                .selected_text(current)
                .width(60.0)
                .show_ui(ui, |ui| {
                    for (index, text) in texts.iter().enumerate() {
                        let entry = ui.selectable_label(index == chosen, text.sentence);
                        if entry.hovered() {
                            pointed = words.meanings.get(index).copied();
                        }
                        if entry.clicked() {
                            clicked = Some(index);
                        }
                    }
                });
            named(list.response, Role::ComboBox, words.label);
        });
        if pointed.is_some() {
            *self.help = pointed;
        }
        if let Some(index) = clicked
            && index != chosen
        {
            self.set(setting, Value::Choice(index));
        }
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
                self.set(setting, Value::Choice(index));
                self.commands.push(StudyCommand::EndEdit.into());
            }
        }
    }

    fn number_ui(&mut self, setting: &'static Setting, value: f64, range: [f64; 2]) {
        let field = number_field(setting, setting_words(setting).label, range);
        let help = setting_words(setting).help;
        let entered = self.explained(help, |ui| field.ui(ui, setting.unit.scale * value));
        self.apply(setting, entered);
    }

    /// Applies a typed or dragged number, in display units.
    pub(super) fn apply(&mut self, setting: &'static Setting, entered: Entered) {
        if let Some(value) = entered.value {
            self.set(setting, value / setting.unit.scale);
            if entered.is_dragged {
                self.commands.push(StudyCommand::DragEdit.into());
            }
        }
        self.end(entered);
    }

    /// Draws a number in a row with its caption and its value at the time the settings panel was
    /// opened, if that differs, and below a slider on which the former value is marked. Returns the
    /// slider rail's area; draws nothing and returns `None` unless the setting is a number.
    pub fn slider_ui(&mut self, setting: &'static Setting) -> Option<Rect> {
        let Kind::Number { range, .. } = setting.kind else {
            return None;
        };
        let Value::Number(now) = setting.value(&self.state.study.settings) else {
            return None;
        };
        let words = setting_words(setting);
        let field = NumberField {
            step: 0.01 * now.max(0.01),
            width: TYPED_WIDTH,
            ..number_field(setting, words.label, range)
        };
        let row = self.captioned_row_ui(setting, TYPED_WIDTH + 8.0);
        let place = row.with_min_x(row.right() - TYPED_WIDTH);
        let typed = self
            .ui
            .scope_builder(UiBuilder::new().max_rect(place), |ui| field.ui(ui, now))
            .inner;
        let mut value = now;
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
            self.set(setting, value);
            if slider.dragged() {
                self.commands.push(StudyCommand::DragEdit.into());
            }
        }
        if slider.drag_stopped() || slider.lost_focus() {
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.apply(setting, typed);
        Some(rail)
    }

    /// Draws a check box that enables a threshold, and a field for the threshold; `initial` is its
    /// value when it is enabled.
    fn threshold_ui(
        &mut self,
        setting: &'static Setting,
        value: Value,
        initial: f64,
        range: [f64; 2],
    ) {
        let mut is_enabled = value != Value::Nothing;
        let words = setting_words(setting);
        let response = self.explained(words.help, |ui| ui.checkbox(&mut is_enabled, "from"));
        let name = format!("{} counts", words.caption);
        let clicked = named_switch(response, Role::CheckBox, is_enabled, name).changed();
        let shown = match value {
            Value::Number(value) => value,
            _ => initial,
        };
        let field = number_field(setting, setting_words(setting).label, range);
        let entered = self.explained(words.help, |ui| {
            ui.add_enabled_ui(is_enabled, |ui| field.ui(ui, shown))
                .inner
        });
        if clicked {
            let threshold = if is_enabled { Some(initial) } else { None };
            self.set(setting, threshold);
            // Each click is a separate undo step.
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.apply(setting, entered);
    }
}

/// Returns the horizontal position of a value on a slider rail, as egui's logarithmic slider places
/// its handle: zero and values below [`SLIDER_START`] are at the left end.
pub fn slider_place(rail: Rect, value: f64) -> f32 {
    let ends = [SLIDER_START.log10(), SLIDER_END.log10()];
    let log = value.max(SLIDER_START).log10().clamp(ends[0], ends[1]);
    let share = (log - ends[0]) / (ends[1] - ends[0]);
    rail.left() + share as f32 * rail.width()
}

/// Creates a setting's number field in display units; the limits are in stored units.
pub(super) fn number_field(
    setting: &'static Setting,
    name: &'static str,
    [least, most]: [f64; 2],
) -> NumberField<'static> {
    let is_whole = matches!(setting.kind, Kind::Number { whole: true, .. });
    NumberField {
        unit: setting.unit.shown,
        shows_unit: !setting.unit.shown.is_empty(),
        is_whole,
        step: setting.control.step,
        digits: setting.control.digits,
        // The panel shows the explanation itself.
        ..NumberField::new(
            name,
            "",
            setting.unit.scale * least..=setting.unit.scale * most,
        )
    }
}
