//! Command table: palette, key page, tables and tour.

use gdcm::gui::commands::assembling::AssemblingCommand;
use gdcm::gui::commands::command_table::{command_table, every_command};
use gdcm::gui::state::forms::FormKind;
use gdcm::gui::state::panel_tables::{TableKind, table_of};
use gdcm_method::correction::Channel;
use gdcm_method::uncertainty::Scalar;
use gdcm_words::Table;

use super::views::give;
use super::*;

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

/// Opens the palette, types a query and presses Enter.
fn ask(window: &mut Window, query: &str) {
    press(window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Command palette");
    window.event(Event::Text(query.to_owned()));
    window.run_steps(2);
    press(window, Modifiers::NONE, Key::Enter);
    settle(window);
    assert_eq!(state(window).forms.shown, None, "{query}");
}

#[test]
fn names_and_keys_of_commands_are_one_of_a_kind() {
    let window = window();
    let entries = every_command(state(&window));
    let mut names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    assert!(names.len() > 100, "{}", names.len());
    names.sort_unstable();
    assert_eq!(names.windows(2).find(|pair| pair[0] == pair[1]), None);
    let table = command_table(state(&window));
    let mut keys: Vec<String> = table
        .iter()
        .flat_map(|entry| &entry.shortcuts)
        .map(|keys| window.ctx.format_shortcut(keys))
        .collect();
    keys.sort_unstable();
    assert_eq!(keys.windows(2).find(|pair| pair[0] == pair[1]), None);
}

#[test]
fn the_palette_finds_commands_by_some_letters() {
    let mut window = window();
    ask(&mut window, "cond 10");
    assert_eq!(state(&window).condition().id(), ConditionId(10));
    ask(&mut window, "use physics V+10kt");
    assert_eq!(
        state(&window)
            .study
            .choice(ConditionId(10))
            .physics
            .pinned
            .as_deref(),
        Some("V+10kt")
    );
    ask(&mut window, "rej sug");
    assert_eq!(
        state(&window)
            .study
            .choice(ConditionId(10))
            .physics
            .rejected
            .len(),
        3
    );
    ask(&mut window, "show ped ny");
    let target = pair(&window, "NY", "PED");
    assert_eq!(state(&window).display.selection.pair, target);
    ask(&mut window, "release ped ny");
    assert!(!state(&window).study.settings.constrained[target]);
    ask(&mut window, "undo");
    assert!(state(&window).study.settings.constrained[target]);
}

#[test]
fn the_palette_is_worked_with_arrows_and_escape() {
    fn field(window: &Window) -> egui::Rect {
        window.get_by_label("Command palette").rect()
    }

    let mut window = window();
    let before = state(&window).study.clone();
    press(&mut window, Modifiers::COMMAND, Key::K);
    assert_eq!(state(&window).forms.shown, Some(FormKind::Palette));
    let place = field(&window);
    window.event(Event::Text("theme".to_owned()));
    window.run_steps(4);
    assert_eq!(
        field(&window),
        place,
        "the field stays in its place while letters are typed"
    );
    press(&mut window, Modifiers::NONE, Key::ArrowDown);
    press(&mut window, Modifiers::NONE, Key::ArrowDown);
    press(&mut window, Modifiers::NONE, Key::ArrowUp);
    assert_eq!(state(&window).forms.palette.chosen, 1);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(state(&window).forms.shown, None);
    assert_eq!(
        state(&window).condition().id(),
        ConditionId(1),
        "the arrows stayed in the palette"
    );
    assert_eq!(state(&window).study, before);
}

#[test]
fn the_palette_goes_to_a_field_and_what_is_typed_replaces_its_number() {
    let mut window = window();
    ask(&mut window, "alpha gains");
    window.run_steps(3);
    assert!(
        window
            .get_by_role_and_label(Role::SpinButton, "α gains")
            .is_focused()
    );
    window.event(Event::Text("12.5".to_owned()));
    press(&mut window, Modifiers::NONE, Key::Enter);
    settle(&mut window);
    assert_eq!(state(&window).study.settings.alpha_gain, 12.5);
}

#[test]
fn menus_show_what_the_table_says() {
    let mut window = window();
    for menu in ["File", "Edit", "View", "Help"] {
        click(&mut window, menu);
        let entries = command_table(state(&window));
        let of_menu = entries
            .iter()
            .filter(|entry| entry.menu.is_some_and(|(of, _)| format!("{of:?}") == menu));
        let mut count = 0;
        for entry in of_menu {
            let found = window.query_all_by_label_contains(&entry.name).any(|node| {
                node.accesskit_node().is_disabled() != entry.enabled
                    || entry.name == "Export corrections…"
            });
            assert!(found, "{menu}: {}", entry.name);
            count += 1;
        }
        assert!(count > 3, "{menu}");
        press(&mut window, Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn the_page_of_keys_is_made_from_the_table_and_fits_the_least_window() {
    let mut window = Harness::builder()
        .with_size(vec2(900.0, 560.0))
        .build_eframe(cold_example);
    settle(&mut window);
    press(&mut window, Modifiers::NONE, Key::F1);
    for entry in command_table(state(&window))
        .iter()
        .filter(|entry| !entry.shortcuts.is_empty())
    {
        assert!(
            window
                .query_all_by_label_contains(&entry.name)
                .next()
                .is_some(),
            "{}",
            entry.name
        );
    }
    let close = window.get_by_role_and_label(Role::Button, "Close").rect();
    assert!(close.max.y < 560.0, "{close}");
}

/// Returns the text that was put on the clipboard in the next frames.
fn copied(window: &mut Window) -> String {
    for _ in 0..4 {
        window.step();
        let commands = window.output().platform_output.commands.iter();
        let mut text = commands.filter_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        if let Some(text) = text.next_back() {
            return text;
        }
    }
    panic!("nothing was copied");
}

#[test]
fn every_table_is_copied_from_its_heading_with_the_figures_of_the_result() {
    let mut window = window();
    choose_condition_10(&mut window);
    for (heading, words) in [
        ("Heading of conditions", "airspeed [kt]"),
        ("Heading of physics models", "discontinuity ratio"),
        ("Heading of identified models", "mean distance"),
        ("Heading of responses (G, D, J)", "net delay [ms]"),
        ("Heading of channel gains and delays", "k [-]"),
    ] {
        window.get_by_label(heading).click_secondary();
        window.run_steps(2);
        window.get_by_label("Copy table").click();
        let text = copied(&mut window);
        assert!(text.contains(words), "{text}");
        if words == "k [-]" {
            let gain = state(&window).shown().unwrap().correction.output_gains[1];
            assert!(text.contains(&format!("{gain:?}")), "{gain}: {text}");
        }
        settle(&mut window);
    }
}

#[test]
fn a_table_is_saved_as_csv_and_an_existing_file_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("matrix.csv");
    let mut window = window();
    for is_second in [false, true] {
        ask_for_form(&mut window, "save table responses");
        window.event(Event::Text(path.to_str().unwrap().to_owned()));
        window.run_steps(2);
        press(&mut window, Modifiers::NONE, Key::Enter);
        settle(&mut window);
        assert_eq!(
            window.query_by_label("This file exists already").is_some(),
            is_second
        );
    }
    click(&mut window, "Overwrite");
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().count(), 25, "a heading and 6 × 4 responses");
    let shown = state(&window).shown().unwrap();
    let gain = shown.comparison.delta.gain[pair(&window, "Q", "LON")].unwrap();
    let line = text
        .lines()
        .find(|line| line.starts_with("Q,LON,yes,yes,yes,"))
        .expect("the response has its line");
    assert!(line.contains(&format!(",{gain:?},")), "{line}");
}

#[test]
fn tables_of_the_matrix_and_the_result_have_the_bars_of_their_figures() {
    fn percent(half: Option<f64>) -> String {
        format!("{:?}", 100.0 * half.unwrap())
    }

    fn cell(table: &Table, row: &[String], column: &str) -> String {
        row[table
            .columns
            .iter()
            .position(|name| name == column)
            .unwrap()]
        .clone()
    }

    let mut window = window();
    wait_for_bars(&mut window);
    let uncertainty = state(&window).uncertainty().unwrap();
    let condition = state(&window).condition().id();
    let pair = pair(&window, "Q", "LON");
    let bar = |scalar: Scalar| uncertainty.bar(condition, scalar).unwrap();
    let matrix = table_of(state(&window), TableKind::Matrix);
    assert!(
        matrix.title.ends_with(", ± at 90 % confidence"),
        "{}",
        matrix.title
    );
    let row = matrix
        .rows
        .iter()
        .find(|row| row[..2] == ["Q", "LON"])
        .unwrap();
    assert_eq!(
        cell(&matrix, row, "G ± [%]"),
        percent(bar(Scalar::Gain(pair)).half_width(0.9))
    );
    let inner = bar(Scalar::NetGain(pair)).inner_half_width(0.9);
    assert_eq!(
        cell(&matrix, row, "net gain ± from identification alone [%]"),
        percent(inner)
    );
    let delay = bar(Scalar::Delay(pair)).half_width(0.9).unwrap();
    assert_eq!(cell(&matrix, row, "D ± [ms]"), format!("{:?}", 1e3 * delay));
    let channels = table_of(state(&window), TableKind::Channels);
    let row = channels
        .rows
        .iter()
        .find(|row| row[..2] == ["output", "Q"])
        .unwrap();
    let gain = bar(Scalar::ChannelGain(Channel::Output(pair.output)));
    assert_eq!(
        cell(&channels, row, "k ± [%]"),
        percent(gain.half_width(0.9))
    );
    assert_eq!(
        cell(&channels, row, "k ± from identification alone [%]"),
        percent(gain.inner_half_width(0.9))
    );
}

/// Opens a form through the palette.
fn ask_for_form(window: &mut Window, query: &str) {
    press(window, Modifiers::COMMAND, Key::K);
    window.event(Event::Text(query.to_owned()));
    window.run_steps(2);
    press(window, Modifiers::NONE, Key::Enter);
    window.run_steps(2);
    assert!(
        state(window)
            .forms
            .shown
            .is_some_and(|form| form != FormKind::Palette),
        "{query}"
    );
}

#[test]
fn the_first_start_shows_the_tour_once_and_it_can_be_skipped() {
    let directory = tempfile::tempdir().unwrap();
    let setup = || Setup {
        directory: Some(directory.path().to_owned()),
        offers_tour: true,
        ..Setup::default()
    };
    let mut window = window_with(example(), setup());
    window.get_by_label("Flight conditions");
    for title in [
        "The bundle of models",
        "The curves",
        "Held responses",
        "The verdict",
    ] {
        click(&mut window, "Next step");
        window.get_by_label(title);
    }
    click(&mut window, "End the tour");
    assert_eq!(state(&window).tour, None);
    drop(window);
    let mut window = window_with(example(), setup());
    assert_eq!(state(&window).tour, None, "not again");
    ask(&mut window, "guided tour");
    window.get_by_label("Flight conditions");
    give(&mut window, AssemblingCommand::Open);
    assert!(
        window.query_by_label("Flight conditions").is_none(),
        "its notes are about panels that are not there"
    );
    give(&mut window, AssemblingCommand::Close);
    click(&mut window, "Skip the tour");
    assert_eq!(state(&window).tour, None);
}
