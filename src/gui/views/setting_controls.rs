//! A control for each row of the settings table.

use egui::{Role, Slider, Ui, WidgetInfo};

use gdcm_method::correction::delta::GainSource;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting_row::{Kind, Setting, Value};

use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::controls::{Entered, NumberField, named_switch};
use crate::gui::widgets::palette::Palette;

/// Largest value on a slider; larger values can be typed.
const SLIDER_END: f64 = 1e3;
/// Value below which a slider snaps to zero.
const SLIDER_START: f64 = 1e-3;

const LABEL_WIDTH: f32 = 60.0;
const TYPED_WIDTH: f32 = 62.0;

/// Summary of M15 in five lines.
const LEADS_IN_SHORT: &str = "Delay or lead:\n\
    1  For each response, one straight line through the origin is fitted to the phase that is missing over the band: its slope is \
    a delay or, where negative, a lead.\n\
    2  Each channel gets one signed delay τ, so that the held responses get exactly theirs.\n\
    3  A positive τ is a pure delay; a negative τ is a filter that acts as a faster servo or sensor put in place of a slower one.\n\
    4  Then the gains are found as before, on what is left.\n\
    5  The price is gain above the band: it is told in dB.";

/// Draws the control of a setting inside the view it concerns.
pub fn setting_ui(
    ui: &mut Ui,
    state: &State,
    setting: &'static Setting,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    SettingControls {
        ui,
        state,
        palette,
        commands,
    }
    .control_ui(setting);
}

/// Returns the value determined by the program for an automatic setting.
fn found_value(state: &State, setting: &Setting) -> Option<Value> {
    let shown = state.shown()?;
    if *setting == setting::GAIN_BOUNDS {
        Some(Some(shown.gain_bounds()).into())
    } else if *setting == setting::DELAY_UPPER {
        Some(shown.delay_upper_s().into())
    } else {
        None
    }
}

/// Draws the controls of settings, and pushes the decisions taken with them.
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

    /// Reports why an entry is refused, and completes the decision.
    fn end(&mut self, entered: Entered) {
        self.commands.extend(
            entered
                .refusal
                .map(|value| Command::Form(FormCommand::Refuse(value))),
        );
        if entered.is_ended {
            self.commands.push(StudyCommand::EndEdit.into());
        }
    }

    pub fn caption_ui(&mut self, setting: &Setting) {
        let label = self.ui.label(self.palette.dim(setting.control.caption));
        if *setting == setting::PHASE {
            label.on_hover_text(LEADS_IN_SHORT);
        }
    }

    fn small_ui(&mut self, text: &str) {
        self.ui.label(self.palette.small(text));
    }

    pub fn controls_ui(&mut self, line: &[&'static Setting]) {
        for (place, setting) in line.iter().enumerate() {
            if place > 0 && !setting.control.caption.is_empty() {
                self.small_ui(setting.control.caption);
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

    pub fn control_ui(&mut self, setting: &'static Setting) {
        match (setting.kind, setting.value(&self.state.study.settings)) {
            (Kind::Number { range, .. }, Value::Number(value)) => {
                self.number_ui(setting, value, range)
            }
            (
                Kind::Optional {
                    range,
                    on: Some(on),
                    ..
                },
                value,
            ) => self.threshold_ui(setting, value, on, range),
            (Kind::Optional { range, .. }, value) => {
                self.automatic_number_ui(setting, value, range)
            }
            (
                Kind::Range {
                    range,
                    ends,
                    nothing,
                    ..
                },
                value,
            ) => {
                self.range_ui(setting, value, ends, range, nothing.is_some());
            }
            (Kind::Flag { .. }, Value::Flag(mut flag)) => {
                let response = self.ui.checkbox(&mut flag, setting.control.label);
                if response.on_hover_text(setting.help).changed() {
                    self.set(setting, flag);
                }
            }
            (Kind::Choice { words, .. }, Value::Choice(index)) => {
                let mut chosen = index;
                let choices: Vec<_> = (0..words.len())
                    .map(|index| (index, words[index][1], words[index][2]))
                    .collect();
                choice_ui(self.ui, setting.control.label, &mut chosen, &choices);
                if chosen != index {
                    self.set(setting, Value::Choice(chosen));
                }
            }
            _ => {}
        }
    }

    fn number_ui(&mut self, setting: &'static Setting, value: f64, range: [f64; 2]) {
        let field = field_of(setting, setting.control.label, range);
        let entered = field.ui(self.ui, setting.unit.scale * value);
        self.take(setting, entered);
    }

    fn take(&mut self, setting: &'static Setting, entered: Entered) {
        if let Some(value) = entered.value {
            self.set(setting, value / setting.unit.scale);
        }
        self.end(entered);
    }

    /// Draws a number on a slider, with a field beside it.
    pub fn slider_ui(&mut self, setting: &'static Setting) {
        let (Kind::Number { range, .. }, Value::Number(now)) =
            (setting.kind, setting.value(&self.state.study.settings))
        else {
            return;
        };
        let mut value = now;
        let label = setting.control.label;
        let field = NumberField {
            step: 0.01 * now.max(0.01),
            width: TYPED_WIDTH,
            ..field_of(setting, label, range)
        };
        let (slider, typed) = self
            .ui
            .horizontal(|ui| {
                let caption = ui.label(self.palette.dim(setting.control.caption));
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
        slider.on_hover_text(setting.help);
        self.take(setting, typed);
    }

    /// Draws a box that enables a threshold, and the threshold; `on` is its initial value.
    fn threshold_ui(&mut self, setting: &'static Setting, value: Value, on: f64, range: [f64; 2]) {
        let mut counts = value != Value::Nothing;
        let response = self.ui.checkbox(&mut counts, "from");
        let response = named_switch(
            response,
            Role::CheckBox,
            counts,
            format!("{} counts", setting.control.caption),
        );
        let clicked = response.on_hover_text(setting.help).changed();
        let shown = if let Value::Number(value) = value {
            value
        } else {
            on
        };
        let field = field_of(setting, setting.control.label, range);
        let entered = self
            .ui
            .add_enabled_ui(counts, |ui| field.ui(ui, shown))
            .inner;
        if clicked {
            self.set(setting, counts.then_some(on));
            // Two clicks are two decisions.
            self.commands.push(StudyCommand::EndEdit.into());
        }
        self.take(setting, entered);
    }

    /// Draws a number that the program determines unless it is set by hand.
    fn automatic_number_ui(&mut self, setting: &'static Setting, value: Value, range: [f64; 2]) {
        let by_hand = value != Value::Nothing;
        let shown = if by_hand {
            Some(value)
        } else {
            found_value(self.state, setting)
        };
        let Some(Value::Number(number)) = shown else {
            return self.small_ui("…");
        };
        let field = field_of(setting, setting.control.label, range);
        let typed = field.ui(self.ui, setting.unit.scale * number);
        let automatic = self.automatic_ui(setting, by_hand);
        if let Some(automatic) = automatic.filter(|_| typed.value.is_none()) {
            self.set(setting, (!automatic).then_some(number));
        }
        self.take(setting, typed);
    }

    /// Draws both ends of a range, which the program determines, where it can, unless they are set
    /// by hand.
    fn range_ui(
        &mut self,
        setting: &'static Setting,
        value: Value,
        [low_name, high_name]: [&'static str; 2],
        [least, most]: [f64; 2],
        is_optional: bool,
    ) {
        let by_hand = value != Value::Nothing;
        let shown = if by_hand {
            Some(value)
        } else {
            found_value(self.state, setting)
        };
        let Some(Value::Range([lower, upper])) = shown else {
            return self.small_ui("…");
        };
        let low = NumberField {
            shows_unit: false,
            ..field_of(setting, low_name, [least, upper])
        }
        .ui(self.ui, lower);
        self.small_ui("–");
        let high = NumberField {
            shows_unit: false,
            ..field_of(setting, high_name, [lower, most])
        }
        .ui(self.ui, upper);
        if !setting.unit.shown.is_empty() {
            self.small_ui(setting.unit.shown);
        }
        let automatic = if is_optional {
            self.automatic_ui(setting, by_hand)
        } else {
            None
        };
        if low.value.is_some() || high.value.is_some() {
            let ends = Value::Range([low.value.unwrap_or(lower), high.value.unwrap_or(upper)]);
            match setting.check(ends) {
                Ok(()) => self.set(setting, ends),
                // A dragged end stops before the other end.
                Err(_) if low.is_dragged || high.is_dragged => {}
                Err(error) => self
                    .commands
                    .push(FormCommand::Refuse(error.to_string()).into()),
            }
        } else if let Some(automatic) = automatic {
            self.set(
                setting,
                if automatic {
                    Value::Nothing
                } else {
                    Value::Range([lower, upper])
                },
            );
        }
        self.end(low);
        self.end(high);
    }

    /// Draws the box that returns a value to the program; returns its new state after a click.
    fn automatic_ui(&mut self, setting: &Setting, by_hand: bool) -> Option<bool> {
        let mut automatic = !by_hand;
        let response = self.ui.checkbox(&mut automatic, "auto");
        let name = format!("{} automatic", setting.control.caption);
        let hint =
            "From the quantiles of each condition; off: set by hand, the same for every condition";
        let response = named_switch(response, Role::CheckBox, automatic, name).on_hover_text(hint);
        response.changed().then_some(automatic)
    }
}

/// Creates the number field of a setting, in display units.
fn field_of(
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
            setting.help,
            setting.unit.scale * least..=setting.unit.scale * most,
        )
    }
}
