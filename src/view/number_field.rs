//! A field for a number, which refuses what is out of its range with a word.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::{Context, DragValue, Id, Key, Response, Role, Ui, WidgetInfo, vec2};

use gdcm_core::study::Digits;
use gdcm_core::units::number;

const HEIGHT: f32 = 18.0;
/// For so many passes after the Escape key egui may still take up the text that was being typed.
const PASSES_AFTER_ESCAPE: u64 = 2;

/// What a field is about.
pub struct NumberField<'a> {
    /// Its accessible name, one of a kind in the window.
    pub name: &'a str,
    /// What it means, with its unit.
    pub hint: &'a str,
    /// The unit in which it is typed; empty for a pure number.
    pub unit: &'static str,
    /// Whether the unit stands in the field, behind the number.
    pub shows_unit: bool,
    /// What it may be.
    pub range: RangeInclusive<f64>,
    /// Whether only whole numbers make sense.
    pub is_whole: bool,
    /// How much it changes by a point of dragging, or by an arrow key.
    pub step: f64,
    /// Least width \[pt\]; 0 leaves it to the text.
    pub width: f32,
    /// How the number is written.
    pub digits: Digits,
}

/// What became of a field in this frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entered {
    /// The new number, where it is one that the field may hold.
    pub value: Option<f64>,
    /// Why what was typed is not taken.
    pub refusal: Option<String>,
    /// Whether the number may still follow the pointer.
    pub is_dragged: bool,
    /// Whether the decision is complete: the pointer let go, or the focus went on.
    pub is_ended: bool,
}

impl<'a> NumberField<'a> {
    /// A field for any pure number in the range, as wide as its text.
    pub fn new(name: &'a str, hint: &'a str, range: RangeInclusive<f64>) -> Self {
        let (unit, shows_unit, is_whole) = ("", false, false);
        Self { name, hint, unit, shows_unit, range, is_whole, step: 0.01, width: 0.0, digits: Digits::Significant }
    }

    /// The field with `value` in it. A number is dragged within the range; one that is typed is taken up by Enter, or when the
    /// focus goes on, and Escape leaves the old one.
    pub fn ui(&self, ui: &mut Ui, value: f64) -> Entered {
        let pass = ui.ctx().cumulative_pass_nr();
        let escaped = ui.data(|data| data.get_temp::<u64>(self.key("escaped")));
        let is_escaped = escaped.is_some_and(|escaped| pass - escaped <= PASSES_AFTER_ESCAPE);
        let wrong = RefCell::new(None);
        let read = |text: &str| self.read(text, value, is_escaped, &wrong);
        let mut entered = value;
        let mut field = DragValue::new(&mut entered)
            .update_while_editing(false)
            .speed(self.step)
            .custom_formatter(|value, _| number_text(self.digits, value))
            .custom_parser(read);
        if self.shows_unit {
            field = field.suffix(format!(" {}", self.unit));
        }
        let response = if self.width > 0.0 { ui.add_sized(vec2(self.width, HEIGHT), field) } else { ui.add(field) };
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

    fn key(&self, what: &str) -> Id {
        Id::unique((what, self.name))
    }

    /// The number that was typed; that in the field where it was left as it is shown, which may be less exact.
    fn read(&self, text: &str, value: f64, is_escaped: bool, wrong: &RefCell<Option<String>>) -> Option<f64> {
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

    fn entered(&self, before: f64, after: f64, wrong: Option<String>, response: &Response) -> Entered {
        let is_dragged = response.dragged();
        let after = if is_dragged { after.clamp(*self.range.start(), *self.range.end()) } else { after };
        let is_allowed = self.range.contains(&after) && (!self.is_whole || after.fract() == 0.0 || is_dragged);
        let refused = wrong.map(|text| format!("\"{text}\""));
        let refused = refused.or_else(|| (after != before && !is_allowed).then(|| number(after)));
        Entered {
            value: (after != before && is_allowed).then_some(after),
            refusal: refused.map(|found| self.refusal(&found, before)),
            is_dragged,
            is_ended: response.drag_stopped() || response.lost_focus(),
        }
    }

    /// "Band from: expected a number from 0.0001 to 12 rad/s, found 30; it stays 0.500 rad/s."
    fn refusal(&self, found: &str, before: f64) -> String {
        let kind = if self.is_whole { "a whole number" } else { "a number" };
        let (least, most) = (number(*self.range.start()), number(*self.range.end()));
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let stays = number_text(self.digits, before);
        format!("{}: expected {kind} from {least} to {most}{unit}, found {found}; it stays {stays}{unit}", self.name)
    }
}

/// Gives the focus to the field of this name, if it is in the window.
pub fn focus_field(ctx: &Context, name: &str) {
    if let Some(id) = ctx.data(|data| data.get_temp::<Id>(Id::unique(("field", name)))) {
        ctx.memory_mut(|memory| memory.request_focus(id));
    }
}

/// A finite number with or without its unit; a comma alone is a decimal point, and the minus sign may be the typographical one.
fn number_in(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit).unwrap_or(text).trim().replace('−', "-");
    let is_decimal_comma = text.matches(',').count() == 1 && !text.contains('.');
    let text = if is_decimal_comma { text.replace(',', ".") } else { text };
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// A number as a field writes it.
fn number_text(digits: Digits, value: f64) -> String {
    match digits {
        Digits::Significant => significant(value),
        Digits::Decimals(decimals) => format!("{value:.decimals$}"),
        Digits::Gain => gain_text(value),
    }
}

/// Three significant digits, without an exponent from 0.001 to 9999.
pub fn significant(value: f64) -> String {
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

/// A gain with three digits behind the point, two where the third is zero; three significant ones where it is small.
pub fn gain_text(gain: f64) -> String {
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
    fn alpha_is_shown_with_three_significant_digits() {
        for (value, text) in [(0.0, "0"), (1.0, "1.00"), (0.00123, "0.00123"), (120.0, "120"), (1e6, "1.00e6")] {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn a_gain_is_shown_with_two_or_three_digits_behind_the_point() {
        for (value, text) in [(1.0, "1.00"), (1.25, "1.25"), (1.2346, "1.235"), (1e-6, "1.00e-6")] {
            assert_eq!(gain_text(value), text);
        }
    }

    #[test]
    fn a_number_is_read_as_engineers_type_it() {
        let cases = [("30", 30.0), (" 0,5 rad/s", 0.5), ("−2e-3", -0.002), ("12rad/s", 12.0), ("1e6", 1e6)];
        for (text, value) in cases {
            assert_eq!(number_in(text, "rad/s"), Some(value), "{text}");
        }
        for text in ["", "three", "1,000,000", "1.000,5", "nan", "inf", "3 kt"] {
            assert_eq!(number_in(text, "rad/s"), None, "{text}");
        }
    }
}
