//! Inputs of tests: steps and doublets, and what models answer to them (M17.2).

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::dataset::StateSpace;
use crate::identification::FirstOrderHold;
use crate::message_text::quoted;
use crate::units::number;

/// The course of an input over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TestInputShape {
    /// All of its size for all of its duration.
    Step,
    /// Its size for the first half of its duration, the opposite for the second.
    Doublet,
}

/// A test: one stick moved from its trim, and back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TestInput {
    /// Its course.
    pub shape: TestInputShape,
    /// The input, as the dataset names it.
    pub input: String,
    /// Its size, in the unit of the input.
    pub size: f64,
    /// How long it lasts \[s\].
    pub duration_s: f64,
}

/// Why a model has no answer to a test.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestInputError {
    /// There is no such input.
    #[error("there is no input {} to move", quoted(input))]
    NoInput {
        /// The name that is asked for.
        input: String,
    },
    /// Size or duration is not a number, or the duration is none.
    #[error("expected a size, and a duration and a sample time above 0 s; found {}, {} s and {} s", number(*size), number(*duration_s), number(*sample_time_s))]
    Numbers {
        /// The size.
        size: f64,
        /// The duration \[s\].
        duration_s: f64,
        /// The sample time \[s\].
        sample_time_s: f64,
    },
    /// The model acts in discrete time, or delays its channels by more than its states say.
    #[error("the model is not of continuous time without delays: write its delays as states first")]
    Timing,
    /// What the model answers is not finite.
    #[error("the model cannot be simulated: its answer is not finite")]
    NotFinite,
}

impl TestInput {
    /// The input at `t = 0, dt, ...`, `samples` of them.
    pub fn signal(&self, sample_time_s: f64, samples: usize) -> Vec<f64> {
        // A millionth of a sample is rounding.
        let before = |n: usize, end_s: f64| (n as f64 + 1e-6) * sample_time_s < end_s;
        let at = |n: usize| match self.shape {
            _ if !before(n, self.duration_s) => 0.0,
            TestInputShape::Doublet if !before(n, 0.5 * self.duration_s) => -self.size,
            _ => self.size,
        };
        (0..samples).map(at).collect()
    }

    /// The outputs of `model` from rest, samples x outputs: the input is there from the first sample on, and later changes within
    /// one sample time. `inputs` are the names of the model's inputs.
    ///
    /// # Errors
    /// [`TestInputError`] where the input is unknown, its numbers are none, or the model cannot be simulated.
    pub fn answer(
        &self,
        model: &StateSpace,
        inputs: &[String],
        sample_time_s: f64,
        samples: usize,
    ) -> Result<DMatrix<f64>, TestInputError> {
        let place = inputs.iter().position(|name| *name == self.input).filter(|place| *place < model.inputs());
        let Some(place) = place else { return Err(TestInputError::NoInput { input: self.input.clone() }) };
        let is_time = |time_s: f64| time_s.is_finite() && time_s > 0.0;
        if !(self.size.is_finite() && is_time(self.duration_s) && is_time(sample_time_s)) {
            let (size, duration_s) = (self.size, self.duration_s);
            return Err(TestInputError::Numbers { size, duration_s, sample_time_s });
        }
        if !model.timing().is_plain() {
            return Err(TestInputError::Timing);
        }
        let held = FirstOrderHold::of(model, sample_time_s).ok_or(TestInputError::NotFinite)?;
        let mut moved = DMatrix::zeros(samples, model.inputs());
        moved.column_mut(place).copy_from_slice(&self.signal(sample_time_s, samples));
        let answer = held.simulate(&DVector::zeros(model.order()), &moved);
        answer.iter().all(|value| value.is_finite()).then_some(answer).ok_or(TestInputError::NotFinite)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Timing;
    use nalgebra::dmatrix;

    fn test(shape: TestInputShape) -> TestInput {
        TestInput { shape, input: "LAT".into(), size: 10.0, duration_s: 1.0 }
    }

    fn lag() -> StateSpace {
        StateSpace::new(dmatrix![-2.0], dmatrix![0.0, 1.0], dmatrix![1.0], dmatrix![0.0, 0.0]).unwrap()
    }

    fn names() -> [String; 2] {
        ["LON".to_owned(), "LAT".to_owned()]
    }

    #[test]
    fn a_step_is_held_and_a_doublet_turns_in_its_middle() {
        let signal = |shape| test(shape).signal(0.25, 6);
        assert_eq!(signal(TestInputShape::Step), [10.0, 10.0, 10.0, 10.0, 0.0, 0.0]);
        assert_eq!(signal(TestInputShape::Doublet), [10.0, 10.0, -10.0, -10.0, 0.0, 0.0]);
    }

    #[test]
    fn the_answer_of_a_lag_to_a_step_is_its_known_one() {
        let answer = test(TestInputShape::Step).answer(&lag(), &names(), 0.1, 10).unwrap();
        for (n, y) in answer.iter().enumerate() {
            // 10 / 2 (1 - e^(-2 t)); rounding of ten steps.
            let expected = 5.0 * (1.0 - (-0.2 * n as f64).exp());
            assert!((y - expected).abs() < 1e-13, "{n}: {y} {expected}");
        }
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_in_words() {
        let refused =
            |test: &TestInput, model: &StateSpace| test.answer(model, &names(), 0.1, 5).unwrap_err().to_string();
        let step = test(TestInputShape::Step);
        assert_eq!(
            refused(&TestInput { input: "PED".into(), ..step.clone() }, &lag()),
            "there is no input \"PED\" to move"
        );
        assert!(refused(&TestInput { duration_s: 0.0, ..step.clone() }, &lag()).contains("found 10, 0 s and 0.1 s"));
        let delayed = lag().timed(Timing { output_delays_s: Some(vec![0.1]), ..Timing::default() }).unwrap();
        assert!(refused(&step, &delayed).contains("write its delays as states"));
        let diverging =
            StateSpace::new(dmatrix![2000.0], dmatrix![0.0, 1.0], dmatrix![1.0], dmatrix![0.0, 0.0]).unwrap();
        assert!(refused(&step, &diverging).contains("not finite"));
    }

    #[test]
    fn a_test_is_read_as_it_is_written() {
        let text = r#"{"shape":"doublet","input":"LAT","size":10.0,"duration_s":1.0}"#;
        assert_eq!(serde_json::from_str::<TestInput>(text).unwrap(), test(TestInputShape::Doublet));
        assert_eq!(serde_json::to_string(&test(TestInputShape::Doublet)).unwrap(), text);
    }
}
