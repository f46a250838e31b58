//! Leads in the window: enabled, displayed and undone (M15).

use std::cell::Cell;

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::sheet::Sheet;
use gdcm::gui::state::view::View;
use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_model::units::signed;
use gdcm_study::decisions::setting_table;
use gdcm_study::{AssessedCorrection, PhaseCorrection};
use gdcm_words::leads::lead_words;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;

fn choose(window: &mut Window, list: &str, choice: &str) {
    unfold_settings(window, true);
    scroll_to(window, list);
    window.get_by_role_and_label(Role::ComboBox, list).click();
    window.run_steps(3);
    click(window, choice);
}

/// Scrolls to a control, which may be outside the visible part of the panel, until it stays in the
/// window.
fn scroll_to(window: &mut Window, label: &str) {
    let frame = window.ctx.content_rect();
    let before = Cell::new(egui::Rect::NOTHING);
    window.get_by_label(label).scroll_to_me();
    wait_until(window, label, |window| {
        let place = window.get_by_label(label).rect();
        before.replace(place) == place && frame.contains_rect(place)
    });
}

/// Opens the settings and chooses a phase correction.
fn choose_phase(window: &mut Window, choice: &str) {
    unfold_settings(window, true);
    click(window, &format!("Phase correction: {choice}"));
}

#[test]
fn what_leads_cost_is_drawn_up_to_ten_times_the_band_and_the_flight_ends_where_it_says_nothing() {
    fn last(window: &Window, role: CurveRole) -> f64 {
        let curve = drawn(window, role);
        let known = curve
            .omega
            .iter()
            .zip(curve.magnitude_db.iter())
            .filter(|(_, db)| db.is_finite());
        known.map(|(omega, _)| *omega).next_back().unwrap()
    }

    let mut window = window();
    // Curves are drawn up to 1.7 times the upper end of the band, 12 rad/s.
    assert!((last(&window, CurveRole::Corrected) - 20.4).abs() < 1e-6);
    let before = state(&window).display.frequency.bode.omega_range().1;
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    wait_until(&mut window, "curves up to ten times the band", |window| {
        (last(window, CurveRole::Corrected) - 120.0).abs() < 1e-6
    });
    let flight = last(&window, CurveRole::IdentifiedRepresentative);
    assert!(flight <= 20.4 * (1.0 + 1e-9) && flight > 20.0, "{flight}");
    assert!(
        (before - 20.4).abs() < 1e-6
            && (state(&window).display.frequency.bode.omega_range().1 - 120.0).abs() < 1e-6
    );
    let texts: Vec<String> = texts_in(&window, egui::Rect::EVERYTHING)
        .into_iter()
        .map(|(text, _)| text)
        .collect();
    assert!(
        texts.iter().any(|text| text.ends_with(" 12 rad/s")),
        "{texts:?}"
    );
    let at_end = |role| {
        drawn(&window, role)
            .value_at(Pane::Magnitude, 120.0)
            .unwrap()
    };
    let price = format!(
        "{} dB",
        signed(
            at_end(CurveRole::Corrected) - at_end(CurveRole::WithoutLeads),
            1
        )
    );
    assert!(texts.contains(&price), "{price} in {texts:?}");
}

#[test]
fn nothing_that_leads_say_makes_the_answer_wider_than_its_panel() {
    fn last_cell(window: &Window) -> egui::Rect {
        window.get_by_label("Response COL → NZ").rect()
    }

    let mut window = Harness::builder()
        .with_size(vec2(1280.0, 720.0))
        .build_eframe(warm_example);
    settle(&mut window);
    let before = last_cell(&window);
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    window.get_by_label("Find the cause");
    assert_eq!(last_cell(&window), before);
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Delay));
    assert_eq!(last_cell(&window), before, "and back");
    assert!(before.right() < 1280.0);
}

#[test]
fn one_click_takes_the_lead_that_the_result_offers_and_undo_gives_it_back() {
    let mut window = window();
    let before = state(&window).shown().unwrap().correction.clone();
    assert!(before.leads.is_none());
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Reasons)));
    // The verdict above the sheet may offer the same step.
    let sheet_top = window.get_by_label("Close the sheet").rect().top();
    window
        .query_all_by_label("Use leads")
        .find(|button| button.rect().top() > sheet_top)
        .expect("the sheet offers leads")
        .click_accesskit();
    settle(&mut window);
    assert_eq!(state(&window).study.settings.phase, PhaseCorrection::Lead);
    let shown = state(&window).shown().unwrap();
    assert!(shown.correction.leads.is_some() && shown.offer.is_none());
    assert!(
        window.query_all_by_label("Use leads").next().is_none(),
        "it is taken"
    );
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(
        state(&window).shown().unwrap().correction,
        before,
        "to the last digit"
    );
}

#[test]
fn the_phase_is_chosen_beside_alpha_with_what_belongs_to_it() {
    let mut window = window();
    assert!(
        window.query_by_label("n of the lead filters").is_none(),
        "there are no filters yet"
    );
    choose_phase(&mut window, "delay or lead");
    assert_eq!(state(&window).study.settings.phase, PhaseCorrection::Lead);
    for label in [
        "n of the lead filters",
        "R_max of the lead filters",
        "Order of the lead filters",
    ] {
        window.get_by_label(label);
    }
    choose_phase(&mut window, "none");
    assert!(window.query_by_label("n of the lead filters").is_none());
    let correction = &state(&window).shown().unwrap().correction;
    assert!(
        correction
            .input_delays_s
            .iter()
            .chain(&correction.output_delays_s)
            .all(|delay_s| *delay_s == 0.0)
    );
}

#[test]
fn the_settings_say_that_g_from_the_mean_has_no_effect_with_leads() {
    let mut window = window();
    choose(&mut window, "Source of G", "mean of pairs");
    assert!(window.query_by_label("No effect with leads").is_none());
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    settle(&mut window);
    assert!(state(&window).study.settings.is_gain_source_idle());
    scroll_to(&mut window, "Source of G");
    assert!(window.query_by_label("No effect with leads").is_some());
    choose(&mut window, "Source of G", "representatives");
    assert!(window.query_by_label("No effect with leads").is_none());
}

#[test]
fn the_phase_without_leads_lies_beside_the_corrected_one_and_the_result_tells_servos() {
    let mut window = window();
    let gains_alone = drawn(&window, CurveRole::Corrected);
    choose_phase(&mut window, "delay or lead");
    let with = drawn(&window, CurveRole::Corrected);
    let without = drawn(&window, CurveRole::WithoutLeads);
    let top = state(&window).study.settings.band.max();
    let phase = |curve: &BodeCurve| curve.value_at(Pane::Phase, top).unwrap();
    assert!(
        phase(&with) > phase(&without) + 10.0,
        "lead turns the phase up"
    );
    // The phases are equal because the example's correction has no delays; only the gains differ
    // slightly. Interpolation between the frequencies of two grids adds an error of about 0.01
    // degrees.
    assert!((phase(&without) - phase(&gains_alone)).abs() < 0.05);
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Reasons)));
    let shown = state(&window).shown().unwrap();
    let uncertainty = state(&window).uncertainty().map(AsRef::as_ref);
    let told = lead_words(&state(&window).study, shown, uncertainty);
    for words in &told {
        window.get_by_label(words);
    }
    let filters = &shown.compensated.as_ref().unwrap().leads;
    for channel in Channel::of_dataset(state(&window).dataset()) {
        let name = channel.name_in(state(&window).dataset());
        assert!(
            told.iter()
                .any(|words| words.starts_with(&format!("{name}: "))),
            "{name} in {told:?}"
        );
    }
    let limit = LeadPrice::new(filters).unwrap().limit_rad_s;
    assert_eq!(limit, 12.0);
    assert!(!remarks_shown(state(&window), state(&window).shown().unwrap()).is_empty());
}

#[test]
fn channels_show_signed_delays_within_their_bounds() {
    let mut window = window();
    choose_phase(&mut window, "delay or lead");
    give(
        &mut window,
        DisplayCommand::ShowChannels(Measure::Delay, Across::Conditions),
    );
    let figure = channel_plots(state(&window)).figure;
    let taus: Vec<f64> = figure
        .panels()
        .flat_map(|(_, panel)| panel.dots())
        .map(|dot| dot.y)
        .collect();
    assert_eq!(taus.len(), 110);
    assert!(taus.iter().any(|tau| *tau < -20.0), "lead is down");
    assert!(
        taus.iter().any(|tau| *tau > 20.0),
        "NX wants delay in condition 4"
    );
}

#[test]
fn the_assessment_is_had_without_the_leads_too() {
    fn mean(window: &Window) -> f64 {
        let table = state(window).assessment().unwrap();
        let measuring = state(window).dataset().measuring_pairs();
        let changes = table
            .conditions
            .iter()
            .flat_map(|of| measuring.marked().filter_map(|pair| of.changes[pair]));
        let after: Vec<f64> = changes.map(|change| change.corrected.total()).collect();
        after.iter().sum::<f64>() / after.len() as f64
    }

    let mut window = window();
    choose_phase(&mut window, "delay or lead");
    show(&mut window, View::Assessment);
    let with = mean(&window);
    choose(&mut window, "Correction assessed", "scheduled, no leads");
    wait_until(&mut window, "the assessment", |window| {
        state(window).assessment().is_some_and(|table| {
            table.choice.correction == AssessedCorrection::ScheduledWithoutLeads
        })
    });
    let without = mean(&window);
    assert!(with < 0.4 * without, "{with} with leads, {without} without");
}
