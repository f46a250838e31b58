//! Sources of the figures of one condition, and the words that describe them.

use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::schedule::{Schedule, ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Model, ModelId, Pair};
use gdcm_model::number_format::compact;
use gdcm_model::response::GainDelay;
use gdcm_model::units::s_to_ms;
use gdcm_study::decisions::settings::Settings;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{ConditionAnalysis, CouplingCorrection, PhaseCorrection, Study};

use super::bode::BodeOptions;
use super::responses::BodeCurve;
use super::role::Role;

/// Sources of the figures of one condition.
#[derive(Clone, Copy, Debug)]
pub struct ConditionSource<'a> {
    /// The dataset with its decisions.
    pub study: &'a Study,
    /// Result of the condition; without it, the responses can still be shown.
    pub analysis: Option<&'a ConditionAnalysis>,
    pub schedule: Option<&'a Schedule>,
    /// Responses of the models of the condition.
    pub curves: &'a Arc<ConditionCurves>,
    /// Name and result of an overlaid variant of the study.
    pub variant: Option<(&'a str, &'a ConditionAnalysis)>,
}

/// Identity of a curve; unique within a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CurveId {
    Model(ModelId),
    /// Representative physics model with the condition's own correction.
    Corrected,
    /// Representative physics model with the scheduled correction.
    Scheduled,
    /// Representative physics model with the condition's own correction, without its lead filters.
    WithoutLeads,
    /// Representative physics model with couplings alone.
    Coupled,
    /// Representative physics model of a variant of the study with the variant's own correction.
    Variant,
}

/// A model of the condition that is not suppressed by an isolated one.
#[derive(Clone, Debug)]
pub(super) struct SourceModel {
    pub(super) id: ModelId,
    /// Index in its bundle.
    pub(super) index: usize,
    pub(super) role: Role,
    pub(super) rejected: bool,
    /// Whether the engineer hides it.
    pub(super) hidden: bool,
}

/// The representative physics model after a correction: a curve still without numbers, and its
/// source.
#[derive(Clone, Debug)]
pub(super) struct CorrectedModel<'a> {
    pub(super) curve: BodeCurve,
    /// Result that holds its couplings.
    pub(super) result: &'a ConditionAnalysis,
    /// Index of the physics model.
    pub(super) model: usize,
    pub(super) correction: GainDelay,
}

impl<'a> ConditionSource<'a> {
    /// Returns the id of the condition.
    pub(super) fn id(&self) -> ConditionId {
        self.curves.condition.id()
    }

    pub(super) fn dataset(&self) -> &'a Dataset {
        &self.study.dataset
    }

    /// Returns the unit of a response, output over input: `(deg/s)/in`.
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

    /// Describes the dataset, the condition, the settings and the rejected models.
    pub(super) fn caption(&self) -> String {
        let mut caption = settings_words(self.dataset(), &self.study.settings);
        let rejected = self.study.rejected_names(self.id());
        if !rejected.is_empty() {
            caption.push_str(&format!(" Rejected: {}.", rejected.join(", ")));
        }
        caption
    }

    /// Returns the representative of a bundle; `None` before the bundle is compared.
    fn representative(&self, kind: BundleKind) -> Option<&'a str> {
        self.analysis
            .map(|analysis| analysis.representative_name(kind))
    }

    /// Returns the index of the identified model that the others are aligned and compared with; the
    /// first if nothing was compared.
    pub(super) fn reference(&self) -> usize {
        let name = self.representative(BundleKind::Identified);
        name.and_then(|name| self.curves.condition.position(BundleKind::Identified, name))
            .unwrap_or(0)
    }

    /// Returns the models of a bundle in file order; if a model is isolated, only that model and
    /// the representative.
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

    /// Creates the curve of a model, still without numbers.
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

    /// Returns the detail of a model: "ratio 3.68, suggested as an outlier · from run 3".
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

    /// Returns the corrected versions of the representative physics model: with the condition's own
    /// correction, with the scheduled one, without leads if there are leads, and with an overlaid
    /// variant's correction.
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
            // The chip names the decisions; the representative model is named in its detail.
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

/// Describes the dataset and the settings behind every figure of the analysis.
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

/// Returns `ln k` or `k`.
pub fn quantity_symbol(quantity: ScheduledQuantity) -> &'static str {
    match quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    }
}

/// Describes the schedule: "polynomial of degree 2 of ln k".
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
