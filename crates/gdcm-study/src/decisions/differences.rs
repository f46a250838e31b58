//! Differences between two states of a dataset, and the decisions carried over from one to the
//! other.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, ModelId, PairTable};

use super::adopted_models::AdoptedModels;
use super::choices::ConditionChoice;
use super::edit::Edit;
use super::requirement_settings::RequirementSettings;
use super::settings::{ResponseNames, Settings};
use super::signs::TurnedChannel;
use super::study::{Study, Variant};

/// One difference between a dataset and the dataset that a study was made with, or a decision that
/// does not apply to it.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The file has changed, and the study has no inventory of the file that it was saved with.
    AnotherFile {
        /// SHA-256 of the file when the study was saved.
        expected: String,
        /// SHA-256 of the present file.
        found: String,
    },
    ConditionAdded(ConditionId),
    ConditionRemoved(ConditionId),
    /// A condition has another airspeed.
    AirspeedChanged {
        condition: ConditionId,
        /// The airspeed before \[kt\].
        before_kt: f64,
        /// The airspeed now \[kt\].
        now_kt: f64,
    },
    /// A bundle has a new model.
    ModelAdded(ModelId),
    ModelRemoved(ModelId),
    /// A model has changed numbers, bands or trim.
    ModelChanged(ModelId),
    /// A decision no longer applies.
    NotApplied {
        /// Label of the decision: "reject nominal (condition 10)".
        decision: String,
        why: String,
    },
}

/// Every decision of a study by the names of channels, conditions and models, independent of the
/// dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Decisions {
    pub settings: Settings<ResponseNames>,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
    /// Models adopted instead of those of the file.
    pub taken: Vec<(ConditionId, Arc<AdoptedModels>)>,
    /// The channels with reversed sign.
    pub signs: Vec<TurnedChannel>,
    pub requirements: Arc<RequirementSettings>,
    /// The variants; a variant contains no variants of its own.
    pub variants: Vec<(String, Decisions)>,
}

impl Decisions {
    /// Collects the decisions of a study.
    pub fn of(study: &Study) -> Self {
        Self {
            settings: study.settings.named(&study.dataset),
            choices: study.choices.clone(),
            taken: study.taken.clone().into_iter().collect(),
            signs: study.turned_channels(),
            requirements: Arc::clone(&study.requirements),
            variants: study
                .variants
                .iter()
                .filter_map(|variant| {
                    Some((
                        variant.name.clone(),
                        Self::of(&study.of_variant(&variant.name)?),
                    ))
                })
                .collect(),
        }
    }

    /// Returns the study of `dataset` with every decision that applies to it, and a list of the
    /// other decisions.
    pub fn applied_to(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut study = Study::new(dataset);
        let mut differences = Vec::new();
        study.requirements = Arc::clone(&self.requirements);
        for decision in self.requirements.without_channel(&study.dataset) {
            let why = "it stays in the study for another dataset".to_owned();
            differences.push(Difference::NotApplied { decision, why });
        }
        study.settings = self
            .settings
            .with_responses(|verb, names| marked(verb, names, &study, &mut differences));
        for taken in &self.taken {
            carry_out(
                &Edit::TakeModels(vec![taken.clone()]),
                &mut study,
                &mut differences,
            );
        }
        for turned in &self.signs {
            match turned.find(&study.dataset) {
                Some(channel) => {
                    carry_out(
                        &Edit::SetSign {
                            channel,
                            of: Some(turned.of),
                        },
                        &mut study,
                        &mut differences,
                    );
                }
                None => differences.push(Difference::NotApplied {
                    decision: format!("turn {}", turned.channel),
                    why: "the dataset has no such channel".to_owned(),
                }),
            }
        }
        for (&condition, choice) in &self.choices {
            take_choice(&mut study, condition, choice, &mut differences);
        }
        for (name, decisions) in &self.variants {
            let (of_variant, mut not_applied) = decisions.applied_to(Arc::clone(&study.dataset));
            for difference in &mut not_applied {
                if let Difference::NotApplied { decision, .. } = difference {
                    decision.push_str(&format!(", of variant \"{name}\""));
                }
            }
            differences.extend(not_applied);
            let Study {
                settings, choices, ..
            } = of_variant;
            if study.variant(name).is_none() {
                study.variants.push(Arc::new(Variant {
                    name: name.clone(),
                    settings,
                    choices,
                }));
            }
        }
        (study, differences)
    }
}

/// Returns the listed responses as a table.
fn marked(
    verb: &str,
    listed: &ResponseNames,
    study: &Study,
    differences: &mut Vec<Difference>,
) -> PairTable<bool> {
    let mut table = study.settings.constrained.map(|_, _| false);
    for (output, input) in &listed.0 {
        match study.dataset.find_pair(output, input) {
            Some(pair) => table[pair] = true,
            None => differences.push(Difference::NotApplied {
                decision: format!("{verb} {input} → {output}"),
                why: "the dataset has no such response".to_owned(),
            }),
        }
    }
    table
}

/// Applies every choice as an edit, so that no choice comes in that an edit would refuse.
fn take_choice(
    study: &mut Study,
    condition: ConditionId,
    choice: &ConditionChoice,
    differences: &mut Vec<Difference>,
) {
    let mut edits = Vec::new();
    if !choice.scheduled {
        edits.push(Edit::SetScheduled {
            condition,
            scheduled: false,
        });
    }
    if choice.held_out {
        edits.push(Edit::SetHeldOut {
            condition,
            held_out: true,
        });
    }
    for kind in BundleKind::BOTH {
        let id = |name: &String| ModelId::new(condition, kind, name);
        let of_bundle = choice.bundle(kind);
        edits.extend(of_bundle.rejected.iter().map(|name| Edit::Reject(id(name))));
        let reasons = of_bundle
            .reasons
            .iter()
            .filter(|(name, _)| of_bundle.rejected.contains(*name));
        edits.extend(reasons.map(|(name, reason)| Edit::SetReason(id(name), reason.clone())));
        edits.extend(of_bundle.pinned.iter().map(|name| Edit::Pin(id(name))));
    }
    edits
        .iter()
        .for_each(|edit| carry_out(edit, study, differences));
}

fn carry_out(edit: &Edit, study: &mut Study, differences: &mut Vec<Difference>) {
    if let Err(refusal) = study.apply(edit) {
        differences.push(Difference::NotApplied {
            decision: edit.label(study),
            why: refusal.to_string(),
        });
    }
}

impl Study {
    /// Returns this study for another state of its dataset, with every decision that still applies,
    /// and all differences.
    pub fn reconciled(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut differences = Inventory::of(self.file_dataset()).differences(&dataset);
        let (study, not_applied) = Decisions::of(self).applied_to(dataset);
        differences.extend(not_applied);
        (study, differences)
    }
}

impl Inventory {
    /// Lists the differences of `dataset` from the dataset of this inventory.
    pub fn differences(&self, dataset: &Dataset) -> Vec<Difference> {
        let now = Inventory::of(dataset);
        let mut differences = Vec::new();
        let [before, now] = [self, &now].map(|of| -> BTreeMap<ConditionId, &ConditionInventory> {
            of.0.iter()
                .map(|condition| (condition.id, condition))
                .collect()
        });
        let ids: BTreeSet<ConditionId> = before.keys().chain(now.keys()).copied().collect();
        for id in ids {
            match (before.get(&id), now.get(&id)) {
                (Some(_), None) => differences.push(Difference::ConditionRemoved(id)),
                (None, Some(_)) => differences.push(Difference::ConditionAdded(id)),
                (Some(before), Some(now)) => {
                    let before_kt = before.airspeed_kt;
                    let now_kt = now.airspeed_kt;
                    if before_kt != now_kt {
                        differences.push(Difference::AirspeedChanged {
                            condition: id,
                            before_kt,
                            now_kt,
                        });
                    }
                    for kind in BundleKind::BOTH {
                        compare_bundles(
                            (id, kind),
                            before.bundle(kind),
                            now.bundle(kind),
                            &mut differences,
                        );
                    }
                }
                (None, None) => {}
            }
        }
        differences
    }
}

fn compare_bundles(
    (condition, kind): (ConditionId, BundleKind),
    before: &BTreeMap<String, String>,
    now: &BTreeMap<String, String>,
    differences: &mut Vec<Difference>,
) {
    let names: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
    for name in names {
        let id = ModelId::new(condition, kind, name);
        match (before.get(name), now.get(name)) {
            (Some(before), Some(now)) if before == now => {}
            (Some(_), Some(_)) => differences.push(Difference::ModelChanged(id)),
            (Some(_), None) => differences.push(Difference::ModelRemoved(id)),
            (None, _) => differences.push(Difference::ModelAdded(id)),
        }
    }
}

/// The models of one condition: name, and fingerprint of the numbers, the bands and the trim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConditionInventory {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub physics: BTreeMap<String, String>,
    pub identified: BTreeMap<String, String>,
}

impl ConditionInventory {
    fn of(condition: &Condition) -> Self {
        let models = |kind| {
            let models = condition.bundle(kind).iter();
            models
                .map(|model| (model.name.clone(), model.fingerprint()))
                .collect()
        };
        Self {
            id: condition.id(),
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics: models(BundleKind::Physics),
            identified: models(BundleKind::Identified),
        }
    }

    /// Returns the models of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BTreeMap<String, String> {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Content of a dataset, small enough for a study file: a study compares it with the present
/// dataset to report changes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inventory(pub Vec<ConditionInventory>);

impl Inventory {
    /// Takes the inventory of a dataset.
    pub fn of(dataset: &Dataset) -> Self {
        Self(
            dataset
                .conditions()
                .iter()
                .map(|condition| ConditionInventory::of(condition))
                .collect(),
        )
    }
}
