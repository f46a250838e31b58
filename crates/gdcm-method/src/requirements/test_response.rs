//! Simulates a model's response to a test input over time (M17.2).

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::simulation::FirstOrderHold;

use super::test_input::{TestInput, TestInputError};

impl TestInput {
    /// Simulates the outputs of `model` from rest, samples x outputs: the input acts from the first
    /// sample on, and every later change is a ramp over one sample time \[s\].
    ///
    /// # Errors
    /// [`TestInputError`] if there is no such input, its numbers are invalid, or the model cannot
    /// be simulated.
    pub fn simulate(
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
        let hold = FirstOrderHold::new(model, sample_time_s).ok_or(TestInputError::NotFinite)?;
        let mut moved = DMatrix::zeros(samples, model.inputs());
        moved
            .column_mut(input)
            .copy_from_slice(&self.signal(sample_time_s, samples));
        let outputs = hold.simulate(&DVector::zeros(model.order()), &moved);
        if outputs.iter().any(|value| !value.is_finite()) {
            return Err(TestInputError::NotFinite);
        }
        Ok(outputs)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use gdcm_model::dataset::state_space::Timing;

    use super::super::test_input::TestInputShape;
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
    fn the_response_of_a_lag_to_a_step_is_its_known_one() {
        let outputs = test(TestInputShape::Step)
            .simulate(&lag(), 1, 0.1, 10)
            .unwrap();
        for (n, y) in outputs.iter().enumerate() {
            // 10 / 2 (1 - e^(-2 t)); rounding errors over ten steps.
            let expected = 5.0 * (1.0 - (-0.2 * n as f64).exp());
            assert!((y - expected).abs() < 1e-13, "{n}: {y} {expected}");
        }
    }

    #[test]
    fn a_test_that_cannot_be_simulated_is_refused() {
        let step = test(TestInputShape::Step);
        assert_eq!(
            step.simulate(&lag(), 2, 0.1, 5).unwrap_err(),
            TestInputError::NoInput {
                input: 2,
                inputs: 2
            }
        );
        let without_duration = TestInput {
            duration_s: 0.0,
            ..step
        };
        assert_eq!(
            without_duration.simulate(&lag(), 1, 0.1, 5).unwrap_err(),
            TestInputError::Numbers {
                size: 10.0,
                duration_s: 0.0
            }
        );
        let delay = Timing {
            output_delays_s: Some(vec![0.1]),
            ..Timing::default()
        };
        assert_eq!(
            step.simulate(&lag().timed(delay).unwrap(), 1, 0.1, 5)
                .unwrap_err(),
            TestInputError::Timing
        );
        let diverging = StateSpace::new(
            dmatrix![2000.0],
            dmatrix![0.0, 1.0],
            dmatrix![1.0],
            dmatrix![0.0, 0.0],
        )
        .unwrap();
        assert_eq!(
            step.simulate(&diverging, 1, 0.1, 5).unwrap_err(),
            TestInputError::NotFinite
        );
    }
}
