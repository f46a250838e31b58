//! What panels and forms are made of: small texts, named controls, fields, menus of commands, headings, and rows of lists.

use egui::containers::panel::PanelState;
use egui::{
    Align, Align2, Button, Color32, FontId, Id, Key, Layout, Rect, Response, RichText, Role, Sense, TextEdit, Ui,
    WidgetInfo, pos2, vec2,
};

use super::focus::begin_with;
use super::palette::medium;
use super::{BODY_SIZE, Command, Palette, SMALL_SIZE, TableKind};

impl Palette {
    /// A small dim text: what stands beside a value.
    pub fn small(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.dim_text)
    }

    /// A dim text in the usual size: a label, or an explanation.
    pub fn dim(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).color(self.dim_text)
    }

    /// A small text that something is amiss.
    pub fn small_warning(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.warning)
    }
}

/// Names a control for screen readers and tests.
pub fn named(response: Response, role: Role, name: impl Into<String>) -> Response {
    let (enabled, name) = (response.enabled(), name.into());
    response.widget_info(|| WidgetInfo::labeled(role, enabled, &name));
    response
}

/// Names a control that is on or off.
pub fn named_switch(response: Response, role: Role, is_on: bool, name: impl Into<String>) -> Response {
    let (enabled, name) = (response.enabled(), name.into());
    response.widget_info(|| WidgetInfo::selected(role, enabled, is_on, &name));
    response
}

/// Says a hint where there is one: an empty one would be an empty box.
fn hint_ui(response: Response, hint: impl Into<String>) -> Response {
    let hint = hint.into();
    if hint.is_empty() { response } else { response.on_hover_text(hint) }
}

/// A check box; whether it is on after a click on it.
pub fn check_ui(ui: &mut Ui, is_on: bool, text: impl Into<String>, hint: impl Into<String>) -> Option<bool> {
    let mut value = is_on;
    let response = ui.checkbox(&mut value, text.into());
    let changed = response.changed();
    hint_ui(response, hint);
    changed.then_some(value)
}

/// A button that gives a command.
pub fn button_ui(
    ui: &mut Ui,
    button: Button<'_>,
    hint: &str,
    command: impl Into<Command>,
    commands: &mut Vec<Command>,
) {
    if hint_ui(ui.add(button), hint).clicked() {
        commands.push(command.into());
    }
}

/// The entries of a menu, each with its command; a click closes the menu.
pub fn entries_ui<N: Into<String>>(
    ui: &mut Ui,
    entries: impl IntoIterator<Item = (N, Command)>,
    commands: &mut Vec<Command>,
) {
    for (text, command) in entries {
        if ui.button(text.into()).clicked() {
            commands.push(command);
            ui.close();
        }
    }
}

/// A line of text to type into, of this accessible name.
pub fn text_field_ui(ui: &mut Ui, name: &str, text: &mut String, hint: &str, width: f32) -> Response {
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(width));
    name_text_field(&response, name, text);
    response
}

/// Names a text field, with what stands in it.
pub fn name_text_field(response: &Response, name: &str, text: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.to_owned());
        info
    });
}

/// Whether a field was left by the Enter key.
pub fn is_entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Height of a row \[pt\].
pub const ROW_HEIGHT: f32 = 20.0;

/// Allocates a row that can be clicked, paints its background, and names it for screen readers and tests.
pub fn row_ui(ui: &mut Ui, palette: &Palette, selected: bool, pointed: bool, name: &str) -> (Rect, Response) {
    row_of_height_ui(ui, palette, (selected, pointed, ROW_HEIGHT), name)
}

/// The same, of another height \[pt\].
pub fn row_of_height_ui(
    ui: &mut Ui,
    palette: &Palette,
    (selected, pointed, height): (bool, bool, f32),
    name: &str,
) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
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

/// Puts the panel of this name back to its own size where its edge was double clicked; called before it is shown.
pub fn restore_panel_size(ui: &Ui, name: &str) {
    let panel = ui.scope_id().with(name);
    if ui.read_response(panel.with("__resize")).is_some_and(|edge| edge.double_clicked()) {
        ui.ctx().data_mut(|data| data.remove::<PanelState>(panel));
    }
}

/// Where a row has room for a text \[pt from the row's left edge\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Where it begins.
    pub left: f32,
    /// Where it ends.
    pub right: f32,
}

/// Paints text into its room, shortened in the middle where it is too long; nothing where there is no room for a letter of it.
pub fn row_text_within(ui: &Ui, row: Rect, room: Room, text: &str, size: f32, color: Color32) {
    let shown = elided(ui, text, room.right - room.left, size);
    if !shown.is_empty() {
        row_text(ui, row, room.left, &shown, size, color);
    }
}

/// A text no wider than `room` \[pt\], its middle left out where it is too long. Empty where there is no room for one letter.
pub fn elided(ui: &Ui, text: &str, room: f32, size: f32) -> String {
    elided_at(ui, text, room, size, 0.5)
}

/// As [`elided`], of a name in a list: where its neighbours would be shortened to the same text, what is left out is at its
/// beginning or at its end instead.
pub fn elided_among(ui: &Ui, text: &str, neighbours: [Option<&str>; 2], room: f32, size: f32) -> String {
    /// Which part of what is kept stands before the gap.
    const HEADS: [f32; 3] = [0.5, 0.0, 1.0];
    let candidates = HEADS.map(|head| (head, elided_at(ui, text, room, size, head)));
    let is_told_apart = |(head, shown): &&(f32, String)| {
        let mut others = neighbours.iter().flatten().filter(|other| **other != text);
        others.all(|other| elided_at(ui, other, room, size, *head) != *shown)
    };
    let found = candidates.iter().find(is_told_apart).unwrap_or(&candidates[0]);
    found.1.clone()
}

fn elided_at(ui: &Ui, text: &str, room: f32, size: f32, head: f32) -> String {
    let width = |text: String| {
        let font = FontId::proportional(size);
        ui.fonts_mut(|fonts| fonts.layout_no_wrap(text, font, Color32::PLACEHOLDER).size().x)
    };
    if width(text.to_owned()) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let keeping = |kept: usize| {
        let before = (head * kept as f32) as usize;
        let after = letters.len() - (kept - before);
        letters[..before].iter().chain(&['…']).chain(&letters[after..]).collect::<String>()
    };
    // The widths grow with what is kept: the greatest that fits is found by halving.
    let (mut fits, mut too_wide) = (0, letters.len());
    while too_wide - fits > 1 {
        let middle = (fits + too_wide) / 2;
        if width(keeping(middle)) <= room {
            fits = middle;
        } else {
            too_wide = middle;
        }
    }
    if fits == 0 { String::new() } else { keeping(fits) }
}

/// Paints text of a font at `x` points from the row's left edge (before its right edge where negative), centred in height.
pub fn painted_text(ui: &Ui, row: Rect, x: f32, text: &str, font: FontId, color: Color32) -> Rect {
    let (left, align) =
        if x < 0.0 { (row.right() + x, Align2::RIGHT_CENTER) } else { (row.left() + x, Align2::LEFT_CENTER) };
    ui.painter().text(pos2(left, row.center().y), align, text, font, color)
}

/// Paints text at `x` points from the row's left edge (from its right edge where negative), centred in height.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    painted_text(ui, row, x, text, FontId::proportional(size), color)
}

/// A button of this text and accessible name that is on or off; gives whether it was clicked.
pub fn toggle_ui(ui: &mut Ui, (text, name): (&str, &str), is_on: bool, hint: &str) -> bool {
    let button = Button::new(text).selected(is_on).corner_radius(6.0);
    named_switch(ui.add(button), Role::CheckBox, is_on, name).on_hover_text(hint).clicked()
}

/// A heading on the left, a value on the right.
pub fn heading_ui(ui: &mut Ui, palette: &Palette, title: &str, value: &str) -> egui::Response {
    ui.add_space(4.0);
    let shown = ui.horizontal(|ui| {
        ui.label(RichText::new(title).font(medium(BODY_SIZE)));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(palette.small(value));
        });
    });
    shown.response
}

/// The same over a table: a right-click copies it or saves it, as the palette does.
pub fn table_heading_ui(
    ui: &mut Ui,
    palette: &Palette,
    (title, value): (&str, &str),
    kind: TableKind,
    commands: &mut Vec<Command>,
) {
    let heading = heading_ui(ui, palette, title, value);
    table_menu_ui(ui, &heading, kind, commands);
}

/// What a right-click offers on the heading of a table.
pub fn table_menu_ui(ui: &mut Ui, heading: &egui::Response, kind: TableKind, commands: &mut Vec<Command>) {
    // No stop of the Tab key: nothing on it can be pressed.
    let response = ui.interact(heading.rect, heading.id.with("table"), Sense::CLICK);
    let response = named(response, Role::Label, format!("Heading of {}", kind.name()));
    response.context_menu(|ui| {
        let choices = [("Copy table", Command::CopyTable(kind)), ("Save table as CSV…", Command::AskSaveTable(kind))];
        entries_ui(ui, choices, commands);
    });
}

/// A tab of a page of a view; gives whether it was clicked. Its accessible name is "Page NAME".
pub fn page_tab_ui(ui: &mut Ui, is_shown: bool, short_name: &str, (name, purpose): (&str, &str)) -> (Response, bool) {
    let tab = ui.selectable_label(is_shown, short_name);
    let tab =
        named_switch(tab, Role::Button, is_shown, format!("Page {name}")).on_hover_text(format!("{name}: {purpose}"));
    let is_clicked = tab.clicked();
    (tab, is_clicked)
}

/// A text field of this accessible name that shows `value`; gives what was typed once the field is left or Enter is pressed.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::unique(("entry", name));
    let held = ui.data(|data| data.get_temp::<String>(id));
    let mut text = held.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text).id(id.with("field")).hint_text(hint);
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

/// As [`entry_ui`], for a number; what is none is refused with the reason. None within where the field was emptied.
pub fn number_entry_ui(
    ui: &mut Ui,
    name: &str,
    value: &str,
    hint: &str,
    width: f32,
    commands: &mut Vec<Command>,
) -> Option<Option<f64>> {
    let typed = typed_number(&entry_ui(ui, name, value, hint, width)?);
    typed.map_err(|why| commands.push(Command::Refuse(format!("{name}: {why}")))).ok()
}

/// A number as engineers type it, with a decimal comma or a point; nothing for an empty text.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_that_differ_only_at_one_end_differ_when_they_are_shortened() {
        let ctx = egui::Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let names = ["FLIGHTLAB BO105 trim V+5kt weight 2300kg", "FLIGHTLAB BO105 trim V+5kt weight 2400kg"];
            let [first, second] = names.map(|name| elided(ui, name, 90.0, 13.0));
            assert!(first != second && first.starts_with("FLI") && first.ends_with("00kg"), "{first} {second}");
            assert_eq!(elided(ui, "nominal", 90.0, 13.0), "nominal");
            let shown = |name, other| elided_among(ui, name, [None, Some(other)], 52.0, 13.0);
            let [first, second] = [shown("ROC-300fpm", "ROC-150fpm"), shown("ROC-150fpm", "ROC-300fpm")];
            assert!(first != second && first.ends_with("00fpm"), "{first} {second}: they differ in the middle");
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
}
