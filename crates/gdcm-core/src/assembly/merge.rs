//! The unchecked dataset of models that are said to be what, each in the channels and units of the dataset.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::DMatrix;

use super::{ChannelRule, ChannelUse, Part, Row, RowRole, Rules};
use crate::dataset::{
    BandsDraft, Channel, ConditionDraft, ConditionId, ConditionRecord, DatasetDraft, FlightState, ModelDraft, Origin,
    Provenance, ResponseArray, ResponseDraft, Timing,
};
use crate::units::number;

/// The draft that the parts make; those that are left out, or of which condition or role are not said, are not in it.
pub(super) fn merged(rules: &Rules, parts: &[Part]) -> DatasetDraft {
    let mut conditions: BTreeMap<i64, Vec<&Part>> = BTreeMap::new();
    for part in parts.iter().filter(|part| !part.row.left_out) {
        if let Some(condition) = part.row.condition {
            conditions.entry(condition).or_default().push(part);
        }
    }
    let channel = |rule: &ChannelRule| Channel::new(rule.name.clone(), rule.unit.clone());
    DatasetDraft {
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: rules.inputs.iter().map(channel).collect(),
        outputs: rules.outputs.iter().map(channel).collect(),
        on_axis: rules.on_axis.clone(),
        band: rules.band,
        conditions: conditions.iter().map(|(id, parts)| condition_of(*id, parts)).collect(),
    }
}

fn condition_of(id: i64, parts: &[&Part]) -> ConditionDraft {
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
    let coordinates: BTreeSet<&String> = physics.iter().flat_map(|part| part.row.perturbation.keys()).collect();
    ConditionDraft {
        flight_state: state,
        physics: physics.iter().map(|part| physics_model(part, &coordinates)).collect(),
        identified: identified_models(&of_role(&[RowRole::Identified])),
        records: records_of(parts),
    }
}

/// The flight records that the files of the models name, once each, as the file says it that says which pieces are used; of different
/// ones of one name the later gets a number.
fn records_of(parts: &[&Part]) -> Vec<ConditionRecord> {
    let mut records: Vec<ConditionRecord> = Vec::new();
    let mut known: Vec<(&String, &String, &Option<String>)> = Vec::new();
    for record in parts.iter().flat_map(|part| &part.found.facts.records) {
        let key = (&record.name, &record.file, &record.variable);
        if let Some(place) = known.iter().position(|other| *other == key) {
            if records[place].used_s.is_empty() {
                records[place] = ConditionRecord { name: records[place].name.clone(), ..record.clone() };
            }
            continue;
        }
        known.push(key);
        let numbers = std::iter::successors(Some(2_usize), |number| Some(number + 1));
        let names = numbers.map(|number| format!("{} ({number})", record.name));
        let free = |name: &String| records.iter().all(|other| other.name != *name);
        let name = std::iter::once(record.name.clone()).chain(names).find(free);
        records.push(ConditionRecord { name: name.unwrap_or_default(), ..record.clone() });
    }
    records
}

/// "45 kt, high altitude, low weight".
fn condition_name(state: &FlightState) -> String {
    let class = |class: &Option<String>, of: &str| class.as_ref().map(|class| format!("{class} {of}"));
    let figure = |value: Option<f64>, unit: &str| value.map(|value| format!("{} {unit}", number(value)));
    let altitude = class(&state.altitude, "altitude").or_else(|| figure(state.altitude_ft, "ft"));
    let weight = class(&state.weight, "weight").or_else(|| figure(state.mass_kg, "kg"));
    let parts = [figure(Some(state.airspeed_kt), "kt"), altitude, weight];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Coordinates that others of the bundle name are at rest in this model.
fn physics_model(part: &Part, coordinates: &BTreeSet<&String>) -> ModelDraft {
    let offset = |coordinate: &&String| {
        let offset = part.row.perturbation.get(*coordinate).copied().unwrap_or(0.0);
        ((*coordinate).clone(), offset)
    };
    let perturbation =
        Some(coordinates.iter().map(offset).collect()).filter(|offsets: &BTreeMap<_, _>| !offsets.is_empty());
    let origin = match part.row.role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        _ => Origin::Perturbed { perturbation },
    };
    ModelDraft { origin, ..model_of(part) }
}

/// Measured responses of one name are one model.
fn identified_models(parts: &[&Part]) -> Vec<ModelDraft> {
    let mut models: Vec<ModelDraft> = Vec::new();
    for part in parts {
        let model = ModelDraft { origin: identified_origin(part), ..model_of(part) };
        let same = models.iter_mut().find(|other| other.name == model.name && other.response.is_some());
        match (same, &model.response) {
            (Some(earlier), Some(response)) => join(earlier, response, part),
            _ => models.push(model),
        }
    }
    models
}

fn identified_origin(part: &Part) -> Origin {
    let order = match &part.found.draft.origin {
        Origin::Identified { order, .. } => *order,
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    };
    Origin::Identified { method: part.row.method.clone(), order: order.filter(|_| part.found.response().is_some()) }
}

/// Puts the responses that `response` has, and the earlier model has not, into it.
fn join(earlier: &mut ModelDraft, response: &ResponseDraft, part: &Part) {
    let Some(into) = &mut earlier.response else { return };
    let count = into.omega.len();
    for place in 0..into.re.shape[0] * into.re.shape[1] {
        let range = place * count..(place + 1) * count;
        let is_given = |of: &ResponseDraft| range.clone().any(|at| of.re.values[at] != 0.0 || of.im.values[at] != 0.0);
        if !is_given(response) || is_given(into) {
            continue;
        }
        into.re.values[range.clone()].copy_from_slice(&response.re.values[range.clone()]);
        into.im.values[range.clone()].copy_from_slice(&response.im.values[range.clone()]);
        join_coherence(into, response, range);
    }
    if let Some(source) = &mut earlier.source {
        let note = source.note.take().map(|note| format!("{note}; ")).unwrap_or_default();
        source.note = Some(format!("{note}with {}", part.found.key()));
    }
}

/// A part without coherence is trusted as it is where others have one.
fn join_coherence(into: &mut ResponseDraft, response: &ResponseDraft, range: std::ops::Range<usize>) {
    let shape = into.re.shape;
    if into.coherence.is_none() && response.coherence.is_none() {
        return;
    }
    let full = || ResponseArray { shape, values: vec![1.0; shape.iter().product()] };
    let coherence = into.coherence.get_or_insert_with(full);
    match &response.coherence {
        Some(of) => coherence.values[range.clone()].copy_from_slice(&of.values[range]),
        None => coherence.values[range].fill(1.0),
    }
}

/// The model in the dataset's channels and units, and what was done to it.
fn model_of(part: &Part) -> ModelDraft {
    let mut model = converted(&part.found.draft, &part.inputs.uses, &part.outputs.uses);
    model.name.clone_from(&part.row.name);
    if let Some(sample_time_s) = part.sample_time_s.filter(|step| *step > 0.0) {
        model.timing.sample_time_s = Some(sample_time_s);
    }
    let uses = part.inputs.uses.iter().chain(&part.outputs.uses).flatten();
    let conversions = uses.filter_map(|used| used.words.clone());
    let sampled = part.sample_time_s.map(|step| format!("sample time {} s, as is said", number(step)));
    let notes = part.inputs.notes.iter().chain(&part.outputs.notes).cloned().chain(sampled);
    let said = model.source.as_ref().and_then(|source| source.note.clone());
    let words: Vec<String> = said.into_iter().chain(notes).chain(conversions).collect();
    if !words.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.note = Some(words.join("; "));
    }
    model
}

/// The model with the dataset's channels in the dataset's order and units, `H'_oi = f_o H_oi / f_i`; the same numbers, bit for bit,
/// where nothing is converted. Channels that are missing respond to nothing.
pub(super) fn converted(
    model: &ModelDraft,
    inputs: &[Option<ChannelUse>],
    outputs: &[Option<ChannelUse>],
) -> ModelDraft {
    let [a, b, c, d] = &model.matrices;
    let response = model.response.as_ref().map(|response| converted_response(response, inputs, outputs));
    let timing = Timing {
        sample_time_s: model.timing.sample_time_s,
        input_delays_s: model.timing.input_delays_s.as_ref().map(|delays| chosen(delays, inputs)),
        output_delays_s: model.timing.output_delays_s.as_ref().map(|delays| chosen(delays, outputs)),
    };
    let b = b.as_ref().map(|b| columns(b, inputs));
    let c = c.as_ref().map(|c| rows(c, outputs));
    let d = d.as_ref().map(|d| rows(&columns(d, inputs), outputs));
    // A factor moves a curve in decibels and leaves the width of its band.
    let bands = model.bands.as_ref().map(|bands| BandsDraft {
        omega: bands.omega.clone(),
        sd_db: picked(&bands.sd_db, (inputs, outputs), false),
        sd_deg: picked(&bands.sd_deg, (inputs, outputs), false),
    });
    ModelDraft { matrices: [a.clone(), b, c, d], response, timing, bands, ..model.clone() }
}

fn chosen(delays: &[f64], uses: &[Option<ChannelUse>]) -> Vec<f64> {
    let delay =
        |used: &Option<ChannelUse>| used.as_ref().and_then(|used| delays.get(used.index)).copied().unwrap_or(0.0);
    uses.iter().map(delay).collect()
}

/// The columns of inputs, each over its factor.
fn columns(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), uses.len(), |row, column| match &uses[column] {
        Some(used) if used.index < matrix.ncols() => scaled(matrix[(row, used.index)], 1.0, used.factor),
        _ => 0.0,
    })
}

/// The rows of outputs, each times its factor.
fn rows(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(uses.len(), matrix.ncols(), |row, column| match &uses[row] {
        Some(used) if used.index < matrix.nrows() => scaled(matrix[(used.index, column)], used.factor, 1.0),
        _ => 0.0,
    })
}

fn scaled(value: f64, times: f64, over: f64) -> f64 {
    if times == over { value } else { value * times / over }
}

fn converted_response(
    response: &ResponseDraft,
    inputs: &[Option<ChannelUse>],
    outputs: &[Option<ChannelUse>],
) -> ResponseDraft {
    let table = |array: &ResponseArray, convert: bool| picked(array, (inputs, outputs), convert);
    ResponseDraft {
        omega: response.omega.clone(),
        re: table(&response.re, true),
        im: table(&response.im, true),
        coherence: response.coherence.as_ref().map(|array| table(array, false)),
        valid_bands: response.valid_bands.as_ref().map(|array| table(array, false)),
        estimate: response.estimate,
    }
}

/// The table of the dataset's channels, converted or as it is; zero where a channel is missing.
fn picked(
    array: &ResponseArray,
    (inputs, outputs): (&[Option<ChannelUse>], &[Option<ChannelUse>]),
    convert: bool,
) -> ResponseArray {
    let [p, m, count] = array.shape;
    let mut values = Vec::with_capacity(outputs.len() * inputs.len() * count);
    for output in outputs {
        for input in inputs {
            let of = output.as_ref().zip(input.as_ref()).filter(|(output, input)| output.index < p && input.index < m);
            let Some((output, input)) = of else {
                values.extend(std::iter::repeat_n(0.0, count));
                continue;
            };
            let start = (output.index * m + input.index) * count;
            let (times, over) = if convert { (output.factor, input.factor) } else { (1.0, 1.0) };
            values.extend(array.values[start..start + count].iter().map(|value| scaled(*value, times, over)));
        }
    }
    ResponseArray { shape: [outputs.len(), inputs.len(), count], values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Origin;

    fn used(index: usize, factor: f64) -> Option<ChannelUse> {
        Some(ChannelUse { index, factor, words: None })
    }

    #[test]
    fn a_response_is_multiplied_by_the_output_s_factor_over_the_input_s() {
        let matrix = |rows, columns, values: &[f64]| Some(DMatrix::from_row_slice(rows, columns, values));
        let model = ModelDraft {
            name: "m".into(),
            origin: Origin::Perturbed { perturbation: None },
            matrices: [
                matrix(1, 1, &[-1.0]),
                matrix(1, 2, &[1.0, 2.0]),
                matrix(2, 1, &[3.0, 5.0]),
                matrix(2, 2, &[0.0, 1.0, 2.0, 3.0]),
            ],
            timing: Timing { input_delays_s: Some(vec![0.1, 0.2]), ..Timing::default() },
            response: None,
            source: None,
            states: Vec::new(),
            bands: None,
        };
        let turned = converted(&model, &[used(1, 2.0), used(0, 1.0)], &[used(1, 10.0)]);
        let [_, b, c, d] = turned.matrices.map(Option::unwrap);
        assert_eq!((b.as_slice(), c.as_slice(), d.as_slice()), (&[1.0, 1.0][..], &[50.0][..], &[15.0, 20.0][..]));
        assert_eq!(turned.timing.input_delays_s, Some(vec![0.2, 0.1]));
        let same = converted(&model, &[used(0, 1.0), used(1, 1.0)], &[used(0, 1.0), used(1, 1.0)]);
        assert_eq!(same, model);
    }
}
