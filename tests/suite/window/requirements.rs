//! Requirements of a qualification, in the window (M17).

use std::sync::Arc;

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::file::FileCommand;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::forms::RequirementTable;
use gdcm::gui::state::requirements_page::RequirementsPage;
use gdcm::gui::state::view::View;
use gdcm_method::requirements::{ModeVerdict, RecordCheck, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{RequirementPart, RequirementSettings};
use gdcm_study::results::record_history::RecordHistory;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_words::missing_results::no_bandwidth_text;
use gdcm_words::requirements::{bandwidth_table, summary_table};
use gdcm_words::requirements_overview::RequirementsOverview;

use super::assembling::type_into;
use super::lists::texts_in;
use super::views::{give, show};
use super::*;

fn texts(window: &Window) -> String {
    texts_in(window, egui::Rect::EVERYTHING)
        .into_iter()
        .map(|(text, _)| text)
        .collect::<Vec<_>>()
        .join("\n")
}

#[test]
fn bandwidth_modes_and_summary_stand_in_tables_and_a_row_is_marked_in_bode() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    wait_until(&mut window, "the requirements", |window| {
        state(window).requirements().is_some() && !state(window).results.background.is_busy()
    });
    let requirements = state(&window).requirements().unwrap().clone();
    let said = texts(&window);
    assert!(
        said.contains("qualification") && said.contains("ω_BW"),
        "{said}"
    );
    // The values equal those of the command: one finding for each condition, on-axis response and
    // role.
    let roles = if state(&window).analysis().unwrap().schedule.is_ok() {
        4
    } else {
        3
    };
    let pairs = state(&window).dataset().measuring_pairs().marked().count();
    assert_eq!(requirements.bandwidth.len(), 3 * pairs * roles);
    let p_lat = pair(&window, "P", "LAT");
    let id = state(&window).condition().id();
    let corrected = requirements
        .bandwidth_of(id, p_lat, RequirementRole::Corrected)
        .unwrap();
    let row = requirements
        .bandwidth
        .iter()
        .position(|of| std::ptr::eq(of, corrected))
        .unwrap();
    let table = bandwidth_table(&requirements, state(&window).dataset());
    assert_eq!(table.rows[row][3], "corrected");
    for (chosen, heading) in [
        (RequirementsPage::Modes, "physics ζ"),
        (RequirementsPage::Summary, "in MUAD on-axis [%]"),
    ] {
        give(&mut window, DisplayCommand::ShowRequirements(chosen));
        assert!(texts(&window).contains(heading), "{heading}");
    }
    // A click on a mark shows the Bode view, with marks at the frequencies that define its values.
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Bandwidth),
    );
    window.get_by_label_contains("Phase delay over bandwidth of LAT → P");
    let first = requirements.bandwidth.first().unwrap();
    let rests = window
        .get_all_by_label(first.role.name())
        .next()
        .unwrap()
        .rect()
        .center();
    window.drag_at(rests);
    window.drop_at(rests);
    window.run_steps(4);
    assert!(
        state(&window)
            .display
            .layout
            .arrangement
            .is_shown(View::Bode),
        "the row leads to Bode"
    );
    assert_eq!(state(&window).display.selection.pair, first.pair);
    let marked: Vec<Option<f64>> = state(&window)
        .display
        .curves
        .crossings
        .iter()
        .map(|(_, omega)| Some(*omega))
        .collect();
    assert_ne!(first.role, RequirementRole::Corrected);
    assert_eq!(
        marked,
        [
            first.omega_phase_rad_s,
            first.omega_gain_rad_s,
            first.omega_180_rad_s
        ],
        "of the row's model"
    );
    let figure = gdcm::gui::views::figures::figure_of(state(&window), View::Bode).unwrap();
    let words = format!("{figure:?}");
    assert!(
        words.contains("ω_phase") && words.contains("ω180"),
        "on paper too"
    );
}

#[test]
fn a_click_on_a_mark_is_of_that_model() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let requirements = shown_requirements(&mut window);
    let p_lat = pair(&window, "P", "LAT");
    // Without leads, the marks of the corrected models coincide with the marks of the physics
    // models.
    let role = RequirementRole::Identified;
    let of_role = |of: &&BandwidthFinding| of.pair == p_lat && of.role == role;
    // The mark with the largest distance from all others cannot be hidden by another mark.
    let places = |of: &BandwidthFinding| gdcm_plot::figure::requirements::bandwidth_place(of);
    let apart = |of: &BandwidthFinding| -> f64 {
        let Some([x, y]) = places(of) else {
            return -1.0;
        };
        let others = requirements
            .bandwidth
            .iter()
            .filter(|other| other.pair == p_lat && !std::ptr::eq(*other, of));
        let distance = |[a, b]: [f64; 2]| ((a - x) / 2.0).hypot((b - y) / 100.0);
        others
            .filter_map(places)
            .map(distance)
            .fold(f64::INFINITY, f64::min)
    };
    let meant = requirements
        .bandwidth
        .iter()
        .filter(of_role)
        .max_by(|a, b| apart(a).total_cmp(&apart(b)))
        .unwrap();
    let plot = gdcm_plot::figure::requirements::bandwidth_pairs(&requirements)
        .iter()
        .position(|of| *of == p_lat)
        .unwrap();
    let at = state(&window).display.figures[&View::Requirements]
        .position(plot, places(meant).unwrap())
        .unwrap();
    window.hover_at(at);
    window.run_steps(2);
    window.drag_at(at);
    window.drop_at(at);
    window.run_steps(4);
    assert_eq!(state(&window).condition().id(), meant.condition);
    let crossings = &state(&window).display.curves.crossings;
    let expected = [
        meant.omega_phase_rad_s,
        meant.omega_gain_rad_s,
        meant.omega_180_rad_s,
    ]
    .map(Option::unwrap);
    assert_eq!(crossings.len(), 3, "{crossings:?}");
    for ((name, omega), expected) in crossings.iter().zip(expected) {
        // Each computation finds the roots with a relative error of up to 1e-12.
        assert!(
            (omega / expected - 1.0).abs() < 1e-11,
            "{name}: {omega} {expected}"
        );
    }
}

fn shown_requirements(
    window: &mut Window,
) -> std::sync::Arc<gdcm_study::results::requirements::Requirements> {
    wait_until(window, "the requirements", |window| {
        let decided = &state(window).study.requirements.attitude_command;
        state(window)
            .requirements()
            .is_some_and(|of| of.attitude_command == *decided)
    });
    state(window).requirements().unwrap().clone()
}

#[test]
fn what_bandwidths_are_asked_with_is_decided_undone_and_drawn() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let rate = shown_requirements(&mut window);
    click(&mut window, "attitude of P");
    let attitude = shown_requirements(&mut window);
    assert!(attitude.attitude_command.contains("P") && rate.attitude_command.is_empty());
    let p_lat = pair(&window, "P", "LAT");
    let of = attitude
        .bandwidth
        .iter()
        .find(|of| of.pair == p_lat && of.omega_phase_rad_s.is_some())
        .unwrap();
    assert_eq!(
        of.omega_bw_rad_s, of.omega_phase_rad_s,
        "the bandwidth is that of the phase margin alone"
    );
    give(&mut window, StudyCommand::Undo);
    assert!(shown_requirements(&mut window).attitude_command.is_empty());

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("levels.json");
    std::fs::write(
        &path,
        r#"[{"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#,
    )
    .unwrap();
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Levels, path.clone()),
    );
    assert_eq!(state(&window).study.requirements.levels.as_slice().len(), 1);
    assert!(texts(&window).contains("levels: 1"));
    std::fs::write(&path, "[]]").unwrap();
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Levels, path),
    );
    assert_eq!(
        state(&window).study.requirements.levels.as_slice().len(),
        1,
        "what cannot be read changes nothing"
    );
    click(&mut window, "Remove levels");
    assert!(
        state(&window)
            .study
            .requirements
            .levels
            .as_slice()
            .is_empty()
    );
}

#[test]
fn models_answer_to_a_step_or_a_doublet_of_the_input_in_focus() {
    fn answers(window: &mut Window) -> Arc<gdcm_study::results::test_input_responses::TestAnswers> {
        wait_until(window, "the answers", |window| {
            let decided = state(window).study.requirements.test;
            matches!(state(window).test_answers(), Some(Ok(found)) if found.test == decided)
        });
        state(window).test_answers().unwrap().clone().unwrap()
    }

    let mut window = few_window();
    show(&mut window, View::Requirements);
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    give(&mut window, DisplayCommand::ShowTest(true));
    let step = answers(&mut window);
    assert_eq!(step.input, state(&window).display.selection.pair.input);
    assert!(
        step.models.iter().all(|(_, answer)| answer.is_ok()),
        "{:?}",
        step.models
    );
    window.get_by_label("P [deg/s] over time");
    click(&mut window, "Shape of the test input");
    click(&mut window, "doublet");
    let doublet = answers(&mut window);
    assert!(
        doublet.signal.iter().any(|value| *value < 0.0)
            && step.signal.iter().all(|value| *value >= 0.0)
    );
    give(&mut window, StudyCommand::Undo);
    assert_eq!(answers(&mut window).test, step.test);
}

#[test]
fn a_record_stands_within_tolerances_that_are_edited_and_kept_in_a_file() {
    fn shown(window: &mut Window) -> Arc<gdcm_study::results::record_history::RecordHistory> {
        wait_until(window, "the record", |window| {
            let decided = &state(window).study.requirements.tolerances;
            let found = state(window).results.record_history.as_ref();
            found.is_some_and(|(job, found)| job.tolerances == *decided && found.is_ok())
        });
        state(window)
            .results
            .record_history
            .as_ref()
            .unwrap()
            .1
            .clone()
            .unwrap()
    }

    fn shares(of: &RecordHistory) -> Vec<f64> {
        let physics = |(role, check): &(_, RecordCheck)| {
            (*role == RequirementRole::Physics).then(|| check.share_inside())
        };
        of.quantities
            .iter()
            .map(|of| of.models.iter().find_map(physics).unwrap())
            .collect()
    }

    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    let by_default = shown(&mut window);
    let first = shares(&by_default);
    let worst = (0..first.len())
        .min_by(|a, b| first[*a].total_cmp(&first[*b]))
        .unwrap();
    assert!(first[worst] < 1.0, "{first:?}");
    click(&mut window, "Tolerances");
    let quantity = &by_default.quantities[worst].tolerance;
    let row = state(&window)
        .study
        .requirements
        .tolerances
        .rows()
        .iter()
        .position(|of| of == quantity)
        .unwrap();
    type_into(
        &mut window,
        &format!("Absolute tolerance {}", row + 1),
        "900",
    );
    let wide = shares(&shown(&mut window));
    let others = |of: &[f64]| [&of[..worst], &of[worst + 1..]].concat();
    assert_eq!(
        (wide[worst], others(&wide)),
        (1.0, others(&first)),
        "nothing is so far from flight"
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.json");
    give(&mut window, FileCommand::WriteTolerances(path.clone()));
    give(&mut window, StudyCommand::Undo);
    assert_eq!(shares(&shown(&mut window)), first);
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Tolerances, path.clone()),
    );
    assert_eq!(shares(&shown(&mut window)), wide);
    std::fs::write(&path, "{}").unwrap();
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Tolerances, path),
    );
    assert_eq!(
        shares(&shown(&mut window)),
        wide,
        "what cannot be read changes nothing"
    );
    click(&mut window, "Default tolerances");
    assert_eq!(shares(&shown(&mut window)), first);
}

#[test]
fn the_summary_has_what_the_records_that_are_open_say() {
    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    wait_until(&mut window, "the records", |window| {
        !state(window).records.conditions.is_empty()
    });
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Summary),
    );
    wait_until(&mut window, "the answers", |window| {
        state(window).time_histories().is_some() && state(window).requirements().is_some()
    });
    let found = state(&window).time_histories().unwrap().clone();
    let rms = |role| found.j_rms(ConditionId(10), role).unwrap();
    assert!(rms(RequirementRole::Identified) < rms(RequirementRole::Physics));
    let table = summary_table(state(&window).requirements().unwrap(), Some(&found));
    let of_flight = table
        .rows
        .iter()
        .find(|row| row[..3] == ["10", "60", "identified"].map(str::to_owned))
        .unwrap();
    assert_eq!(
        of_flight[7],
        format!("{:.2}", rms(RequirementRole::Identified))
    );
    assert!(texts(&window).contains("J_rms") && texts(&window).contains("Theil P"));
    // The overview includes these results; its limits can be changed, undone and drawn.
    let overview = |window: &Window| {
        let limits = &state(window).study.requirements.overview;
        RequirementsOverview::new(
            state(window).requirements().unwrap(),
            state(window).dataset(),
            Some(&found),
            limits,
        )
    };
    let usual = overview(&window);
    let pitch = usual
        .table
        .rows
        .iter()
        .position(|row| row[0] == "pitch rate inside")
        .unwrap();
    let column = usual
        .table
        .columns
        .iter()
        .position(|of| of == "10")
        .unwrap();
    let share = found
        .share_inside(ConditionId(10), RequirementRole::Corrected, "pitch rate")
        .unwrap();
    assert_eq!(
        usual.table.rows[pitch][column],
        format!("{:.1}", (1e3 * share).floor() / 10.0)
    );
    assert!(texts(&window).contains("pitch rate inside") && texts(&window).contains("≥ 90"));
    click(&mut window, "Limits of the overview");
    type_into(&mut window, "Minimum time within tolerance", "100.5");
    assert!(
        overview(&window).is_outside(pitch, column),
        "nothing is inside for longer than always"
    );
    type_into(&mut window, "Limit of the bandwidth", "0");
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "limit-not-positive",
        &["bandwidth"],
    );
    give(&mut window, StudyCommand::Undo);
    assert_eq!(overview(&window), usual);

    // The saved file contains both displayed tables with their values.
    let folder = tempfile::tempdir().unwrap();
    let width = gdcm_plot::figure::ColumnWidth::Double;
    let path = folder.path().join("summary.csv");
    give(
        &mut window,
        OutputCommand::SaveFigure(View::Requirements, width, path.clone()),
    );
    let saved = std::fs::read_to_string(path).unwrap();
    assert!(
        saved.contains("pitch rate inside,% of time,≥ 90")
            && saved.contains("J on-axis")
            && !saved.contains('\u{2212}')
    );
    let picture = folder.path().join("summary.svg");
    give(
        &mut window,
        OutputCommand::SaveFigure(View::Requirements, width, picture.clone()),
    );
    assert_notice(&window, NoticeKind::Trouble, "tables-as-csv", &[".csv"]);
    assert!(!picture.exists());
}

#[test]
fn tolerances_are_reached_without_a_record_and_those_of_modes_are_edited() {
    fn verdicts(window: &Window) -> Vec<ModeVerdict> {
        state(window)
            .requirements()
            .unwrap()
            .modes
            .iter()
            .map(|of| of.verdict)
            .collect()
    }

    fn shown(window: &mut Window) -> Vec<ModeVerdict> {
        wait_until(window, "the modes", |window| {
            let decided = &state(window).study.requirements.mode_tolerances;
            let found = state(window).results.requirements.as_ref();
            found.is_some_and(|(job, _)| job.settings.mode_tolerances == *decided)
        });
        verdicts(window)
    }

    fn outside(of: &[ModeVerdict]) -> usize {
        of.iter().filter(|of| **of == ModeVerdict::Outside).count()
    }

    let mut window = few_window();
    show(&mut window, View::Requirements);
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    give(&mut window, DisplayCommand::ShowTest(true));
    click(&mut window, "Tolerances");
    type_into(&mut window, "Absolute tolerance 1", "4.5");
    assert!((state(&window).study.requirements.tolerances.rows()[0].absolute - 4.5).abs() < 1e-12);

    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Modes),
    );
    let usual = shown(&mut window);
    assert!(usual.contains(&ModeVerdict::Outside), "{usual:?}");
    click(&mut window, "Tolerances of modes");
    for field in [
        "Tolerance of the period 2",
        "Tolerance of the time to half 2",
        "Tolerance of the damping ratio 2",
    ] {
        type_into(&mut window, field, "1e4");
    }
    for field in [
        "Tolerance of the period 1",
        "Tolerance of the time to half 1",
        "Tolerance of the damping ratio 1",
    ] {
        type_into(&mut window, field, "1e4");
    }
    // A mode that does not oscillate, unlike the flown mode, is outside any tolerance.
    assert!(
        outside(&shown(&mut window)) < outside(&usual),
        "nothing is so far from flight"
    );
    click(&mut window, "Default tolerances of modes");
    assert_eq!(shown(&mut window), usual);
}

#[test]
fn the_report_of_the_window_has_the_records_that_are_open_and_what_was_decided_last() {
    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    wait_until(&mut window, "the records", |window| {
        !state(window).records.conditions.is_empty()
    });
    settle(&mut window);
    let mut settings = RequirementSettings::clone(&state(&window).study.requirements);
    let levels =
        r#"[{"name": "Level 1 of the tests", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#;
    settings.levels = serde_json::from_str(levels).unwrap();
    let mut rows = settings.tolerances.rows().to_vec();
    rows[0].absolute = 12.375;
    settings.tolerances = ToleranceTable::new("edited", rows).unwrap();
    give(
        &mut window,
        Edit::SetRequirements(RequirementPart::Levels, Arc::new(settings)),
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    give(&mut window, OutputCommand::WriteReport(path.clone()));
    wait_until(&mut window, "the report", |_| path.exists());
    let written = std::fs::read_to_string(&path).unwrap();
    for words in [
        "Level 1 of the tests",
        "12.375",
        "Records of condition 10",
        "J_rms over all records of a condition",
    ] {
        assert!(written.contains(words), "{words}");
    }
}

#[test]
fn a_condition_without_rates_and_records_says_so_in_words() {
    let desk = crate::commands::Desk::new();
    desk.write("forces.json", |file| {
        for output in file["outputs"].as_array_mut().unwrap() {
            output["unit"] = serde_json::json!("N");
        }
    });
    let opened = load_any(&desk.path("forces.json"), &Default::default()).unwrap();
    let mut window = window_with(opened, Setup::default());
    show(&mut window, View::Requirements);
    wait_until(&mut window, "the requirements", |window| {
        state(window).requirements().is_some()
    });
    let requirements = state(&window).requirements().unwrap();
    assert!(!requirements.bandwidth.is_empty());
    for finding in &requirements.bandwidth {
        let why = &finding.absent["omega_bw_rad_s"];
        assert_eq!(why.code(), "no-attitude-response");
        let words = no_bandwidth_text(why);
        assert!(texts(&window).contains(&words), "{words}");
    }
    give(
        &mut window,
        DisplayCommand::ShowRequirements(RequirementsPage::Histories),
    );
    let id = state(&window).condition().id();
    let records = state(&window).records.conditions.get(&id);
    assert!(records.is_none_or(|records| records.used_rows().next().is_none()));
    assert!(texts(&window).contains("view Records"));
}
