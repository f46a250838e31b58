//! The sentence about a channel that is logged late or early in all records.

use gdcm_model::units::{s_to_ms, telling};
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;

/// Returns the finding in words; `channel` and `physics` name the channel and the physics model.
pub fn time_skew_text(skew: &ChannelTimeSkew, channel: &str, physics: &str) -> String {
    let delay_ms = telling(s_to_ms(skew.delay_s.abs()), 0);
    let direction = if skew.delay_s < 0.0 { "early" } else { "late" };
    format!(
        "{channel} seems to be logged {delay_ms} ms {direction} in all records: compared with the \
        physics model \"{physics}\", its responses differ by a delay, and the other responses do \
        not. This delay can be removed. Keep it if the sensor or servo really has this lag: the \
        correction then contains a delay for it"
    )
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::channel::ChannelSide;

    use super::*;

    #[test]
    fn words_say_what_is_seen_and_what_else_it_may_be() {
        let late = ChannelTimeSkew {
            role: ChannelSide::Output,
            index: 1,
            delay_s: -0.0401,
        };
        let words = time_skew_text(&late, "Q", "nominal");
        assert!(
            words.starts_with(
                "Q seems to be logged 40 ms early in all records: compared with the physics model \"nominal\""
            ),
            "{words}"
        );
        assert!(
            words.contains("Keep it if the sensor or servo really has this lag"),
            "{words}"
        );
    }
}
