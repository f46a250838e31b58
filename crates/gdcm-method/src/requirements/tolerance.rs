//! Simulated time histories within tolerances around flight, by a user-defined table (M17.2).
//!
//! The default table follows 14 CFR part 60, appendix C, table C2A, "Full flight simulator (FFS)
//! objective tests", whose entries also appear in CS-FSTD(H). The check is not a qualification: the
//! tests of that table are steps and doublets at given conditions.
//!
//! ```text
//! 1  attitudes: theta_n = theta_(n-1) + dt (q_(n-1) + q_n) / 2 from the start of the manoeuvre, flown and simulated alike
//! 2  corridor: w_n = max(absolute, relative |y_n - y_0|), the wider of the two
//! 3  excess: e_n = |y^_n - y_n| - w_n; a sample is inside where e_n <= 0
//! 4  share inside, largest e_n and its time; trend: sign of the correlation of y^ and y about their means
//! ```
//!
//! 14 CFR part 60, appendix C, table C2A. Integrals of body rates are attitudes for small angles
//! only.

use nalgebra::{DMatrix, Vector3};
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Channel;
use gdcm_model::message_text::quoted;
use gdcm_model::simulation::ValidationWindow;
use gdcm_model::statistics::mean;
use gdcm_model::units::number;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit, conversion_factor};

use super::not_positive;

/// Source of the default table.
const DEFAULT_SOURCE: &str = "14 CFR part 60, appendix C, table C2A; CS-FSTD(H)";
/// Relative tolerance of the default table.
const TEN_PERCENT: Option<f64> = Some(0.1);

/// One row of the table: `|simulated - flown| <= max(absolute, relative |flown - flown at the start|)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Quantity, as displayed ("bank angle").
    pub quantity: String,
    /// The output that it is read from, as named in the dataset ("P").
    pub channel: String,
    /// Whether the output is integrated: an attitude, from its rate.
    #[serde(default)]
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// Unit of the absolute tolerance ("deg").
    pub unit: String,
    /// The tolerance relative to the change from the start of the manoeuvre; `None` if only the
    /// absolute one applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// Entries of the source ("2.b.3.b, 2.d.1").
    #[serde(default)]
    pub entry: String,
}

/// The table of tolerances; each row is checked on reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ToleranceRows")]
pub struct ToleranceTable {
    source: String,
    #[serde(rename = "tolerances")]
    rows: Vec<Tolerance>,
}

/// The table in its file format.
#[derive(Deserialize)]
struct ToleranceRows {
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

/// Reasons why a tolerance cannot be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    #[error(
        "tolerance {row}, {}: expected the name of an output as its channel, found none",
        quoted(quantity)
    )]
    NoChannelName {
        /// Counted from 1.
        row: usize,
        quantity: String,
    },
    /// A tolerance is not finite, or not above zero.
    #[error("tolerance {row}, {}: expected {name} above zero, found {}", quoted(quantity), number(*found))]
    NotPositive {
        /// Counted from 1.
        row: usize,
        quantity: String,
        /// `absolute` or `relative`.
        name: &'static str,
        found: f64,
    },
    #[error(
        "{} is not compared: there is no output {}",
        quoted(quantity),
        quoted(channel)
    )]
    NoChannel {
        /// The quantity to compare.
        quantity: String,
        /// The output that it needs.
        channel: String,
    },
    /// The integral of an output that is not a rate.
    #[error(
        "{} is not compared: it is the integral of a rate, and {} in {} is none (deg/s, rad/s)",
        quoted(quantity),
        quoted(channel),
        quoted(unit)
    )]
    NotARate {
        /// The quantity to compare.
        quantity: String,
        channel: String,
        unit: String,
    },
    /// The unit of the tolerance does not fit the output.
    #[error(
        "{} is not compared: a tolerance in {} does not fit {} in {}",
        quoted(quantity),
        quoted(unit),
        quoted(channel),
        quoted(of_channel)
    )]
    Unit {
        /// The quantity to compare.
        quantity: String,
        channel: String,
        /// Unit of the tolerance.
        unit: String,
        /// Unit of the output or of its integral.
        of_channel: String,
    },
}

/// A tolerance in the units of its output.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelTolerance {
    /// Index of the output.
    pub output: usize,
    /// Whether the integral of the output is compared.
    pub integrated: bool,
    /// The absolute tolerance, in `unit`.
    pub absolute: f64,
    /// The relative tolerance; zero if only the absolute one applies.
    pub relative: f64,
    /// Unit of the compared quantity: the output or its integral.
    pub unit: String,
}

impl Tolerance {
    fn check(&self, row: usize) -> Result<(), ToleranceError> {
        let quantity = || self.quantity.clone();
        if self.channel.trim().is_empty() {
            return Err(ToleranceError::NoChannelName {
                row,
                quantity: quantity(),
            });
        }
        match not_positive([
            ("absolute", Some(self.absolute)),
            ("relative", self.relative),
        ]) {
            Some((name, found)) => Err(ToleranceError::NotPositive {
                row,
                quantity: quantity(),
                name,
                found,
            }),
            None => Ok(()),
        }
    }

    /// Returns text such as "±10 % or ±3 deg/s".
    pub fn words(&self) -> String {
        let relative = self.relative.map_or_else(String::new, |part| {
            format!("±{} % or ", number(100.0 * part))
        });
        format!("{relative}±{} {}", number(self.absolute), self.unit)
    }

    /// Converts the tolerance to the units of the dataset's output.
    ///
    /// # Errors
    /// [`ToleranceError`] if there is no such output, an integrated output is not a rate, or units
    /// do not fit.
    pub fn of_outputs(&self, outputs: &[Channel]) -> Result<ChannelTolerance, ToleranceError> {
        let quantity = self.quantity.clone();
        let channel = self.channel.clone();
        let Some(output) = outputs
            .iter()
            .position(|output| output.name == self.channel)
        else {
            return Err(ToleranceError::NoChannel { quantity, channel });
        };
        let unit = &outputs[output].unit;
        let of_channel = if self.integrated {
            integral_unit(unit)
        } else {
            Some(unit.as_str())
        };
        let Some(of_channel) = of_channel else {
            return Err(ToleranceError::NotARate {
                quantity,
                channel,
                unit: unit.clone(),
            });
        };
        let Some(factor) = conversion_factor(&self.unit, of_channel) else {
            let of_channel = of_channel.to_owned();
            return Err(ToleranceError::Unit {
                quantity,
                channel,
                unit: self.unit.clone(),
                of_channel,
            });
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

/// Returns the unit of the time integral of an angular rate; `None` for any other unit.
fn integral_unit(rate: &str) -> Option<&'static str> {
    let unit = PhysicalUnit::of(rate).filter(|unit| unit.dimension == Dimension::AngularRate)?;
    ["deg", "rad"]
        .into_iter()
        .find(|angle| PhysicalUnit::of(angle).is_some_and(|angle| angle.size == unit.size))
}

impl ToleranceTable {
    /// Creates a table with its source.
    ///
    /// # Errors
    /// [`ToleranceError`] with the row number if a row names no channel, or a tolerance is not
    /// above zero.
    pub fn new(source: impl Into<String>, rows: Vec<Tolerance>) -> Result<Self, ToleranceError> {
        rows.iter()
            .enumerate()
            .try_for_each(|(index, tolerance)| tolerance.check(index + 1))?;
        Ok(Self {
            source: source.into(),
            rows,
        })
    }

    /// Returns the source of the table.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Returns the rows.
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

impl Default for ToleranceTable {
    /// Returns the tolerances of 14 CFR part 60, appendix C, table C2A: hover and low speed (2.b),
    /// longitudinal (2.c), lateral and directional (2.d).
    fn default() -> Self {
        let row = |quantity: &str,
                   channel: &str,
                   (absolute, unit): (f64, &str),
                   relative,
                   entry: &str| Tolerance {
            quantity: quantity.to_owned(),
            channel: channel.to_owned(),
            integrated: unit == "deg",
            absolute,
            unit: unit.to_owned(),
            relative,
            entry: entry.to_owned(),
        };
        let rows = vec![
            row(
                "roll rate",
                "P",
                (3.0, "deg/s"),
                TEN_PERCENT,
                "2.b.3.b, 2.d.1",
            ),
            row(
                "bank angle",
                "P",
                (3.0, "deg"),
                TEN_PERCENT,
                "2.b.3.b, 2.d.1",
            ),
            row(
                "pitch rate",
                "Q",
                (2.0, "deg/s"),
                TEN_PERCENT,
                "2.b.3.a, 2.c.1",
            ),
            row(
                "pitch attitude",
                "Q",
                (1.5, "deg"),
                TEN_PERCENT,
                "2.b.3.a, 2.c.1",
            ),
            row(
                "yaw rate",
                "R",
                (2.0, "deg/s"),
                TEN_PERCENT,
                "2.b.3.c, 2.d.1",
            ),
            row("heading", "R", (2.0, "deg"), TEN_PERCENT, "2.b.3.c, 2.d.1"),
            row(
                "normal acceleration",
                "NZ",
                (0.1, "g"),
                None,
                "2.b.3.d, 2.c.3.b",
            ),
            row(
                "short term: pitch attitude",
                "Q",
                (1.5, "deg"),
                None,
                "2.c.3.b",
            ),
            row(
                "short term: pitch rate",
                "Q",
                (2.0, "deg/s"),
                None,
                "2.c.3.b",
            ),
        ];
        Self {
            source: DEFAULT_SOURCE.to_owned(),
            rows,
        }
    }
}

/// Reasons why a manoeuvre cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceCheckError {
    #[error("there are no samples to compare")]
    NoSamples,
    /// The numbers of simulated and flown samples differ.
    #[error("expected as many simulated samples as flown ones, {flown}, found {simulated}")]
    Lengths {
        /// Number of flown samples.
        flown: usize,
        /// Number of simulated samples.
        simulated: usize,
    },
    /// A sample is missing or not finite.
    #[error("the {of} sample at {time_s:.2} s is missing or not finite")]
    NotFinite {
        /// `flown` or `simulated`.
        of: &'static str,
        /// Its time \[s\].
        time_s: f64,
    },
    #[error("there is no output number {} in the record", output + 1)]
    NoOutput {
        /// Index of the output.
        output: usize,
    },
}

/// One output over one manoeuvre against its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceCheck {
    /// Time of the first sample \[s\].
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Flown samples as compared: integrated if the tolerance applies to an attitude.
    pub flown: Vec<f64>,
    /// Simulated samples as compared.
    pub simulated: Vec<f64>,
    /// Half-width of the corridor around flight at each sample.
    pub width: Vec<f64>,
    /// Number of samples inside the corridor.
    pub inside: usize,
    /// The largest distance beyond the corridor; negative if all samples are inside.
    pub largest_excess: f64,
    /// Time of the largest excess \[s\].
    pub largest_excess_at_s: f64,
    /// The [`moments`] of its samples.
    trend: Vector3<f64>,
}

/// Returns the terms of a correlation: the sums of squares of flown and of simulated samples about
/// their means, and the sum of their products.
fn moments(flown: &[f64], simulated: &[f64]) -> Vector3<f64> {
    let flown_mean = mean(flown);
    let simulated_mean = mean(simulated);
    let of_sample = |(flown, simulated): (&f64, &f64)| {
        let flown = flown - flown_mean;
        let simulated = simulated - simulated_mean;
        Vector3::new(flown * flown, simulated * simulated, flown * simulated)
    };
    flown.iter().zip(simulated).map(of_sample).sum()
}

fn correlation(moments: Vector3<f64>) -> Option<f64> {
    let scale = moments.x.sqrt() * moments.y.sqrt();
    (scale > 0.0).then(|| moments.z / scale)
}

impl ToleranceCheck {
    /// Checks one output over one window of a record, a manoeuvre of its own, against `tolerance`.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] if there is no such output, there are no samples, their numbers
    /// differ, or a sample is not finite.
    pub fn of(
        window: &ValidationWindow,
        tolerance: &ChannelTolerance,
    ) -> Result<Self, ToleranceCheckError> {
        let ValidationWindow {
            start_s,
            sample_time_s,
            ref measured,
            ref simulated,
            ..
        } = *window;
        let output = tolerance.output;
        if output >= measured.ncols().min(simulated.ncols()) {
            return Err(ToleranceCheckError::NoOutput { output });
        }
        if measured.is_empty() {
            return Err(ToleranceCheckError::NoSamples);
        }
        if measured.nrows() != simulated.nrows() {
            return Err(ToleranceCheckError::Lengths {
                flown: measured.nrows(),
                simulated: simulated.nrows(),
            });
        }
        let compared = |of: &'static str, samples: &DMatrix<f64>| {
            let samples: Vec<f64> = samples.column(output).iter().copied().collect();
            match samples.iter().position(|sample| !sample.is_finite()) {
                Some(n) => Err(ToleranceCheckError::NotFinite {
                    of,
                    time_s: start_s + sample_time_s * n as f64,
                }),
                None if tolerance.integrated => Ok(integral(&samples, sample_time_s)),
                None => Ok(samples),
            }
        };
        let flown = compared("flown", measured)?;
        let simulated = compared("simulated", simulated)?;
        let start = flown[0];
        let wider = |flown: &f64| {
            tolerance
                .absolute
                .max(tolerance.relative * (flown - start).abs())
        };
        let width: Vec<f64> = flown.iter().map(wider).collect();
        let excess: Vec<f64> = excesses(&flown, &simulated, &width).collect();
        // The first of equal maxima.
        let (largest, &largest_excess) = excess
            .iter()
            .enumerate()
            .rev()
            .max_by(|a, b| a.1.total_cmp(b.1))
            .ok_or(ToleranceCheckError::NoSamples)?;
        Ok(Self {
            start_s,
            sample_time_s,
            inside: excess.iter().filter(|excess| **excess <= 0.0).count(),
            largest_excess,
            largest_excess_at_s: start_s + sample_time_s * largest as f64,
            trend: moments(&flown, &simulated),
            flown,
            simulated,
            width,
        })
    }

    /// Returns the number of compared samples; at least one.
    pub fn samples(&self) -> usize {
        self.flown.len()
    }

    /// Returns the share of samples inside the corridor, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        self.inside as f64 / self.samples() as f64
    }

    /// Returns the correlation of simulated and flown samples about their means; `None` if either
    /// is constant. For off-axis outputs a positive sign is the correct trend.
    pub fn correlation(&self) -> Option<f64> {
        correlation(self.trend)
    }

    /// Returns the intervals of time \[s\] with samples outside, each from its first to its last
    /// sample.
    pub fn outside(&self) -> Vec<[f64; 2]> {
        let mut parts: Vec<[f64; 2]> = Vec::new();
        let mut was_outside = false;
        for (n, excess) in excesses(&self.flown, &self.simulated, &self.width).enumerate() {
            let time_s = self.start_s + self.sample_time_s * n as f64;
            let is_outside = excess > 0.0;
            match parts.last_mut().filter(|_| was_outside && is_outside) {
                Some(part) => part[1] = time_s,
                None if is_outside => parts.push([time_s; 2]),
                None => {}
            }
            was_outside = is_outside;
        }
        parts
    }
}

fn excesses<'a>(
    flown: &'a [f64],
    simulated: &'a [f64],
    width: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    flown
        .iter()
        .zip(simulated)
        .zip(width)
        .map(|((flown, simulated), width)| (simulated - flown).abs() - width)
}

/// Integrates over time from the first sample by the trapezoidal rule; needs at least one sample.
fn integral(samples: &[f64], sample_time_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let step = |pair: &[f64]| {
        sum += 0.5 * sample_time_s * (pair[0] + pair[1]);
        sum
    };
    let later: Vec<f64> = samples.windows(2).map(step).collect();
    std::iter::once(0.0).chain(later).collect()
}

/// One output over all windows of a record, each with an estimated initial state of its own (M14,
/// 6).
#[derive(Clone, Debug, PartialEq)]
pub struct RecordCheck {
    /// Record index, counted from 0.
    pub record: usize,
    /// The windows in time order; at least one.
    pub windows: Vec<ToleranceCheck>,
}

impl RecordCheck {
    /// Checks the records of `windows` against `tolerance`; every window is a manoeuvre of its own.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] for the first window that cannot be compared.
    pub fn of_windows(
        windows: &[ValidationWindow],
        tolerance: &ChannelTolerance,
    ) -> Result<Vec<Self>, ToleranceCheckError> {
        let mut records: Vec<Self> = Vec::new();
        for window in windows {
            let check = ToleranceCheck::of(window, tolerance)?;
            match records.iter_mut().find(|of| of.record == window.record) {
                Some(of) => of.windows.push(check),
                None => records.push(Self {
                    record: window.record,
                    windows: vec![check],
                }),
            }
        }
        Ok(records)
    }

    /// Returns the share of samples inside the corridor, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        let inside: usize = self.windows.iter().map(|window| window.inside).sum();
        inside as f64
            / self
                .windows
                .iter()
                .map(ToleranceCheck::samples)
                .sum::<usize>() as f64
    }

    /// Returns the window with the largest excess.
    pub fn worst(&self) -> Option<&ToleranceCheck> {
        self.windows
            .iter()
            .max_by(|a, b| a.largest_excess.total_cmp(&b.largest_excess))
    }

    /// Returns the correlation of simulated and flown samples, each about its mean in its window;
    /// `None` if either is constant.
    pub fn correlation(&self) -> Option<f64> {
        correlation(self.windows.iter().map(|window| window.trend).sum())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{dmatrix, dvector};
    use proptest::prelude::*;

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::executor::Sequential;
    use gdcm_model::simulation::{FirstOrderHold, Segment, ValidationSettings, validate};

    use super::*;
    use crate::requirements::known_answers::{answers, number};

    const SAMPLE_TIME_S: f64 = 0.02;

    fn tolerance(absolute: f64, relative: f64) -> ChannelTolerance {
        ChannelTolerance {
            output: 0,
            integrated: false,
            absolute,
            relative,
            unit: "deg/s".into(),
        }
    }

    fn check_of(
        flown: &[f64],
        simulated: &[f64],
        tolerance: &ChannelTolerance,
    ) -> Result<ToleranceCheck, ToleranceCheckError> {
        let column = |samples: &[f64]| DMatrix::from_column_slice(samples.len(), 1, samples);
        let measured = column(flown);
        let simulated = column(simulated);
        let window = ValidationWindow {
            record: 0,
            start_s: 0.0,
            sample_time_s: SAMPLE_TIME_S,
            measured,
            simulated,
        };
        ToleranceCheck::of(&window, tolerance)
    }

    /// The synthetic record of the known answers.
    fn made_up() -> (Vec<f64>, Vec<f64>) {
        let time = || (0..500).map(|n| SAMPLE_TIME_S * f64::from(n));
        let flown = time().map(|t| 8.0 * (0.9 * t).sin() + 2.0).collect();
        (
            flown,
            time().map(|t| 8.6 * (0.9 * t - 0.12).sin() + 2.3).collect(),
        )
    }

    fn outputs() -> Vec<Channel> {
        [
            ("P", "deg/s"),
            ("Q", "rad/s"),
            ("R", "deg/s"),
            ("NZ", "m/s^2"),
        ]
        .map(|(name, unit)| Channel::new(name, unit))
        .to_vec()
    }

    #[test]
    fn shares_and_excesses_are_the_known_ones() {
        let (flown, simulated) = made_up();
        let answers = answers();
        for case in answers["tolerance"]["cases"].as_array().unwrap() {
            let check = check_of(
                &flown,
                &simulated,
                &tolerance(number(case, "absolute"), 0.1),
            )
            .unwrap();
            assert!(
                (check.share_inside() - number(case, "share_inside")).abs() < 1e-12,
                "{case}"
            );
            assert!(
                (check.largest_excess - number(case, "largest_excess")).abs() < 1e-12,
                "{case}"
            );
            let n = (check.largest_excess_at_s / SAMPLE_TIME_S).round() as usize;
            let width = check.width[n];
            assert!(((simulated[n] - flown[n]).abs() - width - check.largest_excess).abs() < 1e-12);
        }
    }

    #[test]
    fn the_parts_outside_hold_the_samples_that_are_outside() {
        let flown = [0.0; 8];
        let simulated = [0.0, 2.0, 3.0, 0.0, -2.0, 1.0, 0.0, 5.0];
        let check = check_of(&flown, &simulated, &tolerance(1.0, 0.1)).unwrap();
        assert_eq!(check.outside(), [[0.02, 0.04], [0.08, 0.08], [0.14, 0.14]]);
        assert_eq!(
            (
                check.inside,
                check.largest_excess,
                check.largest_excess_at_s
            ),
            (4, 4.0, 0.14)
        );
    }

    #[test]
    fn an_attitude_is_the_integral_of_its_rate_from_the_start() {
        let rate: Vec<f64> = (0..101)
            .map(|n| 3.0 * SAMPLE_TIME_S * f64::from(n))
            .collect();
        let none = vec![0.0; 101];
        let attitude = ChannelTolerance {
            integrated: true,
            ..tolerance(1.0, 0.0)
        };
        let check = check_of(&rate, &none, &attitude).unwrap();
        // 3 t^2 / 2: the trapezoidal rule is exact on straight lines.
        assert!((check.flown[100] - 6.0).abs() < 1e-12 && check.flown[0] == 0.0);
        assert!((check.largest_excess - 5.0).abs() < 1e-12);
    }

    #[test]
    fn the_trend_is_the_sign_of_the_correlation_and_none_where_nothing_moves() {
        let (flown, simulated) = made_up();
        let turned: Vec<f64> = simulated.iter().map(|y| -y).collect();
        let of = |simulated: &[f64]| {
            check_of(&flown, simulated, &tolerance(1.0, 0.1))
                .unwrap()
                .correlation()
        };
        assert!(of(&simulated).unwrap() > 0.9 && of(&turned).unwrap() < -0.9);
        assert_eq!(of(&[4.0; 500]), None);
    }

    #[test]
    fn a_record_of_several_windows_counts_every_sample_once() {
        let window = |record, start_s, simulated: [f64; 4]| ValidationWindow {
            record,
            start_s,
            sample_time_s: 1.0,
            measured: DMatrix::from_column_slice(4, 1, &[0.0, 1.0, 0.0, -1.0]),
            simulated: DMatrix::from_column_slice(4, 1, &simulated),
        };
        let inside = [0.0, 1.0, 0.0, -1.0];
        let windows = [
            window(0, 0.0, inside),
            window(2, 0.0, inside),
            window(0, 4.0, [0.0, 5.0, 0.0, -1.0]),
        ];
        let records = RecordCheck::of_windows(&windows, &tolerance(0.5, 0.1)).unwrap();
        assert_eq!(
            records
                .iter()
                .map(|of| (of.record, of.windows.len()))
                .collect::<Vec<_>>(),
            [(0, 2), (2, 1)]
        );
        assert_eq!(
            (records[0].share_inside(), records[1].share_inside()),
            (7.0 / 8.0, 1.0)
        );
        let worst = records[0].worst().unwrap();
        assert_eq!(
            (worst.largest_excess, worst.largest_excess_at_s),
            (3.5, 5.0)
        );
        assert!(
            records[1].correlation().unwrap() > 0.999 && records[0].correlation().unwrap() < 0.999
        );
        let other = ChannelTolerance {
            output: 1,
            ..tolerance(0.5, 0.1)
        };
        let refused = RecordCheck::of_windows(&windows, &other).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "there is no output number 2 in the record"
        );
    }

    #[test]
    fn the_model_that_flew_is_inside_and_one_of_half_its_gain_is_not() {
        let model = |gain: f64| {
            StateSpace::new(dmatrix![-2.0], dmatrix![gain], dmatrix![1.0], dmatrix![0.0]).unwrap()
        };
        let stick = DMatrix::from_fn(1000, 1, |n, _| {
            10.0 * (0.8 * SAMPLE_TIME_S * n as f64).sin()
        });
        let held = FirstOrderHold::new(&model(2.0), SAMPLE_TIME_S).unwrap();
        let flown = held.simulate(&dvector![1.0], &stick);
        let segment = Segment {
            record: 0,
            start_s: 0.0,
            sample_time_s: SAMPLE_TIME_S,
            inputs: stick,
            outputs: flown,
        };
        let record = |gain: f64| {
            let settings = ValidationSettings::unfiltered();
            let validation = validate(
                &model(gain),
                std::slice::from_ref(&segment),
                &settings,
                &Sequential,
            )
            .unwrap();
            RecordCheck::of_windows(&validation.windows, &tolerance(1.0, 0.1))
                .unwrap()
                .remove(0)
        };
        let right = record(2.0);
        let wrong = record(1.0);
        assert_eq!((right.windows.len(), right.share_inside()), (2, 1.0));
        assert!(right.correlation().unwrap() > 0.999_999);
        assert!(wrong.share_inside() < 0.5 && wrong.worst().unwrap().largest_excess > 1.0);
        assert!(
            wrong.correlation().unwrap() > 0.9,
            "too small, but the right trend"
        );
    }

    #[test]
    fn samples_that_are_missing_are_refused_in_words() {
        let words = |flown: &[f64], simulated: &[f64]| {
            check_of(flown, simulated, &tolerance(1.0, 0.1))
                .unwrap_err()
                .to_string()
        };
        assert_eq!(words(&[], &[]), "there are no samples to compare");
        assert_eq!(
            words(&[1.0, 2.0], &[1.0]),
            "expected as many simulated samples as flown ones, 2, found 1"
        );
        assert_eq!(
            words(&[1.0, f64::NAN], &[1.0, 2.0]),
            "the flown sample at 0.02 s is missing or not finite"
        );
    }

    #[test]
    fn the_default_table_is_in_the_units_of_the_dataset() {
        let table = ToleranceTable::default();
        let of = |quantity: &str| {
            table
                .rows()
                .iter()
                .find(|row| row.quantity == quantity)
                .unwrap()
                .of_outputs(&outputs())
                .unwrap()
        };
        assert_eq!(
            (of("roll rate").absolute, of("roll rate").relative),
            (3.0, 0.1)
        );
        assert_eq!(
            (of("bank angle").integrated, of("bank angle").unit.as_str()),
            (true, "deg")
        );
        let pitch = of("pitch attitude");
        assert!(
            (pitch.absolute - 1.5_f64.to_radians()).abs() < 1e-15
                && pitch.unit == "rad"
                && pitch.output == 1
        );
        let normal = of("normal acceleration");
        assert!((normal.absolute - 0.980_665).abs() < 1e-12 && normal.relative == 0.0);
    }

    #[test]
    fn a_tolerance_without_its_channel_is_refused_in_words() {
        let bank = ToleranceTable::default().rows()[1].clone();
        let words = |outputs: &[Channel]| bank.of_outputs(outputs).unwrap_err().to_string();
        assert_eq!(
            words(&outputs()[1..]),
            "\"bank angle\" is not compared: there is no output \"P\""
        );
        let acceleration = [Channel::new("P", "deg/s^2")];
        assert_eq!(
            words(&acceleration),
            "\"bank angle\" is not compared: it is the integral of a rate, and \"P\" in \"deg/s^2\" is none (deg/s, rad/s)"
        );
        let in_g = Tolerance {
            unit: "g".into(),
            integrated: false,
            ..bank.clone()
        };
        let words = in_g.of_outputs(&outputs()).unwrap_err().to_string();
        assert_eq!(
            words,
            "\"bank angle\" is not compared: a tolerance in \"g\" does not fit \"P\" in \"deg/s\""
        );
    }

    #[test]
    fn a_table_comes_back_as_it_was_and_a_wrong_row_is_refused_with_its_place() {
        let table = ToleranceTable::default();
        let text = serde_json::to_string(&table).unwrap();
        assert_eq!(
            serde_json::from_str::<ToleranceTable>(&text).unwrap(),
            table
        );
        assert!(text.contains(r#"{"quantity":"normal acceleration","channel":"NZ","integrated":false,"absolute":0.1,"unit":"g","entry":"2.b.3.d, 2.c.3.b"}"#), "{text}");
        for (from, to, words) in [
            (
                "\"absolute\":2.0",
                "\"absolute\":0.0",
                "tolerance 3, \"pitch rate\": expected absolute above zero, found 0",
            ),
            (
                "\"relative\":0.1",
                "\"relative\":-0.1",
                "tolerance 1, \"roll rate\": expected relative above zero, found -0.1",
            ),
            (
                "\"channel\":\"NZ\"",
                "\"channel\":\" \"",
                "tolerance 7, \"normal acceleration\": expected the name of an output",
            ),
        ] {
            let error = serde_json::from_str::<ToleranceTable>(&text.replacen(from, to, 1))
                .unwrap_err()
                .to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }

    proptest! {
        #[test]
        fn a_model_compared_with_itself_is_inside_wholly(
            flown in prop::collection::vec(-50.0_f64..50.0, 1..200), absolute in 1e-6_f64..5.0, integrated in any::<bool>(),
        ) {
            let check = check_of(&flown, &flown, &ChannelTolerance { integrated, ..tolerance(absolute, 0.1) }).unwrap();
            prop_assert_eq!(check.share_inside(), 1.0);
            prop_assert!(check.largest_excess <= -absolute && check.outside().is_empty());
        }

        #[test]
        fn a_wider_tolerance_leaves_no_fewer_samples_inside(
            pairs in prop::collection::vec((-50.0_f64..50.0, -50.0_f64..50.0), 1..200),
            absolute in 0.1_f64..20.0, more in 0.0_f64..20.0, relative in 0.0_f64..0.5, more_relative in 0.0_f64..0.5,
        ) {
            let (flown, simulated): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            let narrow = check_of(&flown, &simulated, &tolerance(absolute, relative)).unwrap();
            let wide = check_of(&flown, &simulated, &tolerance(absolute + more, relative + more_relative)).unwrap();
            prop_assert!(wide.inside >= narrow.inside && wide.largest_excess <= narrow.largest_excess);
        }
    }
}
