//! Reading arbitrary bytes never panics, and a dataset that is written and read again is unchanged.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use proptest::prelude::*;
use serde_json::{Value, json};

use gdcm_io::files::dataset_file::save_dataset;
use gdcm_io::load_dataset;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::measured_response::{Estimate, MeasuredResponse};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, Pair, PairTable, StateSpace,
};

use super::{SMALL, gzip, load};

/// Reads bytes and returns whether they are a dataset; asserts that an error message is a single
/// line.
fn read_or_refuse(bytes: &[u8]) -> bool {
    match load(bytes) {
        Ok(_) => true,
        Err(error) => {
            let message = error.to_string();
            assert!(
                message.starts_with("test.json: ") && message.lines().count() == 1,
                "{message}"
            );
            false
        }
    }
}

/// Replaces the `nth` value of a JSON tree, counted depth-first from 0; returns the number of
/// values in the tree.
fn replace_nth(value: &mut Value, nth: usize, replacement: &Value) -> usize {
    fn visit(value: &mut Value, left: &mut Option<usize>, seen: &mut usize, replacement: &Value) {
        *seen += 1;
        if *left == Some(0) {
            *value = replacement.clone();
        }
        *left = left.and_then(|left| left.checked_sub(1));
        match value {
            Value::Array(entries) => {
                for entry in entries {
                    visit(entry, left, seen, replacement);
                }
            }
            Value::Object(entries) => {
                for entry in entries.values_mut() {
                    visit(entry, left, seen, replacement);
                }
            }
            _ => {}
        }
    }
    let mut seen = 0;
    visit(value, &mut Some(nth), &mut seen, replacement);
    seen
}

fn unexpected_values() -> impl Strategy<Value = Value> {
    prop::sample::select(vec![
        json!(null),
        json!(true),
        json!("nominal"),
        json!(""),
        json!(0),
        json!(-1),
        json!(1e308),
        json!(u64::MAX),
        json!(i64::MIN),
        json!([]),
        json!([[]]),
        json!([[[1]]]),
        json!({}),
        json!({"name": "x"}),
    ])
}

/// Generates any finite number, including subnormal and extreme ones.
fn numbers() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = DMatrix<f64>> {
    prop::collection::vec(numbers(), rows * columns)
        .prop_map(move |values| DMatrix::from_row_slice(rows, columns, &values))
}

fn state_space(p: usize, m: usize) -> impl Strategy<Value = Dynamics> {
    (0_usize..4).prop_flat_map(move |n| {
        (
            matrix(n, n),
            matrix(n, m),
            matrix(p, n),
            matrix(p, m),
            timing(p, m),
        )
            .prop_map(|(a, b, c, d, timing)| {
                Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap().timed(timing).unwrap())
            })
    })
}

fn timing(p: usize, m: usize) -> impl Strategy<Value = Timing> {
    let delays = |count| prop::option::of(prop::collection::vec(0.0..=60.0_f64, count));
    (prop::option::of(1e-9..1e9_f64), delays(m), delays(p)).prop_map(
        |(sample_time_s, input_delays_s, output_delays_s)| Timing {
            sample_time_s,
            input_delays_s,
            output_delays_s,
        },
    )
}

fn measured(p: usize, m: usize) -> impl Strategy<Value = Dynamics> {
    let values = move || prop::collection::vec(numbers(), 3 * p * m);
    let coherence = prop::option::of(prop::collection::vec(0.0..=1.0_f64, 3 * p * m));
    let band = prop::option::of((0.0..5.0_f64, 5.0..1e3_f64));
    (
        values(),
        values(),
        coherence,
        band,
        prop::option::of(1e-6..=1e6_f64),
    )
        .prop_map(move |(re, im, coherence, band, window_s)| {
            let table = |values: &[f64]| {
                PairTable::from_fn(p, m, |Pair { output, input }| {
                    values[3 * (output * m + input)..][..3].to_vec()
                })
            };
            let coherence = coherence.as_deref().map(table);
            let response =
                MeasuredResponse::new(vec![0.1, 1.0, 1e300], &table(&re), &table(&im), coherence)
                    .unwrap();
            let response = response
                .with_estimate(Estimate {
                    // Averages have the same limits as windows.
                    averages: window_s,
                    window_s,
                })
                .unwrap();
            Dynamics::Measured(match band {
                Some((low, high)) => response
                    .with_valid_bands(PairTable::filled(p, m, [low, high]))
                    .unwrap(),
                None => response,
            })
        })
}

fn condition(id: i64, p: usize, m: usize) -> impl Strategy<Value = Condition> {
    let perturbation = prop::option::of(prop::collection::btree_map(
        "[a-z\"\\\\\u{e9}]{1,4}",
        numbers(),
        0..3,
    ));
    let identified = prop_oneof![state_space(p, m).boxed(), measured(p, m).boxed()];
    let state = (
        0.0..1e3_f64,
        prop::option::of(numbers()),
        prop::option::of("[ -~]{0,5}"),
    );
    let method_and_order = (prop::option::of("[a-z]{1,3}"), prop::option::of(0_usize..9));
    (
        state_space(p, m),
        state_space(p, m),
        identified,
        perturbation,
        state,
        method_and_order,
    )
        .prop_map(
            move |(
                nominal,
                perturbed,
                identified,
                perturbation,
                (airspeed_kt, altitude_ft, altitude),
                (method, order),
            )| {
                let flight_state = FlightState {
                    id: ConditionId(id),
                    name: format!("condition \"{id}\"\n"),
                    airspeed_kt,
                    altitude,
                    altitude_ft,
                    weight: None,
                    mass_kg: Some(6600.0),
                };
                let unperturbed: Option<BTreeMap<String, f64>> = None;
                let model = |name: &str, origin, dynamics| Model::new(name, origin, dynamics);
                let physics = vec![
                    model("a", Origin::Perturbed { perturbation }, perturbed),
                    model(
                        "b",
                        Origin::Nominal {
                            perturbation: unperturbed,
                        },
                        nominal,
                    ),
                ];
                let identified = vec![model("a", Origin::Identified { method, order }, identified)];
                Condition::new(flight_state, physics, identified).unwrap()
            },
        )
}

fn datasets() -> impl Strategy<Value = Dataset> {
    (1_usize..4, 1_usize..4).prop_flat_map(|(p, m)| {
        let on_axis = prop::collection::vec(any::<bool>(), p * m);
        (
            condition(i64::MIN, p, m),
            condition(3, p, m),
            on_axis,
            "[ -~]{0,8}",
        )
            .prop_map(move |(first, second, on_axis, text)| {
                let channels = |letter: char, count: usize| {
                    (0..count)
                        .map(|index| Channel::new(format!("{letter}{index}"), "m/s²"))
                        .collect()
                };
                let header = DatasetHeader {
                    name: text.clone(),
                    description: text,
                    inputs: channels('u', m),
                    outputs: channels('y', p),
                    on_axis: PairTable::from_fn(p, m, |Pair { output, input }| {
                        on_axis[output * m + input]
                    }),
                    band: Band::new(1e-3, 1e3).unwrap(),
                    parameters: Vec::new(),
                };
                Dataset::new(header, vec![first, second]).unwrap()
            })
    })
}

proptest! {
    #[test]
    fn a_file_truncated_anywhere_is_refused(cut in 0..SMALL.trim_end().len()) {
        prop_assert!(!read_or_refuse(&SMALL.as_bytes()[..cut]));
    }

    #[test]
    fn flipped_bits_never_make_the_reader_panic(
        flips in prop::collection::vec((0..SMALL.len(), 0_u8..8), 1..4),
    ) {
        let mut bytes = SMALL.as_bytes().to_vec();
        for (at, bit) in flips {
            bytes[at] ^= 1 << bit;
        }
        read_or_refuse(&bytes);
    }

    #[test]
    fn a_flipped_bit_in_a_gzip_file_never_changes_the_dataset(
        place in 0.0..1.0_f64, bit in 0_u8..8,
    ) {
        let mut bytes = gzip(SMALL.as_bytes());
        let at = (place * bytes.len() as f64) as usize;
        bytes[at] ^= 1 << bit;
        // If the file can still be read, the dataset must be unchanged: some bits have no meaning
        // (such as the time of compression), and others select one of two equal strings to copy
        // from.
        if read_or_refuse(&bytes) {
            let undamaged = load(SMALL.as_bytes()).unwrap().dataset;
            prop_assert_eq!(load(&bytes).unwrap().dataset, undamaged);
        }
    }

    #[test]
    fn a_replaced_value_never_makes_the_reader_panic(
        nth in 0_usize..400, replacement in unexpected_values(),
    ) {
        let mut value: Value = serde_json::from_str(SMALL).unwrap();
        let count = replace_nth(&mut value.clone(), usize::MAX, &Value::Null);
        replace_nth(&mut value, nth % count, &replacement);
        read_or_refuse(&serde_json::to_vec(&value).unwrap());
    }

    #[test]
    fn arbitrary_bytes_never_make_the_reader_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        read_or_refuse(&bytes);
    }

    #[test]
    fn a_dataset_is_unchanged_after_saving_and_reading(
        dataset in datasets(), packed in any::<bool>(),
    ) {
        let directory = tempfile::tempdir().unwrap();
        let name = if packed { "dataset.json.gz" } else { "dataset.json" };
        let path = directory.path().join(name);
        save_dataset(&dataset, &path).unwrap();
        prop_assert_eq!(std::fs::read(&path).unwrap().starts_with(&[0x1f, 0x8b]), packed);
        let loaded = load_dataset(&path).unwrap();
        prop_assert_eq!(&*loaded.dataset, &dataset);
    }
}
