//! Condition tables in the report: an overview; channels, responses and models for one condition.
//!
//! G and D are the gain and the delay that a response needs (M6). Each condition's channel gains
//! and delays are fitted so that the net gain and net delay of every response, those of its input
//! and its output together, come near its G and D; *held* responses are constrained to them,
//! *ignored* ones are not fitted. Models are *kept* unless the analyst rejects them. A model's
//! *mean distance*, in √J, is that from the other kept models in its bundle; the *discontinuity
//! ratio* of a physics model compares its distances with those that the perturbations explain (M5).

use gdcm_method::correction::{Channel, Outcome};
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::{BundleKind, Condition, ModelId, Pair};
use gdcm_model::number_format::{counted, decimals};
use gdcm_model::units::{number, s_to_ms, signed};
use gdcm_plot::figure::all_channels;
use gdcm_study::results::verdict::MatchCount;
use gdcm_study::{Analysis, ConditionAnalysis, Study};
use gdcm_words::Table;
use gdcm_words::caution::undefined_text;
use gdcm_words::verdict::match_count_text;

use super::limits::PAIRS_LISTED;
use super::page::Page;
use super::shown_models::models_shown;
use super::wording::{MISSING, names};

/// Tabulates the conditions: kept models, matched constrained responses, and whether the gains are
/// proven optimal.
pub(super) fn condition_table(analysis: &Analysis) -> Table {
    let title = "Conditions: kept models, matched held responses, and whether the gains are \
        proven optimal";
    let columns = [
        "condition",
        "name",
        "V [kt]",
        "physics",
        "identified",
        "gains",
        "delays",
        "optimum",
        "scheduled",
    ];
    let mut table = Table::new(title, columns);
    for condition in analysis.study.dataset.conditions() {
        let state = condition.flight_state();
        let result = analysis.condition(condition.id());
        let (gains, delays, optimum) = match result {
            Some(result) => (
                match_count_text(MatchCount::of_gains(result)),
                match_count_text(MatchCount::of_phases(result)),
                proof_word(result),
            ),
            None => (MISSING.to_owned(), MISSING.to_owned(), "no result"),
        };
        let scheduled = result.is_some() && analysis.study.choice(condition.id()).scheduled;
        table.row([
            state.id.to_string(),
            state.name.clone(),
            number(state.airspeed_kt),
            kept_words(&analysis.study, condition, BundleKind::Physics),
            kept_words(&analysis.study, condition, BundleKind::Identified),
            gains,
            delays,
            optimum.to_owned(),
            if scheduled { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

/// Returns how many models in a bundle the analyst has not rejected: "8 of 9".
fn kept_words(study: &Study, condition: &Condition, kind: BundleKind) -> String {
    let models = condition.bundle(kind);
    let rejected = &study.choice(condition.id()).bundle(kind).rejected;
    let kept = models
        .iter()
        .filter(|model| !rejected.contains(&model.name))
        .count();
    format!("{kept} of {}", models.len())
}

/// Returns in two words whether the gains are proven optimal.
pub(super) fn proof_word(result: &ConditionAnalysis) -> &'static str {
    match result.gains.proof.outcome {
        Outcome::Proven { .. } => "global optimum",
        Outcome::NotProven { .. } => "not proven",
    }
}

/// Tabulates each channel's gain and delay.
pub(super) fn channel_table(analysis: &Analysis, result: &ConditionAnalysis) -> Table {
    let dataset = &analysis.study.dataset;
    let correction = &result.correction;
    let title = format!(
        "Condition {}: gain and delay of each channel",
        result.condition.id()
    );
    let mut table = Table::new(title, ["channel", "side", "gain k", "delay τ [ms]"]);
    let (inputs, outputs) = dataset.input_and_output_names();
    for channel in all_channels(dataset) {
        let side = match channel {
            Channel::Input(_) => "input",
            Channel::Output(_) => "output",
        };
        let gain = correction.gain(channel);
        let delay_s = correction.delay_s(channel);
        let name = channel.name(&inputs, &outputs);
        table.row([
            name,
            side.to_owned(),
            decimals(gain, 4),
            decimals(s_to_ms(delay_s), 2),
        ]);
    }
    table
}

/// Headings for the response table; [`response_cells`] returns the cells in the same order.
const RESPONSE_COLUMNS: [&str; 11] = [
    "response",
    "on-axis",
    "treated as",
    "G",
    "net gain",
    "D [ms]",
    "net delay [ms]",
    "J before",
    "J after",
    "ΔJ magnitude",
    "ΔJ phase",
];

/// Adds the response table, and the reasons why some responses have no G and no D. If there are
/// more responses than fit, only the on-axis and the constrained ones are listed.
pub(super) fn add_responses(page: &mut Page, study: &Study, result: &ConditionAnalysis) {
    let pairs: Vec<Pair> = study.dataset.on_axis().pairs().collect();
    let measuring = study.dataset.measuring_pairs();
    let mut shown = pairs.clone();
    if pairs.len() > PAIRS_LISTED {
        shown.retain(|pair| measuring[*pair] || study.settings.constrained[*pair]);
    }
    let title = format!(
        "Condition {}: G, D and J of the representative before and after its own correction",
        result.condition.id()
    );
    let mut table = Table::new(title, RESPONSE_COLUMNS);
    for pair in &shown {
        table.row(response_cells(study, result, *pair));
    }
    page.table(&table);
    if shown.len() < pairs.len() {
        page.paragraph(&format!(
            "Not listed: {} neither on-axis nor held.",
            responses_that_are(pairs.len() - shown.len())
        ));
    }
    page.list(undefined_lines(study, result));
}

fn responses_that_are(count: usize) -> String {
    let verb = if count == 1 { "is" } else { "are" };
    format!("{} that {verb}", counted(count, "response"))
}

/// Formats a value with `digits` decimals; a missing value as [`MISSING`].
fn decimals_or_missing(value: Option<f64>, digits: usize) -> String {
    match value {
        Some(value) => decimals(value, digits),
        None => MISSING.to_owned(),
    }
}

/// Formats a change with its sign and one decimal; a missing value as [`MISSING`].
fn change_or_missing(value: Option<f64>) -> String {
    match value {
        Some(value) => signed(value, 1),
        None => MISSING.to_owned(),
    }
}

/// Returns a response's cells. It is treated as undefined without G and D, else as held, ignored or
/// fitted, in this order.
fn response_cells(study: &Study, result: &ConditionAnalysis, pair: Pair) -> [String; 11] {
    let cost = result.cost[pair];
    let g = result.delta_gain(pair);
    let d_ms = result.delta_delay_s(pair).map(s_to_ms);
    let treatment = if g.is_none() {
        "no G, no D"
    } else if result.held()[pair] {
        "held"
    } else if study.settings.ignored[pair] {
        "ignored"
    } else {
        "fitted"
    };
    let is_on_axis = study.dataset.on_axis()[pair];
    [
        study.dataset.pair_name(pair),
        if is_on_axis { "yes" } else { "no" }.to_owned(),
        treatment.to_owned(),
        decimals_or_missing(g, 3),
        decimals(result.correction.net_gain(pair), 3),
        decimals_or_missing(d_ms, 1),
        decimals(s_to_ms(result.correction.net_delay_s(pair)), 1),
        decimals_or_missing(cost.map(|cost| cost.uncorrected.total()), 1),
        decimals_or_missing(cost.map(|cost| cost.corrected.total()), 1),
        change_or_missing(cost.map(|cost| cost.magnitude())),
        change_or_missing(cost.map(|cost| cost.phase())),
    ]
}

/// Returns a sentence for each reason why responses have no G and no D.
fn undefined_lines(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for (pair, why) in result.comparison.undefined.iter() {
        let Some(why) = why.map(undefined_text) else {
            continue;
        };
        let name = study.dataset.pair_name(pair);
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, pairs)) => pairs.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    let mut lines = Vec::with_capacity(reasons.len());
    for (why, pairs) in reasons {
        lines.push(format!("No G and no D for {}: {why}.", names(&pairs)));
    }
    lines
}

/// Tabulates a bundle's models; for a long bundle, only those selected by [`models_shown`].
pub(super) fn model_table(study: &Study, result: &ConditionAnalysis, kind: BundleKind) -> Table {
    let models = result.condition.bundle(kind);
    let shown = models_shown(study, result, kind);
    let is_physics = kind == BundleKind::Physics;
    let columns = [
        "model",
        "kept",
        "order",
        "mean distance [√J]",
        "discontinuity ratio",
    ];
    let columns = if is_physics {
        &columns[..]
    } else {
        &columns[..4]
    };
    let mut table = Table::new(
        format!("Condition {}: {kind} models", result.condition.id()),
        columns.iter().copied(),
    );
    for &index in &shown {
        let model = &models[index];
        let ratio = if is_physics {
            result.discontinuity_ratio(&model.name)
        } else {
            None
        };
        let ratio_words = match ratio {
            Some(ratio) if ratio > SUGGESTION_RATIO => {
                format!("{} (suggested outlier)", decimals(ratio, 2))
            }
            ratio => decimals_or_missing(ratio, 2),
        };
        let order = match model.order() {
            Some(order) => order.to_string(),
            None => MISSING.to_owned(),
        };
        table.row([
            model.name.clone(),
            kept_word(study, result, kind, &model.name).to_owned(),
            order,
            decimals_or_missing(result.score(kind, &model.name), 2),
            ratio_words,
        ]);
    }
    table
}

/// Adds a sentence on a long bundle's models that are neither listed nor drawn.
pub(super) fn add_models_omitted(
    page: &mut Page,
    study: &Study,
    result: &ConditionAnalysis,
    kind: BundleKind,
) {
    let models = result.condition.bundle(kind);
    let shown = models_shown(study, result, kind);
    if shown.len() < models.len() {
        page.paragraph(&format!(
            "{} of {} {kind} models are listed and drawn.",
            shown.len(),
            models.len()
        ));
    }
}

/// Describes in a word whether a model is kept: rejected by the analyst, else set aside by the
/// analysis, else the representative, else any other kept model.
fn kept_word(
    study: &Study,
    result: &ConditionAnalysis,
    kind: BundleKind,
    name: &str,
) -> &'static str {
    let id = ModelId::new(result.condition.id(), kind, name);
    if study.is_rejected(&id) {
        "rejected"
    } else if result
        .cautions
        .iter()
        .any(|caution| caution.is_set_aside(kind, name))
    {
        "set aside"
    } else if result.representative_name(kind) == name {
        "representative"
    } else {
        "yes"
    }
}
