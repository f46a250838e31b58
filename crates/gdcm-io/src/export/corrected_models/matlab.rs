//! Corrected models as a variable for MATLAB.

use gdcm_model::dataset::{Channel, Dataset};

use super::metrics::{METRICS, array, matrices};
use crate::export::exported_model::ExportedModel;
use crate::export::matlab_values::{Fields, cell_of_texts, contained_parts, records};
use crate::formats::variables::{Value, Variable};

/// Returns the variable `models`: a struct for each model whose fields include properties of
/// MATLAB's `ss` under their names, so that `ss(m.A, m.B, m.C, m.D, m.Ts)` is the model.
pub(super) fn models_variable(models: &[ExportedModel], dataset: &Dataset) -> Variable {
    Variable {
        name: "models".to_owned(),
        value: records(
            models
                .iter()
                .map(|model| model_fields(model, dataset))
                .collect(),
        ),
    }
}

fn model_fields(model: &ExportedModel, dataset: &Dataset) -> Fields {
    let mut fields = Fields::default();
    for (name, values) in matrices(model) {
        fields.add(name, array(values));
    }
    fields.add("InputName", names_of(dataset.inputs()));
    fields.add("OutputName", names_of(dataset.outputs()));
    fields.add("InputUnit", units_of(dataset.inputs()));
    fields.add("OutputUnit", units_of(dataset.outputs()));
    fields.add("StateName", cell_of_texts(model.states.iter().cloned()));
    for (name, metric) in METRICS {
        fields.add(name, Value::number(metric(model)));
    }
    fields.add("model", Value::text(&model.name));
    fields.add("correction", Value::text(model.correction));
    fields.add("contains", contained_parts(&model.contents, dataset));
    fields
}

fn names_of(channels: &[Channel]) -> Value {
    cell_of_texts(channels.iter().map(|channel| channel.name.clone()))
}

fn units_of(channels: &[Channel]) -> Value {
    cell_of_texts(channels.iter().map(|channel| channel.unit.clone()))
}
