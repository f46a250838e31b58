//! Building blocks of panels and forms: small texts, named controls, fields for text and numbers,
//! command menus, headings, and list rows.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::containers::panel::PanelState;
use egui::{
    Align, Align2, Button, Color32, Context, DragValue, FontId, Id, InnerResponse, Key, Layout,
    Rect, Response, RichText, Role, Sense, TextEdit, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use gdcm_model::number_format::{gain_text, significant};
use gdcm_model::units::number;
use gdcm_study::decisions::setting_row::Digits;

use super::focus::begin_with;
use super::palette::{Palette, SMALL_SIZE};

impl Palette {
    /// Returns small dim text, for notes beside a value.
    pub fn small(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.dim_text)
    }

    /// Returns dim text in the usual size, for labels and explanations.
    pub fn dim(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).color(self.dim_text)
    }

    /// Returns small text in the warning colour.
    pub fn small_warning(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.warning)
    }
}

/// Names a control for screen readers and tests.
pub fn named(response: Response, role: Role, name: impl Into<String>) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::labeled(role, enabled, &name));
    response
}

/// Names an on/off control.
pub fn named_switch(
    response: Response,
    role: Role,
    is_on: bool,
    name: impl Into<String>,
) -> Response {
    let enabled = response.enabled();
    let name = name.into();
    response.widget_info(|| WidgetInfo::selected(role, enabled, is_on, &name));
    response
}

/// Adds a hint if it is not empty: an empty hint would show an empty box.
pub fn hint_ui(response: Response, hint: impl Into<String>) -> Response {
    let hint = hint.into();
    if hint.is_empty() {
        response
    } else {
        response.on_hover_text(hint)
    }
}

/// Control that emits a command.
pub trait Asks {
    /// Emits the command on a click.
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>);
}

impl Asks for Response {
    fn asks<C>(&self, command: impl Into<C>, commands: &mut Vec<C>) {
        if self.clicked() {
            commands.push(command.into());
        }
    }
}

/// Draws a button that emits a command.
pub fn button_ui<C>(
    ui: &mut Ui,
    button: Button<'_>,
    hint: &str,
    command: impl Into<C>,
    commands: &mut Vec<C>,
) {
    hint_ui(ui.add(button), hint).asks(command, commands);
}

/// Draws menu entries, each with its command; a click closes the menu.
pub fn entries_ui<N: Into<String>, C>(
    ui: &mut Ui,
    entries: impl IntoIterator<Item = (N, C)>,
    commands: &mut Vec<C>,
) {
    for (text, command) in entries {
        if ui.button(text.into()).clicked() {
            commands.push(command);
            ui.close();
        }
    }
}

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

/// Returns whether Enter ended the editing of a field.
pub fn is_entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Height of a row \[pt\].
pub const ROW_HEIGHT: f32 = 20.0;

/// Allocates a clickable row, paints its background, and names it for screen readers and tests.
pub fn row_ui(
    ui: &mut Ui,
    palette: &Palette,
    selected: bool,
    pointed: bool,
    name: &str,
) -> (Rect, Response) {
    row_of_height_ui(ui, palette, (selected, pointed, ROW_HEIGHT), name)
}

/// As `row_ui`, with another height \[pt\].
pub fn row_of_height_ui(
    ui: &mut Ui,
    palette: &Palette,
    (selected, pointed, height): (bool, bool, f32),
    name: &str,
) -> (Rect, Response) {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, ui.is_enabled(), selected, name));
    if selected {
        begin_with(ui.ctx(), response.id);
    }
    let fill = if selected {
        palette.selected
    } else if response.hovered() || pointed || response.has_focus() {
        palette.raised
    } else {
        Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect, 4.0, fill);
    (rect, response)
}

/// Restores the default size of a named panel after a double click on its edge; call it before the
/// panel is shown.
pub fn restore_panel_size(ui: &Ui, name: &str) {
    let panel = ui.scope_id().with(name);
    if ui
        .read_response(panel.with("__resize"))
        .is_some_and(|edge| edge.double_clicked())
    {
        ui.ctx().data_mut(|data| data.remove::<PanelState>(panel));
    }
}

/// Horizontal extent available to text \[pt from the row's left edge\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub left: f32,
    pub right: f32,
}

/// Paints text into its room, with the middle elided if it is too long; paints nothing without room
/// for a letter.
pub fn row_text_within(ui: &Ui, row: Rect, room: Room, text: &str, size: f32, color: Color32) {
    let shown = elided(ui, text, room.right - room.left, size);
    if !shown.is_empty() {
        row_text(ui, row, room.left, &shown, size, color);
    }
}

/// Returns text no wider than `room` \[pt\], with the middle elided if it is too long. Empty
/// without room for a letter.
pub fn elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    elided_at(ui, text, room, size, 0.5)
}

/// As [`elided`], for a name in a list: if a neighbour would be shortened to the same text, the gap
/// moves to the beginning or to the end.
pub fn elided_among(
    ui: &Ui,
    text: &str,
    neighbours: [Option<&str>; 2],
    room: f32,
    size: f32,
) -> String {
    /// Share of the remaining letters that precedes the gap.
    const HEADS: [f32; 3] = [0.5, 0.0, 1.0];
    let candidates = HEADS.map(|head| (head, elided_at(ui, text, room, size, head)));
    let is_told_apart = |(head, shown): &&(f32, String)| {
        let mut others = neighbours.iter().flatten().filter(|other| **other != text);
        others.all(|other| elided_at(ui, other, room, size, *head) != *shown)
    };
    let found = candidates
        .iter()
        .find(is_told_apart)
        .unwrap_or(&candidates[0]);
    found.1.clone()
}

fn elided_at(ui: &Ui, text: &str, room: f32, size: f32, head: f32) -> String {
    let width = |text: &str| text_width(ui, text, FontId::proportional(size));
    if width(text) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let keeping = |kept: usize| {
        let before = (head * kept as f32) as usize;
        let after = letters.len() - (kept - before);
        letters[..before]
            .iter()
            .chain(&['…'])
            .chain(&letters[after..])
            .collect::<String>()
    };
    // The width grows with the number of remaining letters: bisection finds the greatest number
    // that fits.
    let mut fits = 0;
    let mut too_wide = letters.len();
    while too_wide - fits > 1 {
        let middle = (fits + too_wide) / 2;
        if width(&keeping(middle)) <= room {
            fits = middle;
        } else {
            too_wide = middle;
        }
    }
    if fits == 0 {
        String::new()
    } else {
        keeping(fits)
    }
}

/// Returns the width of single-line text \[pt\].
pub fn text_width(ui: &Ui, text: &str, font: FontId) -> f32 {
    ui.fonts_mut(|fonts| {
        fonts
            .layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER)
            .size()
            .x
    })
}

/// Lays out content within `place`, left to right or right to left, vertically centred.
pub fn in_line_ui<R>(
    ui: &mut Ui,
    place: Rect,
    from_right: bool,
    add: impl FnOnce(&mut Ui) -> R,
) -> InnerResponse<R> {
    let layout = if from_right {
        Layout::right_to_left(Align::Center)
    } else {
        Layout::left_to_right(Align::Center)
    };
    ui.scope_builder(UiBuilder::new().max_rect(place).layout(layout), add)
}

/// Paints text at `x` points from the row's left edge (from its right edge if negative), vertically
/// centred.
pub fn painted_text(ui: &Ui, row: Rect, x: f32, text: &str, font: FontId, color: Color32) -> Rect {
    let (left, align) = if x < 0.0 {
        (row.right() + x, Align2::RIGHT_CENTER)
    } else {
        (row.left() + x, Align2::LEFT_CENTER)
    };
    ui.painter()
        .text(pos2(left, row.center().y), align, text, font, color)
}

/// Paints text at `x` points from the row's left edge (from its right edge if negative), vertically
/// centred.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    painted_text(ui, row, x, text, FontId::proportional(size), color)
}

/// Draws a text field with an accessible name and `value`; returns the typed text after Enter or
/// when the focus leaves.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::unique(("entry", name));
    let held = ui.data(|data| data.get_temp::<String>(id));
    let mut text = held.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text)
        .id(id.with("field"))
        .hint_text(hint);
    let response = ui.add_sized(vec2(width, ROW_HEIGHT), edit);
    name_text_field(&response, name, &text);
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
        return (!is_given_up && text != value).then_some(text);
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// Reason why an entry is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedEntry(pub String);

/// As [`entry_ui`], for a number; refuses anything else with the reason. The inner `None` is an
/// emptied field.
pub fn number_entry_ui<C: From<RefusedEntry>>(
    ui: &mut Ui,
    name: &str,
    value: &str,
    hint: &str,
    width: f32,
    commands: &mut Vec<C>,
) -> Option<Option<f64>> {
    let typed = typed_number(&entry_ui(ui, name, value, hint, width)?);
    typed
        .map_err(|why| commands.push(RefusedEntry(format!("{name}: {why}")).into()))
        .ok()
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
/// Passes after Escape in which egui may still commit the text being typed.
const PASSES_AFTER_ESCAPE: u64 = 2;

/// Description of a number field.
pub struct NumberField<'a> {
    /// Accessible name, unique in the window.
    pub name: &'a str,
    /// Meaning, with the unit.
    pub hint: &'a str,
    /// Unit of the typed number; empty if dimensionless.
    pub unit: &'static str,
    /// Whether the unit is shown behind the number.
    pub shows_unit: bool,
    pub range: RangeInclusive<f64>,
    pub is_whole: bool,
    /// Change per point of dragging and per arrow key.
    pub step: f64,
    /// Least width \[pt\]; 0 for the width of the text.
    pub width: f32,
    pub digits: Digits,
}

/// Result of a field in this frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entered {
    /// New number, if it is valid.
    pub value: Option<f64>,
    /// Reason why the entry is refused.
    pub refusal: Option<String>,
    /// Whether the number may still follow the pointer.
    pub is_dragged: bool,
    /// Whether the decision is complete: released pointer or lost focus.
    pub is_ended: bool,
}

impl<'a> NumberField<'a> {
    /// Creates a field for any dimensionless number in the range, as wide as its text.
    pub fn new(name: &'a str, hint: &'a str, range: RangeInclusive<f64>) -> Self {
        let unit = "";
        let shows_unit = false;
        let is_whole = false;
        Self {
            name,
            hint,
            unit,
            shows_unit,
            range,
            is_whole,
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

    fn key(&self, what: &str) -> Id {
        Id::unique((what, self.name))
    }

    /// Parses the typed number; an unedited text keeps the exact old value, which the text may
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
        let refused = wrong.map(|text| format!("\"{text}\""));
        let refused = refused.or_else(|| (after != before && !is_allowed).then(|| number(after)));
        Entered {
            value: (after != before && is_allowed).then_some(after),
            refusal: refused.map(|found| self.refusal(&found, before)),
            is_dragged,
            is_ended: response.drag_stopped() || response.lost_focus(),
        }
    }

    /// Returns the refusal, for example "Band from: expected a number from 0.0001 to 12 rad/s,
    /// found 30; it stays 0.500 rad/s."
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
            "{}: expected {kind} from {least} to {most}{unit}, found {found}; it stays {stays}{unit}",
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

/// Parses a finite number with or without its unit; a lone comma is a decimal point, and the minus
/// sign may be typographical.
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
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Formats a number for a field.
fn number_text(digits: Digits, value: f64) -> String {
    match digits {
        Digits::Significant => significant(value),
        Digits::Decimals(decimals) => format!("{value:.decimals$}"),
        Digits::Gain => gain_text(value),
    }
}

/// Paints a small arrow: to the right if its section is folded, down if it is open.
pub fn chevron(ui: &Ui, center: egui::Pos2, is_open: bool, palette: &Palette) {
    let turn = |x: f32, y: f32| {
        if is_open {
            center + vec2(-y, x)
        } else {
            center + vec2(x, y)
        }
    };
    let points = vec![turn(-2.0, -4.0), turn(2.0, 0.0), turn(-2.0, 4.0)];
    ui.painter()
        .line(points, egui::Stroke::new(1.3, palette.dim_text));
}

/// Menu text that opens a derivation, used everywhere.
pub const QUESTION: &str = "How was this computed?";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_that_differ_only_at_one_end_differ_when_they_are_shortened() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let names = [
                "FLIGHTLAB BO105 trim V+5kt weight 2300kg",
                "FLIGHTLAB BO105 trim V+5kt weight 2400kg",
            ];
            let [first, second] = names.map(|name| elided(ui, name, 90.0, 13.0));
            assert!(
                first != second && first.starts_with("FLI") && first.ends_with("00kg"),
                "{first} {second}"
            );
            assert_eq!(elided(ui, "nominal", 90.0, 13.0), "nominal");
            let shown = |name, other| elided_among(ui, name, [None, Some(other)], 52.0, 13.0);
            let [first, second] = [
                shown("ROC-300fpm", "ROC-150fpm"),
                shown("ROC-150fpm", "ROC-300fpm"),
            ];
            assert!(
                first != second && first.ends_with("00fpm"),
                "{first} {second}: they differ in the middle"
            );
            assert_eq!(elided(ui, "nominal", 4.0, 13.0), "");
        });
        output.drop_without_applying_deltas();
    }

    #[test]
    fn a_number_is_taken_with_a_comma_or_a_point_and_nothing_else_is() {
        assert_eq!(typed_number(" 1,5 "), Ok(Some(1.5)));
        assert_eq!(typed_number(""), Ok(None));
        assert!(typed_number("12 kt").is_err() && typed_number("inf").is_err());
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
