//! Tables of results to read, copy and save, with the same text in every format.

use gdcm_method::uncertainty::{Scalar, VarianceDecomposition};
use gdcm_model::dataset::Dataset;
use gdcm_model::units::{signed, without_sign_of_zero};

use super::analysis::Analysis;
use crate::stages::uncertainty::{AirspeedDifference, Uncertainty};

/// Rows of texts under headings. Headings name quantity and unit (`airspeed [kt]`), so that a table
/// is self-contained.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Title in words.
    pub title: String,
    /// The heading of each column, with its unit.
    pub columns: Vec<String>,
    /// The rows, with one cell for each column; a cell without a value is empty.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table without rows.
    pub fn new(
        title: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            title: title.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row; cells beyond the last column are dropped, missing cells are empty, and zeros
    /// have no sign.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut cells: Vec<String> = cells
            .into_iter()
            .map(|cell| unsigned_zero(cell.into()))
            .collect();
        cells.resize(self.columns.len(), String::new());
        self.rows.push(cells);
    }

    /// Formats the table as monospaced text: the title, the headings, a line for each row. Numeric
    /// columns are right-aligned, others left-aligned; no line ends in spaces.
    pub fn text(&self) -> String {
        let records = || std::iter::once(&self.columns).chain(&self.rows);
        let cells_of = |column: usize| records().map(move |record| record[column].as_str());
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|column| {
                cells_of(column)
                    .map(|cell| cell.chars().count())
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        let figures: Vec<bool> = (0..self.columns.len())
            .map(|column| self.has_numbers(column))
            .collect();
        let mut text = if self.title.is_empty() {
            String::new()
        } else {
            format!("{}\n", self.title)
        };
        for record in records() {
            let cells =
                record
                    .iter()
                    .zip(&widths)
                    .zip(&figures)
                    .map(|((cell, &width), figures)| {
                        // Not by the width of a format string, which is limited to 65535.
                        let room = " ".repeat(width - cell.chars().count());
                        if *figures {
                            format!("{room}{cell}")
                        } else {
                            format!("{cell}{room}")
                        }
                    });
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            text.push('\n');
        }
        text
    }

    /// Returns whether every nonempty cell of a column is a number, and there is at least one.
    pub fn has_numbers(&self, column: usize) -> bool {
        let mut cells = self
            .rows
            .iter()
            .map(|row| row[column].as_str())
            .filter(|cell| !cell.is_empty())
            .peekable();
        cells.peek().is_some() && cells.all(is_number)
    }
}

/// Returns the cell, with the sign of a zero removed.
fn unsigned_zero(cell: String) -> String {
    let unsigned = without_sign_of_zero(&cell);
    if unsigned.len() == cell.len() {
        cell
    } else {
        unsigned.to_owned()
    }
}

/// Returns whether a text is a number, with any minus sign and an optional unit, or the dash for a
/// missing value.
fn is_number(cell: &str) -> bool {
    let mut words = cell.split(' ');
    let number = words
        .next()
        .unwrap_or_default()
        .replacen('\u{2212}', "-", 1);
    matches!(cell, "–" | "—" | "-") || (words.count() < 2 && number.parse::<f64>().is_ok())
}

/// Placeholder for a missing figure.
const NONE: &str = "–";

fn cell(figure: Option<f64>, decimals: usize) -> String {
    figure.map_or_else(|| NONE.to_owned(), |figure| format!("{figure:.decimals$}"))
}

/// Formats a standard deviation of a logarithm in percent.
fn percent(deviation: Option<f64>) -> String {
    cell(deviation.map(|deviation| 100.0 * deviation), 1)
}

fn probability(p: Option<f64>) -> String {
    p.map_or_else(
        || NONE.to_owned(),
        |p| {
            if p < 0.001 {
                "< 0.001".to_owned()
            } else {
                format!("{p:.3}")
            }
        },
    )
}

/// Tabulates the differences of net gains at equal airspeed, largest multiple of the expected
/// difference first, with the difference of each row.
pub fn difference_table(
    dataset: &Dataset,
    uncertainty: &Uncertainty,
) -> (Table, Vec<AirspeedDifference>) {
    let columns = [
        "response",
        "conditions",
        "airspeed [kt]",
        "difference [%]",
        "× expected",
        "Holm p",
        "verdict",
    ];
    let mut table = Table::new("Differences at equal airspeed", columns);
    let mut differences = uncertainty.differences.clone();
    let ratio = |of: &AirspeedDifference| of.difference.ratio().unwrap_or_default();
    differences.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    for of in &differences {
        let [first, second] = of.conditions;
        table.row([
            dataset.pair_name(of.pair),
            format!("{first} and {second}"),
            format!("{:.0}", of.airspeed_kt),
            signed(100.0 * of.difference.delta, 1),
            cell(of.difference.ratio(), 1),
            probability(of.p_holm),
            of.verdict(uncertainty.level).to_owned(),
        ]);
    }
    (table, differences)
}

/// Tabulates whether the schedule needs a second variable, with the smallest detectable effect.
pub fn second_variable_table(dataset: &Dataset, uncertainty: &Uncertainty) -> Table {
    let columns = [
        "response",
        "variable",
        "effect [%]",
        "not seen below ± [%]",
        "Holm p",
        "unseen [%]",
        "with it [%]",
        "verdict",
    ];
    let mut table = Table::new("Does the schedule need a second variable?", columns);
    for test in &uncertainty.second_variables {
        let name = dataset.pair_name(test.pair);
        let variable = test.variable.name().to_owned();
        let cells = match &test.effect {
            Err(error) => [vec![NONE.to_owned(); 5], vec![error.to_string()]].concat(),
            Ok(effect) => vec![
                signed(100.0 * effect.effect, 1),
                percent(Some(effect.visible)),
                probability(test.p_holm),
                percent(effect.left_out_without),
                percent(effect.left_out_with),
                if test.needed { "needed" } else { "not needed" }.to_owned(),
            ],
        };
        table.row([name, variable].into_iter().chain(cells));
    }
    table
}

/// Tabulates the components of the scatter of each on-axis net gain.
pub fn scatter_table(dataset: &Dataset, uncertainty: &Uncertainty) -> Table {
    let columns = [
        "response",
        "about",
        "scatter [%]",
        "trim [%]",
        "identification [%]",
        "unexplained [%]",
        "interval [%]",
        "× expected",
    ];
    let mut table = Table::new("What the scatter of the net gains is made of", columns);
    let deviation = |variance: f64| percent(Some(variance.sqrt()));
    let interval = |split: &VarianceDecomposition| {
        let ends = split.unexplained_interval(uncertainty.level);
        ends.map_or_else(
            || NONE.to_owned(),
            |[low, high]| format!("{} to {}", percent(Some(low)), percent(Some(high))),
        )
    };
    for scatter in &uncertainty.scatter {
        let splits = [
            ("equal airspeed", &scatter.same_airspeed),
            ("the schedule", &scatter.about_schedule),
        ];
        for (about, split) in splits
            .into_iter()
            .filter_map(|(about, split)| Some((about, split.as_ref()?)))
        {
            table.row([
                dataset.pair_name(scatter.pair),
                about.to_owned(),
                deviation(split.scatter),
                deviation(split.trim),
                deviation(split.identification),
                deviation(split.unexplained()),
                interval(split),
                cell(split.ratio(), 1),
            ]);
        }
    }
    table
}

/// Tabulates the on-axis net gains of every condition with their error bars.
pub fn bar_table(analysis: &Analysis, uncertainty: &Uncertainty) -> Table {
    let level = format!("± [%] of {:.0} %", 100.0 * uncertainty.level);
    let columns = [
        "condition",
        "response",
        "net gain",
        &level,
        "trim uncertainty [%]",
        "identification [%]",
        "residual in the band [%]",
        "remarks",
    ];
    let mut table = Table::new("Error bars of the net gains", columns);
    let dataset = &analysis.study.dataset;
    for (id, of) in &uncertainty.conditions {
        for pair in dataset.measuring_pairs().marked() {
            let Some(bar) = &of.bars[Scalar::NetGain(pair)] else {
                continue;
            };
            table.row([
                id.to_string(),
                dataset.pair_name(pair),
                format!("{:.3}", bar.value.exp()),
                percent(bar.half_width(uncertainty.level)),
                percent(bar.trim.map(|part| part.variance.sqrt())),
                percent(bar.identification.map(|part| part.variance.sqrt())),
                percent(of.left_in_band[pair]),
                bar.remarks().join(", "),
            ]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign() {
        let mut table = Table::new("", ["a", "b", "c"]);
        table.row(["-0.0", "−0.00", "-0.01"]);
        assert_eq!(table.rows, [["0.0", "0.00", "-0.01"]]);
    }

    #[test]
    fn words_stand_at_the_left_and_figures_at_the_right() {
        let mut table = Table::new("Condition 3", ["response", "G [-]", "D [ms]"]);
        table.row(["LON → Q", "1.346", "−12.5"]);
        table.row(["COL → NZ", "0.9", ""]);
        assert_eq!(
            table.text(),
            "Condition 3\nresponse  G [-]  D [ms]\nLON → Q   1.346   −12.5\nCOL → NZ    0.9\n"
        );
    }

    #[test]
    fn a_column_without_figures_is_one_of_words() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["", "1"]);
        table.row(["", "two"]);
        assert_eq!(table.text(), "a  b\n   1\n   two\n");
    }

    #[test]
    fn numbers_with_units_are_numbers_and_counts_of_others_are_words() {
        assert!(["120 kt", "−1.5", "-", "–"].into_iter().all(is_number));
        assert!(
            ["3 of 4", "V+5kt", "kt", ""]
                .into_iter()
                .all(|words| !is_number(words))
        );
    }

    #[test]
    fn a_row_has_as_many_cells_as_there_are_columns() {
        let mut table = Table::new("", ["a", "b"]);
        table.row(["1"]);
        table.row(["1", "2", "3"]);
        assert_eq!(table.rows, [["1", ""], ["1", "2"]]);
    }
}
