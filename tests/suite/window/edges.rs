//! Sparse data in the window.

use std::path::PathBuf;

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::sheet::Sheet;
use gdcm_io::{DatasetOrigin, load_dataset_bytes};

use super::views::give;
use super::*;
use crate::synthetic::two_lags;

/// Dataset whose last identified model ends at 11.9 rad/s.
const SHORT: &str = include_str!("../../data/edges/short-measurement.json");

/// Opens a dataset and waits for its results.
fn window_on(text: &str) -> Window {
    let origin = DatasetOrigin::File(PathBuf::from("edge.json"));
    window_with(
        Opened::Dataset(load_dataset_bytes(text.as_bytes(), origin).unwrap()),
        Setup::default(),
    )
}

#[test]
fn the_window_offers_to_ignore_an_unusual_gain() {
    let mut window =
        window_on(&two_lags([[1.0, 0.01], [0.0, 1.0]], [[1.2, 0.2], [0.0, 0.9]]).to_string());
    let pair = Pair::new(0, 1);
    assert!(!window.state().state().study.settings.ignored[pair]);
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Reasons)));
    window.get_by_label("Ignore I1 → O0").click();
    settle(&mut window);
    assert!(window.state().state().study.settings.ignored[pair]);
    assert!(
        window.query_by_label("Ignore I1 → O0").is_none(),
        "what is ignored is no caution"
    );
}

#[test]
fn a_model_set_aside_cannot_be_pinned_in_the_window() {
    let mut window = window_on(SHORT);
    give(&mut window, LayoutCommand::ShowIdentified(true));
    for model in ["i3", "i4"] {
        window
            .get_by_label(&format!("Use identified model {model} as representative"))
            .click();
        settle(&mut window);
        let pinned = window
            .state()
            .state()
            .study
            .choice(ConditionId(1))
            .identified
            .pinned
            .clone();
        assert_eq!(
            pinned.as_deref(),
            Some("i3"),
            "after a click on the star of {model}"
        );
    }
}
