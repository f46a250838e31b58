//! Tables of ΔJ, the change in J due to a correction.

use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::units::signed;
use gdcm_study::results::assessment_table::AssessmentTable;
use gdcm_words::table::Table;

/// Contents for a table of ΔJ: a row for each pair, a column for each condition.
#[derive(Clone, Copy, Debug)]
pub struct ChangeTable<'a> {
    pub dataset: &'a Dataset,
    pub assessment: &'a AssessmentTable,
    pub pairs: &'a [Pair],
    pub columns: &'a [ChangeColumn],
    /// Function that returns the part of ΔJ to be tabulated, or the whole.
    pub part: fn(CostChange) -> f64,
}

/// A column in a [`ChangeTable`].
#[derive(Clone, Debug)]
pub struct ChangeColumn {
    pub condition: ConditionId,
    pub heading: String,
}

impl ChangeTable<'_> {
    /// Tabulates the signed values with one decimal, and a dash for an unavailable ΔJ.
    pub fn table(&self, title: impl Into<String>) -> Table {
        let mut headings = vec!["response".to_owned()];
        headings.extend(self.columns.iter().map(|column| column.heading.clone()));
        let mut table = Table::new(title, headings);
        for &pair in self.pairs {
            let mut cells = vec![self.dataset.pair_name(pair)];
            for column in self.columns {
                cells.push(match self.assessment.change(column.condition, pair) {
                    Some(change) => signed((self.part)(change), 1),
                    None => "–".to_owned(),
                });
            }
            table.row(cells);
        }
        table
    }
}
