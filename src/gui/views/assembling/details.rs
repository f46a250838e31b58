//! Details of one model: its settings, the columns of its file, and its response.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Grid, RichText, Role, Ui};
use nalgebra::Complex;

use gdcm_io::formats::text::UnsaidUnit;
use gdcm_model::assembly::declarations::Signs;
use gdcm_model::assembly::part::Part;
use gdcm_model::assembly::{ChannelLabel, FoundModel, RowRule};
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dynamics, ModelId, Pair, StateSpace};
use gdcm_model::names::RowRole;
use gdcm_model::response::frequency_response::ResponseShape;
use gdcm_model::response::{FrequencyGrid, PreparedModel};
use gdcm_model::units::number;
use gdcm_plot::figure::axis::FrequencyUnit;

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::{BodeCurve, BodeScene, CurveId, Role as CurveRole, bode_ui};
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::choices::{check_ui, choice_ui};
use crate::gui::widgets::controls::{entry_ui, named, typed_number};
use crate::gui::widgets::palette::Palette;

const FIELD_WIDTH: f32 = 200.0;

/// How a field's text changes the rule of a model.
enum Says {
    Text(fn(&mut RowRule) -> &mut Option<String>),
    Number(fn(&mut RowRule) -> &mut Option<f64>),
    Names(fn(&mut RowRule) -> &mut Option<Vec<String>>),
    Other(fn(&str, &mut RowRule) -> Result<(), String>),
}

/// A field: its name, its current text, and its effect on the rule.
struct Field {
    name: &'static str,
    value: String,
    hint: &'static str,
    says: Says,
}

impl Field {
    fn say(&self, text: &str, row: &mut RowRule) -> Result<(), String> {
        match self.says {
            Says::Text(place) => *place(row) = said(text),
            Says::Number(place) => *place(row) = typed_number(text)?,
            Says::Names(place) => *place(row) = said_names(text),
            Says::Other(say) => say(text, row)?,
        }
        Ok(())
    }
}

/// Draws the fields of the displayed model.
pub(super) fn details_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let selected = assembly.selected;
    let Some(part) = assembly.assembly().parts().get(selected) else {
        ui.label(palette.dim("No model yet: add a folder or files above"));
        return;
    };
    ui.label(RichText::new(part.found.key()).strong());
    ui.label(palette.small(part.found.words()));
    let hint = "Whether it becomes part of the dataset";
    if let Some(included) = check_ui(ui, !part.row.left_out, "Include this model", hint) {
        commands.push(assembly.said_of(selected, |row| row.left_out = Some(!included)));
    }
    Grid::new("details of a model")
        .num_columns(3)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            role_ui(ui, assembly, part, commands);
            for field in fields(
                part,
                assembly.assembly().rules().rows.get(&part.found.key()),
            ) {
                field_ui(ui, assembly, &field, commands);
            }
        });
    if assembly.tables.contains_key(part.found.file()) {
        columns_ui(ui, assembly, part.found.file(), palette, commands);
    }
    for side in part.sides_by_position() {
        let words = format!(
            "caution: {side}s have no names in the file: taken in the order of the dataset"
        );
        ui.label(palette.small_warning(words));
    }
    let notes = part
        .found
        .notes
        .iter()
        .chain(&part.inputs.notes)
        .chain(&part.outputs.notes);
    let uses = part.inputs.uses.iter().chain(&part.outputs.uses).flatten();
    for note in notes
        .cloned()
        .chain(uses.filter_map(|used| used.words.clone()))
    {
        ui.label(palette.small(note));
    }
}

fn role_ui(ui: &mut Ui, assembly: &AssemblyState, part: &Part, commands: &mut Vec<Command>) {
    ui.label("role");
    let mut role = part.row.role;
    let roles = RowRole::ALL.map(|role| {
        (
            Some(role),
            role.word(),
            "What the model is in its condition",
        )
    });
    choice_ui(ui, "Role of the model", &mut role, &roles);
    if role != part.row.role {
        commands.push(assembly.said_of(assembly.selected, |row| row.role = role));
    }
    if fill_ui(ui, "role") {
        commands.push(assembly.filled_down(assembly.selected, |row| row.role = part.row.role));
    }
    ui.end_row();
}

/// Draws a button that copies the setting to the models below in the same folder.
fn fill_ui(ui: &mut Ui, name: &str) -> bool {
    let name = format!("Fill down {name}");
    let hint = format!("{name}: the same for every model below it in the same folder");
    named(ui.small_button("↓"), Role::Button, name)
        .on_hover_text(hint)
        .clicked()
}

fn field_ui(ui: &mut Ui, assembly: &AssemblyState, field: &Field, commands: &mut Vec<Command>) {
    ui.label(field.name);
    let name = format!("Model {}", field.name);
    if let Some(text) = entry_ui(ui, &name, &field.value, field.hint, FIELD_WIDTH) {
        let mut refusal = None;
        let command = assembly.said_of(assembly.selected, |row| {
            refusal = field.say(&text, row).err()
        });
        commands.push(refusal.map_or(command, |why| {
            Command::Form(FormCommand::Refuse(format!("{}: {why}", field.name)))
        }));
    }
    if fill_ui(ui, field.name) {
        // A field's text was accepted before.
        commands.push(
            assembly.filled_down(assembly.selected, |row| drop(field.say(&field.value, row))),
        );
    }
    ui.end_row();
}

fn fields(part: &Part, rule: Option<&RowRule>) -> Vec<Field> {
    let row = &part.row;
    let found = &part.found;
    let field = |name, value: Option<String>, hint, says| Field {
        name,
        value: value.unwrap_or_default(),
        hint,
        says,
    };
    let [inputs, outputs] = [ChannelSide::Input, ChannelSide::Output].map(|side| {
        let [of_inputs, of_outputs] = &part.labels;
        let said = rule.and_then(|rule| side.of(rule.inputs.as_ref(), rule.outputs.as_ref()));
        channel_names(side.of(of_inputs, of_outputs), said)
    });
    let condition = row.condition.map(|of| of.to_string());
    let trim = Some(trim_words(&row.perturbation));
    let signs = rule.and_then(|rule| rule.signs.as_ref()).map(trim_words);
    let units = rule.and_then(|rule| rule.units.as_ref()).map(unit_words);
    let factors = rule.and_then(|rule| rule.factors.as_ref()).map(trim_words);
    let sample_time = part
        .sample_time_s
        .or(found.draft.timing.sample_time_s)
        .map(number);
    vec![
        field(
            "condition",
            condition,
            "a number",
            Says::Other(say_condition),
        ),
        field(
            "name",
            Some(row.name.clone()),
            "in its bundle",
            Says::Text(|row| &mut row.name),
        ),
        field(
            "airspeed",
            row.airspeed_kt.map(number),
            "kt",
            Says::Number(|row| &mut row.airspeed_kt),
        ),
        field(
            "altitude",
            row.altitude.clone(),
            "low, high",
            Says::Text(|row| &mut row.altitude),
        ),
        field(
            "altitude [ft]",
            row.altitude_ft.map(number),
            "ft",
            Says::Number(|row| &mut row.altitude_ft),
        ),
        field(
            "weight",
            row.weight.clone(),
            "low, high",
            Says::Text(|row| &mut row.weight),
        ),
        field(
            "mass [kg]",
            row.mass_kg.map(number),
            "kg",
            Says::Number(|row| &mut row.mass_kg),
        ),
        field(
            "inputs",
            Some(inputs),
            "in the file's order: LON, LAT",
            Says::Names(|row| &mut row.inputs),
        ),
        field(
            "outputs",
            Some(outputs),
            "in the file's order: P, Q",
            Says::Names(|row| &mut row.outputs),
        ),
        field(
            "signs",
            signs,
            "of channels with the other sign: NZ -1",
            Says::Other(say_signs),
        ),
        field(
            "units",
            units,
            "whatever the file says: LON in",
            Says::Other(say_units),
        ),
        field(
            "factors",
            factors,
            "to the dataset's unit: LON 8",
            Says::Other(say_factors),
        ),
        field(
            "sample time",
            sample_time,
            "s; 0 continuous",
            Says::Number(|row| &mut row.sample_time_s),
        ),
        match row.role {
            Some(RowRole::Identified) => field(
                "method",
                row.method.clone(),
                "CT-PBSID",
                Says::Text(|row| &mut row.method),
            ),
            _ => field(
                "trim",
                trim,
                "roll_deg 5, airspeed_kt -10",
                Says::Other(say_trim),
            ),
        },
    ]
}

/// Returns the channels in the file's own order, with the names from the rules or the file; "?" for
/// unnamed ones.
fn channel_names(labels: &[ChannelLabel], said: Option<&Vec<String>>) -> String {
    let of_file = || {
        labels
            .iter()
            .map(|label| label.name.clone().unwrap_or_else(|| "?".to_owned()))
            .collect()
    };
    said.cloned().unwrap_or_else(of_file).join(", ")
}

/// Parses "LON, LAT, PED, COL"; an empty text sets nothing.
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
        false => Some(
            text.parse()
                .map_err(|_| format!("expected a whole number, found \"{text}\""))?,
        ),
    };
    Ok(())
}

pub(super) fn trim_words(perturbation: &BTreeMap<String, f64>) -> String {
    perturbation
        .iter()
        .map(|(coordinate, by)| format!("{coordinate} {}", number(*by)))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Parses "roll_deg 5, airspeed_kt -10": coordinates and offsets, separated by commas.
fn say_trim(text: &str, row: &mut RowRule) -> Result<(), String> {
    row.perturbation = Some(numbers_by_name(
        text,
        "a coordinate and a number as in \"roll_deg 5\"",
    )?);
    Ok(())
}

/// Parses "NZ -1, R 1": channels of the dataset and their signs, separated by commas; an empty text
/// sets nothing.
fn say_signs(text: &str, row: &mut RowRule) -> Result<(), String> {
    row.signs = Some(signs_of(text)?).filter(|signs| !signs.is_empty());
    Ok(())
}

pub(super) fn signs_of(text: &str) -> Result<Signs, String> {
    let signs = numbers_by_name(text, "a channel and 1 or -1 as in \"NZ -1\"")?;
    match signs.iter().find(|(_, sign)| sign.abs() != 1.0) {
        Some((channel, sign)) => Err(format!(
            "the sign of {channel}: expected 1 or -1, found {}",
            number(*sign)
        )),
        None => Ok(signs),
    }
}

/// Parses "LON in, Q rad/s": channels of the dataset and their units in the file; an empty text
/// sets nothing.
fn say_units(text: &str, row: &mut RowRule) -> Result<(), String> {
    let units = units_of(text)?;
    // A channel has either a unit or a factor.
    if let Some(factors) = &mut row.factors {
        factors.retain(|channel, _| !units.contains_key(channel));
    }
    row.units = Some(units).filter(|units| !units.is_empty());
    Ok(())
}

/// Parses "LON 8, NZ -9.81": channels of the dataset and their factors; an empty text sets nothing.
fn say_factors(text: &str, row: &mut RowRule) -> Result<(), String> {
    let factors = factors_of(text)?;
    if let Some(units) = &mut row.units {
        units.retain(|channel, _| !factors.contains_key(channel));
    }
    row.factors = Some(factors).filter(|factors| !factors.is_empty());
    Ok(())
}

pub(super) fn factors_of(text: &str) -> Result<BTreeMap<String, f64>, String> {
    let factors = numbers_by_name(text, "a channel and a number other than 0 as in \"LON 8\"")?;
    match factors.iter().find(|(_, factor)| **factor == 0.0) {
        Some((channel, _)) => Err(format!(
            "the factor of {channel}: expected a number other than 0"
        )),
        None => Ok(factors),
    }
}

pub(super) fn units_of(text: &str) -> Result<BTreeMap<String, String>, String> {
    let mut units = BTreeMap::new();
    for part in text
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
    {
        let Some((channel, unit)) = part.rsplit_once(' ') else {
            return Err(format!(
                "expected a channel and its unit as in \"LON in\", found \"{part}\""
            ));
        };
        units.insert(channel.trim().to_owned(), unit.to_owned());
    }
    Ok(units)
}

pub(super) fn unit_words(units: &BTreeMap<String, String>) -> String {
    units
        .iter()
        .map(|(channel, unit)| format!("{channel} {unit}"))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Parses names and numbers, separated by commas.
fn numbers_by_name(text: &str, expected: &str) -> Result<BTreeMap<String, f64>, String> {
    let mut offsets = BTreeMap::new();
    for part in text
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
    {
        let wrong = || format!("expected {expected}, found \"{part}\"");
        let (coordinate, by) = part.rsplit_once(' ').ok_or_else(wrong)?;
        let by = typed_number(by)?.ok_or_else(wrong)?;
        offsets.insert(coordinate.trim().to_owned(), by);
    }
    Ok(offsets)
}

const HEADING_WIDTH: f32 = 180.0;
/// Maximum number of displayed columns; further ones are only counted.
const MOST_COLUMNS: usize = 60;

/// Shows a field for the heading of each column of a file; a changed heading causes the file to be
/// read again.
pub(super) fn columns_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    file: &str,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(headings) = assembly.tables.get(file) else {
        return;
    };
    ui.label(RichText::new(format!("Columns of {file}")).strong());
    let hint = "What each holds, and its unit: omega [rad/s], f [Hz], mag P/LAT [dB], phase [deg], re, im, coherence";
    ui.label(palette.small(hint));
    Grid::new(("columns", file))
        .num_columns(3)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (column, heading) in headings.iter().enumerate().take(MOST_COLUMNS) {
                ui.label(format!("column {}", column + 1));
                let name = format!("Heading of column {} of {file}", column + 1);
                if let Some(said) = entry_ui(ui, &name, heading, "not used", HEADING_WIDTH) {
                    commands.push(assembly.with_heading(file, column, &said));
                }
                units_ui(ui, assembly, (file, column), commands);
                ui.end_row();
            }
        });
    if headings.len() > MOST_COLUMNS {
        let more = headings.len() - MOST_COLUMNS;
        ui.label(palette.small(format!("and {more} more, which the rules file can name")));
    }
}

/// Shows buttons for the possible units of a column if neither its heading nor its numbers
/// determine the unit.
fn units_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    (file, column): (&str, usize),
    commands: &mut Vec<Command>,
) {
    let asked = assembly
        .unsaid
        .get(file)
        .and_then(|asked| asked.iter().find(|of| of.column == column));
    let Some(UnsaidUnit { units, .. }) = asked else {
        return;
    };
    let files = assembly.tables_alike(file).len();
    ui.horizontal(|ui| {
        for unit in units {
            let button =
                named(ui.small_button(*unit), Role::Button, format!("Column {} of {file} is in {unit}", column + 1));
            let hint = match files {
                1 => format!("Its numbers are in {unit}"),
                _ => {
                    format!("Its numbers are in {unit}, here and in the {} other tables with these headings", files - 1)
                }
            };
            if button.on_hover_text(hint).clicked() {
                commands.push(assembly.with_unit(file, column, unit));
            }
        }
    });
}

/// Number of frequencies of the curve.
const POINTS: usize = 300;
/// Factor by which the curve extends beyond the comparison band on either side.
const BEYOND: f64 = 3.0;

/// Shows the response of the displayed model, and a choice of responses.
pub(super) fn preview_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // A panel without content would shrink.
    ui.set_min_size(ui.available_size());
    let selected = assembly.selected;
    let band = assembly.assembly().rules().band;
    let Some(found) = assembly
        .assembly()
        .parts()
        .get(selected)
        .map(|part| part.found.clone())
    else {
        return;
    };
    let count = (found.inputs.len() * found.outputs.len()).max(1);
    let place = assembly.preview.response.min(count - 1);
    let names: Vec<String> = (0..count).map(|place| pair_name(&found, place)).collect();
    let choices: Vec<(usize, &str, &str)> = names
        .iter()
        .enumerate()
        .map(|(place, name)| (place, name.as_str(), "Response shown"))
        .collect();
    let mut chosen = place;
    choice_ui(ui, "Response of the preview", &mut chosen, &choices);
    if chosen != place {
        commands.push(AssemblingCommand::ShowResponse(chosen).into());
    }
    let key = found.key();
    if assembly
        .preview
        .drawn
        .as_ref()
        .is_none_or(|(of, at, _)| (of, *at) != (&key, place))
    {
        let is_other_model = assembly
            .preview
            .drawn
            .as_ref()
            .is_none_or(|(of, ..)| *of != key);
        assembly.preview.drawn =
            Some((key, place, curve(&found, place, band).into_iter().collect()));
        // A measured response may have other frequencies than the previous model.
        if is_other_model {
            assembly.preview.view.request_fit();
        } else {
            assembly.preview.view.request_refit();
        }
    }
    let Some((_, _, curves)) = &assembly.preview.drawn else {
        return;
    };
    let scene = BodeScene {
        quantity: BodeQuantity::RESPONSE_OF_FOUND_MODEL,
        unit: FrequencyUnit::default(),
        message: Some("This response cannot be computed"),
        ..BodeScene::new(&names[place], curves, band)
    };
    bode_ui(ui, &scene, &mut assembly.preview.view, palette);
}

/// Returns "LON → Q", with the file's own names.
fn pair_name(found: &FoundModel, place: usize) -> String {
    let inputs = found.inputs.len().max(1);
    let name = |labels: &[ChannelLabel], index: usize, side: &str| {
        labels
            .get(index)
            .and_then(|label| label.name.clone())
            .unwrap_or_else(|| format!("{side} {}", index + 1))
    };
    format!(
        "{} → {}",
        name(&found.inputs, place % inputs, "input"),
        name(&found.outputs, place / inputs, "output")
    )
}

fn curve(found: &FoundModel, place: usize, band: (f64, f64)) -> Option<BodeCurve> {
    let pair = Pair::new(
        place / found.inputs.len().max(1),
        place % found.inputs.len().max(1),
    );
    let (omega, values) = match found.response() {
        Some(response) => {
            let count = response.omega.len();
            let range = place * count..(place + 1) * count;
            let parts = response
                .re
                .values
                .get(range.clone())?
                .iter()
                .zip(response.im.values.get(range)?);
            (
                response.omega.clone(),
                parts
                    .map(|(re, im)| Complex::new(*re, *im))
                    .collect::<Vec<_>>(),
            )
        }
        None => {
            let [a, b, c, d] = found.draft.matrices.clone();
            let model = StateSpace::new(a?, b?, c?, d?)
                .ok()?
                .timed(found.draft.timing.clone())
                .ok()?;
            let wide = Band::new(band.0 / BEYOND, band.1 * BEYOND).ok()?;
            let grid = FrequencyGrid::logarithmic(wide, POINTS);
            let response = PreparedModel::of(&Dynamics::StateSpace(model)).response(&grid);
            (grid.omega().to_vec(), response.curve(pair).to_vec())
        }
    };
    let shape = ResponseShape::new(&values);
    Some(BodeCurve {
        id: CurveId::Model(ModelId::new(
            ConditionId(0),
            BundleKind::Physics,
            found.key(),
        )),
        label: found.key(),
        detail: found.words(),
        role: CurveRole::Representative,
        rejected: false,
        highlighted: false,
        hidden: false,
        omega: Arc::from(omega),
        magnitude_db: shape.magnitude_db,
        phase_deg: shape.phase_deg,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trim_is_said_in_words_and_comes_back_in_the_same_words() {
        let mut row = RowRule::default();
        say_trim("roll_deg 5, airspeed_kt -10", &mut row).unwrap();
        assert_eq!(
            trim_words(&row.perturbation.clone().unwrap()),
            "airspeed_kt -10, roll_deg 5"
        );
        assert!(
            say_trim("roll", &mut row)
                .unwrap_err()
                .contains("roll_deg 5")
        );
        say_signs("NZ -1", &mut row).unwrap();
        assert_eq!(
            row.signs.as_ref().and_then(|signs| signs.get("NZ")),
            Some(&-1.0)
        );
        assert!(
            say_signs("NZ -2", &mut row)
                .unwrap_err()
                .contains("1 or -1")
        );
        say_units("LON in, roll rate rad/s", &mut row).unwrap();
        assert_eq!(
            unit_words(&row.units.clone().unwrap()),
            "LON in, roll rate rad/s"
        );
        say_factors("LON 8", &mut row).unwrap();
        assert_eq!(
            unit_words(&row.units.clone().unwrap()),
            "roll rate rad/s",
            "a unit or a factor"
        );
        assert_eq!(
            row.factors.as_ref().map(trim_words).as_deref(),
            Some("LON 8")
        );
        assert!(say_units("in", &mut row).is_err() && say_factors("LON 0", &mut row).is_err());
        say_condition("3", &mut row).unwrap();
        assert_eq!(row.condition, Some(3));
        assert!(say_condition("three", &mut row).is_err());
    }
}
