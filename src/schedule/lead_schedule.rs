//! Signed delays scheduled with airspeed (M15.5).

use std::sync::Arc;

use crate::correction::{ChannelLeads, LeadDesign};

use super::regression::{Airspeeds, Regression};
use super::schedule::ScheduledPoint;

/// Every channel's signed delay as a function of airspeed: sums of regressions are the regression of sums, so the net lead of
/// every response is scheduled exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadSchedule {
    /// Which filter a signed delay has.
    pub design: Arc<LeadDesign>,
    /// Regression of each input's signed delay \[s\].
    pub inputs: Vec<Regression>,
    /// Regression of each output's signed delay \[s\].
    pub outputs: Vec<Regression>,
    /// The widest of the conditions' bounds \[s\]: no scheduled signed delay is outside.
    pub bounds_s: [f64; 2],
    /// The same for all airspeeds, where it is: its filters are computed once.
    constant: Option<ChannelLeads>,
}

impl LeadSchedule {
    /// The schedule of these conditions' signed delays; none where one of them has none.
    pub(super) fn of(points: &[ScheduledPoint<'_>], airspeeds: &Airspeeds, degree: usize) -> Option<Self> {
        let leads =
            points.iter().map(|point| point.correction.leads.as_ref()).collect::<Option<Vec<&ChannelLeads>>>()?;
        let fit = |of: fn(&ChannelLeads) -> &[f64]| -> Vec<Regression> {
            let channels = leads.first().map_or(0, |leads| of(leads).len());
            let figures = |channel: usize| leads.iter().map(|leads| of(leads)[channel]).collect::<Vec<f64>>();
            (0..channels).map(|channel| Regression::polynomial(airspeeds, &figures(channel), degree)).collect()
        };
        let design = Arc::clone(leads.first()?.design());
        let upper_s = points.iter().map(|point| point.delay_upper_s).fold(0.0, f64::max);
        let lower_s = leads.iter().map(|leads| leads.design().lower_s()).fold(0.0, f64::min);
        let (inputs, outputs) = (fit(ChannelLeads::inputs_s), fit(ChannelLeads::outputs_s));
        let mut schedule = Self { design, inputs, outputs, bounds_s: [lower_s, upper_s], constant: None };
        schedule.constant = (schedule.degree() == 0).then(|| schedule.made_at(airspeeds, airspeeds.mean_kt));
        Some(schedule)
    }

    /// Degree of its polynomials.
    pub fn degree(&self) -> usize {
        let channels = self.inputs.iter().chain(&self.outputs);
        channels.map(|regression| regression.figures().len().saturating_sub(1)).max().unwrap_or(0)
    }

    /// The signed delays at an airspeed \[kt\], cut to the bounds.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        self.constant.clone().unwrap_or_else(|| self.made_at(airspeeds, airspeed_kt))
    }

    fn made_at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        let [lower_s, upper_s] = self.bounds_s;
        let cut = |regression: &Regression| regression.at(airspeeds, airspeed_kt).clamp(lower_s, upper_s);
        let of = |channels: &[Regression]| channels.iter().map(cut).collect();
        ChannelLeads::new(Arc::clone(&self.design), of(&self.inputs), of(&self.outputs))
    }
}
