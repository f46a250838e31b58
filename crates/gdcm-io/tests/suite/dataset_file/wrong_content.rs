//! Dataset files rejected because of their content.

use super::*;

#[test]
fn a_key_that_is_missing_is_named_with_its_place() {
    let remove = |file: &mut Value, pointer: &str, key: &str| {
        file.pointer_mut(pointer)
            .unwrap()
            .as_object_mut()
            .unwrap()
            .remove(key)
            .unwrap();
    };
    for (pointer, key, place) in [
        ("", "inputs", "the key \"inputs\" is missing"),
        ("/inputs/1", "unit", "inputs, entry 2: the key \"unit\""),
        (
            "/frequency_band",
            "unit",
            "frequency_band: the key \"unit\"",
        ),
        (
            "/conditions/1",
            "airspeed_kt",
            "condition 10 (number 2 in the file): the key \"airspeed_kt\"",
        ),
        (
            "/conditions/1",
            "id",
            "condition number 2 in the file: the key \"id\"",
        ),
        (
            "/conditions/0/physics_models/1",
            "role",
            "physics model \"V+5kt\" (number 2): the key \"role\"",
        ),
        (
            "/conditions/0/physics_models/1",
            "B",
            "physics model \"V+5kt\" (number 2): matrix B is missing",
        ),
        (
            "/conditions/0/identified_models/0",
            "C",
            "identified model \"sweeps\" (number 1): matrix C is missing",
        ),
        (
            "/conditions/0/identified_models/1/frequency_response",
            "im",
            "\"measured\" (number 2), frequency_response: the key",
        ),
    ] {
        assert_refused(|file| remove(file, pointer, key), &[place]);
    }
}

#[test]
fn text_where_a_number_belongs_is_named_by_matrix_row_and_column() {
    assert_refused(
        |file| file["conditions"][1]["physics_models"][0]["B"][1][0] = json!("0.2"),
        &[
            "condition 10 (number 2 in the file), physics model \"nominal\" (number 1), matrix B, row 2, column 1: ",
            "expected a number (without quotation marks), found the text \"0.2\"",
        ],
    );
    assert_refused(
        |file| file["conditions"][0]["airspeed_kt"] = json!(null),
        &["airspeed_kt", "a number", "found null"],
    );
    assert_refused(
        |file| file["conditions"][0]["id"] = json!(1.5),
        &["id", "expected a whole number, found 1.5"],
    );
    assert_refused(
        |file| file["name"] = json!(5),
        &["name: expected text in quotation marks, found 5"],
    );
    assert_refused(
        |file| file["inputs"] = json!({"name": "LON"}),
        &["inputs: expected a list, found an object"],
    );
}

#[test]
fn a_number_that_is_not_finite_is_named_with_its_place_and_as_it_stands() {
    for written in [
        "NaN",
        "nan",
        "Infinity",
        "-Infinity",
        "-inf",
        "1e999",
        "-1e999",
    ] {
        assert_text_refused(
            "[-0.5, 1.0]",
            &format!("[-0.5, {written}]"),
            &[
                "physics model \"nominal\" (number 1), matrix A, row 1, column 2: expected a finite number",
                written,
            ],
        );
    }
    assert_text_refused(
        "\"mass_kg\": 6600",
        "\"mass_kg\": 1e400",
        &["condition 7", "mass_kg", "found 1e400"],
    );
}

#[test]
fn ragged_and_mis_shaped_matrices_are_named() {
    let model = "condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)";
    for (matrix, value, words) in [
        (
            "A",
            json!([[1, 2], [3]]),
            "matrix A, row 2: expected 2 entries, as in the first of these lists, found 1",
        ),
        (
            "A",
            json!([[1, 2]]),
            "matrix A: expected 1 x 1, found 1 x 2",
        ),
        ("A", json!([]), "matrix B: expected 0 x 2, found 2 x 2"),
        (
            "B",
            json!([[1, 2]]),
            "matrix B: expected 2 x 2, found 1 x 2",
        ),
        (
            "C",
            json!([[1, 2], [3, 4], [5, 6]]),
            "matrix C: expected 2 x 2, found 3 x 2",
        ),
        (
            "D",
            json!([[0, 0, 0], [0, 0, 0]]),
            "matrix D: expected 2 x 2 (outputs x inputs), found 2 x 3",
        ),
        (
            "D",
            json!([]),
            "matrix D: expected 2 x 2 (outputs x inputs), found 0 x 0",
        ),
        (
            "D",
            json!([1, 2]),
            "matrix D, row 1: expected a list of numbers, found 1",
        ),
        (
            "D",
            json!(5),
            "matrix D: expected a list of lists of numbers, found 5",
        ),
    ] {
        assert_refused(
            |file| file["conditions"][0]["physics_models"][1][matrix] = value,
            &[model, words],
        );
    }
}

#[test]
fn a_bundle_needs_exactly_one_nominal_model() {
    let role = |file: &mut Value, model: usize, role: &str| {
        file["conditions"][0]["physics_models"][model]["role"] = json!(role);
    };
    assert_refused(
        |file| role(file, 0, "perturbed"),
        &["condition 7", "exactly one nominal model, found 0"],
    );
    assert_refused(
        |file| role(file, 1, "nominal"),
        &["condition 7", "found 2 (nominal, V+5kt)"],
    );
    assert_refused(
        |file| role(file, 1, "trim"),
        &[
            "\"V+5kt\"",
            "role: expected \"nominal\" or \"perturbed\", found \"trim\"",
        ],
    );
}

#[test]
fn empty_lists_are_refused() {
    assert_refused(
        |file| file["conditions"][1]["physics_models"] = json!([]),
        &[
            "condition 10 (number 2 in the file)",
            "the physics bundle",
            "at least one model",
        ],
    );
    assert_refused(
        |file| file["conditions"] = json!([]),
        &["conditions: expected at least one entry"],
    );
}

#[test]
fn a_condition_without_identified_models_is_no_fault() {
    let mut file: Value =
        serde_json::from_str(include_str!("../../../../../tests/data/small-dataset.json")).unwrap();
    file["conditions"][0]["identified_models"] = json!([]);
    file["conditions"][1]
        .as_object_mut()
        .unwrap()
        .remove("identified_models");
    let origin = gdcm_io::DatasetOrigin::File("small.json".into());
    let loaded = gdcm_io::load_dataset_bytes(file.to_string().as_bytes(), origin).unwrap();
    assert_eq!(
        loaded.dataset.without_reference(),
        loaded.dataset.ids().collect::<Vec<_>>()
    );
    assert!(loaded.cautions.is_empty(), "{:?}", loaded.cautions);
}

#[test]
fn ids_and_names_that_stand_twice_are_refused() {
    assert_refused(
        |file| file["conditions"][1]["id"] = json!(7),
        &["duplicate id 7 (positions 1 and 2 in the list)"],
    );
    let two_of_a_name = |file: &mut Value| {
        file["inputs"][1]["name"] = json!("LON");
        file["on_axis"] = json!([]);
    };
    assert_refused(two_of_a_name, &["inputs: duplicate name \"LON\""]);
    assert_refused(
        |file| file["conditions"][0]["identified_models"][1]["name"] = json!("sweeps"),
        &[
            "condition 7",
            "the identified bundle: duplicate name \"sweeps\" (models 1 and 2)",
        ],
    );
    assert_text_refused(
        "\"id\": 7",
        "\"id\": 7, \"id\": 8",
        &["condition", "duplicate key \"id\""],
    );
}

#[test]
fn on_axis_pairs_are_known_channels_once_and_output_first() {
    for (pairs, words) in [
        (
            json!([["P", "LAT"], ["P", "PED"]]),
            "on-axis pair 2: the dataset has no input \"PED\"",
        ),
        (
            json!([["LAT", "P"]]),
            "on-axis pair 1: the dataset has no output \"LAT\"; a pair is written [output, input]",
        ),
        (
            json!([["P", "LAT"], ["P", "LAT"]]),
            "on-axis pair 2: duplicate pair [\"P\", \"LAT\"]",
        ),
        (json!([["P", "LAT", "Q"]]), "on_axis, entry 1"),
        (
            json!([["P"]]),
            "on_axis, entry 1: expected a list of 2 entries, found 1 entries",
        ),
    ] {
        assert_refused(|file| file["on_axis"] = pairs, &[words]);
    }
}

#[test]
fn a_band_is_positive_rising_and_in_radians_per_second() {
    for (min, max) in [(12.0, 0.5), (0.0, 12.0), (-1.0, 12.0), (2.0, 2.0)] {
        let band = json!({"min": min, "max": max, "unit": "rad/s"});
        assert_refused(
            |file| file["frequency_band"] = band,
            &["frequency band", "0.0001 <= min < max <= 100000"],
        );
    }
    assert_refused(
        |file| file["frequency_band"]["unit"] = json!("Hz"),
        &["frequency_band, unit: expected \"rad/s\", found \"Hz\""],
    );
}

#[test]
fn a_model_has_matrices_or_a_frequency_response() {
    let response =
        |file: &Value| file["conditions"][0]["identified_models"][1]["frequency_response"].clone();
    let both = |file: &mut Value| {
        file["conditions"][0]["identified_models"][0]["frequency_response"] = response(file);
    };
    assert_refused(
        both,
        &[
            "identified model \"sweeps\" (number 1)",
            "both matrices and a measured response",
        ],
    );
    let neither =
        |file: &mut Value| file["conditions"][0]["identified_models"][1] = json!({"name": "empty"});
    assert_refused(
        neither,
        &[
            "identified model \"empty\" (number 2)",
            "neither matrices A, B, C, D nor",
        ],
    );
    let physics = |file: &mut Value| {
        file["conditions"][0]["physics_models"][0]["frequency_response"] = response(file)
    };
    assert_refused(
        physics,
        &[
            "physics model \"nominal\" (number 1)",
            "only an identified model",
        ],
    );
}

#[test]
fn frequency_data_have_the_shape_of_the_channels_and_rising_frequencies() {
    let place = "condition 7 (number 1 in the file), identified model \"measured\" (number 2), ";
    for (key, value, words) in [
        (
            "omega_rad_s",
            json!([0.4, 2.0]),
            "re: expected 2 x 2 x 2 (outputs x inputs x frequencies), found 2 x 2 x 3",
        ),
        (
            "omega_rad_s",
            json!([0.4, 0.4, 14.0]),
            "frequency 2: expected finite, positive and rising",
        ),
        (
            "omega_rad_s",
            json!([-0.4, 2.0, 14.0]),
            "frequency 1: expected finite",
        ),
        (
            "re",
            json!([[[1, 2, 3], [1, 2, 3]]]),
            "re: expected 2 x 2 x 3",
        ),
        (
            "im",
            json!([[[1, 2, 3], [1, 2]], [[1, 2, 3], [1, 2, 3]]]),
            "im, output 1, input 2: expected 3 entries",
        ),
        (
            "coherence",
            json!([[[1, 1, 1], [1, 1, 1]], [[1, 1, 1], [1, 1, 1.5]]]),
            "coherence, output 2, input 2, entry 3",
        ),
        ("coherence", json!([]), "coherence: expected 2 x 2 x 3"),
    ] {
        let change = |file: &mut Value| {
            file["conditions"][0]["identified_models"][1]["frequency_response"][key] = value
        };
        assert_refused(change, &[place, words]);
    }
}

#[test]
fn figures_of_the_flight_state_are_possible_ones() {
    assert_refused(
        |file| file["conditions"][0]["airspeed_kt"] = json!(-5),
        &[
            "condition 7 (number 1 in the file)",
            "airspeed [kt]: expected a finite number not below zero, found -5",
        ],
    );
}

#[test]
fn lists_too_long_to_work_with_are_refused() {
    let channels = |file: &mut Value| {
        file["inputs"] = (0..33)
            .map(|index| json!({"name": index.to_string(), "unit": ""}))
            .collect();
    };
    assert_refused(
        channels,
        &["inputs: expected at most 32 entries, found more"],
    );
}

#[test]
fn a_message_stays_on_one_line_whatever_the_names_in_the_file() {
    let nasty = format!("a\nb\u{1b}[2J{}", "long ".repeat(1000));
    let duplicate = |file: &mut Value| {
        for model in file["conditions"][0]["identified_models"]
            .as_array_mut()
            .unwrap()
        {
            model["name"] = json!(nasty);
        }
    };
    assert_refused(duplicate, &["duplicate name", "a\\nb"]);
    let wrong = |file: &mut Value| {
        file["conditions"][0]["physics_models"][0]["name"] = json!(nasty);
        file["conditions"][0]["physics_models"][0]["A"][0][0] = json!(nasty);
    };
    let message = refusal(&small(wrong));
    assert!(
        message.contains("matrix A, row 1, column 1") && message.chars().count() < 400,
        "{message}"
    );
    assert!(!message.contains('\u{1b}'), "{message}");
}

#[test]
fn a_sample_time_and_delays_that_cannot_be_are_named() {
    let model = "condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)";
    for (key, value, words) in [
        (
            "sample_time_s",
            json!(0),
            "sample_time_s: expected a positive number of seconds (omit it for continuous time)",
        ),
        ("sample_time_s", json!(-1), "found -1"),
        (
            "sample_time_s",
            json!("fast"),
            "sample_time_s: expected a number (without quotation marks)",
        ),
        (
            "input_delays_s",
            json!([0.1]),
            "input_delays_s: expected 2 delays, one for each channel, found 1",
        ),
        (
            "input_delays_s",
            json!([]),
            "input_delays_s: expected 2 delays",
        ),
        (
            "output_delays_s",
            json!([0, 60.1]),
            "output_delays_s, entry 2: expected a delay from 0 to 60 s, found 60.1",
        ),
        (
            "output_delays_s",
            json!([-0.01, 0]),
            "output_delays_s, entry 1: expected a delay",
        ),
        (
            "output_delays_s",
            json!(vec![0; 33]),
            "expected at most 32 entries",
        ),
    ] {
        assert_refused(
            |file| file["conditions"][0]["physics_models"][1][key] = value,
            &[model, words],
        );
    }
    assert_refused(
        |file| file["conditions"][0]["identified_models"][1]["input_delays_s"] = json!([0.1, 0]),
        &[
            "identified model \"measured\" (number 2)",
            "a measured response includes its delays",
        ],
    );
}

#[test]
fn a_valid_band_that_cannot_be_is_named() {
    let measured = "/conditions/0/identified_models/1/frequency_response";
    let bands = |band: Value| json!([[[0.5, 9], [0.5, 9]], [[0.5, 9], band]]);
    for (value, words) in [
        (
            bands(json!([9, 0.5])),
            "valid_band_rad_s, output 2, input 2: expected a first and a last frequency, not negative and in ascending order, found 9 and 0.5",
        ),
        (bands(json!([-1, 9])), "found -1 and 9"),
        (
            json!([[[0.5, 9]]]),
            "valid_band_rad_s: expected 2 x 2 x 2 (outputs x inputs x first and last frequency)",
        ),
    ] {
        assert_refused(
            |file| file.pointer_mut(measured).unwrap()["valid_band_rad_s"] = value,
            &[words],
        );
    }
}

#[test]
fn averages_and_windows_have_the_limits_that_the_options_have() {
    for (key, least, greatest) in [("averages", 1e-6, 1e6), ("window_s", 1e-6, 1e6)] {
        for value in [-1.0, 0.0, 0.9 * least, 1.1 * greatest, 1e300] {
            assert_refused(
                |file| {
                    file["conditions"][0]["identified_models"][1]["frequency_response"][key] =
                        json!(value)
                },
                &[
                    "condition 7",
                    "\"measured\"",
                    "measured response",
                    &format!("{key}: expected a number from 0.000001 to 1000000"),
                ],
            );
        }
        let within = small(|file| {
            file["conditions"][0]["identified_models"][1]["frequency_response"][key] =
                json!(greatest);
        });
        assert!(load(&within).is_ok());
    }
}

#[test]
fn the_schema_says_the_limits_of_averages_and_windows() {
    use gdcm_model::dataset::limits::{AVERAGES, WINDOW_S};
    let path = crate::program_folder().join("assets/gdcm-dataset.schema.json");
    let schema: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    for (key, range) in [("averages", AVERAGES), ("window_s", WINDOW_S)] {
        let said = &schema["$defs"]["response"]["properties"][key];
        assert_eq!(
            [&said["minimum"], &said["maximum"]].map(|limit| limit.as_f64().unwrap()),
            range,
            "{key}"
        );
    }
}
