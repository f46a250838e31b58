//! Levels of feedback of synthetic flights, compared with the true error of the model (M14.14,
//! M14.24). The seeds were used for nothing else.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{Band, Dynamics, Pair};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, PreparedModel};
use gdcm_model::simulation::FlightRecord;
use gdcm_model::statistics::median;

use super::identify::identify;
use super::known_answers_tests::{matrix, number};
use super::real_flight_tests::{SyntheticFlight, codes, options, reference_results};
use crate::diagnostics::feedback::{Feedback, FeedbackLevel};

/// Returns the response of the simulated aircraft to samples of its input:
/// `[0 1 0] (z I - F)^-1 g`, where g is the first column of G.
fn truth(omega: f64) -> Complex<f64> {
    let file = reference_results();
    let generator = &file["generator"];
    let f = matrix(&generator["F"]);
    let g = matrix(&generator["G"]);
    let z = Complex::cis(omega * number(&generator["dt"]));
    let a = DMatrix::from_fn(3, 3, |row, column| {
        let entry = Complex::from(-f[(row, column)]);
        if row == column { z + entry } else { entry }
    });
    let b = DMatrix::from_fn(3, 1, |row, _| Complex::from(g[(row, 0)]));
    a.lu().solve(&b).unwrap()[1]
}

/// Error of a model over the band, as medians over frequency.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelError {
    /// Error of the modulus \[dB\].
    pub(crate) db: f64,
    /// Error of the response relative to its modulus.
    pub(crate) relative: f64,
}

impl ModelError {
    pub(crate) fn new(model: &Dynamics) -> Self {
        let grid = FrequencyGrid::logarithmic(Band::new(1.0, 12.0).unwrap(), 24);
        let found = PreparedModel::new(model).response(&grid);
        let mut db = Vec::new();
        let mut relative = Vec::new();
        for (omega, h) in grid.omega().iter().zip(found.curve(Pair::new(0, 0))) {
            let ratio = h / truth(*omega);
            db.push((20.0 * ratio.norm().log10()).abs());
            relative.push((ratio - 1.0).norm());
        }
        Self {
            db: median(&mut db),
            relative: median(&mut relative),
        }
    }
}

/// A flight of three records, identified.
struct Outcome {
    feedback: Feedback,
    codes: Vec<&'static str>,
    error: ModelError,
}

/// Simulates and identifies three records of a minute.
fn outcome(settings: SyntheticFlight, seed: u64) -> Outcome {
    let file = reference_results();
    let mut records: Vec<FlightRecord> = Vec::new();
    for number in 0..3 {
        let flight = SyntheticFlight {
            seed: seed + number,
            ..settings
        };
        records.push(flight.record(&file).0);
    }
    let found = identify(&records, &options(), &Sequential, &Unobserved).unwrap();
    Outcome {
        feedback: found.feedback.clone().unwrap(),
        codes: codes(&found),
        error: ModelError::new(&found.refined.dynamics),
    }
}

/// A small excitation, and noise of the sensor that closes the loop: the noise reaches the input.
fn sensor_in_the_loop() -> SyntheticFlight {
    SyntheticFlight {
        feedback: 0.15,
        amplitude: 0.05,
        ..SyntheticFlight::calm(0, 0)
    }
}

/// A flight without a sweep: gusts and the pilot's remnant move the aircraft.
fn without_sweep() -> SyntheticFlight {
    SyntheticFlight {
        gust: 0.3,
        amplitude: 0.0,
        noise: 0.02,
        feedback: 0.5,
        remnant: 0.3,
        ..SyntheticFlight::calm(0, 0)
    }
}

#[test]
fn the_effect_of_a_noisy_sensor_in_the_loop_is_not_overstated() {
    for seed in [40_000, 40_010] {
        let outcome = outcome(sensor_in_the_loop(), seed);
        // The predictor with 40 past samples alone would find the fed-back share b = 0.26 and 0.32
        // with a significance z above 14, which is level 2; but the model is right within 10 %.
        assert!(outcome.error.relative < 0.1, "{:?}", outcome.error);
        assert!(
            outcome.feedback.level() < FeedbackLevel::TooMuch,
            "{}",
            outcome.feedback.share
        );
        assert!(outcome.feedback.share < 2.0 * outcome.error.relative.max(0.05));
        assert!(!outcome.codes.contains(&"feedback"), "{:?}", outcome.codes);
    }
}

#[test]
fn a_flight_without_a_coherent_input_has_level_2() {
    let outcome = outcome(without_sweep(), 40_000);
    // The share alone would be level 1 (below 0.18); level 2 comes from the coherence (M14.14).
    assert!(outcome.feedback.share < 0.18, "{}", outcome.feedback.share);
    assert!(outcome.feedback.coherence < 0.6 && outcome.feedback.significance > 1.6);
    assert_eq!(outcome.feedback.level(), FeedbackLevel::TooMuch);
    assert!(outcome.codes.contains(&"feedback"), "{:?}", outcome.codes);
    assert!(outcome.error.db > 2.0, "{:?}", outcome.error);
}

/// Prints the number of flights at each level and the errors of their models.
#[test]
#[ignore = "a measurement of rates over many seeds: minutes"]
fn measure_levels_over_many_seeds() {
    let calm = SyntheticFlight::calm(0, 0);
    let sensor = sensor_in_the_loop();
    let gusty = SyntheticFlight {
        gust: 1.0,
        amplitude: 0.4,
        noise: 0.02,
        feedback: 0.15,
        ..calm
    };
    let without = without_sweep();
    // The level that most flights have, and the minimum number of the 20 flights that have it. The
    // last row is a known weakness: level 2 is right, but few flights reach it (M14.24).
    let cases: [(&str, SyntheticFlight, usize, usize); 12] = [
        ("open loop, noise 0.3", calm, 0, 18),
        (
            "open loop, noise 2",
            SyntheticFlight { noise: 2.0, ..calm },
            0,
            18,
        ),
        (
            "loop, noise 0.02",
            SyntheticFlight {
                noise: 0.02,
                feedback: 0.15,
                ..calm
            },
            0,
            18,
        ),
        (
            "loop, noise 0.3, sweep 0.2",
            SyntheticFlight {
                amplitude: 0.2,
                ..sensor
            },
            0,
            18,
        ),
        ("loop, noise 0.3, sweep 0.05", sensor, 0, 10),
        (
            "strong loop, noise 0.3, sweep 0.2",
            SyntheticFlight {
                feedback: 0.5,
                amplitude: 0.2,
                ..sensor
            },
            1,
            14,
        ),
        (
            "strong loop, noise 0.3, sweep 0.05",
            SyntheticFlight {
                feedback: 0.5,
                ..sensor
            },
            2,
            18,
        ),
        (
            "gust 0.3, sweep 1",
            SyntheticFlight {
                gust: 0.3,
                amplitude: 1.0,
                ..gusty
            },
            0,
            18,
        ),
        ("gust 1, sweep 0.4", gusty, 2, 10),
        (
            "no sweep, gust 1, remnant 0.05",
            SyntheticFlight {
                amplitude: 0.0,
                ..gusty
            },
            2,
            18,
        ),
        ("no sweep, gust 0.3, remnant 0.3", without, 2, 17),
        (
            "no sweep, gust 0.1, remnant 0.05, weak loop",
            SyntheticFlight {
                gust: 0.1,
                noise: 0.3,
                feedback: 0.05,
                remnant: 0.05,
                ..without
            },
            2,
            1,
        ),
    ];
    for (name, flight, level, least) in cases {
        let mut at_level = [0; 3];
        let mut errors: [Vec<f64>; 3] = Default::default();
        for seed in 0..20 {
            let outcome = outcome(flight, 90_000 + 10 * seed);
            let found = outcome.feedback.level() as usize;
            at_level[found] += 1;
            errors[found].push(outcome.error.db);
        }
        let medians = errors.map(|mut errors| {
            let largest = errors.iter().copied().fold(0.0, f64::max);
            (median(&mut errors), largest)
        });
        println!("{name}: levels {at_level:?}, error dB (median, largest) {medians:.2?}");
        assert!(at_level[level] >= least, "{name}: {at_level:?}");
    }
}
