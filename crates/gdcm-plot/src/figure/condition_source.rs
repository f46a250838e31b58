//! What the figures of one condition are made of, and the words that say so.

use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::schedule::{Schedule, ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Model, ModelId, Pair};
use gdcm_model::response::GainDelay;
use gdcm_model::units::s_to_ms;
use gdcm_study::study::condition_responses::ConditionCurves;
use gdcm_study::study::settings::Settings;
use gdcm_study::study::{ConditionAnalysis, CouplingCorrection, PhaseCorrection, Study};

use super::axis::compact;
use super::bode::BodeOptions;
use super::responses::BodeCurve;
use super::role::Role;

/// What the figures of one condition are made of.
#[derive(Clone, Copy, Debug)]
pub struct ConditionSource<'a> {
    /// The dataset, and what was decided about it.
    pub study: &'a Study,
    /// The condition's result; before there is one, the responses can be shown all the same.
    pub analysis: Option<&'a ConditionAnalysis>,
    /// The schedule, where there is one.
    pub schedule: Option<&'a Schedule>,
    /// The responses of its models.
    pub curves: &'a Arc<ConditionCurves>,
    /// The result of a variant of the study, by the variant's name, that is laid over.
    pub variant: Option<(&'a str, &'a ConditionAnalysis)>,
}

/// What a curve stands for; unique within a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CurveId {
    /// One model as it is.
    Model(ModelId),
    /// The representative physics model with the condition's own correction.
    Corrected,
    /// The representative physics model with the scheduled correction.
    Scheduled,
    /// The representative physics model with the condition's own correction, its lead filters left out.
    WithoutLeads,
    /// The representative physics model with couplings alone.
    Coupled,
    /// The representative physics model of a variant of the study with the variant's own correction.
    Variant,
}

/// A model of the condition that is not left out of sight by another one alone.
#[derive(Clone, Debug)]
pub(super) struct SourceModel {
    pub(super) id: ModelId,
    /// Index in its bundle.
    pub(super) index: usize,
    pub(super) role: Role,
    pub(super) rejected: bool,
    /// Whether the engineer does not want to see it.
    pub(super) hidden: bool,
}

/// The representative physics model after a correction: a curve without numbers yet, and what it is made of.
#[derive(Clone, Debug)]
pub(super) struct CorrectedModel<'a> {
    pub(super) curve: BodeCurve,
    /// The result whose couplings it has.
    pub(super) result: &'a ConditionAnalysis,
    /// Index of the physics model.
    pub(super) model: usize,
    pub(super) correction: GainDelay,
}

impl<'a> ConditionSource<'a> {
    /// The condition.
    pub(super) fn id(&self) -> ConditionId {
        self.curves.condition.id()
    }

    pub(super) fn dataset(&self) -> &'a Dataset {
        &self.study.dataset
    }

    /// `(deg/s)/in`: the unit of the ratio of a response's output to its input.
    pub fn ratio_unit(dataset: &Dataset, pair: Pair) -> String {
        let output = &dataset.outputs()[pair.output].unit;
        let input = &dataset.inputs()[pair.input].unit;
        let bracketed = |unit: &str| {
            if unit.contains('/') {
                format!("({unit})")
            } else {
                unit.to_owned()
            }
        };
        format!("{}/{}", bracketed(output), bracketed(input))
    }

    /// `Condition 10: 60 kt, low altitude, high weight`.
    pub(super) fn condition_words(&self) -> String {
        condition_words(self.curves.condition.flight_state())
    }

    /// Dataset, condition, settings, and which models are rejected.
    pub(super) fn caption(&self) -> String {
        let mut caption = settings_words(self.dataset(), &self.study.settings);
        let rejected = self.study.rejected_names(self.id());
        if !rejected.is_empty() {
            caption.push_str(&format!(" Rejected: {}.", rejected.join(", ")));
        }
        caption
    }

    /// The representative of a bundle; none before the bundle was compared.
    fn representative(&self, kind: BundleKind) -> Option<&'a str> {
        self.analysis
            .map(|analysis| analysis.representative_name(kind))
    }

    /// Index of the identified model that the others are laid on and compared with; the first one where nothing was compared.
    pub(super) fn reference(&self) -> usize {
        let name = self.representative(BundleKind::Identified);
        name.and_then(|name| self.curves.condition.position(BundleKind::Identified, name))
            .unwrap_or(0)
    }

    /// The models of a bundle in file order; where one is isolated, that one and the representative.
    pub(super) fn models(&self, kind: BundleKind, options: &BodeOptions) -> Vec<SourceModel> {
        let condition = &self.curves.condition;
        let representative = self.representative(kind);
        let isolated = options
            .isolated
            .as_ref()
            .filter(|id| id.condition == condition.id());
        let is_visible = |name: &str| {
            isolated.is_none_or(|id| {
                (id.bundle == kind && id.name == name) || representative == Some(name)
            })
        };
        let of_model = |(index, model): (usize, &Model)| {
            let id = ModelId::new(condition.id(), kind, &model.name);
            let role = Role::of_model(
                kind,
                model.is_nominal(),
                representative == Some(&model.name),
            );
            let rejected = self.study.is_rejected(&id);
            let hidden = options.hidden.contains(&role.shown(rejected))
                || options.hidden_models.contains(&id);
            SourceModel {
                id,
                index,
                role,
                rejected,
                hidden,
            }
        };
        condition
            .bundle(kind)
            .iter()
            .enumerate()
            .filter(|(_, model)| is_visible(&model.name))
            .map(of_model)
            .collect()
    }

    /// The curve of a model, without numbers yet.
    pub(super) fn curve_of(&self, model: SourceModel) -> BodeCurve {
        let SourceModel {
            id,
            index,
            role,
            rejected,
            hidden,
        } = model;
        let detail = self.detail(&id, index);
        let label = id.name.clone();
        BodeCurve {
            label,
            detail,
            rejected,
            hidden,
            ..BodeCurve::new(CurveId::Model(id), role)
        }
    }

    /// "ratio 3.68, suggested as an outlier · from run 3".
    fn detail(&self, id: &ModelId, index: usize) -> String {
        let analysis = self.analysis.filter(|_| id.bundle == BundleKind::Physics);
        let ratio = analysis
            .and_then(|analysis| analysis.discontinuity_ratio(&id.name))
            .map(|ratio| {
                let verdict = if ratio > SUGGESTION_RATIO {
                    ", suggested as an outlier"
                } else {
                    ""
                };
                format!("ratio {ratio:.2}{verdict}")
            });
        let source = self.curves.condition.bundle(id.bundle)[index]
            .source
            .as_ref();
        let source = source.map(|source| format!("from {}", source.words()));
        ratio
            .into_iter()
            .chain(source)
            .collect::<Vec<_>>()
            .join(" · ")
    }

    /// The representative physics model with the condition's own correction, with that of the schedule, where there are leads
    /// without them, and where a variant is laid over with its.
    pub(super) fn corrected_models(
        &self,
        pair: Pair,
        options: &BodeOptions,
    ) -> Vec<CorrectedModel<'a>> {
        let Some(analysis) = self.analysis else {
            return Vec::new();
        };
        let of = |result: &'a ConditionAnalysis,
                  (id, role): (CurveId, Role),
                  words: &str,
                  correction: &ChannelCorrection| {
            let name = result.representative_name(BundleKind::Physics);
            let model = self.curves.condition.position(BundleKind::Physics, name)?;
            let gain = correction.net_gain(pair);
            let delay_ms = s_to_ms(correction.net_delay_s(pair));
            let detail = format!("net gain {gain:.3}, net delay {delay_ms:.1} ms");
            let label = format!("{name}, {words}");
            let hidden = options.hidden.contains(&role);
            let curve = BodeCurve {
                label,
                detail,
                hidden,
                ..BodeCurve::new(id, role)
            };
            Some(CorrectedModel {
                curve,
                result,
                model,
                correction: correction.on(pair)?,
            })
        };
        let corrected =
            |id, role, words: &str, correction: &_| of(analysis, (id, role), words, correction);
        let variant = self.variant.and_then(|(name, result)| {
            let mut model = of(
                result,
                (CurveId::Variant, Role::Variant),
                "corrected",
                &result.correction,
            )?;
            // The chip says whose decisions these are; which model represents stands in its detail.
            model.curve.detail = format!("{}; {}", model.curve.label, model.curve.detail);
            model.curve.label = format!("variant {name}");
            Some(model)
        });
        let own = corrected(
            CurveId::Corrected,
            Role::Corrected,
            "corrected",
            &analysis.correction,
        );
        let scheduled = self.schedule.and_then(|schedule| {
            let correction = schedule.at_state(self.curves.condition.flight_state());
            corrected(
                CurveId::Scheduled,
                Role::Scheduled,
                "scheduled",
                &correction,
            )
        });
        let without = analysis.compensated.as_ref().and_then(|_| {
            let correction = analysis.correction.clone().without_leads();
            corrected(
                CurveId::WithoutLeads,
                Role::WithoutLeads,
                "corrected without leads",
                &correction,
            )
        });
        let coupled = analysis.coupled.as_ref().and_then(|_| {
            let mut model = corrected(
                CurveId::Coupled,
                Role::Coupled,
                "couplings alone",
                &analysis.correction,
            )?;
            (model.correction, model.curve.detail) = (GainDelay::NONE, String::new());
            Some(model)
        });
        own.into_iter()
            .chain(scheduled)
            .chain(without)
            .chain(coupled)
            .chain(variant)
            .collect()
    }
}

/// `Condition 10: 60 kt, low altitude, high weight`.
pub fn condition_words(FlightState { id, name, .. }: &FlightState) -> String {
    if name.is_empty() {
        format!("Condition {id}")
    } else {
        format!("Condition {id}: {name}")
    }
}

/// The dataset, and the settings that every figure of the analysis rests on.
pub(super) fn settings_words(dataset: &Dataset, settings: &Settings) -> String {
    let low = compact(settings.band.min());
    let high = compact(settings.band.max());
    let phase = match settings.phase {
        PhaseCorrection::Delay => "",
        PhaseCorrection::None => " No correction of the phase.",
        PhaseCorrection::Lead => " A delay or a lead filter in each channel.",
    };
    let couplings = match settings.couplings {
        CouplingCorrection::None => "",
        CouplingCorrection::Mixing => " The physics models with a mixing of the inputs.",
        CouplingCorrection::MixingAndFeedback => " The physics models with mixing and feedback.",
    };
    format!(
        "{}. Band {low} to {high} rad/s, {} frequencies; \u{3b1} {} for gains, {} for delays.{phase}{couplings}",
        dataset.name(),
        settings.points,
        compact(settings.alpha_gain),
        compact(settings.alpha_delay)
    )
}

/// `ln k`, or `k`.
pub fn quantity_symbol(quantity: ScheduledQuantity) -> &'static str {
    match quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    }
}

/// "polynomial of degree 2 of ln k".
pub fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    };
    let quantity = quantity_symbol(settings.quantity);
    let second = settings.second.map_or_else(String::new, |variable| {
        format!(", with {variable} in the middle of its range")
    });
    format!("{kind} of {quantity}{second}")
}
