//! Fields for text and numbers, with number formats.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::{Context, DragValue, Id, Key, Response, Role, TextEdit, Ui, WidgetInfo, vec2};

use gdcm_model::units::number;
use gdcm_study::decisions::setting_row::Digits;

/// Draws a single-line text field with an accessible name.
pub fn text_field_ui(
    ui: &mut Ui,
    name: &str,
    text: &mut String,
    hint: &str,
    width: f32,
) -> Response {
    let response = ui.add(
        TextEdit::singleline(text)
            .hint_text(hint)
            .desired_width(width),
    );
    name_text_field(&response, name, text);
    response
}

/// Names a text field and reports its content to screen readers.
pub fn name_text_field(response: &Response, name: &str, text: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.to_owned());
        info
    });
}

/// Returns whether editing was ended by Enter.
pub fn is_entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Height of a text entry \[pt\].
const ENTRY_HEIGHT: f32 = 20.0;

/// Draws a text field with an accessible name and `value`; returns the typed text after Enter or
/// when the focus leaves.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::unique(("entry", name));
    let edited = ui.data(|data| data.get_temp::<String>(id));
    let mut text = edited.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text)
        .id(id.with("field"))
        .hint_text(hint);
    let response = ui.add_sized(vec2(width, ENTRY_HEIGHT), edit);
    name_text_field(&response, name, &text);
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
        if is_given_up || text == value {
            return None;
        }
        return Some(text);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// Reason why an entry is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedEntry(pub String);

/// Like [`entry_ui`], but for a number; refuses any other text with the reason. The inner `None`
/// means that the field was emptied.
pub fn number_entry_ui<C: From<RefusedEntry>>(
    ui: &mut Ui,
    name: &str,
    value: &str,
    hint: &str,
    width: f32,
    commands: &mut Vec<C>,
) -> Option<Option<f64>> {
    match typed_number(&entry_ui(ui, name, value, hint, width)?) {
        Ok(number) => Some(number),
        Err(why) => {
            commands.push(RefusedEntry(format!("{name}: {why}")).into());
            None
        }
    }
}

/// Parses a number with a decimal comma or point; `None` for empty text.
pub fn typed_number(text: &str) -> Result<Option<f64>, String> {
    let text = text.trim().replace(',', ".");
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(format!("expected a number, found \"{text}\"")),
    }
}

/// Height of a number field \[pt\].
const FIELD_HEIGHT: f32 = 18.0;
/// Number of passes after Escape in which egui may still commit the typed text.
const PASSES_AFTER_ESCAPE: u64 = 2;

/// Numeric input with unit, limits and accessible name.
pub struct NumberField<'a> {
    /// Accessible name, unique in the window.
    pub name: &'a str,
    /// Tooltip: meaning and unit.
    pub hint: &'a str,
    /// Unit of the number; empty if dimensionless.
    pub unit: &'static str,
    /// Whether the unit is shown after the number.
    pub shows_unit: bool,
    pub range: RangeInclusive<f64>,
    pub is_whole: bool,
    /// Change per point of dragging and per press of an arrow key.
    pub step: f64,
    /// Minimum width \[pt\]; 0 to fit the text.
    pub width: f32,
    pub digits: Digits,
}

/// Result of an edit in this frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entered {
    /// New number, if it is valid.
    pub value: Option<f64>,
    /// Reason why the entry is refused.
    pub refusal: Option<String>,
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
    /// by Enter or by a loss of focus, and Escape restores the old value.
    pub fn ui(&self, ui: &mut Ui, value: f64) -> Entered {
        let pass = ui.ctx().cumulative_pass_nr();
        let escaped = ui.data(|data| data.get_temp::<u64>(self.key("escaped")));
        let is_escaped = escaped.is_some_and(|escaped| pass - escaped <= PASSES_AFTER_ESCAPE);
        let wrong = RefCell::new(None);
        let mut entered = value;
        let mut field = DragValue::new(&mut entered)
            .update_while_editing(false)
            .speed(self.step)
            .custom_formatter(|value, _| number_text(self.digits, value))
            .custom_parser(|text| self.read(text, value, is_escaped, &wrong));
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
        if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
            ui.data_mut(|data| data.insert_temp(self.key("escaped"), pass));
        }
        ui.data_mut(|data| data.insert_temp(self.key("field"), response.id));
        let entered = self.entered(value, entered, wrong.into_inner(), &response);
        response.on_hover_text(self.hint);
        entered
    }

    /// Returns the key of `item`, a value that this field keeps in egui's memory between frames.
    fn key(&self, item: &str) -> Id {
        Id::unique((item, self.name))
    }

    /// Parses the typed number; an unedited text returns the exact old value, which the text may
    /// round.
    fn read(
        &self,
        text: &str,
        value: f64,
        is_escaped: bool,
        wrong: &RefCell<Option<String>>,
    ) -> Option<f64> {
        if is_escaped {
            return None;
        }
        if text == number_text(self.digits, value) {
            return Some(value);
        }
        let number = number_in(text, self.unit);
        if number.is_none() {
            *wrong.borrow_mut() = Some(text.trim().to_owned());
        }
        number
    }

    fn entered(
        &self,
        before: f64,
        after: f64,
        wrong: Option<String>,
        response: &Response,
    ) -> Entered {
        let is_dragged = response.dragged();
        let after = if is_dragged {
            after.clamp(*self.range.start(), *self.range.end())
        } else {
            after
        };
        let is_allowed =
            self.range.contains(&after) && (!self.is_whole || after.fract() == 0.0 || is_dragged);
        let mut entered = Entered {
            value: None,
            refusal: None,
            is_dragged,
            is_ended: response.drag_stopped() || response.lost_focus(),
        };
        if after != before && is_allowed {
            entered.value = Some(after);
        }
        if let Some(text) = wrong {
            entered.refusal = Some(self.refusal(&format!("\"{text}\""), before));
        } else if after != before && !is_allowed {
            entered.refusal = Some(self.refusal(&number(after), before));
        }
        entered
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

/// Focuses the field with this name if it is in the window.
pub fn focus_field(ctx: &Context, name: &str) {
    if let Some(id) = ctx.data(|data| data.get_temp::<Id>(Id::unique(("field", name)))) {
        ctx.memory_mut(|memory| memory.request_focus(id));
    }
}

/// Parses a finite number with or without its unit; a single comma is a decimal separator, and the
/// minus sign may be typographical.
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
        Digits::Significant => significant(value),
        Digits::Decimals(decimals) => format!("{value:.decimals$}"),
        Digits::Gain => gain_text(value),
    }
}

/// Formats three significant digits, without an exponent from 0.001 to 9999.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if (-3.0..4.0).contains(&magnitude) {
        format!("{value:.*}", (2.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

/// Formats a gain with three decimals, or two if the third is zero; a gain below 0.1 with three
/// significant digits.
fn gain_text(gain: f64) -> String {
    if gain < 0.1 {
        return significant(gain);
    }
    let text = format!("{gain:.3}");
    text.strip_suffix('0').map(str::to_owned).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_taken_with_a_comma_or_a_point_and_nothing_else_is() {
        assert_eq!(typed_number(" 1,5 "), Ok(Some(1.5)));
        assert_eq!(typed_number(""), Ok(None));
        assert!(typed_number("12 kt").is_err() && typed_number("inf").is_err());
    }

    #[test]
    fn alpha_is_shown_with_three_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.00123, "0.00123"),
            (120.0, "120"),
            (1e6, "1.00e6"),
        ] {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn a_gain_is_shown_with_two_or_three_digits_behind_the_point() {
        for (value, text) in [
            (1.0, "1.00"),
            (1.25, "1.25"),
            (1.2346, "1.235"),
            (1e-6, "1.00e-6"),
        ] {
            assert_eq!(gain_text(value), text);
        }
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
