//! Every setting that changes a result.

use gdcm_core::correction::GainObjective;
use gdcm_core::dataset::{Pair, PairTable};
use gdcm_core::fidelity::CostAverage;
use gdcm_core::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm_core::study::{DelayFrom, PhaseCorrection, Settings, Study};
use gdcm_core::units::{number, s_to_ms};

use super::extent::names;
use super::page::Page;
use crate::figure::compact;

/// Adds the section.
pub(super) fn add(page: &mut Page, study: &Study) {
    page.section("Settings");
    let Settings { band, points, alpha_gain, alpha_delay, agreement_db, schedule, .. } = &study.settings;
    let settings = &study.settings;
    let dataset = &study.dataset;
    let pairs = |marked: &PairTable<bool>, wanted: bool| {
        let found: Vec<Pair> = marked.pairs().filter(|pair| marked[*pair] == wanted).collect();
        let found: Vec<String> = found.into_iter().map(|pair| dataset.pair_name(pair)).collect();
        if found.is_empty() { "none".to_owned() } else { names(&found) }
    };
    page.facts([
        ("Band of comparison", format!("{} to {} rad/s, {points} frequencies", number(band.min()), number(band.max()))),
        ("On-axis responses", pairs(dataset.on_axis(), true)),
        ("Held exactly", pairs(&settings.constrained, true)),
        ("Ignored in the objective", pairs(&settings.fitted, false)),
        ("α of the gains, of the delays", format!("{}, {}", number(*alpha_gain), number(*alpha_delay))),
        ("The phase is corrected by", phase_words(settings)),
        ("The gains minimise", objective_words(settings.gain_objective).to_owned()),
        ("Bounds of the gains", gain_bound_words(settings)),
        ("Upper bound of the delays", delay_bound_words(settings)),
        ("Loops of held gains agree within", format!("{} dB", number(*agreement_db))),
        ("J takes over frequency", average_word(settings.cost_average).to_owned()),
        ("Coherence counts from", coherence_words(settings.coherence_threshold)),
        ("G is taken from", settings.gain_source_words()),
        ("Schedule", schedule_words(schedule)),
        ("Level of error bars", percent(settings.uncertainty.level)),
    ]);
}

/// `the median`, or `the mean`.
pub(super) fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "the median",
        CostAverage::Mean => "the mean",
    }
}

fn phase_words(settings: &Settings) -> String {
    match settings.phase {
        PhaseCorrection::None => "nothing".to_owned(),
        PhaseCorrection::Delay => format!("delays; D is the {}", settings.delay_from.words()),
        PhaseCorrection::Lead => format!(
            "a delay or a lead filter a channel: order {}, n {}, R_max {}; D is the {}",
            settings.lead.order.number(),
            number(settings.lead.pole),
            number(settings.lead.limit),
            DelayFrom::Band.words()
        ),
    }
}

fn objective_words(objective: GainObjective) -> &'static str {
    match objective {
        GainObjective::Ratio => "squared differences of ratios, eq. (7)",
        GainObjective::Decibel => "squared differences in dB",
    }
}

fn coherence_words(threshold: Option<f64>) -> String {
    threshold.map_or("it counts for nothing".to_owned(), |least| format!("γ² = {}", number(least)))
}

fn percent(quantile: f64) -> String {
    format!("{} %", compact(100.0 * quantile))
}

fn gain_bound_words(settings: &Settings) -> String {
    match settings.gain_bounds {
        Some(bounds) => format!("{} to {}, set by hand", number(bounds.lower), number(bounds.upper)),
        None => {
            let (low, high) = (percent(settings.quantile), percent(1.0 - settings.quantile));
            format!("{low} and {high} quantiles of the on-axis ratios")
        }
    }
}

fn delay_bound_words(settings: &Settings) -> String {
    match settings.delay_upper_s {
        Some(upper_s) => format!("{} ms, set by hand", compact(s_to_ms(upper_s))),
        None => format!("{} quantile of the on-axis Δφ/ω", percent(1.0 - settings.quantile)),
    }
}

/// The form of a schedule in words.
pub(super) fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree} in airspeed"),
        ScheduleKind::Table => "table over airspeed, linear between its points".to_owned(),
    };
    let of = match settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let delays = if settings.delays { "delays are scheduled too" } else { "delays are not scheduled" };
    let second = settings.second.map_or_else(String::new, |variable| format!(" and {variable}"));
    format!("{kind}{second}, of {of}; airspeeds within {} kt are one; {delays}", number(settings.airspeed_tolerance_kt))
}
