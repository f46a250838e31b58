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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::{ChannelCorrection, LeadSettings};

    fn corrections(taus_s: &[[f64; 2]]) -> Vec<ChannelCorrection> {
        let design = Arc::new(LeadDesign::new(LeadSettings::default(), [0.5, 3.0, 12.0].into()));
        let of = |&[input_s, output_s]: &[f64; 2]| ChannelCorrection {
            input_gains: vec![1.0],
            output_gains: vec![1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(Arc::clone(&design), vec![input_s], vec![output_s])),
        };
        taus_s.iter().map(of).collect()
    }

    fn points<'a>(airspeeds_kt: &[f64], corrections: &'a [ChannelCorrection]) -> Vec<ScheduledPoint<'a>> {
        let pairs = airspeeds_kt.iter().zip(corrections);
        pairs
            .map(|(&airspeed_kt, correction)| ScheduledPoint {
                airspeed_kt,
                correction,
                delay_upper_s: 0.01,
                second: None,
            })
            .collect()
    }

    #[test]
    fn the_sum_of_two_channels_is_the_regression_of_the_sums() {
        let airspeeds_kt = [60.0, 80.0, 100.0, 130.0];
        let taus_s = [[-0.02, -0.03], [-0.04, 0.004], [-0.01, -0.02], [-0.03, -0.05]];
        let corrections = corrections(&taus_s);
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        for degree in 0..=2 {
            let schedule = LeadSchedule::of(&points(&airspeeds_kt, &corrections), &airspeeds, degree).unwrap();
            let sums: Vec<f64> = taus_s.iter().map(|[input, output]| input + output).collect();
            let direct = Regression::polynomial(&airspeeds, &sums, degree);
            let at = schedule.at(&airspeeds, 93.0);
            // Least squares in another order of rounding.
            assert!((at.inputs_s()[0] + at.outputs_s()[0] - direct.at(&airspeeds, 93.0)).abs() < 1e-15);
            assert_eq!(schedule.degree(), degree);
        }
    }

    #[test]
    fn a_scheduled_signed_delay_stays_within_the_widest_bounds() {
        let corrections = corrections(&[[-0.09, 0.01], [-0.09, 0.01], [0.01, -0.05], [0.01, -0.05]]);
        let airspeeds_kt = [60.0, 80.0, 100.0, 120.0];
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        let schedule = LeadSchedule::of(&points(&airspeeds_kt, &corrections), &airspeeds, 3).unwrap();
        let uncut_s = schedule.inputs[0].at(&airspeeds, 110.0);
        assert!(uncut_s > 0.011, "the cubic swings over: {uncut_s}");
        assert_eq!(schedule.at(&airspeeds, 110.0).inputs_s(), [0.01]);
    }
}
