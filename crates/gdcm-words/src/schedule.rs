//! Sentences that compare the schedule with the conditions' own corrections.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::Dataset;
use gdcm_model::units::s_to_ms;
use gdcm_study::results::schedule_losses::DelayedChannel;

/// Describes the longest delay of a channel, and the number of other conditions with a delay:
/// "delay of output NX: 5.3 ms in condition 4".
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
