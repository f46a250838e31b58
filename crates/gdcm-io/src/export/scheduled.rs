//! The schedule in the form exported to programs and tables: gain, delay and lead filter of each
//! channel as curves over airspeed, and the headings of the files.

use gdcm_method::correction::Channel;
use gdcm_method::couplings::CouplingMatrices;
use gdcm_method::schedule::{Regression, Schedule, ScheduledQuantity};
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::shortened;
use gdcm_plot::figure::all_channels;
use gdcm_words::lead_price::price_text;
use gdcm_words::schedule::schedule_caution_text;

use super::ExportSource;
use super::program_text::{comment, number};
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;

/// Number of airspeed intervals in the table that approximates a lead filter whose time constant
/// varies with airspeed.
const LEAD_INTERVALS: u32 = 100;

/// A schedule, with the dataset and the study from which it comes.
#[derive(Clone)]
pub(super) struct Scheduled<'e> {
    pub(super) schedule: &'e Schedule,
    pub(super) dataset: &'e Dataset,
    pub(super) source: &'e ExportSource,
    /// Mixing and feedback, if any.
    pub(super) couplings: Option<&'e CouplingMatrices>,
    /// Correction parts that a file with the schedule contains.
    pub(super) contents: ExportContents,
}

/// A gain, or a time \[s\], over airspeed.
pub(super) struct Curve {
    /// Dependence on airspeed: a polynomial in the scaled airspeed, or a table.
    pub(super) figures: Regression,
    /// Coefficient of the scaled second variable; `None` without one.
    pub(super) slope: Option<f64>,
    /// Whether `figures` and `slope` give the natural logarithm of the value.
    pub(super) of_logarithm: bool,
    /// Upper limit of the value; the lower limit is then zero. `None` if the value is not limited.
    pub(super) upper: Option<Regression>,
}

impl Curve {
    /// Creates a curve from a regression alone.
    pub(super) fn plain(figures: Regression) -> Self {
        Self {
            figures,
            slope: None,
            of_logarithm: false,
            upper: None,
        }
    }

    fn constant(value: f64) -> Self {
        Self::plain(Regression::Polynomial {
            coefficients: vec![value],
        })
    }

    fn is_finite(&self) -> bool {
        let upper = match &self.upper {
            Some(upper) => upper.parameters(),
            None => &[],
        };
        self.figures
            .parameters()
            .iter()
            .chain(&self.slope)
            .chain(upper)
            .all(|figure| figure.is_finite())
    }
}

impl Scheduled<'_> {
    /// Returns a channel's gain \[-\].
    pub(super) fn gain(&self, channel: Channel) -> Curve {
        let second = self.schedule.second.as_ref();
        Curve {
            slope: second.map(|term| term.slopes[channel]),
            of_logarithm: self.schedule.settings.quantity == ScheduledQuantity::LnGain,
            ..Curve::plain(self.schedule.gains[channel].clone())
        }
    }

    /// Returns a channel's delay \[s\]; zero if delays are not scheduled.
    pub(super) fn delay_s(&self, channel: Channel) -> Curve {
        if let Some(leads) = &self.schedule.leads {
            let upper = Regression::Table {
                airspeeds_kt: vec![self.schedule.airspeeds.min_kt],
                values: vec![leads.bounds_s[1]],
            };
            return Curve {
                upper: Some(upper),
                ..Curve::plain(leads.taus_s[channel].clone())
            };
        }
        match &self.schedule.delays {
            Some(delays) => Curve {
                upper: Some(delays.upper_s.clone()),
                ..Curve::plain(delays.taus_s[channel].clone())
            },
            None => Curve::constant(0.0),
        }
    }

    /// Returns the numerator time constant `a` \[s\] of a channel's lead filter; without a lead in
    /// this channel, `a` equals the denominator's `b`. `None` if the schedule has no leads.
    pub(super) fn zero_s(&self, channel: Channel) -> Option<Curve> {
        let leads = self.schedule.leads.as_ref()?;
        let least = self.schedule.airspeeds.min_kt;
        let most = self.schedule.airspeeds.max_kt;
        if leads.taus_s[channel].parameters().len() == 1 || least == most {
            return Some(Curve::constant(self.zero_at_s(channel, least)?));
        }
        // A table, because the numerator time constant is not a polynomial in airspeed even if the
        // signed delay is.
        let mut airspeeds_kt = Vec::new();
        let mut values = Vec::new();
        for place in 0..=LEAD_INTERVALS {
            let airspeed_kt = least + (most - least) * f64::from(place) / f64::from(LEAD_INTERVALS);
            airspeeds_kt.push(airspeed_kt);
            values.push(self.zero_at_s(channel, airspeed_kt)?);
        }
        Some(Curve::plain(Regression::Table {
            airspeeds_kt,
            values,
        }))
    }

    /// Returns the numerator time constant \[s\] of a channel's lead filter at an airspeed.
    fn zero_at_s(&self, channel: Channel, airspeed_kt: f64) -> Option<f64> {
        let leads = self.schedule.leads.as_ref()?;
        let tau_s = leads.taus_s[channel]
            .at(&self.schedule.airspeeds, airspeed_kt)
            .clamp(leads.bounds_s[0], leads.bounds_s[1]);
        match leads.design.filter(tau_s) {
            Some(filter) => Some(filter.zero_s),
            None => Some(leads.design.lag_s()),
        }
    }

    /// Returns the remarks on the schedule: missing delays, cost of leads, and cautions.
    pub(super) fn notes(&self) -> Vec<String> {
        let (inputs, outputs) = self.dataset.names_of_channels();
        let mut notes = Vec::new();
        if !self.schedule.has_delays() {
            notes.push("delays are not scheduled in this study: they are zero here".to_owned());
        }
        if let Some(price) = self.schedule.lead_price() {
            notes.push(price_text(&price, &inputs, &outputs));
        }
        for caution in &self.schedule.cautions {
            notes.push(schedule_caution_text(caution, &inputs, &outputs));
        }
        notes
    }

    /// Returns the remarks on the schedule, and a remark if lead filters are given as tables.
    pub(super) fn notes_of_curves(&self) -> Vec<String> {
        let mut notes = self.notes();
        let has_lead_table = all_channels(self.dataset).into_iter().any(|channel| {
            self.zero_s(channel)
                .is_some_and(|zero_s| zero_s.figures.parameters().len() > 1)
        });
        if has_lead_table {
            notes.push(format!(
                "the lead filters are tables over airspeed, linear between {} points",
                LEAD_INTERVALS + 1
            ));
        }
        notes
    }

    /// Returns the heading of a file with the schedule, line by line; `notes` are included.
    pub(super) fn heading(&self, notes: &[String]) -> Vec<String> {
        let airspeeds = &self.schedule.airspeeds;
        let quantities = if self.schedule.has_delays() {
            "Gains and delays"
        } else {
            "Gains (no delays)"
        };
        let mut lines = vec![
            format!("{quantities} that correct a helicopter model, scheduled with airspeed."),
            "The model gets the input Mi*u(t - tau_i); its output ym gives y(t) = Mo*ym(t - tau_o).".to_owned(),
            "Units: airspeed in knots, delays in seconds, gains without a unit.".to_owned(),
            format!(
                "Airspeeds outside {} to {} kt are clamped to the ends of this range.",
                airspeeds.min_kt, airspeeds.max_kt
            ),
            format!("Correction: {}", comment(&shortened(&self.source.name))),
            format!("Dataset: {}", comment(&shortened(self.dataset.name()))),
            format!("SHA-256 of the dataset: {}", comment(&self.source.sha256)),
            concat!("Written by: gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
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
                    = feedback*inverse(I - D*feedback).",
                ]
                .map(str::to_owned),
            );
        }
        lines.push(format!("Contains: {}.", self.contents.words()));
        for words in self.contents.left_out_words(self.dataset) {
            lines.push(format!("Left out: {}.", comment(&words)));
        }
        for note in notes {
            lines.push(format!("Note: {}", comment(note)));
        }
        lines
    }

    /// Describes the lead filters, line by line; empty without lead filters.
    fn lead_lines(&self) -> Vec<String> {
        let Some(leads) = &self.schedule.leads else {
            return Vec::new();
        };
        let lag_s = leads.design.lag_s();
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
                number(0.5 * lag_s)
            ),
        ]
    }

    /// Rejects a schedule with coefficients or values that are not finite.
    pub(super) fn check(&self) -> Result<(), ExportFault> {
        for channel in all_channels(self.dataset) {
            self.check_curve(channel, "gain", &self.gain(channel))?;
            self.check_curve(channel, "delay", &self.delay_s(channel))?;
            if let Some(zero_s) = self.zero_s(channel) {
                self.check_curve(channel, "lead numerator", &zero_s)?;
            }
        }
        Ok(())
    }

    fn check_curve(
        &self,
        channel: Channel,
        quantity: &'static str,
        curve: &Curve,
    ) -> Result<(), ExportFault> {
        if curve.is_finite() {
            return Ok(());
        }
        let (inputs, outputs) = self.dataset.names_of_channels();
        Err(ExportFault::Curve {
            channel: channel.name(&inputs, &outputs),
            curve: quantity,
        })
    }
}
