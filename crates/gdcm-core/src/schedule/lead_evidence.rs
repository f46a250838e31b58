//! What speaks for one degree of the scheduled signed delays or another (M11, M15.5).

use crate::correction::{Channel, ChannelLeads};
use crate::dataset::{Pair, PairTable};

use super::lead_schedule::LeadSchedule;
use super::regression::Airspeeds;
use super::schedule::{HIGHEST_DEGREE, ScheduleSettings, ScheduledPoint};

/// How far a schedule of signed delays is from those of the conditions: roots of mean squares \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadFit {
    /// Of the conditions that it is made of.
    pub rms_s: f64,
    /// Leave-one-condition-out: of each condition, by the schedule of the others; none of a single condition.
    pub left_out_rms_s: Option<f64>,
}

/// What one degree makes of the signed delays.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadEvidence {
    /// The degree asked for.
    pub degree: usize,
    /// Of each input channel.
    pub inputs: Vec<LeadFit>,
    /// Of each output channel.
    pub outputs: Vec<LeadFit>,
    /// Of the net signed delay of each response, `tau_o + tau_i`.
    pub pairs: PairTable<LeadFit>,
}

/// The evidence for each degree from 0 to [`HIGHEST_DEGREE`]; none at all where the conditions' corrections have no leads.
pub fn lead_evidence(points: &[ScheduledPoint<'_>], settings: ScheduleSettings) -> Vec<LeadEvidence> {
    let own: Option<Vec<&ChannelLeads>> = points.iter().map(|point| point.correction.leads.as_ref()).collect();
    let Some(own) = own.filter(|own| !own.is_empty()) else { return Vec::new() };
    (0..=HIGHEST_DEGREE).filter_map(|degree| of_degree(points, &own, settings, degree)).collect()
}

/// The signed delays that the schedule of some conditions says at each airspeed \[kt\].
fn predicted(
    points: &[ScheduledPoint<'_>],
    at_kt: &[f64],
    settings: ScheduleSettings,
    degree: usize,
) -> Option<Vec<ChannelLeads>> {
    let airspeeds_kt = points.iter().map(|point| point.airspeed_kt).collect();
    let airspeeds = Airspeeds::new(airspeeds_kt, settings.airspeed_tolerance_kt)?;
    let schedule = LeadSchedule::of(points, &airspeeds, degree)?;
    Some(at_kt.iter().map(|&kt| schedule.at(&airspeeds, kt)).collect())
}

fn of_degree(
    points: &[ScheduledPoint<'_>],
    own: &[&ChannelLeads],
    settings: ScheduleSettings,
    degree: usize,
) -> Option<LeadEvidence> {
    let at_kt: Vec<f64> = points.iter().map(|point| point.airspeed_kt).collect();
    let scheduled = predicted(points, &at_kt, settings, degree)?;
    let unseen = (0..points.len()).map(|left_out| {
        let others: Vec<ScheduledPoint<'_>> =
            points[..left_out].iter().chain(&points[left_out + 1..]).copied().collect();
        predicted(&others, &at_kt[left_out..=left_out], settings, degree)?.pop()
    });
    let unseen: Option<Vec<ChannelLeads>> = unseen.collect();
    let fit = |tau_s: &dyn Fn(&ChannelLeads) -> f64| {
        let rms_s = |found: &[ChannelLeads]| {
            let squares = own.iter().zip(found).map(|(own, found)| (tau_s(own) - tau_s(found)).powi(2));
            (squares.sum::<f64>() / own.len() as f64).sqrt()
        };
        LeadFit { rms_s: rms_s(&scheduled), left_out_rms_s: unseen.as_deref().map(rms_s) }
    };
    let (inputs, outputs) = (own[0].inputs_s().len(), own[0].outputs_s().len());
    let of_channel = |channel: Channel| fit(&move |leads| leads.tau_s(channel));
    let of_pair = |pair: Pair| {
        fit(&move |leads| leads.tau_s(Channel::Output(pair.output)) + leads.tau_s(Channel::Input(pair.input)))
    };
    Some(LeadEvidence {
        degree,
        inputs: (0..inputs).map(|input| of_channel(Channel::Input(input))).collect(),
        outputs: (0..outputs).map(|output| of_channel(Channel::Output(output))).collect(),
        pairs: PairTable::from_fn(outputs, inputs, of_pair),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::{ChannelCorrection, LeadDesign, LeadSettings};

    #[test]
    fn a_mean_leaves_out_worse_than_it_fits_by_the_number_of_conditions() {
        let design = std::sync::Arc::new(LeadDesign::new(LeadSettings::default(), [0.5, 3.0, 12.0].into()));
        let taus_s = [-0.02, -0.03, -0.05];
        let corrections = taus_s.map(|tau_s| ChannelCorrection {
            input_gains: vec![1.0],
            output_gains: vec![1.0],
            input_delays_s: vec![0.0],
            output_delays_s: vec![0.0],
            leads: Some(ChannelLeads::new(std::sync::Arc::clone(&design), vec![tau_s], vec![0.01])),
        });
        let points: Vec<ScheduledPoint<'_>> = [60.0, 90.0, 120.0]
            .into_iter()
            .zip(&corrections)
            .map(|(airspeed_kt, correction)| ScheduledPoint {
                airspeed_kt,
                correction,
                delay_upper_s: 0.02,
                second: None,
            })
            .collect();
        let found = lead_evidence(&points, ScheduleSettings::default());
        assert_eq!(found.len(), 1 + HIGHEST_DEGREE);
        // The mean of the others misses by 3/2 of what the mean of all misses.
        let [mean, input] = [&found[0].pairs[Pair::new(0, 0)], &found[0].inputs[0]];
        assert!((mean.left_out_rms_s.unwrap() / mean.rms_s - 1.5).abs() < 1e-12);
        // The output's is the same everywhere, so that the sum is missed like the input's: sqrt((40^2 + 10^2 + 50^2) / 3) / 3 ms.
        assert!(
            (mean.rms_s - input.rms_s).abs() < 1e-15
                && (mean.rms_s - 0.0042_f64.sqrt() / 3.0 / 3_f64.sqrt()).abs() < 1e-12
        );
        assert!(found[2].inputs[0].rms_s < 1e-15, "a parabola goes through three points");
        assert!(lead_evidence(&[], ScheduleSettings::default()).is_empty());
    }
}
