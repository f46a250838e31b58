//! From what a study file says to the study, each error with its place.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::correction::{GainBounds, GainObjective};
use crate::dataset::{Band, BundleKind, Dataset, ModelId, Pair};
use crate::fidelity::CostAverage;
use crate::io::content_fault::ContentFault;
use crate::io::flaw::Flaw;
use crate::io::place::Place;
use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::study::{Edit, Setting, Study};

use super::schema::{
    AverageText, BundleText, ConditionText, KindText, ObjectiveText, QuantityText, ScheduleText, SettingsText,
};

/// The study of `dataset` with these settings and choices; every one goes the way of the engineer's own decisions, so that the
/// file cannot hold what could not be decided.
pub(super) fn study_of(
    dataset: Arc<Dataset>,
    settings: &SettingsText,
    conditions: &[ConditionText],
) -> Result<Study, Flaw> {
    let mut study = Study::new(dataset);
    take_settings(&mut study, settings)?;
    take_pairs(&mut study, "constrained", &settings.constrained, Setting::Constrained)?;
    take_pairs(&mut study, "ignored", &settings.ignored, |pair, listed| Setting::Fitted(pair, !listed))?;
    let mut seen = BTreeSet::new();
    for (index, text) in conditions.iter().enumerate() {
        take_condition(&mut study, &Place::condition(index + 1, text.id), text, &mut seen)?;
    }
    Ok(study)
}

fn take_settings(study: &mut Study, text: &SettingsText) -> Result<(), Flaw> {
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
    let settings = [
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
    for (key, setting) in settings {
        let place = Place::entry(format!("settings, {key}"));
        study.apply(&Edit::Set(setting)).map_err(|refusal| Flaw::new(place, refusal))?;
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

/// Sets one setting of every pair: `setting(pair, whether it is listed)`.
fn take_pairs(
    study: &mut Study,
    key: &str,
    listed: &[(String, String)],
    setting: impl Fn(Pair, bool) -> Setting,
) -> Result<(), Flaw> {
    let mut pairs = BTreeSet::new();
    for (index, (output, input)) in listed.iter().enumerate() {
        let pair = study.dataset.find_pair(output, input).ok_or_else(|| {
            let unknown_output = !study.dataset.outputs().iter().any(|channel| channel.name == *output);
            let (kind, name) = if unknown_output { ("output", output) } else { ("input", input) };
            let place = Place::entry(format!("settings, {key}, entry {}", index + 1));
            Flaw::new(place, ContentFault::UnknownChannel { kind, name: name.clone() })
        })?;
        pairs.insert(pair);
    }
    for pair in study.settings.constrained.pairs() {
        let edit = Edit::Set(setting(pair, pairs.contains(&pair)));
        study.apply(&edit).map_err(|refusal| Flaw::new(Place::entry(format!("settings, {key}")), refusal))?;
    }
    Ok(())
}

fn take_condition(
    study: &mut Study,
    place: &Place,
    text: &ConditionText,
    seen: &mut BTreeSet<i64>,
) -> Result<(), Flaw> {
    let id = text.id;
    if !seen.insert(id) {
        return Err(Flaw::new(place.clone(), ContentFault::DuplicateCondition { id }));
    }
    let found = study.dataset.conditions().iter().position(|condition| condition.id() == id);
    let condition = found.ok_or_else(|| Flaw::new(place.clone(), ContentFault::UnknownCondition { id }))?;
    study
        .apply(&Edit::SetScheduled { condition, scheduled: text.scheduled })
        .map_err(|refusal| Flaw::new(place.at("scheduled"), refusal))?;
    take_bundle(study, place, condition, BundleKind::Physics, &text.physics)?;
    take_bundle(study, place, condition, BundleKind::Identified, &text.identified)
}

fn take_bundle(
    study: &mut Study,
    place: &Place,
    condition: usize,
    bundle: BundleKind,
    text: &BundleText,
) -> Result<(), Flaw> {
    let key = match bundle {
        BundleKind::Physics => "physics",
        BundleKind::Identified => "identified",
    };
    let find = |study: &Study, name: &String, entry: String| {
        let models = study.dataset.conditions()[condition].bundle(bundle);
        let model = models.iter().position(|model| model.name == *name);
        let model =
            model.ok_or_else(|| Flaw::new(place.at(entry), ContentFault::UnknownModel { name: name.clone() }))?;
        Ok(ModelId { condition, bundle, model })
    };
    for (index, name) in text.rejected.iter().enumerate() {
        let entry = format!("{key}, rejected, entry {}", index + 1);
        let id = find(study, name, entry.clone())?;
        study.apply(&Edit::Reject(id)).map_err(|refusal| Flaw::new(place.at(entry), refusal))?;
    }
    if let Some(name) = &text.pinned {
        let entry = format!("{key}, pinned");
        let id = find(study, name, entry.clone())?;
        study.apply(&Edit::Pin(id)).map_err(|refusal| Flaw::new(place.at(entry), refusal))?;
    }
    Ok(())
}
