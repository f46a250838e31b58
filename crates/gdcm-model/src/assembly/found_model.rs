//! A model as read from a file, its role in the dataset, and the rules proposed where none exist
//! yet.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::channel_match::{SignedName, same_channel};
use super::physical_unit::conversion_factor;
use super::problem::ProblemKind;
use super::response_name::{KnownChannels, ResponseName};
use super::rules::{ChannelRule, Rules, unread_offsets};
use crate::dataset::channel::ChannelSide;
use crate::dataset::condition::ConditionRecord;
use crate::dataset::model::Origin;
use crate::dataset::unchecked_dataset::{ModelDraft, ResponseDraft};
use crate::units::number;

/// Name and unit of one channel as given by a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLabel {
    /// `None` where the file gives none.
    pub name: Option<String>,
    /// `None` where the file gives none.
    pub unit: Option<String>,
}

impl ChannelLabel {
    /// Returns a label with this name and no unit.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: Some(name.into()),
            unit: None,
        }
    }
}

/// Facts about the flight condition of a model from its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    pub condition: Option<i64>,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    pub name: Option<String>,
    /// Whether these facts come from a dataset of this program: names of files and folders then do
    /// not contradict them.
    pub is_of_dataset: bool,
    /// Its flight records, with files relative to the requested path.
    pub records: Vec<ConditionRecord>,
}

/// A model as read from a file: channels in the file's order and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundModel {
    /// Numbers, timing, states and provenance. The name is the variable's; the origin is not set
    /// yet.
    pub draft: ModelDraft,
    pub inputs: Vec<ChannelLabel>,
    pub outputs: Vec<ChannelLabel>,
    pub facts: Facts,
    /// How it was recognised and which parts were skipped, in words.
    pub notes: Vec<String>,
}

impl FoundModel {
    /// Returns its source file; empty where there is none.
    pub fn file(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.file.as_deref())
            .unwrap_or_default()
    }

    /// Returns the variable in the file; empty where the file holds one unnamed model.
    pub fn variable(&self) -> &str {
        self.draft
            .source
            .as_ref()
            .and_then(|source| source.variable.as_deref())
            .unwrap_or_default()
    }

    /// Returns its key in messages and rules: "c03/roll+5.mat#sys".
    pub fn key(&self) -> String {
        match self.variable() {
            "" => self.file().to_owned(),
            variable => format!("{}#{variable}", self.file()),
        }
    }

    /// Returns the channel names. Where the file gives none for a single measured response, they
    /// come from the variable, or else from the file name, as far as those name known channels.
    pub fn labels_with_name(&self, known: KnownChannels<'_>) -> NamedLabels {
        let mut named = NamedLabels {
            labels: [self.inputs.clone(), self.outputs.clone()],
            problem: None,
        };
        if self.response().is_none() || self.inputs.len() != 1 || self.outputs.len() != 1 {
            return named;
        }
        let stem = without_extension(self.file())
            .rsplit('/')
            .next()
            .unwrap_or_default()
            .to_owned();
        for text in [self.variable(), stem.as_str()] {
            if named.labels.iter().all(|labels| labels[0].name.is_some()) {
                break;
            }
            match ResponseName::find(text, known) {
                Ok(found) => {
                    // A known channel that the dataset lacks is not replaced by another.
                    let of_field =
                        ResponseName::find(text, KnownChannels::Field).unwrap_or_default();
                    let input = found.input.or(of_field.input);
                    let output = found.output.or(of_field.output);
                    for (labels, name) in named.labels.iter_mut().zip([input, output]) {
                        labels[0].name = labels[0].name.take().or(name);
                    }
                }
                Err(error) => {
                    let name = text.to_owned();
                    named.problem = named
                        .problem
                        .or(Some(ProblemKind::ResponseName { name, error }));
                }
            }
        }
        if named.labels.iter().all(|labels| labels[0].name.is_some()) {
            named.problem = None;
        }
        named
    }

    /// Names the channels from the file name where nothing else does, as far as the names are known
    /// in the field.
    pub fn with_names_of_file(mut self) -> Self {
        [self.inputs, self.outputs] = self.labels_with_name(KnownChannels::Field).labels;
        self
    }

    /// Returns the measured response, if there is one.
    pub fn response(&self) -> Option<&ResponseDraft> {
        self.draft.response.as_ref()
    }

    /// Describes the model: "39 states, 4 x 6", "measured, 120 frequencies, 1 x 1".
    pub fn words(&self) -> String {
        let channels = format!("{} in, {} out", self.inputs.len(), self.outputs.len());
        let timing = self.draft.timing.words();
        let timing = if timing.is_empty() {
            timing
        } else {
            format!(", {timing}")
        };
        match (&self.draft.response, &self.draft.matrices[0]) {
            (Some(response), _) => format!(
                "measured at {} frequencies, {channels}",
                response.omega.len()
            ),
            (None, Some(a)) => format!("{} states, {channels}{timing}", a.nrows()),
            (None, None) => channels,
        }
    }
}

/// Channel names of a model, with the problem where the name that provides them is ambiguous.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedLabels {
    pub labels: [Vec<ChannelLabel>; 2],
    /// Why the name of the file or of the variable does not give the channels.
    pub problem: Option<ProblemKind>,
}

/// The role of a model in its condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RowRole {
    /// The physics model at the condition's trim.
    Nominal,
    /// A physics model at a perturbed trim.
    Perturbed,
    /// Identified from flight, or measured.
    Identified,
}

impl RowRole {
    /// All roles.
    pub const ALL: [Self; 3] = [Self::Nominal, Self::Perturbed, Self::Identified];

    /// Returns its keyword in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Perturbed => "perturbed",
            Self::Identified => "identified",
        }
    }

    /// Parses a role keyword.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.word() == word)
    }
}

/// The place of one model in the dataset, as far as known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    pub left_out: bool,
    pub condition: Option<i64>,
    pub role: Option<RowRole>,
    /// Its name in its bundle.
    pub name: String,
    /// True airspeed of the condition \[kt\].
    pub airspeed_kt: Option<f64>,
    pub altitude: Option<String>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    pub weight: Option<String>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    pub method: Option<String>,
    /// Offsets of the trim, by coordinate ("roll_deg").
    pub perturbation: BTreeMap<String, f64>,
    /// Parts of its name that look like a trim offset and are not understood.
    pub unread: Vec<String>,
    /// Values in the file that contradict the names of the file and its folders.
    pub contradictions: Vec<NameContradiction>,
}

/// A number in a file that contradicts the names of the file and its folders.
#[derive(Clone, Debug, PartialEq)]
pub struct NameContradiction {
    /// The quantity, by its name in the rules: "airspeed_kt".
    pub field: String,
    pub of_file: f64,
    pub of_name: f64,
}

impl Row {
    /// Formats the airspeed: "45 kt"; `None` where unknown.
    pub fn airspeed_words(&self) -> Option<String> {
        self.airspeed_kt
            .map(|airspeed| format!("{} kt", number(airspeed)))
    }

    /// Formats the altitude: "high", or else "2000 ft"; empty where unknown.
    pub fn altitude_words(&self) -> String {
        self.altitude
            .clone()
            .or(self.altitude_ft.map(|feet| format!("{} ft", number(feet))))
            .unwrap_or_default()
    }

    /// Formats the weight: "low", or else "6600 kg"; empty where unknown.
    pub fn weight_words(&self) -> String {
        self.weight
            .clone()
            .or(self.mass_kg.map(|mass| format!("{} kg", number(mass))))
            .unwrap_or_default()
    }
}

/// On-axis responses of a helicopter, output and input (the paper's Table 2).
const ON_AXIS: [(&str, &str); 5] = [
    ("P", "LAT"),
    ("Q", "LON"),
    ("R", "PED"),
    ("NY", "PED"),
    ("NZ", "COL"),
];

/// Returns whether a response is on-axis for a helicopter, by the names of its output and its
/// input.
pub fn standard_on_axis(output: &str, input: &str) -> bool {
    ON_AXIS.iter().any(|(of_output, of_input)| {
        same_channel(output, of_output) && same_channel(input, of_input)
    })
}

/// Proposes rules: the models' channels with their names and units, the standard patterns, and the
/// on-axis responses of a helicopter among these channels. Anything the files do not determine
/// stays open.
pub fn proposed_rules(name: &str, models: &[FoundModel]) -> Rules {
    let models: Vec<LabelledModel<'_>> = models.iter().map(LabelledModel::of).collect();
    let inputs = channels(&models, ChannelSide::Input);
    let outputs = channels(&models, ChannelSide::Output);
    let find = |channels: &[ChannelRule], name: &str| {
        channels
            .iter()
            .find(|channel| same_channel(&channel.name, name))
            .map(|channel| channel.name.clone())
    };
    let on_axis = ON_AXIS
        .iter()
        .filter_map(|(output, input)| Some((find(&outputs, output)?, find(&inputs, input)?)))
        .collect();
    Rules {
        name: name.to_owned(),
        inputs,
        outputs,
        on_axis,
        ..Rules::default()
    }
}

/// A model and its channel names, from the file or from its name.
struct LabelledModel<'m> {
    found: &'m FoundModel,
    labels: [Vec<ChannelLabel>; 2],
}

impl<'m> LabelledModel<'m> {
    fn of(found: &'m FoundModel) -> Self {
        Self {
            found,
            labels: found.labels_with_name(KnownChannels::Field).labels,
        }
    }

    fn labels(&self, side: ChannelSide) -> &[ChannelLabel] {
        let [inputs, outputs] = &self.labels;
        side.of(inputs, outputs)
    }

    /// Returns whether the file itself names a channel of a side.
    fn names_itself(&self, side: ChannelSide) -> bool {
        side.of(&self.found.inputs, &self.found.outputs)
            .iter()
            .any(|label| label.name.is_some())
    }
}

/// Returns the named channels in the order of the model with the most of them; channels it lacks
/// follow.
fn channels(models: &[LabelledModel<'_>], side: ChannelSide) -> Vec<ChannelRule> {
    let named = |model: &LabelledModel<'_>| {
        model
            .labels(side)
            .iter()
            .filter(|label| label.name.is_some())
            .count()
    };
    let mut order: Vec<&LabelledModel<'_>> = models.iter().collect();
    // File names are weaker evidence than file contents.
    order.sort_by_key(|model| (std::cmp::Reverse(named(model)), !model.names_itself(side)));
    let first_is_measured = order
        .first()
        .is_some_and(|model| model.found.response().is_some());
    let mut channels: Vec<ChannelRule> = Vec::new();
    let mut units: Vec<ProposedUnits> = Vec::new();
    for model in order {
        // Models with matrices have all channels of the dataset; measured responses may have a
        // single one.
        let is_open =
            channels.is_empty() || (model.found.response().is_some() && first_is_measured);
        for label in model.labels(side) {
            // The dataset's channel has the name without its sign marks.
            let Some(name) = label.name.as_ref().map(|name| SignedName::of(name).name) else {
                continue;
            };
            let known = channels
                .iter()
                .position(|channel| same_channel(&channel.name, &name));
            let index = known.unwrap_or(channels.len());
            if known.is_none() {
                if !is_open {
                    continue;
                }
                channels.push(ChannelRule::named(name));
                units.push(ProposedUnits::default());
            }
            if let Some(unit) = label.unit.as_deref().filter(|unit| !unit.trim().is_empty()) {
                units[index].count(unit, model.found.file());
            }
        }
    }
    for (channel, units) in channels.iter_mut().zip(units) {
        channel.unit = units.of_most_files();
    }
    // Matrices without names have all channels of the dataset, whatever the name of a measured
    // response beside them.
    let all_unnamed = models
        .iter()
        .filter(|model| model.found.response().is_none())
        .all(|model| named(model) == 0);
    if channels.is_empty() || all_unnamed {
        let count = models
            .iter()
            .map(|model| model.labels(side).len())
            .max()
            .unwrap_or(0);
        let missing = channels.len() + 1..=count;
        channels.extend(missing.map(|number| ChannelRule::named(format!("{side} {number}"))));
    }
    channels
}

/// The units that files give for a channel, each with its files.
#[derive(Default)]
struct ProposedUnits<'m> {
    units: Vec<(&'m str, BTreeSet<&'m str>)>,
}

impl<'m> ProposedUnits<'m> {
    fn count(&mut self, unit: &'m str, file: &'m str) {
        // "deg/s" and "°/s" are one unit.
        let same = self
            .units
            .iter_mut()
            .find(|(known, _)| conversion_factor(known, unit) == Some(1.0));
        match same {
            Some((_, files)) => drop(files.insert(file)),
            None => self.units.push((unit, [file].into())),
        }
    }

    /// Returns the unit used by most files, the first in case of a tie; empty where no file gives
    /// one.
    fn of_most_files(&self) -> String {
        let most = self.units.iter().map(|(_, files)| files.len()).max();
        let unit = self
            .units
            .iter()
            .find(|(_, files)| Some(files.len()) == most);
        unit.map(|(unit, _)| (*unit).to_owned()).unwrap_or_default()
    }
}

/// Proposes a row for each model from names, contents and rules.
pub(super) fn proposed_rows(models: &[FoundModel], rules: &Rules) -> Vec<Row> {
    let mut rows: Vec<Row> = models
        .iter()
        .map(|model| proposed_row(model, models, rules))
        .collect();
    number_conditions(models, &mut rows);
    propose_nominal(&mut rows);
    for (model, row) in models.iter().zip(&mut rows) {
        if let Some(said) = rules.rows.get(&model.key()) {
            said.apply(row);
        }
    }
    rows
}

fn proposed_row(model: &FoundModel, all: &[FoundModel], rules: &Rules) -> Row {
    let facts = &model.facts;
    let offsets = offsets_of(&model.draft.origin);
    let mut row = Row {
        condition: facts.condition,
        role: role_of(model),
        airspeed_kt: facts.airspeed_kt,
        altitude_ft: facts.altitude_ft,
        mass_kg: facts.mass_kg,
        perturbation: offsets.clone(),
        ..Row::default()
    };
    let path = without_extension(model.file());
    let name = if model.variable().is_empty() {
        path.clone()
    } else {
        format!("{path}#{}", model.variable())
    };
    let mut of_name = Row::default();
    for pattern in &rules.patterns {
        pattern.read(&name, &mut row);
        pattern.read(&name, &mut of_name);
    }
    row.contradictions = contradictions_of_name(model, all, &of_name);
    // Other uses of a hyphen and a number ("rev-3") raise no question.
    if offsets.is_empty() && !row.perturbation.is_empty() {
        row.unread = unread_offsets(name.rsplit('/').next().unwrap_or(&name), &rules.patterns);
    }
    if let Origin::Identified { method, .. } = &model.draft.origin {
        row.role = row.role.or(Some(RowRole::Identified));
        row.method = row.method.or_else(|| method.clone());
    }
    if row.role.is_none() && model.response().is_some() {
        row.role = Some(RowRole::Identified);
    }
    let is_at_rest = row.perturbation.values().all(|offset| *offset == 0.0);
    if row.role.is_none() && !is_at_rest {
        row.role = Some(RowRole::Perturbed);
    }
    if row.name.is_empty() {
        row.name = usual_name(model, all, rules, &path);
    }
    row
}

/// Returns the role of a physics model given by the file itself. A model without facts also has the
/// origin "perturbed", which then gives no role.
fn role_of(model: &FoundModel) -> Option<RowRole> {
    match &model.draft.origin {
        Origin::Nominal { .. } => Some(RowRole::Nominal),
        Origin::Perturbed { .. } if model.facts.is_of_dataset => Some(RowRole::Perturbed),
        Origin::Identified { .. } | Origin::Perturbed { .. } => None,
    }
}

/// Returns the trim offsets that the file itself gives.
fn offsets_of(origin: &Origin) -> BTreeMap<String, f64> {
    match origin {
        Origin::Nominal { perturbation } | Origin::Perturbed { perturbation } => {
            perturbation.clone().unwrap_or_default()
        }
        Origin::Identified { .. } => BTreeMap::new(),
    }
}

/// Compares a file's values with its name and folder. Names are rounded: airspeeds differ by more
/// than 1 kt, other values by more than 1 %. The name of a file with models at several airspeeds
/// gives none of them.
fn contradictions_of_name(
    model: &FoundModel,
    all: &[FoundModel],
    of_name: &Row,
) -> Vec<NameContradiction> {
    let facts = &model.facts;
    if facts.is_of_dataset {
        return Vec::new();
    }
    let mut contradictions = Vec::new();
    if !has_several_airspeeds(all, model.file()) {
        let condition = (
            facts.condition.map(|id| id as f64),
            of_name.condition.map(|id| id as f64),
        );
        contradictions.extend(contradiction("condition", condition.0, condition.1, 0.0));
        contradictions.extend(contradiction(
            "airspeed_kt",
            facts.airspeed_kt,
            of_name.airspeed_kt,
            1.0,
        ));
        contradictions.extend(contradiction(
            "altitude_ft",
            facts.altitude_ft,
            of_name.altitude_ft,
            hundredth(facts.altitude_ft),
        ));
        contradictions.extend(contradiction(
            "mass_kg",
            facts.mass_kg,
            of_name.mass_kg,
            hundredth(facts.mass_kg),
        ));
    }
    for (coordinate, offset) in offsets_of(&model.draft.origin) {
        let of_name = of_name.perturbation.get(&coordinate).copied();
        let field = format!("perturbation, {coordinate}");
        contradictions.extend(contradiction(
            &field,
            Some(offset),
            of_name,
            hundredth(Some(offset)),
        ));
    }
    contradictions
}

fn hundredth(value: Option<f64>) -> f64 {
    0.01 * value.unwrap_or(0.0).abs()
}

/// Returns the contradiction between a number in the file and one in its names where they differ by
/// more than a tolerance.
fn contradiction(
    field: &str,
    of_file: Option<f64>,
    of_name: Option<f64>,
    tolerance: f64,
) -> Option<NameContradiction> {
    let of_file = of_file?;
    let of_name = of_name?;
    if (of_file - of_name).abs() <= tolerance {
        return None;
    }
    Some(NameContradiction {
        field: field.to_owned(),
        of_file,
        of_name,
    })
}

/// Returns whether a file holds models at several airspeeds, hence several conditions.
fn has_several_airspeeds(models: &[FoundModel], file: &str) -> bool {
    let mut airspeeds = models
        .iter()
        .filter(|model| model.file() == file)
        .filter_map(|model| model.facts.airspeed_kt);
    let first = airspeeds.next();
    airspeeds.any(|airspeed| Some(airspeed) != first)
}

/// Returns the default name: the file's name without its folder, with the variable where the file
/// holds several models; "measured" for a response that is one part of a model.
fn usual_name(model: &FoundModel, all: &[FoundModel], rules: &Rules, path: &str) -> String {
    let is_part =
        model.inputs.len() * model.outputs.len() < rules.inputs.len() * rules.outputs.len();
    if model.response().is_some() && is_part {
        return "measured".to_owned();
    }
    if let Some(name) = &model.facts.name {
        return name.clone();
    }
    let stem = path.rsplit('/').next().unwrap_or(path);
    let several = all
        .iter()
        .filter(|other| other.file() == model.file())
        .count()
        > 1;
    match (several, model.variable()) {
        (true, variable) if !variable.is_empty() => variable.to_owned(),
        _ if stem.is_empty() => model.draft.name.clone(),
        _ => stem.to_owned(),
    }
}

fn without_extension(file: &str) -> String {
    let file = file.replace('\\', "/");
    let file = file.strip_suffix(".gz").unwrap_or(&file);
    Path::new(file)
        .with_extension("")
        .to_string_lossy()
        .into_owned()
}

/// Numbers the conditions where no name does: one per folder in alphabetical order; where one file
/// holds models at several airspeeds, one per airspeed in ascending order.
fn number_conditions(models: &[FoundModel], rows: &mut [Row]) {
    if rows.iter().any(|row| row.condition.is_some()) {
        return;
    }
    let files: BTreeSet<&str> = models.iter().map(FoundModel::file).collect();
    if files
        .into_iter()
        .any(|file| has_several_airspeeds(models, file))
    {
        return number_airspeeds(rows);
    }
    let folder = |model: &FoundModel| match without_extension(model.file()).rsplit_once('/') {
        Some((folder, _)) => folder.to_owned(),
        None => String::new(),
    };
    let folders: BTreeSet<String> = models.iter().map(folder).collect();
    for (model, row) in models.iter().zip(rows) {
        row.condition = folders
            .iter()
            .position(|of| *of == folder(model))
            .map(|index| index as i64 + 1);
    }
}

/// Numbers the distinct airspeeds, with altitude and mass, in ascending order; models without an
/// airspeed get no condition.
fn number_airspeeds(rows: &mut [Row]) {
    let mut states: Vec<[f64; 3]> = rows.iter().filter_map(state_of).collect();
    states.sort_by(|one, other| one.partial_cmp(other).unwrap_or(std::cmp::Ordering::Equal));
    states.dedup();
    for row in rows {
        let place = state_of(row).and_then(|state| states.iter().position(|known| *known == state));
        row.condition = place.map(|place| place as i64 + 1);
    }
}

/// Returns airspeed, altitude and mass; unknown altitude and mass sort before all others.
fn state_of(row: &Row) -> Option<[f64; 3]> {
    Some([
        row.airspeed_kt?,
        row.altitude_ft.unwrap_or(f64::MIN),
        row.mass_kg.unwrap_or(f64::MIN),
    ])
}

/// Proposes the nominal role for the only physics model of a condition without a trim perturbation.
fn propose_nominal(rows: &mut [Row]) {
    let conditions: BTreeSet<i64> = rows.iter().filter_map(|row| row.condition).collect();
    for condition in conditions {
        let of = |row: &&mut Row| row.condition == Some(condition);
        let has_nominal = rows
            .iter_mut()
            .filter(of)
            .any(|row| row.role == Some(RowRole::Nominal));
        let mut open: Vec<&mut Row> = rows
            .iter_mut()
            .filter(of)
            .filter(|row| row.role.is_none())
            .collect();
        if let ([row], false) = (open.as_mut_slice(), has_nominal) {
            row.role = Some(RowRole::Nominal);
        }
    }
}
