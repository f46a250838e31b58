//! Delays over airspeed (M11). Signed delays are in `lead_schedule`.

use super::airspeeds::Airspeeds;
use super::regression::Regression;
use super::scheduled_point::ScheduledPoint;
use super::settings::ScheduleKind;
use crate::correction::Channels;

/// Every channel's delay as a function of airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct DelaySchedule {
    /// Delays by channel \[s\].
    pub taus_s: Channels<Regression>,
    /// The conditions' upper bounds \[s\], interpolated linearly: no scheduled delay exceeds them.
    pub upper_s: Regression,
}

impl DelaySchedule {
    /// Fits the conditions' delays and their upper bounds; needs at least one condition.
    pub(super) fn fit(
        points: &[ScheduledPoint<'_>],
        airspeeds: &Airspeeds,
        kind: ScheduleKind,
    ) -> Self {
        let taus_s = points[0].correction.channels(|channel| {
            let taus_s: Vec<f64> = points
                .iter()
                .map(|point| point.correction.pure_delay_s(channel))
                .collect();
            Regression::fit(airspeeds, &taus_s, kind)
        });
        let bounds_s: Vec<f64> = points.iter().map(|point| point.delay_upper_s).collect();
        Self {
            taus_s,
            upper_s: Regression::table(airspeeds, &bounds_s),
        }
    }

    /// Returns the delays \[s\] at an airspeed \[kt\], limited to the range from zero to the upper
    /// bound.
    pub(super) fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> Channels<f64> {
        let upper_s = self.upper_s.at(airspeeds, airspeed_kt);
        self.taus_s
            .map(|_, tau_s| tau_s.at(airspeeds, airspeed_kt).min(upper_s).max(0.0))
    }
}
