//! Fresh synthetic flights of one axis, without a fault or with a single fault: the right caution
//! is raised, and no other.

use std::collections::BTreeSet;
use std::ops::Range;

use nalgebra::DMatrix;

use gdcm_model::dataset::{Band, Dynamics, Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, PreparedModel};
use gdcm_model::simulation::{FirstOrderHold, FlightRecord, Signal};

use super::identify::identify;
use super::real_flight_tests::{Flown, Generator, codes, known, options};
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

fn calm(seed: u64) -> Flown {
    Flown::calm(seed, 0)
}

/// Simulates `count` flights of a minute, with fresh seeds.
fn flights(count: u64, seed: u64, flown: impl Fn(u64) -> Flown) -> Vec<FlightRecord> {
    let file = known();
    (0..count)
        .map(|at| flown(10_000 + 10 * seed + at).record(&file).0)
        .collect()
}

/// Simulates `count` flights; the outputs of the last flight are logged four samples late.
fn last_late(count: u64, seed: u64) -> Vec<FlightRecord> {
    let mut records = flights(count, seed, calm);
    let last = Flown::calm(10_000 + 10 * seed + count - 1, 4)
        .record(&known())
        .0;
    records.pop();
    records.push(last);
    records
}

fn deviation(record: &FlightRecord) -> f64 {
    (record.outputs.norm_squared() / record.outputs.len() as f64).sqrt()
}

/// Flights with a fault.
struct Trap {
    name: &'static str,
    /// The code that has to be raised.
    code: &'static str,
    /// Further codes that may be raised as consequences.
    follows: &'static [&'static str],
    /// Generates the flights from a seed.
    flown: fn(u64) -> Flights,
}

const TRAPS: [Trap; 11] = [
    Trap {
        name: "gusts fed back",
        code: "feedback",
        // Motion by gusts is noise: the sweep exceeds it over a narrower band.
        follows: &["not-identified", "unstable", "band-narrowed"],
        flown: |seed| Flights {
            records: flights(3, seed, |seed| Flown {
                gust: 2.0,
                amp: 0.4,
                noise: 0.02,
                feedback: 0.15,
                ..calm(seed)
            }),
            options: options(),
        },
    },
    Trap {
        name: "one late",
        code: "time-skew",
        follows: &[],
        flown: |seed| Flights {
            records: last_late(3, seed),
            options: options(),
        },
    },
    Trap {
        name: "one of a pair late",
        code: "time-skew",
        follows: &[],
        flown: |seed| Flights {
            records: last_late(2, seed),
            options: options(),
        },
    },
    Trap {
        name: "one turned",
        code: "sign",
        follows: &["not-identified"],
        flown: |seed| {
            let mut records = flights(3, seed, calm);
            records[2].outputs.neg_mut();
            Flights {
                records,
                options: options(),
            }
        },
    },
    Trap {
        name: "clipped",
        code: "clipped",
        // The response of a clipped output is non-linear.
        follows: &["inadequate", "order-limit", "points", "unstable"],
        flown: |seed| {
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
    Trap {
        name: "stuck",
        code: "stuck",
        follows: &[],
        flown: |seed| {
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
    Trap {
        name: "coarse",
        code: "coarse",
        // The error of rounding to coarse steps follows the signal, as feedback does, and hides the
        // weak upper band end.
        follows: &[
            "feedback",
            "feedback-some",
            "band-narrowed",
            "unstable",
            "points",
        ],
        flown: |seed| {
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
    Trap {
        name: "order too low",
        code: "points",
        follows: &["inadequate"],
        flown: |seed| Flights {
            records: flights(3, seed, calm),
            options: Options {
                orders: Some(vec![1]),
                ..options()
            },
        },
    },
    Trap {
        name: "inputs flown together",
        code: "collinear-inputs",
        follows: &["not-identified", "not-swept"],
        flown: |seed| {
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
    Trap {
        name: "short",
        code: "short",
        // With few lines a record is sometimes unlike the others by chance: 4 of 30.
        follows: &["reweighed"],
        // 25 s are four periods of 1 rad/s.
        flown: |seed| Flights {
            records: flights(3, seed, |seed| Flown {
                seconds: 25.0,
                ..calm(seed)
            }),
            options: options(),
        },
    },
    Trap {
        name: "held out and flown differently",
        code: "held-out",
        follows: &[],
        flown: |seed| {
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

/// Asserts that calm flights raise no caution, and that each trap raises its own caution and its
/// consequences at the rates stated in M14.14 to M14.18.
fn assert_cautions_over(seeds: Range<u64>) {
    let count = seeds.clone().count();
    let good: Vec<BTreeSet<&str>> = seeds
        .clone()
        .map(|seed| {
            let calm = Flights {
                records: flights(3, seed, calm),
                options: options(),
            };
            calm.raised_codes()
        })
        .collect();
    // False alarms: feedback 3 of 30, points 4 of 126, the others none.
    assert!(count_raising(&good, "feedback") <= count / 10, "{good:?}");
    assert!(count_raising(&good, "points") <= count / 30, "{good:?}");
    let others = good
        .iter()
        .flatten()
        .filter(|code| !code.starts_with("feedback") && **code != "points");
    assert_eq!(others.count(), 0, "{good:?}");
    let mut wrong = Vec::new();
    for trap in &TRAPS {
        let raised: Vec<BTreeSet<&str>> = seeds
            .clone()
            .map(|seed| (trap.flown)(seed).raised_codes())
            .collect();
        let missed = count - count_raising(&raised, trap.code);
        let others = raised
            .iter()
            .filter(|codes| codes.iter().any(|code| trap.is_other(code)))
            .count();
        if missed > count / 10 || others > count / 10 {
            wrong.push(format!(
                "{}: missed {missed}, others {others} of {count}: {raised:?}",
                trap.name
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

impl Trap {
    /// Returns whether a code is neither the code of the trap nor one of its consequences.
    fn is_other(&self, code: &str) -> bool {
        !code.starts_with(self.code) && !self.follows.contains(&code)
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
fn an_input_at_its_limit_is_a_fact_and_no_caution() {
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
fn good_flights_raise_no_caution_and_each_trap_its_own() {
    assert_cautions_over(0..2);
}

#[test]
#[ignore = "two seeds are enough by default; thirty take minutes"]
fn good_flights_raise_no_caution_and_each_trap_its_own_over_many_seeds() {
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

/// Asserts that the model of flown records has the response of the aircraft within half a decibel
/// where it is strong.
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
            .map(|h| h.norm());
        let strongest = strongest.fold(0.0, f64::max);
        for input in 0..inputs {
            let pair = Pair::new(output, input);
            for (found, expected) in identified.curve(pair).iter().zip(expected.curve(pair)) {
                // The noise of an output does not depend on which input moves it: weak responses
                // have larger relative errors.
                let error = (found - expected).norm() / expected.norm().max(0.3 * strongest);
                assert!(
                    error < 0.06,
                    "{inputs} x {outputs}, {pair:?}: {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn records_of_one_input_and_output_up_to_eight_and_twelve_give_the_aircraft() {
    for (inputs, outputs) in [(1, 1), (1, 3), (3, 1), (2, 2), (8, 12)] {
        assert_identified(inputs, outputs);
    }
}
