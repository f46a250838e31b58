//! User-defined tolerances for time histories, converted to a dataset's units; a tolerance for an
//! angle is converted to the integral of a rate (M17.2).
//!
//! The default table follows 14 CFR part 60, appendix C, table C2A, "Full flight simulator (FFS)
//! objective tests", whose entries also appear in CS-FSTD(H).

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Channel;
use gdcm_model::message_text::quoted;
use gdcm_model::units::number;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit, conversion_factor};

use super::positive_number::{NamedLimit, WrongLimit, first_not_positive};

const DEFAULT_SOURCE: &str = "14 CFR part 60, appendix C, table C2A; CS-FSTD(H)";
/// The relative tolerance in table C2A, as a fraction.
const TEN_PERCENT: f64 = 0.1;

/// A row: `|simulated - flown| <= max(absolute, relative |flown - flown at the start|)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Quantity, as displayed ("bank angle").
    pub quantity: String,
    /// Output from which the quantity is read, as named in the dataset ("P").
    pub channel: String,
    /// Whether the output is integrated: an attitude, from its rate.
    #[serde(default)]
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// Unit of `absolute` ("deg").
    pub unit: String,
    /// The tolerance relative to the change since the manoeuvre's start, as a fraction (0.1: 10 %);
    /// `None` if only `absolute` applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// Entries in the source ("2.b.3.b, 2.d.1").
    #[serde(default)]
    pub entry: String,
}

impl Tolerance {
    /// Checks the tolerance; `row` counts from 1.
    fn check(&self, row: usize) -> Result<(), ToleranceError> {
        let quantity = self.quantity.clone();
        if self.channel.trim().is_empty() {
            return Err(ToleranceError::NoChannelName { row, quantity });
        }
        let limits = [
            NamedLimit {
                name: "absolute",
                value: Some(self.absolute),
            },
            NamedLimit {
                name: "relative",
                value: self.relative,
            },
        ];
        match first_not_positive(&limits) {
            Some(WrongLimit { name, value: found }) => Err(ToleranceError::NotPositive {
                row,
                quantity,
                name,
                found,
            }),
            None => Ok(()),
        }
    }

    /// Converts the tolerance to its output's units.
    ///
    /// # Errors
    /// [`ToleranceError`] if there is no such output, an integrated output is not a rate, or the
    /// units cannot be converted.
    pub fn in_output_units(&self, outputs: &[Channel]) -> Result<ChannelTolerance, ToleranceError> {
        let quantity = self.quantity.clone();
        let channel = self.channel.clone();
        let Some(output) = outputs
            .iter()
            .position(|output| output.name == self.channel)
        else {
            return Err(ToleranceError::NoChannel { quantity, channel });
        };
        let unit = &outputs[output].unit;
        let compared_unit = if self.integrated {
            let Some(angle) = integral_unit(unit) else {
                return Err(ToleranceError::NotARate {
                    quantity,
                    channel,
                    unit: unit.clone(),
                });
            };
            angle
        } else {
            unit.as_str()
        };
        let Some(factor) = conversion_factor(&self.unit, compared_unit) else {
            return Err(ToleranceError::Unit {
                quantity,
                channel,
                unit: self.unit.clone(),
                compared_unit: compared_unit.to_owned(),
            });
        };
        Ok(ChannelTolerance {
            output,
            integrated: self.integrated,
            absolute: self.absolute * factor,
            relative: self.relative.unwrap_or(0.0),
            unit: compared_unit.to_owned(),
        })
    }
}

/// Returns the unit of an angular rate's time integral; `None` for any other unit.
fn integral_unit(rate: &str) -> Option<&'static str> {
    let rate = PhysicalUnit::parse(rate)?;
    if rate.dimension != Dimension::AngularRate {
        return None;
    }
    // An angle and its rate per second have the same factor to SI, computed from the same constant
    // (pi/180 for deg and deg/s). No angle here belongs to another rate, such as rpm.
    ["deg", "rad"]
        .into_iter()
        .find(|angle| PhysicalUnit::parse(angle).is_some_and(|angle| angle.size == rate.size))
}

/// The tolerances with their source; each row is checked on reading.
///
/// Every row that fits the dataset applies to every record. Of rows with the same `channel` and
/// `integrated`, the requirement grid (M17.5) uses the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ToleranceRows")]
pub struct ToleranceTable {
    source: String,
    #[serde(rename = "tolerances")]
    rows: Vec<Tolerance>,
}

impl ToleranceTable {
    /// Creates a table with its source.
    ///
    /// # Errors
    /// [`ToleranceError`] with the row number if a row names no channel, or a tolerance is not
    /// above zero.
    pub fn new(source: impl Into<String>, rows: Vec<Tolerance>) -> Result<Self, ToleranceError> {
        for (index, tolerance) in rows.iter().enumerate() {
            tolerance.check(index + 1)?;
        }
        Ok(Self {
            source: source.into(),
            rows,
        })
    }

    /// Returns the document that the tolerances come from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Returns the rows in file order.
    pub fn rows(&self) -> &[Tolerance] {
        &self.rows
    }
}

/// The table as written in files.
#[derive(Deserialize)]
struct ToleranceRows {
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

impl TryFrom<ToleranceRows> for ToleranceTable {
    type Error = ToleranceError;

    fn try_from(file: ToleranceRows) -> Result<Self, ToleranceError> {
        Self::new(file.source, file.tolerances)
    }
}

impl Default for ToleranceTable {
    /// Returns the tolerances from 14 CFR part 60, appendix C, table C2A: hover and low speed
    /// (2.b), longitudinal (2.c), lateral and directional (2.d).
    fn default() -> Self {
        let rows = DEFAULT_ROWS.iter().map(DefaultRow::tolerance).collect();
        Self {
            source: DEFAULT_SOURCE.to_owned(),
            rows,
        }
    }
}

/// A default row.
struct DefaultRow {
    quantity: &'static str,
    channel: &'static str,
    integrated: bool,
    absolute: f64,
    unit: &'static str,
    relative: Option<f64>,
    entry: &'static str,
}

impl DefaultRow {
    fn tolerance(&self) -> Tolerance {
        Tolerance {
            quantity: self.quantity.to_owned(),
            channel: self.channel.to_owned(),
            integrated: self.integrated,
            absolute: self.absolute,
            unit: self.unit.to_owned(),
            relative: self.relative,
            entry: self.entry.to_owned(),
        }
    }
}

const DEFAULT_ROWS: [DefaultRow; 9] = [
    DefaultRow {
        quantity: "roll rate",
        channel: "P",
        integrated: false,
        absolute: 3.0,
        unit: "deg/s",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.b, 2.d.1",
    },
    DefaultRow {
        quantity: "bank angle",
        channel: "P",
        integrated: true,
        absolute: 3.0,
        unit: "deg",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.b, 2.d.1",
    },
    DefaultRow {
        quantity: "pitch rate",
        channel: "Q",
        integrated: false,
        absolute: 2.0,
        unit: "deg/s",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.a, 2.c.1",
    },
    DefaultRow {
        quantity: "pitch attitude",
        channel: "Q",
        integrated: true,
        absolute: 1.5,
        unit: "deg",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.a, 2.c.1",
    },
    DefaultRow {
        quantity: "yaw rate",
        channel: "R",
        integrated: false,
        absolute: 2.0,
        unit: "deg/s",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.c, 2.d.1",
    },
    DefaultRow {
        quantity: "heading",
        channel: "R",
        integrated: true,
        absolute: 2.0,
        unit: "deg",
        relative: Some(TEN_PERCENT),
        entry: "2.b.3.c, 2.d.1",
    },
    DefaultRow {
        quantity: "normal acceleration",
        channel: "NZ",
        integrated: false,
        absolute: 0.1,
        unit: "g",
        relative: None,
        entry: "2.b.3.d, 2.c.3.b",
    },
    // 2.c.3.b joins the next two rows by "or". They repeat the quantities above with absolute
    // tolerances only, and are no requirements of their own.
    DefaultRow {
        quantity: "short term: pitch attitude",
        channel: "Q",
        integrated: true,
        absolute: 1.5,
        unit: "deg",
        relative: None,
        entry: "2.c.3.b",
    },
    DefaultRow {
        quantity: "short term: pitch rate",
        channel: "Q",
        integrated: false,
        absolute: 2.0,
        unit: "deg/s",
        relative: None,
        entry: "2.c.3.b",
    },
];

/// A tolerance in its output's units.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelTolerance {
    pub output: usize,
    /// Whether the output's integral is compared.
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// The relative tolerance, as a fraction; zero if only `absolute` applies.
    pub relative: f64,
    /// Unit in which the output or its integral is compared.
    pub unit: String,
}

/// Reasons why a tolerance cannot be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    #[error(
        "tolerance {row}, {}: expected the name of an output as its channel, found none",
        quoted(quantity)
    )]
    NoChannelName {
        /// Row number, counted from 1.
        row: usize,
        quantity: String,
    },
    /// A tolerance is not finite, or not above zero.
    #[error("tolerance {row}, {}: expected {name} above zero, found {}", quoted(quantity), number(*found))]
    NotPositive {
        /// Row number, counted from 1.
        row: usize,
        quantity: String,
        /// `absolute` or `relative`.
        name: &'static str,
        found: f64,
    },
    #[error(
        "{} is not compared: the dataset has no output {}; if the output has another name, set it in the tolerance table",
        quoted(quantity),
        quoted(channel)
    )]
    NoChannel {
        quantity: String,
        /// The output that the dataset lacks.
        channel: String,
    },
    /// An output to be integrated is not a rate.
    #[error(
        "{} is not compared: expected a rate in deg/s or rad/s to be integrated, but the unit of {} \
        is {}",
        quoted(quantity),
        quoted(channel),
        quoted(unit)
    )]
    NotARate {
        quantity: String,
        channel: String,
        unit: String,
    },
    /// The tolerance's unit cannot be converted to the output's unit.
    #[error(
        "{} is not compared: its tolerance in {} cannot be converted to {}, the unit in which {} is \
        compared; correct the unit in the tolerance table",
        quoted(quantity),
        quoted(unit),
        quoted(compared_unit),
        quoted(channel)
    )]
    Unit {
        quantity: String,
        channel: String,
        unit: String,
        /// The output's unit, or its integral's.
        compared_unit: String,
    },
}

impl ToleranceError {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoChannelName { .. } => "tolerance-without-channel",
            Self::NotPositive { .. } => "tolerance-not-positive",
            Self::NoChannel { .. } => "tolerance-of-unknown-channel",
            Self::NotARate { .. } => "tolerance-not-of-rate",
            Self::Unit { .. } => "tolerance-unit",
        }
    }
}
