//! Saving and copying the figure of a view.

use std::fs;

use gdcm::gui::state::view::{View, views_with_figure};
use gdcm::gui::views::figures::figure_of;
use gdcm_io::csv_text::csv_text;
use gdcm_io::export::figure_file::write_as;
use gdcm_plot::figure::{ColumnWidth, FigureFormat};
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting_table;

use super::views::{give, show};
use super::*;

/// Saves a view through the button in its header, with a typed path.
fn save_figure(window: &mut Window, view: View, format: &str, path: &Path) {
    click(window, &format!("Save or copy {}", view.name()));
    click(window, &format!("Save as {format}…"));
    fill(window, "Path of the figure", path);
    click(window, "Save figure");
}

/// Saves a view and asserts that the file contains its figure.
fn assert_saved(window: &mut Window, view: View, format: FigureFormat, folder: &Path) {
    let path = folder.join(format!("{}.{}", view.name(), format.extension()));
    save_figure(window, view, &format.extension().to_uppercase(), &path);
    let notice = state(window)
        .notices
        .newest()
        .cloned()
        .expect("it is reported");
    assert_eq!(notice.kind, NoticeKind::Done, "{}", notice.text);
    let mut expected = Vec::new();
    let figure = figure_of(state(window), view).expect("the view has a figure");
    write_as(&figure, ColumnWidth::Double, format, &mut expected).unwrap();
    assert_eq!(fs::read(&path).unwrap(), expected, "{view:?} {format:?}");
}

#[test]
fn every_view_is_saved_from_its_header() {
    let mut window = few_window();
    let folder = tempfile::tempdir().unwrap();
    wait_for_bars(&mut window);
    for view in views_with_figure() {
        if view == View::Leads {
            // The dock has this page only while there are leads.
            give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
            wait_for_bars(&mut window);
        }
        show(&mut window, view);
        wait_until(&mut window, "what it shows", |window| {
            !state(window).results.background.is_busy()
        });
        assert_saved(&mut window, view, FigureFormat::Svg, folder.path());
    }
}

#[test]
fn coherence_of_measured_responses_stands_below_their_bode_plot() {
    let mut window = window();
    assert_eq!(
        figure_of(state(&window), View::Bode).unwrap().plots[0]
            .panels
            .len(),
        2,
        "the example has none"
    );
    open_by_path(&mut window, &files::small_dataset());
    settle(&mut window);
    show(&mut window, View::Bode);
    let title = state(&window)
        .dataset()
        .pair_name(state(&window).display.selection.pair);
    window.get_by_label_contains(&format!("Coherence of {title}"));
    let figure = figure_of(state(&window), View::Bode).unwrap();
    let strip = figure.plots[0]
        .panels
        .get(2)
        .expect("magnitude, phase, coherence");
    assert!(
        strip
            .marks
            .iter()
            .any(|mark| matches!(mark, gdcm_plot::figure::Mark::Curve(of) if !of.x.is_empty()))
    );
}

#[test]
fn a_view_is_saved_in_every_format() {
    let mut window = few_window();
    wait_for_bars(&mut window);
    let folder = tempfile::tempdir().unwrap();
    for format in FigureFormat::ALL {
        assert_saved(&mut window, View::NetGain, format, folder.path());
    }
}

#[test]
fn a_figure_of_the_window_is_that_of_the_command() {
    let mut window = window();
    choose_condition_10(&mut window);
    wait_for_bars(&mut window);
    let folder = tempfile::tempdir().unwrap();
    let ours = folder.path().join("window.svg");
    let theirs = folder.path().join("command.svg");
    save_figure(&mut window, View::Bode, "SVG", &ours);
    let desk = crate::commands::Desk::new();
    let command = [
        "figure",
        "--view",
        "bode",
        "--condition",
        "10",
        "--pair",
        "Q/LON",
        "--out",
        theirs.to_str().unwrap(),
    ];
    desk.gdcm(&command).assert_done();
    assert_eq!(
        fs::read_to_string(ours).unwrap(),
        fs::read_to_string(theirs).unwrap()
    );
}

#[test]
fn a_file_that_is_there_is_asked_about_and_a_name_without_a_format_is_refused() {
    let mut window = window();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bode.svg");
    fs::write(&path, "mine").unwrap();
    save_figure(&mut window, View::Bode, "SVG", &path);
    assert!(window.query_by_label("This file exists already").is_some());
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    click(&mut window, "Overwrite");
    assert!(fs::read_to_string(&path).unwrap().starts_with("<svg"));
    save_figure(
        &mut window,
        View::Bode,
        "SVG",
        &folder.path().join("bode.docx"),
    );
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "figure-format",
        &["bode.docx", ".svg", ".png", ".pdf", ".csv"],
    );
    assert!(!folder.path().join("bode.docx").exists());
}

#[test]
fn the_numbers_of_a_view_are_copied_as_csv() {
    fn copied(window: &Window) -> Option<String> {
        window
            .output()
            .platform_output
            .commands
            .iter()
            .find_map(|command| match command {
                egui::OutputCommand::CopyText(text) => Some(text.clone()),
                _ => None,
            })
    }

    let mut window = window();
    wait_for_bars(&mut window);
    click(&mut window, "Save or copy Net gain");
    window.get_by_label("Copy the values").click();
    let mut text = None;
    for _ in 0..4 {
        window.run_steps(1);
        text = text.or_else(|| copied(&window));
    }
    let figure = figure_of(state(&window), View::NetGain).unwrap();
    assert_eq!(text, Some(csv_text(&figure.tables())));
}
