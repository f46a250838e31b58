//! Sentences about the schedule: cautions, and its delays compared with the conditions' own
//! corrections. The schedule gives the correction as a function of airspeed, fitted to the
//! corrections that are optimal in the conditions. A cluster is a group of conditions at equal
//! airspeed.

use gdcm_method::correction::Channel;
use gdcm_method::schedule::ScheduleCaution;
use gdcm_model::dataset::Dataset;
use gdcm_model::units::{s_to_ms, signed, told_apart};
use gdcm_study::results::schedule_losses::DelayedChannel;

/// Note in exported files whose schedule has no delays.
pub const DELAYS_NOT_SCHEDULED: &str = "delays are not scheduled in this study: they are zero here";

/// Describes a caution about the schedule, with these channel names.
pub fn schedule_caution_text(
    caution: &ScheduleCaution,
    inputs: &[String],
    outputs: &[String],
) -> String {
    match caution {
        ScheduleCaution::DegreeLowered { asked, clusters } => format!(
            "degree {asked} needs {} distinct airspeeds, but the conditions have only \
            {clusters}: the degree is lowered to {}",
            asked + 1,
            clusters - 1
        ),
        ScheduleCaution::Overshoot {
            channel,
            between_kt: [low, high],
            airspeed_kt,
            gain,
            range: [least, most],
        } => {
            let name = channel.name(inputs, outputs);
            format!(
                "between {low:.1} and {high:.1} kt the gain of {name} overshoots: {gain:.3} at {airspeed_kt:.1} kt, \
                 where the conditions' gains range from {least:.3} to {most:.3}; lower the degree or use a table"
            )
        }
        ScheduleCaution::SignedDelayApart {
            channel,
            condition,
            tau_s,
            elsewhere_s,
        } => format!(
            "{}: the signed delay is {} ms in condition {condition}, but on average {} ms in \
            the other conditions; it cannot be scheduled over airspeed",
            channel.name(inputs, outputs),
            signed(s_to_ms(*tau_s), 0),
            signed(s_to_ms(*elsewhere_s), 0)
        ),
        ScheduleCaution::NotPositive => {
            "a scheduled gain is not positive at an airspeed between the conditions; schedule ln k, \
            or lower the degree"
                .to_owned()
        }
        ScheduleCaution::CostsMore(cost) => {
            // Rounded to enough digits that both values differ.
            let (scheduled, own) = told_apart(cost.scheduled, cost.own, 0);
            format!(
                "condition {}, model {}: mean on-axis J {scheduled} with the schedule, {own} with the condition's own correction",
                cost.condition, cost.model
            )
        }
    }
}

/// Describes a channel's longest delay, and counts the other conditions with a delay: "delay of
/// output NX: 5.3 ms in condition 4".
pub fn delayed_channel_text(delayed: &DelayedChannel, dataset: &Dataset) -> String {
    let side = match delayed.channel {
        Channel::Input(_) => "input",
        Channel::Output(_) => "output",
    };
    let name = delayed.channel.name_in(dataset);
    let Some(longest) = delayed.delays.first() else {
        return format!("delay of {side} {name}: none");
    };
    let delay_ms = s_to_ms(longest.delay_s);
    let condition = longest.condition;
    match delayed.delays.len() {
        1 => format!("delay of {side} {name}: {delay_ms:.1} ms in condition {condition}"),
        2 => format!(
            "delay of {side} {name}: up to {delay_ms:.1} ms, in condition {condition} and in 1 \
             other"
        ),
        count => format!(
            "delay of {side} {name}: up to {delay_ms:.1} ms, in condition {condition} and in {} \
             others",
            count - 1
        ),
    }
}
