//! A model in the channels and units of the dataset.

use nalgebra::DMatrix;

use crate::dataset::{BandsDraft, ModelDraft, ResponseArray, ResponseDraft, Timing};

use super::channel_match::ChannelUse;

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
