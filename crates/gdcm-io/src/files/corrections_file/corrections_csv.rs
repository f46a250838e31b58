//! `corrections.csv`: a row for each condition and channel.
//!
//! A *signed delay* `tau` is a channel's delay or, if negative, its lead, which a filter
//! provides (M15). A condition's *own* correction is its own optimum. The *price* of its leads is
//! the gain that they add above the band, and the frequency above which the model is not valid
//! (M15.6). `u_…` are standard deviations due to the choice of the physics model, that is, to its
//! trim, and to the identification (M13).

use std::collections::BTreeSet;
use std::io::{self, Write};

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::full_precision;
use gdcm_model::response::LeadFilter;
use gdcm_plot::figure::all_channels;
use gdcm_study::Analysis;

use super::csv_condition::{ConditionResults, condition_results};
use crate::csv_text::write_records;

/// A row: one channel in one condition.
struct ChannelRow<'a> {
    results: &'a ConditionResults<'a>,
    channel: Channel,
}

/// Column name, with the function that formats its cell.
type ChannelColumn = (&'static str, fn(&ChannelRow<'_>) -> String);

const CHANNEL_COLUMNS: [ChannelColumn; 23] = [
    ("condition", |row| row.results.condition.id().to_string()),
    ("airspeed_kt", |row| {
        row.results.condition.flight_state().airspeed_kt.to_string()
    }),
    ("kind", |row| match row.channel {
        Channel::Input(_) => "input".to_owned(),
        Channel::Output(_) => "output".to_owned(),
    }),
    ("channel", |row| row.name()),
    ("gain", |row| {
        full_precision(row.results.own().map(|own| own.gain(row.channel)))
    }),
    ("delay_s", |row| {
        full_precision(row.results.own().map(|own| own.pure_delay_s(row.channel)))
    }),
    ("scheduled_gain", |row| {
        full_precision(
            row.results
                .scheduled
                .as_ref()
                .map(|scheduled| scheduled.gain(row.channel)),
        )
    }),
    ("scheduled_delay_s", |row| {
        full_precision(
            row.results
                .scheduled
                .as_ref()
                .map(|scheduled| scheduled.pure_delay_s(row.channel)),
        )
    }),
    ("tau_s", |row| full_precision(row.tau_s(row.results.own()))),
    ("lead_s", |row| {
        full_precision(row.filter().map(LeadFilter::lead_s))
    }),
    ("zero_rad_s", |row| {
        full_precision(row.filter().map(LeadFilter::zero_rad_s))
    }),
    ("lag_rad_s", |row| {
        full_precision(row.filter().map(LeadFilter::lag_rad_s))
    }),
    ("gain_at_infinity_db", |row| {
        full_precision(row.filter().map(LeadFilter::gain_at_infinity_db))
    }),
    ("scheduled_tau_s", |row| {
        full_precision(row.tau_s(row.results.scheduled.as_ref()))
    }),
    ("gain_low", |row| {
        row.results.lower_end(Scalar::ChannelGain(row.channel))
    }),
    ("gain_high", |row| {
        row.results.upper_end(Scalar::ChannelGain(row.channel))
    }),
    ("delay_low_s", |row| {
        row.results.lower_end(Scalar::ChannelDelay(row.channel))
    }),
    ("delay_high_s", |row| {
        row.results.upper_end(Scalar::ChannelDelay(row.channel))
    }),
    ("u_gain_physics", |row| {
        row.results
            .deviation(Scalar::ChannelGain(row.channel), |bar| bar.trim)
    }),
    ("u_gain_identification", |row| {
        row.results
            .deviation(Scalar::ChannelGain(row.channel), |bar| bar.identification)
    }),
    ("gain_above_band_db", |row| {
        full_precision(row.results.price().map(|price| price.gains_db[row.channel]))
    }),
    ("not_valid_above_rad_s", |row| {
        full_precision(row.results.price().map(|price| price.limit_rad_s))
    }),
    ("contains", |row| row.results.contains.clone()),
];

/// Writes `corrections.csv`: for the chosen conditions, the channel gains (factors) and delays
/// \[s\], their confidence intervals, and their scheduled values at the same flight state; with
/// leads, also the signed delays and the lead filters (M15). With couplings, further columns give,
/// in the row of an input, its coefficients for each input (mixing) and each output (feedback)
/// (M16). A missing value is an empty cell.
pub fn write_corrections_csv(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut heading: Vec<String> = CHANNEL_COLUMNS
        .iter()
        .map(|(name, _)| (*name).to_owned())
        .collect();
    if analysis.fitted_couplings().is_some() {
        let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
        for name in inputs {
            heading.push(format!("mixing_{name}"));
        }
        for name in outputs {
            heading.push(format!("feedback_{name}"));
        }
    }
    let mut records = vec![heading];
    for results in &condition_results(analysis, chosen) {
        for channel in all_channels(&analysis.study.dataset) {
            records.push(ChannelRow { results, channel }.cells());
        }
    }
    write_records(file, records.into_iter())
}

impl ChannelRow<'_> {
    fn cells(&self) -> Vec<String> {
        let mut cells = Vec::with_capacity(CHANNEL_COLUMNS.len());
        for (_, cell) in CHANNEL_COLUMNS {
            cells.push(cell(self));
        }
        cells.extend(self.coupling_cells());
        cells
    }

    fn name(&self) -> String {
        let (inputs, outputs) = self.results.analysis.study.dataset.input_and_output_names();
        self.channel.name(&inputs, &outputs)
    }

    /// Returns the channel's signed delay \[s\] in a correction; `None` without leads.
    fn tau_s(&self, correction: Option<&ChannelCorrection>) -> Option<f64> {
        let leads = correction?.leads.as_ref()?;
        Some(leads.taus_s[self.channel])
    }

    /// Returns the coefficients with which all inputs (mixing) and outputs (feedback) act on the
    /// row's input; empty cells in an output's row, and no cells without couplings.
    fn coupling_cells(&self) -> Vec<String> {
        let Some(fitted) = self.results.analysis.fitted_couplings() else {
            return Vec::new();
        };
        let matrices = fitted.matrices();
        let airspeed_kt = self.results.condition.flight_state().airspeed_kt;
        let mixing = matrices.normalised_mixing(airspeed_kt);
        let feedback = matrices.feedback();
        match self.channel {
            Channel::Input(to) => {
                let mut cells = Vec::new();
                for from in 0..mixing.ncols() {
                    cells.push(full_precision(Some(mixing[(to, from)])));
                }
                for from in 0..feedback.ncols() {
                    cells.push(full_precision(Some(feedback[(to, from)])));
                }
                cells
            }
            Channel::Output(_) => vec![String::new(); mixing.ncols() + feedback.ncols()],
        }
    }

    /// Returns the channel's lead filter in the condition's own correction.
    fn filter(&self) -> Option<LeadFilter> {
        self.results.own()?.lead(self.channel)
    }
}
