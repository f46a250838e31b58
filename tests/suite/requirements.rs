//! `gdcm requirements`, through the program itself.

use std::path::Path;

use serde_json::{Value, json};

use crate::commands::Desk;
use crate::entries;

/// The rows of a table, each by its headings.
fn rows(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

#[test]
fn the_embedded_example_has_bandwidths_of_every_role_and_modes_and_costs() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["requirements", "--out", "asked", "--quiet"]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("asked/requirements.json"));
    assert_eq!((&written["format"], &written["version"]), (&json!("gdcm-requirements"), &json!(1)));
    for role in ["physics", "corrected", "scheduled", "identified"] {
        let of_role =
            |finding: &&Value| finding["role"] == role && finding["output"] == "P" && finding["input"] == "LAT";
        let findings: Vec<&Value> = entries(&written["bandwidth"]).iter().filter(of_role).collect();
        assert_eq!(findings.len(), 11, "{role}");
        let known = findings.iter().filter(|finding| finding["omega_bw_rad_s"].as_f64().is_some_and(|bw| bw > 0.0));
        assert!(known.count() > 5, "{role}: {findings:?}");
    }
    assert_eq!(entries(&written["summary"]).len(), 33);
    let costs = |role: &str| -> f64 {
        let of_role = entries(&written["summary"]).iter().filter(|finding| finding["role"] == role);
        of_role.map(|finding| finding["mean_j_on_axis"].as_f64().unwrap()).sum()
    };
    assert!(costs("corrected") < costs("physics"), "a correction lowers J");
    for words in ["Bandwidth", "phase delay [ms]", "MUAD", "no qualification", "requirements.csv in asked"] {
        assert!(ended.out.contains(words), "expected \"{words}\" in:\n{}", ended.out);
    }
    let again = desk.gdcm(&["requirements", "--out", "asked"]);
    again.assert_failed(2, &["requirements.json", "--force"]);
}

#[test]
fn the_json_and_the_csv_of_requirements_say_the_same() {
    let desk = Desk::new();
    assert_eq!(desk.gdcm(&["requirements", "small.json", "--out", "."]).status, 0);
    let written = crate::read_json(&desk.path("requirements.json"));
    let table = rows(&desk.path("requirements.csv"));
    assert!(table.len() > 40, "{table:?}");
    for row in &table {
        let condition = json!(row["condition"].parse::<i64>().unwrap());
        let is_same = |finding: &&Value| finding["condition"] == condition;
        let of_condition = entries(&written[&row["question"]]).iter().filter(is_same);
        let numbers = |finding: &Value| match row["question"].as_str() {
            "modes" => finding[&row["role"]].clone(),
            _ => finding.clone(),
        };
        let is_meant = |finding: &&Value| match row["question"].as_str() {
            "modes" => finding["number"].as_u64() == row["mode"].split(' ').next().and_then(|of| of.parse().ok()),
            "bandwidth" => {
                finding["role"] == row["role"] && finding["output"] == row["output"] && finding["input"] == row["input"]
            }
            _ => finding["role"] == row["role"],
        };
        let found = numbers(of_condition.into_iter().find(is_meant).unwrap());
        let quantity = row["quantity"].as_str();
        assert_eq!(found["model"], row["model"]);
        assert_eq!(found[quantity].as_f64(), row["value"].parse().ok(), "{row:?}");
        if found[quantity].is_null() {
            assert_eq!(found["absent"][quantity], row["remark"], "the reason stands in both: {row:?}");
            assert!(!row["remark"].is_empty());
        }
        let interval = found["interval"].get(quantity).map(|ends| [ends[0].as_f64(), ends[1].as_f64()]);
        assert_eq!(interval.unwrap_or_default(), [row["low"].parse().ok(), row["high"].parse().ok()], "{row:?}");
    }
    for question in ["bandwidth", "modes", "summary"] {
        assert!(table.iter().any(|row| row["question"] == question), "{question}");
    }
}

#[test]
fn a_dataset_without_a_rate_has_words_in_place_of_bandwidths() {
    let desk = Desk::new();
    desk.write("forces.json", |file| {
        for output in file["outputs"].as_array_mut().unwrap() {
            output["unit"] = json!("N");
        }
    });
    let ended = desk.gdcm(&["requirements", "forces.json", "--out", "."]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    let why = "\"P\" in \"N\" has no bandwidth: it is neither a rate (deg/s, rad/s) nor an attitude (deg, rad)";
    for finding in entries(&written["bandwidth"]) {
        assert!(finding["omega_bw_rad_s"].is_null() && finding["phase_delay_s"].is_null());
        let said = finding["absent"]["phase_delay_s"].as_str().unwrap();
        assert!(finding["output"] != "P" || said == why, "{said}");
    }
    assert!(ended.out.contains("has no bandwidth: it is neither a rate"), "{}", ended.out);
}

#[test]
fn what_leads_make_above_the_band_is_refused_and_not_given() {
    let desk = Desk::new();
    // In a band that ends below twice the crossings of half a turn; to 12 rad/s nothing of the example rests on more.
    let ended = desk.gdcm(&["requirements", "--phase", "lead", "--band", "0.5", "5", "--out", ".", "--quiet"]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    let findings = entries(&written["bandwidth"]).iter();
    let reasons = findings.filter_map(|finding| Some((finding["role"].as_str()?, finding["absent"].as_object()?)));
    let refused = reasons.filter(|(_, absent)| {
        absent.values().any(|why| why.as_str().is_some_and(|why| why.starts_with("rests on the leads above the band")))
    });
    let roles: Vec<&str> = refused.map(|(role, _)| role).collect();
    assert!(roles.contains(&"corrected"), "{roles:?}");
    assert!(!roles.contains(&"physics") && !roles.contains(&"identified"), "{roles:?}");
}
