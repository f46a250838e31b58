//! Reasons for how a column in a frequency response table was interpreted.

/// Reason for choosing the quantity of a column.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantityReason {
    #[error("its name is \"{0}\"")]
    Name(String),
    #[error("its name contains \"{0}\"")]
    WordInName(String),
    #[error("its unit is {0}")]
    Unit(&'static str),
    #[error("its unit is an angle")]
    UnitOfAngle,
    #[error("its name is between vertical bars")]
    VerticalBars,
    #[error("its name has an angle sign")]
    AngleSign,
    /// Neither name nor unit gives the quantity.
    #[error("")]
    Unknown,
}

/// Reason for choosing the unit of a column, appended to the reason for its quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitReason {
    /// The unit does not affect the interpretation.
    #[error("")]
    NotNeeded,
    #[error(", and its unit is {0}")]
    Unit(String),
    /// The quantity implies the unit.
    #[error(", which implies the unit")]
    Implied,
    #[error(", and its unit is not dB")]
    NotDecibel,
    #[error(", and some of its numbers are negative")]
    NegativeNumbers,
    #[error(", and some of its numbers are above 1")]
    NumbersAboveOne,
    #[error(", and its unit is γ, so that the values are squared")]
    NotSquared,
}
