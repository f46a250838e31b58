//! Colours by meaning and strength, and their values on paper.

/// Meaning of a colour. Paper and each theme of the window assign a different colour to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hue {
    /// Paper, and plot backgrounds in the window.
    Background,
    Grid,
    /// Titles and primary text.
    Text,
    /// Labels, frames and secondary text.
    DimText,
    /// The nominal physics model.
    Nominal,
    /// The other physics models.
    Perturbed,
    /// Models identified from flight.
    Identified,
    /// Corrected models and the schedule.
    Corrected,
    /// Excluded models and conditions.
    Rejected,
    /// The band of comparison, and highlights.
    Accent,
    /// Cautions and deteriorations.
    Warning,
    /// Proofs of optimality, and improvements.
    Good,
    /// Airspeed, from 0 in the colour of perturbed models to 255 in the colour of identified
    /// models; distinguishable by colour-blind readers.
    OfAirspeed(u8),
}

impl Hue {
    /// Returns red, green and blue on paper (sRGB): the light theme's colours on white.
    pub fn on_paper(self) -> [u8; 3] {
        let rgb: u32 = match self {
            Self::Background => 0xffffff,
            Self::Grid => 0xdfe2e7,
            Self::Text => 0x22262e,
            Self::DimText => 0x586070,
            Self::Nominal => 0xc62f2f,
            Self::Perturbed => 0x3566c8,
            Self::Identified => 0xb57a00,
            Self::Corrected => 0x1d8a47,
            Self::Rejected => 0x646c79,
            Self::Accent => 0x1b67a6,
            Self::Warning => 0xa9410a,
            Self::Good => 0x187049,
            Self::OfAirspeed(step) => {
                return mixed(
                    Self::Perturbed.on_paper(),
                    Self::Identified.on_paper(),
                    f64::from(step) / 255.0,
                );
            }
        };
        [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8]
    }
}

/// Interpolates linearly between two colours: `part` = 0 gives `from`, `part` = 1 gives `to`.
fn mixed(from: [u8; 3], to: [u8; 3], part: f64) -> [u8; 3] {
    let mut mixed = [0; 3];
    for (channel, mixed) in mixed.iter_mut().enumerate() {
        let start = f64::from(from[channel]);
        let end = f64::from(to[channel]);
        *mixed = (start + part * (end - start)).round() as u8;
    }
    mixed
}

/// A colour, given by its meaning and strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    pub hue: Hue,
    /// Strength \[%\]: 100 is the full colour, 0 the background.
    pub percent: u8,
}

impl Color {
    /// Background colour of paper.
    pub const WHITE: Self = Self::new(Hue::Background);
    /// Colour of titles and primary text.
    pub const INK: Self = Self::new(Hue::Text);
    /// Colour of labels, frames and secondary text.
    pub const DIM: Self = Self::new(Hue::DimText);
    /// Colour of grid lines.
    pub const GRID: Self = Self::new(Hue::Grid);

    /// Creates a colour at full strength.
    pub const fn new(hue: Hue) -> Self {
        Self { hue, percent: 100 }
    }

    /// Returns this colour blended with the background to a strength of `percent`.
    pub const fn tint(self, percent: u8) -> Self {
        Self { percent, ..self }
    }

    /// Returns red, green and blue on paper (sRGB), blended to the strength of this colour.
    pub fn rgb(self) -> [u8; 3] {
        mixed(
            Hue::Background.on_paper(),
            self.hue.on_paper(),
            f64::from(self.percent.min(100)) / 100.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tint_lies_between_the_colour_and_white() {
        let color = Color::new(Hue::Nominal);
        assert_eq!(color.rgb(), [0xc6, 0x2f, 0x2f]);
        assert_eq!(color.tint(0).rgb(), [255, 255, 255]);
        assert_eq!(color.tint(50).rgb(), [227, 151, 151]);
    }
}
