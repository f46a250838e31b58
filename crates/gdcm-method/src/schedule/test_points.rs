//! Synthetic corrections for tests.

use super::scheduled_point::ScheduledPoint;
use crate::correction::ChannelCorrection;

/// A correction for a single response, with 10 ms input delay.
pub(super) fn correction(input_gain: f64, output_gain: f64) -> ChannelCorrection {
    ChannelCorrection {
        input_gains: vec![input_gain],
        output_gains: vec![output_gain],
        input_delays_s: vec![0.01],
        output_delays_s: vec![0.0],
        leads: None,
    }
}

/// Pairs corrections with airspeeds \[kt\]; all have the same upper delay bound \[s\].
pub(super) fn points<'a>(
    airspeeds_kt: &[f64],
    corrections: &'a [ChannelCorrection],
    delay_upper_s: f64,
) -> Vec<ScheduledPoint<'a>> {
    airspeeds_kt
        .iter()
        .zip(corrections)
        .map(|(&airspeed_kt, correction)| ScheduledPoint {
            airspeed_kt,
            correction,
            delay_upper_s,
            second: None,
        })
        .collect()
}
