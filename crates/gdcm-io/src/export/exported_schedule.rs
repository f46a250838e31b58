//! The schedule in the form exported to programs and tables: each channel's gain, delay and lead
//! filter as curves over airspeed.
//!
//! A lead filter is `(1 + a s) / (1 + b s)`, or second-order with the same time constants. The
//! exported curve is the numerator time constant `a` \[s\] (`zero_s`); `b` (`lag_s`) is a design
//! constant.
//!
//! A *signed delay* is a channel's delay or, if negative, its lead, which a filter provides
//! (M15). The *second variable* is altitude or mass, which may enter the schedule beside
//! airspeed (M13.7).

use gdcm_method::correction::Channel;
use gdcm_method::couplings::CouplingMatrices;
use gdcm_method::schedule::{Regression, Schedule, ScheduledQuantity};
use gdcm_model::dataset::Dataset;
use gdcm_plot::figure::all_channels;

use super::ExportSource;
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;

/// Number of airspeed intervals in the table that approximates a lead filter whose time constant
/// varies with airspeed. More intervals approximate it more closely, but lengthen the files.
pub(super) const LEAD_INTERVALS: u32 = 100;

/// A schedule, with the dataset and the study from which it comes.
#[derive(Clone)]
pub(super) struct ExportedSchedule<'e> {
    pub(super) schedule: &'e Schedule,
    pub(super) dataset: &'e Dataset,
    pub(super) source: &'e ExportSource,
    /// Mixing and feedback, if any.
    pub(super) couplings: Option<&'e CouplingMatrices>,
    /// Correction parts that a file with the schedule contains.
    pub(super) contents: ExportContents,
}

/// A gain, or a time \[s\], over airspeed:
///
/// 1. `regression` over airspeed, plus `slope` times the scaled second variable;
/// 2. the exponential of this sum, if it `is_logarithm`;
/// 3. limited to the range from 0 to `upper`, if there is an upper limit.
pub(super) struct Curve {
    /// Dependence on airspeed: a polynomial in the scaled airspeed, or a table.
    pub(super) regression: Regression,
    /// Coefficient of the scaled second variable; `None` without one.
    pub(super) slope: Option<f64>,
    /// Whether `regression` and `slope` give the value's natural logarithm.
    pub(super) is_logarithm: bool,
    /// Upper limit of the value; the lower limit is then zero. `None` if the value is not limited.
    pub(super) upper: Option<Regression>,
}

impl Curve {
    /// Creates a curve from a regression alone.
    pub(super) fn plain(regression: Regression) -> Self {
        Self {
            regression,
            slope: None,
            is_logarithm: false,
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
        self.regression
            .parameters()
            .iter()
            .chain(&self.slope)
            .chain(upper)
            .all(|parameter| parameter.is_finite())
    }
}

impl ExportedSchedule<'_> {
    /// Returns a channel's gain \[-\].
    pub(super) fn gain(&self, channel: Channel) -> Curve {
        let second = self.schedule.second.as_ref();
        Curve {
            slope: second.map(|term| term.slopes[channel]),
            is_logarithm: self.schedule.settings.quantity == ScheduledQuantity::LnGain,
            ..Curve::plain(self.schedule.gains[channel].clone())
        }
    }

    /// Returns a channel's delay \[s\]: with leads, the signed delay, limited to positive values
    /// ([`Curve::upper`]) because the negative ones are leads (`zero_s`); without leads, the
    /// scheduled delay, or zero if no delays are scheduled.
    pub(super) fn delay_s(&self, channel: Channel) -> Curve {
        if let Some(leads) = &self.schedule.leads {
            // A table with one airspeed is a constant.
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
        let min_kt = self.schedule.airspeeds.min_kt;
        let max_kt = self.schedule.airspeeds.max_kt;
        let is_constant = leads.taus_s[channel].parameters().len() == 1;
        if is_constant || min_kt == max_kt {
            return Some(Curve::constant(self.zero_at_s(channel, min_kt)?));
        }
        // A table, because the numerator time constant is not a polynomial in airspeed even if the
        // signed delay is.
        let mut airspeeds_kt = Vec::new();
        let mut values = Vec::new();
        for point in 0..=LEAD_INTERVALS {
            let airspeed_kt =
                min_kt + (max_kt - min_kt) * f64::from(point) / f64::from(LEAD_INTERVALS);
            airspeeds_kt.push(airspeed_kt);
            values.push(self.zero_at_s(channel, airspeed_kt)?);
        }
        Some(Curve::plain(Regression::Table {
            airspeeds_kt,
            values,
        }))
    }

    /// Returns the numerator time constant \[s\] of a channel's lead filter at an airspeed, or the
    /// denominator's if the signed delay there needs no lead; `None` if the schedule has no leads.
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
        let (inputs, outputs) = self.dataset.input_and_output_names();
        Err(ExportFault::Curve {
            channel: channel.name(&inputs, &outputs),
            curve: quantity,
        })
    }
}
