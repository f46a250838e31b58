//! Checks a schedule between its conditions (M11b): a polynomial through few airspeeds can leave
//! the range of the gains to which it is fitted. A *cluster* holds conditions at nearly equal
//! airspeeds, which count as one airspeed; a gain is inspected at 100 steps between neighbouring
//! clusters, and its sign at 100 steps over the whole range.

use super::caution::ScheduleCaution;
use super::channel_schedule::{STEPS, Schedule};
use super::scheduled_point::ScheduledPoint;
use super::settings::ScheduleKind;
use crate::correction::Channel;

/// Distance between a gain and the conditions' range that does not count as an overshoot, relative
/// to the range's width. A compromise: a smaller share reports harmless extremes of a parabola, a
/// larger one misses an oscillation.
const TOLERATED_SHARE: f64 = 0.5;
/// Relative rounding error that does not count as an overshoot where all gains are equal.
const ROUNDING: f64 = 1e-9;

impl Schedule {
    /// Returns whether interpolation between the conditions is unreliable: a gain overshoots
    /// between them, or is not positive.
    pub fn interpolation_fails(&self) -> bool {
        self.cautions.iter().any(|caution| {
            matches!(
                caution,
                ScheduleCaution::Overshoot { .. } | ScheduleCaution::NotPositive
            )
        })
    }

    /// Checks the degree, and every gain between the clusters; `points` are the conditions to which
    /// the schedule is fitted.
    pub(super) fn find_cautions(&self, points: &[ScheduledPoint<'_>]) -> Vec<ScheduleCaution> {
        let mut cautions = Vec::new();
        let clusters = self.airspeeds.clusters.len();
        // n airspeeds determine a polynomial of degree n - 1 at most.
        if let ScheduleKind::Polynomial { degree: asked } = self.settings.kind
            && asked >= clusters
        {
            cautions.push(ScheduleCaution::DegreeLowered { asked, clusters });
        }
        for (channel, _) in self.gains.iter() {
            cautions.extend(self.find_overshoot(points, channel));
        }
        if !self.is_positive() {
            cautions.push(ScheduleCaution::NotPositive);
        }
        cautions
    }

    /// Returns whether all gains are positive over the airspeed range.
    fn is_positive(&self) -> bool {
        (0..=STEPS).all(|step| {
            let correction = self.at(self.step_kt(step));
            correction
                .input_gains
                .iter()
                .chain(&correction.output_gains)
                .all(|gain| *gain > 0.0)
        })
    }

    /// Finds the airspeed between two clusters at which a channel's gain is farthest outside the
    /// conditions' range; `None` if it is outside by at most half that range.
    fn find_overshoot(
        &self,
        points: &[ScheduledPoint<'_>],
        channel: Channel,
    ) -> Option<ScheduleCaution> {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for point in points {
            let gain = point.correction.gain(channel);
            range = [range[0].min(gain), range[1].max(gain)];
        }
        // At first the distance from the range that is tolerated, then the largest distance so far.
        let mut farthest = TOLERATED_SHARE * (range[1] - range[0]) + ROUNDING * range[1];
        let mut found = None;
        for neighbours in self.airspeeds.clusters_kt().windows(2) {
            let between_kt = [neighbours[0], neighbours[1]];
            for step in 1..STEPS {
                let airspeed_kt = between_kt[0]
                    + (between_kt[1] - between_kt[0]) * f64::from(step) / f64::from(STEPS);
                let gain = self.at(airspeed_kt).gain(channel);
                let outside = (range[0] - gain).max(gain - range[1]);
                if outside > farthest {
                    farthest = outside;
                    found = Some(ScheduleCaution::Overshoot {
                        channel,
                        between_kt,
                        airspeed_kt,
                        gain,
                        range,
                    });
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::ScheduleSettings;
    use crate::schedule::test_points::{correction, points};

    /// The schedule with gains 1, 1.1, 1 at these airspeeds \[kt\].
    fn parabola(airspeeds_kt: [f64; 3]) -> Schedule {
        let corrections = [1.0, 1.1, 1.0].map(|gain| correction(gain, gain * gain));
        let points = points(&airspeeds_kt, &corrections, 1.0);
        Schedule::fit(&points, ScheduleSettings::default()).unwrap()
    }

    #[test]
    fn a_parabola_through_two_near_airspeeds_and_a_distant_airspeed_overshoots() {
        assert_eq!(
            parabola([60.0, 90.0, 120.0]).cautions,
            [],
            "within the range between its points"
        );
        // 1 at 60 and 120 kt, 1.1 at 63 kt: ln k = ln 1.1 (v^2 - 1) / (0.9^2 - 1), 1.65 at 90 kt.
        let wild = parabola([60.0, 63.0, 120.0]);
        let ScheduleCaution::Overshoot {
            channel,
            between_kt,
            airspeed_kt,
            gain,
            range,
        } = &wild.cautions[0]
        else {
            panic!("{:?}", wild.cautions);
        };
        assert_eq!(
            (*channel, *between_kt, *range),
            (Channel::Input(0), [63.0, 120.0], [1.0, 1.1])
        );
        assert!(
            (airspeed_kt - 90.0).abs() < 1.0
                && (gain / 1.1_f64.powf(1.0 / 0.19) - 1.0).abs() < 0.01
        );
        assert!(wild.interpolation_fails());
        let lowered = parabola([60.0, 61.0, 120.0]);
        assert_eq!(
            lowered.cautions,
            [ScheduleCaution::DegreeLowered {
                asked: 2,
                clusters: 2
            }]
        );
        assert_eq!(
            (lowered.degree(), lowered.interpolation_fails()),
            (Some(1), false)
        );
    }
}
