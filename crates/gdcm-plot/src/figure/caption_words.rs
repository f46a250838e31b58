//! Words for captions: a condition, the settings, and the schedule.

use gdcm_method::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_model::dataset::Dataset;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::number_format::compact;
use gdcm_study::decisions::settings::Settings;
use gdcm_study::{Analysis, CouplingCorrection, PhaseCorrection, PhysicsCorrection};

/// Returns `Condition 10: 60 kt, low altitude, high weight`, or `Condition 10` without a name.
pub fn condition_words(FlightState { id, name, .. }: &FlightState) -> String {
    if name.is_empty() {
        format!("Condition {id}")
    } else {
        format!("Condition {id}: {name}")
    }
}

/// Describes the dataset and the settings, for captions.
pub(super) fn settings_words(dataset: &Dataset, settings: &Settings) -> String {
    let low = compact(settings.band.min());
    let high = compact(settings.band.max());
    let phase = match settings.phase {
        PhaseCorrection::Delay => "",
        PhaseCorrection::None => " No phase correction.",
        PhaseCorrection::Lead => " A delay or a lead filter in each channel.",
    };
    let couplings = match settings.couplings {
        CouplingCorrection::None => "",
        CouplingCorrection::Mixing => " Couplings requested: mixing of the inputs.",
        CouplingCorrection::MixingAndFeedback => " Couplings requested: mixing and feedback.",
    };
    let physics = match settings.physics {
        PhysicsCorrection::Off => String::new(),
        requested => format!(" Physics parameters requested: {}.", requested.name()),
    };
    format!(
        "{}. Band {low} to {high} rad/s, {} frequencies; \u{3b1} {} for gains, {} for delays.{phase}{physics}{couplings}",
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

/// Describes the schedule of an analysis with the degree used, which may be lower than requested.
pub(super) fn used_schedule_words(analysis: &Analysis) -> String {
    let mut settings = analysis.study.settings.schedule;
    if let Ok(schedule) = &analysis.schedule
        && let Some(degree) = schedule.degree()
    {
        settings.kind = ScheduleKind::Polynomial { degree };
    }
    schedule_words(&settings)
}

/// Describes the schedule: `polynomial of degree 2 of ln k`.
pub fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    };
    let quantity = quantity_symbol(settings.quantity);
    let second = match settings.second {
        Some(variable) => format!(", with {variable} in the middle of its range"),
        None => String::new(),
    };
    format!("{kind} of {quantity}{second}")
}
