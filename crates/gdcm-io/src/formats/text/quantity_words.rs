//! Quantities and units in frequency response tables, with the words in column names that denote
//! them.

/// Column content in a frequency response table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Standard deviation, which is not used.
    Error,
    Coherence,
    Magnitude,
    Phase,
    Real,
    Imaginary,
    Frequency,
}

/// Units that determine how a column is interpreted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KnownUnit {
    RadianPerSecond,
    Hertz,
    Decibel,
    Degree,
    Radian,
    Percent,
    /// Coherence γ.
    Gamma,
    /// Squared coherence γ².
    GammaSquared,
    /// `rps`, which may mean radians or revolutions per second.
    Rps,
    /// Any other unit, such as that of a magnitude or a real part.
    Other,
}

/// Words in column names that indicate a quantity. The first quantity with a word in the name
/// applies: "phase error" is an error.
pub(super) const WORDS: [(Quantity, &[&str]); 7] = [
    (
        Quantity::Error,
        &[
            "error",
            "err",
            "std",
            "sd",
            "stdev",
            "stddev",
            "deviation",
            "sigma",
            "uncertainty",
            "eps",
        ],
    ),
    (
        Quantity::Coherence,
        &[
            "coherence",
            "coher",
            "coh",
            "gamma",
            "gamma2",
            "gam",
            "gam2",
            "gammasq",
            "γ",
            "γ²",
            "γ2",
            "cxy",
        ],
    ),
    (
        Quantity::Magnitude,
        &[
            "magnitude",
            "mag",
            "amplitude",
            "ampl",
            "amp",
            "gain",
            "abs",
            "modulus",
        ],
    ),
    (
        Quantity::Phase,
        &["phase", "phas", "phs", "pha", "ph", "angle", "arg"],
    ),
    (Quantity::Real, &["real", "re"]),
    (Quantity::Imaginary, &["imaginary", "imag", "img", "im"]),
    (
        Quantity::Frequency,
        &[
            "frequency",
            "frequencies",
            "freq",
            "frq",
            "omega",
            "om",
            "ω",
        ],
    ),
];

/// Units that may follow a name without brackets.
pub(super) const UNIT_ENDINGS: [(&str, KnownUnit); 13] = [
    ("rad/s", KnownUnit::RadianPerSecond),
    ("rad/sec", KnownUnit::RadianPerSecond),
    ("rad_s", KnownUnit::RadianPerSecond),
    ("rad_sec", KnownUnit::RadianPerSecond),
    ("rads", KnownUnit::RadianPerSecond),
    ("rps", KnownUnit::Rps),
    ("hz", KnownUnit::Hertz),
    ("db", KnownUnit::Decibel),
    ("deg", KnownUnit::Degree),
    ("rad", KnownUnit::Radian),
    ("percent", KnownUnit::Percent),
    ("pct", KnownUnit::Percent),
    ("%", KnownUnit::Percent),
];

/// Characters that may separate a name from its unit.
pub(super) const BEFORE_UNIT: [char; 6] = ['_', ' ', '-', '.', '/', ','];

/// Words that indicate a magnitude as a ratio, not in decibels.
pub(super) const ABSOLUTE: [&str; 6] = ["abs", "absolute", "lin", "linear", "ratio", "modulus"];
