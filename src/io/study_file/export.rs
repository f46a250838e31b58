//! From a study to what its file says.

use crate::correction::GainObjective;
use crate::dataset::{BundleKind, ConditionId, Dataset, Model, PairTable};
use crate::fidelity::CostAverage;
use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::study::{BundleChoice, ConditionInventory, Inventory, Settings, Study};

use super::schema::{
    AverageText, BundleText, ConditionInventoryText, ConditionText, DatasetReference, FORMAT, KindText, ObjectiveText,
    QuantityText, ScheduleText, SettingsText, StudyText,
};

/// The text of a study of the referenced dataset.
pub(super) fn text_of(study: &Study, dataset: DatasetReference) -> StudyText {
    let conditions = study.dataset.conditions().iter().map(|condition| {
        let choice = study.choice(condition.id());
        ConditionText {
            id: condition.id().0,
            physics: bundle_text(condition.bundle(BundleKind::Physics), &choice.physics),
            identified: bundle_text(condition.bundle(BundleKind::Identified), &choice.identified),
            scheduled: choice.scheduled,
        }
    });
    StudyText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
        dataset,
        settings: settings_text(&study.settings, &study.dataset),
        conditions: conditions.collect(),
    }
}

/// What a dataset holds, as a study's file says it.
pub(super) fn inventory_text(inventory: &Inventory) -> Vec<ConditionInventoryText> {
    let of = |(id, condition): (&ConditionId, &ConditionInventory)| ConditionInventoryText {
        id: id.0,
        airspeed_kt: condition.airspeed_kt,
        physics: condition.physics.clone(),
        identified: condition.identified.clone(),
    };
    inventory.conditions.iter().map(of).collect()
}

fn bundle_text(models: &[Model], choice: &BundleChoice) -> BundleText {
    let names = models.iter().map(|model| &model.name).filter(|name| choice.rejected.contains(*name));
    BundleText { rejected: names.cloned().collect(), pinned: choice.pinned.clone() }
}

fn settings_text(settings: &Settings, dataset: &Dataset) -> SettingsText {
    let ignored = settings.fitted.map(|_, fitted| !fitted);
    SettingsText {
        band_rad_s: [settings.band.min(), settings.band.max()],
        points: settings.points,
        cost_average: match settings.cost_average {
            CostAverage::Median => AverageText::Median,
            CostAverage::Mean => AverageText::Mean,
        },
        alpha_gain: settings.alpha_gain,
        alpha_delay: settings.alpha_delay,
        gain_objective: match settings.gain_objective {
            GainObjective::Ratio => ObjectiveText::Ratio,
            GainObjective::Decibel => ObjectiveText::Decibel,
        },
        constrained: pair_names(&settings.constrained, dataset),
        ignored: pair_names(&ignored, dataset),
        quantile: settings.quantile,
        gain_bounds: settings.gain_bounds.map(|bounds| [bounds.lower, bounds.upper]),
        delay_upper_s: settings.delay_upper_s,
        schedule: schedule_text(settings.schedule),
    }
}

fn pair_names(table: &PairTable<bool>, dataset: &Dataset) -> Vec<(String, String)> {
    table.marked().map(|pair| dataset.channel_names(pair)).collect()
}

fn schedule_text(settings: ScheduleSettings) -> ScheduleText {
    let (kind, degree) = match settings.kind {
        ScheduleKind::Polynomial { degree } => (KindText::Polynomial, Some(degree)),
        ScheduleKind::Table => (KindText::Table, None),
    };
    let of = match settings.quantity {
        ScheduledQuantity::LnGain => QuantityText::LnGain,
        ScheduledQuantity::Gain => QuantityText::Gain,
    };
    ScheduleText { kind, degree, of, delays: settings.delays, airspeed_tolerance_kt: settings.airspeed_tolerance_kt }
}
