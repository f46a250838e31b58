//! Controls for settings that the program determines unless they are set by hand, and for ranges,
//! which may be such settings. A setting's value is `Value::Nothing` where the program
//! determines it.

use egui::Role;

use gdcm_study::decisions::setting::{Kind, Setting};
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_value::Value;
use gdcm_words::setting_words::setting_words;

use super::setting_controls::{SettingControls, number_field};
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::named_switch;
use crate::gui::widgets::number_field::{Entered, NumberField};

/// Explanation on the "auto" check box.
const AUTOMATIC: &str = "On: from the quantiles of each condition. Off: set by hand, the same \
    for every condition";

/// Whether the program determines a value.
#[derive(Clone, Copy)]
enum Automatic {
    On,
    Off,
}

impl SettingControls<'_, '_> {
    /// Draws a number that the program determines unless it is set by hand, with its "auto" check
    /// box. Before there is a result, a value that the program determines is "…".
    ///
    /// A typed number takes precedence over a click on the box. Switching "auto" on removes the
    /// value set by hand; switching it off keeps the displayed value as set by hand.
    pub(super) fn automatic_number_ui(
        &mut self,
        setting: &'static Setting,
        value: Value,
        range: [f64; 2],
    ) {
        let Some(Value::Number(number)) = self.shown_value(setting, value) else {
            return self.small_ui("…");
        };
        let field = number_field(setting, setting_words(setting).label, range);
        let help = setting_words(setting).help;
        let typed = self.explained(help, |ui| field.ui(ui, setting.unit.scale * number));
        let switched = self.automatic_ui(setting, value);
        if typed.value.is_none() {
            match switched {
                Some(Automatic::On) => self.push_change(setting, None::<f64>),
                Some(Automatic::Off) => self.push_change(setting, Some(number)),
                None => {}
            }
        }
        self.apply_entry(setting, typed);
    }

    /// Returns a value set by hand, or else the value determined by the program.
    fn shown_value(&self, setting: &Setting, value: Value) -> Option<Value> {
        if value == Value::Nothing {
            determined_value(self.state, setting)
        } else {
            Some(value)
        }
    }

    /// Draws both range ends. The program determines a [`Kind::Range`], but not the band, unless it
    /// is set by hand.
    ///
    /// A typed or dragged end takes precedence over a click on "auto", which acts as in
    /// [`Self::automatic_number_ui`]. An invalid range is refused with a message if an end was
    /// typed, and ignored if it was dragged.
    pub(super) fn range_ui(&mut self, setting: &'static Setting, value: Value) {
        let Some([least, most]) = setting.kind.range() else {
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
        if matches!(setting.kind, Kind::Range { .. }) {
            switched = self.automatic_ui(setting, value);
        }
        if low.is_dragged || high.is_dragged {
            self.commands.push(StudyCommand::DragEdit.into());
        }
        if low.value.is_some() || high.value.is_some() {
            let ends = Value::Range([low.value.unwrap_or(lower), high.value.unwrap_or(upper)]);
            match setting.check(ends) {
                Ok(()) => self.push_change(setting, ends),
                // A dragged end stops before the other end, without a message.
                Err(_) if low.is_dragged || high.is_dragged => {}
                Err(error) => self.commands.push(FormCommand::Refuse(error.into()).into()),
            }
        } else {
            match switched {
                Some(Automatic::On) => self.push_change(setting, Value::Nothing),
                Some(Automatic::Off) => self.push_change(setting, Value::Range([lower, upper])),
                None => {}
            }
        }
        self.finish_entry(low);
        self.finish_entry(high);
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
        self.explained(setting_words(setting).help, |ui| field.ui(ui, value))
    }

    /// Draws the check box that lets the program determine a value; returns its new state after a
    /// click.
    fn automatic_ui(&mut self, setting: &Setting, value: Value) -> Option<Automatic> {
        let mut is_automatic = value == Value::Nothing;
        let response = self.explained(AUTOMATIC, |ui| ui.checkbox(&mut is_automatic, "auto"));
        let name = format!("{} automatic", setting_words(setting).caption);
        let response = named_switch(response, Role::CheckBox, is_automatic, name);
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

/// Returns the value that the program determines for an automatic setting; `None` without a result.
fn determined_value(state: &State, setting: &Setting) -> Option<Value> {
    let shown = state.shown()?;
    if *setting == setting_table::GAIN_BOUNDS {
        Some(Value::from(Some(shown.gain_bounds())))
    } else if *setting == setting_table::DELAY_UPPER {
        Some(shown.delay_upper_s().into())
    } else {
        None
    }
}
