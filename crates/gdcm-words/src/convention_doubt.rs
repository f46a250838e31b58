//! Sentences about apparent sign and unit differences between the two bundles.

use std::f64::consts::PI;

use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::rounded_to_three_digits;
use gdcm_study::results::convention_doubt::{Convention, ConventionDoubt};

/// Largest ratio between a factor and a listed conversion factor at which they match.
const NEAR_FACTOR: f64 = 1.08;

/// Conversion factors between common units, with the unit names.
const KNOWN_FACTORS: [(f64, &str); 6] = [
    (9.806_65, "g and m/s²"),
    (32.174, "g and ft/s²"),
    (180.0 / PI, "radians and degrees"),
    (100.0, "a fraction and percent"),
    (12.0, "feet and inches"),
    (1000.0, "a unit and its thousandth"),
];

/// Describes a suspected difference in sign or unit, and how to resolve it.
pub fn doubt_text(doubt: &ConventionDoubt, dataset: &Dataset) -> String {
    let channel = doubt.channel.name_in(dataset);
    let pairs: Vec<String> = doubt
        .pairs
        .iter()
        .map(|&pair| dataset.pair_name(pair))
        .collect();
    let names = pairs.join(", ");
    let place = conditions_text(doubt, dataset);
    let alike = if doubt.all_responses {
        format!(", like all responses of {channel},")
    } else {
        String::new()
    };
    let is_single = pairs.len() == 1;
    match doubt.convention {
        Convention::Sign => {
            let differ = if is_single { "differs" } else { "differ" };
            format!(
                "{names} of the identified models {differ} from the physics model by about half a \
                turn at most frequencies{alike} {place}: {channel} of the identified models has the \
                opposite sign. Reverse it?"
            )
        }
        Convention::Factor(factor) => {
            let are = if is_single { "is" } else { "are" };
            format!(
                "{names} of the identified models {are} {} times as large as in the physics \
                model{alike} {place}{}. Check the unit of {channel}",
                rounded_to_three_digits(factor),
                known_units_text(factor)
            )
        }
    }
}

/// Names the conditions: "in every condition", "in condition 3", "in conditions 3, 8".
fn conditions_text(doubt: &ConventionDoubt, dataset: &Dataset) -> String {
    let ids: Vec<String> = doubt.conditions.iter().map(ToString::to_string).collect();
    match ids.len() {
        count if count == dataset.conditions().len() => "in every condition".to_owned(),
        1 => format!("in condition {}", ids[0]),
        _ => format!("in conditions {}", ids.join(", ")),
    }
}

/// Names the units with about this conversion factor: ", near 57.3: radians and degrees"; empty if
/// no listed factor matches.
fn known_units_text(factor: f64) -> String {
    for (known, units) in KNOWN_FACTORS {
        if is_near(factor, known) {
            let known = if factor < 1.0 {
                format!("1/{}", rounded_to_three_digits(known))
            } else {
                rounded_to_three_digits(known)
            };
            return format!(", near {known}: {units}");
        }
    }
    String::new()
}

fn is_near(factor: f64, known: f64) -> bool {
    let ratio = if factor < 1.0 {
        factor * known
    } else {
        factor / known
    };
    (1.0 / NEAR_FACTOR..=NEAR_FACTOR).contains(&ratio)
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::Channel;

    use super::*;
    use crate::reference_tests::reference_dataset;

    #[test]
    fn a_sign_is_described_with_its_response_and_the_question() {
        let dataset = reference_dataset();
        let doubt = ConventionDoubt {
            convention: Convention::Sign,
            channel: Channel::Output(5),
            pairs: vec![dataset.find_pair("NZ", "COL").unwrap()],
            all_responses: true,
            conditions: dataset.ids().collect(),
        };
        let words = doubt_text(&doubt, &dataset);
        assert!(
            words.starts_with("COL → NZ of the identified models differs from the physics model"),
            "{words}"
        );
        assert!(
            words.ends_with("NZ of the identified models has the opposite sign. Reverse it?"),
            "{words}"
        );
    }

    #[test]
    fn units_are_named_by_their_factor() {
        for (factor, units) in [
            (1.0 / 9.806_65, "1/9.81: g and m/s²"),
            (0.1, "1/9.81: g and m/s²"),
            (1.0 / 32.174, "1/32.2: g and ft/s²"),
            (1e-3, "1/1000: a unit and its thousandth"),
            (180.0 / PI, "57.3: radians and degrees"),
            (100.0, "100: a fraction and percent"),
        ] {
            let words = known_units_text(factor);
            assert!(words.contains(units), "{words}");
        }
    }
}
