//! Corrected models for MATLAB and for `NumPy`.

use nalgebra::DMatrix;

use super::exported_model::ExportedModel;
use super::fields::{Fields, cell_of_texts, matrix, records, scalar, text};
use crate::variables::{TextArray, Value, Variable};
use gdcm_core::dataset::{Channel, Dataset};

/// The variable `models`: one record for each model, with the properties of MATLAB's `ss`: `ss(m.A, m.B, m.C, m.D, m.Ts)`.
pub(super) fn models_variable(models: &[ExportedModel], dataset: &Dataset) -> Variable {
    let names = |channels: &[Channel]| cell_of_texts(channels.iter().map(|channel| channel.name.clone()));
    let units = |channels: &[Channel]| cell_of_texts(channels.iter().map(|channel| channel.unit.clone()));
    let record = |model: &ExportedModel| {
        let mut fields = Fields::default();
        for (name, values) in matrices(model) {
            fields.add(name, array(values));
        }
        fields.add("InputName", names(dataset.inputs()));
        fields.add("OutputName", names(dataset.outputs()));
        fields.add("InputUnit", units(dataset.inputs()));
        fields.add("OutputUnit", units(dataset.outputs()));
        fields.add("StateName", cell_of_texts(model.states.iter().cloned()));
        fields.add("Ts", scalar(sample_time_s(model)));
        fields.add("condition", scalar(model.condition.0 as f64));
        fields.add("airspeed_kt", scalar(model.airspeed_kt));
        fields.add("model", text(&model.name));
        fields.add("correction", text(model.correction));
        fields.add("pade_order", scalar(model.pade_order as f64));
        fields.add("phase_error_deg", scalar(model.phase_error_deg));
        fields.add("band_top_rad_s", scalar(model.band_top_rad_s));
        fields
    };
    Variable { name: "models".to_owned(), value: records(models.iter().map(record).collect()) }
}

/// A figure of a model, and its name.
type Figure = (&'static str, fn(&ExportedModel) -> f64);

/// The same as arrays, which is all that `NumPy` has: of model 0 `A_0`, `B_0`, `C_0`, `D_0` and `StateName_0`; one entry for each model in
/// the others.
pub(super) fn model_arrays(models: &[ExportedModel], dataset: &Dataset) -> Vec<Variable> {
    let variable = |name: String, value: Value| Variable { name, value };
    let mut variables = Vec::new();
    for (place, model) in models.iter().enumerate() {
        let named = matrices(model).map(|(name, values)| variable(format!("{name}_{place}"), array(values)));
        variables.extend(named);
        variables.push(variable(format!("StateName_{place}"), row_of_texts(model.states.iter())));
    }
    for (name, channels) in [("Input", dataset.inputs()), ("Output", dataset.outputs())] {
        let names = row_of_texts(channels.iter().map(|channel| &channel.name));
        let units = row_of_texts(channels.iter().map(|channel| &channel.unit));
        variables.extend([variable(format!("{name}Name"), names), variable(format!("{name}Unit"), units)]);
    }
    let figures: [Figure; 6] = [
        ("Ts", sample_time_s),
        ("condition", |model| model.condition.0 as f64),
        ("airspeed_kt", |model| model.airspeed_kt),
        ("pade_order", |model| model.pade_order as f64),
        ("phase_error_deg", |model| model.phase_error_deg),
        ("band_top_rad_s", |model| model.band_top_rad_s),
    ];
    for (name, figure) in figures {
        let values = models.iter().map(figure).collect();
        variables.push(variable(name.to_owned(), matrix(1, models.len(), values)));
    }
    variables.push(variable("model".to_owned(), row_of_texts(models.iter().map(|model| &model.name))));
    let corrections = models.iter().map(|model| model.correction);
    variables.push(variable("correction".to_owned(), row_of_texts(corrections)));
    variables
}

/// MATLAB's `Ts` \[s\]: 0 in continuous time.
fn sample_time_s(model: &ExportedModel) -> f64 {
    model.model.timing().sample_time_s.unwrap_or(0.0)
}

fn matrices(model: &ExportedModel) -> [(&'static str, &DMatrix<f64>); 4] {
    let of = &model.model;
    [("A", of.a()), ("B", of.b()), ("C", of.c()), ("D", of.d())]
}

fn array(values: &DMatrix<f64>) -> Value {
    // Both run column by column.
    matrix(values.nrows(), values.ncols(), values.as_slice().to_vec())
}

fn row_of_texts<T: ToString>(texts: impl Iterator<Item = T>) -> Value {
    let texts: Vec<String> = texts.map(|text| text.to_string()).collect();
    Value::Text(TextArray { shape: vec![1, texts.len()], texts })
}

#[cfg(test)]
mod tests {
    use super::super::exported_model::exported_models;
    use super::*;
    use crate::npy::write_npz;
    use crate::variables::MemoryBudget;
    use crate::zip_files::read_npz;
    use crate::{embedded_example, mat};
    use gdcm_core::study::{Engine, ExportFormat, ExportRequest, Study, Unobserved};

    #[test]
    fn numpy_and_matlab_get_the_same_matrices_and_names() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let models = exported_models(&analysis, &ExportRequest::new(ExportFormat::StateSpace)).unwrap();
        let budget = MemoryBudget::new(1 << 28, &|_| false);
        let arrays = read_npz(&write_npz(&model_arrays(&models, &study.dataset)).unwrap(), &budget).unwrap();
        let bytes = mat::write_packed(&[models_variable(&models, &study.dataset)]).unwrap();
        let [Variable { value: Value::Struct(records), .. }] = &mat::read(&bytes, &budget).unwrap()[..] else {
            panic!("one struct array")
        };
        for (place, model) in models.iter().enumerate() {
            for name in ["A", "B", "C", "D"] {
                let found = arrays.iter().find(|array| array.name == format!("{name}_{place}")).unwrap();
                assert_eq!(found.value, records.field(name).unwrap()[place], "{name} of model {place}");
            }
            assert_eq!(records.field("A").unwrap()[place], array(model.model.a()));
            let names = arrays.iter().find(|array| array.name == format!("StateName_{place}")).unwrap();
            assert_eq!(names.value, row_of_texts(model.states.iter()));
        }
        let airspeeds = arrays.iter().find(|array| array.name == "airspeed_kt").unwrap();
        let values = models.iter().map(|model| model.airspeed_kt).collect();
        assert_eq!(airspeeds.value, matrix(1, models.len(), values));
    }
}
