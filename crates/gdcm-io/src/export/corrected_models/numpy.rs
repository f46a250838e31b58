//! Corrected models as arrays for NumPy.
//!
//! A correction part (gains, delays, leads, couplings) comes from the schedule, from the
//! condition's own correction, or is missing; `contains_gains` and the like state this source
//! for each model, `contains_physics` the changes of the physics parameters (M18), and
//! `contains_left_out` the omitted parts.

use gdcm_model::dataset::Dataset;

use super::metrics::{METRICS, array, matrices};
use crate::export::exported_model::ExportedModel;
use crate::export::matlab_values::matrix;
use crate::files::export_contents::{ExportContents, PartSource};
use crate::formats::variables::{TextArray, Value, Variable};

/// Correction part name, with the function that returns its source.
type ContainedPart = (&'static str, fn(&ExportContents) -> PartSource);

/// Correction parts whose sources the file states.
const CONTAINED: [ContainedPart; 4] = [
    ("gains", |contents| contents.gains),
    ("delays", |contents| contents.delays),
    ("leads", |contents| contents.leads),
    ("couplings", |contents| contents.couplings),
];

/// Returns the models as arrays, because NumPy files hold nothing else: `A_0`, `B_0`, `C_0`, `D_0`
/// and `StateName_0` for model 0, and so on; every other array has an entry per model or channel.
pub(super) fn model_arrays(models: &[ExportedModel], dataset: &Dataset) -> Vec<Variable> {
    let mut arrays = NamedArrays::default();
    for (place, model) in models.iter().enumerate() {
        for (name, values) in matrices(model) {
            arrays.add(format!("{name}_{place}"), array(values));
        }
        arrays.add(format!("StateName_{place}"), row_of_texts(&model.states));
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
    for (name, source) in CONTAINED {
        let sources = row_of_texts(models.iter().map(|model| source(&model.contents).word()));
        arrays.add(format!("contains_{name}"), sources);
    }
    let moved = row_of_texts(models.iter().map(|model| model.contents.physics.join(", ")));
    arrays.add("contains_physics".to_owned(), moved);
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
