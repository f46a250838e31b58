//! Sentences and a file template for the runs (physics models with a moved parameter) worth making
//! first (M18.4). A *pattern* in couplings, leads and gains suggests them; the cyclic inputs are
//! the longitudinal and lateral stick.

use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::{decimals, signed};
use gdcm_model::units::number;
use gdcm_study::results::suggested_runs::{LeadSide, RunPattern, SuggestedRuns};

/// States the pattern, and the parameters worth a run.
pub fn suggestion_text(suggestion: &SuggestedRuns, dataset: &Dataset) -> String {
    let names: Vec<String> = suggestion
        .parameters
        .iter()
        .map(|parameter| format!("{} ({})", parameter.name, parameter.meaning))
        .collect();
    format!(
        "{}: try a physics model linearised with {} changed",
        pattern_text(&suggestion.pattern, dataset),
        names.join(", or ")
    )
}

/// States the observed pattern, but not its cause.
pub fn pattern_text(pattern: &RunPattern, dataset: &Dataset) -> String {
    let (inputs, outputs) = dataset.input_and_output_names();
    match pattern {
        RunPattern::CrossedCyclic {
            inputs: [first, second],
            shares: [share_of_second, share_of_first],
        } => format!(
            "{} receives {} % of {}, and {} receives {} % of {}: opposite signs, the pattern of a \
            swashplate phase",
            inputs[*first],
            signed(100.0 * share_of_second, 1),
            inputs[*second],
            inputs[*second],
            signed(100.0 * share_of_first, 1),
            inputs[*first]
        ),
        RunPattern::CrossedRate {
            input,
            output,
            share,
        } => format!(
            "{} feeds {} across the cyclic axes (up to {} % of the pedal travel)",
            outputs[*output],
            inputs[*input],
            decimals(100.0 * share, 0)
        ),
        RunPattern::EqualLeads {
            side,
            mean_s,
            deviation_s,
        } => {
            let side = match side {
                LeadSide::Inputs => "all inputs",
                LeadSide::Outputs => "all outputs",
                LeadSide::Responses => "all on-axis responses",
            };
            format!(
                "{side} need a similar lead ({} ± {} ms)",
                decimals(-1e3 * mean_s, 0),
                decimals(1e3 * deviation_s, 0)
            )
        }
        RunPattern::PedalGainAndYawDamping {
            pair,
            gain,
            damping_share,
        } => {
            let damping = match damping_share {
                Some(share) => format!(
                    ", and a feedback for its damping (up to {} % of the pedal travel)",
                    decimals(100.0 * share, 0)
                ),
                None => String::new(),
            };
            format!(
                "{} needs a gain that differs from 1, or from condition to condition (mean {}){damping}",
                dataset.pair_name(*pair),
                decimals(*gain, 2)
            )
        }
        RunPattern::PitchGainOverAirspeed { pair, slow, fast } => format!(
            "{} needs a gain of {} in the slow conditions and {} in the fast ones",
            dataset.pair_name(*pair),
            decimals(*slow, 2),
            decimals(*fast, 2)
        ),
    }
}

/// Returns a template for the runs in a dataset file: for each parameter a physics model to
/// complete, and the parameters' declaration at the top level.
pub fn run_template(suggestions: &[SuggestedRuns]) -> String {
    let mut declared = Vec::new();
    let mut models = Vec::new();
    for parameter in suggestions
        .iter()
        .flat_map(|suggestion| &suggestion.parameters)
    {
        let unit = parameter.unit;
        let name = parameter.name;
        // The suggested step is a plausible change.
        let step = number(parameter.step);
        declared.push(format!(
            "    {{\"name\": \"{name}\", \"unit\": \"{unit}\", \"plausible_sd\": {step}, \
            \"description\": \"{}\"}}",
            parameter.meaning
        ));
        models.push(format!(
            "        {{\"name\": \"{name} +{step} {unit}\", \"role\": \"perturbed\",\n         \
            \"perturbation\": {{\"airspeed_kt\": 0, \"rate_of_climb_fpm\": 0, \"roll_deg\": 0}},\n         \
            \"parameter\": {{\"name\": \"{name}\", \"delta\": {step}, \"unit\": \"{unit}\"}},\n         \
            \"states\": [], \"A\": [], \"B\": [], \"C\": [], \"D\": []}}"
        ));
    }
    format!(
        "{{\n  \"parameters\": [\n{}\n  ],\n  \"conditions\": [\n    {{\"id\": 1, \"physics_models\": [\n{}\n    ]}}\n  ]\n}}\n",
        declared.join(",\n"),
        models.join(",\n")
    )
}
