//! Cautions about signed delays that no schedule can reproduce; the limits are those in M15.6. A
//! negative signed delay is a lead.

use gdcm_method::correction::Channel;
use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::schedule::ScheduleCaution;
use gdcm_model::dataset::ConditionId;

use crate::decisions::study::Study;
use crate::results::analysis::Outcomes;
use crate::results::scheduled_conditions::in_schedule;

/// Maximum distance \[s\] that a schedule can reproduce between a signed delay and its mean over
/// the conditions.
const APART_S: f64 = 0.02;
/// Signed delays of smaller magnitude than this \[s\] are negligible, so that their sign says
/// nothing.
const LEAST_DELAY_S: f64 = 2e-3;

/// Returns cautions about the channels for which no schedule can reproduce the signed delays in all
/// conditions. Conditions without leads are left out.
pub(crate) fn signed_delays_apart(study: &Study, outcomes: &Outcomes) -> Vec<ScheduleCaution> {
    let mut leads = Vec::new();
    for result in in_schedule(study, outcomes) {
        if let Some(compensated) = &result.compensated {
            leads.push((result.condition.id(), &compensated.leads));
        }
    }
    Channel::of_dataset(&study.dataset)
        .filter_map(|channel| signed_delay_apart(&leads, channel))
        .collect()
}

/// Returns the caution about a channel, which names the condition farthest from the mean. There is
/// a caution if this condition's distance is too large, or if some conditions need a lead and
/// others a delay, so that the channel would change from one to the other over airspeed; none for
/// fewer than two conditions.
fn signed_delay_apart(
    leads: &[(ConditionId, &ChannelLeads)],
    channel: Channel,
) -> Option<ScheduleCaution> {
    if leads.len() < 2 {
        return None;
    }
    let taus_s: Vec<f64> = leads
        .iter()
        .map(|(_, leads)| leads.taus_s[channel])
        .collect();
    let sum_s: f64 = taus_s.iter().sum();
    let mean_s = sum_s / taus_s.len() as f64;
    let distance_s = |tau_s: f64| (tau_s - mean_s).abs();
    let farthest = (0..taus_s.len())
        .max_by(|a, b| distance_s(taus_s[*a]).total_cmp(&distance_s(taus_s[*b])))?;
    let tau_s = taus_s[farthest];
    let has_delay = taus_s.iter().any(|tau_s| *tau_s > LEAST_DELAY_S);
    let has_lead = taus_s.iter().any(|tau_s| -*tau_s > LEAST_DELAY_S);
    if distance_s(tau_s) > APART_S || (has_delay && has_lead) {
        Some(ScheduleCaution::SignedDelayApart {
            channel,
            condition: leads[farthest].0,
            tau_s,
            // The mean over the other conditions.
            elsewhere_s: (sum_s - tau_s) / (taus_s.len() as f64 - 1.0),
        })
    } else {
        None
    }
}
