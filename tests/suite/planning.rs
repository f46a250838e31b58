//! `gdcm plan`: tables of predicted intervals, ways to a target, refusals.

use std::f64::consts::TAU;
use std::fs;

use crate::commands::Desk;
use crate::{entries, read_json};

/// Options of the channels and the band.
const CHANNELS: [&str; 7] = [
    "--inputs",
    "LAT,PED",
    "--outputs",
    "P,R",
    "--band",
    "0.8",
    "10",
];

/// Returns a directory with a one-minute sweep of each input of an aircraft with lags in roll and
/// yaw, which affect each other.
fn desk() -> Desk {
    let desk = Desk::new();
    for (swept, name) in ["lat.csv", "ped.csv"].into_iter().enumerate() {
        fs::write(desk.path(name), sweep(swept)).unwrap();
    }
    desk
}

/// Simulates a sweep at 50 Hz; the other input and the outputs have noise.
fn sweep(swept: usize) -> String {
    let mut state = 12_345 + swept as u32;
    let mut noise = || {
        let mut sum = 0.0;
        for _ in 0..6 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            sum += f64::from(state) / f64::from(u32::MAX) - 0.5;
        }
        sum
    };
    let growth = 32_f64.ln() / 60.0;
    let mut text = "t,LAT [%],PED [%],P [deg/s],R [deg/s]\n".to_owned();
    let [mut p, mut r] = [0.0, 0.0];
    for k in 0..3000 {
        let time = 0.02 * f64::from(k);
        let turns = 0.08 / growth * ((growth * time).exp() - 1.0);
        let mut inputs = [0.05 * noise(), 0.05 * noise()];
        inputs[swept] += 4.0 * (TAU * turns).sin();
        text += &format!(
            "{time:.2},{:.4},{:.4},{:.4},{:.4}\n",
            inputs[0],
            inputs[1],
            p + 0.3 * noise(),
            r + 0.3 * noise()
        );
        let [before_p, before_r] = [p, r];
        p += 0.02 * (-2.5 * before_p + 0.5 * before_r + 4.0 * inputs[0] + 0.8 * inputs[1]);
        r += 0.02 * (-0.3 * before_p - 1.2 * before_r + 0.5 * inputs[0] + 2.0 * inputs[1]);
    }
    text
}

#[test]
fn a_plan_has_a_table_for_each_input_and_the_ways_to_each_target() {
    let desk = desk();
    let line = [
        "plan",
        "lat.csv",
        "ped.csv",
        "--out",
        "plan.json",
        "--target",
        "P/LAT@1=0.001",
    ];
    let ended = desk.run(&line, &CHANNELS);
    assert_eq!(ended.status, 0, "{ended:?}");
    for words in ["LAT → P", "PED → R", "after 4 sweeps", " 16 "] {
        assert!(ended.out.contains(words), "{words}: {}", ended.out);
    }
    let file = read_json(&desk.path("plan.json"));
    assert_eq!(
        (&file["format"], &file["version"]),
        (&"gdcm-plan".into(), &1.into())
    );
    let plan = &file["plans"][0];
    assert!(plan["condition"].is_null());
    assert_eq!(entries(&plan["sweeps"]).len(), 2);
    for sweep in entries(&plan["sweeps"]) {
        // As flown: 4 %, about a minute.
        let amplitude = sweep["sweep"]["amplitude"].as_f64().unwrap();
        assert!((3.0..5.0).contains(&amplitude), "{amplitude}");
        assert_eq!(sweep["sweep"]["amplitude_is_assumed"], false);
        for response in entries(&sweep["responses"]) {
            let mut before = response["now"]["half_width_db"].as_f64().unwrap();
            for after in entries(&response["after"]) {
                let half_width = after["half_width_db"].as_f64().unwrap();
                assert!(half_width < before, "{response}");
                before = half_width;
            }
        }
    }
    let target = &plan["targets"][0];
    assert_eq!(target["pair"], serde_json::json!(["P", "LAT"]));
    assert_eq!(target["ways"]["repeats"]["reached"], false);
    assert_eq!(target["ways"]["repeats"]["amount"], 16);
}

#[test]
fn a_larger_amplitude_needs_fewer_sweeps() {
    let desk = desk();
    let needed = |amplitude: &str| {
        let name = format!("plan-{amplitude}.json");
        let line = [
            "plan",
            "lat.csv",
            "ped.csv",
            "--out",
            &name,
            "--repeats",
            "100",
        ];
        let wanted = ["--target", "R/PED@2=0.03", "--amplitude", amplitude];
        let ended = desk.run(&[&line[..], &wanted].concat(), &CHANNELS);
        assert_eq!(ended.status, 0, "{ended:?}");
        let file = read_json(&desk.path(&name));
        let target = &file["plans"][0]["targets"][0];
        (
            target["now"]["half_width_db"].as_f64().unwrap(),
            target["ways"]["repeats"]["amount"].as_u64(),
        )
    };
    let (now, few) = needed("PED=8");
    assert!(now > 0.03, "the target is not reached now: {now}");
    let (_, many) = needed("PED=4");
    assert!(few < many, "{few:?} {many:?}");
}

#[test]
fn wrong_options_of_a_plan_are_refused_before_the_identification() {
    let desk = desk();
    let refusal =
        |more: &[&str]| desk.messages(&[&["plan", "lat.csv"], &CHANNELS[..], more].concat());
    refusal(&["--target", "Q/LAT@1=0.5"]).assert_code("unknown-response", &["--target", "Q/LAT"]);
    refusal(&["--amplitude", "COL=5"]).assert_code("unknown-channel", &["--amplitude", "COL"]);
    refusal(&["--amplitude", "PED=5", "--amplitude", "PED=6"])
        .assert_code("given-twice", &["--amplitude", "PED"]);
    refusal(&["--sweep-band", "5", "2"]).assert_code("wrong-option", &["--sweep-band"]);
    refusal(&["--target", "P/LAT@50=0.5"]).assert_code("wrong-option", &["--target", "50"]);
    fs::write(desk.path("there.json"), "").unwrap();
    let exists = refusal(&["--out", "there.json"]);
    exists.assert_code("output-exists", &["there.json"]);
}
