//! Data behind a condition's figures: its models with their roles, and the representative physics
//! model after each correction.
//!
//! A *bundle* contains a condition's physics models, or its identified models. Its *representative*
//! is the model with the smallest mean distance to the others (M5), unless the engineer has chosen
//! another: the physics representative is corrected, the identified one is the reference.

use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::schedule::Schedule;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Model, ModelId, Pair};
use gdcm_model::response::GainDelay;
use gdcm_model::units::s_to_ms;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{ConditionAnalysis, Study};

use super::bode_curve::BodeCurve;
pub use super::bode_curve::CurveId;
use super::bode_options::BodeOptions;
use super::caption_words::{condition_words, settings_words};
use super::role::Role;

/// Data from which a condition's figures are drawn.
#[derive(Clone, Copy, Debug)]
pub struct ConditionSource<'a> {
    /// The dataset with the engineer's decisions.
    pub study: &'a Study,
    /// The condition's result; without it, responses are shown but no corrected models.
    pub analysis: Option<&'a ConditionAnalysis>,
    pub schedule: Option<&'a Schedule>,
    /// Responses from the condition's models.
    pub curves: &'a Arc<ConditionCurves>,
    /// Name of an overlaid study variant, and its result in the condition.
    pub variant: Option<(&'a str, &'a ConditionAnalysis)>,
}

/// A drawn model from the condition.
#[derive(Clone, Debug)]
pub(super) struct SourceModel {
    pub(super) id: ModelId,
    /// Index in its bundle.
    pub(super) index: usize,
    pub(super) role: Role,
    pub(super) rejected: bool,
    /// Whether the engineer has hidden the model or its role.
    pub(super) hidden: bool,
}

/// The representative physics model after a correction, as drawn.
#[derive(Clone, Debug)]
pub(super) struct CorrectedModel<'a> {
    /// Identity, style and legend text; the points are computed later.
    pub(super) curve: BodeCurve,
    /// Result that contains the model's couplings: the condition's own, or an overlaid variant's.
    pub(super) result: &'a ConditionAnalysis,
    /// Index of the physics model in its bundle.
    pub(super) model: usize,
    pub(super) correction: GainDelay,
}

/// A correction of the representative physics model, with the curve that it has in figures.
struct CorrectedVersion<'c> {
    id: CurveId,
    role: Role,
    /// Text appended to the model's name in the label.
    name_suffix: &'static str,
    correction: &'c ChannelCorrection,
}

impl<'a> ConditionSource<'a> {
    pub(super) fn id(&self) -> ConditionId {
        self.curves.condition.id()
    }

    pub(super) fn dataset(&self) -> &'a Dataset {
        &self.study.dataset
    }

    /// Returns a response's unit, output unit over input unit: `(deg/s)/in`.
    pub fn ratio_unit(dataset: &Dataset, pair: Pair) -> String {
        let output = &dataset.outputs()[pair.output].unit;
        let input = &dataset.inputs()[pair.input].unit;
        format!("{}/{}", bracketed(output), bracketed(input))
    }

    /// Returns `Condition 10: 60 kt, low altitude, high weight`, or `Condition 10` without a name.
    pub(super) fn condition_words(&self) -> String {
        condition_words(self.curves.condition.flight_state())
    }

    /// Describes the dataset, the settings and the rejected models.
    pub(super) fn caption(&self) -> String {
        let mut caption = settings_words(self.dataset(), &self.study.settings);
        let rejected = self.study.rejected_names(self.id());
        if !rejected.is_empty() {
            caption.push_str(&format!(" Rejected: {}.", rejected.join(", ")));
        }
        caption
    }

    /// Returns the name of a bundle's representative; `None` before the bundle is compared.
    fn representative(&self, kind: BundleKind) -> Option<&'a str> {
        self.analysis
            .map(|analysis| analysis.representative_name(kind))
    }

    /// Returns the index of the identified model to which the other models are compared: the
    /// representative, or the first model before the bundle is compared.
    pub(super) fn reference_index(&self) -> usize {
        let name = self.representative(BundleKind::Identified);
        name.and_then(|name| self.curves.condition.position(BundleKind::Identified, name))
            .unwrap_or(0)
    }

    /// Returns a bundle's models in file order; if a model is isolated, only that model and the
    /// representative.
    pub(super) fn models(&self, kind: BundleKind, options: &BodeOptions) -> Vec<SourceModel> {
        let bundle = self.curves.condition.bundle(kind);
        let mut models = Vec::new();
        for (index, model) in bundle.iter().enumerate() {
            let id = ModelId::new(self.id(), kind, &model.name);
            if !self.is_suppressed(&id, options) {
                models.push(self.source_model(id, index, model, options));
            }
        }
        models
    }

    /// Returns whether a model is not shown because another model in its condition is isolated;
    /// representatives are always shown.
    fn is_suppressed(&self, id: &ModelId, options: &BodeOptions) -> bool {
        match &options.isolated {
            Some(isolated) if isolated.condition == id.condition => {
                isolated != id && self.representative(id.bundle) != Some(id.name.as_str())
            }
            _ => false,
        }
    }

    fn source_model(
        &self,
        id: ModelId,
        index: usize,
        model: &Model,
        options: &BodeOptions,
    ) -> SourceModel {
        let represents = self.representative(id.bundle) == Some(id.name.as_str());
        let role = Role::of_model(id.bundle, model.is_nominal(), represents);
        let rejected = self.study.is_rejected(&id);
        let hidden =
            options.hidden.contains(&role.shown(rejected)) || options.hidden_models.contains(&id);
        SourceModel {
            id,
            index,
            role,
            rejected,
            hidden,
        }
    }

    /// Creates a model's curve, without points.
    pub(super) fn curve_of(&self, model: SourceModel) -> BodeCurve {
        BodeCurve {
            label: model.id.name.clone(),
            detail: self.detail(&model.id, model.index),
            rejected: model.rejected,
            hidden: model.hidden,
            ..BodeCurve::new(CurveId::Model(model.id), model.role)
        }
    }

    /// Returns a model's detail line: `discontinuity ratio 3.68, suggested as an outlier · from run
    /// 3`. Each part is omitted if unknown.
    fn detail(&self, id: &ModelId, index: usize) -> String {
        let mut parts = Vec::new();
        if id.bundle == BundleKind::Physics
            && let Some(analysis) = self.analysis
            && let Some(ratio) = analysis.discontinuity_ratio(&id.name)
        {
            let verdict = if ratio > SUGGESTION_RATIO {
                ", suggested as an outlier"
            } else {
                ""
            };
            parts.push(format!("discontinuity ratio {ratio:.2}{verdict}"));
        }
        let model = &self.curves.condition.bundle(id.bundle)[index];
        if let Some(source) = &model.source {
            parts.push(source.origin_words());
        }
        parts.join(" · ")
    }

    /// Returns the representative physics model after each available correction: the condition's
    /// own, the scheduled, the own without leads, couplings alone, and that from an overlaid
    /// variant.
    pub(super) fn corrected_models(
        &self,
        pair: Pair,
        options: &BodeOptions,
    ) -> Vec<CorrectedModel<'a>> {
        let Some(analysis) = self.analysis else {
            return Vec::new();
        };
        let mut models = Vec::new();
        let own = CorrectedVersion {
            id: CurveId::Corrected,
            role: Role::Corrected,
            name_suffix: "corrected",
            correction: &analysis.correction,
        };
        models.extend(self.corrected_model(analysis, own, pair, options));
        if let Some(schedule) = self.schedule {
            let scheduled = CorrectedVersion {
                id: CurveId::Scheduled,
                role: Role::Scheduled,
                name_suffix: "scheduled",
                correction: &schedule.at_state(self.curves.condition.flight_state()),
            };
            models.extend(self.corrected_model(analysis, scheduled, pair, options));
        }
        if analysis.has_leads() {
            let without_leads = CorrectedVersion {
                id: CurveId::WithoutLeads,
                role: Role::WithoutLeads,
                name_suffix: "corrected without leads",
                correction: &analysis.correction.clone().without_leads(),
            };
            models.extend(self.corrected_model(analysis, without_leads, pair, options));
        }
        if analysis.coupled.is_some() {
            models.extend(self.coupled_model(analysis, pair, options));
        }
        if let Some((name, result)) = self.variant {
            models.extend(self.variant_model(name, result, pair, options));
        }
        models
    }

    /// Returns the representative physics model in `result` after one correction; `None` if the
    /// condition does not have that model, or if the correction does not apply to the response.
    fn corrected_model(
        &self,
        result: &'a ConditionAnalysis,
        version: CorrectedVersion<'_>,
        pair: Pair,
        options: &BodeOptions,
    ) -> Option<CorrectedModel<'a>> {
        let name = result.representative_name(BundleKind::Physics);
        let model = self.curves.condition.position(BundleKind::Physics, name)?;
        let gain = version.correction.net_gain(pair);
        let delay_ms = s_to_ms(version.correction.net_delay_s(pair));
        let curve = BodeCurve {
            label: format!("{name}, {}", version.name_suffix),
            detail: format!("net gain {gain:.3}, net delay {delay_ms:.1} ms"),
            hidden: options.hidden.contains(&version.role),
            ..BodeCurve::new(version.id, version.role)
        };
        Some(CorrectedModel {
            curve,
            result,
            model,
            correction: version.correction.on(pair)?,
        })
    }

    /// Returns the representative physics model with couplings alone; `None` as for
    /// [`Self::corrected_model`].
    fn coupled_model(
        &self,
        analysis: &'a ConditionAnalysis,
        pair: Pair,
        options: &BodeOptions,
    ) -> Option<CorrectedModel<'a>> {
        let version = CorrectedVersion {
            id: CurveId::Coupled,
            role: Role::Coupled,
            name_suffix: "couplings alone",
            correction: &analysis.correction,
        };
        let mut model = self.corrected_model(analysis, version, pair, options)?;
        model.correction = GainDelay::NONE;
        model.curve.detail.clear();
        Some(model)
    }

    /// Returns the representative physics model in the variant `name`; `None` as for
    /// [`Self::corrected_model`].
    fn variant_model(
        &self,
        name: &str,
        result: &'a ConditionAnalysis,
        pair: Pair,
        options: &BodeOptions,
    ) -> Option<CorrectedModel<'a>> {
        let version = CorrectedVersion {
            id: CurveId::Variant,
            role: Role::Variant,
            name_suffix: "corrected",
            correction: &result.correction,
        };
        let mut model = self.corrected_model(result, version, pair, options)?;
        // The label names the variant; the detail names its representative.
        model.curve.detail = format!("{}; {}", model.curve.label, model.curve.detail);
        model.curve.label = format!("variant {name}");
        Some(model)
    }
}

/// Returns a unit in brackets if it is a quotient: `(deg/s)`.
fn bracketed(unit: &str) -> String {
    if unit.contains('/') {
        format!("({unit})")
    } else {
        unit.to_owned()
    }
}
