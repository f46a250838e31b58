//! A schedule's parameters, row by row for display. The schedule gives each channel's gain `k` (and
//! delay `τ`, where requested) as a function of the airspeed `V`: a polynomial in the scaled
//! airspeed `v`, whose parameters are its coefficients, or a lookup table, whose parameters are its
//! values.

use super::channel_schedule::Schedule;
use super::lead_schedule::LeadSchedule;
use super::regression::Regression;
use super::settings::ScheduledQuantity;
use crate::correction::{Channel, Channels};

/// Column headings for a polynomial, lowest power first; a schedule's degree is at most 3.
const POWERS: [&str; 4] = ["1", "v", "v²", "v³"];

/// A channel's coefficients or values.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientRow {
    pub channel: Channel,
    /// Scheduled quantity with its channel: "ln k_LON", "k_Q", "τ_PED \[s\]".
    pub name: String,
    /// Coefficients or lookup values, one for each column.
    pub values: Vec<f64>,
}

/// Polynomial coefficients in the scaled airspeed, or a lookup table's values (M11).
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientTable {
    /// Powers multiplied by the coefficients ("1", "v", "v²", "v³"), or airspeeds ("60.0 kt").
    pub columns: Vec<String>,
    /// The gains of inputs and outputs, then their delays if scheduled.
    pub rows: Vec<CoefficientRow>,
    /// How `v` is defined: "v = (V − 92.3 kt) / 47.5 kt"; empty for a lookup table.
    pub scale: String,
}

impl Schedule {
    /// Lists the coefficients or lookup values with these channel names.
    pub fn coefficients(&self, inputs: &[String], outputs: &[String]) -> CoefficientTable {
        let columns = self.columns();
        let scale = match self.degree() {
            Some(_) => format!(
                "v = (V − {:.2} kt) / {:.2} kt",
                self.airspeeds.mean_kt, self.airspeeds.half_range_kt
            ),
            None => String::new(),
        };
        let gain_symbol = match self.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        };
        let mut rows = Vec::new();
        for (channel, regression) in self.gains.iter() {
            rows.push(CoefficientRow {
                channel,
                name: format!("{gain_symbol}_{}", channel.name(inputs, outputs)),
                values: self.row_values(regression, columns.len()),
            });
        }
        for taus_s in self.scheduled_delays() {
            for (channel, regression) in taus_s.iter() {
                rows.push(CoefficientRow {
                    channel,
                    name: format!("τ_{} [s]", channel.name(inputs, outputs)),
                    values: self.row_values(regression, columns.len()),
                });
            }
        }
        CoefficientTable {
            columns,
            rows,
            scale,
        }
    }

    /// Returns the column headings: powers of `v`, or the clusters' airspeeds.
    fn columns(&self) -> Vec<String> {
        match self.degree() {
            Some(degree) => {
                let lead_degree = self.leads.as_ref().map_or(0, LeadSchedule::degree);
                POWERS[..=degree.max(lead_degree)]
                    .iter()
                    .map(|&power| power.to_owned())
                    .collect()
            }
            None => self
                .airspeeds
                .clusters_kt()
                .into_iter()
                .map(|airspeed_kt| format!("{airspeed_kt:.1} kt"))
                .collect(),
        }
    }

    /// Returns the regressions for delays and signed delays, if these are scheduled.
    fn scheduled_delays(&self) -> Vec<&Channels<Regression>> {
        let mut scheduled = Vec::new();
        if let Some(delays) = &self.delays {
            scheduled.push(&delays.taus_s);
        }
        if let Some(leads) = &self.leads {
            scheduled.push(&leads.taus_s);
        }
        scheduled
    }

    /// Returns a regression's coefficients or lookup values, one for each column.
    fn row_values(&self, regression: &Regression, columns: usize) -> Vec<f64> {
        match (self.degree(), regression) {
            // Signed delays are a polynomial even where the gains are a lookup table.
            (None, Regression::Polynomial { .. }) => self
                .airspeeds
                .clusters_kt()
                .iter()
                .map(|&kt| regression.at(&self.airspeeds, kt))
                .collect(),
            // A missing power has the coefficient 0.
            _ => {
                let mut values = regression.parameters().to_vec();
                values.resize(columns, 0.0);
                values
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::test_points::{correction, points};
    use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledPoint};

    fn coefficients(points: &[ScheduledPoint<'_>], settings: ScheduleSettings) -> CoefficientTable {
        Schedule::fit(points, settings)
            .unwrap()
            .coefficients(&["LON".to_owned()], &["Q".to_owned()])
    }

    #[test]
    fn every_channel_has_a_row_of_named_coefficients() {
        let corrections = [1.0, 1.1, 1.3].map(|gain| correction(gain, 1.0));
        let points = points(&[60.0, 90.0, 120.0], &corrections, 0.1);
        let with_delays = ScheduleSettings {
            delays: true,
            ..ScheduleSettings::default()
        };
        let table = coefficients(&points, with_delays);
        let rows: Vec<&str> = table.rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(rows, ["ln k_LON", "ln k_Q", "τ_LON [s]", "τ_Q [s]"]);
        assert_eq!(
            (table.columns.join(" ").as_str(), table.scale.as_str()),
            ("1 v v²", "v = (V − 90.00 kt) / 30.00 kt")
        );
        // The parabola passes through its three points, of which the middle one is at v = 0.
        assert!((table.rows[0].values[0] - 1.1_f64.ln()).abs() < 1e-15);
        let lookup_table = ScheduleSettings {
            kind: ScheduleKind::Table,
            quantity: ScheduledQuantity::Gain,
            ..ScheduleSettings::default()
        };
        let table = coefficients(&points, lookup_table);
        assert_eq!(
            (table.columns.join(" ").as_str(), table.scale.as_str()),
            ("60.0 kt 90.0 kt 120.0 kt", "")
        );
        assert_eq!(
            (table.rows[0].name.as_str(), table.rows[0].values.as_slice()),
            ("k_LON", &[1.0, 1.1, 1.3][..])
        );
    }
}
