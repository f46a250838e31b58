//! Numeric field that can be dragged and typed into, with unit, limits and accessible name.
//!
//! egui's [`DragValue`] draws the field. This file adds messages about refused entries, and
//! restores the old value after Escape.
//!
//! [`Digits`] says how many digits of the number are shown.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::{Context, DragValue, Id, Key, Response, Role, Ui, WidgetInfo, vec2};

use gdcm_model::number_format::{gain_text, number, significant};
use gdcm_study::decisions::setting::Digits;

use super::controls::hint_ui;
use crate::message::Message;

/// Number field height \[pt\].
const FIELD_HEIGHT: f32 = 18.0;
/// Number of egui passes after Escape in which the typed text must not be committed. egui reports a
/// lost focus in two passes, but the key only in the first: in the second, [`DragValue`] would
/// commit the text that Escape has discarded.
const PASSES_AFTER_ESCAPE: u64 = 2;

/// Numeric input with unit, limits and accessible name.
pub struct NumberField<'a> {
    /// Accessible name, unique in the window.
    pub name: &'a str,
    /// Tooltip: meaning and unit; empty for none.
    pub hint: &'a str,
    /// Unit; empty if dimensionless.
    pub unit: &'static str,
    /// Whether the unit is shown after the number.
    pub shows_unit: bool,
    pub range: RangeInclusive<f64>,
    pub is_whole: bool,
    /// Change per point dragged and per arrow key press.
    pub step: f64,
    /// Minimum width \[pt\]; 0 to fit the text.
    pub width: f32,
    pub digits: Digits,
}

/// Outcome of editing a field in this frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entered {
    /// New number; `None` if the number is unchanged or the entry is refused.
    pub value: Option<f64>,
    /// Reason why the entry is refused.
    pub refusal: Option<Message>,
    /// Whether the number is being dragged and may still change.
    pub is_dragged: bool,
    /// Whether the edit is complete: the pointer was released or the focus left the field.
    pub is_ended: bool,
}

impl<'a> NumberField<'a> {
    /// Creates a field for any dimensionless number in the range, as wide as its text.
    pub fn new(name: &'a str, hint: &'a str, range: RangeInclusive<f64>) -> Self {
        Self {
            name,
            hint,
            unit: "",
            shows_unit: false,
            range,
            is_whole: false,
            step: 0.01,
            width: 0.0,
            digits: Digits::Significant,
        }
    }

    /// Draws the field with `value`. Dragging stays within the range; a typed number is committed
    /// by Enter or when the focus leaves, and Escape restores the old value.
    pub fn ui(&self, ui: &mut Ui, value: f64) -> Entered {
        let is_escaped = self.is_escaped(ui);
        // The parser is a shared closure, so the text that it cannot parse leaves it in a cell.
        let unparsed = RefCell::new(None);
        let mut edited = value;
        let mut field = DragValue::new(&mut edited)
            .update_while_editing(false)
            .speed(self.step)
            .custom_formatter(|value, _| number_text(self.digits, value))
            .custom_parser(|text| {
                if is_escaped {
                    return None;
                }
                let number = self.parse(text, value);
                if number.is_none() {
                    *unparsed.borrow_mut() = Some(text.trim().to_owned());
                }
                number
            });
        if self.shows_unit {
            field = field.suffix(format!(" {}", self.unit));
        }
        let response = if self.width > 0.0 {
            ui.add_sized(vec2(self.width, FIELD_HEIGHT), field)
        } else {
            ui.add(field)
        };
        let enabled = response.enabled();
        response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, enabled, self.name));
        self.note_escape(ui, &response);
        remember_field(ui, self.name, response.id);
        let outcome = self.outcome(value, edited, unparsed.into_inner(), &response);
        hint_ui(response, self.hint);
        outcome
    }

    /// Key in egui's memory for the pass in which Escape last ended editing.
    fn escape_key(&self) -> Id {
        Id::unique(("escaped", self.name))
    }

    /// Records the pass in which Escape ends editing.
    fn note_escape(&self, ui: &Ui, response: &Response) {
        if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
            let pass = ui.ctx().cumulative_pass_nr();
            ui.data_mut(|data| data.insert_temp(self.escape_key(), pass));
        }
    }

    /// Returns whether Escape has just ended editing; see [`PASSES_AFTER_ESCAPE`].
    fn is_escaped(&self, ui: &Ui) -> bool {
        let pass = ui.ctx().cumulative_pass_nr();
        let escaped = ui.data(|data| data.get_temp::<u64>(self.escape_key()));
        escaped.is_some_and(|escaped| pass - escaped <= PASSES_AFTER_ESCAPE)
    }

    /// Parses the typed number; an unedited text returns the exact old value, which the text may
    /// round.
    fn parse(&self, text: &str, value: f64) -> Option<f64> {
        if text == number_text(self.digits, value) {
            return Some(value);
        }
        number_in(text, self.unit)
    }

    /// Accepts or refuses the number `after`, which replaces `before`; `unparsed` is a typed text
    /// that is not a number.
    ///
    /// 1. A dragged number stays within the range, and need not be whole before the pointer is
    ///    released.
    /// 2. A number that differs from `before` and is allowed is the new value.
    /// 3. Refused are first a text that is not a number, else a different number that is out of
    ///    range or should be whole.
    fn outcome(
        &self,
        before: f64,
        after: f64,
        unparsed: Option<String>,
        response: &Response,
    ) -> Entered {
        // Step 1.
        let is_dragged = response.dragged();
        let after = if is_dragged {
            after.clamp(*self.range.start(), *self.range.end())
        } else {
            after
        };
        let has_allowed_digits = !self.is_whole || after.fract() == 0.0 || is_dragged;
        let is_allowed = self.range.contains(&after) && has_allowed_digits;
        let mut outcome = Entered {
            value: None,
            refusal: None,
            is_dragged,
            is_ended: response.drag_stopped() || response.lost_focus(),
        };
        // Step 2.
        if after != before && is_allowed {
            outcome.value = Some(after);
        }
        // Step 3.
        if let Some(text) = unparsed {
            let text = self.refusal(&format!("\"{text}\""), before);
            outcome.refusal = Some(Message::new("not-a-number", text));
        } else if after != before && !is_allowed {
            let code = if has_allowed_digits {
                "out-of-range"
            } else {
                "not-a-whole-number"
            };
            let text = self.refusal(&number(after), before);
            outcome.refusal = Some(Message::new(code, text));
        }
        outcome
    }

    /// Returns the refusal, for example "Band from: expected a number from 0.0001 to 12 rad/s,
    /// found 30; 0.500 rad/s is kept."
    fn refusal(&self, found: &str, before: f64) -> String {
        let kind = if self.is_whole {
            "a whole number"
        } else {
            "a number"
        };
        let least = number(*self.range.start());
        let most = number(*self.range.end());
        let unit = if self.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", self.unit)
        };
        let stays = number_text(self.digits, before);
        format!(
            "{}: expected {kind} from {least} to {most}{unit}, found {found}; {stays}{unit} is \
            kept",
            self.name
        )
    }
}

/// Key in egui's memory for the id of the field with this name.
fn field_key(name: &str) -> Id {
    Id::unique(("field", name))
}

/// Stores the id of the field with this name, so that a command can focus it.
pub fn remember_field(ui: &Ui, name: &str, id: Id) {
    ui.data_mut(|data| data.insert_temp(field_key(name), id));
}

/// Focuses the field with this name; returns whether it has been drawn before, so that its id is
/// known.
pub fn focus_field(ctx: &Context, name: &str) -> bool {
    let known = ctx.data(|data| data.get_temp::<Id>(field_key(name)));
    if let Some(id) = known {
        ctx.memory_mut(|memory| memory.request_focus(id));
    }
    known.is_some()
}

/// Parses a finite number with or without its unit, which the field shows and which is therefore
/// often typed or pasted with the number. The minus sign may be typographical, as in copied text. A
/// single comma is a decimal separator; "1.000,5" and "1,000,000" are refused, because either mark
/// could separate thousands.
fn number_in(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text
        .strip_suffix(unit)
        .unwrap_or(text)
        .trim()
        .replace('−', "-");
    let is_decimal_comma = text.matches(',').count() == 1 && !text.contains('.');
    let text = if is_decimal_comma {
        text.replace(',', ".")
    } else {
        text
    };
    let value: f64 = text.parse().ok()?;
    if value.is_finite() { Some(value) } else { None }
}

/// Formats a number with the digits chosen for the field.
fn number_text(digits: Digits, value: f64) -> String {
    match digits {
        Digits::Significant => significant_text(value),
        Digits::Decimals(decimals) => format!("{value:.decimals$}"),
        Digits::Gain => gain_text(value),
    }
}

/// Formats a number with three significant digits, and with at most two decimals where further
/// decimals are zero: "0.50" and "0.525".
fn significant_text(value: f64) -> String {
    let mut text = significant(value);
    if let Some(point) = text.find('.')
        && !text.contains('e')
    {
        while text.len() > point + 3 && text.ends_with('0') {
            text.pop();
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_shown_with_the_digits_that_matter() {
        let shown = [0.5, 0.525, 1.0, 10.0, 12.0, 0.05, 0.0123, 1e10].map(significant_text);
        let expected = [
            "0.50", "0.525", "1.00", "10.0", "12.0", "0.05", "0.0123", "1.00e10",
        ];
        assert_eq!(shown, expected);
    }

    #[test]
    fn a_number_is_read_as_engineers_type_it() {
        let cases = [
            ("30", 30.0),
            (" 0,5 rad/s", 0.5),
            ("−2e-3", -0.002),
            ("12rad/s", 12.0),
            ("1e6", 1e6),
        ];
        for (text, value) in cases {
            assert_eq!(number_in(text, "rad/s"), Some(value), "{text}");
        }
        for text in ["", "three", "1,000,000", "1.000,5", "nan", "inf", "3 kt"] {
            assert_eq!(number_in(text, "rad/s"), None, "{text}");
        }
    }
}
