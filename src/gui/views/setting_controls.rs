//! Controls for the rows of the settings table.

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
use crate::gui::widgets::controls::{Entered, NumberField, named_switch};
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

/// Returns the value that the program determines for an automatic setting; `None` without a result.
fn found_value(state: &State, setting: &Setting) -> Option<Value> {
    let shown = state.shown()?;
    if *setting == setting::GAIN_BOUNDS {
        Some(Value::from(Some(shown.gain_bounds())))
    } else if *setting == setting::DELAY_UPPER {
        Some(shown.delay_upper_s().into())
    } else {
        None
    }
}

/// Context for drawing the controls of settings; collects the commands for changed settings.
pub struct SettingControls<'a, 'c> {
    pub ui: &'a mut Ui,
    pub state: &'a State,
    pub palette: &'a Palette,
    pub commands: &'c mut Vec<Command>,
}

impl SettingControls<'_, '_> {
    fn set(&mut self, setting: &'static Setting, value: impl Into<Value>) {
        self.commands.push(setting.to(value).into());
    }

    /// Reports a refused entry, and ends the undo step when editing ends.
    fn end(&mut self, entered: Entered) {
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

    fn small_ui(&mut self, text: &str) {
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
    fn apply(&mut self, setting: &'static Setting, entered: Entered) {
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

    /// Draws a number that the program determines unless it is set by hand.
    fn automatic_number_ui(&mut self, setting: &'static Setting, value: Value, range: [f64; 2]) {
        let Some(Value::Number(number)) = self.shown_value(setting, value) else {
            return self.small_ui("…");
        };
        let field = number_field(setting, setting_words(setting).label, range);
        let typed = field.ui(self.ui, setting.unit.scale * number);
        let switched = self.automatic_ui(setting, value);
        if typed.value.is_none() {
            match switched {
                Some(Automatic::On) => self.set(setting, None::<f64>),
                Some(Automatic::Off) => self.set(setting, Some(number)),
                None => {}
            }
        }
        self.apply(setting, typed);
    }

    /// Returns a value set by hand, or else the value determined by the program.
    fn shown_value(&self, setting: &Setting, value: Value) -> Option<Value> {
        if value == Value::Nothing {
            found_value(self.state, setting)
        } else {
            Some(value)
        }
    }

    /// Draws both ends of a range. If the range is optional, the program determines it unless it is
    /// set by hand.
    fn range_ui(&mut self, setting: &'static Setting, value: Value) {
        let Kind::Range {
            range: [least, most],
            nothing,
            ..
        } = setting.kind
        else {
            return;
        };
        let Some(Value::Range([lower, upper])) = self.shown_value(setting, value) else {
            return self.small_ui("…");
        };
        let [low_name, high_name] = setting_words(setting).ends;
        let low = self.end_ui(setting, low_name, [least, upper], lower);
        self.small_ui("–");
        let high = self.end_ui(setting, high_name, [lower, most], upper);
        if !setting.unit.shown.is_empty() {
            self.small_ui(setting.unit.shown);
        }
        let mut switched = None;
        if nothing.is_some() {
            switched = self.automatic_ui(setting, value);
        }
        if low.value.is_some() || high.value.is_some() {
            let ends = Value::Range([low.value.unwrap_or(lower), high.value.unwrap_or(upper)]);
            match setting.check(ends) {
                Ok(()) => self.set(setting, ends),
                // A dragged end stops before the other end, without a message.
                Err(_) if low.is_dragged || high.is_dragged => {}
                Err(error) => self
                    .commands
                    .push(FormCommand::Refuse(error.to_string()).into()),
            }
        } else {
            match switched {
                Some(Automatic::On) => self.set(setting, Value::Nothing),
                Some(Automatic::Off) => self.set(setting, Value::Range([lower, upper])),
                None => {}
            }
        }
        self.end(low);
        self.end(high);
    }

    fn end_ui(
        &mut self,
        setting: &'static Setting,
        name: &'static str,
        limits: [f64; 2],
        value: f64,
    ) -> Entered {
        let field = NumberField {
            shows_unit: false,
            ..number_field(setting, name, limits)
        };
        field.ui(self.ui, value)
    }

    /// Draws the check box that lets the program determine a value; returns its new state after a
    /// click.
    fn automatic_ui(&mut self, setting: &Setting, value: Value) -> Option<Automatic> {
        let mut is_automatic = value == Value::Nothing;
        let response = self.ui.checkbox(&mut is_automatic, "auto");
        let name = format!("{} automatic", setting_words(setting).caption);
        let hint = "On: from the quantiles of each condition. Off: set by hand, the same for every condition";
        let response =
            named_switch(response, Role::CheckBox, is_automatic, name).on_hover_text(hint);
        if !response.changed() {
            return None;
        }
        Some(if is_automatic {
            Automatic::On
        } else {
            Automatic::Off
        })
    }
}

/// Whether the program determines a value.
#[derive(Clone, Copy)]
enum Automatic {
    On,
    Off,
}

/// Creates the number field of a setting in display units; the limits are in stored units.
fn number_field(
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
