//! The frame of the window: places that stay, axes that seldom move, pages, and the dock.

use egui::Rect;

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::sheet::Sheet;
use gdcm::gui::state::view::{View, ViewGroup};
use gdcm::gui::state::view_pages::{CouplingsPage, EvidencePage, PolesPage};
use gdcm_method::uncertainty::Scalar;
use gdcm_plot::figure::Range;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting_table;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;

const SMALL: egui::Vec2 = vec2(1280.0, 720.0);
const USUAL: egui::Vec2 = vec2(1600.0, 900.0);

fn window_of(size: egui::Vec2) -> Window {
    let mut window = Harness::builder()
        .with_size(size)
        .build_eframe(warm_example);
    settle(&mut window);
    window
}

/// Places of the parts that no step may move.
fn fixed_places(window: &Window) -> Vec<Rect> {
    let mut places = Vec::new();
    for part in ["Gain: ", "Phase: "] {
        places.push(window.get_by_label_contains(part).rect());
    }
    for label in ["Response LON → Q", "Response COL → NZ"] {
        places.push(window.get_by_label(label).rect());
    }
    places.push(export_button(window));
    places.push(bode_frame(window, Pane::Magnitude));
    places.push(bode_frame(window, Pane::Phase));
    places
}

fn export_button(window: &Window) -> Rect {
    let mut found = window
        .query_all_by_role(Role::Button)
        .filter(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            label.starts_with("Export")
        })
        .map(|node| node.rect());
    found.next().expect("the button is drawn")
}

fn bode_frame(window: &Window, pane: Pane) -> Rect {
    let view = &state(window).display.frequency.bode;
    *view.transform(pane).expect("the pane is drawn").frame()
}

#[test]
fn verdict_matrix_and_export_stay_when_a_step_is_taken() {
    for size in [USUAL, SMALL] {
        let mut window = window_of(size);
        choose_condition_10(&mut window);
        let before = fixed_places(&window);
        let reject = window.get_by_label("Reject 3 suggested").rect();
        click(&mut window, "Reject 3 suggested");
        assert_eq!(fixed_places(&window), before, "after rejecting at {size}");
        let leads = window.get_by_label("Use leads").rect();
        assert_eq!(
            (leads.min, leads.height()),
            (reject.min, reject.height()),
            "the primary step keeps its place"
        );
        let reasons = window.get_by_label("Find the cause").rect();
        click(&mut window, "Use leads");
        assert_eq!(fixed_places(&window), before, "after the leads at {size}");
        assert_eq!(
            window.get_by_label("Find the cause").rect(),
            reasons,
            "the link keeps its place"
        );
    }
}

#[test]
fn the_verdict_stays_while_the_next_results_are_computed() {
    let mut window = window_of(USUAL);
    choose_condition_10(&mut window);
    window.get_by_label("Reject 3 suggested").click();
    window.run_steps(1);
    while state(&window).results.is_waiting() {
        let reject = window.query_by_label("Reject 3 suggested");
        assert!(reject.is_some(), "the step stays until the results arrive");
        window.run_steps(1);
    }
    settle(&mut window);
    assert!(window.query_by_label("Reject 3 suggested").is_none());
    window.get_by_label("Use leads");
}

/// Returns the value range of the net-gain plots.
fn net_gain_range(window: &Window) -> Range {
    let view = &state(window).display.figures[&View::NetGain];
    let bounds = *view.transform(0).expect("it is drawn").bounds();
    Range::new(bounds.min()[1], bounds.max()[1])
}

#[test]
fn error_bars_appear_without_moving_the_axes() {
    let mut window = few_window();
    wait_for_bars(&mut window);
    window.run_steps(3);
    let with_bars = net_gain_range(&window);
    let frame = *state(&window).display.figures[&View::NetGain]
        .transform(0)
        .unwrap()
        .frame();
    give(&mut window, DisplayCommand::ShowBars(false));
    window.run_steps(2);
    assert_eq!(net_gain_range(&window), with_bars);
    give(&mut window, DisplayCommand::FitPlots);
    window.run_steps(2);
    let fitted = net_gain_range(&window);
    give(&mut window, DisplayCommand::ShowBars(true));
    window.run_steps(2);
    assert_eq!(net_gain_range(&window), fitted, "after a fit too");
    let now = *state(&window).display.figures[&View::NetGain]
        .transform(0)
        .unwrap()
        .frame();
    assert_eq!(now, frame);
}

#[test]
fn error_bars_of_values_stay_until_the_new_ones_are_computed() {
    let mut window = few_window();
    wait_for_bars(&mut window);
    let bar = |window: &Window| {
        let pair = state(window).display.selection.pair;
        state(window)
            .painted_uncertainty()
            .half_width(Scalar::Gain(pair))
            .expect("there is always a bar")
    };
    let is_older = |window: &Window| state(window).older_uncertainty().is_some();
    assert!(bar(&window) > 0.0 && !is_older(&window));
    window
        .state_mut()
        .dispatch(setting_table::ALPHA_GAIN.to(3.0));
    window.run_steps(1);
    let mut was_older = false;
    while state(&window).uncertainty().is_none() || state(&window).results.is_behind() {
        was_older |= bar(&window) > 0.0 && is_older(&window);
        window.run_steps(1);
    }
    assert!(was_older && !is_older(&window));
}

fn bode_ranges(window: &Window) -> [Range; 2] {
    let view = &state(window).display.frequency.bode;
    [Pane::Magnitude, Pane::Phase].map(|pane| view.value_range(pane))
}

#[test]
fn chips_selections_and_small_decisions_leave_the_axes() {
    let mut window = window_of(USUAL);
    choose_condition_10(&mut window);
    let before = bode_ranges(&window);
    for _ in 0..2 {
        click(&mut window, "Show nominal");
        assert_eq!(bode_ranges(&window), before, "a chip");
    }
    window.hover_at(bode_frame(&window, Pane::Magnitude).center());
    window.run_steps(3);
    assert_eq!(bode_ranges(&window), before, "the pointer");
    give(&mut window, setting_table::ALPHA_GAIN.to(1.2));
    assert_eq!(bode_ranges(&window), before, "a small change");
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    wait_until(&mut window, "curves above the band", |window| {
        state(window).display.frequency.bode.omega_range().1 > 100.0
    });
    let grown = bode_ranges(&window)[0];
    assert!(grown.min < before[0].min - 20.0, "{grown:?} {before:?}");
}

/// Returns the numbers painted in an area.
fn numbers(window: &Window, area: Rect) -> Vec<f64> {
    let mut numbers = Vec::new();
    for (text, _) in texts_in(window, area) {
        if let Ok(number) = text.replace('\u{2212}', "-").parse() {
            numbers.push(number);
        }
    }
    numbers
}

#[test]
fn each_bode_axis_has_five_ticks_on_a_small_screen() {
    let mut window = window_of(SMALL);
    for phase in [PhaseCorrection::Delay, PhaseCorrection::Lead] {
        give(&mut window, setting_table::PHASE.to(phase));
        for response in ["LON → Q", "LAT → P", "PED → R", "COL → NZ"] {
            click(&mut window, &format!("Response {response}"));
            window.run_steps(3);
            for pane in [Pane::Magnitude, Pane::Phase] {
                let frame = bode_frame(&window, pane);
                let axis = frame
                    .with_min_x(frame.left() - 40.0)
                    .with_max_x(frame.left());
                let ticks = numbers(&window, axis.expand2(vec2(0.0, 6.0)));
                assert!(ticks.len() >= 5, "{response} {pane:?} {phase:?}: {ticks:?}");
            }
            let frame = bode_frame(&window, Pane::Phase);
            let axis = frame.with_min_y(frame.bottom()).expand2(vec2(8.0, 16.0));
            let axis = axis.with_min_y(frame.bottom() + 1.0);
            let ticks = numbers(&window, axis);
            assert!(ticks.len() >= 5, "{response} {phase:?}: {ticks:?}");
        }
    }
}

#[test]
fn the_dock_is_the_only_place_of_the_net_gains_and_a_double_click_doubles_it() {
    let mut window = window_of(USUAL);
    for group in ViewGroup::ALL {
        give(&mut window, LayoutCommand::ShowGroup(group));
        for page in [View::NetGain, View::Leads] {
            let tab = window.query_by_role_and_label(Role::Tab, page.name());
            assert!(tab.is_none(), "{page:?} is a page of the dock");
        }
    }
    show(&mut window, View::Bode);
    window.run_steps(2);
    let height = |window: &Window| window.get_by_label("Enlarge the dock").rect().top();
    let low = 900.0 - 24.0 - height(&window);
    let bar = window.get_by_label("Enlarge the dock").rect();
    // In the test harness, frames are 0.25 s apart, so that a double click needs a longer delay.
    window
        .ctx
        .options_mut(|options| options.input_options.max_double_click_delay = 5.0);
    for _ in 0..2 {
        window.drag_at(bar.center());
        window.run_steps(1);
        window.drop_at(bar.center());
        window.run_steps(1);
    }
    window.run_steps(3);
    assert!(state(&window).display.layout.arrangement.is_dock_enlarged());
    let high = 900.0 - 24.0 - height(&window);
    assert!((high - 2.0 * low).abs() <= 1.0, "{low} {high}");
    give(&mut window, LayoutCommand::EnlargeDock(false));
    window.run_steps(3);
    assert_eq!(900.0 - 24.0 - height(&window), low);
    // The channels contain the net gains' parts and take the whole height.
    show(&mut window, View::Channels);
    window.run_steps(2);
    assert!(window.query_by_label("Enlarge the dock").is_none());
    show(&mut window, View::NetGain);
    window.get_by_label("Enlarge the dock");
}

#[test]
fn leads_are_a_page_of_the_dock_while_there_are_leads() {
    let mut window = window_of(USUAL);
    assert!(window.query_by_label("Page Leads").is_none());
    let entry = |window: &Window| {
        let entries = gdcm::gui::commands::command_table::command_table(state(window));
        let found = entries.into_iter().find(|entry| entry.name == "Show Leads");
        found.expect("the palette has it")
    };
    assert!(!entry(&window).enabled && entry(&window).meaning.contains("Use leads"));
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    assert!(entry(&window).enabled);
    click(&mut window, "Page Leads");
    assert!(
        !texts_in(&window, Rect::EVERYTHING)
            .iter()
            .any(|(text, _)| text.starts_with("No leads")),
        "their plots are drawn"
    );
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Delay));
    window.run_steps(2);
    assert!(window.query_by_label("Page Leads").is_none());
    let transform = state(&window).display.figures[&View::NetGain].transform(0);
    assert!(transform.is_some(), "the net gains are in front again");
}

#[test]
fn the_reasons_cover_no_plot_and_escape_closes_them() {
    for size in [USUAL, SMALL] {
        let mut window = window_of(size);
        choose_condition_10(&mut window);
        click(&mut window, "Reject 3 suggested");
        let frames = [Pane::Magnitude, Pane::Phase].map(|pane| bode_frame(&window, pane));
        let gain = window.get_by_label_contains("Gain: ").rect();
        click(&mut window, "Find the cause");
        assert_eq!(state(&window).display.layout.sheet, Some(Sheet::Reasons));
        let close = window.get_by_label("Close the sheet").rect();
        assert!(close.top() > gain.bottom() && close.left() > frames[0].right());
        for (pane, frame) in [Pane::Magnitude, Pane::Phase].into_iter().zip(frames) {
            assert_eq!(bode_frame(&window, pane), frame);
        }
        // The steps have the names of the verdict and of the views.
        for cause in ["Show Records", "Show Error", "Show Channels"] {
            assert!(window.query_all_by_label(cause).next().is_some(), "{cause}");
        }
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert_eq!(state(&window).display.layout.sheet, None);
    }
}

#[test]
fn every_view_has_its_pages_in_the_same_bar_and_keys_change_them() {
    let mut window = window_of(USUAL);
    let pages = [
        (
            View::Overview,
            ["Magnitude", "Magnitude and phase"].as_slice(),
        ),
        (View::Poles, &["s-plane", "Modes"]),
        (View::Couplings, &["Benefit", "Matrices", "Loop"]),
        (View::Channels, &["Gains", "Delays"]),
        (View::Evidence, &["Findings", "Differences", "Forms"]),
        (View::Assessment, &["Bars", "Table"]),
        (View::Compare, &["Decisions", "Effects"]),
    ];
    let mut tops = Vec::new();
    for (view, names) in pages {
        show(&mut window, view);
        window.run_steps(2);
        for name in names {
            tops.push(window.get_by_label(&format!("Page {name}")).rect().top());
        }
    }
    assert!(tops.windows(2).all(|pair| pair[0] == pair[1]), "{tops:?}");
    assert!(
        (76.0..=116.0).contains(&tops[0]),
        "in the page bar: {tops:?}"
    );
    let mut press = |view: View, key: Key| {
        show(&mut window, view);
        window.key_press_modifiers(Modifiers::ALT, key);
        window.run_steps(3);
        state(&window).display.pages
    };
    assert_eq!(press(View::Poles, Key::PageDown).poles, PolesPage::Modes);
    assert_eq!(
        press(View::Couplings, Key::PageUp).couplings,
        CouplingsPage::Loop
    );
    assert_eq!(
        press(View::Evidence, Key::PageDown).evidence,
        EvidencePage::Differences
    );
}

#[test]
fn poles_and_assessment_show_every_plot_on_a_small_screen() {
    let mut window = window_of(SMALL);
    show(&mut window, View::Poles);
    wait_until(&mut window, "the modes", |window| {
        state(window).modes().is_some()
    });
    window.run_steps(3);
    assert_whole(&window, View::Poles, 2);
    show(&mut window, View::Assessment);
    wait_until(&mut window, "the assessment", |window| {
        state(window).assessment().is_some()
    });
    window.run_steps(3);
    assert_whole(&window, View::Assessment, 5);
}

/// Asserts that the frames of all plots of a view lie between the page bar and the dock.
#[track_caller]
fn assert_whole(window: &Window, view: View, plots: usize) {
    let dock = window.get_by_label("Enlarge the dock").rect();
    let figure = &state(window).display.figures[&view];
    for plot in 0..plots {
        let frame = *figure.transform(plot).expect("it is drawn").frame();
        assert!(
            frame.bottom() < dock.top() && frame.top() > 116.0 && frame.right() < 960.0,
            "{view:?} {plot}: {frame}"
        );
        assert!(frame.width() > 60.0 && frame.height() > 60.0, "{frame}");
    }
}

#[test]
fn the_upper_blocks_of_the_panels_are_the_same_beside_every_view() {
    let mut window = window_of(USUAL);
    let places = |window: &Window| {
        let gain = window.get_by_label_contains("Gain: ").rect();
        let first = window.get_by_label_contains("Condition 1: ").rect();
        let last = window.get_by_label_contains("Condition 11: ").rect();
        [gain, first, last]
    };
    let before = places(&window);
    assert!(before[2].bottom() <= 344.0, "{before:?}");
    for view in View::ALL {
        give(&mut window, LayoutCommand::ShowView(view));
        window.run_steps(2);
        assert_eq!(places(&window), before, "{view:?}");
    }
}
