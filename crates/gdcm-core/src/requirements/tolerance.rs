//! How far a simulated time history may be from the flown one: a table in the engineer's hands (M17.2).
//!
//! Its default is of 14 CFR part 60, appendix C, table C2A, "Full flight simulator (FFS) objective tests", whose entries CS-FSTD(H)
//! has too. It is no qualification: the tests of that table are steps and doublets at given conditions.

use serde::{Deserialize, Serialize};

use crate::assembly::{Dimension, PhysicalUnit, conversion_factor};
use crate::dataset::Channel;
use crate::message_text::quoted;
use crate::units::number;

/// Where the default table comes from.
const DEFAULT_SOURCE: &str = "14 CFR part 60, appendix C, table C2A; CS-FSTD(H)";
/// Relative tolerance of the default table.
const TEN_PERCENT: Option<f64> = Some(0.1);

/// One row of the table: `|simulated - flown| <= max(absolute, relative |flown - flown at the start|)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// What is compared, for people ("bank angle").
    pub quantity: String,
    /// The output that it is read from, as the dataset names it ("P").
    pub channel: String,
    /// Whether it is the integral of that output: an attitude, from its rate.
    #[serde(default)]
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// Unit of the absolute tolerance ("deg").
    pub unit: String,
    /// The tolerance as a part of the change from the start of the manoeuvre; none where only the absolute one holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// Entries of the source ("2.b.3.b, 2.d.1").
    #[serde(default)]
    pub entry: String,
}

/// The table of tolerances; each row is checked as it is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ToleranceRows", into = "ToleranceRows")]
pub struct ToleranceTable {
    source: String,
    rows: Vec<Tolerance>,
}

/// The table as it stands in a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ToleranceRows {
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

/// Why a tolerance cannot be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    /// A row names no channel.
    #[error("tolerance {row}, {}: expected the name of an output as its channel, found none", quoted(quantity))]
    NoChannelName {
        /// Which, counted from 1.
        row: usize,
        /// What it is of.
        quantity: String,
    },
    /// A tolerance is not finite, or not above zero.
    #[error("tolerance {row}, {}: expected {name} above zero, found {}", quoted(quantity), number(*found))]
    NotPositive {
        /// Which, counted from 1.
        row: usize,
        /// What it is of.
        quantity: String,
        /// `absolute` or `relative`.
        name: &'static str,
        /// What stands there.
        found: f64,
    },
    /// The dataset has no such output.
    #[error("{} is not compared: there is no output {}", quoted(quantity), quoted(channel))]
    NoChannel {
        /// What was to be compared.
        quantity: String,
        /// The output that it needs.
        channel: String,
    },
    /// An attitude is asked of an output that is no rate.
    #[error(
        "{} is not compared: it is the integral of a rate, and {} in {} is none (deg/s, rad/s)",
        quoted(quantity),
        quoted(channel),
        quoted(unit)
    )]
    NotARate {
        /// What was to be compared.
        quantity: String,
        /// The output.
        channel: String,
        /// Its unit.
        unit: String,
    },
    /// The unit of the tolerance is not one of the output.
    #[error(
        "{} is not compared: a tolerance in {} does not fit {} in {}",
        quoted(quantity),
        quoted(unit),
        quoted(channel),
        quoted(of_channel)
    )]
    Unit {
        /// What was to be compared.
        quantity: String,
        /// The output.
        channel: String,
        /// Unit of the tolerance.
        unit: String,
        /// Unit of the output or of its integral.
        of_channel: String,
    },
}

/// A tolerance in the units of the output that it is applied to.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelTolerance {
    /// Index of the output.
    pub output: usize,
    /// Whether its integral is compared.
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// The relative tolerance; zero where only the absolute one holds.
    pub relative: f64,
    /// Unit of what is compared: that of the output, or of its integral.
    pub unit: String,
}

impl Tolerance {
    fn check(&self, row: usize) -> Result<(), ToleranceError> {
        let quantity = || self.quantity.clone();
        if self.channel.trim().is_empty() {
            return Err(ToleranceError::NoChannelName { row, quantity: quantity() });
        }
        for (name, value) in [("absolute", Some(self.absolute)), ("relative", self.relative)] {
            if let Some(found) = value.filter(|value| !value.is_finite() || *value <= 0.0) {
                return Err(ToleranceError::NotPositive { row, quantity: quantity(), name, found });
            }
        }
        Ok(())
    }

    /// "±10 % or ±3 deg/s".
    pub fn words(&self) -> String {
        let relative = self.relative.map_or_else(String::new, |part| format!("±{} % or ", number(100.0 * part)));
        format!("{relative}±{} {}", number(self.absolute), self.unit)
    }

    /// The tolerance in the units of the dataset's output.
    ///
    /// # Errors
    /// [`ToleranceError`] where there is no such output, it is no rate whose integral is an attitude, or units do not fit.
    pub fn of_outputs(&self, outputs: &[Channel]) -> Result<ChannelTolerance, ToleranceError> {
        let (quantity, channel) = (self.quantity.clone(), self.channel.clone());
        let Some(output) = outputs.iter().position(|output| output.name == self.channel) else {
            return Err(ToleranceError::NoChannel { quantity, channel });
        };
        let unit = &outputs[output].unit;
        let of_channel = if self.integrated { integral_unit(unit) } else { Some(unit.as_str()) };
        let Some(of_channel) = of_channel else {
            return Err(ToleranceError::NotARate { quantity, channel, unit: unit.clone() });
        };
        let Some(factor) = conversion_factor(&self.unit, of_channel) else {
            let of_channel = of_channel.to_owned();
            return Err(ToleranceError::Unit { quantity, channel, unit: self.unit.clone(), of_channel });
        };
        Ok(ChannelTolerance {
            output,
            integrated: self.integrated,
            absolute: self.absolute * factor,
            relative: self.relative.unwrap_or(0.0),
            unit: of_channel.to_owned(),
        })
    }
}

/// The unit of the integral over time of an angular rate; none of anything else.
fn integral_unit(rate: &str) -> Option<&'static str> {
    let unit = PhysicalUnit::of(rate).filter(|unit| unit.dimension == Dimension::AngularRate)?;
    ["deg", "rad"].into_iter().find(|angle| PhysicalUnit::of(angle).is_some_and(|angle| angle.size == unit.size))
}

impl ToleranceTable {
    /// A table of `source`.
    ///
    /// # Errors
    /// [`ToleranceError`] with its row where a row names no channel, or a tolerance is not above zero.
    pub fn new(source: impl Into<String>, rows: Vec<Tolerance>) -> Result<Self, ToleranceError> {
        rows.iter().enumerate().try_for_each(|(index, tolerance)| tolerance.check(index + 1))?;
        Ok(Self { source: source.into(), rows })
    }

    /// Where it comes from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Its rows.
    pub fn rows(&self) -> &[Tolerance] {
        &self.rows
    }
}

impl TryFrom<ToleranceRows> for ToleranceTable {
    type Error = ToleranceError;

    fn try_from(file: ToleranceRows) -> Result<Self, ToleranceError> {
        Self::new(file.source, file.tolerances)
    }
}

impl From<ToleranceTable> for ToleranceRows {
    fn from(table: ToleranceTable) -> Self {
        Self { source: table.source, tolerances: table.rows }
    }
}

impl Default for ToleranceTable {
    /// 14 CFR part 60, appendix C, table C2A: hover and low speed (2.b), longitudinal (2.c), lateral and directional (2.d).
    fn default() -> Self {
        let row = |quantity: &str, channel: &str, (absolute, unit): (f64, &str), relative, entry: &str| Tolerance {
            quantity: quantity.to_owned(),
            channel: channel.to_owned(),
            integrated: unit == "deg",
            absolute,
            unit: unit.to_owned(),
            relative,
            entry: entry.to_owned(),
        };
        let rows = vec![
            row("roll rate", "P", (3.0, "deg/s"), TEN_PERCENT, "2.b.3.b, 2.d.1"),
            row("bank angle", "P", (3.0, "deg"), TEN_PERCENT, "2.b.3.b, 2.d.1"),
            row("pitch rate", "Q", (2.0, "deg/s"), TEN_PERCENT, "2.b.3.a, 2.c.1"),
            row("pitch attitude", "Q", (1.5, "deg"), TEN_PERCENT, "2.b.3.a, 2.c.1"),
            row("yaw rate", "R", (2.0, "deg/s"), TEN_PERCENT, "2.b.3.c, 2.d.1"),
            row("heading", "R", (2.0, "deg"), TEN_PERCENT, "2.b.3.c, 2.d.1"),
            row("normal acceleration", "NZ", (0.1, "g"), None, "2.b.3.d, 2.c.3.b"),
            row("short term: pitch attitude", "Q", (1.5, "deg"), None, "2.c.3.b"),
            row("short term: pitch rate", "Q", (2.0, "deg/s"), None, "2.c.3.b"),
        ];
        Self { source: DEFAULT_SOURCE.to_owned(), rows }
    }
}
