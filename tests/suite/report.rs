//! The report of a study.

use std::collections::BTreeSet;
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

use roxmltree::{Document, Node, ParsingOptions};
use serde_json::{Value, json};

use gdcm_io::import::record_files::example_records;
use gdcm_io::report::{ReportSource, ReportSubject, report};
use gdcm_io::{load_dataset, save_study};
use gdcm_method::requirements::ToleranceTable;
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};
use gdcm_model::progress::{Cancelled, Progress, Unobserved};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::record_simulations::time_histories_of;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_study::results::verdict::PhaseVerdict;
use gdcm_study::{Analysis, Edit, Engine, Execution, Study};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, TimeSettings};
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::remark::remark_text;
use gdcm_words::requirements::summary_table;
use gdcm_words::time_histories::{record_table, share_table};
use gdcm_words::verdict::phase_verdict_text;

use crate::commands::Desk;
use crate::window::{click, few_window, settle, state};
use crate::{EXAMPLE, FEW};

const SECTIONS: [&str; 16] = [
    "1 Verdict",
    "2 Schedule over airspeed",
    "3 Conditions",
    "4 Assessment",
    "5 Uncertainty",
    "6 Requirements",
    "7 Models left out",
    "8 Settings",
    "9 Provenance",
    "A Details of the conditions",
    "B Gains and delays of the channels, by condition",
    "C Details of the assessment",
    "D Details of the uncertainty",
    "E Details of the requirements",
    "F The method",
    "G Sources of the models",
];
const REASON: &str = "steps at 2 rad/s <see the & bode plot>";

/// A few conditions of the example, with the nominal model in condition 10 rejected for a reason.
static ANALYSIS: LazyLock<Analysis> = LazyLock::new(|| {
    let mut study = Study::new(FEW.dataset.clone());
    let model = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
    study
        .apply(&Edit::RejectBecause {
            model,
            reason: REASON.to_owned(),
        })
        .unwrap();
    Engine::default().analyze(&study, &Unobserved).unwrap()
});

static REPORT: LazyLock<String> = LazyLock::new(|| {
    report(
        without_records(&ANALYSIS),
        &ReportSource::from_files(&FEW, None),
        &mut Engine::default(),
        &Unobserved,
    )
    .unwrap()
});

fn without_records(analysis: &Analysis) -> ReportSubject<'_> {
    static NOTHING: LazyLock<IdentifiedPoles> = LazyLock::new(IdentifiedPoles::default);
    ReportSubject {
        analysis,
        histories: None,
        known: &NOTHING,
    }
}

/// Parses the page as XML; its document type is HTML, without a reference to another file.
fn parsed(text: &str) -> Document<'_> {
    Document::parse_with_options(
        text,
        ParsingOptions {
            allow_dtd: true,
            ..ParsingOptions::default()
        },
    )
    .unwrap()
}

fn texts<'t>(document: &Document<'t>, tag: &str) -> Vec<String> {
    let all_words = |node: Node<'_, '_>| {
        node.descendants()
            .filter_map(|of| of.text().filter(|_| of.is_text()))
            .collect()
    };
    document
        .descendants()
        .filter(|node| node.has_tag_name(tag))
        .map(all_words)
        .collect()
}

#[test]
fn the_report_of_the_example_has_every_section_and_every_condition() {
    let document = parsed(&REPORT);
    let mut sections = texts(&document, "h2");
    assert_eq!(sections.remove(1), "Contents", "after the first page");
    assert_eq!(sections, SECTIONS);
    let parts = texts(&document, "h3");
    for condition in FEW.dataset.conditions() {
        let heading = format!(
            "Condition {}: {}",
            condition.id(),
            condition.flight_state().name
        );
        assert!(
            parts.iter().any(|part| part.ends_with(&heading)),
            "{heading} in {parts:?}"
        );
    }
    let figures = texts(&document, "figcaption");
    for condition in FEW.dataset.conditions() {
        let caption = format!(
            "Condition {}: {}.",
            condition.id(),
            condition.flight_state().name
        );
        assert!(
            figures.iter().any(|figure| figure.ends_with(&caption)),
            "{caption} in {figures:?}"
        );
    }
    for words in [
        "difference between identified and physics models",
        "magnitude of every response",
        "poles of its models",
    ] {
        let of = figures
            .iter()
            .filter(|caption| caption.contains(words))
            .count();
        assert_eq!(of, FEW.dataset.conditions().len(), "{words}");
    }
    for words in [
        "Gains of the inputs over conditions",
        "Delays of the outputs over conditions",
        "Net gains against airspeed",
        "Change of J of on-axis responses",
        "Change of J of off-axis responses",
    ] {
        assert!(
            figures.iter().any(|caption| caption.contains(words)),
            "{words} in {figures:?}"
        );
    }
}

/// The first page: verdict, corrections of every condition, signatures; then the contents.
#[test]
fn page_one_has_the_verdict_the_corrections_and_the_signatures() {
    let first = REPORT.split("<nav").next().unwrap();
    assert!(first.contains(&gdcm_words::verdict::study_verdict_text(&ANALYSIS)[1..]));
    let document = parsed(&REPORT);
    let cells = texts(&document, "td");
    for condition in FEW.dataset.conditions() {
        let result = ANALYSIS.condition(condition.id()).unwrap();
        let phase = PhaseVerdict::new(&ANALYSIS.study, result);
        let phase = phase_verdict_text(phase, &ANALYSIS.study);
        let state = condition.flight_state();
        let name = format!("{}: {} kt", state.id, state.airspeed_kt);
        let row = cells.iter().position(|cell| *cell == name).unwrap();
        assert_eq!(cells[row + 1..row + 3], ["5 of 5".to_owned(), phase]);
        let pair = FEW.dataset.on_axis().marked().next().unwrap();
        let net_gain = format!("{:.3} \u{b1} ", result.correction.net_gain(pair));
        assert!(cells[row + 3].starts_with(&net_gain), "{}", cells[row + 3]);
        assert!(first.contains(&name));
    }
    for role in ["Prepared by", "Checked by", "Approved by"] {
        assert!(first.contains(role), "{role}");
    }
    assert_eq!(REPORT.matches("<nav").count(), 1);
}

/// A figure is at most a quarter of a page high, so that the length stays in proportion; figures with
/// a row of plots for each output may take a third, because flatter plots cannot be read.
#[test]
fn four_figures_fit_on_a_page() {
    // Letter paper, 279 mm, less the margins of 30 mm and a caption for each figure.
    const PAGE_MM: f64 = 249.0;
    const CAPTION_MM: f64 = 9.0;
    let document = parsed(&REPORT);
    let mut heights = Vec::new();
    for svg in document
        .descendants()
        .filter(|node| node.has_tag_name("svg"))
    {
        let height: f64 = svg
            .attribute("height")
            .and_then(|height| height.trim_end_matches("mm").parse().ok())
            .expect("a figure has a height in mm");
        heights.push(height);
    }
    let quarters = heights
        .iter()
        .filter(|height| **height <= PAGE_MM / 4.0 - CAPTION_MM)
        .count();
    assert!(heights.len() > 15, "{heights:?}");
    assert!(
        heights
            .iter()
            .all(|height| *height <= PAGE_MM / 3.0 - CAPTION_MM),
        "{heights:?}"
    );
    assert!(4 * quarters >= 3 * heights.len(), "{heights:?}");
}

#[test]
fn requirements_are_those_of_the_command_and_time_histories_stand_where_there_are_records() {
    let engine = &mut Engine::default();
    let uncertainty = Some(Arc::new(
        engine.uncertainty(&ANALYSIS, &Unobserved).unwrap(),
    ));
    let analysis = Analysis {
        uncertainty,
        ..ANALYSIS.clone()
    };
    let requirements = engine
        .requirements(&analysis, &IdentifiedPoles::default(), &Unobserved)
        .unwrap();
    let cells = texts(&parsed(&REPORT), "td");
    for row in summary_table(&requirements, None).rows {
        assert!(cells.windows(row.len()).any(|of| *of == row), "{row:?}");
    }
    let known = requirements
        .bandwidth
        .iter()
        .find(|of| of.omega_bw_rad_s.is_some())
        .unwrap();
    let bandwidth = format!("{:.2}", known.omega_bw_rad_s.unwrap());
    assert!(cells.contains(&bandwidth) && REPORT.contains("qualification"));
    assert!(!REPORT.contains("J_rms"), "no record was given");

    let channels = RecordChannels::of_dataset(&FEW.dataset).of_named_records();
    let tables = example_records(gdcm_io::Example::Simulated, 3)
        .unwrap()
        .into_iter()
        .take(1);
    let proposed = |table| LaidOutRecord::proposed(table, &channels, &TimeSettings::default()).0;
    let records: Vec<LaidOutRecord> = tables.map(proposed).collect();
    let (inputs, outputs) = FEW.dataset.input_and_output_names();
    let [inputs, outputs]: [Vec<&str>; 2] =
        [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
    let records = [HistoryRecords::from_used(
        ConditionId(3),
        &records,
        Preparation::new(&inputs, &outputs),
    )];
    let table = ToleranceTable::default();
    let histories =
        time_histories_of(&analysis, &records, &table, &Execution::sequential()).unwrap();
    let source = ReportSource::from_files(&FEW, None);
    let subject = ReportSubject {
        histories: Some(&histories),
        ..without_records(&analysis)
    };
    let report = report(subject, &source, engine, &Unobserved).unwrap();
    let cells = texts(&parsed(&report), "td");
    let of_records = record_table(&histories, ConditionId(3));
    assert!(
        !of_records.rows.is_empty(),
        "the physics model leaves some corridor"
    );
    for row in share_table(&histories)
        .rows
        .into_iter()
        .chain(of_records.rows)
    {
        assert!(cells.windows(row.len()).any(|of| *of == row), "{row:?}");
    }
    let rms = histories
        .j_rms(ConditionId(3), RequirementRole::Identified)
        .unwrap();
    assert!(cells.contains(&format!("{rms:.2}")) && report.contains("J_rms"));
    let without: Vec<_> = histories
        .missing
        .iter()
        .filter(|finding| finding.why.code() == "no-record-of-condition")
        .filter_map(|finding| finding.condition)
        .collect();
    assert_eq!(without, [ConditionId(7), ConditionId(10)]);
    assert!(report.contains("Conditions 7, 10: "));
}

#[test]
fn a_rejected_model_stands_with_the_words_that_the_analyst_typed() {
    let document = parsed(&REPORT);
    let cells = texts(&document, "td");
    let place = cells
        .iter()
        .position(|cell| cell == REASON)
        .expect("the reason is there");
    assert_eq!(cells[place - 4..place - 1], ["10", "physics", "nominal"]);
    let left_out = ANALYSIS.assessment[&ConditionId(10)].as_ref().unwrap_err();
    assert_eq!(left_out.code(), "nominal-rejected");
    assert!(REPORT.contains(&not_assessed_text(left_out, &FEW.dataset)));
    let shown = ANALYSIS.condition(ConditionId(10)).unwrap();
    let remarks = condition_remarks(&ANALYSIS.study, shown, None);
    let lead = remarks
        .iter()
        .find(|remark| remark.code() == "needs-lead")
        .expect("a delay cannot provide the phase");
    let words = remark_text(lead, &FEW.dataset);
    assert!(REPORT.contains(&words), "{words}");
    assert!(REPORT.contains(&FEW.sha256) && REPORT.contains(&gdcm_io::software::software()));
}

#[test]
fn a_report_runs_nothing_and_loads_nothing() {
    let document = parsed(&REPORT);
    for tag in ["script", "img", "link", "iframe", "object", "image", "use"] {
        assert_eq!(texts(&document, tag), [""; 0], "{tag}");
    }
    assert!(!REPORT.contains("http:") && !REPORT.contains("https:") && !REPORT.contains("@import"));
    let attributes = document.descendants().flat_map(|node| node.attributes());
    for attribute in attributes {
        let value = attribute.value();
        match attribute.name() {
            "href" => assert!(value.starts_with('#'), "{value}"),
            "clip-path" => assert!(value.starts_with("url(#"), "{value}"),
            name => assert!(!name.starts_with("on") && name != "src", "{name}"),
        }
    }
}

#[test]
fn every_link_and_every_name_within_a_report_leads_to_one_place() {
    let document = parsed(&REPORT);
    let ids: Vec<&str> = document
        .descendants()
        .filter_map(|node| node.attribute("id"))
        .collect();
    let different: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(different.len(), ids.len());
    let links = document
        .descendants()
        .filter_map(|node| node.attribute("href"))
        .map(|link| &link[1..]);
    let clips = document
        .descendants()
        .filter_map(|node| node.attribute("clip-path"));
    let referred =
        links.chain(clips.map(|clip| clip.trim_start_matches("url(#").trim_end_matches(')')));
    let missing: Vec<&str> = referred.filter(|name| !different.contains(name)).collect();
    assert_eq!(missing, [""; 0]);
}

#[test]
fn the_same_study_makes_the_same_bytes() {
    fn again() -> String {
        let analysis = Engine::default()
            .analyze(&Study::new(FEW.dataset.clone()), &Unobserved)
            .unwrap();
        report(
            without_records(&analysis),
            &ReportSource::from_files(&FEW, None),
            &mut Engine::default(),
            &Unobserved,
        )
        .unwrap()
    }

    assert!(again() == again());
}

#[test]
#[ignore = "eleven conditions; three are enough by default"]
fn the_report_of_the_whole_example_is_not_too_long() {
    let analysis = Engine::default()
        .analyze(&Study::new(EXAMPLE.dataset.clone()), &Unobserved)
        .unwrap();
    let source = ReportSource::from_files(&EXAMPLE, None);
    let text = report(
        without_records(&analysis),
        &source,
        &mut Engine::default(),
        &Unobserved,
    )
    .unwrap();
    assert!(text.len() < 15_000_000, "{} bytes", text.len());
}

/// Progress that cancels the work after this number of conditions.
struct Impatient(AtomicUsize);

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }

    fn advanced(&self, done: usize, total: usize) {
        assert_eq!(total, FEW.dataset.conditions().len());
        self.0
            .store(2_usize.saturating_sub(done), Ordering::Relaxed);
    }
}

#[test]
fn a_report_that_is_not_wanted_any_more_is_given_up() {
    let impatient = Impatient(AtomicUsize::new(2));
    let source = ReportSource::from_files(&FEW, None);
    assert_eq!(
        report(
            without_records(&ANALYSIS),
            &source,
            &mut Engine::default(),
            &impatient
        ),
        Err(Cancelled)
    );
}

/// Writes the small dataset with names that contain markup, and with a condition that has no
/// result.
fn write_odd(desk: &Desk) {
    desk.write("odd.json", |file| {
        file["name"] = json!("<script>alert(\"1\")</script> & co\u{1b}[2J");
        file["conditions"][0]["physics_models"][1]["name"] = json!("</td><b>&'\"\u{202e}");
        let model = &mut file["conditions"][1]["physics_models"][0];
        model["B"] = json!([[0, 0], [0, 0]]);
        model["D"] = json!([[0, 0], [0, 0]]);
        let source: Value =
            json!({"file": "models/<a>.mat", "sha256": "c0ffee", "made": "2026-03-01"});
        file["conditions"][0]["physics_models"][0]["source"] = source;
    });
}

#[test]
fn names_that_are_markup_stay_names_and_a_condition_without_result_says_why() {
    let desk = Desk::new();
    write_odd(&desk);
    let told = desk.messages(&["report", "odd.json", "--out", "report.html"]);
    told.assert_success();
    assert!(told.text.starts_with("report.html: "), "{told:?}");
    let failed: Vec<_> = told.of_code("nothing-to-compare").collect();
    assert!(
        failed.len() == 1 && failed[0].conditions == [10],
        "{told:?}"
    );
    let text = fs::read_to_string(desk.path("report.html")).unwrap();
    assert!(!text.contains("<script") && !text.contains('\u{1b}') && !text.contains('\u{202e}'));
    let document = parsed(&text);
    assert!(texts(&document, "h1")[0].contains("<script>alert(\"1\")</script> & co\\u{1b}[2J"));
    assert!(
        texts(&document, "td")
            .iter()
            .any(|cell| cell == "</td><b>&'\"\\u{202e}")
    );
    assert!(
        texts(&document, "p")
            .iter()
            .any(|words| words.contains(&failed[0].text))
    );
    assert!(
        texts(&document, "td")
            .iter()
            .any(|cell| cell == "models/<a>.mat")
            && text.contains("c0ffee")
    );
}

#[test]
fn a_report_is_overwritten_only_by_force_and_never_over_what_it_is_read_from() {
    let desk = Desk::new();
    let command = ["report", "small.json", "--out", "report.html"];
    fs::write(desk.path("report.html"), "mine").unwrap();
    desk.messages(&command)
        .assert_code("output-exists", &["report.html", "--force"]);
    assert_eq!(
        fs::read_to_string(desk.path("report.html")).unwrap(),
        "mine"
    );
    desk.gdcm(&[&command[..], &["--force"]].concat())
        .assert_done();
    assert!(
        fs::read_to_string(desk.path("report.html"))
            .unwrap()
            .starts_with("<!DOCTYPE html>")
    );
    let over = ["report", "small.json", "--out", "small.json", "--force"];
    desk.messages(&over)
        .assert_code("output-is-an-input", &["small.json: "]);
    desk.gdcm(&["report", "missing.json", "--out", "a.html"])
        .assert_failed(2, &["missing.json"]);
    assert!(!desk.path("a.html").exists());
}

#[test]
fn a_study_is_reported_by_its_name_with_its_decisions() {
    let desk = Desk::new();
    let loaded = load_dataset(&desk.path("small.json")).unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    let model = ModelId::new(ConditionId(7), BundleKind::Physics, "V+5kt");
    study
        .apply(&Edit::RejectBecause {
            model,
            reason: "trimmed badly".to_owned(),
        })
        .unwrap();
    save_study(&study, &loaded, &desk.path("a.gdcm-study.json")).unwrap();
    desk.gdcm(&["report", "a.gdcm-study.json", "--out", "a.html"])
        .assert_done();
    let text = fs::read_to_string(desk.path("a.html")).unwrap();
    for words in [
        "a.gdcm-study.json",
        "small.json",
        "trimmed badly",
        &loaded.sha256,
    ] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn of_a_long_bundle_a_part_is_shown_and_said_to_be_one() {
    let desk = Desk::new();
    desk.write("long.json", |file| {
        let models = file["conditions"][0]["physics_models"]
            .as_array_mut()
            .unwrap();
        let last = models.last().unwrap().clone();
        for number in 0..300 {
            let mut model = last.clone();
            model["name"] = json!(format!("trim {number}"));
            models.push(model);
        }
    });
    desk.gdcm(&["report", "long.json", "--out", "long.html"])
        .assert_done();
    let text = fs::read_to_string(desk.path("long.html")).unwrap();
    assert!(text.contains("40 of 302 "));
    assert!(text.len() < 3_000_000, "{} bytes", text.len());
}

#[test]
fn the_window_writes_the_report_beside_and_asks_before_it_overwrites() {
    let mut window = few_window();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    fs::write(&path, "mine").unwrap();
    click(&mut window, "File");
    click(&mut window, "Write report…");
    crate::window::fill(&mut window, "Path of the report", &path);
    click(&mut window, "Write report");
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    click(&mut window, "Overwrite");
    crate::window::wait_until(&mut window, "the report", |window| {
        state(window)
            .notices
            .newest()
            .is_some_and(|notice| notice.code == "report-written")
    });
    settle(&mut window);
    let written = fs::read_to_string(&path).unwrap();
    let analysis = state(&window).results.analysis.clone().unwrap();
    let expected = report(
        without_records(&analysis),
        &ReportSource::from_files(&FEW, None),
        &mut Engine::default(),
        &Unobserved,
    )
    .unwrap();
    assert!(written == expected, "what the command would write");
}
