//! Line styles.

use super::color::Color;

/// Dash pattern, which distinguishes lines without colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dash {
    #[default]
    Solid,
    Long,
    Short,
    Dotted,
    /// Dashes with a dot between them.
    DashDot,
    /// Short dashes with a dot between them.
    ShortDashDot,
}

impl Dash {
    /// Returns dash and gap lengths alternately \[pt\]; empty for a solid line.
    pub fn pattern_pt(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Long => &[7.0, 2.0],
            Self::Short => &[3.0, 1.6],
            Self::Dotted => &[0.9, 1.7],
            Self::DashDot => &[6.0, 1.8, 1.2, 1.8],
            Self::ShortDashDot => &[3.0, 1.5, 1.0, 1.5],
        }
    }
}

/// Line style: colour, width and dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    pub color: Color,
    pub width_pt: f64,
    pub dash: Dash,
}

impl Stroke {
    /// Creates a solid line.
    pub const fn solid(color: Color, width_pt: f64) -> Self {
        Self {
            color,
            width_pt,
            dash: Dash::Solid,
        }
    }

    /// Creates a dashed line.
    pub const fn dashed(color: Color, width_pt: f64, dash: Dash) -> Self {
        Self {
            color,
            width_pt,
            dash,
        }
    }

    /// Returns this line as printed: thinner than in the window, because paper resolves more.
    pub fn printed(self) -> Self {
        Self {
            width_pt: Self::PRINTED * self.width_pt,
            ..self
        }
    }

    /// Line width on paper, relative to the width in the window.
    const PRINTED: f64 = 0.55;
}
