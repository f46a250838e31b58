//! Cautions about all conditions: a table for kinds that usually recur in many conditions, and a
//! line for each other caution, merged over the conditions with equal text.
//!
//! A caution is a [`Remark`] with the kind [`RemarkKind::Caution`]. It is recurring
//! ([`Remark::is_recurring`]) if it usually concerns many conditions at once: missing leads,
//! responses farther from flight, and those in [`COLUMNS`].

use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::NO_VALUE;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::coupling_remark_search::analysis_coupling_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::Table;
use gdcm_words::leads::lead_limit_words;
use gdcm_words::remark::{lead_ms_text, lead_offer_texts, raised_gain_text, remark_text};

use super::condition_messages::{ConditionMessage, shared_messages};
use super::evidence_summary::{UNNEEDED_VARIABLE, unneeded_second_variable};
use super::physics_summary::physics_caution_codes;
use super::printed_lines::{indented, line};
use super::terminal::{keep_caution, keep_summary};

/// A condition's recurring cautions, which a table lists.
struct RecurringRow {
    condition: ConditionId,
    cautions: Vec<Remark>,
}

/// Returns the recurring cautions as a table, and each other caution once with its conditions; also
/// adds them to the JSON object.
///
/// 1. Sorts each condition's cautions into recurring ones, a row for each condition, and others;
///    the limit of the leads is one of the others.
/// 2. If there is only one recurring caution, it becomes one of the others; otherwise the rows
///    become a table.
/// 3. Merges the others with equal text.
pub(super) fn cautions_section(analysis: &Analysis) -> String {
    let mut rows: Vec<RecurringRow> = Vec::new();
    let mut others: Vec<ConditionMessage> = Vec::new();
    let dataset = &analysis.study.dataset;
    // Step 1.
    for condition in dataset.conditions() {
        let Some(result) = analysis.condition(condition.id()) else {
            continue;
        };
        let mut row = RecurringRow {
            condition: result.condition.id(),
            cautions: Vec::new(),
        };
        for caution in condition_cautions(analysis, result) {
            if caution.is_recurring() {
                row.cautions.push(caution);
            } else {
                let text = remark_text(&caution, dataset);
                others.push(ConditionMessage::new(row.condition, caution.code(), text));
            }
        }
        if let Some(words) = lead_limit_words(result) {
            others.push(ConditionMessage::new(row.condition, "lead-limit", words));
        }
        if !row.cautions.is_empty() {
            rows.push(row);
        }
    }
    let mut text = String::new();
    // Step 2.
    if let [row] = &rows[..]
        && let [alone] = &row.cautions[..]
    {
        // A single caution about a single condition needs no table.
        let words = remark_text(alone, dataset);
        let message = ConditionMessage::new(row.condition, alone.code(), words);
        others.insert(0, message);
    } else if !rows.is_empty() {
        text += &recurring_table(dataset, &rows);
    }
    // Step 3.
    for shared in shared_messages(others) {
        keep_caution(
            shared.message.code,
            &shared.conditions,
            &shared.message.text,
        );
        text += &line("Caution", &sanitized(&shared.words()));
    }
    text
}

/// A caution's code, with the conditions that it is about; without conditions, it is about the
/// whole study.
pub(super) struct CodedCaution {
    pub(super) code: &'static str,
    pub(super) conditions: Vec<ConditionId>,
}

/// Collects all caution codes, in this order: doubts about signs and units, conditions, physics
/// parameters, couplings, the schedule and its second variable. A coupling remark with good news is
/// no caution.
pub(super) fn coded_cautions(analysis: &Analysis) -> Vec<CodedCaution> {
    let mut coded = Vec::new();
    for doubt in &analysis.doubts {
        for id in &doubt.conditions {
            add_code(&mut coded, "convention-doubt", Some(*id));
        }
    }
    for result in analysis.conditions.values().flatten() {
        let id = Some(result.condition.id());
        for caution in condition_cautions(analysis, result) {
            add_code(&mut coded, caution.code(), id);
        }
        if lead_limit_words(result).is_some() {
            add_code(&mut coded, "lead-limit", id);
        }
    }
    for code in physics_caution_codes(analysis) {
        add_code(&mut coded, code, None);
    }
    for remark in analysis_coupling_remarks(analysis) {
        if remark.kind() != RemarkKind::Good {
            add_code(&mut coded, remark.code(), None);
        }
    }
    if let Ok(schedule) = &analysis.schedule {
        for caution in &schedule.cautions {
            add_code(&mut coded, caution.code(), caution.condition());
        }
    }
    if unneeded_second_variable(analysis).is_some() {
        add_code(&mut coded, UNNEEDED_VARIABLE, None);
    }
    coded
}

/// Adds a condition to the entry for a code; the first occurrence of a code adds the entry.
fn add_code(coded: &mut Vec<CodedCaution>, code: &'static str, id: Option<ConditionId>) {
    let place = match coded.iter().position(|known| known.code == code) {
        Some(place) => place,
        None => {
            coded.push(CodedCaution {
                code,
                conditions: Vec::new(),
            });
            coded.len() - 1
        }
    };
    if let Some(id) = id
        && !coded[place].conditions.contains(&id)
    {
        coded[place].conditions.push(id);
    }
}

/// Returns the cautions about a condition, without the doubts about signs and units, which are
/// printed before all conditions.
fn condition_cautions(analysis: &Analysis, result: &ConditionAnalysis) -> Vec<Remark> {
    condition_remarks(&analysis.study, result, None)
        .into_iter()
        .filter(|remark| remark.kind() == RemarkKind::Caution)
        .filter(|remark| !matches!(remark, Remark::ConventionDoubt(_)))
        .collect()
}

/// Returns an explanation of the columns, followed by a table with a row for each condition, a
/// column for each response that needs lead or moves away from flight, and those of [`COLUMNS`]
/// that have an entry. The JSON object has a single caution with the explanation and the codes.
fn recurring_table(dataset: &Dataset, rows: &[RecurringRow]) -> String {
    let cautions: Vec<&Remark> = rows.iter().flat_map(|row| &row.cautions).collect();
    let pairs: Vec<Pair> = dataset
        .on_axis()
        .pairs()
        .filter(|pair| has_entry(&cautions, *pair))
        .collect();
    let columns: Vec<&RecurringColumn> = COLUMNS
        .iter()
        .filter(|column| column.cell(&cautions, dataset).is_some())
        .collect();
    let mut headings = vec!["condition".to_owned()];
    headings.extend(pairs.iter().map(|pair| dataset.pair_name(*pair)));
    headings.extend(columns.iter().map(|column| column.heading.to_owned()));
    let mut table = Table::new("", headings);
    for row in rows {
        let cautions: Vec<&Remark> = row.cautions.iter().collect();
        let mut cells = vec![row.condition.to_string()];
        cells.extend(pairs.iter().map(|pair| pair_cell(&cautions, *pair)));
        for column in &columns {
            let cell = column.cell(&cautions, dataset);
            cells.push(cell.unwrap_or_else(|| NO_ENTRY.to_owned()));
        }
        table.row(cells);
    }
    let mut sentences = pair_sentences(&cautions);
    sentences.extend(columns.iter().map(|column| column.sentence));
    let sentence = sentences.join("; ");
    let conditions: Vec<ConditionId> = rows.iter().map(|row| row.condition).collect();
    let mut codes: Vec<&'static str> = cautions.iter().map(|caution| caution.code()).collect();
    codes.sort_unstable();
    codes.dedup();
    keep_summary("recurring-cautions", codes, &conditions, &sentence);
    line("Cautions", &format!("{sentence}:")) + &indented(&table, 2)
}

/// Explains the entries in the response columns.
fn pair_sentences(cautions: &[&Remark]) -> Vec<&'static str> {
    let mut sentences = Vec::new();
    if cautions
        .iter()
        .any(|caution| matches!(caution, Remark::NeedsLead { .. }))
    {
        sentences.push(
            "held responses need lead [ms]: the physics model lags, which no delay can correct",
        );
    }
    if cautions
        .iter()
        .any(|caution| matches!(caution, Remark::HeldFarther(_)))
    {
        sentences.push(
            "* marks a response that is farther from flight (larger J) than without a correction",
        );
    }
    sentences
}

/// Returns whether the table has an entry for a response: it needs a lead, or the correction moves
/// it away from flight.
fn has_entry(cautions: &[&Remark], pair: Pair) -> bool {
    needed_lead_ms(cautions, pair).is_some() || is_farther(cautions, pair)
}

/// Returns the lead \[ms\] that a response needs; `None` if it needs none.
fn needed_lead_ms(cautions: &[&Remark], pair: Pair) -> Option<String> {
    for caution in cautions {
        let Remark::NeedsLead { needed, .. } = caution else {
            continue;
        };
        for response in needed {
            if response.pair == pair {
                return Some(lead_ms_text(response.lead_s));
            }
        }
    }
    None
}

/// Returns whether the correction moves a response away from flight.
fn is_farther(cautions: &[&Remark], pair: Pair) -> bool {
    cautions.iter().any(|caution| match caution {
        Remark::HeldFarther(responses) => responses.iter().any(|response| response.pair == pair),
        _ => false,
    })
}

/// Formats the lead that a response needs, with a star if the response moves away from flight.
fn pair_cell(cautions: &[&Remark], pair: Pair) -> String {
    let lead_ms = needed_lead_ms(cautions, pair).unwrap_or_else(|| NO_ENTRY.to_owned());
    if is_farther(cautions, pair) {
        format!("{lead_ms} *")
    } else {
        lead_ms
    }
}

/// Text in an empty cell.
const NO_ENTRY: &str = NO_VALUE;

/// A column for a recurring caution that does not concern single responses.
struct RecurringColumn {
    heading: &'static str,
    sentence: &'static str,
    /// Returns a caution's cell; `None` if the caution does not belong in the column.
    format: fn(&Remark, &Dataset) -> Option<String>,
}

impl RecurringColumn {
    /// Returns the cell for the first caution that belongs in the column.
    fn cell(&self, cautions: &[&Remark], dataset: &Dataset) -> Option<String> {
        cautions
            .iter()
            .find_map(|caution| (self.format)(caution, dataset))
    }
}

/// Columns for the recurring cautions that do not concern single responses.
const COLUMNS: [RecurringColumn; 3] = [
    RecurringColumn {
        heading: "all",
        sentence: "a common lead (column all [ms]) is better removed at its source: check first the time alignment of the records, \
                   the simulation's integration and sampling delay, then servo and sensor models",
        format: common_lead,
    },
    RecurringColumn {
        heading: "gain",
        sentence: "column gain [dB] is the largest gain increase of the lead filters within the band, which the gains compensate",
        format: raised_gain,
    },
    RecurringColumn {
        heading: "J with leads",
        sentence: "the last column is the mean J of the held responses, without and with a delay or lead in each channel",
        format: cost_with_leads,
    },
];

fn common_lead(caution: &Remark, _: &Dataset) -> Option<String> {
    match caution {
        Remark::CommonLead { lead_s } => Some(lead_ms_text(*lead_s)),
        _ => None,
    }
}

fn raised_gain(caution: &Remark, dataset: &Dataset) -> Option<String> {
    match caution {
        Remark::GainRaised { rise_db, pair } => Some(format!(
            "{} ({})",
            raised_gain_text(*rise_db),
            dataset.pair_name(*pair)
        )),
        _ => None,
    }
}

fn cost_with_leads(caution: &Remark, _: &Dataset) -> Option<String> {
    match caution {
        Remark::LeadsOffered(offer) => Some(lead_offer_texts(offer).join(" → ")),
        _ => None,
    }
}
