//! All results of an analysis: `corrections.json`, `corrections.csv`, and the fields of the former
//! as one MATLAB struct.

use std::collections::BTreeSet;

use serde_json::{Value as Tree, json};

use gdcm_model::dataset::{Channel, ConditionId, Dataset};
use gdcm_study::Analysis;

use super::matlab_struct::{Layout, cell_of_texts};
use super::{Export, ExportFormat, Exported};
use crate::files::corrections_file::{channel_table, corrections, write_corrections};
use crate::files::export_contents::ExportContents;
use crate::formats::mat;
use crate::formats::variables::{Value, Variable};

/// `corrections.json`.
pub(super) const JSON: ExportFormat = ExportFormat {
    name: "json",
    extension: "json",
    words: "corrections.json alone",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |of| {
        let Export {
            analysis, source, ..
        } = *of;
        Ok(Exported::new(move |file| {
            write_corrections(analysis, &source.sha256, &all(analysis), file)
        })
        .with(of.price()))
    },
};

/// `corrections.csv`.
pub(super) const CSV: ExportFormat = ExportFormat {
    name: "csv",
    extension: "csv",
    words: "corrections.csv alone",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |of| {
        let analysis = of.analysis;
        Ok(
            Exported::new(move |file| channel_table(analysis, &all(analysis), file))
                .with(of.price()),
        )
    },
};

/// The MATLAB struct `corrections`.
pub(super) const MAT: ExportFormat = ExportFormat {
    name: "mat",
    extension: "mat",
    words: "MATLAB data: all corrections as one struct",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |of| {
        let corrections = corrections(of.analysis, &of.source.sha256, &all(of.analysis));
        let value = corrections_struct(corrections, &of.analysis.study.dataset);
        Ok(Exported::bytes(mat::write(&[Variable {
            name: "corrections".to_owned(),
            value,
        }])?)
        .with(of.price()))
    },
};

fn all(analysis: &Analysis) -> BTreeSet<ConditionId> {
    analysis.conditions.keys().copied().collect()
}

/// Values of channels are arrays in the order of the dataset's `inputs` and `outputs`.
const LAYOUT: Layout = Layout {
    by_channel: &["inputs", "outputs"],
    by_name: &["discontinuity"],
    columns: &["table"],
};

/// Returns the fields of `corrections.json`. Lists of responses become logical matrices with a row
/// for each output and a column for each input, the values of `net_gains` become the matrices of
/// `net_gain_table`; besides these, fields of earlier programs keep their names.
fn corrections_struct(mut corrections: Tree, dataset: &Dataset) -> Value {
    let pair_rows = |of: &dyn Fn(&str, &str) -> Tree| -> Tree {
        let row = |output: &Channel| {
            dataset
                .inputs()
                .iter()
                .map(|input| of(&output.name, &input.name))
                .collect::<Tree>()
        };
        dataset.outputs().iter().map(row).collect()
    };
    let marked = |pairs: &Tree| {
        let pairs = pairs.as_array().map(Vec::as_slice).unwrap_or_default();
        pair_rows(&|output, input| {
            pairs
                .iter()
                .any(|pair| pair[0] == output && pair[1] == input)
                .into()
        })
    };
    let settings = &mut corrections["settings"];
    for name in ["constrained", "ignored"] {
        settings[name] = marked(&settings[name]);
    }
    // Absent if coherence is not used.
    if settings.get("coherence_threshold").is_none() {
        settings["coherence_threshold"] = Tree::Null;
    }
    for condition in corrections["conditions"]
        .as_array_mut()
        .into_iter()
        .flatten()
    {
        condition["held"] = marked(&condition["held"]);
        condition["held_out"] = condition.get("held_out").cloned().unwrap_or(false.into());
        let net_gains = condition["net_gains"].take();
        let net_gains = net_gains.as_array().map(Vec::as_slice).unwrap_or_default();
        let metric = |key: &str, place: Option<usize>| {
            pair_rows(&|output, input| {
                let found = net_gains
                    .iter()
                    .find(|net| net["output"] == output && net["input"] == input);
                let value = found.and_then(|net| net.get(key));
                value
                    .and_then(|value| place.map_or(Some(value), |place| value.get(place)))
                    .cloned()
                    .into()
            })
        };
        condition["net_gain_table"] = net_gains
            .chunks(dataset.inputs().len())
            .map(|row| json!(row))
            .collect();
        condition["net_gains"] = metric("gain", None);
        condition["net_gains_low"] = metric("interval", Some(0));
        condition["net_gains_high"] = metric("interval", Some(1));
        condition["u_physics"] = metric("u_physics", None);
        condition["u_identification"] = metric("u_identification", None);
        for (name, solution, field) in [
            ("gain_objective", "gain_solution", "objective"),
            ("gain_lower_bound", "gain_solution", "lower_bound"),
            ("gain_proven", "gain_solution", "proven"),
            ("gain_matched", "gain_solution", "matched"),
            ("delay_objective_s2", "delay_solution", "objective"),
            ("delay_matched", "delay_solution", "matched"),
        ] {
            condition[name] = condition[solution][field].clone();
        }
    }
    // Names and units are in separate columns.
    for side in ["inputs", "outputs"] {
        corrections
            .as_object_mut()
            .and_then(|members| members.shift_remove(side));
    }
    if corrections["schedule"].is_null() {
        corrections["schedule"] = json!([]);
    }
    for row in corrections["schedule"]
        .get_mut("table")
        .and_then(Tree::as_array_mut)
        .into_iter()
        .flatten()
    {
        for (name, side) in [("input_delays_s", "inputs"), ("output_delays_s", "outputs")] {
            if let Some(delays) = row
                .get("delays_s")
                .and_then(|delays| delays[side].as_object())
            {
                row[name] = delays.values().cloned().collect();
            }
        }
    }
    let Value::Struct(mut records) = LAYOUT.value("", &corrections) else {
        return LAYOUT.value("", &corrections);
    };
    for (side, channels) in [("input", dataset.inputs()), ("output", dataset.outputs())] {
        let of = |part: fn(&Channel) -> &String| {
            cell_of_texts(channels.iter().map(|channel| part(channel).clone()))
        };
        records
            .fields
            .push((format!("{side}s"), vec![of(|channel| &channel.name)]));
        records
            .fields
            .push((format!("{side}_units"), vec![of(|channel| &channel.unit)]));
    }
    Value::Struct(records)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use gdcm_method::schedule::SecondVariable;
    use gdcm_model::dataset::{BundleKind, ModelId};
    use gdcm_model::progress::Unobserved;
    use gdcm_study::decisions::setting;
    use gdcm_study::{Edit, Engine, PhaseCorrection, Study};

    use super::*;
    use crate::files::dataset_file::embedded_example;

    /// Collects the paths of all JSON members, without list indices and names of channels and
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
            .apply(&setting::PHASE.to(PhaseCorrection::Lead))
            .unwrap();
        let mut engine = Engine::default();
        let mut of_json = BTreeSet::new();
        let mut of_matlab = BTreeSet::new();
        for study in [altitude, leads] {
            let mut analysis = engine.analyze(&study, &Unobserved).unwrap();
            analysis.uncertainty = Some(Arc::new(
                engine.uncertainty(&analysis, &Unobserved).unwrap(),
            ));
            let corrections = corrections(&analysis, "ba78", &all(&analysis));
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
