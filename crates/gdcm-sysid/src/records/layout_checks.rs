//! Checks on the columns chosen from a record: problems that prevent their use, and cautions.
//!
//! A *rule* ([`ChannelRule`]) describes a channel to read: its name and unit, and its names in
//! files.

use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use super::column_use::{ColumnUse, UnitBasis};
use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::plausible_units::largest_plausible;
use super::record_channels::RecordChannels;
use super::record_layout::{ChannelUse, ChosenColumn, RecordLayout};
use super::record_table::{RecordTable, same_samples};
use super::resampling::{Resampling, has_holes};
use super::sample_step::LONGEST_STEP_S;
use super::time_base::TimeBase;

/// Longest plausible sensor or bus delay \[s\].
const LONGEST_DELAY_S: f64 = 10.0;

impl RecordLayout {
    /// Returns all problems with the chosen columns; empty if [`RecordLayout::flight_record`]
    /// returns a record.
    ///
    /// ```text
    /// 1  time: none chosen; a sample time that is not positive; stamps that do not increase, or
    ///    with too long steps
    /// 2  each channel: no column; or the first of factor, delay, samples, unit, magnitude
    /// 3  a column chosen twice
    /// 4  without these: clocks that cannot be combined (M14.11)
    /// ```
    pub fn problems(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutProblem> {
        // Step 1.
        let mut problems = self.time_problems(table);
        // Step 2.
        for ChannelUse { side, rule, used } in self.uses(channels) {
            match used {
                Some(used) => problems.extend(channel_problem(table, rule, used)),
                None => problems.push(LayoutProblem::NoColumn {
                    side,
                    channel: rule.name.clone(),
                    found: table.column_names(),
                }),
            }
        }
        // Steps 3 and 4.
        problems.extend(self.shared_columns(table, channels));
        if problems.is_empty()
            && let Some(Err(error)) = Resampling::new(self, table, channels)
        {
            problems.push(LayoutProblem::Topics(error));
        }
        problems
    }

    fn time_problems(&self, table: &RecordTable) -> Vec<LayoutProblem> {
        match self.time {
            Some(TimeBase::Topics) => Vec::new(),
            Some(TimeBase::SampleTime(step_s)) if step_s.is_finite() && step_s > 0.0 => Vec::new(),
            Some(TimeBase::SampleTime(step_s)) => vec![LayoutProblem::SampleTime(step_s)],
            Some(time @ TimeBase::Column { column, .. }) if column < table.columns.len() => {
                stamp_problems(time, table, column)
            }
            Some(TimeBase::Column { .. }) | None => {
                vec![LayoutProblem::NoTime(table.column_names())]
            }
        }
    }

    /// Returns a problem for each column that is used by two channels, or by a channel and the
    /// time.
    fn shared_columns(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutProblem> {
        struct Taken<'r> {
            column: usize,
            user: &'r str,
        }
        let mut taken: Vec<Taken> = Vec::new();
        if let Some(column) = self.time_column() {
            taken.push(Taken {
                column,
                user: "the time",
            });
        }
        let mut problems = Vec::new();
        for ChosenColumn { rule, used } in self.chosen(channels) {
            if let Some(earlier) = taken.iter().find(|earlier| earlier.column == used.column) {
                problems.push(LayoutProblem::OneColumn {
                    first: rule.name.clone(),
                    second: earlier.user.to_owned(),
                    column: table.quoted(used.column),
                });
            }
            taken.push(Taken {
                column: used.column,
                user: &rule.name,
            });
        }
        problems
    }

    /// Returns unusual features, which may be correct: missing stamps; for each channel an assumed
    /// unit, missing samples, and samples that are constant or else equal to an earlier channel's.
    pub fn cautions(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutCaution> {
        let mut cautions = Vec::new();
        cautions.extend(self.missing_stamps(table));
        let is_resampled = Resampling::new(self, table, channels).is_some();
        let chosen = self.chosen(channels);
        for (index, channel) in chosen.iter().enumerate() {
            let Some(column) = table.columns.get(channel.used.column) else {
                continue;
            };
            cautions.extend(assumed_unit(table, channel));
            // A table that joins several clocks lacks many samples in each column; resampling fills
            // them.
            let are_holes_filled = is_resampled && has_holes(&column.values);
            if !are_holes_filled {
                cautions.extend(missing_samples(table, channel, &column.values));
            }
            if column.range().is_some_and(|(least, most)| least == most) {
                cautions.push(LayoutCaution::Constant {
                    channel: channel.rule.name.clone(),
                    column: table.quoted(channel.used.column),
                });
                continue;
            }
            if let Some(earlier) = channel_with_same_samples(table, channel, &chosen[..index]) {
                cautions.push(LayoutCaution::Same {
                    first: earlier.rule.name.clone(),
                    second: channel.rule.name.clone(),
                });
            }
        }
        cautions
    }

    fn missing_stamps(&self, table: &RecordTable) -> Option<LayoutCaution> {
        let times_s = self.time?.times_s(table);
        let count = times_s.iter().filter(|time| time.is_nan()).count();
        if count == 0 {
            return None;
        }
        Some(LayoutCaution::MissingTime {
            count,
            samples: table.rows(),
        })
    }
}

/// Returns the problems with a stamp column: order and step length.
fn stamp_problems(time: TimeBase, table: &RecordTable, column: usize) -> Vec<LayoutProblem> {
    let quoted = table.quoted(column);
    let mut problems = Vec::new();
    problems.extend(order_problem(&time.times_s(table), &quoted));
    if let Some(step_s) = time.step_s(table)
        && step_s > LONGEST_STEP_S
    {
        problems.push(LayoutProblem::TimeStep {
            column: quoted,
            step_s,
        });
    }
    problems
}

/// Returns a problem if stamps repeat or decrease, with their number and the first of them.
fn order_problem(times_s: &[f64], column: &str) -> Option<LayoutProblem> {
    let mut previous: Option<f64> = None;
    let mut problem: Option<LayoutProblem> = None;
    for (index, &stamp) in times_s.iter().enumerate() {
        if !stamp.is_finite() {
            continue;
        }
        if let Some(earlier) = previous
            && stamp <= earlier
        {
            if let Some(LayoutProblem::TimeOrder { count, .. }) = &mut problem {
                *count += 1;
            } else {
                problem = Some(LayoutProblem::TimeOrder {
                    column: column.to_owned(),
                    count: 1,
                    samples: times_s.len(),
                    sample: index + 1,
                    before: earlier,
                    after: stamp,
                });
            }
        }
        previous = Some(stamp);
    }
    problem
}

/// Returns the first problem with a channel's factor, delay, samples, unit or magnitude.
fn channel_problem(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<LayoutProblem> {
    let channel = rule.name.clone();
    let factor = used.gain();
    if !factor.is_finite() || factor == 0.0 {
        return Some(LayoutProblem::Factor { channel, factor });
    }
    let delay_s = used.remedy.delay_s;
    if !(-LONGEST_DELAY_S..=LONGEST_DELAY_S).contains(&delay_s) {
        return Some(LayoutProblem::Delay { channel, delay_s });
    }
    let column = table.columns.get(used.column);
    if column.and_then(|column| column.range()).is_none() {
        return Some(LayoutProblem::Empty {
            channel,
            column: table.quoted(used.column),
        });
    }
    open_unit(table, rule, used).or_else(|| implausible_magnitude(table, rule, used))
}

/// Returns a problem if neither the file nor the samples determine the unit.
fn open_unit(table: &RecordTable, rule: &ChannelRule, used: ColumnUse) -> Option<LayoutProblem> {
    if used.unit != UnitBasis::Open {
        return None;
    }
    Some(LayoutProblem::UnitNotGiven {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        unit: rule.unit.clone(),
        units: plausible_units(table, rule, used)?,
    })
}

/// Returns a caution if the unit is an assumption.
fn assumed_unit(table: &RecordTable, channel: &ChosenColumn<'_>) -> Option<LayoutCaution> {
    let ChosenColumn { rule, used } = *channel;
    if used.unit != UnitBasis::Assumed {
        return None;
    }
    Some(LayoutCaution::UnitAssumed {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        unit: rule.unit.clone(),
        units: plausible_units(table, rule, used)?,
    })
}

/// Returns the units in which the samples are plausible; `None` if there are none.
fn plausible_units(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<Vec<String>> {
    let units = used.open_units(table, &rule.unit);
    if units.is_empty() {
        return None;
    }
    Some(units.into_iter().map(str::to_owned).collect())
}

/// Returns a problem if samples are implausible in the channel's unit. Columns identified by a
/// system's documentation are not checked: they are not guesses, and quadrotors turn faster than
/// helicopters.
fn implausible_magnitude(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<LayoutProblem> {
    let column = table.columns.get(used.column)?;
    if column.meaning.is_some() {
        return None;
    }
    let value = column.peak()? * used.gain().abs();
    let dimension = PhysicalUnit::parse(&rule.unit)?.dimension;
    let most = largest_plausible(&rule.unit)?;
    if value <= most {
        return None;
    }
    let is_in_radians = column.unit.as_deref().unwrap_or("").contains("rad");
    let likely_unit = match dimension {
        Dimension::AngularRate if is_in_radians => Some("deg/s"),
        Dimension::Part if rule.unit != "%" => Some("%"),
        _ => None,
    };
    Some(LayoutProblem::Magnitude {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        value,
        most,
        unit: rule.unit.clone(),
        likely_unit,
    })
}

/// Returns a caution if some, but not all, samples are missing.
fn missing_samples(
    table: &RecordTable,
    channel: &ChosenColumn,
    values: &[f64],
) -> Option<LayoutCaution> {
    let count = values.iter().filter(|value| !value.is_finite()).count();
    if count == 0 || count == values.len() {
        return None;
    }
    Some(LayoutCaution::Missing {
        channel: channel.rule.name.clone(),
        column: table.quoted(channel.used.column),
        count,
        samples: values.len(),
    })
}

/// Returns the first earlier channel that has equal samples in another column.
fn channel_with_same_samples<'c, 'r>(
    table: &RecordTable,
    channel: &ChosenColumn,
    earlier: &'c [ChosenColumn<'r>],
) -> Option<&'c ChosenColumn<'r>> {
    let values = &table.columns.get(channel.used.column)?.values;
    earlier.iter().find(|other| {
        other.used.column != channel.used.column
            && table
                .columns
                .get(other.used.column)
                .is_some_and(|column| same_samples(&column.values, values))
    })
}
