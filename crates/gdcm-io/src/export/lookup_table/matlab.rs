//! A lookup table as a variable for MATLAB, the struct `gdcm_table`.
//!
//! ```text
//! about, contains, interpolation                    heading, correction parts, how to interpolate
//! airspeed_kt, altitude_ft or mass_kg               a row for each breakpoint
//! inputs, outputs                                   channel names
//! input_gains, input_delays_s                       breakpoints x inputs; likewise for outputs
//! input_lead_numerators_s                           with leads
//! input_gain_error_percent, input_delay_error_ms    1 x inputs: maximum deviation of the linear
//!                                                   interpolation from the schedule
//! mixing, mixing_of                                 breakpoints x entries, "receiver from sender"
//! feedback                                          inputs x outputs, the same at all airspeeds
//! lead_order, lead_lag_s, not_valid_above_rad_s     lead filters, and their limit
//! input_gain_above_band_db                          1 x inputs: gain that leads add above the band
//! ```

use gdcm_method::couplings::CouplingMatrices;

use super::{BreakpointTable, Column, DELAY, GAIN, LEAD, MIXING};
use crate::export::matlab_values::{Fields, cell_of_texts, column, contained_parts, matrix, row};
use crate::formats::variables::{Value, Variable};

impl BreakpointTable<'_> {
    /// Returns the variable `gdcm_table`. Fields for the second variable, couplings and leads exist
    /// only if the schedule has them.
    pub(super) fn variable(&self) -> Variable {
        let scheduled = &self.scheduled;
        let mut fields = Fields::default();
        fields.add(
            "about",
            cell_of_texts(scheduled.heading(&scheduled.remarks())),
        );
        fields.add(
            "airspeed_kt",
            column(self.rows.iter().map(|row| row.airspeed_kt)),
        );
        if let Some(term) = &scheduled.schedule.second {
            let name = format!("{}_{}", term.variable.name(), term.variable.unit());
            fields.add(&name, column(self.rows.iter().filter_map(|row| row.second)));
        }
        let (inputs, outputs) = scheduled.dataset.input_and_output_names();
        self.add_side_fields(&mut fields, "input", inputs);
        self.add_side_fields(&mut fields, "output", outputs);
        if let Some(couplings) = scheduled.couplings {
            self.add_coupling_fields(&mut fields, couplings);
        }
        self.add_lead_fields(&mut fields);
        fields.add(
            "contains",
            contained_parts(&scheduled.contents, scheduled.dataset),
        );
        fields.add(
            "interpolation",
            Value::text("linear between the airspeeds, the end values outside"),
        );
        Variable {
            name: "gdcm_table".to_owned(),
            value: fields.record(),
        }
    }

    /// Adds the channel names and the columns for all inputs or all outputs; `side` is "input" or
    /// "output".
    fn add_side_fields(&self, fields: &mut Fields, side: &str, names: Vec<String>) {
        fields.add(&format!("{side}s"), cell_of_texts(names));
        let mut quantities = vec![&GAIN, &DELAY];
        if self.scheduled.schedule.leads.is_some() {
            quantities.push(&LEAD);
        }
        for quantity in quantities {
            let columns: Vec<&Column> = self
                .columns
                .iter()
                .filter(|column| column.side() == side && column.quantity == quantity)
                .collect();
            fields.add(
                &format!("{side}_{}", quantity.field),
                self.columns_matrix(&columns),
            );
            let unit = if quantity.is_time { "ms" } else { "percent" };
            let name = format!("{side}_{}_error_{unit}", quantity.name.replace(' ', "_"));
            fields.add(
                &name,
                row(columns.iter().map(|column| column.deviation.value)),
            );
        }
    }

    fn add_coupling_fields(&self, fields: &mut Fields, couplings: &CouplingMatrices) {
        let columns: Vec<&Column> = self
            .columns
            .iter()
            .filter(|column| column.quantity == &MIXING)
            .collect();
        fields.add("mixing", self.columns_matrix(&columns));
        fields.add(
            "mixing_of",
            cell_of_texts(columns.iter().map(|column| column.name.clone())),
        );
        let feedback = couplings.feedback();
        fields.add(
            "feedback",
            matrix(
                feedback.nrows(),
                feedback.ncols(),
                feedback.as_slice().to_vec(),
            ),
        );
    }

    fn add_lead_fields(&self, fields: &mut Fields) {
        let schedule = self.scheduled.schedule;
        if let Some(leads) = &schedule.leads {
            fields.add(
                "lead_order",
                Value::number(leads.design.settings().order.number() as f64),
            );
            fields.add("lead_lag_s", Value::number(leads.design.lag_s()));
        }
        if let Some(price) = schedule.lead_price() {
            fields.add("not_valid_above_rad_s", Value::number(price.limit_rad_s));
            fields.add(
                "input_gain_above_band_db",
                row(price.gains_db.inputs.iter().copied()),
            );
            fields.add(
                "output_gain_above_band_db",
                row(price.gains_db.outputs.iter().copied()),
            );
        }
    }

    /// Returns a matrix with a row for each breakpoint and a column for each of `columns`.
    fn columns_matrix(&self, columns: &[&Column]) -> Value {
        let mut values = Vec::new();
        for column in columns {
            values.extend(&column.values);
        }
        matrix(self.rows.len(), columns.len(), values)
    }
}
