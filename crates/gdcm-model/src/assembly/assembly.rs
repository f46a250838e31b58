//! Assembly of models found in files into one dataset, under the engineer's rules.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::DMatrix;

use super::channel_match::{ChannelMatch, ChannelUse};
use super::found_model::{
    ChannelLabel, FoundModel, NameContradiction, Row, RowRole, proposed_rows,
};
use super::problem::{Problem, ProblemKind, find_scopes, problems_of_condition, row_problems};
use super::response_name::KnownChannels;
use super::rules::{ChannelRule, Rules};
use crate::dataset::channel::ChannelSide;
use crate::dataset::condition::{ConditionRecord, FlightState};
use crate::dataset::model::{Origin, Provenance};
use crate::dataset::state_space::Timing;
use crate::dataset::unchecked_dataset::{
    BandsDraft, ConditionDraft, DatasetDraft, ModelDraft, ResponseArray, ResponseDraft,
};
use crate::dataset::{Channel, ConditionId, Dataset};
use crate::units::number;

/// One model with its role, channel names and channel matches.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The model as read from its file.
    pub found: FoundModel,
    pub row: Row,
    /// Names of its inputs and outputs: from the rules, the file, or the file's name.
    pub labels: [Vec<ChannelLabel>; 2],
    /// Its inputs in the dataset's order.
    pub inputs: ChannelMatch,
    /// Its outputs in the dataset's order.
    pub outputs: ChannelMatch,
    /// Sample time \[s\] from the rules where the file has none; 0 for a continuous-time model.
    pub sample_time_s: Option<f64>,
}

impl Part {
    /// Returns the sides whose channels have no names in the file.
    pub fn sides_by_position(&self) -> Vec<ChannelSide> {
        let sides = [ChannelSide::Input, ChannelSide::Output];
        sides
            .into_iter()
            .filter(|side| side.of(&self.inputs, &self.outputs).by_position)
            .collect()
    }
}

/// Models whose channels were matched by position, because their files do not name them.
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyCaution {
    pub sides: Vec<ChannelSide>,
    /// Indices of the models among those found.
    pub parts: Vec<usize>,
}

impl AssemblyCaution {
    /// Returns a stable code.
    pub fn code(&self) -> &'static str {
        "channels-by-position"
    }
}

/// Models found in files, with the rules applied to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    rules: Rules,
    parts: Vec<Part>,
    problems: Vec<Problem>,
}

impl Default for Assembly {
    /// Returns an assembly without models.
    fn default() -> Self {
        Self::new(Vec::new(), Rules::default())
    }
}

impl Assembly {
    /// Applies `rules` to `models`.
    pub fn new(models: Vec<FoundModel>, rules: Rules) -> Self {
        let rows = proposed_rows(&models, &rules);
        let with_row = models.into_iter().zip(rows);
        let parts = with_row
            .map(|(found, row)| part_of(found, row, &rules))
            .collect();
        let mut assembly = Self {
            rules,
            parts,
            problems: Vec::new(),
        };
        assembly.problems = assembly.find_problems();
        assembly
    }

    /// Returns the same models under other rules.
    pub fn with_rules(&self, rules: Rules) -> Self {
        Self::new(
            self.parts.iter().map(|part| part.found.clone()).collect(),
            rules,
        )
    }

    /// Returns the rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Returns the models in the order in which they were found.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the open problems; empty where the dataset can be built.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Describes a problem, with the name of its model.
    pub fn words(&self, problem: &Problem) -> String {
        let option = problem
            .option()
            .map_or_else(String::new, |option| format!(" ({option})"));
        match problem.part {
            Some(part) => format!("{}: {}{option}", self.parts[part].found.key(), problem.kind),
            None => format!("{}{option}", problem.kind),
        }
    }

    /// Lists the problems in words. A problem shared by many models appears once, with the first
    /// model and the number of others.
    pub fn told(&self) -> Vec<(Option<usize>, String)> {
        let mut kinds: Vec<(&Problem, usize)> = Vec::new();
        for problem in &self.problems {
            let is_same =
                |known: &Problem| known.kind == problem.kind && known.scope == problem.scope;
            match kinds.iter_mut().find(|(known, _)| is_same(known)) {
                Some((_, count)) => *count += 1,
                None => kinds.push((problem, 1)),
            }
        }
        let words = |(problem, count): (&Problem, usize)| {
            let others = match count - 1 {
                0 => String::new(),
                1 => " (and 1 other model)".to_owned(),
                others => format!(" (and {others} other models)"),
            };
            (problem.part, format!("{}{others}", self.words(problem)))
        };
        kinds.into_iter().map(words).collect()
    }

    /// Returns the dataset, or `None` while there are problems. File names of models and flight
    /// records are prefixed with `folder`, the path from the dataset's folder to the files.
    pub fn dataset(&self, folder: &str) -> Option<Dataset> {
        if !self.problems.is_empty() {
            return None;
        }
        let mut draft = merged(&self.rules, &self.parts);
        for condition in &mut draft.conditions {
            let models = condition
                .physics
                .iter_mut()
                .chain(&mut condition.identified);
            let of_models = models.filter_map(|model| model.source.as_mut()?.file.as_mut());
            let of_records = condition.records.iter_mut().map(|record| &mut record.file);
            for file in of_models
                .chain(of_records)
                .filter(|file| !folder.is_empty() && !Path::new(file).is_absolute())
            {
                *file = format!("{folder}/{file}");
            }
        }
        draft.checked().ok().map(|(dataset, _)| dataset)
    }

    /// Returns the conditions without an identified model, ordered by id.
    pub fn without_reference(&self) -> Vec<i64> {
        let mut conditions = by_condition(&self.parts);
        conditions.retain(|_, parts| {
            parts
                .iter()
                .all(|(_, part)| part.row.role != Some(RowRole::Identified))
        });
        conditions.into_keys().collect()
    }

    /// Returns the models that are not left out.
    fn taken(&self) -> impl Iterator<Item = (usize, &Part)> {
        self.parts
            .iter()
            .enumerate()
            .filter(|(_, part)| !part.row.left_out)
    }

    fn find_problems(&self) -> Vec<Problem> {
        let mut problems = self.channel_problems();
        if self.taken().next().is_none() {
            problems.push(Problem::of_all(ProblemKind::NoModels));
        }
        for (index, part) in self.taken() {
            let said = self.rules.rows.get(&part.found.key());
            if part.row.role != Some(RowRole::Identified)
                && said.is_none_or(|said| said.perturbation.is_none())
            {
                let unread = part.row.unread.iter().cloned();
                problems.extend(unread.map(|part| Problem::of(index, ProblemKind::TrimPart(part))));
            }
            problems.extend(
                self.name_contradictions(part)
                    .into_iter()
                    .map(|kind| Problem::of(index, kind)),
            );
            problems.extend(
                row_problems(part)
                    .into_iter()
                    .map(|kind| Problem::of(index, kind)),
            );
            let of_channels = part.inputs.problems.iter().chain(&part.outputs.problems);
            problems.extend(of_channels.map(|kind| Problem::of(index, kind.clone())));
        }
        let conditions = by_condition(&self.parts);
        for (condition, parts) in &conditions {
            problems.extend(problems_of_condition(*condition, parts, &self.rules));
        }
        find_scopes(&mut problems, &self.parts, &self.rules);
        if problems.is_empty()
            && let Err(error) = merged(&self.rules, &self.parts).checked()
        {
            problems.push(Problem::of_all(ProblemKind::Dataset(format!(
                "{}: {}",
                error.place, error.fault
            ))));
        }
        problems
    }

    /// Returns the contradictions between the file of a model and its names, as far as the rules do
    /// not settle them.
    fn name_contradictions(&self, part: &Part) -> Vec<ProblemKind> {
        let said = self.rules.rows.get(&part.found.key());
        let mut problems = Vec::new();
        for NameContradiction {
            field,
            of_file,
            of_name,
        } in part.row.contradictions.clone()
        {
            if said.is_none_or(|said| !said.settles(&field)) {
                problems.push(ProblemKind::NameContradiction {
                    field,
                    of_file,
                    of_name,
                });
            }
        }
        problems
    }

    /// Returns points to review although the dataset can be built.
    pub fn cautions(&self) -> Vec<AssemblyCaution> {
        let mut cautions: Vec<AssemblyCaution> = Vec::new();
        for (index, part) in self.taken() {
            let sides = part.sides_by_position();
            if sides.is_empty() {
                continue;
            }
            match cautions.iter_mut().find(|caution| caution.sides == sides) {
                Some(known) => known.parts.push(index),
                None => cautions.push(AssemblyCaution {
                    sides,
                    parts: vec![index],
                }),
            }
        }
        cautions
    }

    /// Describes a caution.
    pub fn caution_words(&self, caution: &AssemblyCaution) -> String {
        /// Number of files listed by name.
        const NAMED: usize = 3;
        let keys = caution
            .parts
            .iter()
            .take(NAMED)
            .map(|part| self.parts[*part].found.key());
        let rest = caution.parts.len().saturating_sub(NAMED);
        let more = (rest > 0).then(|| format!("{rest} more"));
        let files: Vec<String> = keys.chain(more).collect();
        let sides: Vec<String> = caution
            .sides
            .iter()
            .map(|side| {
                let channels = side.of(&self.rules.inputs, &self.rules.outputs);
                let names: Vec<&str> = channels
                    .iter()
                    .map(|channel| channel.name.as_str())
                    .collect();
                format!("{side}s taken as {}", names.join(", "))
            })
            .collect();
        format!(
            "no names of channels in the file: {}, by their position in the dataset; check the order, or name them under \"models\" in \
             the rules: {}",
            sides.join(" and "),
            files.join(", ")
        )
    }

    fn channel_problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        for (side, channels) in [
            ("inputs", &self.rules.inputs),
            ("outputs", &self.rules.outputs),
        ] {
            if channels.is_empty() {
                problems.push(Problem::of_all(ProblemKind::NoChannels(side)));
            }
            let without = channels
                .iter()
                .filter(|channel| channel.unit.trim().is_empty());
            problems.extend(
                without.map(|channel| Problem::of_all(ProblemKind::NoUnit(channel.name.clone()))),
            );
        }
        problems
    }
}

fn part_of(found: FoundModel, row: Row, rules: &Rules) -> Part {
    let said = rules.rows.get(&found.key());
    // A measured response may be one of several files that belong together.
    let partial = found.draft.response.is_some();
    let declared = rules.declared(&found, row.role);
    let known = KnownChannels::Dataset {
        inputs: &rules.inputs,
        outputs: &rules.outputs,
    };
    let named = found.labels_with_name(known);
    let mut labels = named.labels;
    let [of_inputs, of_outputs] = said.map_or([None, None], |said| {
        [said.inputs.as_ref(), said.outputs.as_ref()]
    });
    for (labels, names) in labels.iter_mut().zip([of_inputs, of_outputs]) {
        for (label, name) in labels.iter_mut().zip(names.into_iter().flatten()) {
            label.name = Some(name.clone());
        }
    }
    let matched =
        |side, labels: &[ChannelLabel], names: Option<&Vec<String>>, channels: &[ChannelRule]| {
            let mut matched = ChannelMatch::of(side, labels, channels, &declared, partial);
            if let Some(names) = names.filter(|names| names.len() != labels.len()) {
                matched.problems.push(ProblemKind::Names {
                    side,
                    said: names.len(),
                    found: labels.len(),
                });
            }
            matched
        };
    let mut inputs = matched(ChannelSide::Input, &labels[0], of_inputs, &rules.inputs);
    let mut outputs = matched(ChannelSide::Output, &labels[1], of_outputs, &rules.outputs);
    if let Some(problem) = named
        .problem
        .filter(|_| of_inputs.is_none() || of_outputs.is_none())
    {
        // This problem explains why the channels below match nothing.
        let is_unmatched =
            |kind: &ProblemKind| matches!(kind, ProblemKind::ResponseUnmatched { .. });
        inputs.problems.retain(|kind| !is_unmatched(kind));
        outputs.problems.retain(|kind| !is_unmatched(kind));
        inputs.problems.push(problem);
    }
    let sample_time_s = said
        .and_then(|said| said.sample_time_s)
        .or(rules.sample_time_s);
    let sample_time_s =
        sample_time_s.filter(|_| found.draft.timing.sample_time_s.is_none() && !partial);
    Part {
        found,
        row,
        labels,
        inputs,
        outputs,
        sample_time_s,
    }
}

// Builds an unchecked dataset from models with known roles, each in the channels and units of the
// dataset.

/// Builds the draft from the parts; models that are left out, or without a condition or role, are
/// skipped.
pub(super) fn merged(rules: &Rules, parts: &[Part]) -> DatasetDraft {
    let channel = |rule: &ChannelRule| Channel::new(rule.name.clone(), rule.unit.clone());
    DatasetDraft {
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: rules.inputs.iter().map(channel).collect(),
        outputs: rules.outputs.iter().map(channel).collect(),
        on_axis: rules.on_axis.clone(),
        band: rules.band,
        conditions: by_condition(parts)
            .into_iter()
            .map(|(id, parts)| condition_of(id, &parts, rules))
            .collect(),
    }
}

/// Groups the models in use by condition, each with its index among all models.
fn by_condition(parts: &[Part]) -> BTreeMap<i64, Vec<(usize, &Part)>> {
    let mut conditions: BTreeMap<i64, Vec<(usize, &Part)>> = BTreeMap::new();
    for (index, part) in parts
        .iter()
        .enumerate()
        .filter(|(_, part)| !part.row.left_out)
    {
        if let Some(condition) = part.row.condition {
            conditions.entry(condition).or_default().push((index, part));
        }
    }
    conditions
}

fn condition_of(id: i64, parts: &[(usize, &Part)], rules: &Rules) -> ConditionDraft {
    let parts: Vec<&Part> = parts.iter().map(|(_, part)| *part).collect();
    let parts = parts.as_slice();
    fn said<T: Clone>(parts: &[&Part], of: impl Fn(&Row) -> &Option<T>) -> Option<T> {
        parts.iter().find_map(|part| of(&part.row).clone())
    }
    let mut state = FlightState {
        id: ConditionId(id),
        name: String::new(),
        airspeed_kt: said(parts, |row| &row.airspeed_kt).unwrap_or(f64::NAN),
        altitude: said(parts, |row| &row.altitude),
        altitude_ft: said(parts, |row| &row.altitude_ft),
        weight: said(parts, |row| &row.weight),
        mass_kg: said(parts, |row| &row.mass_kg),
    };
    state.name = condition_name(&state);
    let of_role = |wanted: &[RowRole]| -> Vec<&Part> {
        let is_wanted = |part: &&&Part| part.row.role.is_some_and(|role| wanted.contains(&role));
        parts.iter().filter(is_wanted).copied().collect()
    };
    let mut physics = of_role(&[RowRole::Nominal, RowRole::Perturbed]);
    // The nominal model first, as a dataset is read.
    physics.sort_by_key(|part| part.row.role);
    let coordinates: BTreeSet<&String> = physics
        .iter()
        .flat_map(|part| part.row.perturbation.keys())
        .collect();
    ConditionDraft {
        flight_state: state,
        physics: physics
            .iter()
            .map(|part| physics_model(part, &coordinates))
            .collect(),
        identified: identified_models(&of_role(&[RowRole::Identified]), rules),
        records: records_of(parts),
    }
}

/// Returns the flight records named by the models' files, once each. Where files differ, the record
/// that lists the pieces in use wins; a different record with a name already in use gets a number.
fn records_of(parts: &[&Part]) -> Vec<ConditionRecord> {
    let mut records: Vec<ConditionRecord> = Vec::new();
    let mut known: Vec<(&String, &String, &Option<String>)> = Vec::new();
    for record in parts.iter().flat_map(|part| &part.found.facts.records) {
        let key = (&record.name, &record.file, &record.variable);
        if let Some(place) = known.iter().position(|other| *other == key) {
            if records[place].used_s.is_empty() {
                records[place] = ConditionRecord {
                    name: records[place].name.clone(),
                    ..record.clone()
                };
            }
            continue;
        }
        known.push(key);
        let numbers = std::iter::successors(Some(2_usize), |number| Some(number + 1));
        let names = numbers.map(|number| format!("{} ({number})", record.name));
        let free = |name: &String| records.iter().all(|other| other.name != *name);
        let name = std::iter::once(record.name.clone()).chain(names).find(free);
        records.push(ConditionRecord {
            name: name.unwrap_or_default(),
            ..record.clone()
        });
    }
    records
}

/// "45 kt, high altitude, low weight".
fn condition_name(state: &FlightState) -> String {
    let class =
        |class: &Option<String>, of: &str| class.as_ref().map(|class| format!("{class} {of}"));
    let figure =
        |value: Option<f64>, unit: &str| value.map(|value| format!("{} {unit}", number(value)));
    let altitude = class(&state.altitude, "altitude").or_else(|| figure(state.altitude_ft, "ft"));
    let weight = class(&state.weight, "weight").or_else(|| figure(state.mass_kg, "kg"));
    let parts = [figure(Some(state.airspeed_kt), "kt"), altitude, weight];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Builds a physics model; coordinates named by other models of the bundle have offset zero here.
fn physics_model(part: &Part, coordinates: &BTreeSet<&String>) -> ModelDraft {
    let offset = |coordinate: &&String| {
        let offset = part
            .row
            .perturbation
            .get(*coordinate)
            .copied()
            .unwrap_or(0.0);
        ((*coordinate).clone(), offset)
    };
    let perturbation = Some(coordinates.iter().map(offset).collect())
        .filter(|offsets: &BTreeMap<_, _>| !offsets.is_empty());
    let origin = match part.row.role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        _ => Origin::Perturbed { perturbation },
    };
    ModelDraft {
        origin,
        ..model_of(part)
    }
}

/// Builds the identified models; measured responses with the same name form one model.
fn identified_models(parts: &[&Part], rules: &Rules) -> Vec<ModelDraft> {
    let mut models: Vec<ModelDraft> = Vec::new();
    for part in parts {
        let model = ModelDraft {
            origin: identified_origin(part),
            ..model_of(part)
        };
        let same = models
            .iter_mut()
            .find(|other| other.name == model.name && other.response.is_some());
        match (same, &model.response) {
            (Some(earlier), Some(response)) => join(earlier, response, part),
            _ => models.push(model),
        }
    }
    models
        .iter_mut()
        .for_each(|model| note_unmeasured(model, rules));
    models
}

/// Lists the responses that no file of a measured model provides in its source note; where all are
/// given at all frequencies, the valid bands are dropped as redundant.
fn note_unmeasured(model: &mut ModelDraft, rules: &Rules) {
    let Some(response) = &mut model.response else {
        return;
    };
    let last = response.omega.last().copied().unwrap_or(0.0);
    let Some(bands) = response.valid_bands.as_ref() else {
        return;
    };
    if bands.values.chunks(2).all(|band| band == [0.0, last]) {
        response.valid_bands = None;
        return;
    }
    let mut unmeasured = Vec::new();
    for (place, band) in bands.values.chunks(2).enumerate() {
        let output = rules.outputs.get(place / rules.inputs.len().max(1));
        let input = rules.inputs.get(place % rules.inputs.len().max(1));
        if let (Some(output), Some(input)) = (output, input)
            && band == NOT_MEASURED
        {
            unmeasured.push(format!("{}/{}", output.name, input.name));
        }
    }
    if !unmeasured.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        let note = source
            .note
            .take()
            .map(|note| format!("{note}; "))
            .unwrap_or_default();
        source.note = Some(format!("{note}not measured: {}", unmeasured.join(", ")));
    }
}

fn identified_origin(part: &Part) -> Origin {
    let order = match &part.found.draft.origin {
        Origin::Identified { order, .. } => *order,
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    };
    Origin::Identified {
        method: part.row.method.clone(),
        order: order.filter(|_| part.found.response().is_some()),
    }
}

/// Valid band of a response that was not measured \[rad/s\]: contains no frequency.
const NOT_MEASURED: [f64; 2] = [0.0, 0.0];

/// Returns the valid bands of a response, or its full frequency range where it has none.
fn bands_or_whole(response: &ResponseDraft) -> ResponseArray {
    let [outputs, inputs, _] = response.re.shape;
    let last = response.omega.last().copied().unwrap_or(0.0);
    let whole = || ResponseArray {
        shape: [outputs, inputs, 2],
        values: [0.0, last].repeat(outputs * inputs),
    };
    response.valid_bands.clone().unwrap_or_else(whole)
}

/// Copies the responses that `response` has and the earlier model lacks into the earlier model.
fn join(earlier: &mut ModelDraft, response: &ResponseDraft, part: &Part) {
    let Some(into) = &mut earlier.response else {
        return;
    };
    let count = into.omega.len();
    let given = bands_or_whole(response);
    let mut known = bands_or_whole(into);
    for place in 0..into.re.shape[0] * into.re.shape[1] {
        let band = 2 * place..2 * place + 2;
        if given.values[band.clone()] == NOT_MEASURED || known.values[band.clone()] != NOT_MEASURED
        {
            continue;
        }
        let range = place * count..(place + 1) * count;
        into.re.values[range.clone()].copy_from_slice(&response.re.values[range.clone()]);
        into.im.values[range.clone()].copy_from_slice(&response.im.values[range.clone()]);
        known.values[band.clone()].copy_from_slice(&given.values[band]);
        join_coherence(into, response, range);
    }
    into.valid_bands = Some(known);
    if let Some(source) = &mut earlier.source {
        let note = source
            .note
            .take()
            .map(|note| format!("{note}; "))
            .unwrap_or_default();
        source.note = Some(format!("{note}with {}", part.found.key()));
        let of_part = part
            .found
            .draft
            .source
            .iter()
            .flat_map(|source| &source.unused);
        source.unused.extend(of_part.cloned());
        source.by_position.extend(part.sides_by_position());
        source.by_position.dedup();
    }
}

/// Joins the coherence; a part without coherence is fully trusted where others have one.
fn join_coherence(
    into: &mut ResponseDraft,
    response: &ResponseDraft,
    range: std::ops::Range<usize>,
) {
    let shape = into.re.shape;
    if into.coherence.is_none() && response.coherence.is_none() {
        return;
    }
    let full = || ResponseArray {
        shape,
        values: vec![1.0; shape.iter().product()],
    };
    let coherence = into.coherence.get_or_insert_with(full);
    match &response.coherence {
        Some(of) => coherence.values[range.clone()].copy_from_slice(&of.values[range]),
        None => coherence.values[range].fill(1.0),
    }
}

/// Converts the model to the dataset's channels and units, and notes the conversions.
fn model_of(part: &Part) -> ModelDraft {
    let mut model = converted(&part.found.draft, &part.inputs.uses, &part.outputs.uses);
    model.name.clone_from(&part.row.name);
    if let Some(sample_time_s) = part.sample_time_s.filter(|step| *step > 0.0) {
        model.timing.sample_time_s = Some(sample_time_s);
    }
    let uses = part.inputs.uses.iter().chain(&part.outputs.uses).flatten();
    let conversions = uses.filter_map(|used| used.words.clone());
    let sampled = part
        .sample_time_s
        .map(|step| format!("sample time {} s, as is said", number(step)));
    let notes = part
        .inputs
        .notes
        .iter()
        .chain(&part.outputs.notes)
        .cloned()
        .chain(sampled);
    let said = model.source.as_ref().and_then(|source| source.note.clone());
    let words: Vec<String> = said.into_iter().chain(notes).chain(conversions).collect();
    if !words.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.note = Some(words.join("; "));
    }
    let by_position = part.sides_by_position();
    if !by_position.is_empty() {
        model
            .source
            .get_or_insert_with(Provenance::default)
            .by_position = by_position;
    }
    model
}

/// Returns the model with the dataset's channels in the dataset's order and units,
/// `H'_oi = f_o H_oi / f_i`; bitwise the same numbers where nothing is converted. Missing channels
/// have zero response.
pub(super) fn converted(
    model: &ModelDraft,
    inputs: &[Option<ChannelUse>],
    outputs: &[Option<ChannelUse>],
) -> ModelDraft {
    let [a, b, c, d] = &model.matrices;
    let table = |array: &ResponseArray, convert: bool| picked(array, (inputs, outputs), convert);
    let is_whole = inputs.iter().chain(outputs).all(Option::is_some);
    let response = model.response.as_ref().map(|response| {
        // A response that was not measured has an empty valid band: its zeros are not model values.
        let valid_bands = if is_whole {
            response.valid_bands.clone()
        } else {
            Some(bands_or_whole(response))
        };
        ResponseDraft {
            omega: response.omega.clone(),
            re: table(&response.re, true),
            im: table(&response.im, true),
            coherence: response.coherence.as_ref().map(|array| table(array, false)),
            valid_bands: valid_bands.map(|array| table(&array, false)),
            estimate: response.estimate,
        }
    });
    let timing = Timing {
        sample_time_s: model.timing.sample_time_s,
        input_delays_s: model
            .timing
            .input_delays_s
            .as_ref()
            .map(|delays| chosen(delays, inputs)),
        output_delays_s: model
            .timing
            .output_delays_s
            .as_ref()
            .map(|delays| chosen(delays, outputs)),
    };
    let b = b.as_ref().map(|b| columns(b, inputs));
    let c = c.as_ref().map(|c| rows(c, outputs));
    let d = d.as_ref().map(|d| rows(&columns(d, inputs), outputs));
    // A factor shifts a curve in decibels and leaves its standard deviation unchanged.
    let bands = model.bands.as_ref().map(|bands| BandsDraft {
        omega: bands.omega.clone(),
        sd_db: table(&bands.sd_db, false),
        sd_deg: table(&bands.sd_deg, false),
    });
    ModelDraft {
        matrices: [a.clone(), b, c, d],
        response,
        timing,
        bands,
        ..model.clone()
    }
}

fn chosen(delays: &[f64], uses: &[Option<ChannelUse>]) -> Vec<f64> {
    let delay = |used: &Option<ChannelUse>| {
        used.as_ref()
            .and_then(|used| delays.get(used.index))
            .copied()
            .unwrap_or(0.0)
    };
    uses.iter().map(delay).collect()
}

/// Picks the columns of the inputs, each divided by its factor.
fn columns(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), uses.len(), |row, column| {
        match &uses[column] {
            Some(used) if used.index < matrix.ncols() => {
                scaled(matrix[(row, used.index)], 1.0, used.factor)
            }
            _ => 0.0,
        }
    })
}

/// Picks the rows of the outputs, each multiplied by its factor.
fn rows(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(uses.len(), matrix.ncols(), |row, column| match &uses[row] {
        Some(used) if used.index < matrix.nrows() => {
            scaled(matrix[(used.index, column)], used.factor, 1.0)
        }
        _ => 0.0,
    })
}

fn scaled(value: f64, times: f64, over: f64) -> f64 {
    if times == over {
        value
    } else {
        value * times / over
    }
}

/// Picks the dataset's channels, converted or unchanged; zero where a channel is missing.
fn picked(
    array: &ResponseArray,
    (inputs, outputs): (&[Option<ChannelUse>], &[Option<ChannelUse>]),
    convert: bool,
) -> ResponseArray {
    let [p, m, count] = array.shape;
    let mut values = Vec::with_capacity(outputs.len() * inputs.len() * count);
    for output in outputs {
        for input in inputs {
            let of = output
                .as_ref()
                .zip(input.as_ref())
                .filter(|(output, input)| output.index < p && input.index < m);
            let Some((output, input)) = of else {
                values.extend(std::iter::repeat_n(0.0, count));
                continue;
            };
            let start = (output.index * m + input.index) * count;
            let (times, over) = if convert {
                (output.factor, input.factor)
            } else {
                (1.0, 1.0)
            };
            values.extend(
                array.values[start..start + count]
                    .iter()
                    .map(|value| scaled(*value, times, over)),
            );
        }
    }
    ResponseArray {
        shape: [outputs.len(), inputs.len(), count],
        values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::found_model::{Facts, proposed_rules};

    fn used(index: usize, factor: f64) -> Option<ChannelUse> {
        Some(ChannelUse {
            index,
            factor,
            words: None,
        })
    }

    #[test]
    fn a_response_is_multiplied_by_the_output_s_factor_over_the_input_s() {
        let matrix =
            |rows, columns, values: &[f64]| Some(DMatrix::from_row_slice(rows, columns, values));
        let model = ModelDraft {
            name: "m".into(),
            origin: Origin::Perturbed { perturbation: None },
            matrices: [
                matrix(1, 1, &[-1.0]),
                matrix(1, 2, &[1.0, 2.0]),
                matrix(2, 1, &[3.0, 5.0]),
                matrix(2, 2, &[0.0, 1.0, 2.0, 3.0]),
            ],
            timing: Timing {
                input_delays_s: Some(vec![0.1, 0.2]),
                ..Timing::default()
            },
            response: None,
            source: None,
            states: Vec::new(),
            bands: None,
        };
        let turned = converted(&model, &[used(1, 2.0), used(0, 1.0)], &[used(1, 10.0)]);
        let [_, b, c, d] = turned.matrices.map(Option::unwrap);
        assert_eq!(
            (b.as_slice(), c.as_slice(), d.as_slice()),
            (&[1.0, 1.0][..], &[50.0][..], &[15.0, 20.0][..])
        );
        assert_eq!(turned.timing.input_delays_s, Some(vec![0.2, 0.1]));
        let same = converted(
            &model,
            &[used(0, 1.0), used(1, 1.0)],
            &[used(0, 1.0), used(1, 1.0)],
        );
        assert_eq!(same, model);
    }

    /// A measured response with 2 outputs and 1 input at 2 frequencies.
    fn measured(values: &[f64]) -> ModelDraft {
        let array = |values: &[f64]| ResponseArray {
            shape: [values.len() / 2, 1, 2],
            values: values.to_vec(),
        };
        let response = ResponseDraft {
            omega: vec![1.0, 5.0],
            re: array(values),
            im: array(&vec![0.0; values.len()]),
            coherence: None,
            valid_bands: None,
            estimate: Default::default(),
        };
        ModelDraft {
            name: "measured".into(),
            origin: Origin::Identified {
                method: None,
                order: None,
            },
            matrices: [None, None, None, None],
            timing: Timing::default(),
            response: Some(response),
            source: None,
            states: Vec::new(),
            bands: None,
        }
    }

    #[test]
    fn a_response_that_no_file_gives_is_marked_as_not_measured_and_noted() {
        let rules = Rules {
            inputs: vec![ChannelRule::named("LON")],
            outputs: vec![ChannelRule::named("Q"), ChannelRule::named("P")],
            ..Rules::default()
        };
        let mut of_one = converted(
            &measured(&[3.0, 4.0]),
            &[used(0, 1.0)],
            &[None, used(0, 1.0)],
        );
        note_unmeasured(&mut of_one, &rules);
        assert_eq!(
            of_one.response.unwrap().valid_bands.unwrap().values,
            [0.0, 0.0, 0.0, 5.0]
        );
        assert_eq!(
            of_one.source.unwrap().note.as_deref(),
            Some("not measured: Q/LON")
        );
        let mut whole = converted(
            &measured(&[1.0, 2.0, 3.0, 4.0]),
            &[used(0, 1.0)],
            &[used(0, 1.0), used(1, 1.0)],
        );
        note_unmeasured(&mut whole, &rules);
        assert_eq!(
            (whole.response.unwrap().valid_bands, whole.source),
            (None, None)
        );
    }

    #[test]
    fn two_files_that_give_the_same_response_of_one_model_are_a_problem() {
        let rule = |name: &str| ChannelRule {
            unit: "%".into(),
            unit_in_files: Some("%".into()),
            ..ChannelRule::named(name)
        };
        let rules = Rules {
            inputs: vec![rule("LON")],
            outputs: vec![rule("Q"), rule("P")],
            ..Rules::default()
        };
        let measured_in = |file: &str| {
            let mut model = found(file, None, Facts::default());
            model.draft = ModelDraft {
                source: model.draft.source,
                ..measured(&[3.0, 4.0])
            };
            model
        };
        let codes = |files: [&str; 2]| -> Vec<&str> {
            let assembly = Assembly::new(files.map(measured_in).to_vec(), rules.clone());
            assembly
                .problems()
                .iter()
                .map(|problem| problem.kind.code())
                .collect()
        };
        assert!(codes(["c1/frf_q_lon.csv", "c1/frf_q_lon_run2.csv"]).contains(&"response-twice"));
        assert!(!codes(["c1/frf_q_lon.csv", "c1/frf_p_lon.csv"]).contains(&"response-twice"));
        assert!(codes(["c1/frf_q_lon.csv", "c1/frf_r_ped.csv"]).contains(&"response-unmatched"));
    }

    /// A model with one input and one output in a file, with matrices.
    fn found(file: &str, variable: Option<&str>, facts: Facts) -> FoundModel {
        let scalar = |value: f64| Some(DMatrix::from_element(1, 1, value));
        let source = Provenance {
            file: Some(file.to_owned()),
            variable: variable.map(str::to_owned),
            ..Provenance::default()
        };
        FoundModel {
            draft: ModelDraft {
                name: String::new(),
                origin: Origin::Perturbed { perturbation: None },
                matrices: [scalar(-1.0), scalar(1.0), scalar(1.0), scalar(0.0)],
                timing: Timing::default(),
                response: None,
                source: Some(source),
                states: Vec::new(),
                bands: None,
            },
            inputs: vec![ChannelLabel::default()],
            outputs: vec![ChannelLabel::default()],
            facts,
            notes: Vec::new(),
        }
    }

    fn at(airspeed_kt: f64) -> Facts {
        Facts {
            airspeed_kt: Some(airspeed_kt),
            ..Facts::default()
        }
    }

    #[test]
    fn an_airspeed_of_the_folder_that_is_not_the_file_s_is_a_problem_until_it_is_said() {
        let contradictions = |assembly: &Assembly| -> Vec<ProblemKind> {
            let kinds = assembly
                .problems()
                .iter()
                .map(|problem| problem.kind.clone());
            kinds
                .filter(|kind| matches!(kind, ProblemKind::NameContradiction { .. }))
                .collect()
        };
        let models = vec![found("c1_090kt/nominal.mat", None, at(70.0))];
        let assembly = Assembly::new(models, Rules::default());
        let expected = ProblemKind::NameContradiction {
            field: "airspeed_kt".into(),
            of_file: 70.0,
            of_name: 90.0,
        };
        assert_eq!(contradictions(&assembly), [expected]);
        let mut rules = Rules::default();
        rules
            .rows
            .entry("c1_090kt/nominal.mat".into())
            .or_default()
            .airspeed_kt = Some(70.0);
        assert_eq!(contradictions(&assembly.with_rules(rules)), []);
        let rounded = Assembly::new(
            vec![found("c1_090kt/nominal.mat", None, at(90.3))],
            Rules::default(),
        );
        assert_eq!(contradictions(&rounded), []);
    }

    #[test]
    fn models_of_several_airspeeds_in_one_file_are_several_conditions_in_every_file() {
        let mut models = Vec::new();
        for (file, airspeeds) in [
            ("physics.mat", [60.0, 80.0]),
            ("flight/identified.npz", [80.0, 60.0]),
        ] {
            for (page, airspeed_kt) in airspeeds.into_iter().enumerate() {
                models.push(found(
                    file,
                    Some(&format!("(:,:,{})", page + 1)),
                    at(airspeed_kt),
                ));
            }
        }
        let assembly = Assembly::new(models, Rules::default());
        let rows: Vec<(Option<i64>, Option<RowRole>)> = assembly
            .parts()
            .iter()
            .map(|part| (part.row.condition, part.row.role))
            .collect();
        let nominal = Some(RowRole::Nominal);
        let identified = Some(RowRole::Identified);
        assert_eq!(
            rows,
            [
                (Some(1), nominal),
                (Some(2), nominal),
                (Some(2), identified),
                (Some(1), identified)
            ]
        );
    }

    #[test]
    fn channels_taken_by_position_are_a_caution_and_marked_in_the_dataset() {
        let models = vec![
            found("c1_90kt/nominal.mat", None, at(90.0)),
            found("c1_90kt/identified.mat", None, at(90.0)),
        ];
        let mut rules = proposed_rules("", &models);
        for channel in rules.inputs.iter_mut().chain(&mut rules.outputs) {
            (channel.unit, channel.unit_in_files) = ("deg".into(), Some("deg".into()));
        }
        let assembly = Assembly::new(models, rules.clone());
        let cautions = assembly.cautions();
        let both = vec![ChannelSide::Input, ChannelSide::Output];
        assert_eq!(
            cautions,
            [AssemblyCaution {
                sides: both.clone(),
                parts: vec![0, 1]
            }]
        );
        assert_eq!(cautions[0].code(), "channels-by-position");
        let dataset = assembly.dataset("").unwrap();
        let source = dataset.conditions()[0].bundle(crate::dataset::BundleKind::Physics)[0]
            .source
            .clone()
            .unwrap();
        assert_eq!(source.by_position, both);
        for key in ["c1_90kt/nominal.mat", "c1_90kt/identified.mat"] {
            let row = rules.rows.entry(key.into()).or_default();
            (row.inputs, row.outputs) =
                (Some(vec!["input 1".into()]), Some(vec!["output 1".into()]));
        }
        assert_eq!(assembly.with_rules(rules).cautions(), []);
    }
}
