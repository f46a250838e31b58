//! Joins measured responses from several files into a single model. A measured model consists of
//! one or more parts ([`Part`]), which have the same name and together give its responses.

use std::ops::Range;

use super::channel_conversion::bands_or_full_range;
use super::part::Part;
use super::rules::Rules;
use crate::dataset::dataset_draft::{ModelDraft, ResponseArray, ResponseDraft};
use crate::dataset::model::Provenance;

/// Valid band for an unmeasured response \[rad/s\]: an empty band.
const NOT_MEASURED: [f64; 2] = [0.0, 0.0];

/// Adds a part's responses that the measured model lacks, and extends the model's provenance.
pub(super) fn join_part(model: &mut ModelDraft, response: &ResponseDraft, part: &Part) {
    let Some(joined) = &mut model.response else {
        return;
    };
    join_response(joined, response);
    let Some(source) = &mut model.source else {
        return;
    };
    append_note(source, &format!("with {}", part.found.key()));
    if let Some(part_source) = &part.found.draft.source {
        source.unused.extend_from_slice(&part_source.unused);
    }
    source.by_position.extend(part.sides_by_position());
    source.by_position.dedup();
}

/// Copies the responses that `joined` lacks, with their valid bands and coherence.
fn join_response(joined: &mut ResponseDraft, response: &ResponseDraft) {
    let count = joined.omega.len();
    let new_bands = bands_or_full_range(response);
    let mut bands = bands_or_full_range(joined);
    // `number` counts the responses row by row: output times input count plus input. Each has two
    // band ends, and `count` values.
    for number in 0..joined.re.shape[0] * joined.re.shape[1] {
        let band = 2 * number..2 * number + 2;
        let is_new = new_bands.values[band.clone()] != NOT_MEASURED;
        let is_known = bands.values[band.clone()] != NOT_MEASURED;
        if !is_new || is_known {
            continue;
        }
        let values = number * count..(number + 1) * count;
        joined.re.values[values.clone()].copy_from_slice(&response.re.values[values.clone()]);
        joined.im.values[values.clone()].copy_from_slice(&response.im.values[values.clone()]);
        bands.values[band.clone()].copy_from_slice(&new_bands.values[band]);
        join_coherence(joined, response, values);
    }
    joined.valid_bands = Some(bands);
}

/// Copies the coherence in an index range. If only some parts have coherence, it is set to 1 for
/// the other parts.
fn join_coherence(joined: &mut ResponseDraft, response: &ResponseDraft, range: Range<usize>) {
    if joined.coherence.is_none() && response.coherence.is_none() {
        return;
    }
    let shape = joined.re.shape;
    let coherence = joined.coherence.get_or_insert_with(|| ResponseArray {
        shape,
        values: vec![1.0; shape.iter().product()],
    });
    match &response.coherence {
        Some(new) => coherence.values[range.clone()].copy_from_slice(&new.values[range]),
        None => coherence.values[range].fill(1.0),
    }
}

/// Adds a note about the responses that no file contains. Drops the valid bands if every response
/// is valid at all frequencies.
pub(super) fn note_unmeasured(model: &mut ModelDraft, rules: &Rules) {
    let Some(response) = &mut model.response else {
        return;
    };
    let Some(bands) = &response.valid_bands else {
        return;
    };
    let last = response.omega.last().copied().unwrap_or(0.0);
    if bands.values.chunks(2).all(|band| band == [0.0, last]) {
        response.valid_bands = None;
        return;
    }
    let input_count = rules.inputs.len().max(1);
    let mut unmeasured = Vec::new();
    // `number` counts the responses row by row, as in `join_response`.
    for (number, band) in bands.values.chunks(2).enumerate() {
        if band == NOT_MEASURED
            && let Some(output) = rules.outputs.get(number / input_count)
            && let Some(input) = rules.inputs.get(number % input_count)
        {
            unmeasured.push(format!("{}/{}", output.name, input.name));
        }
    }
    if !unmeasured.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        append_note(source, &format!("not measured: {}", unmeasured.join(", ")));
    }
}

/// Appends to a provenance's note, separated by a semicolon.
fn append_note(source: &mut Provenance, text: &str) {
    source.note = Some(match source.note.take() {
        Some(note) => format!("{note}; {text}"),
        None => text.to_owned(),
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::channel_conversion::{ChannelUses, convert_model};
    use crate::assembly::channel_match::ChannelUse;
    use crate::assembly::test_models::measured_model;
    use crate::names::ChannelRule;

    fn used(index: usize) -> Option<ChannelUse> {
        Some(ChannelUse {
            index,
            factor: 1.0,
            words: None,
        })
    }

    #[test]
    fn unmeasured_responses_have_an_empty_band_and_a_note() {
        let rules = Rules {
            inputs: vec![ChannelRule::named("LON")],
            outputs: vec![ChannelRule::named("Q"), ChannelRule::named("P")],
            ..Rules::default()
        };
        let uses = ChannelUses {
            inputs: &[used(0)],
            outputs: &[None, used(0)],
        };
        let mut partial = convert_model(&measured_model(&[3.0, 4.0]), uses);
        note_unmeasured(&mut partial, &rules);
        assert_eq!(
            partial.response.unwrap().valid_bands.unwrap().values,
            [0.0, 0.0, 0.0, 5.0]
        );
        assert_eq!(
            partial.source.unwrap().note.as_deref(),
            Some("not measured: Q/LON")
        );
        let uses = ChannelUses {
            inputs: &[used(0)],
            outputs: &[used(0), used(1)],
        };
        let mut complete = convert_model(&measured_model(&[1.0, 2.0, 3.0, 4.0]), uses);
        note_unmeasured(&mut complete, &rules);
        assert_eq!(complete.response.unwrap().valid_bands, None);
        assert_eq!(complete.source, None);
    }
}
