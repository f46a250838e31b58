//! Reasons why a level boundary in a file is invalid: it has no name, no axis, too few points or
//! invalid ones, or does not give a level as it has to (`level_boundary`).

use gdcm_model::message_text::quoted;
use gdcm_model::units::number;

/// Reasons why a level boundary is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LevelBoundaryError {
    #[error("boundary {entry}: expected a name, found none")]
    NoName {
        /// Entry number, counted from 1.
        entry: usize,
    },
    #[error(
        "boundary {entry}, {}: expected the name of an output as its axis, found none",
        quoted(name)
    )]
    NoAxis {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
    },
    #[error(
        "boundary {entry}, {}: expected at least 2 points, found {found}",
        quoted(name)
    )]
    TooFewPoints {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
        found: usize,
    },
    /// A point has a coordinate that is negative or not finite.
    #[error(
        "boundary {entry}, {}, point {point}: expected a bandwidth (rad/s) and a phase delay (s) not below zero, found {} and {}",
        quoted(name), number(found[0]), number(found[1])
    )]
    Point {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
        /// Point number, counted from 1.
        point: usize,
        found: [f64; 2],
    },
    #[error(
        "boundary {entry}, {}: expected a level of 1 or more, found 0",
        quoted(name)
    )]
    LevelZero {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
    },
    /// Bandwidth or phase delay decreases along a boundary that gives a level.
    #[error(
        "boundary {entry}, {}, point {point}: expected a bandwidth and a phase delay not below those of the point before, because the boundary gives a level",
        quoted(name)
    )]
    Descending {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
        /// Point number, counted from 1.
        point: usize,
    },
    #[error(
        "boundary {entry}, {}: expected one boundary of level {level} for {}, found a second",
        quoted(name),
        quoted(axis)
    )]
    DuplicateLevel {
        /// Entry number, counted from 1.
        entry: usize,
        name: String,
        axis: String,
        level: u32,
    },
}

impl LevelBoundaryError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoName { .. } => "level-without-name",
            Self::NoAxis { .. } => "level-without-axis",
            Self::TooFewPoints { .. } => "too-few-level-points",
            Self::Point { .. } => "level-point",
            Self::LevelZero { .. } => "level-zero",
            Self::Descending { .. } => "level-descending",
            Self::DuplicateLevel { .. } => "duplicate-level",
        }
    }
}
