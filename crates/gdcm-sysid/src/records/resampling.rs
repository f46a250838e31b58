//! Resamples columns with separate clocks to a common clock (M14.11).
//!
//! A *topic* is a group of columns that share stamps of their own. An input is *held* if it keeps
//! its value until the next sample, as a digital command does.

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::FlightRecord;

use super::common_clock::CommonClock;
use super::layout_note::{LayoutNote, LoggedRate};
use super::record_channels::{RecordChannels, ResamplingSettings};
use super::record_layout::{ChannelUse, RecordLayout};
use super::record_table::{RecordColumn, RecordTable};
use super::resampling_error::ResamplingError;
use super::sample_step::median_step;
use super::stamped_channel::{StampedChannel, is_held};

/// The table is taken to combine several clocks if a missing sample follows more than this share of
/// a column's samples.
const SHARE_OF_HOLES: f64 = 0.1;
/// Largest deviation from a multiple of the median step at which a step is even, relative to the
/// median step.
const JITTER: f64 = 0.2;
/// Minimum share of even steps at which a clock counts as even.
const SHARE_OF_EVEN_STEPS: f64 = 0.95;

/// Chosen columns, and the clock to which they are resampled.
pub(super) struct Resampling {
    /// The inputs, then the outputs.
    channels: Vec<StampedChannel>,
    /// Number of inputs, which come first in `channels`.
    inputs: usize,
    /// Inputs, by name, that are held constant between their samples.
    held: Vec<String>,
    clock: CommonClock,
}

/// A channel, and the column from which its samples are taken.
struct ChannelColumn<'r> {
    channel: ChannelUse<'r>,
    /// Factor from column values to channel values, including sign and the chosen remedy.
    gain: f64,
    /// Logging delay to remove \[s\].
    delay_s: f64,
    column: &'r RecordColumn,
}

impl RecordLayout {
    /// Returns whether the chosen columns have several clocks, or a rate is requested; the record
    /// is then resampled to a common clock. `false` while a channel has no column.
    pub fn is_resampled(&self, table: &RecordTable, channels: &RecordChannels) -> bool {
        Resampling::new(self, table, channels).is_some()
    }
}

impl Resampling {
    /// Chooses a common clock for the chosen columns.
    ///
    /// ```text
    /// 1  several clocks: topics with different or uneven stamps, columns with and without a topic,
    ///    or samples missing repeatedly; or a requested rate
    /// 2  each channel by itself: its stamps less its delay, its values, whether it is held
    /// 3  the common clock, restricted to the part of the record that is used
    /// ```
    ///
    /// Returns `None` if step 1 finds no reason to resample, or if the time or a channel's column
    /// is not yet chosen.
    ///
    /// # Errors
    /// The reason why the columns cannot be resampled.
    pub(super) fn new(
        layout: &RecordLayout,
        table: &RecordTable,
        channels: &RecordChannels,
    ) -> Option<Result<Self, ResamplingError>> {
        // Step 1.
        let chosen = channel_columns(layout, table, channels)?;
        let settings = &channels.resampling;
        let has_several_clocks =
            has_separate_clocks(&chosen) || chosen.iter().any(|c| has_holes(&c.column.values));
        if chosen.is_empty() || !(has_several_clocks || settings.rate_hz.is_some()) {
            return None;
        }
        // Step 2.
        let table_time_s = layout.time?.times_s(table);
        let mut held = Vec::new();
        let mut stamped = Vec::new();
        for chosen in &chosen {
            let name = &chosen.channel.rule.name;
            let stamps = chosen.stamps(&table_time_s);
            let values = chosen.values();
            let is_held = chosen.is_held(&values, settings);
            if is_held {
                held.push(name.clone());
            }
            match StampedChannel::new(name, &stamps, &values, is_held) {
                Ok(channel) => stamped.push(channel),
                Err(error) => return Some(Err(error)),
            }
        }
        // Step 3.
        let clock = match CommonClock::choose(&stamped, settings.band_end, settings.rate_hz) {
            Ok(clock) => clock,
            Err(error) => return Some(Err(error)),
        };
        Some(Ok(Self {
            channels: stamped,
            inputs: layout.inputs.len(),
            held,
            clock: match table.part_s {
                Some(part_s) => clock.within(part_s),
                None => clock,
            },
        }))
    }

    /// Returns notes on the sample rates, the low-pass filter and the held inputs.
    pub(super) fn notes(&self) -> Vec<LayoutNote> {
        let mut logged = Vec::with_capacity(self.channels.len());
        for channel in &self.channels {
            logged.push(LoggedRate {
                channel: channel.name.clone(),
                rate_hz: channel.rate_hz,
            });
        }
        let mut notes = vec![LayoutNote::Resampled {
            rate_hz: self.clock.rate_hz,
            cut_off_rad_s: self.clock.cutoff,
            logged,
        }];
        if !self.held.is_empty() {
            notes.push(LayoutNote::Held {
                channels: self.held.clone(),
            });
        }
        notes
    }

    /// Returns the record on the common clock; NaN in each channel's gaps.
    pub(super) fn flight_record(&self, name: String) -> FlightRecord {
        let time_s = self.clock.times_s();
        let (inputs, outputs) = self.channels.split_at(self.inputs);
        FlightRecord {
            name,
            inputs: self.samples(inputs, &time_s),
            outputs: self.samples(outputs, &time_s),
            time_s,
        }
    }

    /// Returns the low-pass filtered samples at `time_s`, one column per channel.
    fn samples(&self, channels: &[StampedChannel], time_s: &[f64]) -> DMatrix<f64> {
        let values: Vec<f64> = channels
            .iter()
            .flat_map(|channel| channel.at(time_s, self.clock.cutoff))
            .collect();
        DMatrix::from_vec(time_s.len(), channels.len(), values)
    }
}

impl ChannelColumn<'_> {
    /// Returns the stamps from the column's topic, or from the table if the column has no topic,
    /// minus the delay \[s\].
    fn stamps(&self, table_time_s: &[f64]) -> Vec<f64> {
        let stamps = match &self.column.topic {
            Some(topic) => topic.time_s.as_slice(),
            None => table_time_s,
        };
        stamps.iter().map(|time| time - self.delay_s).collect()
    }

    /// Returns the samples in the channel's unit.
    fn values(&self) -> Vec<f64> {
        self.column
            .values
            .iter()
            .map(|value| value * self.gain)
            .collect()
    }

    /// Returns whether the channel is an input that is held between its samples, by request or by
    /// its repeated values.
    fn is_held(&self, values: &[f64], settings: &ResamplingSettings) -> bool {
        self.channel.side == ChannelSide::Input
            && (settings.held.contains(&self.channel.rule.name) || is_held(values))
    }
}

/// Returns every channel with its column; `None` if a channel has no column.
fn channel_columns<'r>(
    layout: &RecordLayout,
    table: &'r RecordTable,
    channels: &'r RecordChannels,
) -> Option<Vec<ChannelColumn<'r>>> {
    let mut chosen = Vec::new();
    for channel in layout.uses(channels) {
        let used = channel.used?;
        chosen.push(ChannelColumn {
            channel,
            gain: used.gain(),
            delay_s: used.remedy.delay_s,
            column: table.columns.get(used.column)?,
        });
    }
    Some(chosen)
}

/// Returns whether columns have topics with different or uneven clocks, or only some columns have a
/// topic.
fn has_separate_clocks(chosen: &[ChannelColumn]) -> bool {
    let clocks: Vec<&[f64]> = chosen
        .iter()
        .filter_map(|chosen| chosen.column.topic.as_ref())
        .map(|topic| topic.time_s.as_slice())
        .collect();
    if clocks.is_empty() {
        return false;
    }
    let is_one_clock = clocks.windows(2).all(|pair| pair[0] == pair[1]);
    !is_one_clock || clocks.len() < chosen.len() || !is_even(clocks[0])
}

/// Returns whether samples are missing repeatedly, as in a table that joins rows from several
/// clocks.
pub(super) fn has_holes(values: &[f64]) -> bool {
    let holes = values
        .windows(2)
        .filter(|pair| pair[0].is_finite() && !pair[1].is_finite())
        .count();
    holes as f64 > SHARE_OF_HOLES * values.len() as f64
}

/// Returns whether at least 95 % of the steps differ from positive multiples of the median step by
/// at most 20 % of it (M14.1).
fn is_even(time_s: &[f64]) -> bool {
    let Some(median) = median_step(time_s) else {
        return false;
    };
    if median <= 0.0 {
        return false;
    }
    let even = time_s
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / median)
        .filter(|steps| (steps - steps.round().max(1.0)).abs() <= JITTER)
        .count();
    even as f64 >= SHARE_OF_EVEN_STEPS * (time_s.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use gdcm_model::names::channel_rule::ChannelRule;

    use super::*;
    use crate::records::layout_problem::LayoutProblem;
    use crate::records::layout_proposal::TimeSettings;
    use crate::records::record_table::TopicClock;

    fn signal(t: f64) -> f64 {
        (3.0 * t).sin()
    }

    fn channels() -> RecordChannels {
        RecordChannels {
            inputs: vec![ChannelRule::named("M")],
            outputs: vec![ChannelRule::named("q")],
            resampling: ResamplingSettings {
                band_end: Some(12.0),
                ..ResamplingSettings::default()
            },
            ..RecordChannels::default()
        }
    }

    fn topic(name: &str, rate_hz: f64, from_s: f64) -> RecordColumn {
        let time_s: Vec<f64> = (0..(20.0 * rate_hz) as usize)
            .map(|k| from_s + k as f64 / rate_hz)
            .collect();
        let values = time_s.iter().map(|t| signal(*t)).collect();
        let clock = TopicClock {
            name: name.to_owned(),
            time_s,
        };
        RecordColumn {
            topic: Some(Arc::new(clock)),
            ..RecordColumn::new(name, values)
        }
    }

    fn flight(table: &RecordTable, channels: &RecordChannels) -> FlightRecord {
        let proposal = RecordLayout::proposed(table, channels, &TimeSettings::default());
        assert_eq!(proposal.problems, []);
        proposal.layout.flight_record(table, channels).unwrap()
    }

    /// Asserts the names and the rates \[Hz\] of channels, to 0.05 Hz.
    fn assert_rates(logged: &[LoggedRate], expected: [(&str, f64); 2]) {
        assert_eq!(logged.len(), expected.len());
        for (found, (channel, rate_hz)) in logged.iter().zip(expected) {
            assert_eq!(found.channel, channel);
            assert!((found.rate_hz - rate_hz).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn topics_with_separate_clocks_become_a_record_with_a_note() {
        let table = RecordTable::new("log", vec![topic("M", 250.0, 0.3), topic("q", 100.0, 0.0)]);
        let notes = RecordLayout::proposed(&table, &channels(), &TimeSettings::default()).notes;
        let Some(LayoutNote::Resampled {
            rate_hz,
            cut_off_rad_s,
            logged,
        }) = notes.last()
        else {
            panic!("{notes:?}")
        };
        assert!((rate_hz - 50.93).abs() < 0.005, "{rate_hz}");
        assert!((cut_off_rad_s - 80.0).abs() < 0.05, "{cut_off_rad_s}");
        assert_rates(logged, [("M", 250.0), ("q", 100.0)]);
        let flight = flight(&table, &channels());
        assert_eq!(flight.time_s[0], 0.3);
        let middle = flight.time_s.len() / 2;
        for (name, samples) in [("M", &flight.inputs), ("q", &flight.outputs)] {
            let error = samples[(middle, 0)] - signal(flight.time_s[middle]);
            // The signal at 3 rad/s is far below the cut-off, so that the low-pass hardly changes
            // it.
            assert!(error.abs() < 1e-3, "{name}: {error}");
        }
    }

    #[test]
    fn a_topic_too_slow_for_the_band_is_refused() {
        let table = RecordTable::new("log", vec![topic("M", 250.0, 0.0), topic("q", 4.0, 0.0)]);
        let channels = channels();
        let proposal = RecordLayout::proposed(&table, &channels, &TimeSettings::default());
        assert!(proposal.layout.flight_record(&table, &channels).is_err());
        let [
            LayoutProblem::Topics(ResamplingError::TooSlow {
                topic,
                rate_hz,
                needed_hz,
                band_end,
                possible,
            }),
        ] = proposal.problems.as_slice()
        else {
            panic!("{:?}", proposal.problems);
        };
        assert_eq!(topic, "q");
        assert_eq!(*band_end, 12.0);
        assert!((rate_hz - 4.0).abs() < 1e-9, "{rate_hz}");
        assert!((needed_hz - 6.4).abs() < 0.05, "{needed_hz}");
        assert!((possible - 7.54).abs() < 0.005, "{possible}");
    }

    #[test]
    fn an_outer_join_with_holes_is_taken_apart_again() {
        let mut t = Vec::new();
        let mut m = Vec::new();
        let mut q = Vec::new();
        for k in 0..5000_u32 {
            let time = 0.004 * f64::from(k);
            t.push(time);
            m.push(if k % 2 == 0 { signal(time) } else { f64::NAN });
            q.push(if k % 5 == 0 { signal(time) } else { f64::NAN });
        }
        let columns = vec![
            RecordColumn::new("t", t),
            RecordColumn::new("M", m),
            RecordColumn::new("q", q),
        ];
        let table = RecordTable::new("joined", columns);
        let notes = RecordLayout::proposed(&table, &channels(), &TimeSettings::default()).notes;
        let resampled = notes.iter().find_map(|note| match note {
            LayoutNote::Resampled { logged, .. } => Some(logged),
            _ => None,
        });
        assert_rates(resampled.unwrap(), [("M", 125.0), ("q", 50.0)]);
        let flight = flight(&table, &channels());
        assert!(flight.outputs.iter().all(|value| value.is_finite()));
        assert!(flight.inputs.iter().all(|value| value.is_finite()));
    }

    #[test]
    fn a_record_with_an_even_clock_is_unchanged_unless_a_rate_is_requested() {
        let stamps: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let values: Vec<f64> = stamps.iter().map(|t| signal(*t)).collect();
        let columns = vec![
            RecordColumn::new("t", stamps.clone()),
            RecordColumn::new("M", values.clone()),
            RecordColumn::new("q", values),
        ];
        let table = RecordTable::new("log", columns);
        let mut channels = channels();
        assert_eq!(flight(&table, &channels).time_s, stamps);
        channels.resampling.rate_hz = Some(50.0);
        assert_eq!(flight(&table, &channels).time_s.len(), 500);
    }

    #[test]
    fn a_part_of_a_record_is_cut_by_its_own_clock() {
        let stamps: Vec<f64> = (0..1000).map(|k| 5.0 + 0.01 * f64::from(k)).collect();
        let columns = ["t", "M", "q"].map(|name| RecordColumn::new(name, stamps.clone()));
        let plain = RecordTable::new("log", columns.to_vec()).part_of_time([6.0, 8.0]);
        let topics = RecordTable::new("log", vec![topic("M", 250.0, 0.0), topic("q", 100.0, 0.0)])
            .part_of_time([6.0, 8.0]);
        assert_eq!(plain.name, "log, 6 to 8 s");
        for table in [plain, topics] {
            let flight = flight(&table, &channels());
            let first = flight.time_s[0];
            let last = flight.time_s[flight.time_s.len() - 1];
            assert!((first - 6.0).abs() < 0.02, "{first}");
            assert!((last - 8.0).abs() < 0.02, "{last}");
            assert_eq!(flight.outputs.nrows(), flight.time_s.len());
        }
    }
}
