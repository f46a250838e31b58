//! Requirements of a qualification, in the window (M17).

use std::sync::Arc;

use egui::Key;

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::file::FileCommand;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::forms::RequirementTable;
use gdcm::gui::state::requirements_display::{GridOrder, RequirementDetail, RequirementsDisplay};
use gdcm::gui::state::view::View;
use gdcm::gui::views::requirement_selection::shown_grid;
use gdcm_method::requirements::{ModeName, ModeVerdict, RecordCheck, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_study::Edit;
use gdcm_study::decisions::requirement_settings::{RequirementPart, RequirementSettings};
use gdcm_study::results::grid_cell::CellVerdict;
use gdcm_study::results::grid_requirement::Requirement;
use gdcm_study::results::record_history::RecordHistory;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_grid::RequirementGrid;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_words::missing_results::no_bandwidth_text;
use gdcm_words::requirement_grid::met_text;

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

/// Shows the requirements and waits for the grid of the current decisions, with the held-out
/// records.
fn grid(window: &mut Window) -> RequirementGrid {
    wait_until(window, "the grid", |window| {
        let state = state(window);
        let records_are_read = state.records.conditions.len() == state.dataset().conditions().len();
        let results = &state.results;
        let histories_are_there = match &results.time_histories {
            Some((job, _)) => job.records == state.records.held_out_records(),
            None => false,
        };
        let requirements_are_new = match &results.requirements {
            Some((job, _)) => *job.settings == *state.study.requirements,
            None => false,
        };
        records_are_read
            && state.records.reading.is_none()
            && histories_are_there
            && requirements_are_new
            && !results.background.is_busy()
    });
    window.run_steps(2);
    shown_grid(state(window)).expect("the requirements are known")
}

fn display(window: &Window) -> RequirementsDisplay {
    state(window).display.judging.requirements
}

/// Returns whether any control has these words in its accessible name.
fn is_named(window: &Window, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

/// Selects a cell by a command, as a click on it does.
fn select(window: &mut Window, requirement: Requirement) {
    let selected = display(window).with_selected(requirement);
    give(window, DisplayCommand::ShowRequirements(selected));
}

/// Opens the editor of a limit by a command, as a double click on it does.
fn edit_limit(window: &mut Window, requirement: Requirement) {
    let edited = RequirementsDisplay {
        edited_limit: Some(requirement),
        ..display(window)
    };
    give(window, DisplayCommand::ShowRequirements(edited));
    window.run_steps(3);
}

#[test]
fn the_grid_counts_what_is_met_and_a_cell_sets_condition_and_response() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let grid = grid(&mut window);
    let count = grid.count();
    assert!(
        count.met > 0 && count.judged > count.met && count.not_determined > 0,
        "{count:?}"
    );
    let shown = texts(&window);
    assert!(shown.contains(&met_text(count)), "{shown}");
    assert!(shown.contains("qualification"), "{shown}");
    // Every row has a cell for each condition.
    assert_eq!(grid.conditions.len(), 3);
    let yaw = pair(&window, "R", "PED");
    assert!(grid.row(Requirement::PhaseDelay(yaw)).is_some());
    window
        .get_by_label_contains("Yaw phase delay, condition 7: ")
        .click();
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(7));
    assert_eq!(state(&window).display.selection.pair, yaw);
    assert_eq!(
        display(&window).selected,
        Some(Requirement::PhaseDelay(yaw))
    );
    window.get_by_label("Yaw phase delay, condition 7");
    window.get_by_label_contains("Phase delay over bandwidth of PED → R");
}

#[test]
fn arrow_keys_move_the_selected_cell() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    grid(&mut window);
    let roll = pair(&window, "P", "LAT");
    window
        .get_by_label_contains("Roll bandwidth, condition 3: ")
        .click();
    settle(&mut window);
    window.key_press(Key::ArrowRight);
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(7));
    window.key_press(Key::ArrowDown);
    settle(&mut window);
    assert_eq!(
        display(&window).selected,
        Some(Requirement::PhaseDelay(roll))
    );
    assert_eq!(state(&window).condition().id(), ConditionId(7));
    window.key_press(Key::ArrowLeft);
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(3));
}

#[test]
fn a_click_on_a_heading_sorts_the_conditions() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let grid = grid(&mut window);
    let places = |window: &Window| -> Vec<ConditionId> {
        let mut cells: Vec<(f32, ConditionId)> = Vec::new();
        for condition in &grid.conditions {
            let label = format!("Roll bandwidth, condition {}: ", condition.id);
            let cell = window.get_by_label_contains(&label);
            cells.push((cell.rect().left(), condition.id));
        }
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
        cells.into_iter().map(|(_, id)| id).collect()
    };
    assert_eq!(places(&window), [3, 7, 10].map(ConditionId));
    click(&mut window, "Sort by airspeed, kt");
    assert_eq!(display(&window).order, GridOrder::Airspeed);
    let mut by_airspeed = grid.conditions.clone();
    by_airspeed.sort_by(|a, b| a.airspeed_kt.total_cmp(&b.airspeed_kt));
    let expected: Vec<ConditionId> = by_airspeed.iter().map(|of| of.id).collect();
    assert_eq!(places(&window), expected);
    click(&mut window, "Sort by condition");
    click(&mut window, "Sort by condition");
    assert_eq!(places(&window), [10, 7, 3].map(ConditionId));
}

#[test]
fn the_window_and_the_command_agree_on_the_counts() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let grid = grid(&mut window);
    let desk = crate::commands::Desk::with_few();
    let records = crate::requirements::RECORDS;
    let ended = desk.gdcm(&[
        "requirements",
        "few.json",
        "--records",
        records,
        "--out",
        ".",
    ]);
    assert_eq!(ended.status, 0, "{ended:?}");
    let count = grid.count();
    assert!(ended.out.contains(&met_text(count)), "{}", ended.out);
    let written = crate::read_json(&desk.path("requirements.json"));
    let own = &written["grid"][0];
    assert_eq!(own["role"], "corrected");
    let number = |name: &str| own[name].as_u64().unwrap() as usize;
    assert_eq!(
        [
            number("met"),
            number("judged"),
            number("physics_met"),
            number("not_determined")
        ],
        [
            count.met,
            count.judged,
            count.physics_met,
            count.not_determined
        ]
    );
}

#[test]
fn limits_are_edited_in_the_grid_undone_and_reset() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let usual = grid(&mut window);
    // A double click on the limit opens its editor.
    window
        .ctx
        .options_mut(|options| options.input_options.max_double_click_delay = 5.0);
    let at = window
        .get_by_label("Limit of Roll bandwidth")
        .rect()
        .center();
    for _ in 0..2 {
        window.drag_at(at);
        window.drop_at(at);
    }
    window.run_steps(4);
    type_into(&mut window, "Limit of the bandwidth", "0.0001");
    let strict = grid(&mut window);
    assert!(strict.count().met < usual.count().met);
    assert_eq!(strict.count().judged, usual.count().judged);
    type_into(&mut window, "Limit of the bandwidth", "0");
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "limit-not-positive",
        &["bandwidth"],
    );
    give(&mut window, StudyCommand::Undo);
    assert_eq!(grid(&mut window), usual);
    let summary = Requirement::MuadShareOnAxis;
    edit_limit(&mut window, summary);
    type_into(&mut window, "Minimum share inside MUAD", "100.5");
    let strict = grid(&mut window);
    for cell in &strict.row(summary).unwrap().cells {
        assert_eq!(cell.corrected.verdict, CellVerdict::Outside);
    }
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert_eq!(display(&window).edited_limit, None);
    click(&mut window, "Limits of the requirements");
    click(&mut window, "Default limits");
    assert_eq!(grid(&mut window), usual);
}

#[test]
fn the_drawer_is_closed_by_escape_and_a_selection_opens_it_again() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    grid(&mut window);
    let name = "Close the details";
    window.get_by_label(name);
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(window.query_by_label(name).is_none());
    let mode = Requirement::ModeFrequency(ModeName::DutchRoll);
    window
        .get_by_label_contains("Dutch roll, frequency, condition 10: ")
        .click();
    settle(&mut window);
    assert_eq!(display(&window).selected, Some(mode));
    assert_eq!(display(&window).detail, RequirementDetail::Modes);
    window.get_by_label(name);
    // Unpaired modes are named as such.
    let condition = state(&window).condition().id();
    let requirements = state(&window).requirements().unwrap();
    let unpaired = requirements
        .modes
        .iter()
        .find(|mode| mode.condition == condition && mode.verdict == ModeVerdict::NotPaired)
        .expect("a flown pole without a partner");
    let name = match unpaired.name {
        Some(name) => name.to_string(),
        None => format!("Mode {}", unpaired.number),
    };
    let label = format!("{name}: unpaired");
    let is_named = window.query_all_by_label_contains("Mode ").any(|node| {
        let text = node.accesskit_node().label().unwrap_or_default();
        text.to_lowercase().contains(&label.to_lowercase())
    });
    assert!(is_named, "{label}");
}

#[test]
fn a_narrow_window_folds_the_groups_and_switches_between_the_details() {
    let mut window = few_window();
    window.set_size(egui::vec2(1280.0, 720.0));
    show(&mut window, View::Requirements);
    let grid = grid(&mut window);
    let yaw_rate = grid
        .rows
        .iter()
        .map(|row| row.requirement)
        .find(|requirement| matches!(requirement, Requirement::PeakError(_)))
        .unwrap();
    select(&mut window, yaw_rate);
    assert!(
        window
            .query_by_label_contains("Roll bandwidth, condition 3: ")
            .is_none()
    );
    let count = grid
        .group_cell(yaw_rate.group(), grid.column(ConditionId(3)).unwrap())
        .count;
    assert!(count.judged > 0, "condition 3 has a held-out record");
    window.get_by_label_contains("Bandwidth, condition 3: ");
    click(&mut window, "Page modes");
    assert_eq!(display(&window).detail, RequirementDetail::Modes);
    click(&mut window, "Page time");
    assert_eq!(display(&window).detail, RequirementDetail::Time);
    click(&mut window, "Group Bandwidth");
    window.get_by_label_contains("Roll bandwidth, condition 3: ");
    assert_eq!(display(&window).detail, RequirementDetail::Frequency);
}

#[test]
fn a_bandwidth_is_marked_in_bode() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    grid(&mut window);
    let roll = pair(&window, "P", "LAT");
    select(&mut window, Requirement::Bandwidth(roll));
    let id = state(&window).condition().id();
    let requirements = state(&window).requirements().unwrap().clone();
    let corrected = requirements
        .bandwidth_of(id, roll, RequirementRole::Corrected)
        .unwrap();
    click(&mut window, "Show in Bode");
    let shown = state(&window);
    assert!(shown.display.layout.arrangement.is_shown(View::Bode));
    assert_eq!(shown.display.selection.pair, roll);
    let marked: Vec<Option<f64>> = shown
        .display
        .curves
        .crossings
        .iter()
        .map(|(_, omega)| Some(*omega))
        .collect();
    let mut expected = vec![
        corrected.omega_phase_rad_s,
        corrected.omega_gain_rad_s,
        corrected.omega_180_rad_s,
    ];
    expected.retain(Option::is_some);
    assert_eq!(marked, expected, "of the corrected model");
    let figure = gdcm::gui::views::figures::figure_of(shown, View::Bode).unwrap();
    let words = format!("{figure:?}");
    assert!(words.contains("ω180"), "on paper too");
}

#[test]
fn a_click_on_a_mark_selects_its_condition() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    grid(&mut window);
    let p_lat = pair(&window, "P", "LAT");
    select(&mut window, Requirement::Bandwidth(p_lat));
    window.run_steps(3);
    let requirements = state(&window).requirements().unwrap().clone();
    let places = |of: &BandwidthFinding| gdcm_plot::figure::requirements::bandwidth_place(of);
    let shown = state(&window).condition().id();
    let meant = requirements
        .bandwidth
        .iter()
        .find(|of| {
            of.pair == p_lat
                && of.role == RequirementRole::Identified
                && of.condition != shown
                && places(of).is_some()
        })
        .unwrap();
    let at = state(&window).display.figures[&View::Requirements]
        .position(0, places(meant).unwrap())
        .unwrap();
    window.hover_at(at);
    window.run_steps(2);
    window.drag_at(at);
    window.drop_at(at);
    window.run_steps(4);
    assert_eq!(state(&window).condition().id(), meant.condition);
    assert!(
        state(&window)
            .display
            .layout
            .arrangement
            .is_shown(View::Requirements)
    );
}

#[test]
fn attitude_commands_and_levels_are_decided_undone_and_drawn() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    grid(&mut window);
    click(&mut window, "Limits of the requirements");
    click(&mut window, "attitude of P");
    grid(&mut window);
    let attitude = state(&window).requirements().unwrap().clone();
    assert!(attitude.attitude_command.contains("P"));
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
    grid(&mut window);
    let rate = state(&window).requirements().unwrap();
    assert!(rate.attitude_command.is_empty());

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
}

#[test]
fn levels_of_the_standard_are_chosen_in_the_menu_and_shown_for_every_model() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let yaw = pair(&window, "R", "PED");
    assert!(grid(&mut window).row(Requirement::Level(yaw)).is_none());
    click(&mut window, "Limits of the requirements");
    click(&mut window, "ADS-33E-PRF, yaw: all other tasks");
    let with_levels = grid(&mut window);
    let row = with_levels.row(Requirement::Level(yaw)).unwrap();
    assert_eq!(row.cells.len(), with_levels.conditions.len());
    let levels = &state(&window).study.requirements.levels;
    let requirements = state(&window).requirements().unwrap();
    for (condition, cell) in with_levels.conditions.iter().zip(&row.cells) {
        let finding = requirements
            .bandwidth_of(condition.id, yaw, RequirementRole::Corrected)
            .unwrap();
        let level = finding.level(levels).and_then(|level| level.number());
        assert_eq!(cell.corrected.value, level.map(f64::from));
    }
    // The other category of the axis replaces this one.
    click(
        &mut window,
        "ADS-33E-PRF, yaw: target acquisition and tracking",
    );
    let names: Vec<f64> = state(&window)
        .study
        .requirements
        .levels
        .as_slice()
        .iter()
        .map(|boundary| boundary.points[0][0])
        .collect();
    assert_eq!(names, [3.5, 2.0]);
    window.key_press(Key::Escape);
    window.run_steps(3);
    let condition = state(&window).condition().id();
    window
        .get_by_label_contains(&format!("Yaw level, condition {condition}: "))
        .click();
    settle(&mut window);
    assert_eq!(state(&window).display.selection.pair, yaw);
    window.get_by_label(&format!("Yaw level, condition {condition}"));
    window.get_by_label_contains("Phase delay over bandwidth of PED → R");
    give(&mut window, StudyCommand::Undo);
    give(&mut window, StudyCommand::Undo);
    assert!(grid(&mut window).row(Requirement::Level(yaw)).is_none());
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
    give(&mut window, DisplayCommand::ShowTest(true));
    let step = answers(&mut window);
    assert_eq!(step.input, state(&window).display.selection.pair.input);
    assert!(
        step.models.iter().all(|(_, answer)| answer.is_ok()),
        "{:?}",
        step.models
    );
    let shown = RequirementsDisplay {
        detail: RequirementDetail::Time,
        ..display(&window)
    };
    give(&mut window, DisplayCommand::ShowRequirements(shown));
    let input = state(&window).dataset().inputs()[step.input].name.clone();
    wait_until(&mut window, "the details with the test input", |window| {
        is_named(window, &format!("of {input} by"))
    });
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
fn the_held_out_record_comes_first_within_tolerances_that_are_edited_and_kept_in_a_file() {
    fn shown(window: &mut Window) -> Arc<RecordHistory> {
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

    fn peaks(of: &RecordHistory) -> Vec<f64> {
        let peak = |check: &RecordCheck| check.peak().unwrap().peak_error;
        let mut peaks = Vec::new();
        for quantity in &of.quantities {
            for (role, check) in &quantity.models {
                if *role == RequirementRole::Physics {
                    peaks.push(peak(check));
                }
            }
        }
        peaks
    }

    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
    let usual_grid = grid(&mut window);
    let by_default = shown(&mut window);
    assert!(by_default.held_out && by_default.record == "cond10_validation");
    let moved = by_default.moved_input.expect("all sticks have one unit");
    let moved = &state(&window).dataset().inputs()[moved].name;
    assert!(is_named(&window, "cond10_validation: "));
    let first = peaks(&by_default);
    // The grid has the same number as the record.
    let row = (0..first.len())
        .max_by(|a, b| first[*a].total_cmp(&first[*b]))
        .unwrap();
    let tolerance = &by_default.quantities[row].tolerance;
    let index = state(&window)
        .study
        .requirements
        .tolerances
        .rows()
        .iter()
        .position(|of| of == tolerance)
        .unwrap();
    let cell = usual_grid.cell(Requirement::PeakError(index), ConditionId(10));
    if let Some(cell) = cell {
        assert_eq!(cell.physics.value, Some(first[row]), "{moved}");
        let is_outside = cell.physics.verdict == CellVerdict::Outside;
        assert_eq!(is_outside, first[row] > 1.0);
    }
    edit_limit(&mut window, Requirement::PeakError(0));
    type_into(&mut window, "Absolute tolerance 1", "900");
    let wide = peaks(&shown(&mut window));
    assert!(wide[0] < 0.1, "nothing is so far from flight");
    assert_eq!(wide[1..], first[1..]);
    let cell = grid(&mut window)
        .cell(Requirement::PeakError(0), ConditionId(10))
        .unwrap()
        .clone();
    assert_eq!(
        (cell.physics.value, cell.physics.verdict),
        (Some(wide[0]), CellVerdict::Met)
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.json");
    give(&mut window, FileCommand::WriteTolerances(path.clone()));
    give(&mut window, StudyCommand::Undo);
    assert_eq!(peaks(&shown(&mut window)), first);
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Tolerances, path.clone()),
    );
    assert_eq!(peaks(&shown(&mut window)), wide);
    std::fs::write(&path, "{}").unwrap();
    give(
        &mut window,
        FileCommand::ReadRequirementTable(RequirementTable::Tolerances, path),
    );
    assert_eq!(
        peaks(&shown(&mut window)),
        wide,
        "what cannot be read changes nothing"
    );
    let rows = state(&window).study.requirements.tolerances.rows().to_vec();
    assert_ne!(rows, ToleranceTable::default().rows());
}

#[test]
fn the_grid_is_saved_as_a_table_and_the_details_as_a_figure() {
    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
    grid(&mut window);
    let folder = tempfile::tempdir().unwrap();
    let width = gdcm_plot::figure::ColumnWidth::Double;
    let path = folder.path().join("grid.csv");
    give(
        &mut window,
        OutputCommand::SaveFigure(View::Requirements, width, path.clone()),
    );
    let saved = std::fs::read_to_string(path).unwrap();
    assert!(
        saved.contains("Roll bandwidth,%,") && saved.contains("Band inside MUAD,%,"),
        "{saved}"
    );
    let picture = folder.path().join("details.svg");
    give(
        &mut window,
        OutputCommand::SaveFigure(View::Requirements, width, picture.clone()),
    );
    assert!(picture.exists());
}

#[test]
fn tolerances_of_modes_are_edited() {
    fn outside(grid: &RequirementGrid) -> usize {
        let row = grid
            .row(Requirement::ModeFrequency(ModeName::DutchRoll))
            .unwrap();
        let mut count = 0;
        for cell in &row.cells {
            if cell.corrected.verdict == CellVerdict::Outside {
                count += 1;
            }
        }
        count
    }

    let mut window = few_window();
    show(&mut window, View::Requirements);
    let usual = grid(&mut window);
    assert!(outside(&usual) > 0);
    edit_limit(&mut window, Requirement::ModeFrequency(ModeName::DutchRoll));
    for field in [
        "Tolerance of the period 2",
        "Tolerance of the time to half 2",
        "Tolerance of the damping ratio 2",
    ] {
        type_into(&mut window, field, "1e4");
    }
    let wide = grid(&mut window);
    assert!(
        outside(&wide) < outside(&usual),
        "nothing is so far from flight"
    );
    window.key_press(Key::Escape);
    window.run_steps(3);
    click(&mut window, "Limits of the requirements");
    click(&mut window, "Default tolerances of modes");
    assert_eq!(grid(&mut window), usual);
}

#[test]
fn the_schedule_is_judged_on_request() {
    let mut window = few_window();
    show(&mut window, View::Requirements);
    let own = grid(&mut window);
    assert_eq!(own.role, RequirementRole::Corrected);
    let scheduled = RequirementsDisplay {
        judges_schedule: true,
        ..display(&window)
    };
    give(&mut window, DisplayCommand::ShowRequirements(scheduled));
    let scheduled = grid(&mut window);
    assert_eq!(scheduled.role, RequirementRole::Scheduled);
    assert_eq!(scheduled.conditions, own.conditions);
    let bandwidth = |grid: &RequirementGrid| {
        let row = &grid.rows[0];
        row.cells[0].physics.clone()
    };
    assert_eq!(bandwidth(&own), bandwidth(&scheduled));
}

#[test]
fn the_report_of_the_window_has_the_records_that_are_open_and_what_was_decided_last() {
    let mut window = few_window();
    choose_condition_10(&mut window);
    show(&mut window, View::Requirements);
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
    window.run_steps(2);
    let requirements = state(&window).requirements().unwrap();
    let id = state(&window).condition().id();
    let focused = state(&window).display.selection.pair;
    let finding = requirements
        .bandwidth_of(id, focused, RequirementRole::Physics)
        .unwrap();
    let why = &finding.absent["omega_bw_rad_s"];
    assert_eq!(why.code(), "no-attitude-response");
    let words = no_bandwidth_text(why);
    assert!(texts(&window).contains(&words), "{words}");
    let records = state(&window).records.conditions.get(&id);
    assert!(records.is_none_or(|records| records.used_rows().next().is_none()));
    assert!(texts(&window).contains("add or use one in Records"));
    let grid = shown_grid(state(&window)).unwrap();
    for row in &grid.rows {
        assert!(!matches!(row.requirement, Requirement::Bandwidth(_)));
    }
}
