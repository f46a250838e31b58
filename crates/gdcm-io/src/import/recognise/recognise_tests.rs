//! Tests of the recognition of models, with values as the format readers return them.

use std::path::Path;

use gdcm_model::assembly::ChannelLabel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::model::Origin;

use super::recognition_fault::{FoundFault, UnclearDelayUnit};
use super::*;
use crate::formats::reading_note::ReadingNote;
use crate::formats::variables::{
    Array, CellArray, ElementKind, Object, StructArray, TextArray, Value,
};
use crate::formats::{Contents, import_bytes};
use crate::import::model_files::{FoundModels, models_of_bytes};
use crate::variable_fault::unread::Unread;

/// Returns a matrix; `values` are column by column.
fn numbers(rows: usize, columns: usize, values: &[f64]) -> Value {
    Value::Array(Array::matrix(rows, columns, values.to_vec()))
}

fn variable(name: &str, value: Value) -> Variable {
    Variable {
        name: name.to_owned(),
        value,
    }
}

/// Returns a struct with a single element.
fn struct_of(fields: Vec<(&str, Value)>) -> StructArray {
    let fields = fields
        .into_iter()
        .map(|(name, value)| (name.to_owned(), vec![value]))
        .collect();
    StructArray {
        shape: vec![1, 1],
        fields,
    }
}

/// Returns the four matrices of a model with one state, one input and one output; B is `gain`, by
/// which tests recognise the model.
fn model_fields(gain: f64) -> Vec<(&'static str, Value)> {
    let scalar = |value: f64| numbers(1, 1, &[value]);
    vec![
        ("A", scalar(-1.0)),
        ("B", scalar(gain)),
        ("C", scalar(1.0)),
        ("D", scalar(0.0)),
    ]
}

fn recognise(variables: &[Variable]) -> Found<FoundModel> {
    super::recognise(variables, PageIndex::Last, &ReadingBudget::new(1 << 20)).unwrap()
}

/// Returns the variable and the gain, which is B, of each recognised model.
fn gains(found: &Found<FoundModel>) -> Vec<(String, f64)> {
    let mut gains = Vec::new();
    for model in &found.items {
        let b = model.draft.matrices[1].as_ref().unwrap();
        gains.push((model.variable().to_owned(), b[(0, 0)]));
    }
    gains
}

#[test]
fn models_are_found_in_structs_cells_struct_arrays_and_suffixed_matrices() {
    let struct_array = StructArray {
        shape: vec![1, 2],
        fields: [("A", -1.0), ("B", 3.0), ("C", 1.0), ("D", 0.0)]
            .map(|(name, value)| {
                (
                    name.to_owned(),
                    vec![numbers(1, 1, &[value]), numbers(1, 1, &[value])],
                )
            })
            .into(),
    };
    let in_cell = CellArray {
        shape: vec![1, 1],
        values: vec![Value::Struct(struct_of(model_fields(2.0)))],
    };
    let nested = struct_of(vec![
        ("sys", Value::Struct(struct_of(model_fields(1.0)))),
        ("all", Value::Cell(in_cell)),
    ]);
    let found = recognise(&[
        variable("c1", Value::Struct(nested)),
        variable("more", Value::Struct(struct_array)),
    ]);
    let expected = [
        ("c1.sys", 1.0),
        ("c1.all{1}", 2.0),
        ("more(1)", 3.0),
        ("more(2)", 3.0),
    ];
    assert_eq!(
        gains(&found),
        expected.map(|(name, gain)| (name.to_owned(), gain))
    );
    let loose: Vec<Variable> = model_fields(4.0)
        .into_iter()
        .map(|(name, value)| variable(name, value))
        .collect();
    assert_eq!(gains(&recognise(&loose)), [(String::new(), 4.0)]);
    let suffixed: Vec<Variable> = model_fields(5.0)
        .into_iter()
        .map(|(name, value)| variable(&format!("{name}_nom"), value))
        .collect();
    assert_eq!(gains(&recognise(&suffixed)), [("nom".to_owned(), 5.0)]);
}

#[test]
fn each_page_of_stacked_matrices_is_a_model_with_the_unstacked_matrices() {
    // C and D are single matrices.
    let b = Array {
        shape: vec![1, 1, 2],
        kind: ElementKind::Float,
        re: vec![7.0, 8.0],
        im: None,
    };
    let a = Array {
        shape: vec![1, 1, 2],
        kind: ElementKind::Float,
        re: vec![-1.0, -2.0],
        im: None,
    };
    let mut fields = model_fields(0.0);
    fields[0].1 = Value::Array(a);
    fields[1].1 = Value::Array(b);
    let found = recognise(&[variable("sys", Value::Struct(struct_of(fields)))]);
    assert_eq!(
        gains(&found),
        [
            ("sys(:,:,1)".to_owned(), 7.0),
            ("sys(:,:,2)".to_owned(), 8.0)
        ]
    );
}

/// Returns a text as MATLAB stores it.
fn text_value(text: &str) -> Value {
    Value::Text(TextArray {
        shape: vec![1, 1],
        texts: vec![text.to_owned()],
    })
}

#[test]
fn a_matlab_ss_object_is_read_with_its_inner_data_and_outer_names() {
    // The inner object has the matrices under lower-case names, and the sample time.
    let matrices = model_fields(6.0)
        .into_iter()
        .map(|(name, value)| (name.to_lowercase(), vec![value]));
    let sample_time = ("Ts".to_owned(), vec![numbers(1, 1, &[0.5])]);
    let data = Object {
        class: "ltipack.ssdata".to_owned(),
        records: StructArray {
            shape: vec![1, 1],
            fields: matrices.chain([sample_time]).collect(),
        },
    };
    let names = CellArray {
        shape: vec![1, 1],
        values: vec![text_value("LAT")],
    };
    let fields = vec![
        ("InputName_", Value::Cell(names)),
        ("Data_", Value::Object(data)),
    ];
    let found = recognise(&[variable(
        "s",
        Value::Object(Object {
            class: "ss".to_owned(),
            records: struct_of(fields),
        }),
    )]);
    assert_eq!(gains(&found), [("s".to_owned(), 6.0)]);
    assert_eq!(found.items[0].inputs[0].name.as_deref(), Some("LAT"));
    assert_eq!(found.items[0].draft.timing.sample_time_s, Some(0.5));
}

/// Changes the fields of a model, and returns the fault with which it is refused.
fn fault_after(change: fn(&mut Vec<(&'static str, Value)>)) -> RecognitionFault {
    let mut fields = model_fields(1.0);
    change(&mut fields);
    let found = recognise(&[variable("sys", Value::Struct(struct_of(fields)))]);
    let fault = only_fault(&found);
    assert_eq!(fault.variable, "sys");
    fault.fault.clone()
}

#[test]
fn a_faulty_model_is_reported_with_the_name_of_its_variable() {
    assert_eq!(
        fault_after(|fields| fields[1].1 = numbers(2, 1, &[1.0, 1.0])),
        RecognitionFault::MatrixShape {
            name: "B",
            expected: [1, 1],
            found: [2, 1],
        }
    );
    assert!(matches!(
        fault_after(|fields| fields[0].1 = numbers(1, 1, &[f64::NAN])),
        RecognitionFault::MatrixNotFinite { name, row: 1, column: 1, value }
            if name == "A" && value.is_nan()
    ));
    assert_eq!(
        fault_after(|fields| fields.push(("Ts", numbers(1, 1, &[-1.0])))),
        RecognitionFault::SampleTime { value: -1.0 }
    );
    let name = "InternalDelay".to_owned();
    assert_eq!(
        fault_after(|fields| fields.push(("InternalDelay", numbers(1, 1, &[0.1])))),
        RecognitionFault::InternalDelay { name }
    );
    let found = recognise(&[variable("x", Value::opaque("ss", Unread::ClassSystem))]);
    let fault = FoundFault {
        class: Some("ss".to_owned()),
        ..FoundFault::new("x", RecognitionFault::Unread(Box::new(Unread::ClassSystem)))
    };
    assert_eq!(found.faults, [fault]);
}

/// Returns the only fault, and asserts that no model was recognised.
fn only_fault(found: &Found<FoundModel>) -> &FoundFault {
    assert!(found.items.is_empty());
    let [fault] = found.faults.as_slice() else {
        panic!("{:?}", found.faults)
    };
    fault
}

/// Recognises the models in a JSON text.
fn recognise_json(text: &str) -> Found<FoundModel> {
    let budget = ReadingBudget::new(1 << 24);
    let imported = import_bytes(text.as_bytes(), Path::new("m.json"), "m.json", &budget).unwrap();
    match imported.contents {
        Contents::Variables {
            variables,
            page_index,
            ..
        } => super::recognise(&variables, page_index, &budget).unwrap(),
        Contents::Models(items, unused) => Found {
            items,
            unused: unused.iter().map(ToString::to_string).collect(),
            ..Found::default()
        },
        _ => panic!("neither variables nor models: {text}"),
    }
}

/// Name of a file in a folder with the number of its condition.
const FILE: &str = "c1_90kt/m.json";

/// Reads the models in the file [`FILE`].
fn read_json(text: &str) -> FoundModels {
    models_of_bytes(text.as_bytes(), FILE, &ReadingBudget::new(1 << 24)).unwrap()
}

/// Recognises a model with two inputs and two outputs to which `members` are added.
fn model_with(members: &str) -> Found<FoundModel> {
    recognise_json(&format!(
        r#"{{"A": [[-1, 0], [0, -2]], "B": [[1, 0], [0, 2]], "C": [[1, 0], [0, 1]], "D": [[0, 0], [0, 0]], {members}}}"#
    ))
}

/// Returns the delays \[s\] of the inputs and of the outputs of the first model.
fn delays(found: &Found<FoundModel>) -> [Option<Vec<f64>>; 2] {
    assert_eq!(found.faults, []);
    let timing = &found.items[0].draft.timing;
    [
        timing.input_delays_s.clone(),
        timing.output_delays_s.clone(),
    ]
}

/// Returns whether two delays \[s\] are as expected, except for rounding.
fn are_near(found: &[f64], expected: [f64; 2]) -> bool {
    found
        .iter()
        .zip(expected)
        .all(|(found, expected)| (found - expected).abs() < 1e-15)
}

#[test]
fn delays_are_read_under_every_name_with_clear_channels_and_unit() {
    for member in [
        r#""InputDelay": [0.03, 0.05]"#,
        r#""InputDelays": [0.03, 0.05]"#,
        r#""InputDelay(s)": [0.03, 0.05]"#,
        r#""input_delay": [0.03, 0.05]"#,
        r#""input_delays": [0.03, 0.05]"#,
        r#""input_delay_s": [0.03, 0.05]"#,
        r#""input_delays_s": [0.03, 0.05]"#,
        r#""input_delay_ms": [30, 50]"#,
        r#""input_delays_ms": [30, 50]"#,
        r#""ioDelay": [[0.03, 0.05], [0.03, 0.05]]"#,
    ] {
        let [inputs, outputs] = delays(&model_with(member));
        let inputs = inputs.unwrap_or_else(|| panic!("{member}"));
        assert!(are_near(&inputs, [0.03, 0.05]), "{member}: {inputs:?}");
        assert!(
            outputs.is_none_or(|outputs| outputs == [0.0, 0.0]),
            "{member}: outputs are delayed"
        );
    }
    // Delays of single responses are split into those of inputs and outputs.
    let [inputs, outputs] = delays(&model_with(
        r#""TransportDelay": [[0.03, 0.05], [0.04, 0.06]], "InputDelay": 0.01"#,
    ));
    let inputs = inputs.unwrap();
    assert!(
        are_near(&inputs, [0.04, 0.06]),
        "{inputs:?}: 0.03 and 0.05 s, and the delay of 0.01 s of both inputs"
    );
    let outputs = outputs.unwrap();
    assert!(are_near(&outputs, [0.0, 0.01]), "{outputs:?}");
    let notes = model_with(r#""input_delays": [0.03, 0.05]"#)
        .items
        .remove(0)
        .notes;
    let name = "input_delays".to_owned();
    let note = ReadingNote::DelayInSeconds { name }.to_string();
    assert!(notes.contains(&note), "{notes:?}");
    assert_eq!(
        delays(&model_with(r#""tau": [0, 0], "delays": []"#)),
        [None, None],
        "delays of zero are accepted under any name"
    );
}

#[test]
fn an_ambiguous_or_contradictory_delay_is_refused_with_the_reason() {
    let named = |name: &str| name.to_owned();
    let unclear = |name: &str| RecognitionFault::UnclearDelay { name: named(name) };
    let unit = |name: &str, unit| RecognitionFault::DelayUnit {
        name: named(name),
        unit,
    };
    for (member, fault) in [
        (r#""tau": 0.03"#, unclear("tau")),
        (r#""tau_i": [0.03, 0.05]"#, unclear("tau_i")),
        (r#""tau_ms": 30"#, unclear("tau_ms")),
        (r#""Td": 0.03"#, unclear("Td")),
        (r#""delay_in": [0.03, 0.05]"#, unclear("delay_in")),
        (r#""delays": {"LON": 0.03}"#, unclear("delays")),
        (r#""time_delay": 0.03"#, unclear("time_delay")),
        (
            r#""input_delay": [30, 50]"#,
            unit(
                "input_delay",
                UnclearDelayUnit::SecondsOrMilliseconds { greatest: 50.0 },
            ),
        ),
        (
            r#""input_delay": [0.02, 0.04], "Ts": 0.02"#,
            unit("input_delay", UnclearDelayUnit::SecondsOrSamples),
        ),
        (
            r#""InputDelay": [0.02, 0.05], "Ts": 0.02"#,
            unit("InputDelay", UnclearDelayUnit::PartsOfSamples),
        ),
        (
            r#""ioDelay": [[0.03, 0.05], [0.03, 0.06]]"#,
            RecognitionFault::NotASumOfDelays {
                name: named("ioDelay"),
                output: 2,
                input: 2,
            },
        ),
        (
            r#""TransportDelay": [0.03, 0.05, 0.07]"#,
            RecognitionFault::ResponseDelayShape {
                name: named("TransportDelay"),
                outputs: 2,
                inputs: 2,
                found: named("a 1 x 3 array of numbers"),
            },
        ),
        (
            r#""input_delays_s": [0.03, 0.05, 0.07]"#,
            RecognitionFault::DelayCount {
                name: named("input_delays_s"),
                side: ChannelSide::Input,
                expected: 2,
                found: 3,
            },
        ),
        (
            r#""InputDelay": [0.03, 0.05], "input_delays_ms": [30, 40]"#,
            RecognitionFault::ContradictoryDelays {
                name: named("input_delays_ms"),
            },
        ),
        (
            r#""TimeUnit": "milliseconds""#,
            RecognitionFault::TimeUnit {
                unit: named("milliseconds"),
            },
        ),
    ] {
        let found = model_with(member);
        assert_eq!(only_fault(&found).fault, fault, "{member}");
    }
    let outside = recognise_json(
        r#"{"sys": {"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}, "input_delays_s": 0.03}"#,
    );
    assert!(matches!(
        only_fault(&outside).fault,
        RecognitionFault::DelayWithoutModel { .. }
    ));
    let model = r#""A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]"#;
    let own = recognise_json(&format!(
        r#"{{"format": "gdcm-models", "version": 1, "models": [{{"name": "m", {model}, "input_delay_ms": [30]}}]}}"#
    ));
    assert_eq!(
        delays(&own),
        [Some(vec![0.03]), None],
        "a hand-written file in the format of this program"
    );
}

#[test]
fn models_in_suffixed_matrices_have_their_own_delays() {
    let mut variables = Vec::new();
    for (suffix, delay) in [("_nom", 0.03), ("_pert", 0.05)] {
        for (name, value) in model_fields(1.0) {
            variables.push(variable(&format!("{name}{suffix}"), value));
        }
        variables.push(variable(
            &format!("InputDelay{suffix}"),
            numbers(1, 1, &[delay]),
        ));
    }
    let found = recognise(&variables);
    assert_eq!(found.faults, []);
    let delays: Vec<Option<Vec<f64>>> = found
        .items
        .iter()
        .map(|model| model.draft.timing.input_delays_s.clone())
        .collect();
    assert_eq!(delays, [Some(vec![0.03]), Some(vec![0.05])]);
    assert_eq!(found.unused, Vec::<String>::new());
}

#[test]
fn unused_variables_are_listed_once_for_a_file() {
    let found = read_json(
        r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "Q": [[1]], "author": "me",
            "trim": {"airspeed_kt": 90, "theta_deg": 3}, "airspeed_kt": 90}"#,
    );
    let unused = &found.unused[FILE];
    assert_eq!(*unused, ["Q", "author", "trim.theta_deg"]);
    assert_eq!(
        found.models[0].draft.source.as_ref().unwrap().unused,
        *unused
    );
    let model = r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "torque": 7}"#;
    let several = read_json(&format!(
        r#"{{"models": [{model}, {model}], "more": [1, 2]}}"#
    ));
    assert_eq!(several.unused[FILE], ["more", "models{:}.torque"]);
    let listed: Vec<usize> = several
        .models
        .iter()
        .map(|model| model.draft.source.as_ref().unwrap().unused.len())
        .collect();
    assert_eq!(listed, [2, 0], "only the first model of a file lists them");
}

#[test]
fn channel_labels_with_units_are_read_and_a_wrong_number_of_labels_is_refused() {
    let label = |name: &str, unit: &str| ChannelLabel {
        name: Some(name.into()),
        unit: Some(unit.into()),
    };
    let members = r#""inputs": [{"name": "delta_ped", "unit": "in"}, {"name": "delta_lat", "unit": "in"}],
        "outputs": [{"name": "R", "unit": "rad/s"}, {"name": "P", "unit": "rad/s"}]"#;
    let found = model_with(members);
    assert_eq!(
        found.items[0].inputs,
        [label("delta_ped", "in"), label("delta_lat", "in")],
        "{:?}",
        found.faults
    );
    assert_eq!(
        found.items[0].outputs,
        [label("R", "rad/s"), label("P", "rad/s")]
    );
    let own = recognise_json(&format!(
        r#"{{"format": "gdcm-models", "version": 1, "models": [{{"name": "m", "A": [[-1]], "B": [[1, 2]], "C": [[1], [2]],
            "D": [[0, 0], [0, 0]], {members}}}]}}"#
    ));
    assert_eq!(
        own.items[0].inputs,
        [label("delta_ped", "in"), label("delta_lat", "in")],
        "{:?}",
        own.faults
    );
    let around = recognise_json(&format!(
        r#"{{"sys": {{"A": [[-1]], "B": [[1, 2]], "C": [[1], [2]], "D": [[0, 0], [0, 0]]}}, {members}}}"#
    ));
    assert_eq!(
        around.items[0].inputs,
        [label("delta_ped", "in"), label("delta_lat", "in")],
        "{:?}",
        around.faults
    );
    let count = RecognitionFault::LabelCount {
        name: "inputs".to_owned(),
        side: ChannelSide::Input,
        found: 1,
        expected: 2,
    };
    assert_eq!(only_fault(&model_with(r#""inputs": ["LON"]"#)).fault, count);
    let name = "inputs".to_owned();
    assert_eq!(
        only_fault(&model_with(r#""inputs": {"LON": "in", "LAT": "in"}"#)).fault,
        RecognitionFault::LabelOrder { name }
    );
    assert!(matches!(
        &only_fault(&model_with(r#""inputs": ["LON", 3]"#)).fault,
        RecognitionFault::Labels { name, .. } if name == "inputs"
    ));
}

#[test]
fn condition_data_beside_a_model_are_used_and_contradictions_are_refused() {
    let found = model_with(
        r#""airspeed_kt": 70, "name": "bank", "perturbation": {"roll_deg": 5}, "mass_kg": 6600"#,
    );
    let model = &found.items[0];
    assert_eq!(
        (model.facts.airspeed_kt, model.facts.mass_kg),
        (Some(70.0), Some(6600.0))
    );
    assert_eq!(model.facts.name.as_deref(), Some("bank"));
    let perturbation = [("roll_deg".to_owned(), 5.0)].into();
    assert_eq!(
        model.draft.origin,
        Origin::Perturbed {
            perturbation: Some(perturbation)
        }
    );
    let model = r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}"#;
    let around = recognise_json(&format!(
        r#"{{"airspeed_kt": 70, "role": "nominal", "sys": {model}}}"#
    ));
    assert_eq!(around.items[0].facts.airspeed_kt, Some(70.0));
    assert_eq!(
        around.items[0].draft.origin,
        Origin::Nominal { perturbation: None }
    );
    let differing = recognise_json(
        r#"{"airspeed_kt": 70, "sys": {"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "airspeed_kt": 90}}"#,
    );
    assert!(matches!(
        differing.faults[0].fault,
        RecognitionFault::Contradiction {
            values: [90.0, 70.0],
            ..
        }
    ));
}

#[test]
fn a_list_of_airspeeds_gives_each_model_of_a_stack_its_airspeed() {
    let stack_text = r#"{"A": [[[-1]], [[-2]], [[-3]]], "B": [[1]], "C": [[1]], "D": [[0]], "airspeed_kt": [60, 80, 100]}"#;
    let stack = recognise_json(stack_text);
    let airspeeds = |found: &Found<FoundModel>| -> Vec<Option<f64>> {
        found
            .items
            .iter()
            .map(|model| model.facts.airspeed_kt)
            .collect()
    };
    assert_eq!(
        airspeeds(&stack),
        [Some(60.0), Some(80.0), Some(100.0)],
        "{:?}",
        stack.faults
    );
    let assembly = gdcm_model::assembly::Assembly::new(
        read_json(stack_text).models,
        gdcm_model::assembly::Rules::default(),
    );
    let conditions: Vec<Option<i64>> = assembly
        .parts()
        .iter()
        .map(|part| part.row.condition)
        .collect();
    assert_eq!(
        conditions,
        [Some(1); 3],
        "the folder states the condition number"
    );
    let short = recognise_json(
        r#"{"A": [[[-1]], [[-2]], [[-3]]], "B": [[1]], "C": [[1]], "airspeed_kt": [60, 80]}"#,
    );
    assert!(short.items.is_empty());
    let fault = RecognitionFault::NumberForEachModel {
        name: "airspeed_kt".to_owned(),
        found: 2,
        models: 3,
    };
    assert!(
        short.faults.iter().all(|found| found.fault == fault),
        "{:?}",
        short.faults
    );
}

/// Returns the faults in a response at three frequencies to which `members` are added; without a
/// fault, the response is recognised.
fn response_faults(members: &str) -> Vec<RecognitionFault> {
    let found = recognise_json(&format!(
        r#"{{"re": [1, 2, 3], "im": [0, 1, 2], {members}}}"#
    ));
    let mut faults = Vec::new();
    for fault in found.faults {
        faults.push(fault.fault);
    }
    assert_eq!(found.items.len() + faults.len(), 1, "{members}: {faults:?}");
    faults
}

#[test]
fn unclear_coherence_frequency_unit_or_delay_of_a_response_is_refused() {
    let name = |name: &str| name.to_owned();
    assert_eq!(
        response_faults(r#""w": [1, 2, 3], "COHER": [1, 0.9, 0.8]"#),
        []
    );
    assert_eq!(
        response_faults(r#""w": [1, 2, 3], "gamma": [1, 0.9, 0.8]"#),
        [RecognitionFault::Gamma {
            name: name("gamma")
        }]
    );
    assert_eq!(
        response_faults(r#""w": [1, 2, 3], "coherence": [1, 0.9]"#),
        [RecognitionFault::CoherenceCount {
            found: 2,
            expected: 3
        }]
    );
    assert_eq!(
        response_faults(r#""f": [1, 2, 3]"#),
        [RecognitionFault::NoFrequencyUnit]
    );
    assert_eq!(
        response_faults(r#""f": [1, 2, 3], "frequency_unit": "rps""#),
        [RecognitionFault::FrequencyUnit { unit: name("rps") }]
    );
    assert_eq!(
        response_faults(r#""f": [1, 2, 3], "frequency_unit": "Hz""#),
        []
    );
    let in_time_unit = r#""f": [1, 2, 3], "frequency_unit": "rad/TimeUnit""#;
    assert_eq!(response_faults(in_time_unit), []);
    assert_eq!(
        response_faults(&format!(r#"{in_time_unit}, "TimeUnit": "minutes""#)),
        [RecognitionFault::TimeUnit {
            unit: name("minutes")
        }]
    );
    assert_eq!(
        response_faults(r#""w": [1, 2, 3], "InputDelay": 0.03"#),
        [RecognitionFault::DelayOfResponse {
            name: name("InputDelay")
        }]
    );
}

#[test]
fn response_values_are_reordered_from_output_first_to_frequency_first() {
    // Two outputs, one input and three frequencies; in the file, the output index runs fastest.
    let response = Array {
        shape: vec![2, 1, 3],
        kind: ElementKind::Float,
        re: vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0],
        im: Some(vec![0.0; 6]),
    };
    let fields = vec![
        ("ResponseData", Value::Array(response)),
        ("Frequency", numbers(1, 3, &[1.0, 2.0, 3.0])),
        ("FrequencyUnit", text_value("Hz")),
    ];
    let found = recognise(&[variable("h", Value::Struct(struct_of(fields)))]);
    let response = found.items[0].draft.response.as_ref().unwrap();
    assert_eq!(response.re.values, [1.0, 2.0, 3.0, 10.0, 20.0, 30.0]);
    assert_eq!(response.omega[0], std::f64::consts::TAU);
}

#[test]
fn a_variable_d_beside_upper_case_matrices_is_not_the_feed_through_matrix() {
    let matrices = ["A", "B", "C"].map(|name| variable(name, numbers(1, 1, &[-1.0])));
    let mut variables = matrices.to_vec();
    variables.push(variable("d", numbers(1, 3, &[1.0, 2.0, 3.0])));
    let found = recognise(&variables);
    assert_eq!(found.faults, []);
    assert_eq!(found.items.len(), 1);
}
