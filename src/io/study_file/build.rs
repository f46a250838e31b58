//! From what a study file says to the decisions it holds, each error with its place.

use std::collections::BTreeMap;

use crate::correction::{GainBounds, GainObjective};
use crate::dataset::Place;
use crate::dataset::{Band, ConditionId};
use crate::fidelity::CostAverage;
use crate::io::content_fault::ContentFault;
use crate::io::flaw::Flaw;
use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::study::{BundleChoice, ConditionChoice, ConditionInventory, Decisions, Inventory, Setting, Settings};

use super::schema::{
    AverageText, BundleText, ConditionInventoryText, ConditionText, KindText, ObjectiveText, QuantityText,
    ScheduleText, SettingsText,
};

/// The decisions of a study file. `start` is what the settings are before any decision; each has to be within its range.
pub(super) fn decisions_of(
    start: Settings,
    text: &SettingsText,
    conditions: Vec<ConditionText>,
) -> Result<Decisions, Flaw> {
    let mut settings = start;
    take_settings(&mut settings, text)?;
    let mut choices = BTreeMap::new();
    for (index, condition) in conditions.into_iter().enumerate() {
        let id = condition.id;
        let choice = ConditionChoice {
            physics: bundle_choice(condition.physics),
            identified: bundle_choice(condition.identified),
            scheduled: condition.scheduled,
        };
        if choices.insert(ConditionId(id), choice).is_some() {
            return Err(Flaw::new(Place::condition(index + 1, id), ContentFault::DuplicateCondition { id }));
        }
    }
    Ok(Decisions { settings, constrained: text.constrained.clone(), ignored: text.ignored.clone(), choices })
}

fn bundle_choice(text: BundleText) -> BundleChoice {
    BundleChoice { rejected: text.rejected.into_iter().collect(), pinned: text.pinned }
}

/// What the study's dataset held when the study was saved.
pub(super) fn inventory_of(conditions: Vec<ConditionInventoryText>) -> Inventory {
    let of = |text: ConditionInventoryText| {
        let ConditionInventoryText { id, airspeed_kt, physics, identified } = text;
        (ConditionId(id), ConditionInventory { airspeed_kt, physics, identified })
    };
    Inventory { conditions: conditions.into_iter().map(of).collect() }
}

fn take_settings(settings: &mut Settings, text: &SettingsText) -> Result<(), Flaw> {
    let [min, max] = text.band_rad_s;
    let band = Band::new(min, max).map_err(|error| Flaw::new(Place::entry("settings, band_rad_s"), error))?;
    let average = match text.cost_average {
        AverageText::Median => CostAverage::Median,
        AverageText::Mean => CostAverage::Mean,
    };
    let objective = match text.gain_objective {
        ObjectiveText::Ratio => GainObjective::Ratio,
        ObjectiveText::Decibel => GainObjective::Decibel,
    };
    let bounds = text.gain_bounds.map(|[lower, upper]| GainBounds { lower, upper });
    let decided = [
        ("band_rad_s", Setting::Band(band)),
        ("points", Setting::Points(text.points)),
        ("cost_average", Setting::CostAverage(average)),
        ("alpha_gain", Setting::AlphaGain(text.alpha_gain)),
        ("alpha_delay", Setting::AlphaDelay(text.alpha_delay)),
        ("gain_objective", Setting::GainObjective(objective)),
        ("quantile", Setting::Quantile(text.quantile)),
        ("gain_bounds", Setting::GainBounds(bounds)),
        ("delay_upper_s", Setting::DelayUpper(text.delay_upper_s)),
        ("schedule", Setting::Schedule(schedule_of(&text.schedule)?)),
    ];
    for (key, setting) in decided {
        let place = Place::entry(format!("settings, {key}"));
        settings.apply(&setting).map_err(|refusal| Flaw::new(place, refusal))?;
    }
    Ok(())
}

fn schedule_of(text: &ScheduleText) -> Result<ScheduleSettings, Flaw> {
    let kind = match (text.kind, text.degree) {
        (KindText::Table, _) => ScheduleKind::Table,
        (KindText::Polynomial, Some(degree)) => ScheduleKind::Polynomial { degree },
        (KindText::Polynomial, None) => {
            let fault = ContentFault::MissingKey { key: "degree".to_owned() };
            return Err(Flaw::new(Place::entry("settings, schedule"), fault));
        }
    };
    let quantity = match text.of {
        QuantityText::LnGain => ScheduledQuantity::LnGain,
        QuantityText::Gain => ScheduledQuantity::Gain,
    };
    Ok(ScheduleSettings { kind, quantity, delays: text.delays, airspeed_tolerance_kt: text.airspeed_tolerance_kt })
}
