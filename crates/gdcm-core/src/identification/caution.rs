//! What the engineer should know of the flight records.

use super::clock::quantile;
use super::preparation::{Hold, Preparation};
use super::signal::names;
use super::{FlightRecord, Piece, Role, Signal};
use nalgebra::DMatrix;
use std::fmt;

/// A channel with more equal consecutive samples than this while it moves is a stair (M14, 1.3).
const STAIR: f64 = 0.5;
/// Equal samples for longer than this are a channel that does not move, and no stair \[s\].
const STANDING_S: f64 = 1.0;
/// With fewer samples than this in motion nothing is said about stairs.
const SAMPLES_IN_MOTION: usize = 50;
/// Two inputs with a correlation beyond this are moved together.
const TOGETHER: f64 = 0.99;
/// An output with a correlation to an input beyond this is a copy of it, and so is an output of another output.
const COPY: f64 = 0.9999;

/// Something in the flight records that may spoil the identification, or that was done to them.
#[derive(Clone, Debug, PartialEq)]
pub enum Caution {
    /// A record with uneven sample times was interpolated, as allowed.
    Resampled {
        /// The record's name.
        record: String,
        /// 95th percentile of the deviation from multiples of the sample time \[%\].
        percent: f64,
    },
    /// What is left between two gaps is too short.
    PieceDropped {
        /// The record's name.
        record: String,
        /// Where it begins \[s\].
        start_s: f64,
        /// Its length \[s\].
        length_s: f64,
    },
    /// Nothing of a record is used.
    RecordUnused {
        /// The record's name.
        record: String,
    },
    /// Most consecutive samples of a channel in motion are equal.
    Stair {
        /// The channel.
        signal: Signal,
        /// Share of equal samples \[%\].
        percent: f64,
        /// Median time from one change to the next \[s\].
        hold_s: f64,
    },
    /// A value that cannot be right in the channel's unit.
    UnlikelyUnit {
        /// The channel.
        signal: Signal,
        /// Its greatest modulus.
        greatest: f64,
        /// The greatest that is right.
        limit: f64,
    },
    /// Two inputs always move together.
    MovedTogether {
        /// The inputs.
        signals: [Signal; 2],
        /// Their correlation.
        correlation: f64,
    },
    /// An output is a copy of another channel.
    Copy {
        /// The output.
        copy: Signal,
        /// The channel that it copies.
        of: Signal,
    },
}

impl fmt::Display for Caution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Resampled { record, percent } => {
                write!(f, "{record}: the sample time varies by {percent:.0} %; it was interpolated to even steps")
            }
            Self::PieceDropped { record, start_s, length_s } => {
                write!(f, "{record}: {length_s:.1} s from {start_s:.2} s were left out, too short between gaps")
            }
            Self::RecordUnused { record } => write!(f, "{record}: nothing of it could be used"),
            Self::Stair { signal, percent, hold_s } => stair(f, signal, *percent, 1e3 * hold_s),
            Self::UnlikelyUnit { signal, greatest, limit } => {
                write!(f, "{signal} reaches {greatest:.3}, beyond {limit}: check its unit")
            }
            Self::MovedTogether { signals, correlation } => {
                let names = names(signals);
                write!(
                    f,
                    "{names} always moved together (correlation {correlation:.3}): their effects cannot be told apart"
                )
            }
            Self::Copy { copy, of } => write!(f, "{copy} is a copy of the {} {of}: leave it out", of.role),
        }
    }
}

fn stair(f: &mut fmt::Formatter<'_>, signal: &Signal, percent: f64, hold_ms: f64) -> fmt::Result {
    write!(
        f,
        "{signal}: {percent:.0} % of consecutive samples are equal, it changes every {hold_ms:.0} ms. Say which it is: "
    )?;
    if signal.role == Role::Input {
        write!(f, "a command held and logged once a hold (moved {:.0} ms later), ", 0.5 * hold_ms)?;
    }
    write!(f, "a slow sensor (only fresh samples kept, or moved {:.0} ms earlier), ", 0.5 * hold_ms)?;
    f.write_str("or stairs that are right as they are (nothing done, as now)")
}

/// The cautions about channels, from the records as logged and the pieces made of them.
pub(super) fn channel_cautions(records: &[FlightRecord], pieces: &[Piece], preparation: &Preparation) -> Vec<Caution> {
    let mut cautions = Vec::new();
    for (signal, channel) in preparation.channels() {
        let samples = |record| samples(record, &signal);
        let greatest = pieces.iter().map(|piece| column(piece, &signal).amax()).fold(0.0, f64::max);
        if let Some(limit) = channel.limit.filter(|limit| greatest > *limit) {
            cautions.push(Caution::UnlikelyUnit { signal: signal.clone(), greatest, limit });
        }
        if channel.hold == Hold::None
            && let Some((share, hold_s)) = stairs(records.iter().map(samples))
        {
            cautions.push(Caution::Stair { signal, percent: 100.0 * share, hold_s });
        }
    }
    cautions.extend(correlated(pieces, preparation));
    cautions
}

/// Stamps and values of a channel in `record` where both are there.
fn samples(record: &FlightRecord, signal: &Signal) -> Vec<(f64, f64)> {
    let column = match signal.role {
        Role::Input => record.inputs.column(signal.index),
        Role::Output => record.outputs.column(signal.index),
    };
    let stamped = record.time_s.iter().copied().zip(column.iter().copied());
    stamped.filter(|(time, value)| time.is_finite() && value.is_finite()).collect()
}

/// A channel of a piece.
fn column<'a>(piece: &'a Piece, signal: &Signal) -> nalgebra::DVectorView<'a, f64> {
    match signal.role {
        Role::Input => piece.inputs.column(signal.index),
        Role::Output => piece.outputs.column(signal.index),
    }
}

/// Share of equal consecutive samples in a channel while it moves, and the median time between changes \[s\]; none where
/// the share is a half or less.
fn stairs(records: impl Iterator<Item = Vec<(f64, f64)>>) -> Option<(f64, f64)> {
    let (mut samples, mut steps) = (0, Vec::new());
    for record in records {
        let runs: Vec<_> = record.chunk_by(|a, b| a.1 == b.1).collect();
        for pair in runs.windows(2) {
            let held_s = pair[1][0].0 - pair[0][0].0;
            if held_s <= STANDING_S {
                samples += pair[0].len();
                steps.push(held_s);
            }
        }
    }
    let share = 1.0 - steps.len() as f64 / samples.max(1) as f64;
    (samples >= SAMPLES_IN_MOTION && share > STAIR).then(|| (share, quantile(steps, 0.5)))
}

/// Channels that move together, by their correlation over all pieces.
fn correlated(pieces: &[Piece], preparation: &Preparation) -> Vec<Caution> {
    let signals: Vec<Signal> = preparation.channels().map(|(signal, _)| signal).collect();
    let mut covariance = DMatrix::zeros(signals.len(), signals.len());
    for piece in pieces {
        let mut centred = DMatrix::zeros(piece.inputs.nrows(), signals.len());
        for (signal, mut centre) in signals.iter().zip(centred.column_iter_mut()) {
            centre.copy_from(&column(piece, signal));
            let mean = centre.mean();
            centre.add_scalar_mut(-mean);
        }
        covariance += centred.tr_mul(&centred);
    }
    let mut cautions = Vec::new();
    for (second, b) in signals.iter().enumerate() {
        for (first, a) in signals.iter().enumerate().take(second) {
            let power = (covariance[(first, first)] * covariance[(second, second)]).sqrt();
            let correlation: f64 = covariance[(first, second)] / power;
            match b.role {
                Role::Input if correlation.abs() > TOGETHER => {
                    cautions.push(Caution::MovedTogether { signals: [a.clone(), b.clone()], correlation });
                }
                Role::Output if correlation.abs() > COPY => {
                    cautions.push(Caution::Copy { copy: b.clone(), of: a.clone() })
                }
                Role::Input | Role::Output => {}
            }
        }
    }
    cautions
}
