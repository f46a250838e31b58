//! The report's first page: verdict, corrections, signatures.
//!
//! A response's G and D are the gain and the delay that it needs (M6); its *net* gain and delay are
//! those of its output and its input together. *Held* responses are constrained to their G and D;
//! the verdict counts how many are matched, in gain and in phase. J (M4) is the mismatch with the
//! identified representative.
//!
//! The tables show the held responses; if none is held, the on-axis responses; if none is on-axis,
//! all.

use gdcm_method::correction::Channel;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{Condition, Pair};
use gdcm_model::number_format::{counted, decimals};
use gdcm_model::units::{number, s_to_ms, signed, told_apart};
use gdcm_plot::figure::assessment::usual_choice;
use gdcm_study::results::verdict::{GainVerdict, MatchCount, MeanCost, PhaseVerdict};
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, PhaseCorrection, Study};
use gdcm_words::Table;
use gdcm_words::assessment::summary_text;
use gdcm_words::caution::failure_text;
use gdcm_words::verdict::{
    gain_verdict_text, match_count_text, phase_verdict_text, study_verdict_text,
};

use super::page::Page;
use super::wording::{MISSING, capital, counted_are};

/// Maximum number of responses in the correction table, which then fits on the page.
const PAIRS_SHOWN: usize = 6;
/// Maximum number of table rows on the first page, which leaves room for the signatures.
const ROWS_SHOWN: usize = 24;
/// Net delays up to this magnitude are displayed as zero \[ms\].
const NO_DELAY_MS: f64 = 0.05;
/// Roles of those who sign the report.
const ROLES: [&str; 3] = ["Prepared by", "Checked by", "Approved by"];

/// Adds the verdict on the study, the corrections for all conditions, and the signature block.
pub(super) fn add_first_page(page: &mut Page, analysis: &Analysis) {
    page.section("Verdict");
    page.paragraph(&verdict_sentence(analysis));
    page.paragraph(&assessment_sentence(analysis));
    page.list(failures(analysis));
    let pairs = shown_pairs(&analysis.study);
    let mut tables = vec![correction_table(analysis, &pairs)];
    tables.extend(delay_table(analysis, &pairs));
    let rows = ROWS_SHOWN / tables.len();
    // The same for both tables: each has a row per condition.
    let mut omitted = 0;
    for mut table in tables {
        omitted = table.rows.len().saturating_sub(rows);
        table.rows.truncate(rows);
        page.table(&table);
    }
    if omitted > 0 {
        page.paragraph(&format!(
            "{} not listed on this page; section Conditions and its appendix list all.",
            counted_are(omitted, "more condition")
        ));
    }
    page.signatures(&ROLES);
}

fn verdict_sentence(analysis: &Analysis) -> String {
    let mut rejected = 0;
    for id in analysis.study.dataset.ids() {
        rejected += analysis.study.rejected_names(id).len();
    }
    let schedule = match &analysis.schedule {
        Ok(_) => format!(
            "The schedule is fitted to {}",
            counted(analysis.scheduled().len(), "condition")
        ),
        Err(_) => "There is no schedule".to_owned(),
    };
    format!(
        "{}. {schedule}; {} rejected.",
        capital(&study_verdict_text(analysis)),
        counted_are(rejected, "model")
    )
}

/// Returns a sentence for each condition without a result.
fn failures(analysis: &Analysis) -> Vec<String> {
    let mut failures = Vec::new();
    for (id, outcome) in &analysis.conditions {
        if let Err(failure) = outcome {
            let why = failure_text(failure, &analysis.study.dataset);
            failures.push(format!("Condition {id} has no result: {why}."));
        }
    }
    failures
}

/// Returns the responses in the tables, at most [`PAIRS_SHOWN`].
fn shown_pairs(study: &Study) -> Vec<Pair> {
    let held = study.settings.constrained.marked();
    let mut pairs: Vec<Pair> = held.take(PAIRS_SHOWN).collect();
    if pairs.is_empty() {
        let measuring = study.dataset.measuring_pairs();
        pairs = measuring.marked().take(PAIRS_SHOWN).collect();
    }
    pairs
}

/// Returns the noun for the responses in the tables.
fn shown_noun(study: &Study) -> &'static str {
    if study.settings.constrained.marked().next().is_some() {
        "held responses"
    } else if study.dataset.on_axis().marked().next().is_some() {
        "on-axis responses"
    } else {
        "responses"
    }
}

/// Names the responses in the tables: "6 of 12 held responses", "the held responses".
fn shown_words(study: &Study, pairs: &[Pair]) -> String {
    let held = study.settings.constrained.marked().count();
    let count = if held == 0 {
        study.dataset.measuring_pairs().marked().count()
    } else {
        held
    };
    let noun = shown_noun(study);
    if count > pairs.len() {
        format!("{} of {count} {noun}", pairs.len())
    } else {
        format!("the {noun}")
    }
}

/// Tabulates verdict, net gains with their error bars, and mean J for each condition.
fn correction_table(analysis: &Analysis, pairs: &[Pair]) -> Table {
    let study = &analysis.study;
    let interval = match &analysis.uncertainty {
        Some(uncertainty) => format!(" \u{b1} {:.0} % interval", 100.0 * uncertainty.level),
        None => String::new(),
    };
    let title = format!(
        "Corrections: verdict on gain and phase, net gains of {}{interval}, and mean J of all {}",
        shown_words(study, pairs),
        shown_noun(study)
    );
    let mut columns = vec![
        "condition".to_owned(),
        "gain".to_owned(),
        "phase".to_owned(),
    ];
    for pair in pairs {
        columns.push(study.dataset.pair_name(*pair));
    }
    columns.extend(["J before", "J after"].map(str::to_owned));
    let mut table = Table::new(title, columns);
    for condition in study.dataset.conditions() {
        let mut cells = vec![condition_cell(condition)];
        match analysis.condition(condition.id()) {
            Some(result) => cells.extend(correction_cells(analysis, result, pairs)),
            None => {
                cells.push("no result".to_owned());
                // Besides the responses: condition, gain, phase, J before and J after.
                cells.resize(pairs.len() + 5, MISSING.to_owned());
            }
        }
        table.row(cells);
    }
    table
}

/// Names a condition with its airspeed: "3: 45 kt".
fn condition_cell(condition: &Condition) -> String {
    let state = condition.flight_state();
    format!("{}: {} kt", state.id, number(state.airspeed_kt))
}

fn correction_cells(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    pairs: &[Pair],
) -> Vec<String> {
    let study = &analysis.study;
    let gain = GainVerdict::new(result);
    let gain = match gain {
        GainVerdict::Matched => match_count_text(MatchCount::of_gains(result)),
        _ => gain_verdict_text(gain, &study.dataset),
    };
    let phase = phase_verdict_text(PhaseVerdict::new(study, result), study);
    let mut cells = vec![gain, phase];
    for pair in pairs {
        let net_gain = decimals(result.correction.net_gain(*pair), 3);
        cells.push(match half_width_percent(analysis, result, *pair) {
            Some(percent) => format!("{net_gain} \u{b1} {} %", decimals(percent, 1)),
            None => net_gain,
        });
    }
    let (before, after) = match MeanCost::new(study, result) {
        Some(mean) => told_apart(mean.before, mean.after, 1),
        None => (MISSING.to_owned(), MISSING.to_owned()),
    };
    cells.extend([before, after]);
    cells
}

/// Returns the half-width of a net gain's error bar \[%\]; `None` without an error bar.
fn half_width_percent(analysis: &Analysis, result: &ConditionAnalysis, pair: Pair) -> Option<f64> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let bar = uncertainty.bar(result.condition.id(), Scalar::NetGain(pair))?;
    Some(100.0 * bar.half_width(uncertainty.level)?)
}

/// Tabulates each condition's net delays for `pairs`; negative values are leads. `None` if the
/// study corrects no phase, and if all values are displayed as zero.
fn delay_table(analysis: &Analysis, pairs: &[Pair]) -> Option<Table> {
    let study = &analysis.study;
    if study.settings.phase == PhaseCorrection::None {
        return None;
    }
    let mut columns = vec!["condition".to_owned()];
    for pair in pairs {
        columns.push(study.dataset.pair_name(*pair));
    }
    let mut table = Table::new(
        format!(
            "Net delays of {} [ms]; negative values are leads",
            shown_words(study, pairs)
        ),
        columns,
    );
    let mut has_delay = false;
    for condition in study.dataset.conditions() {
        let mut cells = vec![condition_cell(condition)];
        let result = analysis.condition(condition.id());
        for pair in pairs {
            cells.push(match result {
                Some(result) => {
                    let delay_ms = net_signed_delay_ms(result, *pair);
                    has_delay |= delay_ms.abs() > NO_DELAY_MS;
                    signed(delay_ms, 1)
                }
                None => MISSING.to_owned(),
            });
        }
        table.row(cells);
    }
    if has_delay { Some(table) } else { None }
}

fn net_signed_delay_ms(result: &ConditionAnalysis, pair: Pair) -> f64 {
    let delays_s = result.correction.signed_delays_s();
    s_to_ms(delays_s[Channel::Input(pair.input)] + delays_s[Channel::Output(pair.output)])
}

/// Returns a sentence on how the schedule changes J for the nominal models, and a warning if the
/// schedule must not be used between the conditions' airspeeds.
pub fn assessment_sentence(analysis: &Analysis) -> String {
    let dataset = &analysis.study.dataset;
    let measuring = dataset.measuring_pairs();
    let noun = if dataset.on_axis().marked().next().is_some() {
        "on-axis responses"
    } else {
        "responses"
    };
    let table = AssessmentTable::assess(analysis, usual_choice(analysis));
    let summary = summary_text(&table.summary(&measuring), dataset);
    let fails_between = match &analysis.schedule {
        Ok(schedule) => schedule.interpolation_fails(),
        Err(_) => false,
    };
    let between = if fails_between {
        " Do not use the schedule between the conditions' airspeeds (see its cautions)."
    } else {
        ""
    };
    format!(
        "Change in J of the nominal models due to the schedule, over the {noun} of all assessed \
        conditions: {summary}.{between}"
    )
}
