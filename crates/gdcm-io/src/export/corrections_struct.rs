//! The content of `corrections.json` as a MATLAB struct.
//!
//! ```text
//! 1  lists of responses -> logical matrices; net gains -> matrices; scheduled delays -> lists
//! 2  names of solution members in earlier versions -> added beside the present names
//! 3  the changed JSON, without the channels -> MATLAB, with the layout in `LAYOUT`
//! 4  names and units of the channels -> added to the struct, each as a separate column
//! ```
//!
//! A response's net gain is the product of its output's and its input's gain; `u_physics` and
//! `u_identification` are its standard deviations due to the choice of the physics model and to
//! the identification (M13). A *held* response is constrained; a *held-out* condition is not used
//! to fit the schedule.

use serde_json::{Value as Json, json};

use gdcm_model::dataset::Dataset;

use super::json_to_matlab::Layout;
use super::matlab_values::cell_of_texts;
use crate::formats::variables::Value;

/// Members with a special conversion, by name; see [`Layout`]. Channel values become arrays,
/// ordered as in the dataset's `inputs` and `outputs`.
const LAYOUT: Layout = Layout {
    by_channel: &["inputs", "outputs"],
    by_model_name: &["discontinuity"],
    gathered_lists: &["table"],
};

/// Members of the solutions in `corrections.json` that the MATLAB struct repeats under names from
/// earlier versions.
const EARLIER_NAMES: [EarlierName; 6] = [
    EarlierName::new("gain_objective", "gain_solution", "objective"),
    EarlierName::new("gain_lower_bound", "gain_solution", "lower_bound"),
    EarlierName::new("gain_proven", "gain_solution", "proven"),
    EarlierName::new("gain_matched", "gain_solution", "matched"),
    EarlierName::new("delay_objective_s2", "delay_solution", "objective"),
    EarlierName::new("delay_matched", "delay_solution", "matched"),
];

/// Name of a solution member in earlier versions, when it was a member of the condition.
struct EarlierName {
    name: &'static str,
    /// Member of the condition: "gain_solution" or "delay_solution".
    solution: &'static str,
    /// Present name, within the solution.
    member: &'static str,
}

impl EarlierName {
    const fn new(name: &'static str, solution: &'static str, member: &'static str) -> Self {
        Self {
            name,
            solution,
            member,
        }
    }
}

/// Matrix (outputs x inputs) in the struct with one member of each response's net gain.
struct NetGainMatrix {
    /// Field in the struct.
    name: &'static str,
    /// Member of the net gain in `corrections.json`.
    member: &'static str,
    /// Index in this member if it is a list, such as an interval's end.
    index: Option<usize>,
}

impl NetGainMatrix {
    const fn new(name: &'static str, member: &'static str, index: Option<usize>) -> Self {
        Self {
            name,
            member,
            index,
        }
    }

    /// Returns a response's value from the list of net gains; null if missing.
    fn value_at(&self, net_gains: &[Json], output: &str, input: &str) -> Json {
        let net_gain = net_gains
            .iter()
            .find(|net_gain| net_gain["output"] == output && net_gain["input"] == input);
        let Some(value) = net_gain.and_then(|net_gain| net_gain.get(self.member)) else {
            return Json::Null;
        };
        match self.index {
            Some(index) => value.get(index).cloned().unwrap_or(Json::Null),
            None => value.clone(),
        }
    }
}

const NET_GAIN_MATRICES: [NetGainMatrix; 5] = [
    NetGainMatrix::new("net_gains", "gain", None),
    NetGainMatrix::new("net_gains_low", "interval", Some(0)),
    NetGainMatrix::new("net_gains_high", "interval", Some(1)),
    NetGainMatrix::new("u_physics", "u_physics", None),
    NetGainMatrix::new("u_identification", "u_identification", None),
];

/// Returns the members of `corrections.json` as a struct.
pub(super) fn corrections_struct(mut corrections: Json, dataset: &Dataset) -> Value {
    // Steps 1 and 2.
    restructure_settings(&mut corrections["settings"], dataset);
    if let Some(conditions) = corrections["conditions"].as_array_mut() {
        for condition in conditions {
            restructure_condition(condition, dataset);
            repeat_under_earlier_names(condition);
        }
    }
    restructure_schedule(&mut corrections["schedule"]);
    // Step 3.
    if let Some(members) = corrections.as_object_mut() {
        members.shift_remove("inputs");
        members.shift_remove("outputs");
    }
    let mut value = LAYOUT.value("", &corrections);
    // Step 4.
    if let Value::Struct(records) = &mut value {
        for (side, channels) in [("input", dataset.inputs()), ("output", dataset.outputs())] {
            let names = cell_of_texts(channels.iter().map(|channel| channel.name.clone()));
            let units = cell_of_texts(channels.iter().map(|channel| channel.unit.clone()));
            records.fields.push((format!("{side}s"), vec![names]));
            records.fields.push((format!("{side}_units"), vec![units]));
        }
    }
    value
}

/// Step 1 for the settings. Adds the coherence threshold as null if it is absent because coherence
/// is not used.
fn restructure_settings(settings: &mut Json, dataset: &Dataset) {
    for name in ["constrained", "ignored"] {
        settings[name] = marked_responses(&settings[name], dataset);
    }
    if settings.get("coherence_threshold").is_none() {
        settings["coherence_threshold"] = Json::Null;
    }
}

/// Step 1 for a condition: `net_gains` becomes several matrices, and `net_gain_table` keeps all its
/// members. Adds `held_out`, which is absent if it is false.
fn restructure_condition(condition: &mut Json, dataset: &Dataset) {
    condition["held"] = marked_responses(&condition["held"], dataset);
    condition["held_out"] = condition.get("held_out").cloned().unwrap_or(false.into());
    let net_gains = condition["net_gains"].take();
    let net_gains = net_gains.as_array().map(Vec::as_slice).unwrap_or_default();
    // The list has all inputs for the first output, then for the second, and so on.
    condition["net_gain_table"] = net_gains
        .chunks(dataset.inputs().len())
        .map(|row| json!(row))
        .collect();
    for matrix in NET_GAIN_MATRICES {
        condition[matrix.name] = response_table(dataset, |output, input| {
            matrix.value_at(net_gains, output, input)
        });
    }
}

/// Step 2.
fn repeat_under_earlier_names(condition: &mut Json) {
    for earlier in EARLIER_NAMES {
        condition[earlier.name] = condition[earlier.solution][earlier.member].clone();
    }
}

/// Step 1 for the schedule; a missing schedule becomes an empty list.
fn restructure_schedule(schedule: &mut Json) {
    if schedule.is_null() {
        *schedule = json!([]);
    }
    if let Some(rows) = schedule.get_mut("table").and_then(Json::as_array_mut) {
        for row in rows {
            add_delay_lists(row);
        }
    }
}

/// Returns all response values as rows, one per output; each row has a value for each input.
fn response_table(dataset: &Dataset, value: impl Fn(&str, &str) -> Json) -> Json {
    let mut rows = Vec::new();
    for output in dataset.outputs() {
        let mut row = Vec::new();
        for input in dataset.inputs() {
            row.push(value(&output.name, &input.name));
        }
        rows.push(Json::Array(row));
    }
    Json::Array(rows)
}

/// Returns a logical matrix (outputs x inputs) that marks the responses in a list of pairs (output,
/// input).
fn marked_responses(pairs: &Json, dataset: &Dataset) -> Json {
    let pairs = pairs.as_array().map(Vec::as_slice).unwrap_or_default();
    response_table(dataset, |output, input| {
        pairs
            .iter()
            .any(|pair| pair[0] == output && pair[1] == input)
            .into()
    })
}

/// Adds a schedule row's delays as lists in channel order; nothing if it has no delays.
fn add_delay_lists(row: &mut Json) {
    for (name, side) in [("input_delays_s", "inputs"), ("output_delays_s", "outputs")] {
        if let Some(delays) = row
            .get("delays_s")
            .and_then(|delays| delays[side].as_object())
        {
            row[name] = delays.values().cloned().collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use gdcm_method::schedule::SecondVariable;
    use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};
    use gdcm_model::progress::Unobserved;
    use gdcm_study::decisions::setting_table;
    use gdcm_study::{Edit, Engine, PhaseCorrection, Study};

    use super::*;
    use crate::files::corrections_file::corrections;
    use crate::files::dataset_file::embedded_example;

    /// Collects the paths of all JSON leaves, leaving out list indices and names of channels and
    /// models.
    fn json_paths(json: &serde_json::Value, path: &str, found: &mut BTreeSet<String>) {
        match json {
            serde_json::Value::Array(list) => {
                list.iter().for_each(|entry| json_paths(entry, path, found))
            }
            serde_json::Value::Object(members) => {
                for (name, value) in members {
                    let is_name = ["inputs", "outputs", "discontinuity"]
                        .iter()
                        .any(|by| path.ends_with(by));
                    json_paths(
                        value,
                        &if is_name {
                            path.to_owned()
                        } else {
                            format!("{path}.{name}")
                        },
                        found,
                    );
                }
            }
            _ => {
                found.insert(path.to_owned());
            }
        }
    }

    fn struct_paths(value: &Value, path: &str, found: &mut BTreeSet<String>) {
        found.insert(path.to_owned());
        match value {
            Value::Struct(records) => {
                for (name, values) in &records.fields {
                    values
                        .iter()
                        .for_each(|value| struct_paths(value, &format!("{path}.{name}"), found));
                }
            }
            Value::Cell(cell) => cell
                .values
                .iter()
                .for_each(|value| struct_paths(value, path, found)),
            _ => {}
        }
    }

    #[test]
    fn the_struct_of_matlab_has_every_field_of_the_json() {
        let model = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
        let mut altitude = Study::new(embedded_example().unwrap().dataset);
        altitude.settings.schedule.second = Some(SecondVariable::Altitude);
        altitude
            .apply(&Edit::RejectBecause {
                model,
                reason: "trimmed badly".to_owned(),
            })
            .unwrap();
        let mut leads = Study::new(embedded_example().unwrap().dataset);
        leads
            .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
            .unwrap();
        let mut engine = Engine::default();
        let mut of_json = BTreeSet::new();
        let mut of_matlab = BTreeSet::new();
        for study in [altitude, leads] {
            let mut analysis = engine.analyze(&study, &Unobserved).unwrap();
            analysis.uncertainty = Some(Arc::new(
                engine.uncertainty(&analysis, &Unobserved).unwrap(),
            ));
            let corrections = corrections(
                &analysis,
                "ba78",
                &analysis.conditions.keys().copied().collect(),
            );
            json_paths(&corrections, "", &mut of_json);
            struct_paths(
                &corrections_struct(corrections, &study.dataset),
                "",
                &mut of_matlab,
            );
        }
        let of_json = of_json
            .iter()
            .map(|path| path.replace(".net_gains.", ".net_gain_table."));
        let missing: Vec<String> = of_json.filter(|path| !of_matlab.contains(path)).collect();
        assert_eq!(missing, [""; 0]);
        for path in [
            ".schedule.second_variable.inputs",
            ".conditions.reasons.why",
            ".conditions.bars.G.interval",
        ] {
            assert!(of_matlab.contains(path), "{path} of {of_matlab:?}");
        }
    }
}
