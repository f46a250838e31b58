//! Resampling of chosen columns with separate clocks to a common clock (M14.11).

use std::collections::BTreeSet;
use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::FlightRecord;
use gdcm_model::units::telling;

use super::record_channels::RecordChannels;
use super::record_layout::{ColumnUse, RecordLayout};
use super::record_table::{RecordColumn, RecordTable, TopicClock, median_step};
use crate::identification::topics::{CommonClock, Topic, TopicError, is_held};

/// Settings for the combination of topics with separate clocks into one record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResamplingWish {
    /// Upper end of the record's band of interest \[rad/s\]; `None` if unknown.
    pub band_end: Option<f64>,
    /// Sample rate \[Hz\], also applied to records with one clock; `None` leaves those unchanged
    /// and resamples topics by the rule.
    pub rate_hz: Option<f64>,
    /// Inputs treated as constant between logged samples, whatever their samples look like.
    pub held: BTreeSet<String>,
}

/// Fraction of a column's samples followed by a hole, above which the table counts as a join of
/// several clocks.
const SHARE_OF_HOLES: f64 = 0.1;

/// The chosen columns of a table, and their common clock.
pub(super) struct Resampling {
    /// The inputs, then the outputs.
    topics: Vec<Topic>,
    inputs: usize,
    held: Vec<String>,
    clock: CommonClock,
}

impl RecordLayout {
    /// Whether the chosen columns have several clocks, or a rate is requested; the record then has
    /// a new clock.
    pub fn is_resampled(&self, table: &RecordTable, channels: &RecordChannels) -> bool {
        Resampling::of(self, table, channels).is_some()
    }
}

impl Resampling {
    /// Prepares the resampling of the chosen columns to a common clock; `None` if they already have
    /// one, or if a column or the time is still open.
    ///
    /// # Errors
    /// The reason why they cannot be resampled.
    pub(super) fn of(
        layout: &RecordLayout,
        table: &RecordTable,
        channels: &RecordChannels,
    ) -> Option<Result<Self, TopicError>> {
        let wish = &channels.resampling;
        let mut chosen: Vec<(ChannelSide, &ChannelRule, ColumnUse, &RecordColumn)> = Vec::new();
        for (side, rule, used) in layout.uses(channels) {
            let used = used?;
            chosen.push((side, rule, used, table.columns.get(used.column)?));
        }
        let own: Vec<Arc<TopicClock>> = chosen
            .iter()
            .filter_map(|(.., column)| column.topic.clone())
            .collect();
        let one_clock = own.windows(2).all(|pair| pair[0].time_s == pair[1].time_s);
        let of_topics =
            !own.is_empty() && (!one_clock || own.len() < chosen.len() || !is_even(&own[0].time_s));
        let with_holes = chosen.iter().any(|(.., column)| has_holes(&column.values));
        if chosen.is_empty() || !(of_topics || with_holes || wish.rate_hz.is_some()) {
            return None;
        }
        let of_table = layout.time?.times_s(table);
        let mut held = Vec::new();
        let topics = chosen.iter().map(|(side, rule, used, column)| {
            let stamps = column
                .topic
                .as_ref()
                .map_or(&of_table, |topic| &topic.time_s);
            let stamps: Vec<f64> = stamps
                .iter()
                .map(|time| time - used.remedy.delay_s)
                .collect();
            let values: Vec<f64> = column
                .values
                .iter()
                .map(|value| value * used.gain())
                .collect();
            let holds =
                *side == ChannelSide::Input && (wish.held.contains(&rule.name) || is_held(&values));
            held.extend(holds.then(|| rule.name.clone()));
            Topic::new(&rule.name, &stamps, &values, holds)
        });
        let topics: Result<Vec<Topic>, TopicError> = topics.collect();
        Some(topics.and_then(|topics| {
            let clock = CommonClock::choose(&topics, wish.band_end, wish.rate_hz)?;
            let clock = table.part_s.map_or(clock, |part| clock.within(part));
            Ok(Self {
                topics,
                inputs: layout.inputs.len(),
                held,
                clock,
            })
        }))
    }

    /// Returns a description of the resampling.
    pub(super) fn words(&self) -> Vec<String> {
        let rates: Vec<String> = self
            .topics
            .iter()
            .map(|topic| format!("{} {} Hz", topic.name, telling(topic.rate_hz, 1)))
            .collect();
        let resampled = format!(
            "resampled to {} Hz, every channel through the same low-pass at {} rad/s (logged: {})",
            telling(self.clock.rate_hz, 2),
            telling(self.clock.cutoff, 1),
            rates.join(", ")
        );
        let held = (!self.held.is_empty()).then(|| {
            format!(
                "{}: taken as held from sample to sample, so moved half a sample later",
                self.held.join(", ")
            )
        });
        std::iter::once(resampled).chain(held).collect()
    }

    /// Returns the record on the common clock; NaN in the gaps of each topic.
    pub(super) fn flight_record(&self, name: String) -> FlightRecord {
        let time_s = self.clock.times_s();
        let matrix = |topics: &[Topic]| {
            let values: Vec<f64> = topics
                .iter()
                .flat_map(|topic| topic.at(&time_s, self.clock.cutoff))
                .collect();
            DMatrix::from_vec(time_s.len(), topics.len(), values)
        };
        let (inputs, outputs) = self.topics.split_at(self.inputs);
        FlightRecord {
            name,
            inputs: matrix(inputs),
            outputs: matrix(outputs),
            time_s,
        }
    }
}

/// Whether samples are missing repeatedly, as in a table that joins the rows of several clocks.
pub(super) fn has_holes(values: &[f64]) -> bool {
    let begin = values
        .windows(2)
        .filter(|pair| pair[0].is_finite() && !pair[1].is_finite())
        .count();
    begin as f64 > SHARE_OF_HOLES * values.len() as f64
}

/// Whether 95 % of the steps are within 20 % of the median step or of a multiple of it (M14, 1.1).
fn is_even(time_s: &[f64]) -> bool {
    let Some(middle) = median_step(time_s).filter(|step| *step > 0.0) else {
        return false;
    };
    let steps = time_s.windows(2).map(|pair| (pair[1] - pair[0]) / middle);
    let even = steps
        .filter(|step| (step - step.round().max(1.0)).abs() <= 0.2)
        .count();
    even as f64 >= 0.95 * (time_s.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::layout_proposal::{LayoutProposal, TimeWish};

    fn signal(t: f64) -> f64 {
        (3.0 * t).sin()
    }

    fn channels() -> RecordChannels {
        RecordChannels {
            inputs: vec![ChannelRule::named("M")],
            outputs: vec![ChannelRule::named("q")],
            resampling: ResamplingWish {
                band_end: Some(12.0),
                ..ResamplingWish::default()
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

    fn proposed(
        table: &RecordTable,
        channels: &RecordChannels,
    ) -> (Vec<String>, Vec<String>, Option<FlightRecord>) {
        let LayoutProposal {
            layout,
            notes,
            problems,
            ..
        } = RecordLayout::proposed(table, channels, &TimeWish::default());
        (
            notes,
            problems.iter().map(ToString::to_string).collect(),
            layout.flight_record(table, channels).ok(),
        )
    }

    #[test]
    fn topics_with_clocks_of_their_own_become_one_record_and_that_is_said() {
        let table = RecordTable::new("log", vec![topic("M", 250.0, 0.3), topic("q", 100.0, 0.0)]);
        let (notes, problems, flight) = proposed(&table, &channels());
        assert!(problems.is_empty(), "{problems:?}");
        let told = "resampled to 50.93 Hz, every channel through the same low-pass at 80.0 rad/s (logged: M 250.0 Hz, q 100.0 Hz)";
        assert!(notes.iter().any(|note| note == told), "{notes:?}");
        let flight = flight.unwrap();
        assert_eq!(flight.time_s[0], 0.3);
        let middle = flight.time_s.len() / 2;
        for (value, name) in [
            (flight.inputs[(middle, 0)], "M"),
            (flight.outputs[(middle, 0)], "q"),
        ] {
            // 3 rad/s is far below the cut-off.
            assert!(
                (value - signal(flight.time_s[middle])).abs() < 1e-3,
                "{name}"
            );
        }
    }

    #[test]
    fn a_topic_too_slow_for_the_band_is_named_with_the_rate_that_it_takes() {
        let table = RecordTable::new("log", vec![topic("M", 250.0, 0.0), topic("q", 4.0, 0.0)]);
        let (_, problems, flight) = proposed(&table, &channels());
        assert!(flight.is_none());
        let told = "q has 4.0 samples in a second, and a band to 12.000 rad/s takes 6.4: log it faster, or end the band at 7.54 rad/s";
        assert_eq!(problems, [told]);
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
        let (notes, problems, flight) = proposed(&table, &channels());
        assert!(
            problems.is_empty()
                && notes
                    .iter()
                    .any(|note| note.contains("M 125.0 Hz, q 50.0 Hz")),
            "{notes:?}"
        );
        let flight = flight.unwrap();
        assert!(
            flight
                .outputs
                .iter()
                .chain(&flight.inputs)
                .all(|value| value.is_finite())
        );
    }

    #[test]
    fn a_record_of_one_even_clock_is_left_alone_unless_a_rate_is_asked_for() {
        let stamps: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let values: Vec<f64> = stamps.iter().map(|t| signal(*t)).collect();
        let columns = ["M", "q"].map(|name| RecordColumn::new(name, values.clone()));
        let table = RecordTable::new(
            "log",
            [
                vec![RecordColumn::new("t", stamps.clone())],
                columns.to_vec(),
            ]
            .concat(),
        );
        let mut channels = channels();
        assert_eq!(proposed(&table, &channels).2.unwrap().time_s, stamps);
        channels.resampling.rate_hz = Some(50.0);
        assert_eq!(proposed(&table, &channels).2.unwrap().time_s.len(), 500);
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
            let flight = proposed(&table, &channels()).2.unwrap();
            let ends = [flight.time_s[0], *flight.time_s.last().unwrap()];
            assert!(
                (ends[0] - 6.0).abs() < 0.02 && (ends[1] - 8.0).abs() < 0.02,
                "{ends:?}"
            );
            assert_eq!(flight.outputs.nrows(), flight.time_s.len());
        }
    }
}
