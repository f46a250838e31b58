//! What one model is to be, field by field, and what the columns of its file hold.

use std::collections::BTreeMap;

use egui::{Grid, Id, Key, RichText, Role, TextEdit, Ui, WidgetInfo, vec2};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::settings_panel::choice_ui;
use gdcm_core::assembly::{ChannelLabel, Part, RowRole, RowRule};
use gdcm_core::units::number;

use super::assembly_state::{AssemblingCommand, AssemblyState};

const FIELD_WIDTH: f32 = 200.0;

/// A field: its name, what stands in it, and what a text in it says.
struct Field {
    name: &'static str,
    value: String,
    hint: &'static str,
    say: fn(&str, &mut RowRule) -> Result<(), String>,
}

/// The fields of the model shown.
pub(super) fn details_ui(ui: &mut Ui, bench: &AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(part) = bench.assembly().parts().get(bench.selected) else {
        ui.label(RichText::new("No model yet: add a folder or files above").color(palette.dim_text));
        return;
    };
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(RichText::new(part.found.key()).strong());
    ui.label(small(part.found.words()));
    let mut taken = !part.row.left_out;
    if ui.checkbox(&mut taken, "Take this model").on_hover_text("Whether it becomes part of the dataset").changed() {
        push(bench.said_of(bench.selected, |row| row.left_out = Some(!taken)), commands);
    }
    Grid::new("details of a model").num_columns(3).spacing([6.0, 3.0]).show(ui, |ui| {
        role_ui(ui, bench, part, commands);
        for field in fields(part, bench.assembly().rules().rows.get(&part.found.key())) {
            field_ui(ui, bench, &field, commands);
        }
    });
    if bench.tables.contains_key(part.found.file()) {
        columns_ui(ui, bench, part.found.file(), palette, commands);
    }
    let notes = part.found.notes.iter().chain(&part.inputs.notes).chain(&part.outputs.notes);
    let uses = part.inputs.uses.iter().chain(&part.outputs.uses).flatten();
    for note in notes.cloned().chain(uses.filter_map(|used| used.words.clone())) {
        ui.label(small(note));
    }
}

fn push(rules: gdcm_core::assembly::Rules, commands: &mut Vec<Command>) {
    commands.push(AssemblingCommand::Change(Box::new(rules)).into());
}

fn role_ui(ui: &mut Ui, bench: &AssemblyState, part: &Part, commands: &mut Vec<Command>) {
    ui.label("role");
    let mut role = part.row.role;
    let roles = RowRole::ALL.map(|role| (Some(role), role.word(), "What the model is in its condition"));
    choice_ui(ui, "Role of the model", &mut role, &roles);
    if role != part.row.role {
        push(bench.said_of(bench.selected, |row| row.role = role), commands);
    }
    if fill_ui(ui, "role") {
        let role = part.row.role;
        push(bench.filled_down(bench.selected, |row| row.role = role), commands);
    }
    ui.end_row();
}

/// A button that says the same of the models below, in the same folder.
fn fill_ui(ui: &mut Ui, name: &str) -> bool {
    let response = ui.small_button("↓");
    let label = format!("Fill down {name}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    response.on_hover_text(format!("{label}: the same for every model below it in the same folder")).clicked()
}

fn field_ui(ui: &mut Ui, bench: &AssemblyState, field: &Field, commands: &mut Vec<Command>) {
    ui.label(field.name);
    let name = format!("Model {}", field.name);
    if let Some(text) = entry_ui(ui, &name, &field.value, field.hint, FIELD_WIDTH) {
        let mut refusal = None;
        let rules = bench.said_of(bench.selected, |row| refusal = (field.say)(&text, row).err());
        match refusal {
            None => push(rules, commands),
            Some(why) => commands.push(Command::Refuse(format!("{}: {why}", field.name))),
        }
    }
    if fill_ui(ui, field.name) {
        let rules = bench.filled_down(bench.selected, |row| {
            // What stands in a field was taken before.
            let _ = (field.say)(&field.value, row);
        });
        push(rules, commands);
    }
    ui.end_row();
}

fn fields(part: &Part, rule: Option<&RowRule>) -> Vec<Field> {
    let row = &part.row;
    let figure = |value: Option<f64>| value.map_or(String::new(), number);
    let word = |value: &Option<String>| value.clone().unwrap_or_default();
    let mut fields = vec![
        Field {
            name: "condition",
            value: row.condition.map_or(String::new(), |of| of.to_string()),
            hint: "a number",
            say: say_condition,
        },
        Field {
            name: "name",
            value: row.name.clone(),
            hint: "in its bundle",
            say: |text, row| {
                row.name = Some(text.trim().to_owned());
                Ok(())
            },
        },
        Field {
            name: "airspeed",
            value: figure(row.airspeed_kt),
            hint: "kt",
            say: |text, row| {
                row.airspeed_kt = typed_number(text)?;
                Ok(())
            },
        },
        Field {
            name: "altitude",
            value: word(&row.altitude),
            hint: "low, high",
            say: |text, row| {
                row.altitude = said(text);
                Ok(())
            },
        },
        Field {
            name: "altitude [ft]",
            value: figure(row.altitude_ft),
            hint: "ft",
            say: |text, row| {
                row.altitude_ft = typed_number(text)?;
                Ok(())
            },
        },
        Field {
            name: "weight",
            value: word(&row.weight),
            hint: "low, high",
            say: |text, row| {
                row.weight = said(text);
                Ok(())
            },
        },
        Field {
            name: "mass [kg]",
            value: figure(row.mass_kg),
            hint: "kg",
            say: |text, row| {
                row.mass_kg = typed_number(text)?;
                Ok(())
            },
        },
    ];
    fields.extend([
        Field {
            name: "inputs",
            value: channel_names(&part.found.inputs, rule.and_then(|rule| rule.inputs.as_deref())),
            hint: "in the file's order: LON, LAT",
            say: |text, row| {
                row.inputs = said_names(text);
                Ok(())
            },
        },
        Field {
            name: "outputs",
            value: channel_names(&part.found.outputs, rule.and_then(|rule| rule.outputs.as_deref())),
            hint: "in the file's order: P, Q",
            say: |text, row| {
                row.outputs = said_names(text);
                Ok(())
            },
        },
    ]);
    match row.role {
        Some(RowRole::Identified) => fields.push(Field {
            name: "method",
            value: word(&row.method),
            hint: "CT-PBSID",
            say: |text, row| {
                row.method = said(text);
                Ok(())
            },
        }),
        _ => fields.push(Field {
            name: "trim",
            value: trim_words(&row.perturbation),
            hint: "roll_deg 5, airspeed_kt -10",
            say: say_trim,
        }),
    }
    fields
}

/// The channels of a file in its own order, as they are said to be or as the file calls them; "?" where it does not.
fn channel_names(labels: &[ChannelLabel], said: Option<&[String]>) -> String {
    let of_file = || labels.iter().map(|label| label.name.clone().unwrap_or_else(|| "?".to_owned())).collect();
    said.map_or_else(of_file, <[String]>::to_vec).join(", ")
}

/// "LON, LAT, PED, COL"; an empty text says nothing.
fn said_names(text: &str) -> Option<Vec<String>> {
    said(text).map(|text| text.split(',').map(|name| name.trim().to_owned()).collect())
}

fn said(text: &str) -> Option<String> {
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}

fn say_condition(text: &str, row: &mut RowRule) -> Result<(), String> {
    let text = text.trim();
    row.condition = match text.is_empty() {
        true => None,
        false => Some(text.parse().map_err(|_| format!("expected a whole number, found \"{text}\""))?),
    };
    Ok(())
}

fn trim_words(perturbation: &BTreeMap<String, f64>) -> String {
    perturbation.iter().map(|(coordinate, by)| format!("{coordinate} {}", number(*by))).collect::<Vec<_>>().join(", ")
}

/// "roll_deg 5, airspeed_kt -10": a coordinate and its offset, separated by commas.
fn say_trim(text: &str, row: &mut RowRule) -> Result<(), String> {
    let mut offsets = BTreeMap::new();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let wrong = || format!("expected a coordinate and a number as in \"roll_deg 5\", found \"{part}\"");
        let (coordinate, by) = part.rsplit_once(' ').ok_or_else(wrong)?;
        let by = typed_number(by)?.ok_or_else(wrong)?;
        offsets.insert(coordinate.trim().to_owned(), by);
    }
    row.perturbation = Some(offsets);
    Ok(())
}

const HEADING_WIDTH: f32 = 180.0;
/// More columns than this are counted.
const MOST_COLUMNS: usize = 60;

/// A field for the heading of each column of a file; the file is read again by what is said.
pub(super) fn columns_ui(
    ui: &mut Ui,
    bench: &AssemblyState,
    file: &str,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(headings) = bench.tables.get(file) else { return };
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(RichText::new(format!("Columns of {file}")).strong());
    ui.label(small(
        "What each holds, and its unit: omega [rad/s], f [Hz], mag P/LAT [dB], phase [deg], re, im, coherence".into(),
    ));
    Grid::new(("columns", file)).num_columns(2).spacing([6.0, 3.0]).show(ui, |ui| {
        for (column, heading) in headings.iter().enumerate().take(MOST_COLUMNS) {
            ui.label(format!("column {}", column + 1));
            let name = format!("Heading of column {} of {file}", column + 1);
            if let Some(said) = entry_ui(ui, &name, heading, "not used", HEADING_WIDTH) {
                let rules = bench.with_heading(file, column, &said);
                commands.push(AssemblingCommand::Change(Box::new(rules)).into());
            }
            ui.end_row();
        }
    });
    if headings.len() > MOST_COLUMNS {
        ui.label(small(format!("and {} more, to be said in the rules file", headings.len() - MOST_COLUMNS)));
    }
}

const HEIGHT: f32 = 20.0;

/// A text field of this accessible name that shows `value`; gives what was typed once the field is left or Enter is pressed.
pub fn entry_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::unique(("entry", name));
    let held = ui.data(|data| data.get_temp::<String>(id));
    let mut text = held.unwrap_or_else(|| value.to_owned());
    let edit = TextEdit::singleline(&mut text).id(id.with("field")).hint_text(hint);
    let response = ui.add_sized(vec2(width, HEIGHT), edit);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, name);
        info.current_text_value = Some(text.clone());
        info
    });
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
    fn a_trim_is_said_in_words_and_comes_back_in_the_same_words() {
        let mut row = RowRule::default();
        say_trim("roll_deg 5, airspeed_kt -10", &mut row).unwrap();
        assert_eq!(trim_words(&row.perturbation.clone().unwrap()), "airspeed_kt -10, roll_deg 5");
        assert!(say_trim("roll", &mut row).unwrap_err().contains("roll_deg 5"));
        say_condition("3", &mut row).unwrap();
        assert_eq!(row.condition, Some(3));
        assert!(say_condition("three", &mut row).is_err());
    }

    #[test]
    fn a_number_is_taken_with_a_comma_or_a_point_and_nothing_else_is() {
        assert_eq!(typed_number(" 1,5 "), Ok(Some(1.5)));
        assert_eq!(typed_number(""), Ok(None));
        assert!(typed_number("12 kt").is_err() && typed_number("inf").is_err());
    }
}
