//! Predicted intervals compared with theory, with the information of flights that are simulated
//! afterwards, and with the identification of these flights.

use nalgebra::{DMatrix, DVector, dmatrix};

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord, Segment};
use gdcm_model::units::neper_to_db;

use super::coordinate_changes::coordinate_changes;
use super::flight_information::FlightInformation;
use super::flight_planner::{
    FactoredInformation, FlightPlanner, LogVariance, Repeated, SweepInformation,
};
use super::interval_target::{IntervalTarget, Need};
use super::planned_sweep::PlannedSweep;
use crate::diagnostics::bands::TWO_SIDED_95;
use crate::identification::identify::identify;
use crate::identification::known_flight::stable_feedback;
use crate::identification::real_flight_tests::Generator;
use crate::identification::{Identification, Options, Preparation};
use crate::likelihood::cost::Likelihood;
use crate::likelihood::normal_equations::{EXACT, NormalEquations};
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::spectra::preparation::segments_of;
use crate::spectra::spectrum::LineRange;

const STEP_S: f64 = 0.04;
const BAND: [f64; 2] = [1.0, 12.0];
const INPUTS: [&str; 3] = ["LON", "LAT", "PED"];
const OUTPUTS: [&str; 4] = ["P", "Q", "R", "NZ"];

/// An aircraft with its feedback and its disturbances.
struct Aircraft {
    model: StateSpace,
    /// Gains from outputs to inputs, inputs x outputs.
    feedback: DMatrix<f64>,
    /// Standard deviation of the gusts on each output; they are correlated over about a second.
    gusts: f64,
    /// Standard deviation of the measurement noise.
    noise: f64,
}

/// A lateral aircraft: a lag, and a lightly damped mode of 3 rad/s.
fn small_aircraft(noise: f64) -> Aircraft {
    let model = StateSpace::new(
        dmatrix![-2.5, 0.4, 0.0; 0.0, 0.0, 3.0; 0.3, -3.0, -1.0],
        dmatrix![8.0, 0.8; 0.0, 0.3; 0.5, 2.5],
        dmatrix![1.0, 0.2, 0.1; 0.05, 0.1, 1.0],
        DMatrix::zeros(2, 2),
    );
    Aircraft {
        model: model.unwrap(),
        feedback: DMatrix::zeros(2, 2),
        gusts: 0.0,
        noise,
    }
}

/// A helicopter of three inputs and four outputs with modes of 1.5, 3 and 6 rad/s and a lag, under
/// feedback and in gusts.
fn helicopter(random: &mut Generator) -> Aircraft {
    let mut a = DMatrix::zeros(7, 7);
    for (at, omega) in [1.5, 3.0, 6.0].into_iter().enumerate() {
        a.view_mut((2 * at, 2 * at), (2, 2))
            .copy_from(&dmatrix![0.0, omega; -omega, -omega]);
    }
    a[(6, 6)] = -2.0;
    let b = DMatrix::from_fn(7, 3, |_, _| random.normal());
    let c = DMatrix::from_fn(4, 7, |_, _| random.normal());
    let mut feedback = DMatrix::zeros(3, 4);
    for axis in 0..3 {
        feedback[(axis, axis)] = 0.05;
    }
    Aircraft {
        model: StateSpace::new(a, b, c, DMatrix::zeros(4, 3)).unwrap(),
        feedback,
        gusts: 0.2,
        noise: 0.05,
    }
}

/// A sweep of one minute with the amplitude 1, a little wider than the band.
fn sweep_of(input: usize) -> PlannedSweep {
    PlannedSweep {
        input,
        amplitude: 1.0,
        length_s: 60.0,
        band: [0.5, 16.0],
        repeats: 1,
    }
}

impl Aircraft {
    /// Simulates a sweep. The inputs are the sweep, the feedback of the sample before, and a small
    /// remnant.
    fn fly(&self, sweep: &PlannedSweep, random: &mut Generator) -> FlightRecord {
        let samples = (sweep.length_s / STEP_S).round() as usize;
        let order = self.model.order();
        let (outputs_count, inputs_count) = self.model.d().shape();
        let states = StateSpace::new(
            self.model.a().clone(),
            self.model.b().clone(),
            DMatrix::identity(order, order),
            DMatrix::zeros(order, inputs_count),
        );
        let hold = FirstOrderHold::new(&states.unwrap(), STEP_S).unwrap();
        let mut inputs = DMatrix::zeros(samples, inputs_count);
        let mut outputs = DMatrix::zeros(samples, outputs_count);
        let mut remnant = DVector::zeros(inputs_count);
        let mut gust = DVector::zeros(outputs_count);
        let mut x = DVector::zeros(order);
        for k in 0..samples {
            let mut input = remnant.clone();
            if k > 0 {
                input -= &self.feedback * outputs.row(k - 1).transpose();
            }
            input[sweep.input] += sweep.at(k as f64 * STEP_S);
            inputs.set_row(k, &input.transpose());
            if k > 0 {
                let step = inputs.rows(k - 1, 2).into_owned();
                x = hold.simulate(&x, &step).row(1).transpose();
            }
            let mut output = self.model.c() * &x + &gust;
            output.apply(|value| *value += self.noise * random.normal());
            outputs.set_row(k, &output.transpose());
            remnant.apply(|value| *value = 0.95 * *value + 0.01 * random.normal());
            let strength = self.gusts * (1.0_f64 - 0.96 * 0.96).sqrt();
            gust.apply(|value| *value = 0.96 * *value + strength * random.normal());
        }
        FlightRecord {
            name: format!("sweep {}", sweep.input),
            time_s: (0..samples).map(|k| k as f64 * STEP_S).collect(),
            inputs,
            outputs,
        }
    }

    fn inputs(&self) -> usize {
        self.model.inputs()
    }

    fn preparation(&self) -> Preparation {
        Preparation::new(
            &INPUTS[3 - self.inputs()..],
            &OUTPUTS[..self.model.outputs()],
        )
    }

    fn identified(&self, records: &[FlightRecord]) -> Identification {
        let options = Options::new(BAND, self.preparation());
        identify(records, &options, &Sequential, &Unobserved).unwrap()
    }

    /// Simulates one sweep of each input.
    fn sweep_each_input(&self, random: &mut Generator) -> Vec<FlightRecord> {
        (0..self.inputs())
            .map(|input| self.fly(&sweep_of(input), random))
            .collect()
    }

    /// Responses and frequencies \[rad/s\] at which predictions are compared.
    fn comparison_points(&self) -> Vec<(Pair, f64)> {
        let mut points = Vec::new();
        for omega in [1.0, 2.0, 3.5, 8.0] {
            for output in 0..self.model.outputs() {
                for input in 0..self.inputs() {
                    points.push((Pair { output, input }, omega));
                }
            }
        }
        points
    }
}

/// Identifies a first flight of the small aircraft.
fn first_identification(seed: u64) -> Identification {
    let aircraft = small_aircraft(0.3);
    let found = aircraft.identified(&aircraft.sweep_each_input(&mut Generator::new(seed)));
    assert!(found.information.is_some());
    found
}

/// Returns the variance of the logarithm of a response: real part for the magnitude, imaginary part
/// for the phase.
fn variance(
    planner: &FlightPlanner,
    after: &FactoredInformation,
    pair: Pair,
    omega: f64,
) -> LogVariance {
    after.variance(&planner.log_gradient(pair, omega)).unwrap()
}

fn repeated(information: &SweepInformation, times: f64) -> Repeated<'_> {
    Repeated { information, times }
}

#[test]
fn changes_of_coordinates_change_neither_response_nor_cost() {
    let found = first_identification(1);
    let information = found.information.as_ref().unwrap();
    let model = SchurModel::from_state_space(&information.model).unwrap();
    let changes = coordinate_changes(&model);
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    for (pair, omega) in small_aircraft(0.3).comparison_points() {
        let gradient = planner.log_gradient(pair, omega);
        let derivative = changes.tr_mul(&gradient);
        assert!(derivative.amax() < 1e-10 * gradient.amax() * changes.amax());
    }
    let derivative = &information.flown * &changes;
    assert!(derivative.amax() < 1e-9 * information.flown.amax() * changes.amax());
}

#[test]
fn the_information_of_the_records_gives_the_bands_of_the_identification() {
    let aircraft = small_aircraft(0.3);
    let records = aircraft.sweep_each_input(&mut Generator::new(2));
    let options = Options {
        // A single order: no differences from neighbouring orders enter the bands.
        orders: Some(vec![3]),
        ..Options::new(BAND, aircraft.preparation())
    };
    let found = identify(&records, &options, &Sequential, &Unobserved).unwrap();
    let information = found.information.as_ref().unwrap();
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    let now = planner.after(&[]).unwrap();
    for (pair, omega) in small_aircraft(0.3).comparison_points() {
        let variance = variance(&planner, &now, pair, omega);
        let fed_back = match &found.feedback {
            Some(feedback) => feedback.ratio(omega, (pair.output, pair.input)),
            None => 0.0,
        };
        // The bands contain a factor of 2 in the variance, and the part of the response that is fed
        // back (M14.17).
        let sd = (2.0 * variance.re + 0.5 * fed_back.powi(2)).sqrt();
        let interval = planner.interval_now(pair, omega);
        let ratio = neper_to_db(sd) * TWO_SIDED_95 / interval.half_db;
        // The tolerance covers the interpolation of the bands, which also accept a dispersion below
        // 1.
        assert!(
            (ratio - 1.0).abs() < 0.03,
            "{pair:?} at {omega} rad/s: {ratio}"
        );
    }
}

#[test]
fn repeats_and_amplitudes_divide_the_variance_of_the_planned_sweeps() {
    let found = first_identification(3);
    // Nearly without the information of the flown records, so that only the planned sweeps count.
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
    for (pair, omega) in small_aircraft(0.3).comparison_points() {
        let [once, twice, doubled] =
            [&once, &twice, &doubled].map(|after| variance(&planner, after, pair, omega));
        for (found, expected) in [
            (once.re / twice.re, 2.0),
            (once.im / twice.im, 2.0),
            (once.re / doubled.re, 4.0),
            (once.im / doubled.im, 4.0),
        ] {
            // The tolerance covers the remaining information of the flown records, and rounding
            // errors of the elimination.
            assert!(
                (found / expected - 1.0).abs() < 1e-4,
                "variance ratio {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn no_sweep_widens_an_interval() {
    let mut random = Generator::new(4);
    let found = first_identification(4);
    let planner = FlightPlanner::new(found.information.as_ref().unwrap(), &Sequential).unwrap();
    let mut planned: Vec<SweepInformation> = Vec::new();
    let mut before: Vec<f64> = small_aircraft(0.3)
        .comparison_points()
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
        for ((pair, omega), before) in small_aircraft(0.3)
            .comparison_points()
            .into_iter()
            .zip(&mut before)
        {
            let interval = planner.interval(&after, pair, omega).unwrap();
            assert!(
                interval.half_db <= *before * (1.0 + 1e-9),
                "{pair:?} at {omega} rad/s: {} dB after {before} dB",
                interval.half_db
            );
            assert!(
                interval.half_db >= planner.interval_limit(pair, omega).half_db,
                "{pair:?} at {omega} rad/s is below the limit: {} dB",
                interval.half_db
            );
            *before = interval.half_db;
        }
    }
}

/// Returns the information of a simulated record at the model for which flights are planned.
fn information_of(record: &FlightRecord, information: &FlightInformation) -> SweepInformation {
    let prepared = segments_of(record, &small_aircraft(0.3).preparation()).unwrap();
    let segments: Vec<Segment> = prepared
        .iter()
        .map(|segment| information.scales.scaled(segment))
        .collect();
    let [lowest, highest] = information.lines;
    let spectra = LineRange { lowest, highest }.spectra(&segments, &Sequential);
    let lines = SpectralLines::new(&spectra[0], &information.noise).unwrap();
    let likelihood = Likelihood::new(vec![lines], &Sequential);
    let model = SchurModel::from_state_space(&information.model).unwrap();
    let parts = likelihood.parts(&model).unwrap();
    let system = NormalEquations::new(&likelihood, &model, &parts, EXACT).unwrap();
    SweepInformation(system.matrix.unscale(information.dispersion))
}

#[test]
fn the_predicted_variance_agrees_with_the_information_of_the_flight() {
    let mut random = Generator::new(5);
    let found = first_identification(5);
    let information = found.information.as_ref().unwrap();
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    for input in 0..2 {
        for length_s in [30.0, 60.0, 90.0] {
            let sweep = PlannedSweep {
                amplitude: 2.0,
                ..information.with_length(&sweep_of(input), length_s)
            };
            let planned = planner.sweep_information(&sweep).unwrap();
            let record = small_aircraft(0.3).fly(&sweep, &mut random);
            let actual = information_of(&record, information);
            let planned = planner.after(&[repeated(&planned, 1.0)]).unwrap();
            let actual = planner.after(&[repeated(&actual, 1.0)]).unwrap();
            for (pair, omega) in small_aircraft(0.3).comparison_points() {
                let [planned, actual] =
                    [&planned, &actual].map(|after| variance(&planner, after, pair, omega));
                let ratios = [planned.re / actual.re, planned.im / actual.im];
                // The record differs from the planned sweep by its remnant and noise.
                assert!(
                    ratios.iter().all(|ratio| (0.87..1.15).contains(ratio)),
                    "{pair:?} at {omega} rad/s: predicted over actual variance {ratios:?}"
                );
            }
        }
    }
}

/// Half-widths of intervals after further sweeps, over many flights.
#[derive(Default)]
struct Comparison {
    /// Obtained over predicted half-widths.
    ratios: Vec<f64>,
    /// Half-widths before the sweeps over those obtained.
    gains: Vec<f64>,
    /// Flights without a model.
    failures: usize,
}

impl Comparison {
    /// Identifies a first flight, simulates two further sweeps of each input, and identifies all
    /// records.
    fn add(&mut self, aircraft: &Aircraft, random: &mut Generator) {
        let options = Options::new(BAND, aircraft.preparation());
        let mut records = aircraft.sweep_each_input(random);
        let first = identify(&records, &options, &Sequential, &Unobserved);
        for _ in 0..2 {
            records.extend(aircraft.sweep_each_input(random));
        }
        let second = identify(&records, &options, &Sequential, &Unobserved);
        let Ok(first) = first else {
            self.failures += 1;
            return;
        };
        let Ok(second) = second else {
            self.failures += 1;
            return;
        };
        let planner = FlightPlanner::new(first.information.as_ref().unwrap(), &Sequential).unwrap();
        let mut planned = Vec::new();
        for input in 0..aircraft.inputs() {
            planned.push(planner.sweep_information(&sweep_of(input)).unwrap());
        }
        let sweeps: Vec<Repeated> = planned.iter().map(|sweep| repeated(sweep, 2.0)).collect();
        let after = planner.after(&sweeps).unwrap();
        let flown = FlightPlanner::new(second.information.as_ref().unwrap(), &Sequential).unwrap();
        for (pair, omega) in aircraft.comparison_points() {
            let predicted = planner.interval(&after, pair, omega).unwrap().half_db;
            let obtained = flown.interval_now(pair, omega).half_db;
            self.ratios.push(obtained / predicted);
            self.gains
                .push(planner.interval_now(pair, omega).half_db / obtained);
        }
    }

    /// Prints the quantiles, and asserts that the median of obtained over predicted half-widths is
    /// near 1 (measured: docs/identification.md).
    fn assert_predicts(&self, name: &str) {
        let ratios = quantiles(&self.ratios);
        println!(
            "{name}: obtained over predicted {ratios:.2?}, before over obtained {:.2?}, \
             failures {}",
            quantiles(&self.gains),
            self.failures
        );
        assert!((0.75..1.4).contains(&ratios[2]), "{name}: {ratios:?}");
    }
}

/// Returns the quantiles 5, 25, 50, 75 and 95 %.
fn quantiles(values: &[f64]) -> [f64; 5] {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| sorted[(share * (sorted.len() - 1) as f64) as usize])
}

#[test]
#[ignore = "identifies eighty flights"]
fn identified_flights_have_the_predicted_intervals() {
    for noise in [0.1, 0.3, 1.0] {
        let mut comparison = Comparison::default();
        for seed in 0..10 {
            comparison.add(&small_aircraft(noise), &mut Generator::new(1000 + seed));
        }
        comparison.assert_predicts(&format!("noise {noise}"));
    }
    // u = r + K y with a random K, as in `efficiency_tests`. [`Aircraft::feedback`] has the
    // opposite sign.
    for (feedback, first) in [(0.02, 3000), (0.1, 3020)] {
        let mut comparison = Comparison::default();
        for seed in first..first + 10 {
            let mut random = Generator::new(seed);
            let mut aircraft = small_aircraft(0.3);
            aircraft.feedback = -stable_feedback(feedback, &aircraft.model, &mut random);
            comparison.add(&aircraft, &mut random);
        }
        comparison.assert_predicts(&format!("noise 0.3, feedback {feedback}"));
    }
    let mut comparison = Comparison::default();
    for seed in 0..10 {
        let mut random = Generator::new(2000 + seed);
        let aircraft = helicopter(&mut random);
        comparison.add(&aircraft, &mut random);
    }
    comparison.assert_predicts("helicopter");
}

#[test]
fn flying_the_advised_sweep_identifies_an_input_that_was_not_swept() {
    let aircraft = small_aircraft(0.3);
    let mut random = Generator::new(6);
    let mut records: Vec<FlightRecord> = (0..2)
        .map(|_| aircraft.fly(&sweep_of(0), &mut random))
        .collect();
    let options = Options {
        orders: Some(vec![3]),
        ..Options::new(BAND, aircraft.preparation())
    };
    let found = identify(&records, &options, &Sequential, &Unobserved).unwrap();
    assert!(found.not_identified.iter().any(|pair| pair.1 == 1));
    let [advice] = &found.advice[..] else {
        panic!("{:?}", found.advice)
    };
    assert_eq!((advice.sweep.sweep.input, advice.is_enough), (1, true));
    // The amplitude and the length are those of the input that was swept.
    assert!(advice.sweep.is_assumed);
    assert!((advice.sweep.sweep.amplitude - 1.0).abs() < 0.1);
    assert!((advice.sweep.sweep.length_s - 60.0).abs() < 0.1);
    // A response is identified if its standard deviation is below 3 dB, that is its 95 % half-width
    // below 1.96 times 3 dB.
    assert!(
        advice.now.half_db > 5.9 && advice.then.half_db < 5.9,
        "{advice:?}"
    );
    for _ in 0..advice.sweep.sweep.repeats {
        records.push(aircraft.fly(&advice.sweep.sweep, &mut random));
    }
    let again = identify(&records, &options, &Sequential, &Unobserved).unwrap();
    assert_eq!(again.not_identified, []);
    assert_eq!(again.advice, []);
}

#[test]
fn each_way_to_a_target_reaches_it_or_reports_that_it_is_out_of_reach() {
    let found = first_identification(7);
    let information = found.information.as_ref().unwrap();
    let planner = FlightPlanner::new(information, &Sequential).unwrap();
    let sweep = information.standard_sweep(0).unwrap();
    let pair = Pair::new(0, 0);
    let now = planner.interval_now(pair, 2.0).half_db;
    let target = |share: f64| IntervalTarget {
        pair,
        omega: 2.0,
        half_db: share * now,
    };
    let plan = planner.target_plan(target(1.1), sweep, 16).unwrap();
    assert_eq!(plan.ways, None, "the interval is already below the target");
    let ways = planner
        .target_plan(target(0.6), sweep, 16)
        .unwrap()
        .ways
        .unwrap();
    let Need::Least { amount, half_db } = ways.repeats else {
        panic!("{ways:?}")
    };
    let single_sweep = planner.sweep_information(&sweep.sweep).unwrap();
    let half_db_after = |times: f64| {
        let after = planner.after(&[repeated(&single_sweep, times)]).unwrap();
        planner.interval(&after, pair, 2.0).unwrap().half_db
    };
    assert_eq!(half_db, half_db_after(amount as f64));
    assert!(half_db <= 0.6 * now && half_db_after(amount as f64 - 1.0) > 0.6 * now);
    // The information grows with the length and with the square of the amplitude: the same target
    // needs about `amount` times the length, or the root of `amount` times the amplitude.
    let Need::Least {
        amount: length_s, ..
    } = ways.length_s
    else {
        panic!("{ways:?}")
    };
    let most_s = 60.0 * amount as f64 + 10.0;
    assert!((60.0 * (amount as f64 - 1.0) - 10.0..most_s).contains(&length_s));
    let Need::Least {
        amount: amplitude, ..
    } = ways.amplitude
    else {
        panic!("{ways:?}")
    };
    let ratio = amplitude / sweep.sweep.amplitude;
    assert!(ratio <= (amount as f64).sqrt() + 0.05 && ratio > (amount as f64 - 1.0).sqrt());
    assert!((ways.narrow_band[0] - 1.0).abs() < 1e-9 && (ways.narrow_band[1] - 4.0).abs() < 1e-9);
    // A sweep from half to twice the frequency of the target has all of its power near it, and
    // needs no more repeats.
    assert!(matches!(ways.narrow_repeats, Need::Least { amount: narrow, .. } if narrow <= amount));
    let far = planner.target_plan(target(0.01), sweep, 4).unwrap();
    let repeats = far.ways.unwrap().repeats;
    assert!(
        matches!(repeats, Need::NotWithin { most: 4, half_db } if half_db > 0.01 * now),
        "{repeats:?}"
    );
}
