//! Controls for the rows of the settings table, by kind of setting: flag, choice, number, slider,
//! threshold. Settings that the program may determine are in `automatic_settings`.
//!
//! A drag pushes a change in each frame; `StudyCommand::EndEdit` ends the undo step that they
//! share.

use egui::{Role, Slider, Ui, WidgetInfo};

use gdcm_method::correction::delta::GainSource;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting_row::{Kind, Setting, Value};
use gdcm_words::setting_words::setting_words;

use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::controls::named_switch;
use crate::gui::widgets::number_field::{Entered, NumberField};
use crate::gui::widgets::palette::Palette;

/// Maximum value on a slider; larger values can be typed.
const SLIDER_END: f64 = 1e3;
/// Value below which a slider snaps to zero.
const SLIDER_START: f64 = 1e-3;

const LABEL_WIDTH: f32 = 60.0;
const TYPED_WIDTH: f32 = 62.0;

/// Tooltip of the phase correction: summary of its method (M15) in five steps.
const LEADS_IN_SHORT: &str = "Delay or lead:\n\
    1  For each response, a straight line through the origin is fitted to the missing phase over the band. Its slope is a delay or, \
    if negative, a lead.\n\
    2  Each channel gets one signed delay τ, so that every held response gets exactly the delay or lead of its line.\n\
    3  A positive τ is a pure delay. A negative τ is a filter that replaces a slow servo or sensor by a faster one.\n\
    4  The gains are then computed as without leads, for the remaining error.\n\
    5  The price is gain above the band [dB].";

/// Context for drawing the controls of settings; collects the commands for changed settings. The
/// entry points are [`Self::controls_ui`], [`Self::control_ui`] and [`Self::slider_ui`].
pub struct SettingControls<'a, 'c> {
    pub ui: &'a mut Ui,
    pub state: &'a State,
    pub palette: &'a Palette,
    pub commands: &'c mut Vec<Command>,
}

impl SettingControls<'_, '_> {
    /// Pushes the command that changes a setting.
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

    /// Draws the caption; for the phase correction, with a summary as tooltip.
    pub fn caption_ui(&mut self, setting: &Setting) {
        let label = self
            .ui
            .label(self.palette.dim(setting_words(setting).caption));
        if *setting == setting::PHASE {
            label.on_hover_text(LEADS_IN_SHORT);
        }
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

    /// Draws the note beside a setting's value.
    pub fn note_ui(&mut self, setting: &Setting) {
        let settings = &self.state.study.settings;
        let is_idle = settings.gain_source == GainSource::MeanOfPairs
            && settings.phase == PhaseCorrection::Lead;
        if *setting == setting::GAIN_SOURCE && is_idle {
            self.ui.label("");
            let text = self.palette.small_warning("No effect with leads");
            self.ui
                .label(text)
                .on_hover_text(format!("G from {}", settings.gain_source_words()));
            self.ui.end_row();
        }
    }

    /// Draws the control that suits the kind of setting.
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
            (Kind::Range { .. }, value) => self.range_ui(setting, value),
            (Kind::Flag { .. }, Value::Flag(flag)) => self.flag_ui(setting, flag),
            (Kind::Choice { words, .. }, Value::Choice(index)) => {
                let mut chosen = index;
                let mut choices = Vec::new();
                let meanings = setting_words(setting).meanings;
                for (index, ([_, text], hint)) in words.iter().zip(meanings).enumerate() {
                    choices.push((index, *text, *hint));
                }
                choice_ui(self.ui, setting_words(setting).label, &mut chosen, &choices);
                if chosen != index {
                    self.set(setting, Value::Choice(chosen));
                }
            }
            _ => {}
        }
    }

    fn flag_ui(&mut self, setting: &'static Setting, mut flag: bool) {
        let response = self.ui.checkbox(&mut flag, setting_words(setting).label);
        if response
            .on_hover_text(setting_words(setting).help)
            .changed()
        {
            self.set(setting, flag);
        }
    }

    fn number_ui(&mut self, setting: &'static Setting, value: f64, range: [f64; 2]) {
        let field = number_field(setting, setting_words(setting).label, range);
        let entered = field.ui(self.ui, setting.unit.scale * value);
        self.apply(setting, entered);
    }

    /// Applies a typed or dragged number, in display units.
    pub(super) fn apply(&mut self, setting: &'static Setting, entered: Entered) {
        if let Some(value) = entered.value {
            self.set(setting, value / setting.unit.scale);
        }
        self.end(entered);
    }

    /// Draws a number on a slider, with a field beside it.
    pub fn slider_ui(&mut self, setting: &'static Setting) {
        let Kind::Number { range, .. } = setting.kind else {
            return;
        };
        let Value::Number(now) = setting.value(&self.state.study.settings) else {
            return;
        };
        let mut value = now;
        let label = setting_words(setting).label;
        let field = NumberField {
            step: 0.01 * now.max(0.01),
            width: TYPED_WIDTH,
            ..number_field(setting, label, range)
        };
        let (slider, typed) = self
            .ui
            .horizontal(|ui| {
                let caption = ui.label(self.palette.dim(setting_words(setting).caption));
                ui.add_space((LABEL_WIDTH - caption.rect.width()).max(0.0));
                let gap = ui.spacing().item_spacing.x;
                ui.spacing_mut().slider_width =
                    (ui.available_width() - TYPED_WIDTH - 2.0 * gap).max(60.0);
                let slider = Slider::new(&mut value, 0.0..=SLIDER_END)
                    .logarithmic(true)
                    .smallest_positive(SLIDER_START)
                    .show_value(false);
                let slider = ui.add(slider);
                slider.widget_info(|| {
                    WidgetInfo::labeled(Role::Slider, true, format!("{label} slider"))
                });
                (slider, field.ui(ui, now))
            })
            .inner;
        if slider.changed() {
            self.set(setting, value);
        }
        if slider.drag_stopped() || slider.lost_focus() {
            self.commands.push(StudyCommand::EndEdit.into());
        }
        slider.on_hover_text(setting_words(setting).help);
        self.apply(setting, typed);
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
        let mut counts = value != Value::Nothing;
        let response = self.ui.checkbox(&mut counts, "from");
        let response = named_switch(
            response,
            Role::CheckBox,
            counts,
            format!("{} counts", setting_words(setting).caption),
        );
        let clicked = response
            .on_hover_text(setting_words(setting).help)
            .changed();
        let shown = match value {
            Value::Number(value) => value,
            _ => initial,
        };
        let field = number_field(setting, setting_words(setting).label, range);
        let entered = self
            .ui
            .add_enabled_ui(counts, |ui| field.ui(ui, shown))
            .inner;
        if clicked {
            let enabled = if counts { Some(initial) } else { None };
            self.set(setting, enabled);
            // Each click is a separate undo step.
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.apply(setting, entered);
    }
}

/// Creates the number field of a setting in display units; the limits are in stored units.
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
        ..NumberField::new(
            name,
            setting_words(setting).help,
            setting.unit.scale * least..=setting.unit.scale * most,
        )
    }
}
