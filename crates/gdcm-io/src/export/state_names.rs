//! State names for a corrected model.

use gdcm_method::correction::corrected_model::CorrectedModel;
use gdcm_model::dataset::{Channel, Dataset, Model};

/// Returns the state names, in this order: "LON lead 1" and "LON delay 1" for inputs, the model's
/// own state names, "Q delay 1" and "Q lead 1" for outputs.
pub(super) fn state_names(
    dataset: &Dataset,
    model: &Model,
    corrected: &CorrectedModel,
) -> Vec<String> {
    let CorrectedModel {
        lead_states,
        delay_states,
        ..
    } = corrected;
    let inputs = dataset.inputs();
    let outputs = dataset.outputs();
    let mut names = Vec::with_capacity(corrected.model.order());
    add_state_names(&mut names, inputs, "lead", &lead_states.inputs);
    add_state_names(&mut names, inputs, "delay", &delay_states.inputs);
    let mut last = Vec::new();
    add_state_names(&mut last, outputs, "delay", &delay_states.outputs);
    add_state_names(&mut last, outputs, "lead", &lead_states.outputs);
    let own_states = corrected.model.order() - names.len() - last.len();
    for state in 0..own_states {
        names.push(model.state_name(state));
    }
    names.extend(last);
    names
}

/// Adds state names for `part` ("lead", "delay"), counted from 1 within each channel.
fn add_state_names(names: &mut Vec<String>, channels: &[Channel], part: &str, counts: &[usize]) {
    for (channel, &count) in channels.iter().zip(counts) {
        for place in 1..=count {
            names.push(format!("{} {part} {place}", channel.name));
        }
    }
}
