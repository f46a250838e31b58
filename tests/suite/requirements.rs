//! `gdcm requirements` on the command line.

use std::path::Path;

use serde_json::{Value, json};

use gdcm_method::requirements::bandwidth::NoMetric;
use gdcm_study::results::missing_finding::MissingReason;
use gdcm_words::missing_results::missing_reason_text;

use crate::commands::Desk;
use crate::entries;

/// Returns the rows of a CSV table, with cells by heading.
fn rows(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    csv::Reader::from_path(path)
        .unwrap()
        .deserialize()
        .map(Result::unwrap)
        .collect()
}

#[test]
fn the_embedded_example_has_bandwidths_of_every_role_and_modes_and_costs() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["requirements", "--out", "asked", "--quiet"]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("asked/requirements.json"));
    assert_eq!(
        (&written["format"], &written["version"]),
        (&json!("gdcm-requirements"), &json!(1))
    );
    for role in ["physics", "corrected", "scheduled", "identified"] {
        let of_role = |finding: &&Value| {
            finding["role"] == role && finding["output"] == "P" && finding["input"] == "LAT"
        };
        let findings: Vec<&Value> = entries(&written["bandwidth"])
            .iter()
            .filter(of_role)
            .collect();
        assert_eq!(findings.len(), 11, "{role}");
        let known = findings.iter().filter(|finding| {
            finding["omega_bw_rad_s"]
                .as_f64()
                .is_some_and(|bw| bw > 0.0)
        });
        assert!(known.count() > 5, "{role}: {findings:?}");
    }
    assert_eq!(entries(&written["summary"]).len(), 33);
    let costs = |role: &str| -> f64 {
        let of_role = entries(&written["summary"])
            .iter()
            .filter(|finding| finding["role"] == role);
        of_role
            .map(|finding| finding["mean_j_on_axis"].as_f64().unwrap())
            .sum()
    };
    assert!(
        costs("corrected") < costs("physics"),
        "a correction lowers J"
    );
    for words in [
        "Bandwidth",
        "[ms]",
        "MUAD",
        "qualification",
        "requirements.csv",
    ] {
        assert!(
            ended.out.contains(words),
            "expected \"{words}\" in:\n{}",
            ended.out
        );
    }
    let again = desk.gdcm(&["requirements", "--out", "asked"]);
    again.assert_failed(2, &["requirements.json", "--force"]);
}

#[test]
fn the_json_and_the_csv_of_requirements_say_the_same() {
    let desk = Desk::new();
    assert_eq!(
        desk.gdcm(&["requirements", "small.json", "--out", "."])
            .status,
        0
    );
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
            "modes" => {
                finding["number"].as_u64()
                    == row["mode"].split(' ').next().and_then(|of| of.parse().ok())
            }
            "bandwidth" => {
                finding["role"] == row["role"]
                    && finding["output"] == row["output"]
                    && finding["input"] == row["input"]
            }
            _ => finding["role"] == row["role"],
        };
        let found = numbers(of_condition.into_iter().find(is_meant).unwrap());
        let quantity = row["quantity"].as_str();
        assert_eq!(found["model"], row["model"]);
        assert_eq!(
            found[quantity].as_f64(),
            row["value"].parse().ok(),
            "{row:?}"
        );
        if found[quantity].is_null() {
            assert_eq!(
                found["absent"][quantity], row["remark"],
                "the reason stands in both: {row:?}"
            );
            assert!(!row["remark"].is_empty());
        }
        let interval = found["interval"]
            .get(quantity)
            .map(|ends| [ends[0].as_f64(), ends[1].as_f64()]);
        assert_eq!(
            interval.unwrap_or_default(),
            [row["low"].parse().ok(), row["high"].parse().ok()],
            "{row:?}"
        );
    }
    assert_eq!(entries(&written["time_histories"]["records"]).len(), 0);
    let missing = &written["time_histories"]["missing"][0];
    assert_eq!(
        missing["why"],
        missing_reason_text(&MissingReason::NoRecord)
    );
    for question in ["bandwidth", "modes", "summary"] {
        assert!(
            table.iter().any(|row| row["question"] == question),
            "{question}"
        );
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
    let printed = ended.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for finding in entries(&written["bandwidth"]) {
        assert!(finding["omega_bw_rad_s"].is_null() && finding["phase_delay_s"].is_null());
        let said = finding["absent"]["phase_delay_s"].as_str().unwrap();
        let output = finding["output"].as_str().unwrap();
        assert!(
            said.contains(&format!("\"{output}\"")) && said.contains("\"N\""),
            "{said}"
        );
        assert!(printed.contains(said), "{said} in {printed}");
    }
}

#[test]
fn what_leads_make_above_the_band_is_refused_and_not_given() {
    let desk = Desk::with_few();
    // The band ends below twice the frequency of -180 deg. With a band up to 12 rad/s, no value in
    // the example depends on frequencies above the band.
    let ended = desk.gdcm(&[
        "requirements",
        "few.json",
        "--phase",
        "lead",
        "--band",
        "0.5",
        "5",
        "--out",
        ".",
        "--quiet",
    ]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    let findings = entries(&written["bandwidth"]).iter();
    let reasons = findings
        .filter_map(|finding| Some((finding["role"].as_str()?, finding["absent"].as_object()?)));
    // The reasons differ in the frequency that is needed alone, which follows the first colon.
    let reason = NoMetric::AboveBand {
        needed: 10.0,
        top: 5.0,
    }
    .to_string();
    let start = reason.split(':').next().unwrap();
    let refused = reasons.filter(|(_, absent)| {
        absent
            .values()
            .any(|why| why.as_str().is_some_and(|why| why.contains(start)))
    });
    let roles: Vec<&str> = refused.map(|(role, _)| role).collect();
    assert!(roles.contains(&"corrected"), "{roles:?}");
    assert!(
        !roles.contains(&"physics") && !roles.contains(&"identified"),
        "{roles:?}"
    );
}

pub(crate) const RECORDS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/assets/example-records-3-and-10.zip"
);

#[test]
fn the_models_of_the_example_answer_to_its_records_and_the_files_say_the_same() {
    let desk = Desk::with_few();
    let told = desk.messages(&[
        "requirements",
        "few.json",
        "--records",
        RECORDS,
        "--out",
        ".",
        "--phase",
        "lead",
    ]);
    told.assert_success()
        .assert_reported("no-record-of-condition", &["condition 7: "]);
    assert!(told.text.contains("14 CFR part 60"), "{}", told.text);
    let written = crate::read_json(&desk.path("requirements.json"));
    let histories = &written["time_histories"];
    let records = entries(&histories["records"]);
    // Nine records in each of the conditions 3 and 10, four models.
    assert_eq!(records.len(), 72);
    assert!(
        records
            .iter()
            .any(|of| of["held_out"] == true && of["record"] == "cond03_validation")
    );
    let squares = |role: &str| -> f64 {
        let of_role = records
            .iter()
            .filter(|of| of["condition"] == 3 && of["role"] == role);
        of_role
            .map(|of| of["j_rms"].as_f64().unwrap().powi(2))
            .sum()
    };
    let [physics, corrected, identified] = ["physics", "corrected", "identified"].map(squares);
    assert!(
        identified < corrected && corrected < physics,
        "{identified} {corrected} {physics}"
    );
    let sweep = records
        .iter()
        .find(|of| of["record"] == "cond03_sweep_LON_1" && of["role"] == "physics")
        .unwrap();
    assert_eq!(sweep["moved_input"], "LON");
    let pitch = entries(&sweep["tolerances"])
        .iter()
        .find(|of| of["quantity"] == "pitch rate")
        .unwrap();
    assert!(
        pitch["on_axis"] == true
            && pitch["trend"].is_null()
            && pitch["correlation"].as_f64().unwrap() > 0.9
    );

    let table = rows(&desk.path("requirements.csv"));
    let of_histories: Vec<_> = table
        .iter()
        .filter(|row| row["question"] == "time_histories")
        .collect();
    assert!(of_histories.len() > 72 * 40);
    for row in of_histories {
        let is_meant = |of: &&Value| of["record"] == row["record"] && of["role"] == row["role"];
        let finding = records.iter().find(is_meant).unwrap();
        let against = |of: &&Value| of["quantity"] == row["tolerance"];
        let number = match (row["tolerance"].as_str(), row["quantity"].as_str()) {
            ("", "theil") => &finding["theil"][&row["output"]],
            ("", quantity) => &finding[quantity],
            (_, quantity) => &entries(&finding["tolerances"])
                .iter()
                .find(against)
                .unwrap()[quantity],
        };
        assert_eq!(number.as_f64(), row["value"].parse().ok(), "{row:?}");
    }
}

#[test]
fn a_table_of_tolerances_is_written_edited_and_used() {
    let desk = Desk::new();
    desk.gdcm(&["requirements", "--write-tolerances", "mine.json"])
        .assert_done();
    let mut table = crate::read_json(&desk.path("mine.json"));
    assert_eq!(entries(&table["tolerances"]).len(), 9);
    let write = |table: &Value| {
        std::fs::write(desk.path("mine.json"), serde_json::to_vec(table).unwrap()).unwrap()
    };
    table["source"] = json!("ours");
    table["tolerances"].as_array_mut().unwrap().truncate(2);
    table["tolerances"][1]["channel"] = json!("PHI");
    write(&table);
    let ended = desk.gdcm(&[
        "requirements",
        "small.json",
        "--tolerances",
        "mine.json",
        "--out",
        ".",
    ]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    let histories = &written["time_histories"];
    assert_eq!(histories["tolerance_table"]["source"], "ours");
    let said: Vec<&str> = entries(&histories["missing"])
        .iter()
        .map(|of| of["why"].as_str().unwrap())
        .collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert_eq!(said[0], missing_reason_text(&MissingReason::NoRecord));
    assert!(
        said[1].contains("\"bank angle\"") && said[1].contains("\"PHI\""),
        "{said:?}"
    );
    table["tolerances"][0]["absolute"] = json!(-1.0);
    write(&table);
    desk.messages(&[
        "requirements",
        "small.json",
        "--tolerances",
        "mine.json",
        "--out",
        ".",
        "--force",
    ])
    .assert_code(
        "tolerance-not-positive",
        &["mine.json", "1", "\"roll rate\"", "absolute", "-1"],
    );
    let onto_itself = [
        "requirements",
        "--tolerances",
        "small.json",
        "--write-tolerances",
        "small.json",
        "--force",
    ];
    desk.gdcm(&onto_itself).assert_failed(2, &["small.json"]);
    let ended = desk.gdcm(&[
        "requirements",
        "small.json",
        "--records",
        "nothing.csv",
        "--out",
        ".",
        "--force",
    ]);
    ended.assert_failed(2, &["nothing.csv"]);
}

#[test]
fn what_a_stick_commands_is_an_option_and_levels_are_drawn() {
    let desk = Desk::with_few();
    let ended = desk.gdcm(&[
        "requirements",
        "few.json",
        "--attitude-command",
        "P",
        "--out",
        ".",
        "--quiet",
    ]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    assert_eq!(written["attitude_command"], json!(["P"]));
    let findings = entries(&written["bandwidth"]);
    let ruled = |output: &str| -> Vec<&Value> {
        let gain_first = |of: &&Value| of["output"] == output && of["gain_limited"] == true;
        findings
            .iter()
            .filter(gain_first)
            .map(|of| &of["rule"])
            .collect()
    };
    assert!(
        findings
            .iter()
            .filter(|of| of["output"] == "P")
            .all(|of| of["omega_bw_rad_s"] == of["omega_phase_rad_s"])
    );
    assert!(
        ruled("P").iter().all(|rule| **rule == "phase"),
        "of attitude command the phase margin alone"
    );
    // Each interval contains its value, also for substituted models.
    let mut swapped = 0;
    for of in findings.iter().filter(|of| of["role"] == "physics") {
        let bandwidth = &of["omega_bw_rad_s"];
        let ends = &of["interval"]["omega_bw_rad_s"];
        if let (Some(bandwidth), Some(low), Some(high)) =
            (bandwidth.as_f64(), ends[0].as_f64(), ends[1].as_f64())
        {
            assert!(low <= bandwidth && bandwidth <= high && low < high, "{of}");
            swapped += 1;
        }
    }
    assert!(
        swapped > 5,
        "most bandwidths of the example have kept models beside theirs: {swapped}"
    );

    desk.gdcm(&["requirements", "--attitude-command", "X", "--out", "."])
        .assert_failed(2, &["X"]);
    let levels =
        r#"[{"name": "Level 1 of the tests", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#;
    std::fs::write(desk.path("levels.json"), levels).unwrap();
    let figure = [
        "figure",
        "few.json",
        "--view",
        "requirements",
        "--levels",
        "levels.json",
        "--out",
        "levels.svg",
    ];
    desk.gdcm(&figure).assert_done();
    assert!(
        std::fs::read_to_string(desk.path("levels.svg"))
            .unwrap()
            .contains("Level 1 of the tests")
    );
    std::fs::write(desk.path("levels.json"), "[]]").unwrap();
    desk.gdcm(&[
        "figure",
        "--view",
        "requirements",
        "--levels",
        "levels.json",
        "--out",
        "b.svg",
    ])
    .assert_failed(2, &["levels.json"]);
}

#[test]
fn levels_of_the_standard_are_chosen_by_name_and_stand_in_every_result() {
    let desk = Desk::with_few();
    let name = "ads-33e-prf-yaw-other-tasks";
    let ended = desk.gdcm(&["requirements", "few.json", "--levels", name, "--out", "."]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let written = crate::read_json(&desk.path("requirements.json"));
    let boundaries: Value = serde_json::from_str(include_str!(
        "../../assets/levels/ads-33e-prf-yaw-other-tasks.json"
    ))
    .unwrap();
    // The lowest bandwidth of a boundary at a phase delay, by interpolation in this test.
    let least = |level: usize, delay_s: f64| -> f64 {
        let points: Vec<[f64; 2]> =
            serde_json::from_value(boundaries[level - 1]["points"].clone()).unwrap();
        let above = points
            .iter()
            .position(|point| point[1] >= delay_s)
            .unwrap()
            .max(1);
        let [from, to] = [points[above - 1], points[above]];
        from[0] + (to[0] - from[0]) * (delay_s - from[1]) / (to[1] - from[1])
    };
    let mut yaw = 0;
    for finding in entries(&written["bandwidth"]) {
        if finding["output"] != "R" {
            assert!(finding.get("level").is_none(), "{finding}");
            continue;
        }
        let place = ["omega_bw_rad_s", "phase_delay_s"].map(|name| finding[name].as_f64());
        let [Some(omega), Some(delay_s)] = place else {
            continue;
        };
        let expected = if omega >= least(1, delay_s) {
            1
        } else if omega >= least(2, delay_s) {
            2
        } else {
            3
        };
        assert_eq!(finding["level"], json!(expected), "{finding}");
        yaw += 1;
    }
    assert!(yaw > 3, "{yaw}");
    let grid = entries(&written["grid"][0]["rows"]);
    let row = grid
        .iter()
        .find(|row| row["requirement"] == "level")
        .unwrap();
    assert_eq!(
        (&row["output"], &row["input"]),
        (&json!("R"), &json!("PED"))
    );
    let verdicts = entries(&row["verdicts"]);
    assert!(verdicts.iter().any(|verdict| verdict == "met"), "{row}");
    let table = std::fs::read_to_string(desk.path("requirements.csv")).unwrap();
    assert_eq!(table.matches(",level,").count(), yaw);
    assert!(ended.out.contains("Yaw level"), "{}", ended.out);

    // The file of a set is read as the set, under any name, and replaces the levels of its axis.
    desk.gdcm(&[
        "requirements",
        "few.json",
        "--levels",
        name,
        "--write-levels",
        "mine.json",
    ])
    .assert_done();
    let levels = |file: &Value| -> gdcm_method::requirements::LevelBoundaries {
        serde_json::from_value(file.clone()).unwrap()
    };
    let mine = crate::read_json(&desk.path("mine.json"));
    assert_eq!(levels(&mine), levels(&boundaries));
    let both = [
        "--levels",
        "ads-33e-prf-yaw-tracking",
        "--levels",
        "mine.json",
    ];
    let all = [
        &["requirements", "few.json"][..],
        &both,
        &["--write-levels", "both.json"],
    ]
    .concat();
    desk.gdcm(&all).assert_done();
    let both = crate::read_json(&desk.path("both.json"));
    assert_eq!(levels(&both), levels(&boundaries));
    desk.messages(&[
        "requirements",
        "few.json",
        "--levels",
        "ads-33e",
        "--out",
        "x",
    ])
    .assert_code("missing-file", &["ads-33e"]);
}

#[test]
fn what_requirements_are_asked_with_comes_back_with_the_study() {
    use gdcm_study::decisions::requirement_settings::{
        OverviewLimits, RequirementPart, RequirementSettings,
    };
    use gdcm_study::{Edit, Study};
    let desk = Desk::new();
    let loaded = gdcm_io::load_dataset(&desk.path("small.json")).unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    let mut settings = RequirementSettings::clone(&study.requirements);
    let levels = r#"[{"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#;
    settings.levels = serde_json::from_str(levels).unwrap();
    let mut rows = settings.tolerances.rows().to_vec();
    rows[0].absolute = 4.25;
    settings.tolerances = gdcm_method::requirements::ToleranceTable::new("edited", rows).unwrap();
    let mut modes = settings.mode_tolerances.rows().to_vec();
    modes[1].period_s = Some(0.75);
    settings.mode_tolerances = modes.try_into().unwrap();
    settings.overview = OverviewLimits {
        bandwidth: 0.15,
        ..OverviewLimits::default()
    };
    settings.attitude_command.insert("P".to_owned());
    study
        .apply(&Edit::SetRequirements(
            RequirementPart::Levels,
            std::sync::Arc::new(settings),
        ))
        .unwrap();
    let path = desk.path("a.gdcm-study.json");
    gdcm_io::save_study(&study, &loaded, &path).unwrap();
    let opened = gdcm_io::files::study_file::open_study(&path).unwrap();
    assert_eq!(opened.study.requirements, study.requirements);
    // The command reads the tolerances from the study.
    desk.gdcm(&[
        "requirements",
        "a.gdcm-study.json",
        "--write-tolerances",
        "mine.json",
    ])
    .assert_done();
    assert_eq!(
        crate::read_json(&desk.path("mine.json"))["tolerances"][0]["absolute"],
        json!(4.25)
    );
}

#[test]
fn a_record_is_drawn_with_its_corridor_the_difference_and_what_is_outside() {
    fn is_wide(mark: &Mark) -> bool {
        matches!(mark, Mark::Curve(curve) if curve.name == "physics, outside" && curve.key.is_none())
    }

    use gdcm_model::executor::{Executor, Sequential};
    use gdcm_model::progress::Unobserved;
    use gdcm_plot::figure::Mark;
    use gdcm_plot::figure::requirements::record_history_figure;
    use gdcm_study::jobs::job::Job;
    use gdcm_study::jobs::requirement_jobs::RecordHistoryJob;
    use gdcm_study::results::requirement_role::RequirementRole;
    use gdcm_study::results::time_histories::HistoryRecord;
    use gdcm_study::{Engine, Study};
    let dataset = crate::FEW.dataset.clone();
    let analysis = Engine::default()
        .analyze(&Study::new(dataset.clone()), &Unobserved)
        .unwrap();
    let channels = gdcm_sysid::records::RecordChannels::of_dataset(&dataset).of_named_records();
    let table = gdcm_io::import::record_files::example_records(gdcm_io::Example::Simulated, 3)
        .unwrap()
        .remove(0);
    let record =
        gdcm_sysid::records::LaidOutRecord::proposed(table, &channels, &Default::default()).0;
    let flight = std::sync::Arc::clone(record.used_flight().unwrap());
    let (inputs, outputs) = dataset.input_and_output_names();
    let [inputs, outputs]: [Vec<&str>; 2] =
        [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
    let job = RecordHistoryJob {
        tolerances: analysis.study.requirements.tolerances.clone(),
        analysis: std::sync::Arc::new(analysis).into(),
        condition: gdcm_model::dataset::ConditionId(3),
        record: HistoryRecord {
            flight: flight.into(),
            held_out: false,
        },
        preparation: gdcm_sysid::identification::Preparation::new(&inputs, &outputs),
    };
    let mut executor: Box<dyn Executor> = Box::new(Sequential);
    let history = job.run(&mut executor, &Unobserved).unwrap().unwrap();
    let figure = record_history_figure(&history, &dataset, 0);
    assert_eq!(figure.plots.len(), 1 + history.quantities.len());
    for (plot, of) in figure.plots[1..].iter().zip(&history.quantities) {
        assert_eq!(
            plot.panels.len(),
            2,
            "the record above what is left of it less flight"
        );
        let starts: Vec<Vec<f64>> = of
            .models
            .iter()
            .map(|(_, check)| check.windows.iter().map(|window| window.start_s).collect())
            .collect();
        assert!(
            starts.windows(2).all(|pair| pair[0] == pair[1]),
            "all models in the same windows: {starts:?}"
        );
        let (_, physics) = of
            .models
            .iter()
            .find(|(role, _)| *role == RequirementRole::Physics)
            .unwrap();
        for (panel, is_difference) in plot.panels.iter().zip([false, true]) {
            let corridor = panel.marks.iter().find_map(|mark| {
                if let Mark::Envelope(of) = mark {
                    Some(of)
                } else {
                    None
                }
            });
            let [_, low, high] = corridor.unwrap().points[0];
            let flown = physics.windows[0].flown[0];
            let width = physics.windows[0].width[0];
            let middle = if is_difference { 0.0 } else { flown };
            assert!(
                (low - (middle - width)).abs() < 1e-12 && (high - (middle + width)).abs() < 1e-12
            );
            assert_eq!(
                panel.marks.iter().any(is_wide),
                physics.share_inside() < 1.0,
                "{}",
                plot.title
            );
        }
    }
}
