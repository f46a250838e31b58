//! Memory that the window keeps between frames.

use gdcm::gui::commands::selection::SelectionCommand;

use super::views::{give, show};
use super::*;

#[test]
fn curves_of_other_conditions_are_not_kept() {
    let mut window = few_window();
    let pairs: Vec<Pair> = state(&window).dataset().on_axis().pairs().collect();
    let ids: Vec<ConditionId> = state(&window).dataset().ids().collect();
    assert!(ids.len() >= 2 && pairs.len() >= 4);
    for (number, pair) in pairs.iter().take(6).enumerate() {
        let id = ids[number % ids.len()];
        give(&mut window, SelectionCommand::SelectCondition(id));
        give(&mut window, SelectionCommand::FocusPair(*pair));
        let shapes = &state(&window).display.frequency.shapes;
        let shown = state(&window).responses().unwrap();
        assert!(!shapes.is_empty());
        for (pair, cache) in shapes {
            assert!(cache.is_from(shown), "{pair:?} of condition {id}");
        }
        assert!(shapes.len() <= 2, "{} responses", shapes.len());
    }
    // All cells of the overview share the curves of the condition.
    show(&mut window, View::Overview);
    let shapes = &state(&window).display.frequency.shapes;
    assert_eq!(shapes.len(), pairs.len());
}
