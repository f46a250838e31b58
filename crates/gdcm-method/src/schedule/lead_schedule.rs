//! Signed delays over airspeed (M15.5). A negative signed delay is a lead, which a filter realises.

use std::sync::Arc;

use super::airspeeds::Airspeeds;
use super::regression::Regression;
use super::scheduled_point::ScheduledPoint;
use crate::correction::Channels;
use crate::correction::channel_leads::ChannelLeads;
use crate::correction::lead_design::LeadDesign;

/// Every channel's signed delay as a function of airspeed. Two regressions added up are the
/// regression of the sum, so that a response's net signed delay is the regression of the
/// conditions' net signed delays, unless a channel reaches a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadSchedule {
    /// Design that gives the filter for a signed delay.
    pub design: Arc<LeadDesign>,
    /// Signed delays by channel \[s\].
    pub taus_s: Channels<Regression>,
    /// The conditions' widest bounds \[s\], which limit the scheduled signed delays.
    pub bounds_s: [f64; 2],
    /// The leads at all airspeeds if they are constant, so that their filters are computed once.
    constant: Option<ChannelLeads>,
}

impl LeadSchedule {
    /// Fits polynomials with this degree to the conditions' signed delays; `None` without
    /// conditions, or if a condition has no signed delays.
    pub(super) fn fit(
        points: &[ScheduledPoint<'_>],
        airspeeds: &Airspeeds,
        degree: usize,
    ) -> Option<Self> {
        let mut leads: Vec<&ChannelLeads> = Vec::new();
        for point in points {
            leads.push(point.correction.leads.as_ref()?);
        }
        let first = leads.first()?;
        let taus_s = first.taus_s.map(|channel, _| {
            let taus_s: Vec<f64> = leads.iter().map(|leads| leads.taus_s[channel]).collect();
            Regression::polynomial(airspeeds, &taus_s, degree)
        });
        let upper_s = points
            .iter()
            .map(|point| point.delay_upper_s)
            .fold(0.0, f64::max);
        let lower_s = leads
            .iter()
            .map(|leads| leads.design.lower_s())
            .fold(0.0, f64::min);
        let mut schedule = Self {
            design: Arc::clone(&first.design),
            taus_s,
            bounds_s: [lower_s, upper_s],
            constant: None,
        };
        if schedule.degree() == 0 {
            schedule.constant = Some(schedule.evaluate(airspeeds, airspeeds.mean_kt));
        }
        Some(schedule)
    }

    /// Returns the polynomials' maximum degree.
    pub fn degree(&self) -> usize {
        self.taus_s
            .iter()
            .map(|(_, regression)| regression.parameters().len().saturating_sub(1))
            .max()
            .unwrap_or(0)
    }

    /// Returns the leads at an airspeed \[kt\], limited to the bounds.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        match &self.constant {
            Some(leads) => leads.clone(),
            None => self.evaluate(airspeeds, airspeed_kt),
        }
    }

    fn evaluate(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> ChannelLeads {
        let [lower_s, upper_s] = self.bounds_s;
        let taus_s = self.taus_s.map(|_, regression| {
            regression
                .at(airspeeds, airspeed_kt)
                .clamp(lower_s, upper_s)
        });
        ChannelLeads::new(Arc::clone(&self.design), taus_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::correction::lead_design::LeadSettings;
    use crate::schedule::test_points::{correction, points};

    /// Corrections with these signed delays \[s\] in input and output.
    fn corrections(taus_s: &[[f64; 2]]) -> Vec<ChannelCorrection> {
        let design = Arc::new(LeadDesign::new(
            LeadSettings::default(),
            [0.5, 3.0, 12.0].into(),
        ));
        let mut corrections = Vec::new();
        for [input_s, output_s] in taus_s {
            let taus_s = Channels {
                inputs: vec![*input_s],
                outputs: vec![*output_s],
            };
            corrections.push(ChannelCorrection {
                input_delays_s: vec![0.0],
                leads: Some(ChannelLeads::new(Arc::clone(&design), taus_s)),
                ..correction(1.0, 1.0)
            });
        }
        corrections
    }

    #[test]
    fn the_sum_of_two_channels_is_the_regression_of_the_sums() {
        let airspeeds_kt = [60.0, 80.0, 100.0, 130.0];
        let taus_s = [
            [-0.02, -0.03],
            [-0.04, 0.004],
            [-0.01, -0.02],
            [-0.03, -0.05],
        ];
        let corrections = corrections(&taus_s);
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        for degree in 0..=2 {
            let schedule = LeadSchedule::fit(
                &points(&airspeeds_kt, &corrections, 0.01),
                &airspeeds,
                degree,
            )
            .unwrap();
            let sums: Vec<f64> = taus_s
                .iter()
                .map(|[input, output]| input + output)
                .collect();
            let direct = Regression::polynomial(&airspeeds, &sums, degree);
            let at = schedule.at(&airspeeds, 93.0);
            // The same least-squares problem, rounded in another order.
            assert!(
                (at.taus_s.inputs[0] + at.taus_s.outputs[0] - direct.at(&airspeeds, 93.0)).abs()
                    < 1e-15
            );
            assert_eq!(schedule.degree(), degree);
        }
    }

    #[test]
    fn a_scheduled_signed_delay_stays_within_the_widest_bounds() {
        let corrections =
            corrections(&[[-0.09, 0.01], [-0.09, 0.01], [0.01, -0.05], [0.01, -0.05]]);
        let airspeeds_kt = [60.0, 80.0, 100.0, 120.0];
        let airspeeds = Airspeeds::new(airspeeds_kt.to_vec(), 2.0).unwrap();
        let schedule =
            LeadSchedule::fit(&points(&airspeeds_kt, &corrections, 0.01), &airspeeds, 3).unwrap();
        let uncut_s = schedule.taus_s.inputs[0].at(&airspeeds, 110.0);
        assert!(uncut_s > 0.011, "the cubic overshoots: {uncut_s}");
        assert_eq!(schedule.at(&airspeeds, 110.0).taus_s.inputs, [0.01]);
    }
}
