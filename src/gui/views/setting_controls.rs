//! Controls for the rows in the settings table, by kind of setting: flag, choice, number,
//! threshold. Settings that the program may determine are in `automatic_settings`, sliders and
//! segments in `captioned_settings`.
//!
//! A drag pushes a change in each frame; `StudyCommand::EndEdit` ends the undo step that they
//! share.
//!
//! A setting's value is in stored units, the control's in display units (`Setting::unit`). A
//! setting can also be *nothing*: a threshold is then off, and a value that the program may
//! determine is determined by it.

use egui::{ComboBox, RichText, Role, Ui};

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
use crate::gui::widgets::palette::Palette;

/// Explanation shown if the choice of G's source has no effect.
const IDLE_SOURCE: &str = "With leads, G is computed from the difference between the \
    representatives that remains after the leads";

/// Context for drawing setting controls; collects the commands for changed settings. The entry
/// points are [`Self::controls_ui`], [`Self::control_ui`], [`Self::segments_ui`] and
/// [`Self::slider_ui`].
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
    pub(super) fn push_change(&mut self, setting: &'static Setting, value: impl Into<Value>) {
        self.commands.push(setting.to(value).into());
    }

    /// Reports a refused entry, and ends the undo step when editing ends.
    pub(super) fn finish_entry(&mut self, entered: Entered) {
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

    pub(super) fn small_ui(&mut self, text: &str) {
        self.ui.label(self.palette.small(text));
    }

    /// Draws several settings in a line, each except the first with its caption in front.
    pub fn controls_ui(&mut self, settings: &[&'static Setting]) {
        for (index, setting) in settings.iter().enumerate() {
            if index > 0 && !setting_words(setting).caption.is_empty() {
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

    /// Draws the control that suits the kind of setting. An optional number that can be switched on
    /// (`on` is its initial value) is a threshold; the program determines any other optional
    /// number, unless it is set by hand.
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
            self.push_change(setting, flag);
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
            self.push_change(setting, Value::Choice(index));
        }
    }

    fn number_ui(&mut self, setting: &'static Setting, value: f64, range: [f64; 2]) {
        let field = number_field(setting, setting_words(setting).label, range);
        let help = setting_words(setting).help;
        let entered = self.explained(help, |ui| field.ui(ui, setting.unit.scale * value));
        self.apply_entry(setting, entered);
    }

    /// Applies a typed or dragged number, in display units.
    pub(super) fn apply_entry(&mut self, setting: &'static Setting, entered: Entered) {
        if let Some(value) = entered.value {
            self.push_change(setting, value / setting.unit.scale);
            if entered.is_dragged {
                self.commands.push(StudyCommand::DragEdit.into());
            }
        }
        self.finish_entry(entered);
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
            self.push_change(setting, threshold);
            // Each click is a separate undo step.
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.apply_entry(setting, entered);
    }
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
