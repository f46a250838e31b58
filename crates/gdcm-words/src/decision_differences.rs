//! Differences between two sets of decisions, in words.
//!
//! In the words, *held* responses are constrained, *free* ones are not, *ignored* ones do not count
//! in the objective. *Kept* models are those that are not rejected; the medoid of these represents
//! the bundle unless another model is chosen.

use std::collections::BTreeSet;
use std::fmt;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{BundleKind, ConditionId, PairTable};
use gdcm_model::units::number;
use gdcm_study::Study;
use gdcm_study::decisions::choices::BundleChoice;
use gdcm_study::decisions::physics_settings::PhysicsSettings;
use gdcm_study::decisions::setting_table::SETTINGS;

/// A decision that differs between two studies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionDifference {
    /// Subject of the decision: "α of the gains", "LON → Q", "nominal (condition 10)".
    pub what: String,
    /// Previous value: "1", "held", "rejected".
    pub before: String,
    pub after: String,
}

impl DecisionDifference {
    fn new(what: impl Into<String>, before: impl Into<String>, after: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            before: before.into(),
            after: after.into(),
        }
    }
}

impl fmt::Display for DecisionDifference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {} → {}", self.what, self.before, self.after)
    }
}

/// Words for a decision's two states.
struct YesNo {
    yes: &'static str,
    no: &'static str,
}

impl YesNo {
    fn word(&self, decision: bool) -> &'static str {
        if decision { self.yes } else { self.no }
    }
}

/// Lists the decisions in which `after` differs from `before`: settings, responses, signs, physics
/// parameters, then condition by condition. Both studies must have the same channels and
/// conditions. Variants, adopted models, requirement settings and export choices are not compared.
pub fn decision_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let mut differences = setting_differences(before, after);
    let held = YesNo {
        yes: "held",
        no: "free",
    };
    let ignored = YesNo {
        yes: "ignored",
        no: "fitted",
    };
    differences.extend(pair_differences(before, after, &held, |study| {
        &study.settings.constrained
    }));
    differences.extend(pair_differences(before, after, &ignored, |study| {
        &study.settings.ignored
    }));
    differences.extend(sign_differences(before, after));
    differences.extend(parameter_differences(before, after));
    for condition in before.dataset.conditions() {
        differences.extend(condition_differences(before, after, condition.id()));
    }
    differences
}

fn setting_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    SETTINGS
        .iter()
        .filter(|setting| setting.value(&before.settings) != setting.value(&after.settings))
        .map(|setting| {
            DecisionDifference::new(
                setting.name,
                setting.current_text(&before.settings),
                setting.current_text(&after.settings),
            )
        })
        .collect()
}

fn pair_differences(
    before: &Study,
    after: &Study,
    words: &YesNo,
    marked: fn(&Study) -> &PairTable<bool>,
) -> Vec<DecisionDifference> {
    let mut differences = Vec::new();
    for (pair, &was_marked) in marked(before).iter() {
        if was_marked != marked(after)[pair] {
            differences.push(DecisionDifference::new(
                before.dataset.pair_name(pair),
                words.word(was_marked),
                words.word(!was_marked),
            ));
        }
    }
    differences
}

fn sign_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let mut differences = Vec::new();
    for channel in Channel::of_dataset(&before.dataset) {
        if before.signs.get(&channel) != after.signs.get(&channel) {
            differences.push(DecisionDifference::new(
                format!("sign of {}", channel.name_in(&before.dataset)),
                sign_words(before, channel),
                sign_words(after, channel),
            ));
        }
    }
    differences
}

/// Lists differences in decisions about physics parameters (M18).
fn parameter_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let [old, new] = [before, after].map(|study| &study.settings.physics_parameters);
    let mut names: BTreeSet<&String> = BTreeSet::new();
    for settings in [old, new] {
        names.extend(settings.by_hand.keys());
        names.extend(&settings.off);
        names.extend(settings.plausible_sd.keys());
    }
    let mut differences = Vec::new();
    for name in names {
        let [before, after] = [old, new].map(|settings| parameter_words(settings, name));
        if before != after {
            differences.push(DecisionDifference::new(name.clone(), before, after));
        }
    }
    if old.gain_sd != new.gain_sd || old.delay_sd_s != new.delay_sd_s || old.points != new.points {
        let [before, after] = [old, new].map(|settings| {
            format!(
                "prior standard deviation of gains {}, of delays {} ms; {} frequencies",
                number(settings.gain_sd),
                number(1e3 * settings.delay_sd_s),
                settings.points
            )
        });
        differences.push(DecisionDifference::new(
            "fit of physics parameters",
            before,
            after,
        ));
    }
    differences
}

/// Describes the decisions about a parameter: off, else held by hand, else fitted; then the
/// plausible change, if there is a decision about it: "off", "held at 5, plausible ± 10".
fn parameter_words(settings: &PhysicsSettings, name: &str) -> String {
    let state = if settings.off.contains(name) {
        "off".to_owned()
    } else {
        match settings.by_hand.get(name) {
            Some(change) => format!("held at {}", number(*change)),
            None => "fitted".to_owned(),
        }
    };
    let mut words = vec![state];
    if let Some(plausible_sd) = settings.plausible_sd.get(name) {
        words.push(format!("plausible ± {}", number(*plausible_sd)));
    }
    words.join(", ")
}

fn sign_words(study: &Study, channel: Channel) -> String {
    match study.signs.get(&channel) {
        Some(role) => format!("reversed in {}", role.models()),
        None => "as in the file".to_owned(),
    }
}

fn condition_differences(
    before: &Study,
    after: &Study,
    id: ConditionId,
) -> Vec<DecisionDifference> {
    let scheduled = YesNo {
        yes: "in the schedule",
        no: "left out of the schedule",
    };
    let held_out = YesNo {
        yes: "held out",
        no: "not held out",
    };
    let old = before.choice(id);
    let new = after.choice(id);
    let mut differences = Vec::new();
    for (words, before, after) in [
        (scheduled, old.scheduled, new.scheduled),
        (held_out, old.held_out, new.held_out),
    ] {
        if before != after {
            differences.push(DecisionDifference::new(
                format!("condition {id}"),
                words.word(before),
                words.word(after),
            ));
        }
    }
    for kind in BundleKind::BOTH {
        differences.extend(bundle_differences(
            id,
            kind,
            old.bundle(kind),
            new.bundle(kind),
        ));
    }
    differences
}

fn bundle_differences(
    condition: ConditionId,
    kind: BundleKind,
    before: &BundleChoice,
    after: &BundleChoice,
) -> Vec<DecisionDifference> {
    let names: BTreeSet<&String> = before.rejected.iter().chain(&after.rejected).collect();
    let mut differences: Vec<DecisionDifference> = names
        .into_iter()
        .map(|name| {
            DecisionDifference::new(
                format!("{name} (condition {condition})"),
                rejection_words(before, name),
                rejection_words(after, name),
            )
        })
        .collect();
    differences.push(DecisionDifference::new(
        format!("{kind} representative (condition {condition})"),
        representative_words(before),
        representative_words(after),
    ));
    differences.retain(|difference| difference.before != difference.after);
    differences
}

fn rejection_words(choice: &BundleChoice, model: &String) -> String {
    if !choice.rejected.contains(model) {
        return "kept".to_owned();
    }
    match choice.reasons.get(model) {
        Some(reason) => format!("rejected ({reason})"),
        None => "rejected".to_owned(),
    }
}

fn representative_words(choice: &BundleChoice) -> String {
    match &choice.pinned {
        Some(model) => model.clone(),
        None => "the medoid".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use gdcm_model::dataset::ModelId;
    use gdcm_study::Edit;
    use gdcm_study::decisions::setting_table;

    use super::*;
    use crate::reference_tests::reference_dataset;

    #[test]
    fn differences_have_their_subject_and_both_values() {
        let before = Study::new(Arc::new(reference_dataset()));
        let mut after = before.clone();
        assert_eq!(decision_differences(&before, &after), []);
        let pair = before.dataset.find_pair("Q", "LON").unwrap();
        for edit in [
            setting_table::ALPHA_GAIN.to(0.1),
            Edit::Hold(pair, false),
            Edit::RejectBecause {
                model: ModelId::new(ConditionId(10), BundleKind::Physics, "nominal"),
                reason: "step".to_owned(),
            },
            Edit::SetScheduled {
                condition: ConditionId(3),
                scheduled: false,
            },
            Edit::StoreVariant {
                name: "kept".to_owned(),
            },
            setting_table::DELAY_UPPER.to(Some(0.02)),
        ] {
            after.apply(&edit).unwrap();
        }
        let words: Vec<String> = decision_differences(&before, &after)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(
            words,
            [
                "α of the gains: 1 → 0.1",
                "upper delay bound: by the quantile → 20 ms",
                "LON → Q: held → free",
                "condition 3: in the schedule → left out of the schedule",
                "nominal (condition 10): kept → rejected (step)",
            ]
        );
    }
}
