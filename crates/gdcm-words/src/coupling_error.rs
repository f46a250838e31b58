//! Sentences about missing couplings: why mixing and feedback cannot be fitted (M16.2).

use gdcm_method::couplings::problem::CouplingError;
use gdcm_model::dataset::Dataset;
use gdcm_model::units::{number, telling};

/// Returns why couplings are unavailable; a reversed input is named instead of numbered.
pub fn coupling_error_text(error: &CouplingError, dataset: &Dataset) -> String {
    let (inputs, _) = dataset.input_and_output_names();
    named_error_text(error, &inputs)
}

fn named_error_text(error: &CouplingError, inputs: &[String]) -> String {
    if let CouplingError::ReversedInput {
        input,
        airspeed_kt,
        factor,
    } = error
        && let Some(name) = inputs.get(input - 1)
    {
        return format!(
            "the mixing multiplies input {name} by {} at {} kt; a factor of \
            zero or below removes or reverses an input: check its sign in both models, or switch \
            the couplings off",
            telling(*factor, 3),
            number(*airspeed_kt)
        );
    }
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_input_is_named() {
        let error = CouplingError::ReversedInput {
            input: 2,
            airspeed_kt: 40.0,
            factor: -0.598_742_4,
        };
        let inputs = ["LON".to_owned(), "LAT".to_owned()];
        let text = named_error_text(&error, &inputs);
        assert_eq!(
            text,
            "the mixing multiplies input LAT by -0.599 at 40 kt; a factor of \
            zero or below removes or reverses an input: check its sign in both models, or switch \
            the couplings off"
        );
        assert_eq!(text, error.to_string().replace("input 2", "input LAT"));
        assert_eq!(named_error_text(&error, &[]), error.to_string());
    }

    #[test]
    fn the_other_errors_have_no_names() {
        let error = CouplingError::NothingToFit { conditions: 4 };
        assert_eq!(named_error_text(&error, &[]), error.to_string());
    }
}
