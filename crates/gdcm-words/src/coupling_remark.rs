//! Sentences for the remarks on couplings: diagnosis, benefit and cost, cautions (M16.4). Couplings
//! are a mixing of the inputs, in which each receives a share of the others, and a feedback K from
//! outputs to inputs. J is the mismatch cost (M4).

use std::collections::BTreeMap;

use nalgebra::Complex;

use gdcm_method::couplings::Unknown;
use gdcm_method::couplings::coupling_shares::{FeedbackShare, MixingShare};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::{conjugate_pair, counted, with_minus_sign};
use gdcm_model::units::{number, signed, telling};
use gdcm_study::results::coupling_remark::{
    CostSource, CouplingRemark, FeedbackMeaning, OffAxisBenefit,
};
use gdcm_study::results::couplings_assessment::{NoPoles, UnstablePole};

use crate::coupling_error::coupling_error_text;

/// Returns a remark on couplings as one or more sentences: "LAT receives 4.7 % of LON, equivalent
/// to a swashplate phase of 2.7°."
pub fn coupling_remark_text(remark: &CouplingRemark, dataset: &Dataset) -> String {
    match remark {
        CouplingRemark::Unavailable(error) => format!(
            "Couplings are unavailable: {}. All results are computed without couplings.",
            coupling_error_text(error, dataset)
        ),
        CouplingRemark::Mixing(share) => mixing_words(dataset, share),
        CouplingRemark::Feedback { share, meaning } => feedback_words(dataset, share, *meaning),
        CouplingRemark::Costs(benefit) => benefit_words(benefit),
        CouplingRemark::NotWorthwhile { couplings, source } => format!(
            "Off-axis J of {} decreases by less than a tenth with {}: switch the couplings off.",
            source_words(*source),
            couplings.name()
        ),
        CouplingRemark::Offered {
            couplings,
            without,
            with,
        } => format!(
            "With {}, off-axis J of conditions left out of the fit would be {} instead of {}.",
            couplings.name(),
            telling(*with, 1),
            telling(*without, 1)
        ),
        CouplingRemark::ChangeAboveBand {
            condition,
            pair,
            change_db,
            omega_rad_s,
        } => format!(
            "Above the band, at {} rad/s, the couplings change {} more than any other on-axis \
            response: the relative change is {} dB (condition {condition}).",
            number(*omega_rad_s),
            dataset.pair_name(*pair),
            signed(*change_db, 0)
        ),
        CouplingRemark::PolesMoved {
            condition,
            before,
            after,
            distance_rad_s,
        } => format!(
            "Poles within the band move by up to {} rad/s: from {} to {} (condition {condition}).",
            telling(*distance_rad_s, 2),
            pole_words(*before),
            pole_words(*after)
        ),
        CouplingRemark::BarsKeepCouplings => {
            "Error bars of gains, delays and leads hold the couplings fixed: the uncertainty of \
            the couplings is not included."
                .to_owned()
        }
        CouplingRemark::NewlyUnstable {
            is_representative,
            poles,
        } => unstable_words(*is_representative, poles),
        CouplingRemark::CloseToRinging { condition, margin } => format!(
            "The loop of the feedback K and the physics model H is close to ringing at {} rad/s: \
            the minimum singular value of I − K H is {} (condition {condition}).",
            telling(margin.omega_rad_s, 1),
            telling(margin.least, 2)
        ),
        CouplingRemark::FeedbackAsLead { conditions } => format!(
            "In {}, all held responses need lead, which no channel provides. The feedback \
            compensates for it, with large entries and large pole shifts. Correct the phase by \
            leads first.",
            counted(*conditions, "condition")
        ),
        CouplingRemark::FewConditions { conditions } => format!(
            "The couplings are fitted to {}; error bars, and J of conditions left out, require \
            three.",
            counted(*conditions, "condition")
        ),
        CouplingRemark::NotFedBack { outputs } => not_fed_back_words(dataset, outputs),
        CouplingRemark::EntriesUndetermined(unknowns) => undetermined_words(dataset, unknowns),
        CouplingRemark::PolesUnknown { condition, why } => format!(
            "The poles of the physics representative of condition {condition} cannot be computed: {}.",
            no_poles_text(why)
        ),
        CouplingRemark::ModelRefused {
            condition,
            model,
            why,
        } => format!(
            "The effect of the couplings on \"{model}\" (condition {condition}) cannot be \
            computed: {why}."
        ),
        CouplingRemark::PartlyLeftOut { fits, conditions } => format!(
            "J of conditions left out, and the error bars of the couplings, are based on {fits} \
            of {conditions} conditions: if one of the others is left out, the couplings or the \
            schedule cannot be fitted."
        ),
    }
}

/// Returns why a physics model's poles are unavailable.
pub fn no_poles_text(why: &NoPoles) -> String {
    match why {
        NoPoles::Measured => "a measured response has no poles".to_owned(),
        NoPoles::Failed(error) => error.to_string(),
    }
}

/// Names the source of the J that shows the benefit.
fn source_words(source: CostSource) -> &'static str {
    match source {
        CostSource::LeftOut => "conditions left out of the fit",
        CostSource::Schedule => "the schedule",
    }
}

/// Compares J without and with couplings.
fn benefit_words(benefit: &OffAxisBenefit) -> String {
    let mut text = format!(
        "Off-axis J of {} is {} without couplings and {} with {}",
        source_words(benefit.source),
        telling(benefit.without, 1),
        telling(benefit.with, 1),
        benefit.couplings.name()
    );
    if let Some(on_axis) = &benefit.on_axis {
        text.push_str(&format!(
            "; on-axis J is {} and {}",
            telling(on_axis.without, 1),
            telling(on_axis.with, 1)
        ));
    }
    text.push('.');
    text
}

/// Describes a mixing entry: "LAT receives 4.7 % of LON, equivalent to a swashplate phase of 2.7°".
fn mixing_words(dataset: &Dataset, mixing: &MixingShare) -> String {
    let to = &dataset.inputs()[mixing.to];
    let from = &dataset.inputs()[mixing.from];
    if to.unit != from.unit {
        return format!(
            "{} receives {} {} per {} of {}.",
            to.name,
            with_minus_sign(&telling(mixing.share, 3)),
            to.unit,
            from.unit,
            from.name
        );
    }
    let phase = match mixing.swashplate_phase_deg {
        Some(phase_deg) => format!(
            ", equivalent to a swashplate phase of {}°",
            with_minus_sign(&telling(phase_deg, 1))
        ),
        None => String::new(),
    };
    format!(
        "{} receives {} % of {}{phase}.",
        to.name,
        percent(mixing.share),
        from.name
    )
}

/// Describes a feedback entry: "PED follows NY by 1.2 % per m/s², up to 5.0 % of the movement of PED
/// at 2.1 rad/s: directional stiffness that the physics model does not represent correctly".
///
/// The pilot moves the input `moved`, which causes the output and so the feedback to `input`.
fn feedback_words(dataset: &Dataset, feedback: &FeedbackShare, meaning: FeedbackMeaning) -> String {
    let input = &dataset.inputs()[feedback.input];
    let output = &dataset.outputs()[feedback.output];
    let meaning = meaning_words(meaning);
    // A percentage is meaningful only between channels with the same unit.
    let moved = &dataset.inputs()[feedback.moved];
    let share = if moved.unit == input.unit {
        format!(
            "{} % of the movement of {}",
            percent(feedback.share),
            moved.name
        )
    } else {
        format!(
            "{} {} for each {} that {} moves",
            telling(feedback.share, 3),
            input.unit,
            moved.unit,
            moved.name
        )
    };
    format!(
        "{} follows {} by {} {} per {}, up to {share} at {} rad/s: {meaning} that the \
        physics model does not represent correctly.",
        input.name,
        output.name,
        with_minus_sign(&telling(feedback.entry, 3)),
        input.unit,
        output.unit,
        telling(feedback.omega_rad_s, 1)
    )
}

/// Names the physical meaning of a feedback entry.
fn meaning_words(meaning: FeedbackMeaning) -> &'static str {
    match meaning {
        FeedbackMeaning::DirectionalStiffness => "directional stiffness",
        FeedbackMeaning::Damping => "damping",
        FeedbackMeaning::Coupling => "a coupling",
    }
}

/// Counts the newly unstable poles and locates them.
fn unstable_words(is_representative: bool, poles: &[UnstablePole]) -> String {
    let models = if is_representative {
        "physics representatives"
    } else {
        "other kept physics models"
    };
    let places = unstable_places(poles);
    if poles.len() == 1 {
        format!("A pole of the {models} becomes unstable with the couplings: {places}.")
    } else {
        format!(
            "{} poles of {models} become unstable with the couplings: {places}.",
            poles.len()
        )
    }
}

/// Lists the outputs that cannot be fed back.
fn not_fed_back_words(dataset: &Dataset, outputs: &[usize]) -> String {
    let names: Vec<&str> = outputs
        .iter()
        .map(|&output| dataset.outputs()[output].name.as_str())
        .collect();
    format!(
        "{} cannot be fed back: the response to at least one input is missing in every condition.",
        names.join(", ")
    )
}

/// Lists the entries that the data do not determine.
fn undetermined_words(dataset: &Dataset, unknowns: &[Unknown]) -> String {
    let (inputs, outputs) = dataset.input_and_output_names();
    let names: Vec<String> = unknowns
        .iter()
        .map(|unknown| match *unknown {
            Unknown::Mixing { to, from, .. } => format!("{} from {}", inputs[to], inputs[from]),
            Unknown::Feedback { input, output } => {
                format!("{} from {}", inputs[input], outputs[output])
            }
        })
        .collect();
    format!(
        "No response determines these entries of the mixing and the feedback, which keep their \
        values without couplings: {}.",
        names.join(", ")
    )
}

/// Formats a share in percent.
fn percent(share: f64) -> String {
    with_minus_sign(&telling(100.0 * share, 1))
}

/// Locates unstable poles, grouped by condition: "within the band, condition 4, slow at 2
/// rad/s; condition 1, 8 models at 0.143 to 0.149 rad/s".
fn unstable_places(poles: &[UnstablePole]) -> String {
    let mut inside_band: BTreeMap<ConditionId, Vec<&UnstablePole>> = BTreeMap::new();
    let mut outside_band: BTreeMap<ConditionId, Vec<&UnstablePole>> = BTreeMap::new();
    for pole in poles {
        let by_condition = if pole.is_in_band {
            &mut inside_band
        } else {
            &mut outside_band
        };
        by_condition.entry(pole.condition).or_default().push(pole);
    }
    let mut places = Vec::new();
    for (condition, poles) in &inside_band {
        places.push(format!(
            "within the band, {}",
            unstable_place(*condition, poles)
        ));
    }
    for (condition, poles) in &outside_band {
        places.push(unstable_place(*condition, poles));
    }
    places.join("; ")
}

/// Locates a condition's unstable poles: "condition 1, 8 models at 0.143 to 0.149 rad/s".
fn unstable_place(condition: ConditionId, poles: &[&UnstablePole]) -> String {
    let moduli: Vec<f64> = poles.iter().map(|pole| pole.pole.norm()).collect();
    let least = telling(moduli.iter().copied().fold(f64::INFINITY, f64::min), 3);
    let most = telling(moduli.iter().copied().fold(0.0, f64::max), 3);
    let models = match poles {
        poles if poles.iter().all(|pole| pole.is_representative) => String::new(),
        [pole] => format!(", {}", pole.model),
        poles => format!(", {} models", poles.len()),
    };
    let frequencies = if least == most {
        least
    } else {
        format!("{least} to {most}")
    };
    format!("condition {condition}{models} at {frequencies} rad/s")
}

/// Formats a pole: "−0.30 ± j1.20 rad/s".
fn pole_words(pole: Complex<f64>) -> String {
    format!("{} rad/s", conjugate_pair(pole.re, pole.im, 2))
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::dataset::DatasetHeader;

    use super::*;
    use crate::reference_tests::reference_dataset;

    #[test]
    fn a_share_of_a_stick_in_another_unit_is_no_percentage() {
        let old = reference_dataset();
        let share = FeedbackShare {
            input: 2,
            output: 5,
            entry: 0.092,
            share: 0.106,
            moved: 0,
            condition: ConditionId(1),
            omega_rad_s: 0.5,
        };
        let words = feedback_words(&old, &share, FeedbackMeaning::Coupling);
        assert!(
            words.contains("up to 10.6 % of the movement of LON at 0.5 rad/s"),
            "{words}"
        );
        let mut inputs = old.inputs().to_vec();
        inputs[0].unit = "inch".into();
        let header = DatasetHeader {
            name: old.name().into(),
            description: String::new(),
            inputs,
            outputs: old.outputs().to_vec(),
            on_axis: old.on_axis().clone(),
            band: old.band(),
            parameters: Vec::new(),
        };
        let conditions = old
            .conditions()
            .iter()
            .map(|condition| (**condition).clone())
            .collect();
        let words = feedback_words(
            &Dataset::new(header, conditions).unwrap(),
            &share,
            FeedbackMeaning::Coupling,
        );
        assert!(
            words.contains("up to 0.106 % for each inch that LON moves at 0.5 rad/s"),
            "{words}"
        );
    }
}
