//! Test inputs: steps and doublets (M17.2). `test_response` simulates a model with them.

use serde::{Deserialize, Serialize};

use gdcm_model::units::number;

/// How a test input varies over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TestInputShape {
    /// `size` over the whole duration.
    Step,
    /// `size` in the first half of the duration, `-size` in the second.
    Doublet,
}

/// A test: an input is moved from its trim value and returned to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "TestInputText")]
pub struct TestInput {
    pub shape: TestInputShape,
    /// Amplitude, in the input's unit.
    pub size: f64,
    /// Total duration \[s\]; for a doublet, both halves together.
    pub duration_s: f64,
}

/// Reasons why a model has no response to a test.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestInputError {
    #[error("expected an input number from 1 to {inputs}, found {}", input + 1)]
    NoInput { input: usize, inputs: usize },
    /// The size is not finite, or the duration is not above zero and at most 600 s.
    #[error("test input: expected a finite size and a duration greater than 0 s and at most \
        {LONGEST_S} s, found {} and {} s", number(*size), number(*duration_s))]
    Numbers { size: f64, duration_s: f64 },
    /// The model is in discrete time, or has channel delays that are not states.
    #[error(
        "expected a model in continuous time without delays: convert its delays to states first"
    )]
    Timing,
    #[error("the model cannot be simulated: its response is not finite")]
    NotFinite,
}

impl TestInputError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoInput { .. } => "no-input",
            Self::Numbers { .. } => "test-input-numbers",
            Self::Timing => "test-input-timing",
            Self::NotFinite => "not-finite",
        }
    }
}

/// Maximum test duration \[s\], which limits the time and memory of a simulation.
const LONGEST_S: f64 = 600.0;
/// Added to each sample number, so that a change at a sample is not missed due to rounding.
const ROUNDING_SAMPLES: f64 = 1e-6;

impl Default for TestInput {
    /// Returns a unit step that lasts two seconds.
    fn default() -> Self {
        Self {
            shape: TestInputShape::Step,
            size: 1.0,
            duration_s: 2.0,
        }
    }
}

/// A test as written in a file, before its numbers are checked.
#[derive(Deserialize)]
struct TestInputText {
    shape: TestInputShape,
    size: f64,
    duration_s: f64,
}

impl TryFrom<TestInputText> for TestInput {
    type Error = TestInputError;

    fn try_from(text: TestInputText) -> Result<Self, TestInputError> {
        let test = Self {
            shape: text.shape,
            size: text.size,
            duration_s: text.duration_s,
        };
        test.checked()
    }
}

impl TestInput {
    /// Returns the test if its size and duration are valid.
    ///
    /// # Errors
    /// [`TestInputError::Numbers`] otherwise.
    pub fn checked(self) -> Result<Self, TestInputError> {
        let duration_s = self.duration_s;
        let is_valid_duration =
            duration_s.is_finite() && duration_s > 0.0 && duration_s <= LONGEST_S;
        if self.size.is_finite() && is_valid_duration {
            Ok(self)
        } else {
            Err(TestInputError::Numbers {
                size: self.size,
                duration_s,
            })
        }
    }

    /// Returns `samples` values of the input, at multiples of the sample time \[s\] from 0 on.
    pub fn signal(&self, sample_time_s: f64, samples: usize) -> Vec<f64> {
        (0..samples)
            .map(|n| {
                let time_s = (n as f64 + ROUNDING_SAMPLES) * sample_time_s;
                self.at(time_s)
            })
            .collect()
    }

    /// Returns the input at a time \[s\] not below zero.
    fn at(&self, time_s: f64) -> f64 {
        if time_s >= self.duration_s {
            return 0.0;
        }
        match self.shape {
            TestInputShape::Doublet if time_s >= 0.5 * self.duration_s => -self.size,
            TestInputShape::Doublet | TestInputShape::Step => self.size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(shape: TestInputShape) -> TestInput {
        TestInput {
            shape,
            size: 10.0,
            duration_s: 1.0,
        }
    }

    #[test]
    fn a_step_is_held_and_a_doublet_turns_in_its_middle() {
        assert_eq!(
            test(TestInputShape::Step).signal(0.25, 6),
            [10.0, 10.0, 10.0, 10.0, 0.0, 0.0]
        );
        assert_eq!(
            test(TestInputShape::Doublet).signal(0.25, 6),
            [10.0, 10.0, -10.0, -10.0, 0.0, 0.0]
        );
    }

    #[test]
    fn a_test_is_read_as_it_is_written() {
        let text = r#"{"shape":"doublet","size":10.0,"duration_s":1.0}"#;
        assert_eq!(
            serde_json::from_str::<TestInput>(text).unwrap(),
            test(TestInputShape::Doublet)
        );
        assert_eq!(
            serde_json::to_string(&test(TestInputShape::Doublet)).unwrap(),
            text
        );
        let endless: TestInputText = serde_json::from_str(&text.replace("1.0", "1e9")).unwrap();
        assert_eq!(
            TestInput::try_from(endless),
            Err(TestInputError::Numbers {
                size: 10.0,
                duration_s: 1e9
            })
        );
    }
}
