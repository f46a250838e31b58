//! Converts a model to the dataset's channels, order and units.
//!
//! A [`ChannelUse`] is a file channel matched to a dataset channel, with the factor from the file's
//! unit and sign to the dataset's (`channel_match.rs`).

use nalgebra::DMatrix;

use super::channel_match::ChannelUse;
use crate::dataset::dataset_draft::{BandsDraft, ModelDraft, ResponseArray, ResponseDraft};
use crate::dataset::state_space::Timing;

/// A model's file channels, one entry per dataset channel; `None` if the model lacks the channel.
#[derive(Clone, Copy)]
pub(super) struct ChannelUses<'u> {
    pub inputs: &'u [Option<ChannelUse>],
    pub outputs: &'u [Option<ChannelUse>],
}

/// Whether table values are converted with the channels' unit factors.
#[derive(Clone, Copy, PartialEq)]
enum Scaling {
    Converted,
    Unchanged,
}

/// Converts a model to the dataset's channels: `H'_oi = f_o H_oi / f_i` with the unit factors `f`
/// for output `o` and input `i`. Values whose factors are 1 are copied bit for bit; a missing
/// channel gives a zero response.
pub(super) fn convert_model(model: &ModelDraft, uses: ChannelUses<'_>) -> ModelDraft {
    let [a, b, c, d] = &model.matrices;
    let b = b.as_ref().map(|b| pick_inputs(b, uses.inputs));
    let c = c.as_ref().map(|c| pick_outputs(c, uses.outputs));
    let d = d
        .as_ref()
        .map(|d| pick_outputs(&pick_inputs(d, uses.inputs), uses.outputs));
    // A unit factor shifts the magnitude in dB and leaves its standard deviation unchanged.
    let bands = model.bands.as_ref().map(|bands| BandsDraft {
        omega: bands.omega.clone(),
        sd_db: pick_table(&bands.sd_db, uses, Scaling::Unchanged),
        sd_deg: pick_table(&bands.sd_deg, uses, Scaling::Unchanged),
    });
    ModelDraft {
        matrices: [a.clone(), b, c, d],
        response: model
            .response
            .as_ref()
            .map(|response| convert_response(response, uses)),
        timing: convert_timing(&model.timing, uses),
        bands,
        ..model.clone()
    }
}

fn convert_response(response: &ResponseDraft, uses: ChannelUses<'_>) -> ResponseDraft {
    let is_complete = uses.inputs.iter().chain(uses.outputs).all(Option::is_some);
    // An unmeasured response has zero values; its empty valid band excludes them.
    let valid_bands = if is_complete {
        response.valid_bands.clone()
    } else {
        Some(bands_or_full_range(response))
    };
    ResponseDraft {
        omega: response.omega.clone(),
        re: pick_table(&response.re, uses, Scaling::Converted),
        im: pick_table(&response.im, uses, Scaling::Converted),
        coherence: response
            .coherence
            .as_ref()
            .map(|table| pick_table(table, uses, Scaling::Unchanged)),
        valid_bands: valid_bands.map(|table| pick_table(&table, uses, Scaling::Unchanged)),
        estimate: response.estimate,
    }
}

/// Returns a response's valid bands \[rad/s\]; without valid bands, the band from 0 to the last
/// frequency for each response.
pub(super) fn bands_or_full_range(response: &ResponseDraft) -> ResponseArray {
    if let Some(bands) = &response.valid_bands {
        return bands.clone();
    }
    let [outputs, inputs, _] = response.re.shape;
    let last = response.omega.last().copied().unwrap_or(0.0);
    ResponseArray {
        shape: [outputs, inputs, 2],
        values: [0.0, last].repeat(outputs * inputs),
    }
}

fn convert_timing(timing: &Timing, uses: ChannelUses<'_>) -> Timing {
    Timing {
        sample_time_s: timing.sample_time_s,
        input_delays_s: timing
            .input_delays_s
            .as_ref()
            .map(|delays| pick_delays(delays, uses.inputs)),
        output_delays_s: timing
            .output_delays_s
            .as_ref()
            .map(|delays| pick_delays(delays, uses.outputs)),
    }
}

/// Returns the delays for the dataset's channels \[s\]; zero for a missing channel.
fn pick_delays(delays: &[f64], uses: &[Option<ChannelUse>]) -> Vec<f64> {
    let mut picked = Vec::with_capacity(uses.len());
    for used in uses {
        let delay = used.as_ref().and_then(|used| delays.get(used.index));
        picked.push(delay.copied().unwrap_or(0.0));
    }
    picked
}

/// Returns the matrix columns in the order of the dataset's inputs, each divided by its unit
/// factor; zeros for a missing channel.
fn pick_inputs(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), uses.len(), |row, column| {
        match &uses[column] {
            Some(used) if used.index < matrix.ncols() => {
                scaled(matrix[(row, used.index)], 1.0, used.factor)
            }
            _ => 0.0,
        }
    })
}

/// Returns the matrix rows in the order of the dataset's outputs, each multiplied by its unit
/// factor; zeros for a missing channel.
fn pick_outputs(matrix: &DMatrix<f64>, uses: &[Option<ChannelUse>]) -> DMatrix<f64> {
    DMatrix::from_fn(uses.len(), matrix.ncols(), |row, column| match &uses[row] {
        Some(used) if used.index < matrix.nrows() => {
            scaled(matrix[(used.index, column)], used.factor, 1.0)
        }
        _ => 0.0,
    })
}

/// Returns `value * numerator / denominator`; exactly `value` if numerator and denominator are
/// equal.
fn scaled(value: f64, numerator: f64, denominator: f64) -> f64 {
    if numerator == denominator {
        value
    } else {
        value * numerator / denominator
    }
}

/// Returns a table `[output, input, value]` for the dataset's channels; zeros for a missing
/// channel.
fn pick_table(array: &ResponseArray, uses: ChannelUses<'_>, scaling: Scaling) -> ResponseArray {
    let [output_count, input_count, count] = array.shape;
    let mut values = Vec::with_capacity(uses.outputs.len() * uses.inputs.len() * count);
    for output in uses.outputs {
        for input in uses.inputs {
            match (output, input) {
                (Some(output), Some(input))
                    if output.index < output_count && input.index < input_count =>
                {
                    // The last index runs fastest: `count` values for each response.
                    let start = (output.index * input_count + input.index) * count;
                    let known = &array.values[start..start + count];
                    match scaling {
                        Scaling::Converted => values.extend(
                            known
                                .iter()
                                .map(|value| scaled(*value, output.factor, input.factor)),
                        ),
                        Scaling::Unchanged => values.extend_from_slice(known),
                    }
                }
                _ => values.extend(std::iter::repeat_n(0.0, count)),
            }
        }
    }
    ResponseArray {
        shape: [uses.outputs.len(), uses.inputs.len(), count],
        values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::model::Origin;

    fn used(index: usize, factor: f64) -> Option<ChannelUse> {
        Some(ChannelUse {
            index,
            factor,
            words: None,
        })
    }

    #[test]
    fn a_response_is_multiplied_by_the_output_factor_over_the_input_factor() {
        let model = ModelDraft {
            name: "m".into(),
            origin: Origin::Perturbed { perturbation: None },
            matrices: [
                DMatrix::from_row_slice(1, 1, &[-1.0]),
                DMatrix::from_row_slice(1, 2, &[1.0, 2.0]),
                DMatrix::from_row_slice(2, 1, &[3.0, 5.0]),
                DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 2.0, 3.0]),
            ]
            .map(Some),
            timing: Timing {
                input_delays_s: Some(vec![0.1, 0.2]),
                ..Timing::default()
            },
            response: None,
            source: None,
            states: Vec::new(),
            bands: None,
            moved: None,
        };
        let uses = ChannelUses {
            inputs: &[used(1, 2.0), used(0, 1.0)],
            outputs: &[used(1, 10.0)],
        };
        let converted = convert_model(&model, uses);
        let [_, b, c, d] = converted.matrices.map(Option::unwrap);
        assert_eq!(b.as_slice(), [1.0, 1.0]);
        assert_eq!(c.as_slice(), [50.0]);
        assert_eq!(d.as_slice(), [15.0, 20.0]);
        assert_eq!(converted.timing.input_delays_s, Some(vec![0.2, 0.1]));
        let unchanged = ChannelUses {
            inputs: &[used(0, 1.0), used(1, 1.0)],
            outputs: &[used(0, 1.0), used(1, 1.0)],
        };
        assert_eq!(convert_model(&model, unchanged), model);
    }
}
