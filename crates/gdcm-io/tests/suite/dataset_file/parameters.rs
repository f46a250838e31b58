//! Named parameters of the physics model in dataset files (M18.1).

use gdcm_io::files::dataset_file::save_dataset;
use gdcm_model::dataset::limits::MOST_PARAMETERS;
use gdcm_model::dataset::physics_parameter::MovedParameters;

use super::*;

/// Adds a run, a rerun and the declaration of a parameter to the small dataset.
fn with_runs(file: &mut Value) {
    file["parameters"] = json!([
        {"name": "Ixx", "unit": "%", "plausible_sd": 5, "description": "roll inertia"},
        {"name": "lag", "unit": "s"}
    ]);
    let models = file["conditions"][0]["physics_models"]
        .as_array_mut()
        .unwrap();
    let mut run = models[0].clone();
    run["name"] = json!("Ixx +5 %");
    run["role"] = json!("perturbed");
    run["parameter"] = json!({"name": "Ixx", "delta": 5.0, "unit": "%"});
    let mut rerun = models[0].clone();
    rerun["name"] = json!("found");
    rerun["parameters"] = json!([
        {"name": "Ixx", "delta": 4.0, "unit": "%"},
        {"name": "lag", "delta": -0.01, "unit": "s"}
    ]);
    models.insert(1, run);
    models.push(rerun);
}

#[test]
fn runs_and_reruns_are_no_members_of_the_physics_bundle() {
    let before = load(SMALL.as_bytes()).unwrap().dataset;
    let loaded = load(&small(with_runs)).unwrap();
    assert!(loaded.cautions.is_empty(), "{:?}", loaded.cautions);
    let dataset = loaded.dataset;
    let parameters = dataset.parameters();
    assert_eq!(parameters[0].name, "Ixx");
    assert_eq!(parameters[0].plausible_sd, Some(5.0));
    assert_eq!(parameters[0].description, "roll inertia");
    assert_eq!(parameters[1].plausible_sd, None);
    let condition = &dataset.conditions()[0];
    assert_eq!(
        condition.bundle(BundleKind::Physics),
        before.conditions()[0].bundle(BundleKind::Physics),
        "the bundle should be the same as without runs"
    );
    let [run, rerun] = condition.moved_models() else {
        panic!("expected a run and a rerun")
    };
    assert_eq!(run.run().unwrap().delta, 5.0);
    let MovedParameters::Rerun(changes) = &rerun.moved else {
        panic!("expected a rerun")
    };
    assert_eq!((changes[1].name.as_str(), changes[1].delta), ("lag", -0.01));
    // The role of the rerun is nominal in the file.
    assert!(!rerun.model.is_nominal());
}

#[test]
fn runs_survive_saving() {
    let dataset = load(&small(with_runs)).unwrap().dataset;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.json.gz");
    save_dataset(&dataset, &path).unwrap();
    assert_eq!(load_dataset(&path).unwrap().dataset, dataset);
}

#[test]
fn a_dataset_without_runs_is_saved_without_their_keys() {
    let dataset = load(SMALL.as_bytes()).unwrap().dataset;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.json");
    save_dataset(&dataset, &path).unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    assert!(!text.contains("parameter"), "{text}");
}

#[test]
fn a_run_keeps_its_parameter_when_models_are_identified() {
    let dataset = load(&small(with_runs)).unwrap().dataset;
    let condition = &dataset.conditions()[0];
    let identified = condition.bundle(BundleKind::Identified).to_vec();
    let replaced = condition
        .with_identified(identified[..1].to_vec(), Vec::new())
        .unwrap();
    assert_eq!(replaced.moved_models(), condition.moved_models());
}

#[test]
fn meaningless_runs_and_parameters_are_refused() {
    for (pointer, value, code) in [
        (
            "/conditions/0/physics_models/1/parameter/delta",
            json!(0.0),
            "parameter-delta",
        ),
        (
            "/conditions/0/physics_models/1/parameter/name",
            json!(""),
            "parameter-without-name",
        ),
        (
            "/conditions/0/physics_models/1/name",
            json!("found"),
            "duplicate-moved-model",
        ),
        (
            "/parameters/0/plausible_sd",
            json!(0.0),
            "parameter-plausible-sd",
        ),
        ("/parameters/1/name", json!("Ixx"), "duplicate-parameter"),
        (
            "/conditions/0/physics_models/1/parameter/delta",
            json!("5"),
            "wrong-type",
        ),
    ] {
        assert_refused(
            |file| {
                with_runs(file);
                *file.pointer_mut(pointer).unwrap() = value.clone();
            },
            code,
            "",
            &[],
        );
    }
    assert_refused(
        |file| {
            with_runs(file);
            let model = &mut file["conditions"][0]["physics_models"][1];
            model["parameters"] = json!([model["parameter"]]);
        },
        "run-and-rerun",
        "Ixx +5 %",
        &[],
    );
    assert_refused(
        |file| {
            with_runs(file);
            let parameter = file["parameters"][1].clone();
            file["parameters"] = json!(vec![parameter; MOST_PARAMETERS + 1]);
        },
        "too-many-entries",
        "parameters",
        // The limit, MOST_PARAMETERS.
        &["200"],
    );
}

#[test]
fn a_parameter_of_an_identified_model_is_reported_as_misplaced() {
    let loaded = load(&small(|file| {
        file["conditions"][0]["identified_models"][0]["parameter"] =
            json!({"name": "Ixx", "delta": 5, "unit": "%"});
    }))
    .unwrap();
    let [FileCaution::MisplacedKey { key, .. }] = loaded.cautions.as_slice() else {
        panic!("{:?}", loaded.cautions)
    };
    assert_eq!(key, "parameter");
}

#[test]
fn the_schema_has_the_limits_of_parameters() {
    let path = crate::program_folder().join("assets/gdcm-dataset.schema.json");
    let schema: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let most = MOST_PARAMETERS as u64;
    assert_eq!(schema["properties"]["parameters"]["maxItems"], most);
    let model = &schema["$defs"]["physics_model"]["properties"];
    assert_eq!(model["parameters"]["maxItems"], most);
    let change = &schema["$defs"]["parameter_change"]["properties"];
    assert_eq!(change["delta"]["not"]["const"], 0);
}
