//! How lines and grounds look on paper.

/// A colour, as on a screen (sRGB).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    /// Red, green and blue, 0 to 255.
    pub rgb: [u8; 3],
}

impl Color {
    /// Paper.
    pub const WHITE: Self = Self::new(0xff, 0xff, 0xff);
    /// Titles and what is read first.
    pub const INK: Self = Self::new(0x22, 0x26, 0x2e);
    /// Labels, frames, and what is read second.
    pub const DIM: Self = Self::new(0x4a, 0x51, 0x5c);
    /// Grid lines.
    pub const GRID: Self = Self::new(0xdf, 0xe2, 0xe7);

    /// The colour of these parts, 0 to 255 each.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue] }
    }

    /// The colour that is this part of the way to another one.
    pub fn mixed(self, other: Self, part: f64) -> Self {
        let mix = |from: u8, to: u8| (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8;
        Self { rgb: std::array::from_fn(|at| mix(self.rgb[at], other.rgb[at])) }
    }

    /// This colour thinned with white; 1 leaves it as it is, 0 leaves white.
    pub fn tint(self, strength: f64) -> Self {
        Self::WHITE.mixed(self, strength.clamp(0.0, 1.0))
    }
}

/// What parts a line consists of: tells lines apart where colours do not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dash {
    /// One unbroken line.
    #[default]
    Solid,
    /// Long dashes.
    Long,
    /// Short dashes.
    Short,
    /// Dots.
    Dotted,
    /// Dashes with a dot between them.
    DashDot,
    /// Dashes with two dots between them.
    DashDotDot,
}

impl Dash {
    /// Lengths of dashes and gaps in turn \[pt\]; none of a solid line.
    pub fn pattern_pt(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Long => &[7.0, 2.0],
            Self::Short => &[3.0, 1.6],
            Self::Dotted => &[0.9, 1.7],
            Self::DashDot => &[6.0, 1.8, 1.2, 1.8],
            Self::DashDotDot => &[5.0, 1.6, 1.2, 1.6, 1.2, 1.6],
        }
    }
}

/// Colour, width and dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width \[pt\].
    pub width_pt: f64,
    /// Dashes.
    pub dash: Dash,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(color: Color, width_pt: f64) -> Self {
        Self { color, width_pt, dash: Dash::Solid }
    }

    /// A line of dashes.
    pub const fn dashed(color: Color, width_pt: f64, dash: Dash) -> Self {
        Self { color, width_pt, dash }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tint_lies_between_the_colour_and_white() {
        let color = Color::new(200, 0, 100);
        assert_eq!(color.tint(1.0), color);
        assert_eq!(color.tint(0.0), Color::WHITE);
        assert_eq!(color.tint(0.5), Color::new(228, 128, 178));
    }
}
