//! Predictions against theory, against the information of flights that are simulated afterwards,
//! and against their identification.

use nalgebra::{DMatrix, DVector, dmatrix};

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord, Segment};
use gdcm_model::units::neper_to_db;

use super::coordinate_changes::coordinate_changes;
use super::flight_information::FlightInformation;
use super::flight_planner::{FlightPlanner, Repeated, SweepInformation};
use super::planned_sweep::PlannedSweep;
use crate::diagnostics::bands::TWO_SIDED_95;
use crate::identification::identify::identify;
use crate::identification::real_flight_tests::Generator;
use crate::identification::{Identification, Options, Preparation};
use crate::likelihood::cost::{Likelihood, SpectralLines};
use crate::likelihood::dense_model::DenseModel;
use crate::likelihood::dense_system::dense_system;
use crate::spectra::preparation::segments_of;
use crate::spectra::spectrum::LineRange;

const STEP_S: f64 = 0.04;
const BAND: [f64; 2] = [1.0, 12.0];

/// A lateral aircraft: a lag, and a lightly damped mode of 3 rad/s.
fn aircraft() -> StateSpace {
    StateSpace::new(
        dmatrix![-2.5, 0.4, 0.0; 0.0, 0.0, 3.0; 0.3, -3.0, -1.0],
        dmatrix![8.0, 0.8; 0.0, 0.3; 0.5, 2.5],
        dmatrix![1.0, 0.2, 0.1; 0.05, 0.1, 1.0],
        DMatrix::zeros(2, 2),
    )
    .unwrap()
}

fn sweep_of(input: usize) -> PlannedSweep {
    PlannedSweep {
        input,
        amplitude: 1.0,
        length_s: 60.0,
        band: [0.5, 16.0],
        repeats: 1,
    }
}

/// Flies a sweep; the other input moves a little, and the outputs have noise.
fn flown(sweep: &PlannedSweep, noise: f64, random: &mut Generator) -> FlightRecord {
    let samples = (sweep.length_s / STEP_S).round() as usize;
    let mut inputs = DMatrix::zeros(samples, 2);
    let mut slow = [0.0; 2];
    for k in 0..samples {
        for (input, state) in slow.iter_mut().enumerate() {
            *state = 0.95 * *state + 0.01 * random.normal();
            inputs[(k, input)] = *state;
        }
        inputs[(k, sweep.input)] += sweep.at(k as f64 * STEP_S);
    }
    let hold = FirstOrderHold::new(&aircraft(), STEP_S).unwrap();
    let mut outputs = hold.simulate(&DVector::zeros(3), &inputs);
    for value in outputs.iter_mut() {
        *value += noise * random.normal();
    }
    FlightRecord {
        name: format!("sweep {} {:.1}", sweep.input, sweep.amplitude),
        time_s: (0..samples).map(|k| k as f64 * STEP_S).collect(),
        inputs,
        outputs,
    }
}

fn identified(records: &[FlightRecord]) -> Identification {
    let options = Options::new(BAND, Preparation::of(&["LAT", "PED"], &["P", "R"]));
    identify(records, &options, &Sequential, &Unobserved).unwrap()
}

/// One sweep of each input, with noise.
fn first_flight(noise: f64, random: &mut Generator) -> Vec<FlightRecord> {
    vec![
        flown(&sweep_of(0), noise, random),
        flown(&sweep_of(1), noise, random),
    ]
}

/// Returns the information of the first flight.
fn first_information(noise: f64, seed: u64) -> Identification {
    let records = first_flight(noise, &mut Generator::new(seed));
    let found = identified(&records);
    assert!(found.information.is_some());
    found
}

/// Frequencies and responses at which predictions are compared.
fn places() -> Vec<(Pair, f64)> {
    let mut places = Vec::new();
    for omega in [1.0, 2.0, 3.5, 8.0] {
        for output in 0..2 {
            for input in 0..2 {
                places.push((Pair { output, input }, omega));
            }
        }
    }
    places
}

fn repeated(information: &SweepInformation, times: f64) -> Repeated<'_> {
    Repeated { information, times }
}

#[test]
fn changes_of_coordinates_change_neither_response_nor_cost() {
    let found = first_information(0.3, 1);
    let information = found.information.as_ref().unwrap();
    let model = DenseModel::from_state_space(&information.model).unwrap();
    let changes = coordinate_changes(&model);
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    for (pair, omega) in places() {
        let gradient = planner.log_gradient(pair, omega);
        let along = changes.tr_mul(&gradient);
        assert!(along.amax() < 1e-10 * gradient.amax() * changes.amax());
    }
    let along = &information.flown * &changes;
    assert!(along.amax() < 1e-9 * information.flown.amax() * changes.amax());
}

#[test]
fn the_information_of_the_records_gives_the_bands_of_the_identification() {
    let records = first_flight(0.3, &mut Generator::new(2));
    let options = Options {
        // Without neighbouring orders.
        orders: Some(vec![3]),
        ..Options::new(BAND, Preparation::of(&["LAT", "PED"], &["P", "R"]))
    };
    let found = identify(&records, &options, &Sequential, &Unobserved).unwrap();
    let information = found.information.as_ref().unwrap();
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    let now = planner.after(&[]).unwrap();
    for (pair, omega) in places() {
        let variance = planner.variance(&now, pair, omega).unwrap();
        let fed_back = match &found.feedback {
            Some(feedback) => feedback.ratio(omega, (pair.output, pair.input)),
            None => 0.0,
        };
        let sd = (2.0 * variance.re + 0.5 * fed_back.powi(2)).sqrt();
        let interval = planner.interval_now(pair, omega);
        let ratio = neper_to_db(sd) * TWO_SIDED_95 / interval.half_db;
        // The bands are interpolated, and use the dispersion as it is.
        let dispersion = found.cost.min(1.0).sqrt();
        assert!(
            (ratio * dispersion - 1.0).abs() < 0.02,
            "{pair:?} {omega}: {ratio}"
        );
    }
}

#[test]
fn repeats_and_amplitudes_divide_the_variance_of_the_planned_sweeps() {
    let found = first_information(0.3, 3);
    // Only planned sweeps.
    let mut information = found.information.unwrap().as_ref().clone();
    information.flown *= 1e-9;
    let planner = FlightPlanner::new(&information, &Sequential).unwrap();
    let sweeps = [0, 1].map(|input| planner.sweep_information(&sweep_of(input)).unwrap());
    let larger = [0, 1].map(|input| {
        let sweep = PlannedSweep {
            amplitude: 2.0,
            ..sweep_of(input)
        };
        planner.sweep_information(&sweep).unwrap()
    });
    let both = |sweeps: &[SweepInformation; 2], times: f64| {
        let planned = [repeated(&sweeps[0], times), repeated(&sweeps[1], times)];
        planner.after(&planned).unwrap()
    };
    let once = both(&sweeps, 1.0);
    let twice = both(&sweeps, 2.0);
    let doubled = both(&larger, 1.0);
    for (pair, omega) in places() {
        let [once, twice, doubled] =
            [&once, &twice, &doubled].map(|after| planner.variance(after, pair, omega).unwrap());
        for (found, expected) in [
            (once.re / twice.re, 2.0),
            (once.im / twice.im, 2.0),
            (once.re / doubled.re, 4.0),
            (once.im / doubled.im, 4.0),
        ] {
            // What is left of the flown records, and rounding errors of the elimination.
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }
}

#[test]
fn no_sweep_widens_an_interval() {
    let mut random = Generator::new(4);
    let found = first_information(0.3, 4);
    let planner = FlightPlanner::new(found.information.as_ref().unwrap(), &Sequential).unwrap();
    let mut planned: Vec<SweepInformation> = Vec::new();
    let mut before: Vec<f64> = places()
        .into_iter()
        .map(|(pair, omega)| planner.interval_now(pair, omega).half_db)
        .collect();
    for number in 0..6 {
        let low = 0.5 + 0.5 * random.normal().abs();
        let sweep = PlannedSweep {
            input: number % 2,
            amplitude: 0.5 + 0.3 * random.normal().abs(),
            length_s: 40.0 + 10.0 * random.normal().abs(),
            band: [low, low + 6.0 + random.normal().abs()],
            repeats: 1,
        };
        planned.push(planner.sweep_information(&sweep).unwrap());
        let all: Vec<Repeated> = planned.iter().map(|sweep| repeated(sweep, 1.0)).collect();
        let after = planner.after(&all).unwrap();
        for ((pair, omega), before) in places().into_iter().zip(&mut before) {
            let interval = planner.interval(&after, pair, omega).unwrap();
            assert!(
                interval.half_db <= *before * (1.0 + 1e-9),
                "{pair:?} {omega}"
            );
            assert!(
                interval.half_db >= planner.interval_limit(pair, omega).unwrap().half_db,
                "{pair:?} {omega}"
            );
            *before = interval.half_db;
        }
    }
}

/// Returns the information of a flown record at the model for which flights are planned.
fn information_of(record: &FlightRecord, information: &FlightInformation) -> SweepInformation {
    let prepared = segments_of(record, &Preparation::of(&["LAT", "PED"], &["P", "R"])).unwrap();
    let segments: Vec<Segment> = prepared
        .iter()
        .map(|segment| information.scales.scaled(segment))
        .collect();
    let [lowest, highest] = information.lines;
    let spectra = LineRange { lowest, highest }.spectra(&segments, &Sequential);
    let lines = SpectralLines::new(&spectra[0], &information.noise).unwrap();
    let likelihood = Likelihood::new(vec![lines], &Sequential);
    let model = DenseModel::from_state_space(&information.model).unwrap();
    let parts = likelihood.parts(&model).unwrap();
    let system = dense_system(&likelihood, &model, &parts).unwrap();
    SweepInformation(system.matrix.unscale(information.dispersion))
}

#[test]
fn the_predicted_variance_is_that_of_the_flight() {
    let mut random = Generator::new(5);
    let found = first_information(0.3, 5);
    let information = found.information.as_ref().unwrap();
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    for input in 0..2 {
        for length_s in [30.0, 60.0, 90.0] {
            let sweep = PlannedSweep {
                amplitude: 2.0,
                ..information.with_length(&sweep_of(input), length_s)
            };
            let planned = planner.sweep_information(&sweep).unwrap();
            let record = flown(&sweep, 0.3, &mut random);
            let actual = information_of(&record, information);
            let planned = planner.after(&[repeated(&planned, 1.0)]).unwrap();
            let actual = planner.after(&[repeated(&actual, 1.0)]).unwrap();
            for (pair, omega) in places() {
                let [planned, actual] =
                    [&planned, &actual].map(|after| planner.variance(after, pair, omega).unwrap());
                println!(
                    "{input} {length_s} {pair:?} {omega} {} {}",
                    planned.re / actual.re,
                    planned.im / actual.im
                );
                let ratios = [planned.re / actual.re, planned.im / actual.im];
                assert!(
                    ratios.iter().all(|ratio| (0.87..1.15).contains(ratio)),
                    "{pair:?} {omega}: {ratios:?}"
                );
            }
        }
    }
}

/// Intervals predicted for two further sweeps of each input, and obtained by flying them.
struct Comparison {
    /// Obtained over predicted half-width, sorted.
    ratios: Vec<f64>,
    /// The same, if the differences between orders fell with the variance of the fit.
    ratios_of_fit: Vec<f64>,
}

fn compare(seeds: std::ops::Range<u64>, noise: f64) -> Comparison {
    let mut comparison = Comparison {
        ratios: Vec::new(),
        ratios_of_fit: Vec::new(),
    };
    for seed in seeds {
        let mut random = Generator::new(1000 + seed);
        let mut records = first_flight(noise, &mut random);
        let found = identified(&records);
        let information = found.information.as_ref().unwrap();
        let planner = FlightPlanner::new(information, &Sequential).unwrap();
        let planned = [0, 1].map(|input| planner.sweep_information(&sweep_of(input)).unwrap());
        let planned = [repeated(&planned[0], 2.0), repeated(&planned[1], 2.0)];
        let after = planner.after(&planned).unwrap();
        let now = planner.after(&[]).unwrap();
        for input in [0, 1, 0, 1] {
            records.push(flown(&sweep_of(input), noise, &mut random));
        }
        let again = identified(&records);
        let bands = again.information.as_ref().unwrap();
        let obtained = FlightPlanner::new(bands, &Sequential).unwrap();
        for (pair, omega) in places() {
            let predicted = planner.interval(&after, pair, omega).unwrap();
            let obtained = obtained.interval_now(pair, omega);
            comparison.ratios.push(obtained.half_db / predicted.half_db);
            let [before, left] =
                [&now, &after].map(|at| planner.variance(at, pair, omega).unwrap());
            let scaled = planner.interval_now(pair, omega).half_db * (left.re / before.re).sqrt();
            comparison.ratios_of_fit.push(obtained.half_db / scaled);
        }
    }
    comparison.ratios.sort_by(f64::total_cmp);
    comparison.ratios_of_fit.sort_by(f64::total_cmp);
    comparison
}

#[test]
#[ignore = "identifies forty flights"]
fn flights_obtain_what_was_predicted() {
    for noise in [0.1, 0.3, 1.0] {
        let Comparison {
            ratios,
            ratios_of_fit,
        } = compare(0..10, noise);
        for sorted in [&ratios, &ratios_of_fit] {
            let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
            println!(
                "noise {noise}: {:.2} {:.2} {:.2} {:.2} {:.2}",
                at(0.05),
                at(0.25),
                at(0.5),
                at(0.75),
                at(0.95)
            );
        }
    }
}
