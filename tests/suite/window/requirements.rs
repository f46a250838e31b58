//! The questions of a qualification by hand (M17).

use gdcm::view::arrangement::View;
use gdcm::view::views::RequirementsTable;
use gdcm_core::study::RequirementRole;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;
use gdcm::view::command::Command as Action;

fn texts(window: &Window) -> String {
    texts_in(window, egui::Rect::EVERYTHING).into_iter().map(|(text, _)| text).collect::<Vec<_>>().join("\n")
}

#[test]
fn bandwidth_modes_and_summary_stand_in_tables_and_a_row_is_marked_in_bode() {
    let mut window = window();
    show(&mut window, View::Requirements);
    wait_until(&mut window, "the requirements", |window| {
        state(window).requirements().is_some() && !state(window).results.background.is_busy()
    });
    let requirements = state(&window).requirements().unwrap().clone();
    let said = texts(&window);
    assert!(said.contains("these numbers are no qualification") && said.contains("ω_BW [rad/s]"), "{said}");
    // The numbers are those of the command: one finding a condition, measuring response and role.
    let roles = if state(&window).analysis().unwrap().schedule.is_ok() { 4 } else { 3 };
    let pairs = state(&window).dataset().measuring_pairs().marked().count();
    assert_eq!(requirements.bandwidth.len(), 11 * pairs * roles);
    let p_lat = pair(&window, "P", "LAT");
    let id = state(&window).condition().id();
    let corrected = requirements.bandwidth_of(id, p_lat, RequirementRole::Corrected).unwrap();
    let marked = [corrected.omega_bw_rad_s, corrected.omega_180_rad_s];
    let row = requirements.bandwidth.iter().position(|of| std::ptr::eq(of, corrected)).unwrap();
    let table = requirements.bandwidth_table(state(&window).dataset());
    assert_eq!(table.rows[row][3], "corrected");
    for (chosen, heading) in
        [(RequirementsTable::Modes, "physics ζ"), (RequirementsTable::Summary, "in MUAD on-axis [%]")]
    {
        give(&mut window, Action::ShowRequirements(chosen));
        assert!(texts(&window).contains(heading), "{heading}");
    }
    // A click on a mark goes to Bode, where the frequencies are marked that its numbers are read at.
    window.get_by_label_contains("Phase delay over bandwidth of LAT → P");
    give(&mut window, Action::ShowRequirements(RequirementsTable::Bandwidth));
    let first = requirements.bandwidth.first().unwrap();
    let rests = window.get_all_by_label(first.role.name()).last().unwrap().rect().center();
    window.drag_at(rests);
    window.drop_at(rests);
    window.run_steps(4);
    assert!(state(&window).display.arrangement.is_shown(View::Bode), "the row leads to Bode");
    assert_eq!(state(&window).display.pair, first.pair);
    assert!(marked.iter().all(Option::is_some), "{corrected:?}");
}
