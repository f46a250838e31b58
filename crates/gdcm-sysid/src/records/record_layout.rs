//! Assignment of a record's columns to its time and channels.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::names::ChannelRule;
use gdcm_model::names::signed_name::sign_between;
use gdcm_model::simulation::FlightRecord;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit, conversion_factor};

use super::laid_out_record::RecordGuess;
use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::record_channels::RecordChannels;
use super::record_table::{LONGEST_STEP_S, RecordColumn, RecordTable, TimeBase, median_step};
use super::resampling::{Resampling, has_holes};

/// A column of a record, used as a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnUse {
    /// Index of the column.
    pub column: usize,
    /// Channel units per column unit; negative for the opposite sign.
    pub factor: f64,
    /// Whether the factor is still open: neither the file nor the samples determine the unit.
    pub is_unit_open: bool,
    /// Remedy applied in this record only.
    pub remedy: ChannelRemedy,
}

impl ColumnUse {
    /// Uses the column unchanged.
    pub fn as_it_is(column: usize) -> Self {
        Self::times(column, 1.0)
    }

    /// Uses the column times a factor.
    pub fn times(column: usize, factor: f64) -> Self {
        Self {
            column,
            factor,
            is_unit_open: false,
            remedy: ChannelRemedy::NONE,
        }
    }

    /// Returns the use without the remedy of this record.
    fn without_remedy(self) -> Self {
        Self {
            remedy: ChannelRemedy::NONE,
            ..self
        }
    }

    /// Returns the total factor of the samples.
    pub(super) fn gain(&self) -> f64 {
        self.factor * self.remedy.factor
    }
}

/// Assignment of a record's columns to its time and channels: proposed by
/// [`RecordLayout::proposed`], and editable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordLayout {
    /// Source of the sample times; `None` while open.
    pub time: Option<TimeBase>,
    /// One for each input; `None` while open.
    pub inputs: Vec<Option<ColumnUse>>,
    /// One for each output; `None` while open.
    pub outputs: Vec<Option<ColumnUse>>,
}

impl RecordLayout {
    /// Returns every channel, inputs first, with its chosen column.
    pub(super) fn uses<'r>(
        &'r self,
        channels: &'r RecordChannels,
    ) -> impl Iterator<Item = (ChannelSide, &'r ChannelRule, Option<ColumnUse>)> {
        let of_side = |side: ChannelSide| {
            let uses = side.of(&self.inputs, &self.outputs);
            let rules = side
                .of(&channels.inputs, &channels.outputs)
                .iter()
                .enumerate();
            rules.map(move |(index, rule)| (side, rule, uses.get(index).copied().flatten()))
        };
        of_side(ChannelSide::Input).chain(of_side(ChannelSide::Output))
    }

    /// Returns the channels with a chosen column.
    fn chosen<'r>(
        &'r self,
        channels: &'r RecordChannels,
    ) -> impl Iterator<Item = (&'r ChannelRule, ColumnUse)> {
        self.uses(channels)
            .filter_map(|(_, rule, used)| Some((rule, used?)))
    }

    /// Returns all problems of the chosen columns; empty if [`RecordLayout::flight_record`] returns
    /// a record.
    pub fn problems(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutProblem> {
        let mut problems = self.time_problems(table);
        for (side, rule, used) in self.uses(channels) {
            let missing = || {
                let channel = rule.name.clone();
                let found = table.column_names();
                Some(LayoutProblem::NoColumn {
                    side,
                    channel,
                    found,
                })
            };
            problems.extend(used.map_or_else(missing, |used| channel_problem(table, rule, used)));
        }
        problems.extend(self.shared_columns(table, channels));
        if problems.is_empty() {
            let refused = Resampling::of(self, table, channels).and_then(Result::err);
            problems.extend(refused.map(LayoutProblem::Topics));
        }
        problems
    }

    /// Returns unusual features of the chosen columns, which may be correct.
    pub fn cautions(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutCaution> {
        let mut cautions = Vec::new();
        let is_resampled = Resampling::of(self, table, channels).is_some();
        if let Some(time) = self.time {
            let samples = table.rows();
            let count = time
                .times_s(table)
                .iter()
                .filter(|time| time.is_nan())
                .count();
            cautions.extend((count > 0).then_some(LayoutCaution::MissingTime { count, samples }));
        }
        let all: Vec<_> = self.chosen(channels).collect();
        for (index, (rule, used)) in all.iter().enumerate() {
            let Some(values) = table.columns.get(used.column).map(|column| &column.values) else {
                continue;
            };
            let channel = rule.name.clone();
            let column = table.quoted(used.column);
            let samples = values.len();
            let count = values.iter().filter(|value| !value.is_finite()).count();
            if count > 0 && count < samples && !(is_resampled && has_holes(values)) {
                let channel = channel.clone();
                let column = column.clone();
                cautions.push(LayoutCaution::Missing {
                    channel,
                    column,
                    count,
                    samples,
                });
            }
            let is_constant = table.columns[used.column]
                .range()
                .is_some_and(|(least, most)| least == most);
            if is_constant {
                cautions.push(LayoutCaution::Constant { channel, column });
                continue;
            }
            let same = all[..index].iter().find(|(_, other)| {
                other.column != used.column
                    && table
                        .columns
                        .get(other.column)
                        .is_some_and(|other| same_samples(&other.values, values))
            });
            cautions.extend(same.map(|(first, _)| LayoutCaution::Same {
                first: first.name.clone(),
                second: rule.name.clone(),
            }));
        }
        cautions
    }

    /// Returns the flight record of the chosen columns: each sample times its factor, otherwise
    /// unchanged. Fails while a problem remains.
    pub fn flight_record(
        &self,
        table: &RecordTable,
        channels: &RecordChannels,
    ) -> Result<FlightRecord, Vec<LayoutProblem>> {
        let problems = self.problems(table, channels);
        match self.time {
            Some(time) if problems.is_empty() => Ok(match Resampling::of(self, table, channels) {
                Some(Ok(resampling)) => resampling.flight_record(table.name.clone()),
                _ => self.as_logged(table, time),
            }),
            _ => Err(problems),
        }
    }

    /// Returns the samples on their common clock, restricted to the record's part of the file.
    fn as_logged(&self, table: &RecordTable, time: TimeBase) -> FlightRecord {
        let of_topic = || {
            let used = self.inputs.iter().chain(&self.outputs).flatten().next()?;
            Some(
                table
                    .columns
                    .get(used.column)?
                    .topic
                    .as_ref()?
                    .time_s
                    .clone(),
            )
        };
        let time_s = if time == TimeBase::Topics {
            of_topic().unwrap_or_default()
        } else {
            time.times_s(table)
        };
        let is_of_part = |time: &f64| {
            table
                .part_s
                .is_none_or(|[from, to]| (from..=to).contains(time))
        };
        let rows: Vec<usize> = (0..time_s.len())
            .filter(|row| is_of_part(&time_s[*row]))
            .collect();
        FlightRecord {
            name: table.name.clone(),
            inputs: samples_of(table, &self.inputs, (&time_s, &rows)),
            outputs: samples_of(table, &self.outputs, (&time_s, &rows)),
            time_s: rows.into_iter().map(|row| time_s[row]).collect(),
        }
    }

    /// Copies the remedy of each channel from `other`.
    #[must_use]
    pub fn with_remedies_of(mut self, other: &Self) -> Self {
        let sides = [
            (&mut self.inputs, &other.inputs),
            (&mut self.outputs, &other.outputs),
        ];
        let pairs = sides
            .into_iter()
            .flat_map(|(uses, others)| uses.iter_mut().zip(others));
        for (used, other) in pairs.filter_map(|(used, other)| used.as_mut().zip(*other)) {
            used.remedy = other.remedy;
        }
        self
    }

    /// Adds remedies to channels by name, in this record only, in addition to earlier remedies.
    pub fn put_right(
        &mut self,
        remedies: &BTreeMap<String, ChannelRemedy>,
        channels: &RecordChannels,
    ) {
        let sides = [
            (&channels.inputs, &mut self.inputs),
            (&channels.outputs, &mut self.outputs),
        ];
        for (rule, used) in sides
            .into_iter()
            .flat_map(|(rules, uses)| rules.iter().zip(uses))
        {
            if let Some((used, remedy)) = used.as_mut().zip(remedies.get(&rule.name)) {
                used.remedy = used.remedy.then(*remedy);
            }
        }
    }

    /// Returns the editable use of a channel.
    pub fn channel_mut(&mut self, role: ChannelSide, index: usize) -> Option<&mut ColumnUse> {
        role.of(&mut self.inputs, &mut self.outputs)
            .get_mut(index)?
            .as_mut()
    }

    /// Applies the changes between two layouts of `from` to this layout of `table`, channel by
    /// channel: transfers the user's edits of one record to another with columns of the same names.
    /// Remedies, which belong to one record, stay as they are.
    #[must_use]
    pub fn following(
        &self,
        table: &RecordTable,
        [before, after]: [&Self; 2],
        from: &RecordTable,
    ) -> Self {
        let mut layout = self.clone();
        if before.time != after.time {
            layout.time = match after.time {
                Some(TimeBase::Column { column, seconds }) => match place(column, from, table) {
                    Some(column) => Some(TimeBase::Column { column, seconds }),
                    None => self.time,
                },
                other => other,
            };
        }
        let sides = [
            (&mut layout.inputs, &before.inputs, &after.inputs),
            (&mut layout.outputs, &before.outputs, &after.outputs),
        ];
        for (uses, before, after) in sides {
            for (index, own) in uses.iter_mut().enumerate() {
                let [was, is] = [before, after].map(|uses| uses.get(index).copied().flatten());
                let Some(is) =
                    is.filter(|is| was.map(ColumnUse::without_remedy) != Some(is.without_remedy()))
                else {
                    continue;
                };
                if let Some(column) = place(is.column, from, table) {
                    let remedy = own.map_or(ChannelRemedy::NONE, |own| own.remedy);
                    *own = Some(ColumnUse {
                        column,
                        remedy,
                        ..is
                    });
                }
            }
        }
        layout
    }

    /// Takes every open unit to be the unit of the channel.
    #[must_use]
    pub fn in_units_of_channels(&self) -> Self {
        let closed = |uses: &[Option<ColumnUse>]| -> Vec<Option<ColumnUse>> {
            uses.iter()
                .map(|used| {
                    used.map(|used| ColumnUse {
                        is_unit_open: false,
                        ..used
                    })
                })
                .collect()
        };
        Self {
            inputs: closed(&self.inputs),
            outputs: closed(&self.outputs),
            ..self.clone()
        }
    }

    /// Returns the same columns, by name, in another record; `None` if it lacks one of them.
    pub fn carried_to(&self, other: &RecordTable, from: &RecordTable) -> Option<Self> {
        let place = |column: usize| place(column, from, other);
        let carry = |uses: &[Option<ColumnUse>]| -> Option<Vec<Option<ColumnUse>>> {
            let carried = |used: &Option<ColumnUse>| match used {
                Some(used) => Some(Some(ColumnUse {
                    column: place(used.column)?,
                    ..*used
                })),
                None => Some(None),
            };
            uses.iter().map(carried).collect()
        };
        let time = match self.time {
            Some(TimeBase::Column { column, seconds }) => Some(TimeBase::Column {
                column: place(column)?,
                seconds,
            }),
            other => other,
        };
        Some(Self {
            time,
            inputs: carry(&self.inputs)?,
            outputs: carry(&self.outputs)?,
        })
    }

    /// Creates the dataset entry of this record: its location, and the information in its name.
    pub fn condition_record(
        &self,
        table: &RecordTable,
        guess: &RecordGuess,
        channels: &RecordChannels,
    ) -> ConditionRecord {
        let remedies = self
            .chosen(channels)
            .map(|(rule, used)| (rule.name.clone(), used.kept_remedy(table, rule)));
        ConditionRecord {
            remedies: remedies
                .filter(|(_, remedy)| *remedy != ChannelRemedy::NONE)
                .collect(),
            variable: table.source.variable.clone(),
            sha256: Some(table.source.sha256.clone()).filter(|hash| !hash.is_empty()),
            kind: guess.kind,
            held_out: guess.held_out,
            part_s: table.part_s,
            sample_time_s: self
                .time
                .and_then(|time| time.step_s(table))
                .filter(|step_s| *step_s > 0.0),
            ..ConditionRecord::new(table.name.clone(), table.source.file.clone())
        }
    }

    fn time_problems(&self, table: &RecordTable) -> Vec<LayoutProblem> {
        match self.time {
            Some(TimeBase::Topics) => Vec::new(),
            Some(TimeBase::SampleTime(step_s)) if step_s.is_finite() && step_s > 0.0 => Vec::new(),
            Some(TimeBase::SampleTime(step_s)) => vec![LayoutProblem::SampleTime(step_s)],
            Some(time @ TimeBase::Column { column, .. }) if column < table.columns.len() => {
                let quoted = table.quoted(column);
                let step = time.step_s(table).filter(|step_s| *step_s > LONGEST_STEP_S);
                let step = step.map(|step_s| LayoutProblem::TimeStep {
                    column: quoted.clone(),
                    step_s,
                });
                order_problem(&time.times_s(table), quoted)
                    .into_iter()
                    .chain(step)
                    .collect()
            }
            Some(TimeBase::Column { .. }) | None => {
                vec![LayoutProblem::NoTime(table.column_names())]
            }
        }
    }

    /// Returns a problem for each column used by two channels.
    fn shared_columns(&self, table: &RecordTable, channels: &RecordChannels) -> Vec<LayoutProblem> {
        let mut taken: Vec<(usize, String)> = Vec::new();
        if let Some(TimeBase::Column { column, .. }) = self.time {
            taken.push((column, "the time".to_owned()));
        }
        let mut problems = Vec::new();
        for (rule, used) in self.chosen(channels) {
            if let Some((_, second)) = taken.iter().find(|(column, _)| *column == used.column) {
                let first = rule.name.clone();
                let second = second.clone();
                let column = table.quoted(used.column);
                problems.push(LayoutProblem::OneColumn {
                    first,
                    second,
                    column,
                });
            }
            taken.push((used.column, rule.name.clone()));
        }
        problems
    }
}

/// Returns the index in another record of a column, by name.
fn place(column: usize, from: &RecordTable, other: &RecordTable) -> Option<usize> {
    let name = &from.columns.get(column)?.name;
    if other
        .columns
        .get(column)
        .is_some_and(|same| same.name == *name)
    {
        Some(column)
    } else {
        other.find(name)
    }
}

fn channel_problem(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<LayoutProblem> {
    let channel = rule.name.clone();
    let column = table.quoted(used.column);
    if !used.gain().is_finite() || used.gain() == 0.0 {
        return Some(LayoutProblem::Factor {
            channel,
            factor: used.gain(),
        });
    }
    let delay_s = used.remedy.delay_s;
    if !(-LONGEST_DELAY_S..=LONGEST_DELAY_S).contains(&delay_s) {
        return Some(LayoutProblem::Delay { channel, delay_s });
    }
    let range = table
        .columns
        .get(used.column)
        .and_then(|column| column.range());
    if range.is_none() {
        return Some(LayoutProblem::Empty { channel, column });
    }
    unsaid_unit(table, rule, used).or_else(|| magnitude(table, rule, used))
}

fn order_problem(times_s: &[f64], column: String) -> Option<LayoutProblem> {
    let mut last: Option<f64> = None;
    let mut count = 0;
    let mut first = None;
    for (sample, &after) in times_s
        .iter()
        .enumerate()
        .filter(|(_, time)| time.is_finite())
    {
        if let Some(before) = last.filter(|before| after <= *before) {
            count += 1;
            first = first.or(Some((sample + 1, before, after)));
        }
        last = Some(after);
    }
    let samples = times_s.len();
    first.map(|(sample, before, after)| LayoutProblem::TimeOrder {
        column,
        count,
        samples,
        sample,
        before,
        after,
    })
}

/// Whether samples are equal, with missing samples in the same places.
pub(super) fn same_samples(first: &[f64], second: &[f64]) -> bool {
    first.len() == second.len()
        && first
            .iter()
            .zip(second)
            .all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
}

/// Returns the samples in these rows, one column per channel; NaN where a sample is missing.
fn samples_of(
    table: &RecordTable,
    uses: &[Option<ColumnUse>],
    (time_s, rows): (&[f64], &[usize]),
) -> DMatrix<f64> {
    let mut samples = DMatrix::from_element(rows.len(), uses.len(), f64::NAN);
    for (mut into, used) in samples.column_iter_mut().zip(uses) {
        let Some((column, used)) =
            used.and_then(|used| Some((table.columns.get(used.column)?, used)))
        else {
            continue;
        };
        let advanced = (used.remedy.delay_s != 0.0)
            .then(|| advanced(time_s, &column.values, used.remedy.delay_s));
        let values = advanced.as_deref().unwrap_or(&column.values);
        let values = rows
            .iter()
            .map(|row| values.get(*row).copied().unwrap_or(f64::NAN));
        for (sample, value) in into
            .iter_mut()
            .zip(values)
            .filter(|(_, value)| value.is_finite())
        {
            *sample = if used.gain() == 1.0 {
                value
            } else {
                value * used.gain()
            };
        }
    }
    samples
}

/// Removes a logging delay of `delay_s` from a channel: at t, the linear interpolation at t + delay
/// between two adjacent samples; NaN beyond the ends, beside a missing sample, and in a gap of the
/// stamps.
fn advanced(time_s: &[f64], values: &[f64], delay_s: f64) -> Vec<f64> {
    let longest_s = LONGEST_LINE * median_step(time_s).unwrap_or(0.0);
    let mut next = 0;
    let at = |t: f64| {
        if !t.is_finite() {
            return f64::NAN;
        }
        while next < time_s.len() && (time_s[next] <= t || time_s[next].is_nan()) {
            next += 1;
        }
        let Some(before) = next.checked_sub(1) else {
            return f64::NAN;
        };
        let value = |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        if time_s[before] == t {
            return value(before);
        }
        let Some(after) = time_s.get(next) else {
            return f64::NAN;
        };
        let step = after - time_s[before];
        let part = (t - time_s[before]) / step;
        if step <= longest_s {
            value(before) + part * (value(next) - value(before))
        } else {
            f64::NAN
        }
    };
    time_s.iter().map(|t| t + delay_s).map(at).collect()
}

/// Longest plausible delay of a sensor or a bus \[s\].
const LONGEST_DELAY_S: f64 = 10.0;
/// Longest interpolation interval, in median steps: gaps of three samples, as in the preparation of
/// records (M14.1).
const LONGEST_LINE: f64 = 4.5;

// Possible and impossible units of a channel's samples.

/// Largest plausible value for a helicopter by dimension, in the given unit.
const MOST: [(Dimension, f64, &str); 7] = [
    (Dimension::AngularRate, 400.0, "deg/s"),
    (Dimension::Angle, 3600.0, "deg"),
    (Dimension::AngularAcceleration, 5000.0, "deg/s^2"),
    (Dimension::Acceleration, 15.0, "g"),
    (Dimension::Speed, 500.0, "kt"),
    (Dimension::Part, 3.0, "1"),
    (Dimension::Length, 50_000.0, "m"),
];

/// Units in which channels are logged.
const LOGGED: [&str; 21] = [
    "rad/s", "deg/s", "rad", "deg", "rad/s^2", "deg/s^2", "g", "m/s^2", "ft/s^2", "m/s", "ft/s",
    "kt", "%", "1", "m", "cm", "mm", "ft", "in", "N", "lb",
];

/// Returns the largest plausible value for a helicopter in this unit.
fn most(unit: &str) -> Option<f64> {
    let dimension = PhysicalUnit::of(unit)?.dimension;
    let (_, limit, of) = MOST.into_iter().find(|(of, ..)| *of == dimension)?;
    Some(limit * conversion_factor(of, unit)?)
}

/// Returns the largest absolute sample.
fn peak(column: &RecordColumn) -> Option<f64> {
    column
        .range()
        .map(|(least, most)| least.abs().max(most.abs()))
}

/// Returns the possible units of a column's samples for a channel with this unit, which comes
/// first: units of the same dimension whose largest plausible value is not below the largest
/// sample. Empty if all samples are zero; an unknown unit leaves nothing open.
pub(super) fn possible_units<'u>(column: &RecordColumn, unit: &'u str) -> Vec<&'u str> {
    let Some(peak) = peak(column).filter(|peak| *peak > 0.0) else {
        return Vec::new();
    };
    let is_other =
        |other: &&str| conversion_factor(other, unit).is_some_and(|factor| factor != 1.0);
    let units = std::iter::once(unit).filter(|unit| PhysicalUnit::of(unit).is_some());
    let units = units.chain(LOGGED.into_iter().filter(is_other));
    units
        .filter(|unit| most(unit).is_none_or(|most| peak <= most))
        .collect()
}

/// Returns the problem of a channel whose unit is determined by neither its file nor its samples.
pub(super) fn unsaid_unit(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<LayoutProblem> {
    let units = used.open_units(table, &rule.unit);
    let (last, rest) = units.split_last()?;
    Some(LayoutProblem::UnsaidUnit {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        unit: rule.unit.clone(),
        units: format!("{} or {last}", rest.join(", ")),
    })
}

/// Returns the problem of a channel whose samples are implausible in its unit.
pub(super) fn magnitude(
    table: &RecordTable,
    rule: &ChannelRule,
    used: ColumnUse,
) -> Option<LayoutProblem> {
    // Columns identified by a system's documentation are not guesses, and quadrotors turn faster
    // than helicopters.
    let column = table
        .columns
        .get(used.column)
        .filter(|column| column.meaning.is_none())?;
    let value = peak(column)? * used.gain().abs();
    let unit = PhysicalUnit::of(&rule.unit)?;
    let most = most(&rule.unit)?;
    if value <= most {
        return None;
    }
    let hint = match unit.dimension {
        Dimension::AngularRate
            if column
                .unit
                .as_deref()
                .is_some_and(|unit| unit.contains("rad")) =>
        {
            "; its samples look like deg/s"
        }
        Dimension::Part if rule.unit != "%" => "; its samples look like %",
        _ => "",
    };
    Some(LayoutProblem::Magnitude {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        value,
        most,
        unit: rule.unit.clone(),
        hint: hint.to_owned(),
    })
}

impl ColumnUse {
    /// Uses a column for a channel with this unit, converted from the unit in the file, or else
    /// from the only possible unit of its samples; the unit is open if several are possible.
    pub fn by_unit(table: &RecordTable, column: usize, unit: &str) -> Self {
        let Some(of) = table.columns.get(column) else {
            return Self::as_it_is(column);
        };
        let said = of
            .said_unit()
            .and_then(|said| conversion_factor(said, unit));
        match (said, possible_units(of, unit).as_slice()) {
            (Some(factor), _) => Self::times(column, factor),
            (None, [only]) => Self::times(column, conversion_factor(only, unit).unwrap_or(1.0)),
            (None, [_, _, ..]) if of.said_unit().is_none() => Self {
                is_unit_open: true,
                ..Self::as_it_is(column)
            },
            _ => Self::as_it_is(column),
        }
    }

    /// Returns the possible units of an open column, for a channel with this unit; empty if nothing
    /// is open.
    pub fn open_units<'u>(&self, table: &RecordTable, unit: &'u str) -> Vec<&'u str> {
        let column = table.columns.get(self.column).filter(|_| self.is_unit_open);
        column.map_or_else(Vec::new, |column| possible_units(column, unit))
    }

    /// Uses the column in a given unit for a channel with another.
    #[must_use]
    pub fn in_unit(self, said: &str, unit: &str) -> Self {
        Self {
            factor: self.factor * conversion_factor(said, unit).unwrap_or(1.0),
            is_unit_open: false,
            ..self
        }
    }

    /// Returns the remedy of this record combined with all user settings of the column: the
    /// conversion from the file, in the dataset's units if the file gives none, to the samples
    /// used. A later reading of the record with the dataset has no other information.
    pub(super) fn kept_remedy(&self, table: &RecordTable, rule: &ChannelRule) -> ChannelRemedy {
        let of_file = table.columns.get(self.column).map_or(1.0, |column| {
            let unit = column.said_unit().filter(|_| !rule.unit.is_empty());
            let factor = unit
                .and_then(|unit| conversion_factor(unit, &rule.unit))
                .unwrap_or(1.0);
            factor * sign_between(&column.name, &rule.name).unwrap_or(1.0)
        });
        let besides = if self.factor == of_file {
            1.0
        } else {
            self.factor / of_file
        };
        ChannelRemedy {
            factor: self.remedy.factor * besides,
            ..self.remedy
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(names: &[&str]) -> RecordTable {
        let columns = names
            .iter()
            .map(|name| RecordColumn::new(*name, vec![0.0, 1.0, 2.0]))
            .collect();
        RecordTable::new("record", columns)
    }

    #[test]
    fn what_is_said_of_one_channel_follows_in_other_records_and_leaves_their_other_channels() {
        let from = table(&["t", "P", "Q"]);
        let other = table(&["Q", "t", "P"]);
        let time = |column| {
            Some(TimeBase::Column {
                column,
                seconds: 1.0,
            })
        };
        let open = |column| {
            Some(ColumnUse {
                is_unit_open: true,
                ..ColumnUse::as_it_is(column)
            })
        };
        let before = RecordLayout {
            time: time(0),
            inputs: Vec::new(),
            outputs: vec![open(1), open(2)],
        };
        let mut after = before.clone();
        after.outputs[0] = before.outputs[0].map(|used| used.in_unit("rad/s", "deg/s"));
        let remedy = ChannelRemedy {
            delay_s: 0.1,
            ..ChannelRemedy::NONE
        };
        let own = ColumnUse {
            remedy,
            ..ColumnUse::as_it_is(2)
        };
        let layout = RecordLayout {
            time: time(1),
            inputs: Vec::new(),
            outputs: vec![Some(own), open(0)],
        };
        let found = layout.following(&other, [&before, &after], &from);
        let said = found.outputs[0].unwrap();
        assert_eq!(
            (said.column, said.is_unit_open, said.remedy),
            (2, false, remedy),
            "by its name, its remedy kept"
        );
        assert!((said.factor - 180.0 / std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(
            (found.outputs[1], found.time),
            (layout.outputs[1], layout.time),
            "nothing else"
        );
        let without = table(&["t", "Q"]);
        assert_eq!(
            before.following(&without, [&before, &after], &from),
            before,
            "it has no such column"
        );
    }
}
