//! A schedule for external programs and tables: each channel's gain, delay and lead filter over
//! airspeed, and the file headings.

use gdcm_method::correction::Channel;
use gdcm_method::couplings::CouplingMatrices;
use gdcm_method::schedule::{Regression, Schedule, ScheduledQuantity};
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::shortened;
use gdcm_plot::figure::all_channels;

use super::ExportSource;
use super::programs::comment;
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;

/// A schedule with its dataset and study.
#[derive(Clone)]
pub(super) struct Scheduled<'e> {
    pub(super) schedule: &'e Schedule,
    pub(super) dataset: &'e Dataset,
    pub(super) source: &'e ExportSource,
    /// Mixing and feedback of the model, if any.
    pub(super) couplings: Option<&'e CouplingMatrices>,
    /// Contents of a file with the schedule.
    pub(super) contents: ExportContents,
}

/// A gain, or a time \[s\], over airspeed.
pub(super) struct Curve {
    /// A polynomial in the scaled airspeed, or a table.
    pub(super) figures: Regression,
    /// Coefficient of the scaled second variable, for an added term.
    pub(super) slope: Option<f64>,
    /// Whether the sum is the natural logarithm of the value.
    pub(super) of_logarithm: bool,
    /// If present, the value is clipped between zero and this table.
    pub(super) upper: Option<Regression>,
}

impl Curve {
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
        let upper = self.upper.as_ref().map_or(&[][..], Regression::figures);
        self.figures
            .figures()
            .iter()
            .chain(&self.slope)
            .chain(upper)
            .all(|figure| figure.is_finite())
    }
}

/// Intervals of airspeed in which an airspeed-dependent lead filter is linear.
const LEAD_POINTS: u32 = 100;

impl Scheduled<'_> {
    /// Returns the gain of a channel \[-\].
    pub(super) fn gain(&self, channel: Channel) -> Curve {
        Curve {
            slope: self
                .schedule
                .second
                .as_ref()
                .map(|term| term.slopes[channel]),
            of_logarithm: self.schedule.settings.quantity == ScheduledQuantity::LnGain,
            ..Curve::plain(self.schedule.gains[channel].clone())
        }
    }

    /// Returns the delay of a channel \[s\]; zero if delays are not scheduled.
    pub(super) fn delay_s(&self, channel: Channel) -> Curve {
        let (figures, upper) = match (&self.schedule.leads, &self.schedule.delays) {
            (Some(leads), _) => {
                let airspeeds_kt = vec![self.schedule.airspeeds.min_kt];
                let values = vec![leads.bounds_s[1]];
                (
                    &leads.taus_s[channel],
                    Regression::Table {
                        airspeeds_kt,
                        values,
                    },
                )
            }
            (None, Some(delays)) => (&delays.taus_s[channel], delays.upper_s.clone()),
            (None, None) => return Curve::constant(0.0),
        };
        Curve {
            upper: Some(upper),
            ..Curve::plain(figures.clone())
        }
    }

    /// Returns the time constant `a` of the numerator of a channel's lead filter \[s\]: equal to
    /// `b` without a lead. `None` for a schedule without leads.
    pub(super) fn zero_s(&self, channel: Channel) -> Option<Curve> {
        let leads = self.schedule.leads.as_ref()?;
        let least = self.schedule.airspeeds.min_kt;
        let most = self.schedule.airspeeds.max_kt;
        let figures = &leads.taus_s[channel];
        let at = |kt: f64| {
            let tau_s = figures
                .at(&self.schedule.airspeeds, kt)
                .clamp(leads.bounds_s[0], leads.bounds_s[1]);
            leads
                .design
                .filter(tau_s)
                .map_or(leads.design.lag_s(), |filter| filter.zero_s)
        };
        if figures.figures().len() == 1 || least == most {
            return Some(Curve::constant(at(least)));
        }
        // The numerator for a signed delay is not a polynomial of it.
        let kt = |place: u32| least + (most - least) * f64::from(place) / f64::from(LEAD_POINTS);
        let airspeeds_kt: Vec<f64> = (0..=LEAD_POINTS).map(kt).collect();
        let values = airspeeds_kt.iter().map(|&kt| at(kt)).collect();
        Some(Curve::plain(Regression::Table {
            airspeeds_kt,
            values,
        }))
    }

    /// Returns the remarks on the schedule.
    pub(super) fn notes(&self) -> Vec<String> {
        let unscheduled = "delays are not scheduled in this study: they are zero here".to_owned();
        let (inputs, outputs) = self.dataset.names_of_channels();
        let cautions = self
            .schedule
            .cautions
            .iter()
            .map(|caution| caution.words(&inputs, &outputs));
        let price = self
            .schedule
            .lead_price()
            .map(|price| price.words(&inputs, &outputs));
        let cautions = price.into_iter().chain(cautions);
        (!self.schedule.has_delays())
            .then_some(unscheduled)
            .into_iter()
            .chain(cautions)
            .collect()
    }

    /// Returns the same remarks, and those on parts omitted from the curves.
    pub(super) fn notes_of_curves(&self) -> Vec<String> {
        let is_table = |channel| {
            self.zero_s(channel)
                .is_some_and(|zero_s| zero_s.figures.figures().len() > 1)
        };
        let points = LEAD_POINTS + 1;
        let tables =
            format!("the lead filters are tables over airspeed, linear between {points} points");
        self.notes()
            .into_iter()
            .chain(
                all_channels(self.dataset)
                    .into_iter()
                    .any(is_table)
                    .then_some(tables),
            )
            .collect()
    }

    /// Describes a file with the schedule, line by line, with these notes.
    pub(super) fn heading(&self, notes: &[String]) -> Vec<String> {
        let airspeeds = &self.schedule.airspeeds;
        let what = if self.schedule.has_delays() {
            "Gains and delays"
        } else {
            "Gains (no delays)"
        };
        let mut lines = vec![
            format!("{what} that correct a model of a helicopter, scheduled with airspeed."),
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
        if let Some(leads) = &self.schedule.leads {
            let lag_s = leads.design.lag_s();
            let filter = match leads.design.settings().order.number() {
                1 => "L(s) = (1 + a*s)/(1 + b*s)",
                _ => "L(s) = (1 + sqrt(2)*a*s + a^2*s^2)/(1 + sqrt(2)*b*s + b^2*s^2)",
            };
            lines.extend([
                format!("Lead: each input, after its gain and delay, and each output, before them, passes {filter},"),
                format!(
                    "with b = {} s for all, and a in seconds for each; where a = b there is no lead.",
                    number(lag_s)
                ),
                format!("In fixed-step code use Tustin's rule and a step of at most {} s.", number(0.5 * lag_s)),
            ]);
        }
        if self.couplings.is_some() {
            lines.extend(
                [
                    "Couplings: in place of u1 = Mi*u(t - tau_i), after leads, the model itself gets u2 = mixing*u1 + feedback*ym;",
                    "ym is its output before any correction. Where it has a feed-through D, u2 and ym depend on each other at once:",
                    "solved, u2 = u1m + F*(y0) of u1m = mixing*u1, y0 = C*x + D*u1m, F = feedback*inverse(I - D*feedback).",
                ]
                .map(str::to_owned),
            );
        }
        lines.push(format!("Contains: {}.", self.contents.words()));
        for words in self.contents.left_out_words(self.dataset) {
            lines.push(format!("Left out: {}.", comment(&words)));
        }
        lines.extend(notes.iter().map(|note| format!("Note: {}", comment(note))));
        lines
    }

    /// Rejects numbers that no program can compute with.
    pub(super) fn check(&self) -> Result<(), ExportFault> {
        let (inputs, outputs) = self.dataset.names_of_channels();
        for channel in all_channels(self.dataset) {
            let curves = [
                ("gain", Some(self.gain(channel))),
                ("delay", Some(self.delay_s(channel))),
            ];
            for (curve, of) in curves
                .into_iter()
                .chain([("lead numerator", self.zero_s(channel))])
            {
                if of.is_some_and(|of| !of.is_finite()) {
                    return Err(ExportFault::Curve {
                        channel: channel.name(&inputs, &outputs),
                        curve,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Formats a finite number with 17 significant digits: every language reads back the same value.
pub(super) fn number(value: f64) -> String {
    // Adding zero turns minus zero into zero.
    format!("{:.16e}", value + 0.0)
}
