//! Decisions with channels, conditions and models by name, so that they can be carried over from
//! one dataset to another.
//!
//! *Adopted* models come from an identification and replace those in the file; a *reversed* channel
//! has the opposite sign. *Requirements* are the settings for the qualification checks.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, ModelId, PairTable};

use super::adopted_models::AdoptedModels;
use super::choices::{BundleChoice, ConditionChoice};
use super::dataset_differences::{CarriedDecision, Difference, Inventory, NotApplied};
use super::edit::Edit;
use super::export_choices::ExportChoices;
use super::requirement_settings::RequirementSettings;
use super::settings::{ResponseMark, ResponseNames, Settings};
use super::signs::ReversedChannel;
use super::study::{Study, Variant};

/// A study's decisions, with channels, conditions and models by name: independent of the dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Decisions {
    pub settings: Settings<ResponseNames>,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
    /// Models adopted instead of those in the file.
    pub adopted: Vec<(ConditionId, Arc<AdoptedModels>)>,
    /// The channels with reversed sign.
    pub signs: Vec<ReversedChannel>,
    pub requirements: Arc<RequirementSettings>,
    /// Choices in the last export.
    pub exports: Arc<ExportChoices>,
    /// The variants, which contain no variants themselves.
    pub variants: Vec<(String, Decisions)>,
}

impl Decisions {
    /// Collects a study's decisions, with channels, conditions and models by name.
    pub fn from_study(study: &Study) -> Self {
        let mut variants = Vec::new();
        for variant in &study.variants {
            if let Some(study) = study.of_variant(&variant.name) {
                variants.push((variant.name.clone(), Self::from_study(&study)));
            }
        }
        Self {
            settings: study.settings.named(&study.dataset),
            choices: study.choices.clone(),
            adopted: study.adopted.clone().into_iter().collect(),
            signs: study.reversed_channels(),
            requirements: Arc::clone(&study.requirements),
            exports: Arc::clone(&study.exports),
            variants,
        }
    }

    /// Returns a study of `dataset` with every decision that applies to it, and those that do not
    /// apply.
    ///
    /// Each decision is applied after those that it refers to: settings and requirements; adopted
    /// models and signs, which change the dataset; choices, which name its models; variants.
    pub fn applied_to(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut carried = CarriedDecisions {
            study: Study::new(dataset),
            not_applied: Vec::new(),
        };
        carried.study.exports = Arc::clone(&self.exports);
        carried.apply_requirements(&self.requirements);
        carried.apply_settings(&self.settings);
        for adopted in &self.adopted {
            carried.apply_edit(&Edit::AdoptModels(vec![adopted.clone()]));
        }
        for reversed in &self.signs {
            carried.apply_sign(reversed);
        }
        for (condition, choice) in &self.choices {
            carried.apply_choice(*condition, choice);
        }
        for (name, decisions) in &self.variants {
            carried.apply_variant(name, decisions);
        }
        (carried.study, carried.not_applied)
    }
}

/// A study to which decisions about another dataset are applied.
struct CarriedDecisions {
    study: Study,
    /// The decisions that do not apply.
    not_applied: Vec<Difference>,
}

impl CarriedDecisions {
    fn refuse(&mut self, decision: CarriedDecision, why: NotApplied) {
        self.not_applied.push(Difference::NotApplied {
            decision,
            variant: None,
            why,
        });
    }

    /// Applies an edit, or adds it to `not_applied` with the reason for its refusal.
    fn apply_edit(&mut self, edit: &Edit) {
        if let Err(refusal) = self.study.apply(edit) {
            let decision = CarriedDecision::Edit {
                edit: edit.clone(),
                dataset: Arc::clone(&self.study.dataset),
            };
            self.refuse(decision, NotApplied::Refused(refusal));
        }
    }

    /// Takes over the requirement settings. Settings for channels that the dataset lacks are kept,
    /// and added to `not_applied`.
    fn apply_requirements(&mut self, requirements: &Arc<RequirementSettings>) {
        self.study.requirements = Arc::clone(requirements);
        for decision in requirements.without_channel(&self.study.dataset) {
            let decision = CarriedDecision::Requirement(decision);
            self.refuse(decision, NotApplied::KeptForAnotherDataset);
        }
    }

    fn apply_settings(&mut self, settings: &Settings<ResponseNames>) {
        self.study.settings = settings.with_responses(|mark, names| self.marked(mark, names));
    }

    /// Returns the listed responses as a table; adds those that the dataset lacks to `not_applied`.
    fn marked(&mut self, mark: ResponseMark, names: &ResponseNames) -> PairTable<bool> {
        let mut table = self.study.settings.constrained.map(|_, _| false);
        for (output, input) in &names.0 {
            match self.study.dataset.find_pair(output, input) {
                Some(pair) => table[pair] = true,
                None => {
                    let decision = CarriedDecision::Response {
                        mark,
                        output: output.clone(),
                        input: input.clone(),
                    };
                    self.refuse(decision, NotApplied::NoResponse);
                }
            }
        }
        table
    }

    fn apply_sign(&mut self, reversed: &ReversedChannel) {
        match reversed.find(&self.study.dataset) {
            Some(channel) => self.apply_edit(&Edit::SetSign {
                channel,
                role: Some(reversed.role),
            }),
            None => {
                let channel = reversed.channel.clone();
                self.refuse(CarriedDecision::Sign { channel }, NotApplied::NoChannel);
            }
        }
    }

    /// Applies every choice that departs from the default (scheduled, not held out, no model
    /// rejected or pinned) as an edit, so that invalid choices are refused.
    fn apply_choice(&mut self, condition: ConditionId, choice: &ConditionChoice) {
        if !choice.scheduled {
            self.apply_edit(&Edit::SetScheduled {
                condition,
                scheduled: false,
            });
        }
        if choice.held_out {
            self.apply_edit(&Edit::SetHeldOut {
                condition,
                held_out: true,
            });
        }
        for kind in BundleKind::BOTH {
            self.apply_bundle_choice(condition, kind, choice.bundle(kind));
        }
    }

    fn apply_bundle_choice(
        &mut self,
        condition: ConditionId,
        kind: BundleKind,
        choice: &BundleChoice,
    ) {
        for name in &choice.rejected {
            self.apply_edit(&Edit::Reject(ModelId::new(condition, kind, name)));
        }
        for (name, reason) in &choice.reasons {
            if choice.rejected.contains(name) {
                let model = ModelId::new(condition, kind, name);
                self.apply_edit(&Edit::SetReason(model, reason.clone()));
            }
        }
        if let Some(name) = &choice.pinned {
            self.apply_edit(&Edit::Pin(ModelId::new(condition, kind, name)));
        }
    }

    /// Adds a variant with the decisions that apply to the dataset; an existing variant of this
    /// name is kept instead.
    fn apply_variant(&mut self, name: &str, decisions: &Decisions) {
        let (variant, mut not_applied) = decisions.applied_to(Arc::clone(&self.study.dataset));
        for difference in &mut not_applied {
            if let Difference::NotApplied { variant, .. } = difference {
                *variant = Some(name.to_owned());
            }
        }
        self.not_applied.extend(not_applied);
        if self.study.variant(name).is_none() {
            self.study.variants.push(Arc::new(Variant {
                name: name.to_owned(),
                settings: variant.settings,
                choices: variant.choices,
            }));
        }
    }
}

impl Study {
    /// Returns this study for a changed version of its dataset, with every decision that still
    /// applies, and all differences.
    pub fn reconciled(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut differences = Inventory::from_dataset(self.file_dataset()).differences(&dataset);
        let (study, not_applied) = Decisions::from_study(self).applied_to(dataset);
        differences.extend(not_applied);
        (study, differences)
    }
}
