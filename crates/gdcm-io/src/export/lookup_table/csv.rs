//! A lookup table as text.
//!
//! A [`BreakpointTable`] has a row for each breakpoint (airspeed and, if scheduled, second
//! variable), and a column for each channel's gain, delay and lead, and for each entry of the
//! mixing. The feedback does not depend on airspeed, and is therefore in the comment lines.

use std::fmt::Write;

use gdcm_method::couplings::CouplingMatrices;

use super::BreakpointTable;
use crate::export::program_text::{comment, number};

impl BreakpointTable<'_> {
    /// Returns the table as CSV, preceded by comment lines (#) that describe it and state each
    /// column's maximum deviation from its curve.
    pub(super) fn csv(&self) -> String {
        let mut text = String::new();
        self.write_description(&mut text);
        self.write_column_heads(&mut text);
        for (index, row) in self.rows.iter().enumerate() {
            let mut cells = vec![number(row.airspeed_kt)];
            cells.extend(row.second.map(number));
            for column in &self.columns {
                cells.push(number(column.values[index]));
            }
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }

    fn write_description(&self, text: &mut String) {
        for line in self.scheduled.heading(&self.scheduled.remarks()) {
            let _ = writeln!(text, "# {line}");
        }
        text.push_str(
            "# Maximum error of linear interpolation in this table (with the end values outside \
            its range), compared with the curves:\n",
        );
        for column in &self.columns {
            let _ = writeln!(
                text,
                "# {}: {}",
                comment(&column.words()),
                column.deviation_words()
            );
        }
        if let Some(couplings) = self.scheduled.couplings {
            for line in self.feedback_lines(couplings) {
                let _ = writeln!(text, "# {line}");
            }
        }
    }

    fn write_column_heads(&self, text: &mut String) {
        text.push_str("airspeed [kt]");
        if let Some(term) = &self.scheduled.schedule.second {
            let _ = write!(text, ",{} [{}]", term.variable.name(), term.variable.unit());
        }
        for column in &self.columns {
            let unit = if column.quantity.is_time { "s" } else { "-" };
            let words = comment(&column.words()).replace('"', "\"\"");
            let _ = write!(text, ",\"{words} [{unit}]\"");
        }
        text.push('\n');
    }

    /// Returns a line for each input with the feedback gains from all outputs.
    fn feedback_lines(&self, couplings: &CouplingMatrices) -> Vec<String> {
        let (inputs, outputs) = self.scheduled.dataset.input_and_output_names();
        let mut lines = Vec::with_capacity(inputs.len());
        for (to, input) in inputs.iter().enumerate() {
            let mut entries = Vec::with_capacity(outputs.len());
            for (from, output) in outputs.iter().enumerate() {
                let gain = couplings.feedback()[(to, from)];
                entries.push(format!("{} {}", comment(output), number(gain)));
            }
            lines.push(format!(
                "feedback to input {}: {}",
                comment(input),
                entries.join(", ")
            ));
        }
        lines
    }
}
