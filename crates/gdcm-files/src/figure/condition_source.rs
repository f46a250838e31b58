//! What the figures of one condition are made of, and the words that say so.

use std::sync::Arc;

use gdcm_core::dataset::{BundleKind, ConditionId, Dataset, FlightState, Model, ModelId, Pair};
use gdcm_core::response::{GainDelay, ResponseShape};
use gdcm_core::schedule::{Schedule, ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_core::study::{ConditionAnalysis, ConditionCurves, PhaseCorrection, Settings, Study};

use super::bode::BodeOptions;
use super::role::Role;
use super::ticks::compact;

/// What the figures of one condition are made of.
#[derive(Clone, Copy, Debug)]
pub struct ConditionSource<'a> {
    /// The dataset, and what was decided about it.
    pub study: &'a Study,
    /// The condition's result.
    pub analysis: &'a ConditionAnalysis,
    /// The schedule, where there is one.
    pub schedule: Option<&'a Schedule>,
    /// The responses of its models.
    pub curves: &'a ConditionCurves,
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
}

/// A model of the condition.
#[derive(Clone, Debug)]
pub(super) struct SourceModel {
    pub(super) id: ModelId,
    /// Index in its bundle.
    pub(super) index: usize,
    pub(super) role: Role,
    pub(super) rejected: bool,
}

/// One line of a response's plot.
#[derive(Clone, Debug)]
pub(super) struct ResponseLine {
    pub(super) id: CurveId,
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) rejected: bool,
    pub(super) shape: ResponseShape,
}

/// The representative physics model after a correction.
#[derive(Clone, Debug)]
pub(super) struct CorrectedModel {
    pub(super) id: CurveId,
    pub(super) name: String,
    pub(super) role: Role,
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
    pub(super) fn ratio_unit(&self, pair: Pair) -> String {
        let (output, input) = (&self.dataset().outputs()[pair.output].unit, &self.dataset().inputs()[pair.input].unit);
        let bracketed = |unit: &str| if unit.contains('/') { format!("({unit})") } else { unit.to_owned() };
        format!("{}/{}", bracketed(output), bracketed(input))
    }

    /// `Condition 10: 60 kt, low altitude, high weight`.
    pub(super) fn condition_words(&self) -> String {
        let FlightState { id, name, .. } = self.curves.condition.flight_state();
        if name.is_empty() { format!("Condition {id}") } else { format!("Condition {id}: {name}") }
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

    /// Index of the identified model that the others are laid on and compared with.
    pub(super) fn reference(&self) -> usize {
        let name = self.analysis.representative_name(BundleKind::Identified);
        self.curves.condition.position(BundleKind::Identified, name).unwrap_or(0)
    }

    /// Every model of a bundle, in file order.
    pub(super) fn models(&self, kind: BundleKind) -> Vec<SourceModel> {
        let condition = &self.curves.condition;
        let representative = self.analysis.representative_name(kind);
        let of_model = |(index, model): (usize, &Model)| {
            let id = ModelId::new(condition.id(), kind, &model.name);
            let role = Role::of_model(kind, model.is_nominal(), representative == model.name);
            SourceModel { index, role, rejected: self.study.is_rejected(&id), id }
        };
        condition.bundle(kind).iter().enumerate().map(of_model).collect()
    }

    /// The representative physics model with the condition's own correction, with that of the schedule, and where there are leads
    /// without them.
    pub(super) fn corrected_models(&self, pair: Pair) -> Vec<CorrectedModel> {
        let name = self.analysis.representative_name(BundleKind::Physics);
        let Some(model) = self.curves.condition.position(BundleKind::Physics, name) else {
            return Vec::new();
        };
        let own = self.analysis.correction.on(pair).map(|correction| (CurveId::Corrected, Role::Corrected, correction));
        let scheduled =
            self.schedule.and_then(|schedule| schedule.at_state(self.curves.condition.flight_state()).on(pair));
        let scheduled = scheduled.map(|correction| (CurveId::Scheduled, Role::Scheduled, correction));
        let without = self.analysis.compensated.as_ref().and_then(|_| self.analysis.correction.without_leads_on(pair));
        let without = without.map(|correction| (CurveId::WithoutLeads, Role::WithoutLeads, correction));
        own.into_iter()
            .chain(scheduled)
            .chain(without)
            .map(|(id, role, correction)| CorrectedModel {
                id,
                name: format!("{name}, {}", role.name()),
                role,
                model,
                correction,
            })
            .collect()
    }

    /// The lines of a response's plot that are shown, what matters most last; phases are laid on that of the reference.
    pub(super) fn lines(&self, pair: Pair, options: &BodeOptions) -> Vec<ResponseLine> {
        let shape = |kind, index: usize| ResponseShape::of(&self.curves.bundle(kind)[index].curve(pair));
        let reference = shape(BundleKind::Identified, self.reference());
        let models = BundleKind::BOTH.into_iter().flat_map(|kind| self.models(kind));
        let shown = models.filter(|model| options.shows_model(model));
        let mut lines: Vec<ResponseLine> = shown
            .map(|SourceModel { id, index, role, rejected }| {
                let shape = shape(id.bundle, index).phase_aligned(&reference);
                let name = id.name.clone();
                ResponseLine { id: CurveId::Model(id), name, role, rejected, shape }
            })
            .collect();
        let omega = self.curves.grid.omega();
        for CorrectedModel { id, name, role, model, correction } in self.corrected_models(pair) {
            let shape = shape(BundleKind::Physics, model).phase_aligned(&reference).corrected(omega, correction);
            lines.push(ResponseLine { id, name, role, rejected: false, shape });
        }
        for line in &mut lines {
            line.shape.phase_deg = options.turned(self.id(), pair, &line.id, &line.shape.phase_deg);
        }
        lines.retain(|line| !options.hidden.contains(&line.role.shown(line.rejected)));
        lines.sort_by_key(|line| line.role.layer(line.rejected));
        lines
    }

    /// Frequencies of the curves \[rad/s\].
    pub(super) fn omega(&self) -> Arc<[f64]> {
        self.curves.grid.omega().into()
    }
}

/// The dataset, and the settings that every figure of the analysis rests on.
pub(super) fn settings_words(dataset: &Dataset, settings: &Settings) -> String {
    let (low, high) = (compact(settings.band.min()), compact(settings.band.max()));
    let phase = match settings.phase {
        PhaseCorrection::Delay => "",
        PhaseCorrection::None => " No correction of the phase.",
        PhaseCorrection::Lead => " A delay or a lead filter in each channel.",
    };
    format!(
        "{}. Band {low} to {high} rad/s, {} frequencies; \u{3b1} {} for gains, {} for delays.{phase}",
        dataset.name(),
        settings.points,
        compact(settings.alpha_gain),
        compact(settings.alpha_delay)
    )
}

/// `degree 2 in ln k`.
pub(super) fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    };
    let quantity = match settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let second =
        settings.second.map_or_else(String::new, |variable| format!(", with {variable} in the middle of its range"));
    format!("{kind} of {quantity}{second}")
}
