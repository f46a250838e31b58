//! Colours by meaning and strength, and their values on paper.

/// Meaning of a colour. The window's dark theme and its light theme assign different colours to it;
/// paper has nearly all colours of the light theme.
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
    /// The comparison band, and highlights.
    Accent,
    /// Cautions and deteriorations.
    Warning,
    /// Improvements, and the envelopes of unnoticeable errors.
    Good,
    /// Airspeed, from 0 at the lowest to 255 at the highest; the colours in `AIRSPEED_STOPS` differ
    /// in lightness, and no role has them.
    OfAirspeed(u8),
}

impl Hue {
    /// Returns red, green and blue on paper (sRGB), mostly as in the light theme.
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
                let place = AirspeedPlace::new(step);
                return mixed(
                    channels(AIRSPEED_STOPS[place.stop]),
                    channels(AIRSPEED_STOPS[place.stop + 1]),
                    place.part,
                );
            }
        };
        channels(rgb)
    }
}

/// Airspeed colours on paper and in the light theme, at equal distances from the lowest to the
/// highest airspeed.
const AIRSPEED_STOPS: [u32; 5] = [0x3a1f7a, 0x7a2f95, 0xb04487, 0xcf6f8f, 0xdd9aa4];

/// An airspeed's place between two of the five colours in a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirspeedPlace {
    /// Index of the colour below, from 0 to 3.
    pub stop: usize,
    /// Share from the colour above, from 0 to 1.
    pub part: f64,
}

impl AirspeedPlace {
    /// Returns the place for an airspeed from 0 at the lowest to 255 at the highest.
    pub fn new(step: u8) -> Self {
        let intervals = (AIRSPEED_STOPS.len() - 1) as f64;
        let place = f64::from(step) / 255.0 * intervals;
        let stop = place.floor().min(intervals - 1.0);
        Self {
            stop: stop as usize,
            part: place - stop,
        }
    }
}

fn channels(rgb: u32) -> [u8; 3] {
    [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8]
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
    /// Paper background.
    pub const WHITE: Self = Self::new(Hue::Background);
    /// Titles and primary text.
    pub const INK: Self = Self::new(Hue::Text);
    /// Labels, frames and secondary text.
    pub const DIM: Self = Self::new(Hue::DimText);
    /// Grid lines.
    pub const GRID: Self = Self::new(Hue::Grid);

    /// Creates a colour at full strength.
    pub const fn new(hue: Hue) -> Self {
        Self { hue, percent: 100 }
    }

    /// Returns this colour blended with the background; at `percent` = 100 it is unchanged.
    pub const fn tint(self, percent: u8) -> Self {
        Self { percent, ..self }
    }

    /// Returns red, green and blue on paper (sRGB), blended with white according to the strength.
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
    fn the_ramp_of_airspeeds_runs_through_its_colours() {
        let ramp = [0, 64, 128, 191, 255].map(|step| Hue::OfAirspeed(step).on_paper());
        for (found, stop) in ramp.into_iter().zip(AIRSPEED_STOPS) {
            for (found, stop) in found.into_iter().zip(channels(stop)) {
                // A step of the ramp changes a channel by less than 2.
                assert!(found.abs_diff(stop) <= 2, "{found} instead of {stop}");
            }
        }
        assert_eq!(ramp[0], channels(AIRSPEED_STOPS[0]));
        assert_eq!(ramp[4], channels(AIRSPEED_STOPS[4]));
    }

    #[test]
    fn a_tint_lies_between_the_colour_and_white() {
        let color = Color::new(Hue::Nominal);
        assert_eq!(color.rgb(), [0xc6, 0x2f, 0x2f]);
        assert_eq!(color.tint(0).rgb(), [255, 255, 255]);
        assert_eq!(color.tint(50).rgb(), [227, 151, 151]);
    }
}
