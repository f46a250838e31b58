//! Recovery of unsaved decisions after the window has disappeared.

use std::path::PathBuf;

use gdcm::gui::state::notices::RecoveryOffer;

use super::*;

/// Returns a setup that keeps unsaved decisions in a separate directory, after a short delay.
fn setup(directory: &Path) -> Setup {
    Setup {
        directory: Some(directory.to_owned()),
        keep_after: Duration::from_millis(50),
        ..Setup::default()
    }
}

/// Returns the recovery files in a directory.
fn kept(directory: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(directory.join("recovery")) else {
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.to_str().unwrap().ends_with(".gdcm-study.json"))
        .collect()
}

/// Opens a window with unsaved decisions that have been written to the recovery directory.
fn with_decisions(opened: Opened, directory: &Path) -> Window {
    let mut window = window_with(opened, setup(directory));
    slide(&mut window, "α gains", 12.5);
    settle(&mut window);
    wait_until(&mut window, "the decisions are kept", |_| {
        !kept(directory).is_empty()
    });
    window
}

/// Opens further windows until one offers the lost decisions.
fn next_window(directory: &Path) -> Window {
    // A thread of the previous window may keep its recovery file open for a moment.
    let limit = Instant::now() + LIMIT;
    loop {
        let mut window = window_with(example(), setup(directory));
        for _ in 0..20 {
            window.run_steps(1);
            std::thread::sleep(Duration::from_millis(5));
        }
        if bar_codes(&window).contains(&"decisions-not-saved") {
            return window;
        }
        assert!(Instant::now() < limit, "nothing was offered");
    }
}

/// Returns the first offer to restore decisions.
fn offer(window: &Window) -> RecoveryOffer {
    let Some(MessageBar::Recovery(offer)) = state(window).notices.bars().next() else {
        panic!("{:?}", bar_codes(window))
    };
    offer.clone()
}

#[test]
fn decisions_that_were_not_saved_are_offered_at_the_next_start_and_restored() {
    let directory = tempfile::tempdir().unwrap();
    let lost = with_decisions(example(), directory.path());
    let study = state(&lost).study.clone();
    drop(lost);
    let file = kept(directory.path()).remove(0);
    assert_eq!(
        open_study(&file).unwrap().study,
        study,
        "it is a study, and opens by hand too"
    );

    let mut window = next_window(directory.path());
    let offer = offer(&window);
    assert_eq!(offer.study, None);
    window.get_by_label_contains(&offer.dataset);
    click(&mut window, "Restore");
    assert_eq!(state(&window).study, study);
    assert!(state(&window).unsaved, "restored is not saved");
    assert!(window.query_by_label("Restore").is_none());
    wait_until(&mut window, "only this window's own file is left", |_| {
        let files = kept(directory.path());
        files.len() == 1 && files[0] != file
    });
}

#[test]
fn a_study_that_was_saved_before_is_offered_by_its_name_and_saved_there_again() {
    let directory = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let dataset = folder.path().join("data.json");
    std::fs::copy(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json"),
        &dataset,
    )
    .unwrap();
    let mut lost = window_with(
        load_any(&dataset, &Default::default()).unwrap(),
        setup(directory.path()),
    );
    let path = folder.path().join("mine.gdcm-study.json");
    save_as(&mut lost, &path);
    slide(&mut lost, "α gains", 12.5);
    settle(&mut lost);
    drop(lost);

    let mut window = next_window(directory.path());
    let offer = offer(&window);
    assert_eq!(
        (offer.dataset.as_str(), offer.study.as_deref()),
        ("data.json", Some("mine.gdcm-study.json"))
    );
    window.get_by_label_contains("mine.gdcm-study.json");
    click(&mut window, "Restore");
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    settle(&mut window);
    assert!(!state(&window).unsaved);
    wait_until(&mut window, "the list is read", |window| {
        !state(window).recent.is_empty()
    });
    let recent: Vec<&str> = state(&window)
        .recent
        .iter()
        .map(|file| file.name.as_str())
        .collect();
    assert_eq!(
        recent,
        ["mine.gdcm-study.json", "data.json"],
        "the recovery file is none of them"
    );
    assert_eq!(open_study(&path).unwrap().study.settings.alpha_gain, 12.5);
}

#[test]
fn what_is_saved_or_taken_back_leaves_no_recovery_file() {
    let directory = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut window = with_decisions(example(), directory.path());
    save_as(&mut window, &folder.path().join("mine.gdcm-study.json"));
    wait_until(&mut window, "saved: the file is gone", |_| {
        kept(directory.path()).is_empty()
    });
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    wait_until(&mut window, "another decision is kept", |_| {
        !kept(directory.path()).is_empty()
    });
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    settle(&mut window);
    wait_until(&mut window, "as saved again: the file is gone", |_| {
        kept(directory.path()).is_empty()
    });
}

#[test]
fn discarded_decisions_are_gone_and_later_they_are_offered_again() {
    let directory = tempfile::tempdir().unwrap();
    drop(with_decisions(example(), directory.path()));
    let mut window = next_window(directory.path());
    click(&mut window, "Later");
    assert!(bar_codes(&window).is_empty());
    drop(window);
    let mut window = next_window(directory.path());
    click(&mut window, "Discard");
    assert!(bar_codes(&window).is_empty());
    wait_until(&mut window, "the file is gone", |_| {
        kept(directory.path()).is_empty()
    });
}

#[test]
fn the_decisions_of_a_window_that_is_open_are_not_offered_to_another() {
    let directory = tempfile::tempdir().unwrap();
    let first = with_decisions(example(), directory.path());
    let mut second = with_decisions(example(), directory.path());
    wait_until(&mut second, "each has its own file", |_| {
        kept(directory.path()).len() == 2
    });
    for window in [&first, &second] {
        assert!(bar_codes(window).is_empty());
    }
}

#[test]
fn decisions_that_are_lost_on_purpose_are_not_offered() {
    let directory = tempfile::tempdir().unwrap();
    let mut window = with_decisions(example(), directory.path());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    window.run_steps(2);
    window.get_by_label("Don't save").click();
    window.run_steps(2);
    drop(window);
    let limit = Instant::now() + LIMIT;
    while !kept(directory.path()).is_empty() {
        assert!(Instant::now() < limit, "the file stays");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn decisions_stay_safe_where_what_was_to_be_opened_in_their_place_cannot_be_read() {
    let directory = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut window = with_decisions(example(), directory.path());
    let broken = folder.path().join("broken.json");
    std::fs::write(&broken, "{").unwrap();
    open_by_path(&mut window, &broken);
    assert!(window.query_by_label("Don't save").is_none());
    assert_eq!(
        state(&window).notices.newest().map(|notice| notice.kind),
        Some(NoticeKind::Trouble)
    );
    assert!(state(&window).unsaved && !kept(directory.path()).is_empty());
}
