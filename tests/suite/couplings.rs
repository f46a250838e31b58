//! Mixing and feedback on the command line: printed text and files (M16).

use std::fs;

use serde_json::Value;

use crate::commands::Desk;
use crate::exports::octave;
use crate::{entries, read_json};

const COUPLED: [&str; 4] = ["--phase", "lead", "--couplings", "feedback"];

fn row_numbers(row: &Value) -> Vec<f64> {
    let values = entries(row).iter();
    values.map(|value| value.as_f64().unwrap()).collect()
}

fn numbers(rows: &Value) -> Vec<Vec<f64>> {
    entries(rows).iter().map(row_numbers).collect()
}

#[test]
fn analyze_says_what_couplings_mean_are_worth_and_cost_and_writes_them() {
    let desk = Desk::new();
    let told = desk.messages(&[&["analyze", "--out", "with"], &COUPLED[..]].concat());
    told.assert_success().assert_reported("newly-unstable", &[]);
    for words in [
        "11 conditions",
        "LAT receives 3.9 %",
        "left out",
        "swashplate phase",
        "at 120 rad/s, ",
    ] {
        assert!(told.text.contains(words), "{words}: {}", told.text);
    }
    let found = read_json(&desk.path("with/corrections.json"));
    assert_eq!(found["settings"]["couplings"], "feedback");
    let of = &found["couplings"];
    let condition = &found["conditions"][9]["couplings"];
    let feedback = numbers(&of["feedback"]);
    let deviations = numbers(&of["feedback_sd"]);
    assert_eq!((feedback.len(), feedback[0].len()), (4, 6));
    assert!(
        deviations
            .iter()
            .flatten()
            .all(|deviation| *deviation > 0.0)
    );
    let left_out = &of["left_out"];
    assert!(
        left_out["others"].as_f64() < left_out["without_others"].as_f64(),
        "{left_out}"
    );
    assert!(of["residual"].as_f64().unwrap() < 1e-12);
    let mixing = numbers(&condition["mixing"]);
    assert!(
        (0..4).all(|input| mixing[input][input] == 1.0) && (0.03..0.07).contains(&mixing[1][0]),
        "{mixing:?}"
    );
    assert!(condition["least_singular_value"]["value"].as_f64().unwrap() > 0.5);
    assert!(
        entries(&condition["poles_moved"])
            .iter()
            .any(|of| of["before_real_rad_s"] != of["after_real_rad_s"])
    );
    let table = fs::read_to_string(desk.path("with/corrections.csv")).unwrap();
    let mut lines = table.lines();
    assert!(lines.next().unwrap().ends_with(",mixing_LON,mixing_LAT,mixing_PED,mixing_COL,feedback_P,feedback_Q,feedback_R,feedback_NX,feedback_NY,feedback_NZ"));
    let cells: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(cells[cells.len() - 6].parse(), Ok(feedback[0][0]));

    desk.gdcm(&["analyze", "--phase", "lead", "--out", "without"])
        .assert_done();
    let without = read_json(&desk.path("without/corrections.json"));
    assert!(without.get("couplings").is_none() && without["settings"].get("couplings").is_none());
    assert!(
        !fs::read_to_string(desk.path("without/corrections.csv"))
            .unwrap()
            .contains("mixing_")
    );
    assert_ne!(without["conditions"][9]["G"], found["conditions"][9]["G"]);
    assert_eq!(
        without["conditions"][9]["physics_representative"],
        found["conditions"][9]["physics_representative"]
    );
}

#[test]
#[ignore = "runs another program: 18 s"]
fn octave_closes_the_loop_of_an_exported_function_as_state_space_has_it() {
    let desk = Desk::new();
    let feedback = ["--couplings", "feedback"];
    for (format, name, words) in [
        (
            "m",
            "my_study.m",
            "mixing, feedback] = my_study(airspeed_kt, D)",
        ),
        ("table-csv", "t.csv", "mixing of input LAT from LON [-]"),
    ] {
        exported(&desk, format, name, &feedback);
        assert!(
            desk.read(name).contains(words),
            "{name}: {}",
            desk.read(name)
        );
    }
    assert!(
        desk.read("t.csv").contains("# feedback to input PED: P "),
        "{}",
        desk.read("t.csv")
    );
    exported(&desk, "table-mat", "t.mat", &feedback);
    exported(&desk, "mat", "c.mat", &feedback);
    let one = ["--condition", "7", "--couplings"];
    let said = exported(
        &desk,
        "state-space",
        "with.mat",
        &[&one[..], &["feedback"]].concat(),
    );
    assert!(said.contains("couplings scheduled"), "{said}");
    exported(
        &desk,
        "state-space",
        "plain.mat",
        &[&one[..], &["none"]].concat(),
    );
    exported(&desk, "m", "plain_gains.m", &["--couplings", "none"]);
    // Closes the loop of the exported function around the plain model, including its feed-through,
    // and compares the result with the exported matrices.
    let program = "load with.mat; w = models; load plain.mat; p = models; w3 = 3i * eye(size(w.A)); p3 = 3i * eye(size(p.A)); \
        [Mi, Mo, ~, ~] = plain_gains(w.airspeed_kt); \
        h = Mo \\ (p.C * ((p3 - p.A) \\ p.B) + p.D) / Mi; d = Mo \\ p.D / Mi; \
        [Mi, Mo, ~, ~, m, k] = my_study(w.airspeed_kt); [~, ~, ~, ~, ~, f] = my_study(w.airspeed_kt, d); \
        u2 = eye(4) - f * (h - d); u2 = u2 \\ ((eye(4) + f * d) * m); \
        found = Mo * h * u2 * Mi; expected = w.C * ((w3 - w.A) \\ w.B) + w.D; \
        direct = Mo * ((eye(6) - h * k) \\ (h * m)) * Mi; \
        load c.mat; load t.mat; c = corrections.couplings; \
        assert(isequal(size(c.feedback), [4, 6]) && isequal(c.feedback, gdcm_table.feedback)); \
        printf('%.17g ', max(abs(found - expected)(:)) / max(abs(expected)(:)), \
               max(abs(direct - expected)(:)) / max(abs(expected)(:)), max(abs(k - c.feedback)(:)));";
    let Some(found) = octave(&desk, program) else {
        return;
    };
    assert!(
        found[0] < 1e-9 && found[1] < 1e-9 && found[2] < 1e-15,
        "{found:?}"
    );
}

#[test]
fn a_schedule_over_airspeed_and_altitude_has_its_couplings_beside_it() {
    let desk = Desk::new();
    let chosen = [&COUPLED[..], &["--second-variable", "altitude"]].concat();
    desk.gdcm(&[&["analyze", "--out", "."], &chosen[..]].concat())
        .assert_done();
    desk.gdcm(&[&["export", "--as", "m", "--out", "two.m"], &chosen[..]].concat())
        .assert_done();
    let found = read_json(&desk.path("corrections.json"));
    let condition = &found["conditions"][6];
    let program = format!(
        "[low, ~, ~, ~, ~, ~, m, k] = two({0}, 2000); [high, ~, ~, ~, ~, ~, n, l] = two({0}, 8000); \
         printf('%.17g ', max(abs(low - high)(:)), isequal(m, n) && isequal(k, l), m', k');",
        condition["airspeed_kt"]
    );
    let Some(values) = octave(&desk, &program) else {
        return;
    };
    assert!(
        values[0] > 1e-3 && values[1] == 1.0,
        "gains depend on the altitude, couplings do not: {values:?}"
    );
    let rows = [
        numbers(&condition["couplings"]["mixing"]),
        numbers(&found["couplings"]["feedback"]),
    ]
    .concat();
    let expected: Vec<f64> = rows.into_iter().flatten().collect();
    assert_eq!(values.len(), 2 + expected.len());
    // The coefficients are printed with seventeen digits.
    assert!(
        values[2..]
            .iter()
            .zip(&expected)
            .all(|(a, b)| (a - b).abs() < 1e-12),
        "{values:?} {expected:?}"
    );
}

#[test]
fn couplings_that_nothing_can_be_fitted_to_are_told_in_words() {
    let desk = Desk::with_few();
    let ids: Vec<String> = crate::FEW
        .dataset
        .conditions()
        .iter()
        .map(|of| of.id().to_string())
        .collect();
    let held_out: Vec<&str> = ids[1..]
        .iter()
        .flat_map(|id| ["--hold-out", id.as_str()])
        .collect();
    desk.messages(
        &[
            &["analyze", "few.json", "--out", "one"],
            &COUPLED[..],
            &held_out[..],
        ]
        .concat(),
    )
    .assert_success()
    .assert_reported("few-conditions", &["1 condition"]);
    // Without the requested couplings, models must not be exported.
    let all: Vec<&str> = ids
        .iter()
        .flat_map(|id| ["--hold-out", id.as_str()])
        .collect();
    let export = [
        "export",
        "few.json",
        "--as",
        "state-space",
        "--correction",
        "own",
        "--out",
        "own.mat",
    ];
    desk.messages(&[&export[..], &COUPLED[..], &all[..]].concat())
        .assert_code("no-couplings", &[]);
    assert!(!desk.path("own.mat").exists());
    let wrong = desk.gdcm(&["analyze", "--out", "none", "--couplings", "all"]);
    assert_eq!(wrong.status, 2);
    assert!(wrong.error.contains("feedback"), "{}", wrong.error);
}

#[test]
fn the_report_has_a_section_on_couplings() {
    let desk = Desk::with_few();
    desk.gdcm(&[&["report", "few.json", "--out", "r.html"], &COUPLED[..]].concat())
        .assert_done();
    let page = fs::read_to_string(desk.path("r.html")).unwrap();
    for words in [
        "Couplings</h",
        "swashplate",
        "Feedback: units of an input",
        "Poles of the physics representatives",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn a_figure_shows_the_poles_of_the_condition_that_is_asked_for() {
    let desk = Desk::with_few();
    let figure = [
        "figure",
        "few.json",
        "--view",
        "couplings",
        "--condition",
        "3",
        "--out",
        "couplings.svg",
    ];
    desk.gdcm(&[&figure[..], &COUPLED[..]].concat())
        .assert_done();
    let text = fs::read_to_string(desk.path("couplings.svg")).unwrap();
    assert!(text.contains("Poles of condition 3") && text.contains("close to ringing"));
}

/// Exports the example without phase correction, and returns the printed text.
fn exported(desk: &Desk, format: &str, name: &str, more: &[&str]) -> String {
    let line = ["export", "--as", format, "--out", name, "--phase", "none"];
    let ended = desk.run(&line, more);
    ended.assert_done();
    ended.out
}
