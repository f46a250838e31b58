//! Handling-qualities level boundaries over bandwidth and phase delay, and the level at a point
//! (M17.1).
//!
//! No boundaries apply by default, because they depend on the mission task element and the category
//! (ADS-33E-PRF, 3.3.2.1, 3.3.5.1 and 3.4.1.1).
//!
//! ```text
//! tau_p |  Level 3 /  Level 2 /  Level 1
//!       |         |          |
//!       +---------+----------+---------- omega_BW
//! ```
//!
//! `omega_BW` is the bandwidth, `tau_p` the phase delay; Level 1 is the best. A point meets Level n
//! if it lies on the Level n boundary or to its right, and is assigned the lowest number n that it
//! meets. If it does not meet the highest number N, its level is N + 1.

use serde::{Deserialize, Serialize};

pub use super::level_boundary_error::LevelBoundaryError;

/// A boundary: a polyline over bandwidth and phase delay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelBoundary {
    /// Level name ("Level 1").
    pub name: String,
    /// Level number met on the boundary and to its right, 1 for the best; `None` for a boundary
    /// that is only drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// Output to which the boundary applies ("P").
    pub axis: String,
    /// Points \[rad/s, s\]: bandwidth and phase delay, in drawing order; at least two. Where
    /// `level` is given, neither coordinate decreases.
    pub points: Vec<[f64; 2]>,
    /// Document, paragraph and figure that give the points, and the error in reading them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
}

/// Where a point lies relative to a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BoundarySide {
    /// On the boundary or to its right: the point meets the boundary's level.
    OnOrRight,
    /// To the left of the boundary: the point does not meet its level.
    Left,
    /// Above and to the right of the boundary's end, where it decides nothing.
    Undrawn,
}

/// Level assigned to a bandwidth and a phase delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssessedLevel {
    /// Level number, 1 for the best.
    Level(u32),
    /// The point lies above the end of a boundary that would have to decide its level.
    AboveBoundaries,
}

impl AssessedLevel {
    /// Returns the level number, if the boundaries determine it.
    pub fn number(self) -> Option<u32> {
        match self {
            Self::Level(number) => Some(number),
            Self::AboveBoundaries => None,
        }
    }
}

/// The boundaries in a file, `[{"name": "Level 1", "axis": "P", "points": [[omega, tau], ...]}]`;
/// each is checked on reading.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<LevelBoundary>")]
pub struct LevelBoundaries(Vec<LevelBoundary>);

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
        if self.level.is_some() {
            self.check_level(entry)?;
        }
        Ok(())
    }

    /// Checks a boundary that gives a level: the level is not 0, and neither coordinate decreases,
    /// so that the boundary has two sides. `entry` counts from 1.
    fn check_level(&self, entry: usize) -> Result<(), LevelBoundaryError> {
        let name = self.name.clone();
        if self.level == Some(0) {
            return Err(LevelBoundaryError::LevelZero { entry, name });
        }
        for (index, ends) in self.points.windows(2).enumerate() {
            if ends[1][0] < ends[0][0] || ends[1][1] < ends[0][1] {
                return Err(LevelBoundaryError::Descending {
                    entry,
                    name,
                    point: index + 2,
                });
            }
        }
        Ok(())
    }

    /// Returns the lowest bandwidth \[rad/s\] on the boundary at a phase delay; below its first
    /// point, the first point's bandwidth; `None` above its last point.
    fn least_bandwidth(&self, phase_delay_s: f64) -> Option<f64> {
        let first = self.points.first()?;
        if phase_delay_s <= first[1] {
            return Some(first[0]);
        }
        for ends in self.points.windows(2) {
            let [from, to] = [ends[0], ends[1]];
            if phase_delay_s <= to[1] {
                // Not horizontal: the phase delay exceeds `from`'s.
                let share = (phase_delay_s - from[1]) / (to[1] - from[1]);
                return Some(from[0] + share * (to[0] - from[0]));
            }
        }
        None
    }

    /// Returns on which side of the boundary a bandwidth and a phase delay lie.
    fn side(&self, omega_bw_rad_s: f64, phase_delay_s: f64) -> BoundarySide {
        let last_rad_s = self.points.last().map_or(0.0, |point| point[0]);
        match self.least_bandwidth(phase_delay_s) {
            Some(least) if omega_bw_rad_s >= least => BoundarySide::OnOrRight,
            Some(_) => BoundarySide::Left,
            None if omega_bw_rad_s < last_rad_s => BoundarySide::Left,
            None => BoundarySide::Undrawn,
        }
    }
}

impl TryFrom<Vec<LevelBoundary>> for LevelBoundaries {
    type Error = LevelBoundaryError;

    fn try_from(boundaries: Vec<LevelBoundary>) -> Result<Self, LevelBoundaryError> {
        for (index, boundary) in boundaries.iter().enumerate() {
            boundary.check(index + 1)?;
            let has_same_level = boundaries[..index]
                .iter()
                .any(|known| known.axis == boundary.axis && known.level == boundary.level);
            if let Some(level) = boundary.level
                && has_same_level
            {
                return Err(LevelBoundaryError::DuplicateLevel {
                    entry: index + 1,
                    name: boundary.name.clone(),
                    axis: boundary.axis.clone(),
                    level,
                });
            }
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
    pub fn for_output<'a>(&'a self, axis: &'a str) -> impl Iterator<Item = &'a LevelBoundary> {
        self.0.iter().filter(move |boundary| boundary.axis == axis)
    }

    /// Returns the boundaries that give levels for an axis, best level first.
    fn assessing(&self, axis: &str) -> Vec<&LevelBoundary> {
        let mut found = Vec::new();
        for boundary in &self.0 {
            if boundary.axis == axis && boundary.level.is_some() {
                found.push(boundary);
            }
        }
        found.sort_by_key(|boundary| boundary.level);
        found
    }

    /// Returns whether any boundary gives levels for an axis.
    pub fn assesses(&self, axis: &str) -> bool {
        self.0
            .iter()
            .any(|boundary| boundary.axis == axis && boundary.level.is_some())
    }

    /// Returns the level for a bandwidth \[rad/s\] and a phase delay \[s\]; `None` if no boundary
    /// gives levels for the axis.
    ///
    /// ```text
    /// for the boundaries in ascending order of their levels:
    ///     on it or to the right of it            the level of this boundary
    ///     above its end and to the right of it   not determined
    ///     to the left of it                      the next boundary decides
    /// to the left of all                         one more than the last level
    /// ```
    pub fn level(
        &self,
        axis: &str,
        omega_bw_rad_s: f64,
        phase_delay_s: f64,
    ) -> Option<AssessedLevel> {
        let assessing = self.assessing(axis);
        for boundary in &assessing {
            match boundary.side(omega_bw_rad_s, phase_delay_s) {
                BoundarySide::OnOrRight => return boundary.level.map(AssessedLevel::Level),
                BoundarySide::Undrawn => return Some(AssessedLevel::AboveBoundaries),
                BoundarySide::Left => {}
            }
        }
        let last = assessing.last()?.level?;
        Some(AssessedLevel::Level(last.saturating_add(1)))
    }

    /// Returns these boundaries, without those for any axis in `others`, followed by `others`.
    pub fn replaced_by(&self, others: &Self) -> Self {
        let mut boundaries = self.0.clone();
        boundaries.retain(|boundary| !others.0.iter().any(|other| other.axis == boundary.axis));
        boundaries.extend(others.0.iter().cloned());
        Self(boundaries)
    }

    /// Returns these boundaries without those in `others`.
    pub fn without(&self, others: &Self) -> Self {
        let mut boundaries = self.0.clone();
        boundaries.retain(|boundary| !others.0.contains(boundary));
        Self(boundaries)
    }

    /// Returns these boundaries for another axis, an output's name.
    pub fn for_axis(&self, axis: &str) -> Self {
        let mut boundaries = self.0.clone();
        for boundary in &mut boundaries {
            boundary.axis = axis.to_owned();
        }
        Self(boundaries)
    }

    /// Returns whether all boundaries in `others` are among these.
    pub fn contains(&self, others: &Self) -> bool {
        others.0.iter().all(|other| self.0.contains(other))
    }

    /// Returns the axes that are not among the dataset's outputs, without duplicates.
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
            boundaries.for_output("Q").next().unwrap().points[1],
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
            level: None,
            axis: "P".into(),
            points: vec![[f64::NAN, 0.0]; 2],
            source: String::new(),
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

    /// Two boundaries: vertical up to 0.1 s, then rising by 0.1 s per 1 rad/s up to 0.3 s.
    const TWO: &str = r#"[
        {"name": "Level 1", "level": 1, "axis": "P", "points": [[2, 0], [2, 0.1], [4, 0.3]]},
        {"name": "Level 2", "level": 2, "axis": "P", "points": [[1, 0], [1, 0.1], [3, 0.3]]}]"#;

    #[test]
    fn the_level_of_a_point_agrees_with_calculation_by_hand() {
        let boundaries = read(TWO).unwrap();
        let above = AssessedLevel::AboveBoundaries;
        for (omega, delay_s, expected) in [
            (2.5, 0.05, AssessedLevel::Level(1)),
            // On the boundary, at its corner and on its slope: omega = 2 + 10 (tau - 0.1).
            (2.0, 0.05, AssessedLevel::Level(1)),
            (2.0, 0.1, AssessedLevel::Level(1)),
            (3.0, 0.2, AssessedLevel::Level(1)),
            (2.999, 0.2, AssessedLevel::Level(2)),
            (1.999, 0.0, AssessedLevel::Level(2)),
            (2.0, 0.2, AssessedLevel::Level(2)),
            (1.999, 0.2, AssessedLevel::Level(3)),
            (0.5, 0.0, AssessedLevel::Level(3)),
            // Above the ends: Level 3 to the left of both, not determined to the right of one.
            (2.5, 0.35, AssessedLevel::Level(3)),
            (3.5, 0.35, above),
            (5.0, 0.35, above),
            // A negative phase delay counts as zero.
            (2.0, -0.01, AssessedLevel::Level(1)),
        ] {
            let found = boundaries.level("P", omega, delay_s);
            assert_eq!(found, Some(expected), "{omega} {delay_s}");
        }
        assert_eq!(boundaries.level("Q", 2.0, 0.1), None);
        let drawn = read(r#"[{"name":"L","axis":"P","points":[[2,0],[2,1]]}]"#).unwrap();
        assert_eq!(
            drawn.level("P", 3.0, 0.1),
            None,
            "a drawn line gives no level"
        );
    }

    #[test]
    fn a_boundary_that_gives_a_level_does_not_turn_back() {
        let faults = [
            (r#""level":0,"points":[[1,0],[1,1]]"#, "level-zero"),
            (r#""level":1,"points":[[2,0],[1,1]]"#, "level-descending"),
            (r#""level":1,"points":[[1,1],[2,0]]"#, "level-descending"),
        ];
        for (fields, code) in faults {
            let text = format!(r#"[{{"name":"L","axis":"P",{fields}}}]"#);
            let boundaries: Vec<LevelBoundary> = serde_json::from_str(&text).unwrap();
            let error = LevelBoundaries::try_from(boundaries).unwrap_err();
            assert_eq!(error.code(), code, "{text}");
        }
        let turning = r#"[{"name":"L","axis":"P","points":[[2,0],[1,1]]}]"#;
        assert!(read(turning).is_ok(), "a line that is only drawn may turn");
        let twice = TWO.replace("\"level\": 2", "\"level\": 1");
        let boundaries: Vec<LevelBoundary> = serde_json::from_str(&twice).unwrap();
        let error = LevelBoundaries::try_from(boundaries).unwrap_err();
        assert_eq!(error.code(), "duplicate-level");
    }

    #[test]
    fn boundaries_are_replaced_axis_by_axis() {
        let old = read(r#"[{"name":"a","axis":"P","points":[[1,0],[1,1]]},{"name":"b","axis":"R","points":[[1,0],[1,1]]}]"#).unwrap();
        let new = read(r#"[{"name":"c","axis":"R","points":[[2,0],[2,1]]}]"#).unwrap();
        let both = old.replaced_by(&new);
        let names = |boundaries: &LevelBoundaries| -> Vec<String> {
            boundaries
                .as_slice()
                .iter()
                .map(|b| b.name.clone())
                .collect()
        };
        assert_eq!(names(&both), ["a", "c"]);
        assert!(both.contains(&new) && !both.contains(&old));
        assert_eq!(names(&both.without(&new)), ["a"]);
        assert_eq!(new.for_axis("yaw").as_slice()[0].axis, "yaw");
    }
}
