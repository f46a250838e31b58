//! Sentences about corrected models that cannot be represented by matrices (M10, M16.3).

use gdcm_method::correction::corrected_model::{CorrectedModelError, samples_of_delay};
use gdcm_method::couplings::CoupledModelError;
use gdcm_model::dataset::Dataset;
use gdcm_model::units::number;

/// Returns why a model cannot be represented by matrices; a delayed channel is named instead of
/// numbered.
pub fn coupled_model_error_text(error: &CoupledModelError, dataset: &Dataset) -> String {
    let (inputs, outputs) = dataset.input_and_output_names();
    named_error_text(error, &inputs, &outputs)
}

fn named_error_text(error: &CoupledModelError, inputs: &[String], outputs: &[String]) -> String {
    match error {
        CoupledModelError::Delays(CorrectedModelError::PartOfSample {
            channel,
            delay_s,
            sample_time_s,
        }) => format!(
            "the total delay of {} (model and correction), {} s, is {} samples of {} s: a \
            discrete-time model can only be delayed by whole samples; use a continuous-time model",
            channel.name(inputs, outputs),
            number(*delay_s),
            number(samples_of_delay(*delay_s, *sample_time_s)),
            number(*sample_time_s)
        ),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::Channel;

    use super::*;

    #[test]
    fn a_delayed_channel_is_named() {
        let error = CoupledModelError::Delays(CorrectedModelError::PartOfSample {
            channel: Channel::Output(1),
            delay_s: 0.011,
            sample_time_s: 0.01,
        });
        let outputs = ["P".to_owned(), "Q".to_owned()];
        let text = named_error_text(&error, &[], &outputs);
        assert_eq!(
            text,
            "the total delay of Q (model and correction), 0.011 s, is 1.1 samples of 0.01 s: a \
            discrete-time model can only be delayed by whole samples; use a continuous-time model"
        );
        assert_eq!(text, error.to_string().replace("output 2", "Q"));
        assert_eq!(named_error_text(&error, &[], &[]), error.to_string());
    }
}
