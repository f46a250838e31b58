//! Models and responses in files written by GNU Octave, NumPy, python-control and spreadsheet
//! programs.

use nalgebra::DMatrix;

use gdcm_io::import::model_files::{FoundModels, models_of_bytes};
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_model::assembly::problem::ProblemKind;
use gdcm_model::assembly::{Assembly, ChannelLabel, FoundModel, Rules, proposed_rules};
use gdcm_model::dataset::dataset_draft::ResponseDraft;
use gdcm_model::names::RowRole;

use crate::program_folder;

/// Reads a file of `tests/data/foreign`; its name includes the folder of the writing program.
fn read_foreign(name: &str) -> FoundModels {
    let bytes = std::fs::read(program_folder().join("tests/data/foreign").join(name))
        .expect("the test file should exist");
    let name = name.rsplit('/').next().unwrap_or(name);
    models_of_bytes(&bytes, name, &ReadingBudget::new(1 << 26))
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Returns the model of a file; asserts that there is exactly one.
fn model(name: &str) -> FoundModel {
    let mut found = read_foreign(name);
    assert_eq!(
        found.models.len(),
        1,
        "{name} should contain one model; faults {:?}, ignored {:?}",
        found.faults,
        found.ignored
    );
    found.models.remove(0)
}

fn matrices(model: &FoundModel) -> Vec<DMatrix<f64>> {
    model.draft.matrices.iter().flatten().cloned().collect()
}

fn response(model: &FoundModel) -> &ResponseDraft {
    model.response().expect("the model should be a response")
}

/// Returns the response of Q to LON from the text file that states all names and units.
fn q_lon() -> ResponseDraft {
    response(&model("text/desc_Q_LON.csv")).clone()
}

/// Asserts that the response of channel pair `(output, input)` equals [`q_lon`] within 1e-9 of its
/// magnitude; `inputs` is the number of inputs in `found`.
fn assert_same_response(found: &ResponseDraft, [output, inputs, input]: [usize; 3], name: &str) {
    let expected = q_lon();
    let count = expected.omega.len();
    assert_eq!(found.omega.len(), count, "{name}");
    let start = (output * inputs + input) * count;
    for k in 0..count {
        assert!(
            (found.omega[k] / expected.omega[k] - 1.0).abs() < 1e-12,
            "{name}: frequency {k} differs"
        );
        let [re, im] = [&found.re, &found.im].map(|part| part.values[start + k]);
        let difference = (re - expected.re.values[k]).hypot(im - expected.im.values[k]);
        assert!(
            difference < 1e-9 * re.hypot(im),
            "{name}, value {k}: {re} + {im}j differs by {difference}"
        );
    }
}

#[test]
fn every_format_of_octave_gives_the_same_matrices_to_the_last_digit() {
    let expected = matrices(&model("octave/expected-A-B-C-D.mat"));
    for name in [
        "m_text.txt",
        "m_bin.bin",
        "m_hdf5.h5.gz",
        "m_textzip.gz",
        "ss_text.txt",
        "ss_bin.bin",
        "ss_hdf5.h5.gz",
        "st_text.txt",
    ] {
        assert_eq!(
            matrices(&model(&format!("octave/{name}"))),
            expected,
            "{name}"
        );
    }
    let object = model("octave/ss_text.txt");
    assert_eq!(object.inputs[0].name.as_deref(), Some("LON"));
    assert_eq!(object.draft.timing.sample_time_s, None);
}

#[test]
fn a_discrete_model_of_octave_keeps_its_sample_time() {
    let discrete = model("octave/d_text.txt");
    assert_eq!(
        matrices(&discrete),
        matrices(&model("octave/expected-discrete.mat"))
    );
    assert_eq!(discrete.draft.timing.sample_time_s, Some(0.02));
}

#[test]
fn a_missing_sample_time_of_a_discrete_model_is_asked_for() {
    let mut discrete = model("octave/d_text.txt");
    discrete.draft.timing.sample_time_s = None;
    let is_asked = |model: &FoundModel, sample_time_s: Option<f64>| {
        let assembly = Assembly::new(
            vec![model.clone()],
            Rules {
                sample_time_s,
                ..Rules::default()
            },
        );
        assembly
            .problems()
            .iter()
            .any(|problem| matches!(problem.kind, ProblemKind::NoSampleTime { .. }))
    };
    assert!(is_asked(&discrete, None));
    assert!(!is_asked(&discrete, Some(0.02)));
    assert!(!is_asked(&discrete, Some(0.0)));
    assert!(!is_asked(&model("octave/m_text.txt"), None));
}

#[test]
fn signs_of_a_file_override_those_of_its_role_of_all_files_and_of_the_name() {
    let mut found = model("octave/ss_text.txt");
    found.outputs[5] = ChannelLabel::named("-NZ");
    let factor = |rules: Rules| {
        Assembly::new(vec![found.clone()], rules).parts()[0]
            .outputs
            .uses[5]
            .clone()
            .map(|channel_use| channel_use.factor)
    };
    let rules = || {
        let mut rules = proposed_rules("", std::slice::from_ref(&found));
        for channel in &mut rules.outputs {
            channel.unit_in_files = Some(channel.unit.clone());
        }
        rules
    };
    assert_eq!(rules().outputs[5].name, "NZ");
    assert_eq!(
        factor(rules()),
        Some(-1.0),
        "the minus in the name of the channel is its sign"
    );
    let mut stated = rules();
    stated.signs.insert("NZ".into(), 1.0);
    assert_eq!(factor(stated.clone()), Some(1.0));
    stated
        .role_signs
        .insert("physics".into(), [("NZ".to_owned(), -1.0)].into());
    stated.rows.entry(found.key()).or_default().role = Some(RowRole::Nominal);
    assert_eq!(factor(stated.clone()), Some(-1.0));
    stated.rows.entry(found.key()).or_default().signs = Some([("NZ".to_owned(), 1.0)].into());
    assert_eq!(factor(stated), Some(1.0));
}

#[test]
fn a_transfer_function_of_octave_becomes_a_state_space_model() {
    let found = model("octave/tf_v7.mat");
    let a = found.draft.matrices[0]
        .as_ref()
        .expect("the model should have matrices");
    assert_eq!(
        (a.nrows(), found.inputs.len(), found.outputs.len()),
        (8, 1, 1)
    );
    for name in ["kinds.txt", "kinds.bin", "kinds.h5.gz"] {
        let found = read_foreign(&format!("octave/{name}"));
        let transfer_function = found
            .models
            .iter()
            .find(|model| model.variable() == "t")
            .unwrap_or_else(|| panic!("{name} should contain a model t"));
        assert_eq!(
            transfer_function.draft.matrices[0]
                .as_ref()
                .map(|a| a.as_slice().to_vec()),
            Some(vec![-3.0, 1.0, -4.0, 0.0])
        );
    }
}

#[test]
fn responses_of_octave_numpy_and_python_control_are_those_of_the_text() {
    // Outputs: P, Q, R and three accelerations; inputs: LON, LAT, PED, COL.
    for name in [
        "octave/frd_text.txt.gz",
        "numpy/frd.npz",
        "numpy/frd2.npz",
        "numpy/frd3.npz",
    ] {
        let found = model(name);
        assert_eq!(response(&found).re.shape, [6, 4, 60], "{name}");
        assert_same_response(response(&found), [1, 4, 0], name);
    }
}

#[test]
fn each_first_index_of_a_numpy_stack_is_a_model() {
    let found = read_foreign("numpy/stack.npz");
    assert_eq!(found.models.len(), 3, "{:?}", found.faults);
    let expected = matrices(&model("octave/expected-A-B-C-D.mat"));
    assert_eq!(found.models[0].variable(), "[0,:,:]");
    assert!(
        found.models.iter().any(|model| matrices(model) == expected),
        "a model of the stack should equal the one of Octave"
    );
}

#[test]
fn responses_in_text_files_are_read_from_every_kind_of_column() {
    for name in [
        "cplx_Q_LON.csv",
        "desc_Q_LON.csv",
        "pd_Q_LON.csv",
        "cohp_Q_LON.csv",
    ] {
        let model = model(&format!("text/{name}")).with_names_of_file();
        assert_eq!(
            (
                model.outputs[0].name.as_deref(),
                model.inputs[0].name.as_deref()
            ),
            (Some("Q"), Some("LON")),
            "{name}"
        );
        assert_same_response(response(&model), [0, 1, 0], name);
    }
    let percent = model("text/cohp_Q_LON.csv");
    let coherence = response(&percent)
        .coherence
        .as_ref()
        .expect("the response should have coherence");
    assert!(
        (coherence.values[0] - 0.97).abs() < 1e-12,
        "{}",
        coherence.values[0]
    );
}

#[test]
fn missing_units_of_a_table_are_asked_for_and_never_guessed() {
    for (name, units) in [
        (
            "amb_Q_LON.csv",
            &[["rad/s", "Hz"], ["dB", "abs"], ["deg", "rad"]][..],
        ),
        // Without a frequency, no unit is asked for.
        ("frf_Q_LON.txt", &[]),
        ("positive_Q_LON.csv", &[["dB", "abs"]]),
    ] {
        let found = read_foreign(&format!("text/{name}"));
        assert!(found.models.is_empty(), "{name}");
        let mut asked = Vec::new();
        for missing in found.missing_units.values().flatten() {
            asked.push(missing.units);
        }
        assert_eq!(asked, units, "{name}");
        // The question about the headings is the reason why the file is ignored.
        assert_eq!(found.faults, [""; 0], "{name}");
        assert_eq!(found.ignored.len(), 1, "{name}: {:?}", found.ignored);
    }
}
