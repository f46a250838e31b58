//! Synthetic flights of one axis, without a fault or with a single fault: the right caution is
//! raised, and no other. Seeds are fresh: they were not used to tune the cautions.

use std::collections::BTreeSet;
use std::ops::Range;

use nalgebra::DMatrix;

use gdcm_model::dataset::{Band, Dynamics, Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, PreparedModel};
use gdcm_model::simulation::{FirstOrderHold, FlightRecord, Signal};

use super::identify::identify;
use super::real_flight_tests::{Generator, SyntheticFlight, codes, options, reference_results};
use super::{Options, Preparation};
use crate::spectra::preparation::prepare;

/// Records, and the options of their identification.
struct Flights {
    records: Vec<FlightRecord>,
    options: Options,
}

impl Flights {
    /// Identifies the flights and returns the codes of the cautions without duplicates.
    fn raised_codes(&self) -> BTreeSet<&'static str> {
        let found = identify(&self.records, &self.options, &Sequential, &Unobserved).unwrap();
        codes(&found).into_iter().collect()
    }
}

fn calm(seed: u64) -> SyntheticFlight {
    SyntheticFlight::calm(seed, 0)
}

/// Simulates `count` flights of a minute; `settings` returns those of a seed.
fn flights(count: u64, seed: u64, settings: impl Fn(u64) -> SyntheticFlight) -> Vec<FlightRecord> {
    let file = reference_results();
    (0..count)
        .map(|number| settings(10_000 + 10 * seed + number).record(&file).0)
        .collect()
}

/// Simulates `count` flights; the outputs of the last flight are logged four samples late.
fn last_late(count: u64, seed: u64) -> Vec<FlightRecord> {
    let mut records = flights(count, seed, calm);
    let last = SyntheticFlight::calm(10_000 + 10 * seed + count - 1, 4)
        .record(&reference_results())
        .0;
    records.pop();
    records.push(last);
    records
}

/// Returns the root mean square of the outputs.
fn deviation(record: &FlightRecord) -> f64 {
    (record.outputs.norm_squared() / record.outputs.len() as f64).sqrt()
}

/// Flights with a fault.
struct FaultCase {
    name: &'static str,
    /// The code that has to be raised.
    code: &'static str,
    /// Further codes that may be raised.
    consequences: &'static [&'static str],
    /// Simulates the flights of a seed.
    simulate: fn(u64) -> Flights,
}

const FAULT_CASES: [FaultCase; 11] = [
    FaultCase {
        name: "gusts fed back",
        code: "feedback",
        // Motion by gusts is noise: the sweep exceeds it over a narrower band.
        consequences: &["not-identified", "unstable", "band-narrowed"],
        simulate: |seed| Flights {
            records: flights(3, seed, |seed| SyntheticFlight {
                gust: 2.0,
                amplitude: 0.4,
                noise: 0.02,
                feedback: 0.15,
                ..calm(seed)
            }),
            options: options(),
        },
    },
    FaultCase {
        name: "one record late",
        code: "time-skew",
        consequences: &[],
        simulate: |seed| Flights {
            records: last_late(3, seed),
            options: options(),
        },
    },
    FaultCase {
        name: "one record of two late",
        code: "time-skew",
        consequences: &[],
        simulate: |seed| Flights {
            records: last_late(2, seed),
            options: options(),
        },
    },
    FaultCase {
        name: "one record with reversed sign",
        code: "sign",
        consequences: &["not-identified"],
        simulate: |seed| {
            let mut records = flights(3, seed, calm);
            records[2].outputs.neg_mut();
            Flights {
                records,
                options: options(),
            }
        },
    },
    FaultCase {
        name: "clipped output",
        code: "clipped",
        // The response of a clipped output is non-linear.
        consequences: &["inadequate", "order-limit", "points", "unstable"],
        simulate: |seed| {
            let mut records = flights(3, seed, calm);
            for record in &mut records {
                let limit = 1.5 * deviation(record);
                record.outputs.apply(|y| *y = y.clamp(-limit, limit));
            }
            Flights {
                records,
                options: options(),
            }
        },
    },
    FaultCase {
        name: "output that stands still",
        code: "stuck",
        consequences: &[],
        simulate: |seed| {
            let mut records = flights(3, seed, calm);
            // The output is held for 3 s from 20 s on, at 50 Hz.
            let held = records[0].outputs[(1000, 0)];
            records[0].outputs.rows_mut(1000, 150).fill(held);
            Flights {
                records,
                options: options(),
            }
        },
    },
    FaultCase {
        name: "coarsely rounded output",
        code: "coarse",
        // The error of rounding to coarse steps follows the signal, as feedback does, and hides the
        // weak upper band end.
        consequences: &[
            "feedback",
            "feedback-some",
            "band-narrowed",
            "unstable",
            "points",
        ],
        simulate: |seed| {
            let step = 0.6 * deviation(&flights(1, seed, calm)[0]);
            let mut records = flights(3, seed, calm);
            for record in &mut records {
                record.outputs.apply(|y| *y = (*y / step).round() * step);
            }
            Flights {
                records,
                options: options(),
            }
        },
    },
    FaultCase {
        name: "order too low",
        code: "points",
        consequences: &["inadequate"],
        simulate: |seed| Flights {
            records: flights(3, seed, calm),
            options: Options {
                orders: Some(vec![1]),
                ..options()
            },
        },
    },
    FaultCase {
        name: "inputs flown together",
        code: "collinear-inputs",
        consequences: &["not-identified", "not-swept"],
        simulate: |seed| {
            let mut random = Generator::new(seed);
            let mut records = flights(3, seed, calm);
            for record in &mut records {
                let first = record.inputs.column(0).into_owned();
                let second = first.map(|u| u + 0.02 * random.normal());
                record.inputs = DMatrix::from_columns(&[first, second]);
            }
            Flights {
                records,
                options: Options::new([1.0, 12.0], Preparation::new(&["LON", "LAT"], &["Q"])),
            }
        },
    },
    FaultCase {
        name: "short records",
        code: "short",
        // With few lines a record sometimes differs from the others by chance: in 4 of 30 flights.
        consequences: &["reweighed"],
        // 25 s are four periods of 1 rad/s.
        simulate: |seed| Flights {
            records: flights(3, seed, |seed| SyntheticFlight {
                seconds: 25.0,
                ..calm(seed)
            }),
            options: options(),
        },
    },
    FaultCase {
        name: "held-out record with another gain",
        code: "held-out",
        consequences: &[],
        simulate: |seed| {
            let mut records = flights(3, seed, calm);
            records[2].outputs *= 1.6;
            Flights {
                records,
                options: Options {
                    held_out: vec![2],
                    ..options()
                },
            }
        },
    },
];

/// Asserts that calm flights raise no caution, and that each fault raises its caution and at most
/// its consequences, except at the rates stated in M14.14 to M14.18.
fn assert_cautions_over(seeds: Range<u64>) {
    let count = seeds.clone().count();
    let without_fault: Vec<BTreeSet<&str>> = seeds
        .clone()
        .map(|seed| {
            let calm = Flights {
                records: flights(3, seed, calm),
                options: options(),
            };
            calm.raised_codes()
        })
        .collect();
    // False alarms: feedback in 3 of 30 flights, points in 4 of 126, others in none.
    assert!(
        count_raising(&without_fault, "feedback") <= count / 10,
        "{without_fault:?}"
    );
    assert!(
        count_raising(&without_fault, "points") <= count / 30,
        "{without_fault:?}"
    );
    let others = without_fault
        .iter()
        .flatten()
        .filter(|code| !code.starts_with("feedback") && **code != "points");
    assert_eq!(others.count(), 0, "{without_fault:?}");
    let mut wrong = Vec::new();
    for case in &FAULT_CASES {
        let raised: Vec<BTreeSet<&str>> = seeds
            .clone()
            .map(|seed| (case.simulate)(seed).raised_codes())
            .collect();
        let missed = count - count_raising(&raised, case.code);
        let unexpected = raised
            .iter()
            .filter(|codes| codes.iter().any(|code| case.is_unexpected(code)))
            .count();
        if missed > count / 10 || unexpected > count / 10 {
            wrong.push(format!(
                "{}: missed in {missed}, others raised in {unexpected} of {count} flights: \
                 {raised:?}",
                case.name
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

impl FaultCase {
    /// Returns whether a code is neither that of the fault nor one of its consequences.
    fn is_unexpected(&self, code: &str) -> bool {
        !code.starts_with(self.code) && !self.consequences.contains(&code)
    }
}

/// Counts the flights that raise a code starting with `start`.
fn count_raising(flights: &[BTreeSet<&str>], start: &str) -> usize {
    flights
        .iter()
        .filter(|codes| codes.iter().any(|code| code.starts_with(start)))
        .count()
}

/// Returns the inputs at their limit, in records that raise no caution.
fn inputs_at_limit(records: &[FlightRecord]) -> Vec<(Signal, f64)> {
    let prepared = prepare(records, &options().preparation, &Sequential).unwrap();
    assert_eq!(prepared.cautions, []);
    let mut inputs = Vec::new();
    for used in prepared.records {
        inputs.extend(used.inputs_at_limit);
    }
    inputs
}

#[test]
fn an_input_at_its_limit_is_reported_without_a_caution() {
    let mut records = flights(1, 0, calm);
    assert!(inputs_at_limit(&records).is_empty());
    // A sweep of amplitude 1 is beyond 0.9 for 29 % of the time; the remnant lowers this share.
    records[0].inputs.apply(|u| *u = u.clamp(-0.9, 0.9));
    let inputs = inputs_at_limit(&records);
    assert!(
        matches!(&inputs[..], [(input, percent)] if input.name == "LON" && *percent > 0.0),
        "{inputs:?}"
    );
}

#[test]
fn calm_flights_raise_no_caution_and_each_fault_raises_its_own() {
    assert_cautions_over(0..2);
}

#[test]
#[ignore = "two seeds are enough by default; thirty take minutes"]
fn calm_flights_raise_no_caution_and_each_fault_raises_its_own_over_many_seeds() {
    assert_cautions_over(100..130);
}

/// Returns a stable aircraft with modes of 1.5, 3 and 6 rad/s and a lag of 2 rad/s, and random
/// input and output matrices.
pub(crate) fn aircraft(inputs: usize, outputs: usize, random: &mut Generator) -> StateSpace {
    let mut a = DMatrix::zeros(7, 7);
    for (at, omega) in [1.5, 3.0, 6.0].into_iter().enumerate() {
        a.view_mut((2 * at, 2 * at), (2, 2))
            .copy_from(&nalgebra::dmatrix![0.0, omega; -omega, -omega]);
    }
    a[(6, 6)] = -2.0;
    let b = DMatrix::from_fn(7, inputs, |_, _| random.normal());
    let c = DMatrix::from_fn(outputs, 7, |_, _| random.normal());
    StateSpace::new(a, b, c, DMatrix::zeros(outputs, inputs)).unwrap()
}

/// Simulates a one-minute sweep of each input in turn while the others move a little; the noise of
/// every output has a fiftieth of the output's amplitude.
fn sweeps(model: &StateSpace, random: &mut Generator) -> Vec<FlightRecord> {
    const STEP_S: f64 = 0.02;
    let time_s: Vec<f64> = (0..3000).map(|k| STEP_S * f64::from(k)).collect();
    let plant = FirstOrderHold::new(model, STEP_S).unwrap();
    let mut records = Vec::new();
    for swept in 0..model.inputs() {
        let mut slow = vec![0.0; model.inputs()];
        let inputs = DMatrix::from_fn(model.inputs(), time_s.len(), |input, k| {
            slow[input] = 0.95 * slow[input] + 0.02 * random.normal();
            // A logarithmic sweep from 0.13 to 2.6 Hz.
            let rate = 20f64.ln();
            let turns = 0.13 * 60.0 / rate * ((rate * time_s[k] / 60.0).exp() - 1.0);
            slow[input]
                + if input == swept {
                    (std::f64::consts::TAU * turns).sin()
                } else {
                    0.0
                }
        });
        let inputs = inputs.transpose();
        let mut outputs = plant.simulate(&nalgebra::DVector::zeros(model.order()), &inputs);
        for mut column in outputs.column_iter_mut() {
            let noise = 0.02 * (column.norm_squared() / column.len() as f64).sqrt();
            column.apply(|y| *y += noise * random.normal());
        }
        records.push(FlightRecord {
            name: format!("sweep {swept}"),
            time_s: time_s.clone(),
            inputs,
            outputs,
        });
    }
    records
}

/// Asserts that the model of simulated records has the response of the aircraft: within 6 % (half a
/// decibel) of its modulus or, if that is larger, of 0.3 times the strongest response of the
/// output.
fn assert_identified(inputs: usize, outputs: usize) {
    let mut random = Generator::new(7 + 100 * inputs as u64 + outputs as u64);
    let truth = aircraft(inputs, outputs, &mut random);
    let records = sweeps(&truth, &mut random);
    let preparation = Preparation::new(
        &["u0", "u1", "u2", "u3", "u4", "u5", "u6", "u7"][..inputs],
        &[
            "y0", "y1", "y2", "y3", "y4", "y5", "y6", "y7", "y8", "y9", "y10", "y11",
        ][..outputs],
    );
    let options = Options::new([1.0, 12.0], preparation);
    let found = identify(&records, &options, &Sequential, &Unobserved).unwrap();
    let grid = FrequencyGrid::logarithmic(Band::new(1.2, 10.0).unwrap(), 8);
    let identified = PreparedModel::new(&found.refined.dynamics).response(&grid);
    let expected = PreparedModel::new(&Dynamics::StateSpace(truth)).response(&grid);
    for output in 0..outputs {
        let strongest = (0..inputs)
            .flat_map(|input| expected.curve(Pair::new(output, input)))
            .map(|h| h.norm())
            .fold(0.0, f64::max);
        for input in 0..inputs {
            let pair = Pair::new(output, input);
            for (found, expected) in identified.curve(pair).iter().zip(expected.curve(pair)) {
                // The noise of an output does not depend on which input moves it: weak responses
                // have larger relative errors.
                let error = (found - expected).norm() / expected.norm().max(0.3 * strongest);
                assert!(
                    error < 0.06,
                    "{inputs} inputs, {outputs} outputs, {pair:?}: {found}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn the_aircraft_is_identified_for_up_to_eight_inputs_and_twelve_outputs() {
    for (inputs, outputs) in [(1, 1), (1, 3), (3, 1), (2, 2), (8, 12)] {
        assert_identified(inputs, outputs);
    }
}
