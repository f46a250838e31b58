//! Handling-qualities level boundaries over bandwidth and phase delay, read from a user file
//! (M17.1).
//!
//! No boundaries are built in, because they depend on the mission task element and the category
//! (ADS-33E-PRF, figures 5, 6, 11 and 12).

use serde::{Deserialize, Serialize};

use gdcm_model::message_text::quoted;
use gdcm_model::units::number;

/// A boundary: a polyline in the plane of bandwidth and phase delay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelBoundary {
    /// Level name ("Level 1").
    pub name: String,
    /// Output to which the boundary applies ("P").
    pub axis: String,
    /// Points \[rad/s, s\]: bandwidth and phase delay, in drawing order; at least two.
    pub points: Vec<[f64; 2]>,
}

/// The boundaries in a file, `[{"name": "Level 1", "axis": "P", "points": [[omega, tau], ...]}]`;
/// each is checked on reading.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<LevelBoundary>")]
pub struct LevelBoundaries(Vec<LevelBoundary>);

/// Reasons why a level boundary is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LevelBoundaryError {
    #[error("boundary {entry}: expected a name, found none")]
    NoName {
        /// Index of the entry, counted from 1.
        entry: usize,
    },
    #[error(
        "boundary {entry}, {}: expected the name of an output as its axis, found none",
        quoted(name)
    )]
    NoAxis {
        /// Index of the entry, counted from 1.
        entry: usize,
        name: String,
    },
    #[error(
        "boundary {entry}, {}: expected at least 2 points, found {found}",
        quoted(name)
    )]
    TooFewPoints {
        /// Index of the entry, counted from 1.
        entry: usize,
        name: String,
        found: usize,
    },
    /// A coordinate of a point is negative or not finite.
    #[error(
        "boundary {entry}, {}, point {point}: expected a bandwidth (rad/s) and a phase delay (s) not below zero, found {} and {}",
        quoted(name), number(found[0]), number(found[1])
    )]
    Point {
        /// Index of the entry, counted from 1.
        entry: usize,
        name: String,
        /// Index of the point, counted from 1.
        point: usize,
        found: [f64; 2],
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
        }
    }
}

impl LevelBoundary {
    /// Checks a boundary; `entry` counts from 1.
    fn check(&self, entry: usize) -> Result<(), LevelBoundaryError> {
        let name = self.name.clone();
        if name.trim().is_empty() {
            return Err(LevelBoundaryError::NoName { entry });
        }
        if self.axis.trim().is_empty() {
            return Err(LevelBoundaryError::NoAxis { entry, name });
        }
        if self.points.len() < 2 {
            return Err(LevelBoundaryError::TooFewPoints {
                entry,
                name,
                found: self.points.len(),
            });
        }
        for (index, &found) in self.points.iter().enumerate() {
            if found.iter().any(|value| !value.is_finite() || *value < 0.0) {
                return Err(LevelBoundaryError::Point {
                    entry,
                    name,
                    point: index + 1,
                    found,
                });
            }
        }
        Ok(())
    }
}

impl TryFrom<Vec<LevelBoundary>> for LevelBoundaries {
    type Error = LevelBoundaryError;

    fn try_from(boundaries: Vec<LevelBoundary>) -> Result<Self, LevelBoundaryError> {
        for (index, boundary) in boundaries.iter().enumerate() {
            boundary.check(index + 1)?;
        }
        Ok(Self(boundaries))
    }
}

impl LevelBoundaries {
    /// Returns the boundaries in file order.
    pub fn as_slice(&self) -> &[LevelBoundary] {
        &self.0
    }

    /// Returns the boundaries for one axis, named as the dataset names its output.
    pub fn of_axis<'a>(&'a self, axis: &'a str) -> impl Iterator<Item = &'a LevelBoundary> {
        self.0.iter().filter(move |boundary| boundary.axis == axis)
    }

    /// Returns the axes that are not outputs of the dataset, without duplicates.
    pub fn unknown_axes(&self, outputs: &[String]) -> Vec<&str> {
        let mut unknown: Vec<&str> = Vec::new();
        for LevelBoundary { axis, .. } in &self.0 {
            if !outputs.contains(axis) && !unknown.contains(&axis.as_str()) {
                unknown.push(axis);
            }
        }
        unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<LevelBoundaries, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    /// Returns the error of reading a file with this single boundary.
    fn read_error(name: &str, axis: &str, points: &str) -> LevelBoundaryError {
        let boundary = format!(r#"[{{"name":"{name}","axis":"{axis}","points":{points}}}]"#);
        let boundaries: Vec<LevelBoundary> = serde_json::from_str(&boundary).unwrap();
        let error = LevelBoundaries::try_from(boundaries).unwrap_err();
        assert!(read(&boundary).unwrap_err().starts_with(&error.to_string()));
        error
    }

    #[test]
    fn boundaries_are_read_and_come_back_as_they_were() {
        let text = r#"[{"name":"Level 1","axis":"P","points":[[2.0,0.0],[2.0,0.15],[3.0,0.25]]},{"name":"Level 1","axis":"Q","points":[[1.0,0.0],[1.0,0.2]]}]"#;
        let boundaries = read(text).unwrap();
        assert_eq!(boundaries.as_slice().len(), 2);
        assert_eq!(
            boundaries.of_axis("Q").next().unwrap().points[1],
            [1.0, 0.2]
        );
        assert_eq!(boundaries.unknown_axes(&["P".to_owned()]), ["Q"]);
        assert_eq!(serde_json::to_string(&boundaries).unwrap(), text);
    }

    #[test]
    fn a_wrong_boundary_is_refused_with_its_place() {
        let name = "L".to_owned();
        assert_eq!(
            read_error(" ", "P", "[[1,0],[1,1]]"),
            LevelBoundaryError::NoName { entry: 1 }
        );
        assert_eq!(
            read_error("L", "", "[[1,0],[1,1]]"),
            LevelBoundaryError::NoAxis {
                entry: 1,
                name: name.clone()
            }
        );
        assert_eq!(
            read_error("L", "P", "[[1,0]]"),
            LevelBoundaryError::TooFewPoints {
                entry: 1,
                name: name.clone(),
                found: 1
            }
        );
        assert_eq!(
            read_error("L", "P", "[[1,0],[1,-0.1]]"),
            LevelBoundaryError::Point {
                entry: 1,
                name,
                point: 2,
                found: [1.0, -0.1]
            }
        );
        let not_finite = LevelBoundary {
            name: "L".into(),
            axis: "P".into(),
            points: vec![[f64::NAN, 0.0]; 2],
        };
        let error = LevelBoundaries::try_from(vec![not_finite]).unwrap_err();
        assert!(matches!(
            error,
            LevelBoundaryError::Point {
                entry: 1,
                point: 1,
                ..
            }
        ));
    }
}
