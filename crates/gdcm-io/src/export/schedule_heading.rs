//! Headings for files with an exported schedule: its quantities with meaning and units, origin,
//! contents, and remarks. The quantities are gains, delays, lead filters (M15) and couplings (M16).
//! *Remarks* are lines of text about the schedule, such as its cautions.

use gdcm_model::message_text::shortened;
use gdcm_plot::figure::all_channels;
use gdcm_words::lead_price::price_text;
use gdcm_words::schedule::{DELAYS_NOT_SCHEDULED, schedule_caution_text};

use super::exported_schedule::{ExportedSchedule, LEAD_INTERVALS};
use super::program_text::{comment, number};
use crate::software::software;

impl ExportedSchedule<'_> {
    /// Returns the heading for a file with the schedule, line by line; it ends with the `remarks`.
    pub(super) fn heading(&self, remarks: &[String]) -> Vec<String> {
        let airspeeds = &self.schedule.airspeeds;
        let quantities = if self.schedule.has_delays() {
            "Gains and delays"
        } else {
            "Gains (no delays)"
        };
        let mut lines = vec![
            format!("{quantities} that correct a helicopter model, scheduled with airspeed."),
            "Mi and Mo are diagonal matrices of the gains of inputs and outputs; tau_i and tau_o are \
            their delays, one for each channel."
                .to_owned(),
            "Inputs u, outputs y: the model gets the input Mi*u(t - tau_i); its output ym gives \
            y(t) = Mo*ym(t - tau_o)."
                .to_owned(),
            "Units: airspeed in knots, delays in seconds, gains without a unit.".to_owned(),
            format!(
                "Airspeeds outside {} to {} kt are clamped to the ends of this range.",
                airspeeds.min_kt, airspeeds.max_kt
            ),
            format!("Correction: {}", comment(&shortened(&self.source.name))),
            format!("Dataset: {}", comment(&shortened(self.dataset.name()))),
            format!("SHA-256 of the dataset: {}", comment(&self.source.sha256)),
            format!("Written by: {}", software()),
        ];
        lines.extend(self.lead_lines());
        if self.couplings.is_some() {
            lines.extend(
                [
                    "Couplings: instead of u1 = Mi*u(t - tau_i), after leads, the model itself \
                    gets u2 = mixing*u1 + feedback*ym;",
                    "ym is its output before any correction. If the model has a feed-through D, \
                    u2 and ym depend on each other instantaneously;",
                    "the solution is u2 = u1m + F*y0, where u1m = mixing*u1, y0 = C*x + D*u1m, F \
                    = feedback*inverse(I - D*feedback),",
                    "with the state x and the output matrix C of the model.",
                ]
                .map(str::to_owned),
            );
        }
        lines.push(format!("Contains: {}.", self.contents.words()));
        for words in self.contents.left_out_words(self.dataset) {
            lines.push(format!("Left out: {}.", comment(&words)));
        }
        for remark in remarks {
            lines.push(format!("Note: {}", comment(remark)));
        }
        lines
    }

    /// Describes the lead filters, line by line; empty without lead filters.
    fn lead_lines(&self) -> Vec<String> {
        let Some(leads) = &self.schedule.leads else {
            return Vec::new();
        };
        let lag_s = leads.design.lag_s();
        // The maximum step up to which the program itself samples these filters
        // (`CorrectedModelError::SlowSamples`).
        let longest_step_s = 0.5 * lag_s;
        let filter = match leads.design.settings().order.number() {
            1 => "L(s) = (1 + a*s)/(1 + b*s)",
            _ => "L(s) = (1 + sqrt(2)*a*s + a^2*s^2)/(1 + sqrt(2)*b*s + b^2*s^2)",
        };
        vec![
            format!(
                "Lead: each input, after its gain and delay, and each output, before them, passes \
                through {filter},"
            ),
            format!(
                "with b = {} s for all channels, and a [s] for each channel; a = b means no lead.",
                number(lag_s)
            ),
            format!(
                "In fixed-step code, use Tustin's rule and a step of at most {} s.",
                number(longest_step_s)
            ),
        ]
    }

    /// Returns the remarks on the schedule: missing delays, the price of leads, and cautions.
    pub(super) fn remarks(&self) -> Vec<String> {
        let (inputs, outputs) = self.dataset.input_and_output_names();
        let mut remarks = Vec::new();
        if !self.schedule.has_delays() {
            remarks.push(DELAYS_NOT_SCHEDULED.to_owned());
        }
        if let Some(price) = self.schedule.lead_price() {
            remarks.push(price_text(&price, &inputs, &outputs));
        }
        for caution in &self.schedule.cautions {
            remarks.push(schedule_caution_text(caution, &inputs, &outputs));
        }
        remarks
    }

    /// Returns whether a lead filter is given as a table over airspeed.
    pub(super) fn has_lead_table(&self) -> bool {
        all_channels(self.dataset).into_iter().any(|channel| {
            self.zero_s(channel)
                .is_some_and(|zero_s| zero_s.regression.parameters().len() > 1)
        })
    }

    /// Returns the remarks on the schedule as curves: those of [`Self::remarks`], and a remark if
    /// lead filters are given as tables.
    pub(super) fn curve_remarks(&self) -> Vec<String> {
        let mut remarks = self.remarks();
        if self.has_lead_table() {
            remarks.push(format!(
                "the lead filters are tables over airspeed, linear between {} points",
                LEAD_INTERVALS + 1
            ));
        }
        remarks
    }
}
