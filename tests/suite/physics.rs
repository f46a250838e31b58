//! Physics parameters on the command line: printed text and files (M18.5).

use std::fs;
use std::path::Path;

use gdcm_io::load_dataset;
use gdcm_model::dataset::BundleKind;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::evaluate;
use gdcm_study::decisions::setting_table;
use gdcm_study::{Engine, PhysicsCorrection, Study};
use gdcm_words::physics::{LIKE_EFFECT, naming_words};

use crate::commands::Desk;
use crate::exports::octave;
use crate::{entries, read_json};

/// The dataset with known truth: tail lift +11 %, swashplate phase +1.6 deg, inflow mass -12 %.
const DATASET: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/data/reference/physics-dataset.json.gz"
);

fn line<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [
        &["analyze", DATASET, "--points", "40", "--phase", "lead"],
        more,
    ]
    .concat()
}

#[test]
fn analyze_names_parameters_and_writes_them() {
    let desk = Desk::new();
    let told = desk.messages(&line(&["--physics", "named", "--out", "named"]));
    told.assert_success();
    let printed = told.text.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in ["tail_lift", naming_words(None), LIKE_EFFECT, "physics.csv"] {
        assert!(printed.contains(words), "{words}: {printed}");
    }
    let found = read_json(&desk.path("named/corrections.json"));
    assert_eq!(found["settings"]["physics"], "named");
    let physics = &found["physics"];
    assert_eq!(physics["verdict"], "accounts");
    let parameters = entries(&physics["parameters"]);
    assert_eq!(parameters.len(), 7);
    let mut named = Vec::new();
    for parameter in parameters {
        assert_eq!(parameter["on"], true);
        assert_eq!(entries(&parameter["interval"]).len(), 2);
        assert!(parameter["variance"]["prior"].as_f64().unwrap() > 0.0);
        if parameter["named"] == true {
            named.push(parameter["name"].as_str().unwrap());
        } else {
            assert!(parameter["why_not"].is_string());
        }
    }
    assert_eq!(named, ["tail_lift", "swashplate_phase"]);
    let applied = entries(&physics["applied"]);
    assert_eq!(applied.len(), 2);
    let phase = applied[1]["change"].as_f64().unwrap();
    assert!((phase - 1.65).abs() < 0.05, "{phase}");
    let left_out = &physics["left_out"];
    assert!(left_out["others"].as_f64() < left_out["without_others"].as_f64());
    assert_eq!(entries(&physics["without_condition"]).len(), 8);
    assert_eq!(entries(&found["contains"]["physics"]).len(), 2);
    let table = fs::read_to_string(desk.path("named/physics.csv")).unwrap();
    assert_eq!(table.lines().count(), 8);
    let sums = fs::read_to_string(desk.path("named/corrections.sha256")).unwrap();
    assert!(sums.contains("physics.csv"));

    desk.gdcm(&line(&["--out", "off"])).assert_done();
    let off = read_json(&desk.path("off/corrections.json"));
    assert!(off.get("physics").is_none() && off["settings"].get("physics").is_none());
    assert!(!desk.path("off/physics.csv").exists());
}

#[test]
fn values_are_set_by_hand() {
    let desk = Desk::new();
    let by_hand = ["--parameter", "Ixx=+4%", "--parameter", "tail_wake=-0.1"];
    desk.gdcm(&line(&[&by_hand[..], &["--out", "hand"]].concat()))
        .assert_done();
    let found = read_json(&desk.path("hand/corrections.json"));
    assert_eq!(found["settings"]["physics"], "by-hand");
    let settings = &found["settings"]["physics_parameters"]["by_hand"];
    assert_eq!(settings["Ixx"], 4.0);
    assert_eq!(settings["tail_wake"], -0.1);
    let applied = entries(&found["physics"]["applied"]);
    assert_eq!(applied.len(), 2);
    assert_eq!(applied[0]["by_hand"], true);
    assert!(found["physics"].get("verdict").is_none());
    assert_eq!(
        found["physics"]["text_block"]
            .as_str()
            .unwrap()
            .lines()
            .count(),
        3
    );
}

#[test]
fn wrong_values_are_refused_with_codes() {
    let desk = Desk::new();
    for (value, code) in [
        ("Iyy=+4%", "unknown-parameter"),
        ("Ixx=4 deg", "parameter-unit"),
        ("Ixx", "wrong-command-line"),
        ("Ixx=nan", "wrong-command-line"),
    ] {
        desk.messages(&line(&["--parameter", value, "--out", "wrong"]))
            .assert_code(code, &[]);
    }
    let twice = ["--parameter", "Ixx=1", "--parameter", "Ixx=2"];
    desk.messages(&line(&[&twice[..], &["--out", "wrong"]].concat()))
        .assert_code("given-twice", &[]);
    assert!(!desk.path("wrong").exists());
}

/// Octave computes `|C (j omega I - A)^-1 B + D|` of the exported models; the program, the response
/// of the moved physics models times the net gains. Delays do not change magnitudes.
#[test]
fn octave_computes_the_responses_of_models_with_moved_parameters() {
    let desk = Desk::new();
    let export = [
        "export",
        DATASET,
        "--points",
        "40",
        "--physics",
        "named",
        "--correction",
        "own",
        "--as",
        "state-space",
        "--out",
        "m.mat",
    ];
    desk.gdcm(&export).assert_done();
    let program = "load m.mat; for m = models, H = m.C * ((3i * eye(size(m.A)) - m.A) \\ m.B) + m.D; \
                   printf('%.17g ', m.condition, abs(H)'); assert(numel(m.contains.physics) == 2); end";
    let Some(found) = octave(&desk, program) else {
        return;
    };
    let mut study = Study::new(load_dataset(Path::new(DATASET)).unwrap().dataset);
    for edit in [
        setting_table::POINTS.to(40_usize),
        setting_table::PHYSICS.to(PhysicsCorrection::Named),
    ] {
        study.apply(&edit).unwrap();
    }
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    let mut expected = Vec::new();
    let mut unmoved = Vec::new();
    for (id, result) in &analysis.conditions {
        let result = result.as_ref().unwrap();
        for (values, condition) in [
            (&mut expected, &result.condition),
            (&mut unmoved, result.file_condition()),
        ] {
            values.push(id.0 as f64);
            let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
            let response = evaluate(nominal.state_space().unwrap(), &[3.0]);
            for (pair, curve) in response.curves().iter() {
                values.push(curve[0].norm() * result.correction.net_gain(pair));
            }
        }
    }
    assert_eq!(found.len(), expected.len());
    let are_near = [&expected, &unmoved].map(|values| {
        let pairs = found.iter().zip(values);
        // Two solutions of the same linear equations, conditioned to about 1e6.
        pairs
            .map(|(a, b)| (a - b).abs() <= 1e-9 * b.abs())
            .collect::<Vec<bool>>()
    });
    assert!(are_near[0].iter().all(|is_near| *is_near));
    let moved = are_near[1].iter().filter(|is_near| !**is_near).count();
    assert!(moved > found.len() / 2, "{moved}");
}
