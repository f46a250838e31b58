//! Content of the assessment view apart from the bars: assessed responses, table, summary.

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::assessment::{ChangeColumn, ChangeTable};
use gdcm_study::AssessmentTable;
use gdcm_words::Table;
use gdcm_words::assessment::{held_out_verdict, not_assessed_text, summary_text};

use crate::gui::state::assessment_display::AssessedPairs;
use crate::gui::state::window_state::State;

/// Returns the assessed responses in matrix order.
pub fn assessed_pairs(state: &State) -> Vec<Pair> {
    let measuring = state.dataset().measuring_pairs();
    let mut pairs = Vec::new();
    for pair in measuring.pairs() {
        let is_assessed = match state.display.judging.assessed.pairs {
            AssessedPairs::OnAxis => measuring[pair],
            AssessedPairs::OffAxis => !measuring[pair],
            AssessedPairs::Focused => pair == state.display.selection.pair,
            AssessedPairs::All => true,
        };
        if is_assessed {
            pairs.push(pair);
        }
    }
    pairs
}

/// Builds the table: a row for each response, a column for each condition, and in each cell the
/// signed change in J.
pub fn assessment_text_table(state: &State, table: &AssessmentTable) -> Table {
    let part = state.display.judging.assessed.part;
    let columns: Vec<ChangeColumn> = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| ChangeColumn {
            condition: condition.id(),
            heading: condition.id().to_string(),
        })
        .collect();
    let title = format!("{} of each response in each condition", part.symbol());
    let contents = ChangeTable {
        dataset: state.dataset(),
        assessment: table,
        pairs: &assessed_pairs(state),
        columns: &columns,
        part: part.extractor(),
    };
    contents.table(title)
}

/// Summarises the assessment in sentences: improved responses, the verdict on conditions held out
/// of the schedule, and omissions.
pub fn assessment_sentences(state: &State, table: &AssessmentTable) -> Vec<String> {
    let pairs = assessed_pairs(state);
    let marked = state
        .dataset()
        .on_axis()
        .map(|pair, _| pairs.contains(&pair));
    let mut sentences = vec![summary_text(&table.summary(&marked), state.dataset())];
    if let Some(analysis) = state.analysis() {
        sentences.extend(held_out_verdict(analysis, table.choice));
    }
    for left_out in &table.left_out {
        sentences.push(format!(
            "condition {} is left out: {}",
            left_out.condition,
            not_assessed_text(&left_out.why, state.dataset())
        ));
    }
    sentences
}
