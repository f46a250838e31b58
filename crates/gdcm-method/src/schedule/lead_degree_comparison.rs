//! How well polynomials of each degree fit the signed delays: root mean square differences, with
//! all conditions and with each condition left out (M15.5). A *signed delay* may be negative: it is
//! then a lead.

use gdcm_model::dataset::{Pair, PairTable};

use super::predictions::Predictions;
use super::scheduled_point::ScheduledPoint;
use super::settings::{HIGHEST_DEGREE, ScheduleKind, ScheduleSettings};
use crate::correction::ChannelCorrection;

/// Fits the signed delays with each degree from 0 to [`HIGHEST_DEGREE`]; empty without conditions,
/// or if a condition's correction has no leads.
pub fn compare_lead_degrees(
    points: &[ScheduledPoint<'_>],
    settings: ScheduleSettings,
) -> Vec<LeadDegreeFit> {
    let mut fits = Vec::new();
    if points.iter().any(|point| point.correction.leads.is_none()) {
        return fits;
    }
    for degree in 0..=HIGHEST_DEGREE {
        let settings = ScheduleSettings {
            // Signed delays depend on airspeed only, whatever form the gains have.
            kind: ScheduleKind::Polynomial { degree: 0 },
            tau_degree: degree,
            second: None,
            ..settings
        };
        let Ok(predictions) = Predictions::new(points, settings) else {
            continue;
        };
        fits.push(LeadDegreeFit {
            degree,
            pairs: predictions.by_pair(|pair| net_delay_fit(points, &predictions, pair)),
        });
    }
    fits
}

/// How well polynomials of one degree fit the signed delays.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadDegreeFit {
    pub degree: usize,
    /// Differences by response.
    pub pairs: PairTable<NetDelayFit>,
}

/// Root mean square differences \[s\] between the conditions' own net signed delays and the
/// scheduled ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetDelayFit {
    /// With the schedule fitted to all conditions.
    pub rms_s: f64,
    /// With each condition predicted by the schedule fitted to the others; `None` for the only
    /// condition.
    pub left_out_rms_s: Option<f64>,
}

/// Returns the differences for a response's net signed delay.
fn net_delay_fit(
    points: &[ScheduledPoint<'_>],
    predictions: &Predictions,
    pair: Pair,
) -> NetDelayFit {
    let left_out: Option<Vec<&ChannelCorrection>> =
        predictions.left_out.iter().map(Option::as_ref).collect();
    NetDelayFit {
        rms_s: delay_rms_s(points, &predictions.scheduled, pair),
        left_out_rms_s: left_out.map(|left_out| delay_rms_s(points, left_out, pair)),
    }
}

/// Returns the root mean square difference \[s\] between the conditions' own net signed delays and
/// the predicted delays.
fn delay_rms_s<'a>(
    points: &[ScheduledPoint<'_>],
    predictions: impl IntoIterator<Item = &'a ChannelCorrection>,
    pair: Pair,
) -> f64 {
    let sum = points
        .iter()
        .zip(predictions)
        .map(|(point, prediction)| {
            let error_s = point.correction.net_delay_s(pair) - prediction.net_delay_s(pair);
            error_s.powi(2)
        })
        .sum::<f64>();
    (sum / points.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::correction::Channels;
    use crate::correction::channel_leads::ChannelLeads;
    use crate::correction::lead_design::{LeadDesign, LeadSettings};
    use crate::schedule::test_points::{correction, points};

    #[test]
    fn a_mean_predicts_left_out_delays_worse_than_it_fits() {
        let design = Arc::new(LeadDesign::new(
            LeadSettings::default(),
            [0.5, 3.0, 12.0].into(),
        ));
        let taus_s = [-0.02, -0.03, -0.05];
        let corrections = taus_s.map(|tau_s| ChannelCorrection {
            input_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(
                Arc::clone(&design),
                Channels {
                    inputs: vec![tau_s],
                    outputs: vec![0.01],
                },
            )),
            ..correction(1.0, 1.0)
        });
        let points = points(&[60.0, 90.0, 120.0], &corrections, 0.02);
        let found = compare_lead_degrees(&points, ScheduleSettings::default());
        assert_eq!(found.len(), 1 + HIGHEST_DEGREE);
        // The distance from the mean of the others is 3/2 times the distance from the mean of all.
        let mean = &found[0].pairs[Pair::new(0, 0)];
        assert!((mean.left_out_rms_s.unwrap() / mean.rms_s - 1.5).abs() < 1e-12);
        // The output's signed delay is constant, so the sum has the input's residuals:
        // sqrt((40^2 + 10^2 + 50^2) / 3) / 3 ms.
        assert!((mean.rms_s - 0.0042_f64.sqrt() / 3.0 / 3_f64.sqrt()).abs() < 1e-12);
        assert!(
            found[2].pairs[Pair::new(0, 0)].rms_s < 1e-15,
            "a parabola goes through three points"
        );
        assert!(compare_lead_degrees(&[], ScheduleSettings::default()).is_empty());
    }
}
