//! What couplings are and are worth, as tables (M16.4, M16.5).

use nalgebra::DMatrix;

use crate::dataset::Dataset;
use crate::units::{number, telling};

use super::{AxisCost, CouplingEntry, CouplingsAssessment, Table};

impl CouplingsAssessment {
    /// "mixing and feedback of 11 conditions; its least-squares problem is solved to 3e-16".
    pub fn heading(&self) -> String {
        let count = self.fitted.problem.conditions.len();
        format!(
            "{} fitted to {count} {}; the normal equations of the last solve hold to {:.0e}",
            self.couplings.name(),
            if count == 1 { "condition" } else { "conditions" },
            self.fitted.fit.residual
        )
    }

    /// J on the axis and off it, without couplings and with them.
    pub fn cost_table(&self) -> Table {
        let columns = ["mean J", "on-axis, without", "on-axis, with", "others, without", "others, with"];
        let mut table = Table::new("", columns);
        let costs = &self.costs;
        let cell = |cost: Option<f64>| cost.map_or_else(|| "-".to_owned(), |cost| format!("{cost:.1}"));
        let mut row = |name: &str, without: AxisCost, with: AxisCost| {
            let cells = [without.on_axis, with.on_axis, without.others, with.others].map(cell);
            table.row(std::iter::once(name.to_owned()).chain(cells));
        };
        row("uncorrected", costs.uncorrected, AxisCost::default());
        row("own correction", costs.own.without, costs.own.with);
        row("scheduled", costs.scheduled.without, costs.scheduled.with);
        if let Some(left_out) = costs.left_out {
            row("condition left out", left_out.without, left_out.with);
        }
        table
    }

    /// The mixing at the mean airspeed, and the feedback where there is one: what each input (row) takes of each input and output. An
    /// entry within its bar stands in brackets.
    pub fn matrix_tables(&self, dataset: &Dataset) -> Vec<Table> {
        let airspeed_kt = self.mean_airspeed_kt();
        let (inputs, outputs) = dataset.names_of_channels();
        let bars = if self.left_out_fits.is_empty() {
            String::new()
        } else {
            format!(", ± bar of {} %, in brackets within it", number(100.0 * self.level))
        };
        let mixing = format!("Mixing at {} kt: share of each input that an input takes{bars}", telling(airspeed_kt, 0));
        let mut tables = vec![matrix_table(mixing, &inputs, &inputs, &self.mixing(airspeed_kt))];
        let feedback = self.feedback();
        if feedback.iter().any(|entry| entry.value != 0.0) {
            let of_unit = |(name, channel): (&String, &crate::dataset::Channel)| format!("{name} [{}]", channel.unit);
            let to: Vec<String> = inputs.iter().zip(dataset.inputs()).map(of_unit).collect();
            let from: Vec<String> = outputs.iter().zip(dataset.outputs()).map(of_unit).collect();
            let title = format!("Feedback: units of an input for each unit of an output{bars}");
            tables.push(matrix_table(title, &to, &from, &feedback));
        }
        tables
    }

    /// The poles of each condition's physics representative before and after, the farthest moved first.
    pub fn pole_table(&self) -> Table {
        let columns = ["condition", "before [rad/s]", "after [rad/s]", "moved by [rad/s]"];
        let mut table = Table::new("Poles of the physics representatives, without couplings and with them", columns);
        let pole = |of: nalgebra::Complex<f64>| {
            let imaginary = if of.im == 0.0 { String::new() } else { format!(" ± {}j", telling(of.im.abs(), 3)) };
            format!("{}{imaginary}", telling(of.re, 3).replace('-', "−"))
        };
        for (id, of) in &self.conditions {
            let mut shifts: Vec<_> = of.poles.iter().flatten().collect();
            shifts.sort_by(|a, b| b.distance_rad_s().unwrap_or(0.0).total_cmp(&a.distance_rad_s().unwrap_or(0.0)));
            for shift in shifts {
                let moved = shift.distance_rad_s().map_or_else(|| "-".to_owned(), |distance| telling(distance, 3));
                let before = shift.before.map_or_else(|| "-".to_owned(), pole);
                table.row([id.to_string(), before, pole(shift.after), moved]);
            }
        }
        table
    }
}

fn matrix_table(title: String, to: &[String], from: &[String], entries: &DMatrix<CouplingEntry>) -> Table {
    let mut table = Table::new(title, std::iter::once("to".to_owned()).chain(from.iter().cloned()));
    for (row, name) in to.iter().enumerate() {
        let cells = (0..from.len()).map(|column| entry_words(&entries[(row, column)]));
        table.row(std::iter::once(name.clone()).chain(cells));
    }
    table
}

/// "0.047 ± 0.011", in brackets where it is within its bar.
fn entry_words(entry: &CouplingEntry) -> String {
    let value = telling(entry.value, 3).replace('-', "−");
    let bar = entry.half_width.filter(|half_width| *half_width > 0.0);
    let text = bar.map_or_else(|| value.clone(), |bar| format!("{value} ± {}", telling(bar, 3)));
    if entry.is_within_bar && entry.value != 0.0 { format!("({text})") } else { text }
}
