//! The commands as functions (`gdcm::cli::calls`), of which the Python module is made.

use std::ffi::OsString;
use std::thread::scope;

use serde_json::Value;

use gdcm::cli::calls::{ModelChoice, OpenedData, analyze};
use gdcm_model::progress::Unobserved;

use crate::commands::Desk;
use crate::{FEW_TEXT, entries};

fn few() -> OpenedData {
    OpenedData::from_json(&FEW_TEXT, "few.json").unwrap().value
}

fn words(line: &str) -> Vec<OsString> {
    line.split_whitespace().map(OsString::from).collect()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("it is JSON")
}

#[test]
fn an_analysis_by_call_has_the_results_of_the_command() {
    let desk = Desk::with_few();
    let line = ["--phase", "lead", "--reject-suggested", "--points", "40"];
    let ended = desk.run(&["analyze", "few.json", "--out", "results"], &line);
    assert_eq!(ended.status, 0, "{ended:?}");
    let options = line.map(OsString::from).to_vec();
    let called = analyze(&few(), options, &Unobserved).unwrap();
    let expected = json(&desk.read("results/corrections.json"));
    assert_eq!(json(&called.value.corrections_json()), expected);
    let summary = called.value.summary().unwrap();
    assert!(!entries(&summary.messages["cautions"]).is_empty());
    let [channels, responses] = called.value.tables().unwrap();
    assert_eq!(channels, desk.read("results/corrections.csv").as_bytes());
    assert_eq!(responses, desk.read("results/assessment.csv").as_bytes());
}

#[test]
fn a_wrong_option_is_an_error_with_its_code_and_fields() {
    for (line, code, option) in [
        ("--quantile 2", "wrong-option", "--quantile"),
        ("--reject 3:nobody", "unknown-model", "--reject"),
        ("--on Q/STICK", "unknown-response", "--on"),
    ] {
        let error = analyze(&few(), words(line), &Unobserved).err().unwrap();
        assert_eq!((error.code, error.status), (code, 2), "{line}");
        assert_eq!(error.fields["option"], option, "{line}");
    }
    let error = analyze(&few(), words("--no-such-option"), &Unobserved).err();
    assert_eq!(error.unwrap().code, "wrong-command-line");
}

#[test]
fn calls_of_several_threads_keep_their_messages_apart() {
    scope(|threads| {
        let plain = threads.spawn(|| {
            let called = analyze(&few(), words("--points 20"), &Unobserved).unwrap();
            called.value.summary().unwrap().messages
        });
        for _ in 0..20 {
            let error = OpenedData::from_json(b"{", "damaged.json").err().unwrap();
            assert!(entries(&error.messages["cautions"]).is_empty());
        }
        let expected = analyze(&few(), words("--points 20"), &Unobserved).unwrap();
        let expected = expected.value.summary().unwrap().messages;
        assert_eq!(plain.join().unwrap(), expected);
    });
}

#[test]
fn the_response_of_a_corrected_model_is_exact_and_that_of_its_matrices_nearly() {
    let called = analyze(&few(), words("--points 40"), &Unobserved).unwrap();
    let choice = ModelChoice {
        condition: 10,
        model: "nominal".to_owned(),
        is_scheduled: false,
        pade: 8,
    };
    let omega = [0.5, 2.0, 12.0];
    let exact = called.value.response(&choice, &omega).unwrap();
    let models = called.value.model_json(&choice).unwrap();
    let model = &entries(&json(std::str::from_utf8(&models).unwrap())["models"])[0].clone();
    let (mut contents, matrices) = (
        json(std::str::from_utf8(&FEW_TEXT).unwrap()),
        ["A", "B", "C", "D"],
    );
    for condition in contents["conditions"].as_array_mut().unwrap() {
        let nominal = &mut condition["physics_models"][0];
        nominal["states"] = model["states"].clone();
        for matrix in matrices {
            nominal[matrix] = model[matrix].clone();
        }
    }
    let text = serde_json::to_vec(&contents).unwrap();
    let other = OpenedData::from_json(&text, "corrected.json")
        .unwrap()
        .value;
    let name = contents["conditions"][0]["physics_models"][0]["name"].clone();
    let bundle = gdcm_model::dataset::BundleKind::Physics;
    let approximate = other
        .response(10, bundle, name.as_str().unwrap(), &omega)
        .unwrap();
    for (pair, curve) in exact.iter() {
        for (exact, approximate) in curve.iter().zip(&approximate[pair]) {
            let error = (exact - approximate).norm();
            assert!(error <= 1e-8 * exact.norm().max(1e-6), "{pair:?}: {error}");
        }
    }
}
