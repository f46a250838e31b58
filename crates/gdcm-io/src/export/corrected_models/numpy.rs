//! Corrected models as arrays for NumPy.
//!
//! ```text
//! A_0, B_0, C_0, D_0, StateName_0          model 0; and so on for the others
//! InputName, InputUnit, OutputName, ...    an entry per channel
//! Ts, condition, airspeed_kt, ...          an entry per model: the metrics (metrics.rs)
//! model, correction                        an entry per model: names
//! contains_gains, contains_delays, ...     an entry per model: source of each correction part,
//!                                          which is the schedule, the condition's own correction,
//!                                          or none
//! contains_physics, contains_left_out      an entry per model: changes of the physics parameters
//!                                          (M18), and the omitted parts
//! ```

use gdcm_model::dataset::Dataset;

use super::metrics::{METRICS, array, matrices};
use crate::export::exported_model::ExportedModel;
use crate::export::matlab_values::matrix;
use crate::files::export_contents::{ExportContents, PartSource};
use crate::formats::variables::{TextArray, Value, Variable};

/// Correction part name, with the function that returns its source.
type CorrectionPart = (&'static str, fn(&ExportContents) -> PartSource);

/// Correction parts whose sources the file states.
const CORRECTION_PARTS: [CorrectionPart; 4] = [
    ("gains", |contents| contents.gains),
    ("delays", |contents| contents.delays),
    ("leads", |contents| contents.leads),
    ("couplings", |contents| contents.couplings),
];

/// Returns the models as arrays, because NumPy files hold nothing else.
pub(super) fn model_arrays(models: &[ExportedModel], dataset: &Dataset) -> Vec<Variable> {
    let mut arrays = NamedArrays::default();
    for (index, model) in models.iter().enumerate() {
        for (name, values) in matrices(model) {
            arrays.add(format!("{name}_{index}"), array(values));
        }
        arrays.add(format!("StateName_{index}"), row_of_texts(&model.states));
    }
    for (side, channels) in [("Input", dataset.inputs()), ("Output", dataset.outputs())] {
        let names = row_of_texts(channels.iter().map(|channel| &channel.name));
        let units = row_of_texts(channels.iter().map(|channel| &channel.unit));
        arrays.add(format!("{side}Name"), names);
        arrays.add(format!("{side}Unit"), units);
    }
    for (name, metric) in METRICS {
        let values = models.iter().map(metric).collect();
        arrays.add(name.to_owned(), matrix(1, models.len(), values));
    }
    let names = row_of_texts(models.iter().map(|model| &model.name));
    arrays.add("model".to_owned(), names);
    let corrections = row_of_texts(models.iter().map(|model| model.correction));
    arrays.add("correction".to_owned(), corrections);
    for (name, source_of) in CORRECTION_PARTS {
        let sources = row_of_texts(models.iter().map(|model| source_of(&model.contents).word()));
        arrays.add(format!("contains_{name}"), sources);
    }
    let physics_changes =
        row_of_texts(models.iter().map(|model| model.contents.physics.join(", ")));
    arrays.add("contains_physics".to_owned(), physics_changes);
    let left_out = row_of_texts(
        models
            .iter()
            .map(|model| model.contents.left_out_words(dataset).join("; ")),
    );
    arrays.add("contains_left_out".to_owned(), left_out);
    arrays.variables
}

/// Named arrays, in file order.
#[derive(Default)]
struct NamedArrays {
    variables: Vec<Variable>,
}

impl NamedArrays {
    fn add(&mut self, name: String, value: Value) {
        self.variables.push(Variable { name, value });
    }
}

/// Returns a row with one string per entry.
pub(super) fn row_of_texts<T: ToString>(texts: impl IntoIterator<Item = T>) -> Value {
    let texts: Vec<String> = texts.into_iter().map(|text| text.to_string()).collect();
    Value::Text(TextArray {
        shape: vec![1, texts.len()],
        texts,
    })
}
