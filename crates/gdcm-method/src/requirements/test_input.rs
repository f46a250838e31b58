//! Test inputs (steps and doublets), and the responses of models to them (M17.2).

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::StateSpace;
use gdcm_model::simulation::FirstOrderHold;
use gdcm_model::units::number;

/// Time history of a test input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TestInputShape {
    /// Constant over the duration.
    Step,
    /// Positive for the first half of the duration, negative for the second.
    Doublet,
}

/// A test: one input moved from its trim, and back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "TestInputText")]
pub struct TestInput {
    pub shape: TestInputShape,
    /// Amplitude, in the unit of the input that is moved.
    pub size: f64,
    /// Duration \[s\].
    pub duration_s: f64,
}

/// Reasons why a model has no response to a test.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestInputError {
    #[error("the model has {inputs} inputs, none of number {}", input + 1)]
    NoInput {
        /// Index of the requested input.
        input: usize,
        inputs: usize,
    },
    /// Size or duration is not a number, or the duration is zero.
    #[error("test input: expected a size, and a duration above 0 s up to {LONGEST_S} s; found {} and {} s", number(*size), number(*duration_s))]
    Numbers {
        size: f64,
        /// Duration \[s\].
        duration_s: f64,
    },
    /// The model is in discrete time, or has channel delays beyond its states.
    #[error("the model is not of continuous time without delays: write its delays as states first")]
    Timing,
    #[error("the model cannot be simulated: its answer is not finite")]
    NotFinite,
}

/// Longest duration of a test \[s\].
const LONGEST_S: f64 = 600.0;

impl Default for TestInput {
    /// Returns a step of one unit that lasts two seconds.
    fn default() -> Self {
        Self {
            shape: TestInputShape::Step,
            size: 1.0,
            duration_s: 2.0,
        }
    }
}

/// A test in its file format.
#[derive(Deserialize)]
struct TestInputText {
    shape: TestInputShape,
    size: f64,
    duration_s: f64,
}

impl TryFrom<TestInputText> for TestInput {
    type Error = TestInputError;

    fn try_from(
        TestInputText {
            shape,
            size,
            duration_s,
        }: TestInputText,
    ) -> Result<Self, TestInputError> {
        Self {
            shape,
            size,
            duration_s,
        }
        .checked()
    }
}

impl TestInput {
    /// Returns the test if its numbers are valid.
    ///
    /// # Errors
    /// [`TestInputError::Numbers`].
    pub fn checked(self) -> Result<Self, TestInputError> {
        let Self {
            size, duration_s, ..
        } = self;
        let is_duration = duration_s.is_finite() && duration_s > 0.0 && duration_s <= LONGEST_S;
        if size.is_finite() && is_duration {
            Ok(self)
        } else {
            Err(TestInputError::Numbers { size, duration_s })
        }
    }

    /// Returns the input at `t = 0, dt, ...`, `samples` values.
    pub fn signal(&self, sample_time_s: f64, samples: usize) -> Vec<f64> {
        // A millionth of a sample covers rounding.
        let before = |n: usize, end_s: f64| (n as f64 + 1e-6) * sample_time_s < end_s;
        let at = |n: usize| match self.shape {
            _ if !before(n, self.duration_s) => 0.0,
            TestInputShape::Doublet if !before(n, 0.5 * self.duration_s) => -self.size,
            _ => self.size,
        };
        (0..samples).map(at).collect()
    }

    /// Simulates the outputs of `model` from rest, samples x outputs: the input acts from the first
    /// sample on, and later changes take one sample time \[s\].
    ///
    /// # Errors
    /// [`TestInputError`] if there is no such input, its numbers are invalid, or the model cannot
    /// be simulated.
    pub fn answer(
        &self,
        model: &StateSpace,
        input: usize,
        sample_time_s: f64,
        samples: usize,
    ) -> Result<DMatrix<f64>, TestInputError> {
        self.checked()?;
        if input >= model.inputs() {
            return Err(TestInputError::NoInput {
                input,
                inputs: model.inputs(),
            });
        }
        if !model.timing().is_plain() {
            return Err(TestInputError::Timing);
        }
        let held = FirstOrderHold::new(model, sample_time_s).ok_or(TestInputError::NotFinite)?;
        let mut moved = DMatrix::zeros(samples, model.inputs());
        moved
            .column_mut(input)
            .copy_from_slice(&self.signal(sample_time_s, samples));
        let answer = held.simulate(&DVector::zeros(model.order()), &moved);
        answer
            .iter()
            .all(|value| value.is_finite())
            .then_some(answer)
            .ok_or(TestInputError::NotFinite)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use gdcm_model::dataset::state_space::Timing;

    use super::*;

    fn test(shape: TestInputShape) -> TestInput {
        TestInput {
            shape,
            size: 10.0,
            duration_s: 1.0,
        }
    }

    fn lag() -> StateSpace {
        StateSpace::new(
            dmatrix![-2.0],
            dmatrix![0.0, 1.0],
            dmatrix![1.0],
            dmatrix![0.0, 0.0],
        )
        .unwrap()
    }

    #[test]
    fn a_step_is_held_and_a_doublet_turns_in_its_middle() {
        let signal = |shape| test(shape).signal(0.25, 6);
        assert_eq!(
            signal(TestInputShape::Step),
            [10.0, 10.0, 10.0, 10.0, 0.0, 0.0]
        );
        assert_eq!(
            signal(TestInputShape::Doublet),
            [10.0, 10.0, -10.0, -10.0, 0.0, 0.0]
        );
    }

    #[test]
    fn the_answer_of_a_lag_to_a_step_is_its_known_one() {
        let answer = test(TestInputShape::Step)
            .answer(&lag(), 1, 0.1, 10)
            .unwrap();
        for (n, y) in answer.iter().enumerate() {
            // 10 / 2 (1 - e^(-2 t)); rounding errors of ten steps.
            let expected = 5.0 * (1.0 - (-0.2 * n as f64).exp());
            assert!((y - expected).abs() < 1e-13, "{n}: {y} {expected}");
        }
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_in_words() {
        let refused = |test: &TestInput, model: &StateSpace| {
            test.answer(model, 1, 0.1, 5).unwrap_err().to_string()
        };
        let step = test(TestInputShape::Step);
        let third = step.answer(&lag(), 2, 0.1, 5).unwrap_err().to_string();
        assert_eq!(third, "the model has 2 inputs, none of number 3");
        assert!(
            refused(
                &TestInput {
                    duration_s: 0.0,
                    ..step
                },
                &lag()
            )
            .contains("found 10 and 0 s")
        );
        let delayed = lag()
            .timed(Timing {
                output_delays_s: Some(vec![0.1]),
                ..Timing::default()
            })
            .unwrap();
        assert!(refused(&step, &delayed).contains("write its delays as states"));
        let diverging = StateSpace::new(
            dmatrix![2000.0],
            dmatrix![0.0, 1.0],
            dmatrix![1.0],
            dmatrix![0.0, 0.0],
        )
        .unwrap();
        assert!(refused(&step, &diverging).contains("not finite"));
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
        let endless = serde_json::from_str::<TestInput>(&text.replace("1.0", "1e9"))
            .unwrap_err()
            .to_string();
        assert!(
            endless.contains("a duration above 0 s up to 600 s"),
            "{endless}"
        );
    }
}
