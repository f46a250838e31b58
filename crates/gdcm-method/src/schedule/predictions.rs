//! Scheduled corrections at the fitted conditions, and at each condition when it is left out of the
//! fit (M11).

use gdcm_model::dataset::{Pair, PairTable};

use super::channel_schedule::Schedule;
use super::error::ScheduleError;
use super::scheduled_point::ScheduledPoint;
use super::settings::ScheduleSettings;
use crate::correction::ChannelCorrection;

/// Scheduled corrections at the conditions; there is at least one condition.
pub(super) struct Predictions {
    /// Polynomial degree, possibly less than requested (M11b); `None` for a table.
    pub(super) degree: Option<usize>,
    /// Each condition's correction by the schedule fitted to all conditions.
    pub(super) scheduled: Vec<ChannelCorrection>,
    /// Each condition's correction by the schedule fitted to the other conditions; `None` if that
    /// schedule does not exist.
    pub(super) left_out: Vec<Option<ChannelCorrection>>,
}

impl Predictions {
    /// Fits the schedule to all conditions, and once without each condition.
    ///
    /// # Errors
    /// [`ScheduleError`] if no schedule can be fitted to all conditions.
    pub(super) fn new(
        points: &[ScheduledPoint<'_>],
        settings: ScheduleSettings,
    ) -> Result<Self, ScheduleError> {
        let schedule = Schedule::fit_unchecked(points, settings)?;
        let scheduled = points
            .iter()
            .map(|point| schedule.evaluate(point.airspeed_kt, point.second))
            .collect();
        let mut left_out = Vec::with_capacity(points.len());
        for (omitted, point) in points.iter().enumerate() {
            let others = [&points[..omitted], &points[omitted + 1..]].concat();
            left_out.push(match Schedule::fit_unchecked(&others, settings) {
                Ok(schedule) => Some(schedule.evaluate(point.airspeed_kt, point.second)),
                Err(_) => None,
            });
        }
        Ok(Self {
            degree: schedule.degree(),
            scheduled,
            left_out,
        })
    }

    /// Fills a table with a value for each response.
    pub(super) fn by_pair<T>(&self, value: impl FnMut(Pair) -> T) -> PairTable<T> {
        let first = &self.scheduled[0];
        PairTable::from_fn(first.output_gains.len(), first.input_gains.len(), value)
    }
}
