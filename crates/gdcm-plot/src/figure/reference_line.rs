//! Reference lines in plots of responses and errors: G and D, bounds, quantiles and envelopes.

use super::bode_curve::Pane;
use super::drawing::{Color, Dash, Hue, Stroke};

/// Number of intervals that divide a line which is not straight over `log10 omega`.
const POINTS: usize = 80;

/// Frequency dependence of a reference line.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// The same value at every frequency.
    Constant(f64),
    /// Slope times omega \[rad/s\]; for example, a delay's phase.
    ProportionalToOmega(f64),
    /// `[omega, value]` with omega \[rad/s\] ascending.
    Sampled(Vec<[f64; 2]>),
}

impl Level {
    /// Returns the value at omega \[rad/s\]. A sampled level is NaN except at its
    /// samples.
    pub fn at(&self, omega: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::ProportionalToOmega(slope) => slope * omega,
            Self::Sampled(points) => match points.iter().find(|[at, _]| *at == omega) {
                Some([_, value]) => *value,
                None => f64::NAN,
            },
        }
    }

    /// Returns points `[log10 omega, value]` along the line between two values of `log10 omega`;
    /// for a sampled level, all samples.
    pub fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        match self {
            Self::Constant(value) => vec![[from, *value], [to, *value]],
            Self::ProportionalToOmega(slope) => (0..=POINTS)
                .map(|point| from + (to - from) * point as f64 / POINTS as f64)
                .map(|log_omega| [log_omega, slope * 10f64.powf(log_omega)])
                .collect(),
            Self::Sampled(points) => points
                .iter()
                .map(|[omega, value]| [omega.log10(), *value])
                .collect(),
        }
    }
}

/// Meaning of a reference line; labels are placed in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReferenceKind {
    /// Delta gain G or delta delay D: the gain or the delay that the physics model lacks, to which
    /// the correction is fitted (M6).
    Delta,
    /// Lower or upper channel bound.
    Bound,
    /// Quantile of the error over the band.
    Quantile,
    /// Envelope for maximum unnoticeable added dynamics.
    Envelope,
}

impl ReferenceKind {
    /// Returns the line style used in the window.
    pub fn line(self) -> Stroke {
        match self {
            Self::Delta => Stroke::dashed(Color::INK, 0.9, Dash::Dotted),
            Self::Bound => Stroke::dashed(Color::new(Hue::Warning), 1.0, Dash::DashDot),
            Self::Quantile => Stroke::dashed(Color::DIM, 0.9, Dash::Short),
            Self::Envelope => Stroke::solid(Color::new(Hue::Good), 1.0),
        }
    }

    /// Returns the text in the legend, for lines without a label in the plot.
    pub fn key(self) -> &'static str {
        match self {
            Self::Delta => "delta gain, delta delay",
            Self::Bound => "bounds",
            Self::Quantile => "quantiles",
            Self::Envelope => "unnoticeable within (MUAD)",
        }
    }
}

/// A labelled line across a panel, with which curves are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    pub pane: Pane,
    pub kind: ReferenceKind,
    /// Meaning and value: `G 0.83 (−1.7 dB)`.
    pub label: String,
    /// Appended to the label if there is room: `, median over the band`. May be empty.
    pub note: String,
    pub level: Level,
}

impl ReferenceLine {
    /// Creates a line without a note.
    pub(super) fn new(
        pane: Pane,
        kind: ReferenceKind,
        label: impl Into<String>,
        level: Level,
    ) -> Self {
        Self {
            pane,
            kind,
            label: label.into(),
            note: String::new(),
            level,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_of_a_delay_is_proportional_to_frequency() {
        assert_eq!(
            Level::Constant(3.0).points(0.0, 1.0),
            [[0.0, 3.0], [1.0, 3.0]]
        );
        let points = Level::ProportionalToOmega(-2.0).points(0.0, 1.0);
        assert_eq!(
            (points.first(), points.last()),
            (Some(&[0.0, -2.0]), Some(&[1.0, -20.0]))
        );
        assert_eq!(
            Level::Sampled(vec![[100.0, 5.0]]).points(0.0, 1.0),
            [[2.0, 5.0]]
        );
    }
}
