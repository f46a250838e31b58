//! Table of the cautions that usually concern many conditions at once ([`Remark::is_recurring`]):
//! missing leads, responses farther from flight, and those in [`COLUMNS`].

use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::number_format::NO_VALUE;
use gdcm_study::results::remark::Remark;
use gdcm_words::Table;
use gdcm_words::remark::{lead_ms_text, lead_offer_texts, raised_gain_text};

use super::printed_lines::{indented, line};
use super::terminal::keep_summary;

/// A condition's recurring cautions, which a table lists.
pub(super) struct RecurringRow {
    pub(super) condition: ConditionId,
    pub(super) cautions: Vec<Remark>,
}

/// Returns an explanation of the columns, followed by a table with a row for each condition, a
/// column for each response that needs lead or moves away from flight, and those of [`COLUMNS`]
/// that have an entry. The JSON object has a single caution with the explanation and the codes.
pub(super) fn recurring_table(dataset: &Dataset, rows: &[RecurringRow]) -> String {
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
        sentence: "column J with leads is the mean J of the held responses, without and with a delay or lead in each channel",
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
