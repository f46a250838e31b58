//! Dataset files rejected because of their content.

use super::*;

#[test]
fn a_missing_key_or_matrix_is_named_with_its_place() {
    let remove = |file: &mut Value, pointer: &str, key: &str| {
        file.pointer_mut(pointer)
            .unwrap()
            .as_object_mut()
            .unwrap()
            .remove(key)
            .unwrap();
    };
    let key_places = [
        ("", "inputs", ""),
        ("/inputs/1", "unit", "inputs, entry 2"),
        ("/frequency_band", "unit", "frequency_band"),
        (
            "/conditions/1",
            "airspeed_kt",
            "condition 10 (number 2 in the file)",
        ),
        ("/conditions/1", "id", "condition at position 2 in the file"),
        (
            "/conditions/0/physics_models/1",
            "role",
            "physics model \"V+5kt\" (number 2)",
        ),
        (
            "/conditions/0/identified_models/1/frequency_response",
            "im",
            "\"measured\" (number 2), frequency_response",
        ),
    ];
    for (pointer, key, place) in key_places {
        let quoted = format!("\"{key}\"");
        assert_refused(
            |file| remove(file, pointer, key),
            "missing-key",
            place,
            &[&quoted],
        );
    }
    let matrix_places = [
        (
            "/conditions/0/physics_models/1",
            "B",
            "physics model \"V+5kt\" (number 2)",
        ),
        (
            "/conditions/0/identified_models/0",
            "C",
            "identified model \"sweeps\" (number 1)",
        ),
    ];
    for (pointer, matrix, place) in matrix_places {
        let named = format!("matrix {matrix}");
        assert_refused(
            |file| remove(file, pointer, matrix),
            "missing-matrix",
            place,
            &[&named],
        );
    }
}

#[test]
fn text_where_a_number_belongs_is_named_by_matrix_row_and_column() {
    assert_refused(
        |file| file["conditions"][1]["physics_models"][0]["B"][1][0] = json!("0.2"),
        "wrong-type",
        "condition 10 (number 2 in the file), physics model \"nominal\" (number 1), \
         matrix B, row 2, column 1",
        &["\"0.2\""],
    );
    assert_refused(
        |file| file["conditions"][0]["airspeed_kt"] = json!(null),
        "wrong-type",
        "airspeed_kt",
        &["found null"],
    );
    assert_refused(
        |file| file["conditions"][0]["id"] = json!(1.5),
        "wrong-type",
        "id",
        &["found 1.5"],
    );
    assert_refused(
        |file| file["name"] = json!(5),
        "wrong-type",
        "name",
        &["found 5"],
    );
    assert_refused(
        |file| file["inputs"] = json!({"name": "LON"}),
        "wrong-type",
        "inputs",
        &[],
    );
}

#[test]
fn a_non_finite_number_is_quoted_as_written_with_its_place() {
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
            "number-not-finite",
            "physics model \"nominal\" (number 1), matrix A, row 1, column 2",
            &[written],
        );
    }
    assert_text_refused(
        "\"mass_kg\": 6600",
        "\"mass_kg\": 1e400",
        "number-not-finite",
        "mass_kg",
        &["found 1e400"],
    );
}

#[test]
fn ragged_and_wrongly_shaped_matrices_are_refused() {
    let model = "condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)";
    for (matrix, value, code, values) in [
        (
            "A",
            json!([[1, 2], [3]]),
            "list-length",
            ["matrix A, row 2", "expected 2", "found 1"],
        ),
        (
            "A",
            json!([[1, 2]]),
            "matrix-shape",
            ["matrix A", "expected 1 x 1", "found 1 x 2"],
        ),
        (
            "A",
            json!([]),
            "matrix-shape",
            ["matrix B", "expected 0 x 2", "found 2 x 2"],
        ),
        (
            "B",
            json!([[1, 2]]),
            "matrix-shape",
            ["matrix B", "expected 2 x 2", "found 1 x 2"],
        ),
        (
            "C",
            json!([[1, 2], [3, 4], [5, 6]]),
            "matrix-shape",
            ["matrix C", "expected 2 x 2", "found 3 x 2"],
        ),
        (
            "D",
            json!([[0, 0, 0], [0, 0, 0]]),
            "table-shape",
            ["matrix D", "expected 2 x 2", "found 2 x 3"],
        ),
        (
            "D",
            json!([]),
            "table-shape",
            ["matrix D", "expected 2 x 2", "found 0 x 0"],
        ),
        (
            "D",
            json!([1, 2]),
            "wrong-type",
            ["matrix D, row 1", "", "found 1"],
        ),
        ("D", json!(5), "wrong-type", ["matrix D", "", "found 5"]),
    ] {
        assert_refused(
            |file| file["conditions"][0]["physics_models"][1][matrix] = value,
            code,
            model,
            &values,
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
        "no-nominal",
        "condition 7",
        &["found 0"],
    );
    assert_refused(
        |file| role(file, 1, "nominal"),
        "no-nominal",
        "condition 7",
        &["found 2 (nominal, V+5kt)"],
    );
    assert_refused(
        |file| role(file, 1, "trim"),
        "unknown-word",
        "\"V+5kt\" (number 2), role",
        &["\"nominal\"", "\"perturbed\"", "\"trim\""],
    );
}

#[test]
fn empty_lists_are_refused() {
    assert_refused(
        |file| file["conditions"][1]["physics_models"] = json!([]),
        "empty-bundle",
        "condition 10 (number 2 in the file)",
        &["physics"],
    );
    assert_refused(
        |file| file["conditions"] = json!([]),
        "empty-dataset",
        "",
        &["conditions"],
    );
}

#[test]
fn a_condition_without_identified_models_is_accepted() {
    let mut file: Value = serde_json::from_str(SMALL).unwrap();
    file["conditions"][0]["identified_models"] = json!([]);
    file["conditions"][1]
        .as_object_mut()
        .unwrap()
        .remove("identified_models");
    let origin = DatasetOrigin::File("small.json".into());
    let loaded = load_dataset_bytes(file.to_string().as_bytes(), origin).unwrap();
    assert_eq!(
        loaded.dataset.without_reference(),
        loaded.dataset.ids().collect::<Vec<_>>()
    );
    assert!(loaded.cautions.is_empty(), "{:?}", loaded.cautions);
}

#[test]
fn duplicate_ids_names_and_keys_are_refused() {
    assert_refused(
        |file| file["conditions"][1]["id"] = json!(7),
        "duplicate-condition",
        "",
        &["7", "positions 1 and 2"],
    );
    let duplicate_input = |file: &mut Value| {
        file["inputs"][1]["name"] = json!("LON");
        file["on_axis"] = json!([]);
    };
    assert_refused(
        duplicate_input,
        "duplicate-channel",
        "",
        &["inputs", "\"LON\""],
    );
    assert_refused(
        |file| file["conditions"][0]["identified_models"][1]["name"] = json!("sweeps"),
        "duplicate-name",
        "condition 7",
        &["identified", "\"sweeps\"", "models 1 and 2"],
    );
    assert_text_refused(
        "\"id\": 7",
        "\"id\": 7, \"id\": 8",
        "duplicate-key",
        "condition",
        &["\"id\""],
    );
}

#[test]
fn on_axis_pairs_must_be_distinct_known_and_output_first() {
    for (pairs, code, place, value) in [
        (
            json!([["P", "LAT"], ["P", "PED"]]),
            "unknown-channel",
            "on-axis pair 2",
            "input \"PED\"",
        ),
        (
            json!([["LAT", "P"]]),
            "unknown-channel",
            "on-axis pair 1",
            "output \"LAT\"",
        ),
        (
            json!([["P", "LAT"], ["P", "LAT"]]),
            "duplicate-pair",
            "on-axis pair 2",
            "[\"P\", \"LAT\"]",
        ),
        (
            json!([["P", "LAT", "Q"]]),
            "wrong-type",
            "on_axis, entry 1",
            "",
        ),
        (
            json!([["P"]]),
            "wrong-type",
            "on_axis, entry 1",
            "found 1 entries",
        ),
    ] {
        assert_refused(|file| file["on_axis"] = pairs, code, place, &[value]);
    }
}

#[test]
fn a_band_must_be_positive_rising_and_in_radians_per_second() {
    for (min, max) in [(12.0, 0.5), (0.0, 12.0), (-1.0, 12.0), (2.0, 2.0)] {
        let band = json!({"min": min, "max": max, "unit": "rad/s"});
        assert_refused(
            |file| file["frequency_band"] = band,
            "wrong-band",
            "",
            &["0.0001 <= min < max <= 100000"],
        );
    }
    assert_refused(
        |file| file["frequency_band"]["unit"] = json!("Hz"),
        "unknown-word",
        "frequency_band, unit",
        &["\"rad/s\"", "\"Hz\""],
    );
}

#[test]
fn a_model_must_have_either_matrices_or_a_frequency_response() {
    let response =
        |file: &Value| file["conditions"][0]["identified_models"][1]["frequency_response"].clone();
    let both = |file: &mut Value| {
        file["conditions"][0]["identified_models"][0]["frequency_response"] = response(file);
    };
    assert_refused(
        both,
        "matrices-and-response",
        "identified model \"sweeps\" (number 1)",
        &[],
    );
    let neither =
        |file: &mut Value| file["conditions"][0]["identified_models"][1] = json!({"name": "empty"});
    assert_refused(
        neither,
        "neither-matrices-nor-response",
        "identified model \"empty\" (number 2)",
        &[],
    );
    let physics = |file: &mut Value| {
        file["conditions"][0]["physics_models"][0]["frequency_response"] = response(file)
    };
    assert_refused(
        physics,
        "measured-physics",
        "physics model \"nominal\" (number 1)",
        &[],
    );
}

#[test]
fn frequency_data_must_have_the_shape_of_the_channels_and_rising_frequencies() {
    let place = "condition 7 (number 1 in the file), identified model \"measured\" (number 2)";
    for (key, value, code, values) in [
        (
            "omega_rad_s",
            json!([0.4, 2.0]),
            "table-shape",
            ["re", "expected 2 x 2 x 2", "found 2 x 2 x 3"],
        ),
        (
            "omega_rad_s",
            json!([0.4, 0.4, 14.0]),
            "response-frequency",
            ["frequency 2", "", ""],
        ),
        (
            "omega_rad_s",
            json!([-0.4, 2.0, 14.0]),
            "response-frequency",
            ["frequency 1", "", ""],
        ),
        (
            "re",
            json!([[[1, 2, 3], [1, 2, 3]]]),
            "table-shape",
            ["re", "expected 2 x 2 x 3", ""],
        ),
        (
            "im",
            json!([[[1, 2, 3], [1, 2]], [[1, 2, 3], [1, 2, 3]]]),
            "list-length",
            ["im, output 1, input 2", "expected 3", ""],
        ),
        (
            "coherence",
            json!([[[1, 1, 1], [1, 1, 1]], [[1, 1, 1], [1, 1, 1.5]]]),
            "response-value",
            ["coherence, output 2, input 2, entry 3", "", ""],
        ),
        (
            "coherence",
            json!([]),
            "table-shape",
            ["coherence", "expected 2 x 2 x 3", ""],
        ),
    ] {
        let change = |file: &mut Value| {
            file["conditions"][0]["identified_models"][1]["frequency_response"][key] = value
        };
        assert_refused(change, code, place, &values);
    }
}

#[test]
fn a_negative_airspeed_is_refused() {
    assert_refused(
        |file| file["conditions"][0]["airspeed_kt"] = json!(-5),
        "flight-state",
        "condition 7 (number 1 in the file)",
        &["airspeed [kt]", "found -5"],
    );
}

#[test]
fn more_than_32_inputs_are_refused() {
    let channels = |file: &mut Value| {
        file["inputs"] = (0..33)
            .map(|index| json!({"name": index.to_string(), "unit": ""}))
            .collect();
    };
    assert_refused(channels, "too-many-entries", "inputs", &["32"]);
}

#[test]
fn a_message_stays_short_and_on_one_line_despite_the_names_in_the_file() {
    let long_name = format!("a\nb\u{1b}[2J{}", "long ".repeat(1000));
    let duplicate = |file: &mut Value| {
        for model in file["conditions"][0]["identified_models"]
            .as_array_mut()
            .unwrap()
        {
            model["name"] = json!(long_name);
        }
    };
    assert_refused(duplicate, "duplicate-name", "", &["a\\nb"]);
    let wrong = |file: &mut Value| {
        file["conditions"][0]["physics_models"][0]["name"] = json!(long_name);
        file["conditions"][0]["physics_models"][0]["A"][0][0] = json!(long_name);
    };
    let error = refusal(&small(wrong));
    assert_error(&error, "wrong-type", "matrix A, row 1, column 1", &[]);
    let message = error.to_string();
    assert!(message.chars().count() < 400, "{message}");
    assert!(!message.contains('\u{1b}'), "{message}");
}

#[test]
fn impossible_sample_times_and_delays_are_refused() {
    let model = "condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)";
    for (key, value, code, found) in [
        ("sample_time_s", json!(0), "sample-time", "found 0"),
        ("sample_time_s", json!(-1), "sample-time", "found -1"),
        ("sample_time_s", json!("fast"), "wrong-type", "\"fast\""),
        ("input_delays_s", json!([0.1]), "delay-count", "found 1"),
        ("input_delays_s", json!([]), "delay-count", "found 0"),
        (
            "output_delays_s",
            json!([0, 60.1]),
            "delay-value",
            "found 60.1",
        ),
        (
            "output_delays_s",
            json!([-0.01, 0]),
            "delay-value",
            "entry 1",
        ),
        (
            "output_delays_s",
            json!(vec![0; 33]),
            "too-many-entries",
            "32",
        ),
    ] {
        assert_refused(
            |file| file["conditions"][0]["physics_models"][1][key] = value,
            code,
            model,
            &[key, found],
        );
    }
    assert_refused(
        |file| file["conditions"][0]["identified_models"][1]["input_delays_s"] = json!([0.1, 0]),
        "timed-response",
        "identified model \"measured\" (number 2)",
        &[],
    );
}

#[test]
fn impossible_valid_bands_are_refused() {
    let measured = "/conditions/0/identified_models/1/frequency_response";
    let bands = |band: Value| json!([[[0.5, 9], [0.5, 9]], [[0.5, 9], band]]);
    for (value, code, values) in [
        (
            bands(json!([9, 0.5])),
            "valid-band",
            ["output 2, input 2", "found 9 and 0.5"],
        ),
        (
            bands(json!([-1, 9])),
            "valid-band",
            ["output 2, input 2", "found -1 and 9"],
        ),
        (
            json!([[[0.5, 9]]]),
            "table-shape",
            ["valid_band_rad_s", "expected 2 x 2 x 2"],
        ),
    ] {
        assert_refused(
            |file| file.pointer_mut(measured).unwrap()["valid_band_rad_s"] = value,
            code,
            "identified model \"measured\" (number 2)",
            &values,
        );
    }
}

#[test]
fn averages_and_windows_outside_their_limits_are_refused() {
    for (key, least, greatest) in [("averages", 1e-6, 1e6), ("window_s", 1e-6, 1e6)] {
        for value in [-1.0, 0.0, 0.9 * least, 1.1 * greatest, 1e300] {
            assert_refused(
                |file| {
                    file["conditions"][0]["identified_models"][1]["frequency_response"][key] =
                        json!(value)
                },
                "response-estimate",
                "identified model \"measured\" (number 2)",
                &[key, "from 0.000001 to 1000000"],
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
fn the_schema_has_the_limits_of_averages_and_windows() {
    use gdcm_model::dataset::limits::{AVERAGES, WINDOW_S};
    let path = crate::program_folder().join("assets/gdcm-dataset.schema.json");
    let schema: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    for (key, range) in [("averages", AVERAGES), ("window_s", WINDOW_S)] {
        let property = &schema["$defs"]["response"]["properties"][key];
        assert_eq!(
            [&property["minimum"], &property["maximum"]].map(|limit| limit.as_f64().unwrap()),
            range,
            "{key}"
        );
    }
}
