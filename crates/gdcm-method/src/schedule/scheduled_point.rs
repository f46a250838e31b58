//! Data to which a schedule is fitted.

use crate::correction::ChannelCorrection;

/// A condition with its own optimal correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledPoint<'a> {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub correction: &'a ChannelCorrection,
    /// The condition's upper delay bound \[s\].
    pub delay_upper_s: f64,
    /// The condition's second variable, if available.
    pub second: Option<f64>,
}
