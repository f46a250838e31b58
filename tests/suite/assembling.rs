//! Datasets assembled from folders, by the command line and by the library.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use nalgebra::DMatrix;
use serde_json::json;

use gdcm_io::formats::npy::write_npz;
use gdcm_io::formats::variables::{Array, CellArray, StructArray, TextArray, Value, Variable};
use gdcm_io::import::model_files::FoundModels;
use gdcm_io::{FolderProgress, load_dataset, read_models, write_mat};
use gdcm_model::assembly::problem::ProblemKind;
use gdcm_model::assembly::{Assembly, FoundModel, Headings, UnitRule, proposed_rules};
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::{BundleKind, Condition, Dataset, Dynamics, Model, StateSpace};
use gdcm_model::names::{ChannelRule, RowRole};

use crate::commands::{Ended, Messages};

struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

/// Runs a command, and returns the messages in its JSON output.
#[track_caller]
fn run_json(arguments: &[&str]) -> Messages {
    Messages::from_json(&run(&[arguments, &["--json"]].concat()))
}

fn run(arguments: &[&str]) -> Ended {
    Ended::from_output(
        &Command::new(env!("CARGO_BIN_EXE_gdcm"))
            .args(arguments)
            .output()
            .unwrap(),
    )
}

fn found_in(folder: &Path) -> FoundModels {
    read_models(&[folder.to_owned()], &Headings::new(), &Silent).unwrap()
}

fn matrices(model: &Model) -> [&DMatrix<f64>; 4] {
    match &model.dynamics {
        Dynamics::StateSpace(system) => [system.a(), system.b(), system.c(), system.d()],
        Dynamics::Measured(_) => panic!("the example has matrices"),
    }
}

fn array(matrix: &DMatrix<f64>) -> Value {
    Value::Array(Array::matrix(
        matrix.nrows(),
        matrix.ncols(),
        matrix.as_slice().to_vec(),
    ))
}

fn text(text: &str) -> Value {
    Value::Text(TextArray {
        shape: vec![1, 1],
        texts: vec![text.to_owned()],
    })
}

fn cell(texts: &[String]) -> Value {
    Value::Cell(CellArray {
        shape: vec![texts.len(), 1],
        values: texts.iter().map(|of| text(of)).collect(),
    })
}

/// Returns the names and units of the example's channels, under the keys used by MATLAB.
fn labels(dataset: &Dataset) -> [(&'static str, Vec<String>); 4] {
    let of = |channels: &[gdcm_model::dataset::Channel],
              part: fn(&gdcm_model::dataset::Channel) -> &String| {
        channels
            .iter()
            .map(|channel| part(channel).clone())
            .collect()
    };
    [
        ("InputName", of(dataset.inputs(), |channel| &channel.name)),
        ("InputUnit", of(dataset.inputs(), |channel| &channel.unit)),
        ("OutputName", of(dataset.outputs(), |channel| &channel.name)),
        ("OutputUnit", of(dataset.outputs(), |channel| &channel.unit)),
    ]
}

/// Returns the file name of a model without extension: "nominal", or the kind of an identified
/// model.
fn stem(kind: BundleKind, model: &Model) -> String {
    match kind {
        BundleKind::Physics if model.is_nominal() => "nominal".to_owned(),
        BundleKind::Physics => model.name.replace(' ', "_"),
        BundleKind::Identified => format!("flight_{}", model.name.replace([' ', '/'], "_")),
    }
}

/// Writes the models of the example: a folder for each condition, a file for each model.
fn write_folders(root: &Path, dataset: &Dataset, write: impl Fn(&Path, &Model)) {
    fn class(class: &Option<String>) -> String {
        class.clone().unwrap()
    }

    for condition in dataset.conditions() {
        let state = condition.flight_state();
        let name = format!(
            "c{:02}_{:03.0}kt_{}_{}",
            state.id.0,
            state.airspeed_kt,
            class(&state.altitude),
            class(&state.weight)
        );
        let folder = root.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        for kind in BundleKind::BOTH {
            condition
                .bundle(kind)
                .iter()
                .for_each(|model| write(&folder.join(stem(kind, model)), model));
        }
    }
}

fn write_as_mat(dataset: &Dataset, path: &Path, model: &Model) {
    write_sys(path, matrices(model), labels(dataset));
}

/// Writes a system as a MATLAB struct with channel names and units.
fn write_sys(path: &Path, matrices: [&DMatrix<f64>; 4], labels: [(&'static str, Vec<String>); 4]) {
    let names = ["A", "B", "C", "D"]
        .into_iter()
        .zip(matrices)
        .map(|(name, matrix)| (name.to_owned(), vec![array(matrix)]));
    let lists = labels
        .into_iter()
        .map(|(name, list)| (name.to_owned(), vec![cell(&list)]));
    let sys = Value::Struct(StructArray {
        shape: vec![1, 1],
        fields: names.chain(lists).collect(),
    });
    let bytes = write_mat(&[Variable {
        name: "sys".into(),
        value: sys,
    }])
    .unwrap();
    std::fs::write(path.with_file_name(file_name(path, "mat")), bytes).unwrap();
}

/// Writes the example's models to MATLAB files in a folder for each condition.
pub(crate) fn example_folder(root: &Path) {
    let example = &crate::EXAMPLE.dataset;
    write_folders(root, example, |path, model| {
        write_as_mat(example, path, model)
    });
}

/// Share of the longitudinal stick's travel per inch \[%\].
pub(crate) const PERCENT_IN_AN_INCH: f64 = 12.5;

/// Writes conditions 1 and 3 of the example as files of two programs. In the identified models, NZ
/// has the opposite sign, and the longitudinal stick is in inches under another name.
pub(crate) fn foreign_tree(root: &Path) {
    let example = &crate::EXAMPLE.dataset;
    let of_tree = |condition: &&Arc<Condition>| [1, 3].contains(&condition.id().0);
    let conditions = example
        .conditions()
        .iter()
        .filter(of_tree)
        .map(|condition| condition.as_ref().clone())
        .collect();
    let two = Dataset::new(example.header(), conditions).unwrap();
    write_folders(root, &two, |path, model| {
        let mut of = matrices(model).map(DMatrix::clone);
        let mut labels = labels(example);
        if path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("flight_"))
        {
            let nz = example.outputs().len() - 1;
            of[1].column_mut(0).scale_mut(PERCENT_IN_AN_INCH);
            of[3].column_mut(0).scale_mut(PERCENT_IN_AN_INCH);
            of[2].row_mut(nz).scale_mut(-1.0);
            of[3].row_mut(nz).scale_mut(-1.0);
            for (name, first) in [("InputName", "xb"), ("InputUnit", "in")] {
                labels
                    .iter_mut()
                    .filter(|label| label.0 == name)
                    .for_each(|label| label.1[0] = first.to_owned());
            }
        }
        write_sys(path, of.each_ref(), labels);
    });
}

fn write_as_npz(dataset: &Dataset, path: &Path, model: &Model) {
    let numbers = ["A", "B", "C", "D"]
        .into_iter()
        .zip(matrices(model))
        .map(|(name, matrix)| (name, array(matrix)));
    let lists = labels(dataset).into_iter().map(|(name, texts)| {
        (
            name,
            Value::Text(TextArray {
                shape: vec![1, texts.len()],
                texts,
            }),
        )
    });
    let variables: Vec<Variable> = numbers
        .chain(lists)
        .map(|(name, value)| Variable {
            name: name.to_owned(),
            value,
        })
        .collect();
    std::fs::write(
        path.with_file_name(file_name(path, "npz")),
        write_npz(&variables).unwrap(),
    )
    .unwrap();
}

fn write_as_csv(path: &Path, model: &Model) {
    for (letter, matrix) in ["A", "B", "C", "D"].into_iter().zip(matrices(model)) {
        let mut text = String::new();
        for row in matrix.row_iter() {
            let cells: Vec<String> = row.iter().map(|value| format!("{value:?}")).collect();
            writeln!(text, "{}", cells.join(",")).unwrap();
        }
        let name = format!(
            "{}_{letter}.csv",
            path.file_name().unwrap().to_str().unwrap()
        );
        std::fs::write(path.with_file_name(name), text).unwrap();
    }
}

fn write_as_literals(dataset: &Dataset, path: &Path, model: &Model) {
    let mut text = String::from("% one model\r\n");
    for (letter, matrix) in ["A", "B", "C", "D"].into_iter().zip(matrices(model)) {
        let rows: Vec<String> = matrix
            .row_iter()
            .map(|row| {
                row.iter()
                    .map(|value| format!("{value:?}"))
                    .collect::<Vec<_>>()
                    .join(" ")
            })
            .collect();
        write!(text, "{letter} = [{}];\r\n", rows.join("; ...\r\n  ")).unwrap();
    }
    for (name, list) in labels(dataset) {
        let quoted: Vec<String> = list.iter().map(|item| format!("'{item}'")).collect();
        write!(text, "{name} = {{{}}};\r\n", quoted.join(", ")).unwrap();
    }
    std::fs::write(path.with_file_name(file_name(path, "m")), text).unwrap();
}

/// Appends the extension: "roll+5" and "mat" give "roll+5.mat". `with_extension` would cut names at
/// their last point.
fn file_name(path: &Path, extension: &str) -> String {
    format!(
        "{}.{extension}",
        path.file_name().unwrap().to_str().unwrap()
    )
}

/// Asserts that a dataset has the example's values, bit for bit, and the names of the files.
fn assert_same_numbers(made: &Dataset, example: &Dataset, route: &str) {
    assert_eq!(
        made.conditions().len(),
        example.conditions().len(),
        "{route}"
    );
    for expected in example.conditions() {
        let found: &Arc<Condition> = made.condition(expected.id()).unwrap();
        let found_state = found.flight_state();
        let state = expected.flight_state();
        assert_eq!(
            (
                found_state.airspeed_kt,
                &found_state.altitude,
                &found_state.weight
            ),
            (state.airspeed_kt, &state.altitude, &state.weight)
        );
        for kind in BundleKind::BOTH {
            assert_eq!(
                found.bundle(kind).len(),
                expected.bundle(kind).len(),
                "{route}"
            );
            for model in expected.bundle(kind) {
                let same = found
                    .model(kind, &stem(kind, model))
                    .unwrap_or_else(|| panic!("{route}: {}", stem(kind, model)));
                assert_eq!(matrices(same), matrices(model), "{route}: {}", model.name);
                assert_eq!(
                    same.is_nominal(),
                    model.is_nominal(),
                    "{route}: {}",
                    model.name
                );
            }
        }
    }
}

/// Format name and the function that writes a model in this format.
type Route<'w> = (&'static str, &'w dyn Fn(&Path, &Model));

#[test]
fn the_example_in_a_folder_of_any_format_is_the_same_dataset_to_the_last_digit() {
    let example = &crate::EXAMPLE.dataset;
    let folder = tempfile::tempdir().unwrap();
    let routes: [Route<'_>; 3] = [
        ("mat", &|path, model| write_as_mat(example, path, model)),
        ("npz", &|path, model| write_as_npz(example, path, model)),
        ("m", &|path, model| write_as_literals(example, path, model)),
    ];
    for (route, write) in routes {
        let root = folder.path().join(route);
        write_folders(&root, example, write);
        let found = found_in(&root);
        assert!(found.faults.is_empty(), "{route}: {:?}", found.faults);
        let rules = proposed_rules(route, &found.models);
        let assembly = Assembly::new(found.models, rules);
        assert!(
            assembly.problems().is_empty(),
            "{route}: {:?}",
            assembly.problem_lines()
        );
        assert_same_numbers(&assembly.dataset("").unwrap(), example, route);
    }
}

#[test]
fn perturbations_of_file_names_are_the_example_s() {
    let example = &crate::EXAMPLE.dataset;
    let folder = tempfile::tempdir().unwrap();
    write_folders(folder.path(), example, |path, model| {
        write_as_mat(example, path, model)
    });
    let found = found_in(folder.path());
    let rules = proposed_rules("", &found.models);
    let made = Assembly::new(found.models, rules).dataset("").unwrap();
    for expected in example.conditions() {
        for model in expected.bundle(BundleKind::Physics) {
            let condition = made.condition(expected.id()).unwrap();
            let found = condition
                .model(BundleKind::Physics, &stem(BundleKind::Physics, model))
                .unwrap();
            assert_eq!(found.perturbation(), model.perturbation(), "{}", model.name);
        }
    }
}

#[test]
fn a_folder_of_matrices_without_names_is_made_a_dataset_by_rules_from_the_shell() {
    let example = &crate::EXAMPLE.dataset;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("csv");
    write_folders(&root, example, write_as_csv);
    let out = folder.path().join("made.json.gz");
    let root = root.to_str().unwrap();
    let made = out.to_str().unwrap();
    let first = run_json(&["assemble", root, "--out", made]);
    let models: usize = example
        .conditions()
        .iter()
        .flat_map(|of| BundleKind::BOTH.map(|kind| of.bundle(kind).len()))
        .sum();
    let others = (models - 1).to_string();
    first
        .assert_code("incomplete-rules", &[])
        .assert_reported("no-unit", &["input 1: "])
        .assert_reported("unit-of-file", &[&others]);
    assert!(!out.exists(), "nothing half made");
    // Complete the proposed rules with the names and units of the channels.
    let path = folder.path().join("made.gdcm-rules.json");
    let mut rules: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    for (side, channels) in [("inputs", example.inputs()), ("outputs", example.outputs())] {
        rules[side] = channels
            .iter()
            .map(|channel| serde_json::json!({"name": channel.name, "unit": channel.unit, "unit_in_files": channel.unit}))
            .collect();
    }
    std::fs::write(&path, rules.to_string()).unwrap();
    let second = run_json(&[
        "assemble",
        root,
        "--rules",
        path.to_str().unwrap(),
        "--out",
        made,
    ]);
    second
        .assert_success()
        .assert_reported("channels-by-position", &[]);
    assert!(second.text.contains("11 conditions"), "{}", second.text);
    let analysed = folder.path().join("analysed");
    run_json(&["analyze", made, "--out", analysed.to_str().unwrap()])
        .assert_success()
        .assert_reported("channels-by-position", &[]);
    let dataset = load_dataset(&out).unwrap().dataset;
    assert_same_numbers(&dataset, example, "csv");
    let nominal = &dataset.conditions()[0].bundle(BundleKind::Physics)[0];
    let source = nominal.source.as_ref().unwrap();
    assert_eq!(
        source.file.as_deref(),
        Some("csv/c01_120kt_low_low/nominal"),
        "relative to the dataset"
    );
    assert!(
        source.note.as_ref().unwrap().contains("SHA-256"),
        "{source:?}"
    );
    let again = run(&[
        "assemble",
        root,
        "--rules",
        path.to_str().unwrap(),
        "--out",
        made,
    ]);
    assert_eq!(again.status, 2, "nothing is overwritten unasked");
    assert!(again.error.contains("--force"), "{}", again.error);
}

/// Writes files with two physics models and a measured response of one input and one output.
pub(crate) fn small_folder(root: &Path) {
    fn model(gain: f64) -> Vec<u8> {
        let values = [
            ("A", vec![-1.0]),
            ("B", vec![gain]),
            ("C", vec![1.0]),
            ("D", vec![0.0]),
        ];
        let numbers = values.map(|(name, values)| Variable {
            name: name.into(),
            value: Value::Array(Array::matrix(1, 1, values)),
        });
        let names = [
            ("InputName", "xb"),
            ("OutputName", "pitch rate"),
            ("InputUnit", "in"),
            ("OutputUnit", "rad/s"),
        ];
        let texts = names.map(|(name, of)| Variable {
            name: name.into(),
            value: text(of),
        });
        write_mat(&[&numbers[..], &texts[..]].concat()).unwrap()
    }

    let folder = root.join("c1_60kt");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("trim.mat"), model(1.0)).unwrap();
    std::fs::write(folder.join("V+5kt.mat"), model(1.1)).unwrap();
    let mut frf = String::from("omega [rad/s],mag [dB],phase [deg],coherence\n");
    for step in 0..40 {
        let omega = 0.3 * 1.1f64.powi(step);
        let magnitude = -10.0 * (1.0 + omega * omega).log10();
        writeln!(
            frf,
            "{omega},{magnitude},{},0.9",
            -omega.atan().to_degrees()
        )
        .unwrap();
    }
    std::fs::write(folder.join("frf_Q_LON.csv"), frf).unwrap();
    std::fs::write(folder.join("broken.mat"), b"not a mat file at all").unwrap();
}

#[test]
fn channels_are_matched_and_units_converted_as_declared_and_never_in_silence() {
    fn asked(assembly: &Assembly, wanted: fn(&ProblemKind) -> bool) -> bool {
        assembly.problems().iter().any(|of| wanted(&of.kind))
    }

    let folder = tempfile::tempdir().unwrap();
    small_folder(folder.path());
    let found = found_in(folder.path());
    assert_eq!(found.models.len(), 3);
    assert!(
        found
            .faults
            .iter()
            .any(|fault| fault.contains("broken.mat")),
        "{:?}",
        found.faults
    );
    let mut rules = proposed_rules("small", &found.models);
    let assembly = Assembly::new(found.models, rules.clone());
    assert!(
        asked(&assembly, |kind| matches!(kind, ProblemKind::UnitOfFile(_))),
        "the response has no units: {:?}",
        assembly.problem_lines()
    );
    rules.rename(ChannelSide::Input, 0, "LON".into());
    rules.rename(ChannelSide::Output, 0, "Q".into());
    assert_eq!(
        rules.on_axis,
        [("Q".to_owned(), "LON".to_owned())],
        "under its new name"
    );
    rules.inputs[0].unit = "%".into();
    rules.outputs[0].unit = "deg/s".into();
    rules.inputs[0].unit_in_files = Some("%".into());
    rules.outputs[0].unit_in_files = Some("deg/s".into());
    let assembly = assembly.with_rules(rules.clone());
    assert!(
        asked(&assembly, |kind| matches!(
            kind,
            ProblemKind::Conversion { .. }
        )),
        "inches of a stick: {:?}",
        assembly.problem_lines()
    );
    rules.units.push(UnitRule {
        channel: "LON".into(),
        from: "in".into(),
        factor: 8.0,
    });
    let assembly = assembly.with_rules(rules);
    assert!(
        assembly.problems().is_empty(),
        "{:?}",
        assembly.problem_lines()
    );
    assert_eq!(
        assembly
            .parts()
            .iter()
            .filter(|part| part.row.role == Some(RowRole::Identified))
            .count(),
        1
    );
    let dataset = assembly.dataset("there").unwrap();
    let nominal = &dataset.conditions()[0].bundle(BundleKind::Physics)[0];
    let [_, b, c, _] = matrices(nominal);
    // One inch is 8 % of the stick's travel, one radian 57.3 degrees.
    assert_eq!(
        (b[(0, 0)], c[(0, 0)]),
        (1.0 / 8.0, 180.0 / std::f64::consts::PI)
    );
    let source = nominal.source.as_ref().unwrap();
    assert_eq!(source.file.as_deref(), Some("there/c1_60kt/trim.mat"));
    let note = source.note.as_ref().unwrap();
    assert!(
        note.contains("LON in → % (× 8)") && note.contains("rad/s → deg/s"),
        "{note}"
    );
    assert_eq!(source.sha256.as_ref().map(String::len), Some(64));
    let Dynamics::Measured(response) =
        &dataset.conditions()[0].bundle(BundleKind::Identified)[0].dynamics
    else {
        panic!("the response is measured")
    };
    assert!(response.coherence().is_some());
}

/// A stack with physics models and a stack with identified models, each in a file without condition
/// names.
#[test]
fn stacks_with_airspeeds_become_conditions_and_what_is_not_used_is_noted_once_a_file() {
    fn stack(gains: [f64; 3], airspeeds: [f64; 3]) -> serde_json::Value {
        let pages: Vec<serde_json::Value> = gains.iter().map(|gain| json!([[gain]])).collect();
        json!({
            "A": [[[-1.0]], [[-1.0]], [[-1.0]]], "B": pages, "C": [[1.0]], "D": [[0.0]], "airspeed_kt": airspeeds,
            "inputs": [{"name": "LON", "unit": "%"}], "outputs": [{"name": "Q", "unit": "deg/s"}],
            "input_delay_ms": [30.0], "torque": 7.0
        })
    }

    let folder = tempfile::tempdir().unwrap();
    for (name, gains, airspeeds) in [
        ("physics.json", [1.0, 2.0, 3.0], [60.0, 80.0, 100.0]),
        ("identified.json", [30.0, 20.0, 10.0], [100.0, 80.0, 60.0]),
    ] {
        std::fs::write(
            folder.path().join(name),
            stack(gains, airspeeds).to_string(),
        )
        .unwrap();
    }
    let out = folder.path().join("made.json");
    let told = run_json(&[
        "assemble",
        folder.path().to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    told.assert_success();
    let unused: Vec<_> = told.of_code("unused-variables").collect();
    assert_eq!(unused.len(), 2, "{told:?}");
    assert!(
        unused.iter().all(|note| note.text.contains("torque")),
        "{unused:?}"
    );
    let made = load_dataset(&out).unwrap().dataset;
    let mut found = Vec::new();
    for condition in made.conditions() {
        let gains = BundleKind::BOTH.map(|kind| matrices(&condition.bundle(kind)[0])[1][(0, 0)]);
        found.push((condition.flight_state().airspeed_kt, gains));
    }
    assert_eq!(
        found,
        [
            (60.0, [1.0, 10.0]),
            (80.0, [2.0, 20.0]),
            (100.0, [3.0, 30.0])
        ]
    );
    let Dynamics::StateSpace(nominal) =
        &made.conditions()[0].bundle(BundleKind::Physics)[0].dynamics
    else {
        panic!("it has matrices")
    };
    assert_eq!(nominal.timing().input_delays_s, Some(vec![0.03]));
}

#[test]
fn what_was_converted_is_read_again_as_the_same_models() {
    let folder = tempfile::tempdir().unwrap();
    small_folder(folder.path());
    let file = |name: &str| {
        folder
            .path()
            .join("c1_60kt")
            .join(name)
            .to_str()
            .unwrap()
            .to_owned()
    };
    let out = folder.path().join("models.json");
    let ended = run(&[
        "convert",
        &file("trim.mat"),
        &file("frf_Q_LON.csv"),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(ended.status, 0, "{}", ended.error);
    let again = read_models(&[out], &Headings::new(), &Silent).unwrap();
    assert_eq!(again.models.len(), 2, "{:?}", again.faults);
    let first = read_models(
        &[file("trim.mat").into(), file("frf_Q_LON.csv").into()],
        &Headings::new(),
        &Silent,
    )
    .unwrap();
    for (a, b) in first
        .models
        .into_iter()
        .map(FoundModel::with_names_of_file)
        .zip(&again.models)
    {
        assert_eq!(
            (&a.draft.matrices, &a.inputs, &a.outputs),
            (&b.draft.matrices, &b.inputs, &b.outputs)
        );
        assert_eq!(
            a.draft
                .response
                .as_ref()
                .map(|of| (&of.omega, &of.re, &of.im)),
            b.draft
                .response
                .as_ref()
                .map(|of| (&of.omega, &of.re, &of.im))
        );
    }
}

#[test]
fn a_discrete_time_model_keeps_its_sample_time_and_its_delays_in_samples_become_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = [
        ("A", 0.9),
        ("B", 1.0),
        ("C", 1.0),
        ("D", 0.0),
        ("Ts", 0.02),
        ("InputDelay", 3.0),
    ];
    let variables = numbers.map(|(name, value)| Variable {
        name: name.into(),
        value: Value::Array(Array::matrix(1, 1, vec![value])),
    });
    std::fs::write(
        folder.path().join("sys.mat"),
        write_mat(&variables).unwrap(),
    )
    .unwrap();
    let found = found_in(folder.path());
    let timing = &found.models[0].draft.timing;
    assert_eq!(
        (timing.sample_time_s, timing.input_delays_s.as_deref()),
        (Some(0.02), Some(&[0.06][..]))
    );
    let [a, b, c, d] = found.models[0].draft.matrices.clone().map(Option::unwrap);
    assert!(
        StateSpace::new(a, b, c, d)
            .unwrap()
            .timed(timing.clone())
            .is_ok()
    );
}

#[test]
fn columns_are_read_by_the_headings_that_the_rules_say_in_place_of_the_file_s() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frf-omega-re-im.csv");
    std::fs::write(&path, "1,0,-90\n2,-6,-100\n4,-12,-120\n").unwrap();
    let of =
        |headings: &Headings| read_models(&[folder.path().to_owned()], headings, &Silent).unwrap();
    let unsaid = of(&Headings::new());
    assert_eq!(unsaid.tables["frf-omega-re-im.csv"], ["", "", ""]);
    assert!(
        unsaid.models.is_empty(),
        "numbers alone do not say what they are"
    );
    assert!(
        unsaid.ignored[0].contains("\"headings\""),
        "{:?}",
        unsaid.ignored
    );

    let said = ["f [Hz]", "mag P/LAT [dB]", "phase P/LAT [deg]"]
        .map(str::to_owned)
        .to_vec();
    let headings = Headings::from([("frf-omega-re-im.csv".to_owned(), said.clone())]);
    let found = of(&headings);
    assert_eq!(found.tables, headings);
    let response = found.models[0].response().unwrap();
    // 1 Hz is 2 pi rad/s; -6 dB at -100 degrees.
    assert!((response.omega[0] - std::f64::consts::TAU).abs() < 1e-12);
    let magnitude = 10f64.powf(-0.3);
    let phase = -100f64.to_radians();
    assert!((response.re.values[1] - magnitude * phase.cos()).abs() < 1e-12);
    assert_eq!(found.models[0].outputs[0].name.as_deref(), Some("P"));

    let short = Headings::from([("frf-omega-re-im.csv".to_owned(), said[..2].to_vec())]);
    let fault = read_models(&[folder.path().to_owned()], &short, &Silent)
        .unwrap_err()
        .to_string();
    assert!(
        fault.contains("2 headings") && fault.contains("3 columns"),
        "{fault}"
    );
}

#[test]
fn names_are_said_for_the_channels_of_one_model_and_a_wrong_number_of_them_is_told() {
    let folder = tempfile::tempdir().unwrap();
    small_folder(folder.path());
    let found = found_in(folder.path());
    let rules = proposed_rules("", &found.models);
    let key = found
        .models
        .iter()
        .find(|model| model.file().ends_with("trim.mat"))
        .unwrap()
        .key();
    let with = |names: &[&str]| {
        let mut rules = rules.clone();
        rules.rows.entry(key.clone()).or_default().outputs =
            Some(names.iter().map(|name| (*name).to_owned()).collect());
        Assembly::new(found.models.clone(), rules)
    };
    let kinds = |names: &[&str]| -> Vec<ProblemKind> {
        let assembly = with(names);
        let problems = assembly.problems();
        problems
            .iter()
            .map(|problem| problem.kind.clone())
            .collect()
    };
    let nz = kinds(&["NZ"]);
    assert!(
        nz.iter().any(|kind| kind.to_string().contains("NZ")),
        "the model has another output now: {nz:?}"
    );
    let wrong_count = ProblemKind::NameCount {
        side: ChannelSide::Output,
        given: 2,
        found: 1,
    };
    let two_names = kinds(&["Q", "P"]);
    assert!(two_names.contains(&wrong_count), "{two_names:?}");
}

#[test]
fn measured_responses_of_one_model_at_differing_frequencies_are_a_problem() {
    let folder = tempfile::tempdir().unwrap();
    small_folder(folder.path());
    let frf: String = (1..=30)
        .map(|step| format!("{},0,-10\n", 0.5 * f64::from(step)))
        .collect();
    let text = format!("omega [rad/s],mag [dB],phase [deg]\n{frf}");
    std::fs::write(folder.path().join("c1_60kt/frf_P_LAT.csv"), text).unwrap();
    let found = found_in(folder.path());
    let mut rules = proposed_rules("small", &found.models);
    rules.inputs.push(ChannelRule::named("LAT"));
    rules.outputs.push(ChannelRule::named("P"));
    let assembly = Assembly::new(found.models, rules);
    let grids = assembly
        .problems()
        .iter()
        .find_map(|problem| match &problem.kind {
            ProblemKind::Grids {
                first,
                first_grid,
                second,
                second_grid,
            } => Some([(first, first_grid), (second, second_grid)]),
            _ => None,
        })
        .unwrap_or_else(|| panic!("{:#?}", assembly.problem_lines()));
    for (name, count, ends_rad_s) in [
        ("frf_P_LAT.csv", 30, [0.5, 15.0]),
        ("frf_Q_LON.csv", 40, [0.3, 12.3]),
    ] {
        let (_, grid) = grids
            .iter()
            .find(|(file, _)| file.ends_with(name))
            .unwrap_or_else(|| panic!("{name} in {grids:?}"));
        assert_eq!(grid.count, count);
        let found = [grid.lowest_rad_s, grid.highest_rad_s];
        assert!(
            found
                .iter()
                .zip(ends_rad_s)
                .all(|(a, b)| (a - b).abs() < 0.05),
            "{found:?}"
        );
    }
}

#[test]
fn the_flight_records_of_a_dataset_stay_with_its_condition_and_are_found_from_where_the_new_one_lies()
 {
    fn plain(path: &Path) -> PathBuf {
        path.components()
            .filter(|part| part.as_os_str() != ".")
            .collect::<PathBuf>()
    }

    fn unplaced(records: &[ConditionRecord]) -> Vec<ConditionRecord> {
        records
            .iter()
            .map(|record| ConditionRecord {
                file: String::new(),
                ..record.clone()
            })
            .collect()
    }

    let folder = tempfile::tempdir().unwrap();
    let mut text: serde_json::Value =
        serde_json::from_str(include_str!("../data/small-dataset.json")).unwrap();
    text["conditions"][0]["records"] = json!([
        {"name": "LON 1", "file": "records/lon_1.csv", "kind": "sweep", "used_s": [[0.0, 30.5]]},
        {"name": "steps", "file": "all.mat", "variable": "run 2", "held_out": true}
    ]);
    text["conditions"][0]["identified_models"][0]["source"] = json!({"records": ["LON 1"]});
    let old = folder.path().join("flights/old.json");
    std::fs::create_dir_all(old.parent().unwrap()).unwrap();
    std::fs::write(&old, text.to_string()).unwrap();
    let before = load_dataset(&old).unwrap().dataset;
    let made = |source: &Path, name: &str| {
        let path = folder.path().join(name);
        let ended = run(&[
            "assemble",
            source.to_str().unwrap(),
            "--out",
            path.to_str().unwrap(),
        ]);
        assert_eq!(ended.status, 0, "{}", ended.error);
        let made = load_dataset(&path).unwrap().dataset;
        let files: Vec<PathBuf> = made.conditions()[0]
            .records()
            .iter()
            .map(|record| path.parent().unwrap().join(&record.file))
            .collect();
        let beside = old.parent().unwrap();
        let expected = ["records/lon_1.csv", "all.mat"].map(|file| beside.join(file));
        assert_eq!(
            files.iter().map(|path| plain(path)).collect::<Vec<_>>(),
            expected,
            "from {}",
            source.display()
        );
        made
    };
    for (source, name) in [
        (folder.path().join("flights"), "of_folder.json"),
        (old.clone(), "of_file.json"),
    ] {
        let made = made(&source, name);
        let condition = &made.conditions()[0];
        let old = &before.conditions()[0];
        assert_eq!(unplaced(condition.records()), unplaced(old.records()));
        assert_eq!(
            condition.bundle(BundleKind::Identified)[0]
                .source
                .as_ref()
                .unwrap()
                .records,
            ["LON 1"]
        );
        assert_eq!(made.conditions()[1].records(), []);
    }
}

#[test]
fn a_folder_without_identified_models_makes_a_dataset_that_says_what_it_needs_next() {
    let folder = tempfile::tempdir().unwrap();
    let models = folder.path().join("models");
    foreign_tree(&models);
    for entry in walk(&models) {
        if entry
            .file_name()
            .unwrap()
            .to_string_lossy()
            .starts_with("flight_")
        {
            std::fs::remove_file(entry).unwrap();
        }
    }
    let out = folder.path().join("made.json");
    let ended = run(&[
        "assemble",
        models.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--json",
    ]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let said: serde_json::Value = serde_json::from_str(&ended.out).unwrap();
    let of_code: Vec<_> = said["cautions"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|caution| caution["code"] == "no-reference")
        .collect();
    assert_eq!(
        (of_code.len(), &of_code[0]["conditions"]),
        (1, &json!([1, 3]))
    );
    let dataset = load_dataset(&out).unwrap().dataset;
    assert!(
        dataset
            .conditions()
            .iter()
            .all(|condition| !condition.has_reference())
    );
}

/// Returns every file below a folder.
fn walk(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(walk(&path))
        } else {
            files.push(path)
        }
    }
    files
}

/// Writes the response of a channel pair, magnitude in dB and phase in degrees over rad/s, to a
/// file with this name.
fn write_response(folder: &Path, name: &str) {
    let mut frf = String::from("omega [rad/s],mag [dB],phase [deg]\n");
    for step in 0..40 {
        writeln!(
            frf,
            "{},{},-10",
            0.3 * 1.1f64.powi(step),
            -0.5 * f64::from(step)
        )
        .unwrap();
    }
    std::fs::write(folder.join(name), frf).unwrap();
}

/// Writes a model with a single state to a MATLAB file: gain, names and units of input and output.
fn write_small(path: &Path, gain: f64, names: [&str; 2], units: [Option<&str>; 2]) {
    let scalar = |value: f64| DMatrix::from_element(1, 1, value);
    let lists = [("InputName", names[0]), ("OutputName", names[1])]
        .map(|(key, name)| (key, vec![name.to_owned()]));
    let mut variables: Vec<Variable> = [("A", -1.0), ("B", gain), ("C", 1.0), ("D", 0.0)]
        .into_iter()
        .map(|(name, value)| Variable {
            name: name.into(),
            value: array(&scalar(value)),
        })
        .collect();
    variables.extend(lists.map(|(key, names)| Variable {
        name: key.into(),
        value: cell(&names),
    }));
    for (key, unit) in ["InputUnit", "OutputUnit"].into_iter().zip(units) {
        variables.extend(unit.map(|unit| Variable {
            name: key.into(),
            value: cell(&[unit.to_owned()]),
        }));
    }
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, write_mat(&variables).unwrap()).unwrap();
}

/// Returns the gain C B of the first model of a bundle in the first condition, in the dataset's
/// units.
fn gain_of(dataset: &Path, kind: BundleKind) -> f64 {
    let dataset = load_dataset(dataset).unwrap().dataset;
    let [_, b, c, _] = matrices(&dataset.conditions()[0].bundle(kind)[0]);
    b[(0, 0)] * c[(0, 0)]
}

#[test]
fn a_response_whose_name_says_no_channels_makes_no_dataset_and_one_that_does_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let models = folder.path().join("models/c1_60kt");
    write_small(
        &models.join("nominal.mat"),
        1.0,
        ["LON", "Q"],
        [Some("%"), Some("deg/s")],
    );
    let out = folder.path().join("made.json");
    let assemble = |more: &[&str]| {
        let root = folder.path().join("models");
        run(&[
            &[
                "assemble",
                root.to_str().unwrap(),
                "--out",
                out.to_str().unwrap(),
                "--force",
            ],
            more,
        ]
        .concat())
    };
    let units = ["--unit", "LON=%", "--unit", "Q=deg/s"];
    // The file name contains the pedals, which the dataset lacks. Without this check, the dataset
    // would contain a response of zeros.
    write_response(&models, "frf_r_ped_run2.csv");
    let ended = assemble(&units);
    assert_eq!(ended.status, 2, "{}{}", ended.out, ended.error);
    Messages::from_json(&assemble(&[&units[..], &["--json"]].concat()))
        .assert_reported("response-unmatched", &["frf_r_ped_run2.csv: "]);
    assert!(
        ended.error.contains("--headings") && ended.error.contains("\"models\""),
        "two ways: {}",
        ended.error
    );
    assert!(!out.exists());
    std::fs::remove_file(models.join("frf_r_ped_run2.csv")).unwrap();
    for name in [
        "frf_q_delta_lon.csv",
        "q_per_lon.csv",
        "frf_q_lon_run2.csv",
        "frf_pitch_rate_lon_cyclic.csv",
    ] {
        write_response(&models, name);
        let ended = assemble(&units);
        assert_eq!(ended.status, 0, "{name}: {}", ended.error);
        let dataset = load_dataset(&out).unwrap().dataset;
        let Dynamics::Measured(response) =
            &dataset.conditions()[0].bundle(BundleKind::Identified)[0].dynamics
        else {
            panic!("{name}: the response is measured")
        };
        let first = response.values()[gdcm_model::dataset::Pair::new(0, 0)][0];
        assert!(
            (first.norm() - 1.0).abs() < 1e-12,
            "{name}: 0 dB, not {first}"
        );
        std::fs::remove_file(models.join(name)).unwrap();
    }
}

#[test]
fn units_factors_and_signs_are_said_for_a_role_a_folder_or_a_file_by_the_option_that_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("models");
    // The identified file has another unit that it does not state, another name for the input, and
    // an output with an unknown sign.
    write_small(
        &root.join("c1_60kt/nominal.mat"),
        1.0,
        ["LON", "NZ"],
        [Some("%"), Some("m/s^2")],
    );
    write_small(
        &root.join("c1_60kt/flight.mat"),
        -2.0,
        ["xb", "az"],
        [None, Some("g")],
    );
    let out = folder.path().join("made.json");
    let assemble = |more: &[&str]| {
        run(&[
            &[
                "assemble",
                root.to_str().unwrap(),
                "--out",
                out.to_str().unwrap(),
                "--force",
            ],
            more,
        ]
        .concat())
    };
    let rules = folder.path().join("made.gdcm-rules.json");
    let ended = assemble(&[]);
    assert_eq!(ended.status, 2, "{}", ended.error);
    // The rules define the channels as in the physics model.
    let mut said: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&rules).unwrap()).unwrap();
    said["inputs"] = json!([{"name": "LON", "unit": "%"}]);
    said["outputs"] = json!([{"name": "NZ", "unit": "m/s^2"}]);
    let rules = folder.path().join("said.gdcm-rules.json");
    std::fs::write(&rules, said.to_string()).unwrap();
    let with = |more: &[&str]| assemble(&[&["--rules", rules.to_str().unwrap()], more].concat());
    Messages::from_json(&with(&["--json"]))
        .assert_code("incomplete-rules", &[])
        .assert_reported("unit-of-file", &["--unit LON=UNIT:identified"])
        .assert_reported("sign", &["--sign NZ=-1:identified"]);
    let options = ["--unit", "LON=in:identified", "--sign", "NZ=-1:identified"];
    Messages::from_json(&with(&[&options[..], &["--json"]].concat()))
        .assert_reported("conversion", &["--factor LON=X:identified"]);
    let gravity = 9.806_65;
    for of in [
        ":identified",
        "",
        ":flight*",
        ":c1_60kt/flight.mat",
        ":c1_*/flight.mat",
    ] {
        let sign = format!("NZ=-1{of}");
        let ended = with(&["--factor", &format!("LON=8{of}"), "--sign", &sign]);
        assert_eq!(ended.status, 0, "{of}: {}", ended.error);
        assert_eq!(
            gain_of(&out, BundleKind::Physics),
            1.0,
            "{of}: the physics model is as it was"
        );
        let identified = gain_of(&out, BundleKind::Identified);
        assert!(
            (identified / (2.0 * gravity / 8.0) - 1.0).abs() < 1e-12,
            "{of}: {identified}"
        );
    }
    let ended = with(&["--factor", "LON=8", "--factor", "NZ=-9.8:flight.mat"]);
    assert_eq!(ended.status, 0, "{}", ended.error);
    let identified = gain_of(&out, BundleKind::Identified);
    assert!(
        (identified / (2.0 * 9.8 / 8.0) - 1.0).abs() < 1e-12,
        "a factor has its sign: {identified}"
    );
    let refused: [(&[&str], &str, &[&str]); 3] = [
        (
            &["--factor", "PED=8", "--json"],
            "unknown-channel",
            &["--factor: ", "channel PED"],
        ),
        (
            &["--sign", "NZ=-1:c7/*", "--json"],
            "unknown-model",
            &["--sign: NZ: ", "\"c7/*\""],
        ),
        (
            &["--factor", "LON=8", "--unit", "LON=in", "--json"],
            "given-twice",
            &["--factor: LON of identified "],
        ),
    ];
    for (options, code, names) in refused {
        Messages::from_json(&with(options)).assert_code(code, names);
    }
}

#[test]
fn units_are_proposed_from_most_files() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join("c1_60kt").join(name);
    write_small(
        &place("a_flight.mat"),
        1.0,
        ["LON", "Q"],
        [Some("in"), Some("rad/s")],
    );
    write_small(
        &place("nominal.mat"),
        1.0,
        ["LON", "Q"],
        [Some("%"), Some("deg/s")],
    );
    write_small(
        &place("roll+5.mat"),
        1.0,
        ["LON", "Q"],
        [Some("percent"), Some("°/s")],
    );
    let rules = proposed_rules("", &found_in(folder.path()).models);
    assert_eq!(
        (
            rules.inputs[0].unit.as_str(),
            rules.outputs[0].unit.as_str()
        ),
        ("%", "deg/s")
    );
}
