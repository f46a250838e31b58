//! What differs between two sets of decisions about one dataset, in plain words.

use std::collections::BTreeSet;

use crate::correction::GainObjective;
use crate::dataset::{BundleKind, ConditionId, PairTable};
use crate::fidelity::CostAverage;
use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity, SecondVariable};
use crate::uncertainty::UncertaintySettings;
use crate::units::{number, s_to_ms};

use super::{BundleChoice, Settings, Study};

/// One decision that was taken otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionDifference {
    /// What was decided: "α of the gains", "LON → Q", "nominal (condition 10)".
    pub what: String,
    /// The one decision: "1", "held", "rejected".
    pub before: String,
    /// The other.
    pub after: String,
}

impl DecisionDifference {
    fn new(what: impl Into<String>, before: impl Into<String>, after: impl Into<String>) -> Self {
        Self { what: what.into(), before: before.into(), after: after.into() }
    }

    /// The difference in words: "α of the gains: 1 → 0.1".
    pub fn words(&self) -> String {
        format!("{}: {} → {}", self.what, self.before, self.after)
    }
}

/// Every decision in which `after` differs from `before`, a study of the same dataset: settings, responses, then condition by
/// condition. What was kept under names does not count.
pub fn decision_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let mut differences = setting_differences(&before.settings, &after.settings);
    let (a, b) = (&before.settings, &after.settings);
    differences.extend(pair_differences(before, (&a.constrained, &b.constrained), ["held", "free"]));
    differences.extend(pair_differences(before, (&a.fitted, &b.fitted), ["fitted", "ignored"]));
    for condition in before.dataset.conditions() {
        let id = condition.id();
        let (a, b) = (before.choice(id), after.choice(id));
        if a.scheduled != b.scheduled {
            let word = |scheduled| if scheduled { "in the schedule" } else { "left out of the schedule" };
            differences.push(DecisionDifference::new(format!("condition {id}"), word(a.scheduled), word(b.scheduled)));
        }
        if a.held_out != b.held_out {
            let word = |held_out| if held_out { "held out" } else { "not held out" };
            differences.push(DecisionDifference::new(format!("condition {id}"), word(a.held_out), word(b.held_out)));
        }
        for kind in BundleKind::BOTH {
            differences.extend(bundle_differences(id, kind, a.bundle(kind), b.bundle(kind)));
        }
    }
    differences
}

fn setting_differences(before: &Settings, after: &Settings) -> Vec<DecisionDifference> {
    let (before, after) = (setting_words(before), setting_words(after));
    let pairs = before.into_iter().zip(after).filter(|((_, before), (_, after))| before != after);
    pairs.map(|((what, before), (_, after))| DecisionDifference::new(what, before, after)).collect()
}

/// Every setting with its value in words, the responses apart.
fn setting_words(settings: &Settings) -> Vec<(&'static str, String)> {
    let band = format!("{} to {} rad/s", number(settings.band.min()), number(settings.band.max()));
    let average = match settings.cost_average {
        CostAverage::Median => "median",
        CostAverage::Mean => "mean",
    };
    let coherence = settings.coherence_threshold;
    let coherence = coherence.map_or_else(|| "not used".to_owned(), |least| format!("used from {}", number(least)));
    let objective = match settings.gain_objective {
        GainObjective::Ratio => "ratios",
        GainObjective::Decibel => "dB",
    };
    let by_quantile = || "by the quantile".to_owned();
    let gain_bounds = settings
        .gain_bounds
        .map_or_else(by_quantile, |bounds| format!("{} to {}", number(bounds.lower), number(bounds.upper)));
    let delay_upper =
        settings.delay_upper_s.map_or_else(by_quantile, |upper_s| format!("{} ms", number(s_to_ms(upper_s))));
    let mut words = vec![
        ("frequency band", band),
        ("number of frequencies", settings.points.to_string()),
        ("average in J", average.to_owned()),
        ("coherence", coherence),
        ("α of the gains", number(settings.alpha_gain)),
        ("α of the delays", number(settings.alpha_delay)),
        ("phase correction", settings.phase.words().to_owned()),
        ("D of the delays", settings.delay_from.words().to_owned()),
        ("order of the lead filters", settings.lead.order.number().to_string()),
        ("n of the lead filters", number(settings.lead.pole)),
        ("R_max of the lead filters", number(settings.lead.limit)),
        ("objective of the gains", objective.to_owned()),
        ("quantile of the bounds", format!("{} %", number(100.0 * settings.quantile))),
        ("gain bounds", gain_bounds),
        ("upper delay bound", delay_upper),
        ("agreement tolerance", format!("{} dB", number(settings.agreement_db))),
    ];
    words.push(("G from", settings.gain_source_words()));
    words.extend(schedule_words(settings.schedule));
    words.extend(error_bar_words(settings.uncertainty));
    words
}

fn error_bar_words(settings: UncertaintySettings) -> [(&'static str, String); 5] {
    let known = |figure: Option<f64>, unit: &str| {
        figure.map_or_else(|| "as the files say".to_owned(), |figure| format!("{}{unit}", number(figure)))
    };
    [
        ("level of error bars", format!("{} %", number(100.0 * settings.level))),
        ("degrees of freedom borrowed", number(settings.prior_degrees)),
        ("averages of measured responses", known(settings.averages, "")),
        ("windows of measured responses", known(settings.window_s, " s")),
        ("windows overlap", if settings.half_overlap { "by half" } else { "not" }.to_owned()),
    ]
}

fn schedule_words(schedule: ScheduleSettings) -> [(&'static str, String); 6] {
    let kind = match schedule.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    };
    let quantity = match schedule.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let delays = if schedule.delays { "scheduled" } else { "not scheduled" };
    [
        ("schedule", kind),
        ("what is scheduled", quantity.to_owned()),
        ("delays", delays.to_owned()),
        ("degree of the signed delays", schedule.tau_degree.to_string()),
        ("airspeed tolerance", format!("{} kt", number(schedule.airspeed_tolerance_kt))),
        ("second variable", schedule.second.map_or("none", SecondVariable::name).to_owned()),
    ]
}

fn pair_differences(
    study: &Study,
    (before, after): (&PairTable<bool>, &PairTable<bool>),
    [yes, no]: [&str; 2],
) -> Vec<DecisionDifference> {
    let word = |marked: bool| if marked { yes } else { no };
    let changed = before.iter().filter(|(pair, marked)| **marked != after[*pair]);
    changed
        .map(|(pair, &marked)| DecisionDifference::new(study.dataset.pair_name(pair), word(marked), word(!marked)))
        .collect()
}

fn bundle_differences(
    condition: ConditionId,
    kind: BundleKind,
    before: &BundleChoice,
    after: &BundleChoice,
) -> Vec<DecisionDifference> {
    let rejected =
        |choice: &BundleChoice, name: &String| match (choice.rejected.contains(name), choice.reasons.get(name)) {
            (true, Some(reason)) => format!("rejected ({reason})"),
            (true, None) => "rejected".to_owned(),
            (false, _) => "kept".to_owned(),
        };
    let names: BTreeSet<&String> = before.rejected.iter().chain(&after.rejected).collect();
    let of_models = names.into_iter().map(|name| {
        DecisionDifference::new(
            format!("{name} (condition {condition})"),
            rejected(before, name),
            rejected(after, name),
        )
    });
    let represents = |choice: &BundleChoice| choice.pinned.clone().unwrap_or_else(|| "the medoid".to_owned());
    let pinned = DecisionDifference::new(
        format!("{kind} representative (condition {condition})"),
        represents(before),
        represents(after),
    );
    of_models.chain([pinned]).filter(|difference| difference.before != difference.after).collect()
}
