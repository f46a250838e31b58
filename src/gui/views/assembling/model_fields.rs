//! Text fields for the displayed model: condition, flight state, channels, sample time, trim. A
//! *part* is a model that was found in the files, with the settings that the rules give it; its
//! *row rule* has the settings for this model alone.

use egui::{Role, Ui};

use gdcm_model::assembly::part::Part;
use gdcm_model::assembly::{ChannelLabel, RowRule};
use gdcm_model::names::RowRole;
use gdcm_model::units::number;

use super::rule_setters::{set_condition, set_factors, set_signs, set_trim, set_units};
use super::typed_rules::{number_text, typed_names, typed_text, unit_text};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::number_entry::typed_number;
use crate::gui::widgets::text_fields::entry_ui;
use crate::message::Message;

const FIELD_WIDTH: f32 = 200.0;

/// How a field's text changes a model's rule. The first three kinds return the place in the rule
/// that receives the parsed text; an empty text removes the setting.
enum Effect {
    Text(fn(&mut RowRule) -> &mut Option<String>),
    Number(fn(&mut RowRule) -> &mut Option<f64>),
    Names(fn(&mut RowRule) -> &mut Option<Vec<String>>),
    /// Parses the text and changes the rule; the error is the reason for refusing the text.
    Parsed(fn(&mut RowRule, &str) -> Result<(), String>),
}

struct Field {
    name: &'static str,
    value: String,
    hint: &'static str,
    effect: Effect,
}

impl Field {
    fn new(name: &'static str, value: Option<String>, hint: &'static str, effect: Effect) -> Self {
        Self {
            name,
            value: value.unwrap_or_default(),
            hint,
            effect,
        }
    }

    /// Changes `rule` as the text requires, or returns the reason for refusing the text.
    fn apply(&self, text: &str, rule: &mut RowRule) -> Result<(), String> {
        match self.effect {
            Effect::Text(place) => *place(rule) = typed_text(text),
            Effect::Number(place) => {
                *place(rule) = typed_number(text).map_err(|refusal| refusal.text)?;
            }
            Effect::Names(place) => *place(rule) = typed_names(text),
            Effect::Parsed(set) => set(rule, text)?,
        }
        Ok(())
    }
}

/// Draws a grid row for each field.
pub(super) fn model_fields_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    part: &Part,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    let rule = rules.rows.get(&part.found.key());
    let mut fields = condition_fields(part);
    fields.extend(channel_fields(part, rule));
    fields.push(sample_time_field(part));
    fields.push(origin_field(part));
    for field in fields {
        field_ui(ui, assembly, &field, rule, commands);
    }
}

fn field_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    field: &Field,
    rule: Option<&RowRule>,
    commands: &mut Vec<Command>,
) {
    ui.label(field.name);
    let name = format!("Model {}", field.name);
    if let Some(text) = entry_ui(ui, &name, &field.value, field.hint, FIELD_WIDTH) {
        let mut changed = rule.cloned().unwrap_or_default();
        commands.push(match field.apply(&text, &mut changed) {
            Ok(()) => assembly.rule_change(assembly.selected, |rule| *rule = changed),
            Err(why) => {
                let text = format!("{}: {why}", field.name);
                Command::Form(FormCommand::Refuse(Message::new("wrong-declaration", text)))
            }
        });
    }
    if fill_down_ui(ui, field.name) {
        commands.push(assembly.fill_down_change(assembly.selected, |rule| {
            // The displayed text has the form that the field parses, so it cannot be refused.
            field.apply(&field.value, rule).unwrap_or_default();
        }));
    }
    ui.end_row();
}

/// Draws the button for copying a setting to the models below in the same folder; returns whether
/// it was clicked.
pub(super) fn fill_down_ui(ui: &mut Ui, name: &str) -> bool {
    let label = format!("Fill down {name}");
    let hint = format!("Copies {name} to every model below in the same folder");
    named(ui.small_button("↓"), Role::Button, label)
        .on_hover_text(hint)
        .clicked()
}

/// Returns the fields for condition and flight state.
fn condition_fields(part: &Part) -> Vec<Field> {
    let row = &part.row;
    vec![
        Field::new(
            "condition",
            row.condition.map(|condition| condition.to_string()),
            "a number",
            Effect::Parsed(set_condition),
        ),
        Field::new(
            "name",
            Some(row.name.clone()),
            "unique in the bundle",
            Effect::Text(|rule| &mut rule.name),
        ),
        Field::new(
            "airspeed",
            row.airspeed_kt.map(number),
            "kt",
            Effect::Number(|rule| &mut rule.airspeed_kt),
        ),
        Field::new(
            "altitude",
            row.altitude.clone(),
            "low, high",
            Effect::Text(|rule| &mut rule.altitude),
        ),
        Field::new(
            "altitude [ft]",
            row.altitude_ft.map(number),
            "ft",
            Effect::Number(|rule| &mut rule.altitude_ft),
        ),
        Field::new(
            "weight",
            row.weight.clone(),
            "low, high",
            Effect::Text(|rule| &mut rule.weight),
        ),
        Field::new(
            "mass [kg]",
            row.mass_kg.map(number),
            "kg",
            Effect::Number(|rule| &mut rule.mass_kg),
        ),
    ]
}

/// Returns the channel fields: names, signs, units, factors.
fn channel_fields(part: &Part, rule: Option<&RowRule>) -> Vec<Field> {
    let [input_labels, output_labels] = &part.labels;
    let inputs = channel_names(input_labels, rule.and_then(|rule| rule.inputs.as_ref()));
    let outputs = channel_names(output_labels, rule.and_then(|rule| rule.outputs.as_ref()));
    let signs = rule.and_then(|rule| rule.signs.as_ref());
    let units = rule.and_then(|rule| rule.units.as_ref());
    let factors = rule.and_then(|rule| rule.factors.as_ref());
    vec![
        Field::new(
            "inputs",
            Some(inputs),
            "in the file's order: LON, LAT",
            Effect::Names(|rule| &mut rule.inputs),
        ),
        Field::new(
            "outputs",
            Some(outputs),
            "in the file's order: P, Q",
            Effect::Names(|rule| &mut rule.outputs),
        ),
        Field::new(
            "signs",
            signs.map(number_text),
            "channels with the opposite sign: NZ -1",
            Effect::Parsed(set_signs),
        ),
        Field::new(
            "units",
            units.map(unit_text),
            "overrides the file: LON in",
            Effect::Parsed(set_units),
        ),
        Field::new(
            "factors",
            factors.map(number_text),
            "to the dataset's unit: LON 8",
            Effect::Parsed(set_factors),
        ),
    ]
}

fn sample_time_field(part: &Part) -> Field {
    let sample_time_s = part.sample_time_s.or(part.found.draft.timing.sample_time_s);
    Field::new(
        "sample time",
        sample_time_s.map(number),
        "s; 0 continuous",
        Effect::Number(|rule| &mut rule.sample_time_s),
    )
}

/// Returns the field for the origin: an identified model's method, or a physics model's offset from
/// trim.
fn origin_field(part: &Part) -> Field {
    let row = &part.row;
    if row.role == Some(RowRole::Identified) {
        Field::new(
            "method",
            row.method.clone(),
            "CT-PBSID",
            Effect::Text(|rule| &mut rule.method),
        )
    } else {
        Field::new(
            "trim",
            Some(number_text(&row.perturbation)),
            "roll_deg 5, airspeed_kt -10",
            Effect::Parsed(set_trim),
        )
    }
}

/// Returns the channel names in file order, from the rule or else from the file; "?" for unnamed
/// channels.
fn channel_names(labels: &[ChannelLabel], rule_names: Option<&Vec<String>>) -> String {
    if let Some(names) = rule_names {
        return names.join(", ");
    }
    labels
        .iter()
        .map(|label| label.name.as_deref().unwrap_or("?"))
        .collect::<Vec<_>>()
        .join(", ")
}
