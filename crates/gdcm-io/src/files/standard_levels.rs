//! Level boundaries from ADS-33E-PRF, embedded in the program (M17.1).
//!
//! The standard is a public US Army document. Only boundaries read from a publicly available figure
//! are here; each names its source and the reading error.
//!
//! A level boundary is a polyline over bandwidth and phase delay, with the level of handling
//! qualities that is met on it and to its right.

use std::path::Path;

use gdcm_method::requirements::{AttitudeOutput, LevelBoundaries};
use gdcm_model::dataset::Channel;
use gdcm_model::names::channel_alias::same_channel;

use super::levels_and_tolerances::levels_from_text;
use crate::file_error::FileError;

/// Boundaries for one axis and one category of mission task elements.
#[derive(Debug, PartialEq, Eq)]
pub struct StandardLevels {
    /// Name on the command line.
    pub name: &'static str,
    /// Axis and tasks, in words.
    pub title: &'static str,
    /// Rate and attitude of the axis, under any name that files use for them.
    axis: [&'static str; 2],
    /// File in the format of [`read_levels`](super::levels_and_tolerances::read_levels).
    text: &'static str,
}

/// The boundaries to choose from.
pub static STANDARD_LEVELS: [StandardLevels; 2] = [
    StandardLevels {
        name: "ads-33e-prf-yaw-tracking",
        title: "ADS-33E-PRF, yaw: target acquisition and tracking",
        axis: ["R", "psi"],
        text: include_str!("../../../../assets/levels/ads-33e-prf-yaw-tracking.json"),
    },
    StandardLevels {
        name: "ads-33e-prf-yaw-other-tasks",
        title: "ADS-33E-PRF, yaw: all other tasks",
        axis: ["R", "psi"],
        text: include_str!("../../../../assets/levels/ads-33e-prf-yaw-other-tasks.json"),
    },
];

impl StandardLevels {
    /// Returns the boundaries with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        STANDARD_LEVELS.iter().find(|levels| levels.name == name)
    }

    /// Returns the boundaries for the first of the `outputs` that is the rate or the attitude of
    /// the axis; if there is none, under the axis's standard name.
    ///
    /// # Errors
    /// [`FileError`] if the embedded file is invalid, which a test excludes.
    pub fn boundaries(&self, outputs: &[Channel]) -> Result<LevelBoundaries, FileError> {
        let boundaries = levels_from_text(self.text.as_bytes(), Path::new(self.name))?;
        Ok(match self.output(outputs) {
            Some(output) => boundaries.for_axis(&output.name),
            None => boundaries,
        })
    }

    /// Returns the first output to which the boundaries apply.
    pub fn output<'a>(&self, outputs: &'a [Channel]) -> Option<&'a Channel> {
        outputs.iter().find(|output| {
            AttitudeOutput::classify(output).is_ok()
                && self
                    .axis
                    .iter()
                    .any(|name| same_channel(name, &output.name))
        })
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::requirements::level_boundary::AssessedLevel;

    use super::*;

    fn boundaries(name: &str) -> LevelBoundaries {
        StandardLevels::named(name)
            .unwrap()
            .boundaries(&[])
            .unwrap()
    }

    #[test]
    fn each_boundary_names_its_source_and_the_error_of_reading_it() {
        for levels in &STANDARD_LEVELS {
            let boundaries = levels.boundaries(&[]).unwrap();
            let numbers: Vec<Option<u32>> = boundaries
                .as_slice()
                .iter()
                .map(|boundary| boundary.level)
                .collect();
            assert_eq!(numbers, [Some(1), Some(2)], "{}", levels.name);
            for boundary in boundaries.as_slice() {
                for word in ["ADS-33E-PRF", "3.3.5.1", "rad/s"] {
                    assert!(boundary.source.contains(word), "{}", boundary.source);
                }
            }
        }
    }

    /// Points whose level can be read from the grid lines of the figure without interpolation.
    #[test]
    fn points_of_the_figure_have_the_levels_that_it_shows() {
        let tracking = boundaries("ads-33e-prf-yaw-tracking");
        let other = boundaries("ads-33e-prf-yaw-other-tasks");
        for (boundaries, omega, delay_s, level) in [
            (&tracking, 4.0, 0.1, 1),
            (&tracking, 3.0, 0.1, 2),
            (&tracking, 4.0, 0.3, 2),
            (&tracking, 1.0, 0.1, 3),
            (&tracking, 3.0, 0.3, 3),
            (&other, 3.0, 0.1, 1),
            (&other, 4.0, 0.3, 1),
            (&other, 1.0, 0.1, 2),
            (&other, 3.0, 0.3, 2),
            (&other, 1.0, 0.3, 3),
            (&other, 0.3, 0.1, 3),
        ] {
            assert_eq!(
                boundaries.level("R", omega, delay_s),
                Some(AssessedLevel::Level(level)),
                "{omega} rad/s, {delay_s} s"
            );
        }
        // Beyond 0.4 s nothing is drawn.
        assert_eq!(
            other.level("R", 5.0, 0.45),
            Some(AssessedLevel::AboveBoundaries)
        );
    }

    #[test]
    fn boundaries_apply_to_the_yaw_output_of_the_dataset_under_its_name() {
        let outputs = [
            Channel::new("roll rate", "deg/s"),
            Channel::new("yaw rate", "deg/s"),
        ];
        let levels = &STANDARD_LEVELS[0];
        let boundaries = levels.boundaries(&outputs).unwrap();
        assert!(boundaries.assesses("yaw rate") && !boundaries.assesses("R"));
        assert_eq!(levels.output(&outputs[..1]), None);
        let force = [Channel::new("yaw", "N")];
        assert_eq!(levels.output(&force), None, "not an attitude");
    }
}
