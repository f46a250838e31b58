//! The figures that make a schedule, channel by channel.

use crate::correction::Channel;

use super::lead_schedule::LeadSchedule;
use super::regression::Regression;
use super::schedule::{Schedule, ScheduledQuantity};

/// The figures of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientRow {
    /// The channel.
    pub channel: Channel,
    /// What is scheduled with its channel: "ln k_LON", "k_Q", "τ_PED \[s\]".
    pub name: String,
    /// A figure for each column of the table.
    pub figures: Vec<f64>,
}

/// The coefficients of a polynomial schedule in the scaled airspeed, or the figures of a table (M11).
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientTable {
    /// What each figure is multiplied by ("1", "v", "v²", "v³"), or the airspeed of each ("60.0 kt").
    pub columns: Vec<String>,
    /// Inputs, then outputs; gains, then delays where they are scheduled.
    pub rows: Vec<CoefficientRow>,
    /// What `v` is: "v = (V − 92.3 kt) / 47.5 kt"; empty for a table.
    pub scale: String,
}

impl Schedule {
    /// The figures that it is made of; channels have these names.
    pub fn coefficients(&self, inputs: &[String], outputs: &[String]) -> CoefficientTable {
        const POWERS: [&str; 4] = ["1", "v", "v²", "v³"];
        let (columns, scale): (Vec<String>, String) = match self.degree() {
            Some(degree) => {
                let degree = degree.max(self.leads.as_ref().map_or(0, LeadSchedule::degree));
                let columns = POWERS[..=degree].iter().map(|&power| power.to_owned()).collect();
                let (mean_kt, half_kt) = (self.airspeeds.mean_kt, self.airspeeds.half_range_kt);
                (columns, format!("v = (V − {mean_kt:.2} kt) / {half_kt:.2} kt"))
            }
            None => {
                let airspeeds_kt = self.airspeeds.clusters_kt();
                (airspeeds_kt.into_iter().map(|airspeed_kt| format!("{airspeed_kt:.1} kt")).collect(), String::new())
            }
        };
        let symbol = match self.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        };
        let count = columns.len();
        let row = |(channel, regression): (Channel, &Regression), symbol: &str, unit: &str| CoefficientRow {
            channel,
            name: format!("{symbol}_{}{unit}", channel.name(inputs, outputs)),
            figures: match (self.degree(), regression) {
                // Signed delays are a polynomial beside a table of gains.
                (None, Regression::Polynomial { .. }) => {
                    self.airspeeds.clusters_kt().iter().map(|&kt| regression.at(&self.airspeeds, kt)).collect()
                }
                // The power of which there is none has the coefficient 0.
                _ => {
                    let none = std::iter::repeat(0.0);
                    let figures = regression.figures().iter().copied().chain(none);
                    figures.take(count).collect()
                }
            },
        };
        let gains = with_channels(&self.inputs, &self.outputs).map(|of| row(of, symbol, ""));
        let delays = self.delays.iter().flat_map(|delays| with_channels(&delays.inputs, &delays.outputs));
        let leads = self.leads.iter().flat_map(|leads| with_channels(&leads.inputs, &leads.outputs));
        let delays = delays.chain(leads).map(|of| row(of, "τ", " [s]"));
        let rows = gains.chain(delays).collect();
        CoefficientTable { columns, rows, scale }
    }
}

fn with_channels<'a>(
    inputs: &'a [Regression],
    outputs: &'a [Regression],
) -> impl Iterator<Item = (Channel, &'a Regression)> {
    let inputs = inputs.iter().enumerate().map(|(index, regression)| (Channel::Input(index), regression));
    inputs.chain(outputs.iter().enumerate().map(|(index, regression)| (Channel::Output(index), regression)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledPoint};

    #[test]
    fn every_channel_has_a_row_of_named_coefficients() {
        let corrections = [1.0, 1.1, 1.3].map(|gain| ChannelCorrection {
            input_gains: vec![gain],
            output_gains: vec![1.0],
            input_delays_s: vec![0.02],
            output_delays_s: vec![0.0],
            leads: None,
        });
        let points: Vec<ScheduledPoint<'_>> = [60.0, 90.0, 120.0]
            .into_iter()
            .zip(&corrections)
            .map(|(airspeed_kt, correction)| ScheduledPoint {
                airspeed_kt,
                correction,
                delay_upper_s: 0.1,
                second: None,
            })
            .collect();
        let names = (["LON".to_owned()], ["Q".to_owned()]);
        let of = |settings| Schedule::of(&points, settings).unwrap().coefficients(&names.0, &names.1);
        let table = of(ScheduleSettings { delays: true, ..ScheduleSettings::default() });
        let rows: Vec<&str> = table.rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(rows, ["ln k_LON", "ln k_Q", "τ_LON [s]", "τ_Q [s]"]);
        assert_eq!(
            (table.columns.join(" ").as_str(), table.scale.as_str()),
            ("1 v v²", "v = (V − 90.00 kt) / 30.00 kt")
        );
        // The parabola goes through its three points: at v = 0 it is the middle one.
        assert!((table.rows[0].figures[0] - 1.1_f64.ln()).abs() < 1e-15);
        let table = of(ScheduleSettings {
            kind: ScheduleKind::Table,
            quantity: ScheduledQuantity::Gain,
            ..ScheduleSettings::default()
        });
        assert_eq!((table.columns.join(" ").as_str(), table.scale.as_str()), ("60.0 kt 90.0 kt 120.0 kt", ""));
        assert_eq!((table.rows[0].name.as_str(), table.rows[0].figures.as_slice()), ("k_LON", &[1.0, 1.1, 1.3][..]));
    }
}
