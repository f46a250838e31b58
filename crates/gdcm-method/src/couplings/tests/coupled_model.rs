//! Mixing and feedback applied to a response and to a model.

use nalgebra::{Complex, DMatrix, dmatrix};

use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Band, Dynamics, Pair, StateSpace};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::{constant, matrix_at};
use crate::correction::Pade;
use crate::couplings::response_change::relative_change_db;
use crate::couplings::{CoupledModelError, CouplingMatrices, LoopMargin};

/// A helicopter with four states, two inputs, three outputs and feed-through.
fn small_aircraft() -> StateSpace {
    let a = dmatrix![
        -0.9, 0.3, 0.0, 0.1;
        -0.4, -1.6, 0.2, 0.0;
        0.1, 0.0, -0.2, 1.0;
        0.3, -0.1, -1.5, -0.4
    ];
    let b = dmatrix![1.0, 0.1; -0.2, 0.8; 0.0, 0.3; 0.6, -0.2];
    let c = dmatrix![1.0, 0.0, 0.2, 0.0; 0.0, 1.0, 0.0, -0.3; 0.1, 0.4, 1.0, 0.2];
    StateSpace::new(a, b, c, dmatrix![0.0, 0.1; 0.05, 0.0; -0.2, 0.4]).unwrap()
}

fn small_couplings() -> CouplingMatrices {
    constant(
        &dmatrix![1.1, 0.2; -0.1, 0.9],
        &dmatrix![0.1, -0.3, 0.2; 0.05, 0.2, -0.1],
    )
}

fn grid() -> FrequencyGrid {
    FrequencyGrid::logarithmic(Band::new(0.2, 8.0).unwrap(), 40)
}

fn response_of(model: &StateSpace) -> FrequencyResponse {
    FrequencyResponse::from_dynamics(&Dynamics::StateSpace(model.clone()), &grid())
}

fn pade() -> Pade {
    Pade::new(4).unwrap()
}

/// Maximum difference between two responses.
fn largest_difference(first: &FrequencyResponse, second: &FrequencyResponse) -> f64 {
    let mut largest = 0.0;
    for (pair, curve) in first.curves().iter() {
        for (a, b) in curve.iter().zip(second.curve(pair)) {
            largest = f64::max(largest, (a - b).norm());
        }
    }
    largest
}

#[test]
fn without_couplings_nothing_changes() {
    let physics = small_aircraft();
    let none = constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 3));
    assert_eq!(none.model(&physics, 60.0, pade()).unwrap(), physics);
    assert_eq!(
        none.response(&response_of(&physics), 60.0),
        response_of(&physics)
    );
    let shifts = none.pole_shifts(&physics, 60.0, pade()).unwrap();
    assert!(
        shifts
            .iter()
            .all(|shift| shift.distance_rad_s() == Some(0.0) && !shift.is_newly_unstable())
    );
    let margin = LoopMargin::find(
        &none.least_singular_values(&response_of(&physics)),
        grid().omega(),
    )
    .unwrap();
    assert!((margin.least - 1.0).abs() < 1e-15 && !margin.is_close_to_ringing());
}

#[test]
fn the_coupled_matrices_have_the_coupled_response() {
    let continuous = small_aircraft();
    // A sampled model with the same matrices, stable because scaling by 0.5 puts the poles inside
    // the unit circle.
    let sampled = StateSpace::new(
        continuous.a() * 0.5,
        continuous.b().clone(),
        continuous.c().clone(),
        continuous.d().clone(),
    )
    .unwrap();
    let timing = Timing {
        sample_time_s: Some(0.2),
        ..Timing::default()
    };
    for physics in [continuous, sampled.timed(timing).unwrap()] {
        let coupled = small_couplings().model(&physics, 60.0, pade()).unwrap();
        assert_eq!(coupled.timing(), physics.timing());
        let difference = largest_difference(
            &response_of(&coupled),
            &small_couplings().response(&response_of(&physics), 60.0),
        );
        // Rounding errors: a dozen operations on values near 1, done in two orders.
        assert!(difference < 1e-12, "{difference:e}");
    }
}

#[test]
fn the_coupled_response_agrees_with_its_formula() {
    let h = response_of(&small_aircraft());
    let couplings = small_couplings();
    let coupled = couplings.response(&h, 60.0);
    let mixing = couplings.normalised_mixing(60.0).map(Complex::from);
    for k in 0..grid().len() {
        let h = matrix_at(&h, k);
        let difference = DMatrix::identity(3, 3) - &h * couplings.feedback().map(Complex::from);
        let expected = difference.try_inverse().unwrap() * h * &mixing;
        for error in (matrix_at(&coupled, k) - expected).iter() {
            assert!(error.norm() < 1e-13);
        }
    }
}

#[test]
fn channel_delays_are_inside_the_loop() {
    let delays = Timing {
        sample_time_s: None,
        input_delays_s: Some(vec![0.02, 0.0]),
        output_delays_s: Some(vec![0.0, 0.03, 0.0]),
    };
    let physics = small_aircraft().timed(delays).unwrap();
    let coupled = small_couplings()
        .model(&physics, 60.0, Pade::new(6).unwrap())
        .unwrap();
    assert!(coupled.timing().is_plain() && coupled.order() > physics.order());
    let difference = largest_difference(
        &response_of(&coupled),
        &small_couplings().response(&response_of(&physics), 60.0),
    );
    // Error of the sixth-order approximants of 0.03 s delays, up to 8 rad/s.
    assert!(difference < 1e-10, "{difference:e}");
}

#[test]
fn a_singular_loop_through_the_feed_through_is_refused() {
    // The feed-through from input 2 to output 3 is 0.4 = 1 / 2.5.
    let feedback = dmatrix![0.0, 0.0, 0.0; 0.0, 0.0, 2.5 - 1e-9];
    let error = constant(&DMatrix::identity(2, 2), &feedback)
        .model(&small_aircraft(), 60.0, pade())
        .unwrap_err();
    assert!(
        matches!(
            error,
            CoupledModelError::AlgebraicLoop { condition_number } if condition_number > 1e6
        ),
        "{error}"
    );
    let two_outputs = constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 2)).model(
        &small_aircraft(),
        60.0,
        pade(),
    );
    assert!(matches!(
        two_outputs,
        Err(CoupledModelError::Channels {
            found: [3, 2],
            expected: [2, 2]
        })
    ));
}

#[test]
fn a_pole_that_the_loop_makes_unstable_is_marked() {
    // A pole at -1 rad/s with a feedback of 1.5 moves to 0.5 rad/s.
    let lag = StateSpace::new(dmatrix![-1.0], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
    let shifts = constant(&dmatrix![1.0], &dmatrix![1.5])
        .pole_shifts(&lag, 60.0, pade())
        .unwrap();
    assert!(shifts[0].is_newly_unstable() && (shifts[0].after.re - 0.5).abs() < 1e-15);
    assert_eq!(shifts[0].distance_rad_s(), Some(1.5));
    let response = FrequencyResponse::from_dynamics(&Dynamics::StateSpace(lag), &grid());
    let couplings = constant(&dmatrix![1.0], &dmatrix![0.9]);
    let margin =
        LoopMargin::find(&couplings.least_singular_values(&response), grid().omega()).unwrap();
    // |1 - 0.9 / (1 + j 0.2)| at the lowest frequency.
    let expected = (Complex::from(1.0) - Complex::from(0.9) / Complex::new(1.0, 0.2)).norm();
    assert!(
        (margin.least - expected).abs() < 1e-14
            && margin.omega_rad_s == 0.2
            && margin.is_close_to_ringing()
    );
    let change = relative_change_db(&response, &couplings.response(&response, 60.0), 39);
    assert!(
        change[Pair::new(0, 0)].unwrap() < -17.0,
        "the relative change at 8 rad/s is not below -17 dB: {change:?}"
    );
}
