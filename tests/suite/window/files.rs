//! Opening and saving files.

use super::*;

#[test]
fn a_file_that_cannot_be_read_leaves_what_is_open_and_says_what_is_wrong() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    // Unsaved decisions are not lost without a question.
    let before = state(&window).study.clone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.json");
    std::fs::write(&path, "{\"format\": \"gdcm-dataset\", ").unwrap();
    open_by_path(&mut window, &path);
    assert!(
        window.query_by_label("Don't save").is_none(),
        "nothing is asked for a file that cannot be shown"
    );
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "json-cut-off",
        &["broken.json"],
    );
    assert_eq!(state(&window).study, before);
    assert!(state(&window).unsaved, "they are not saved still");
}

#[test]
fn models_of_another_program_that_are_opened_by_path_are_sent_to_their_import() {
    let folder = tempfile::tempdir().unwrap();
    crate::assembling::small_folder(folder.path());
    let mut window = window();
    open_by_path(&mut window, &folder.path().join("c1_60kt/V+5kt.mat"));
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "model-file",
        &["V+5kt.mat", "Import models"],
    );
}

#[test]
fn whether_to_lose_decisions_is_asked_once_the_file_is_found_good() {
    let mut window = window();
    click(&mut window, "Keep physics model V+10kt");
    let before = state(&window).study.clone();
    for answer in ["Cancel", "Don't save"] {
        window
            .input_mut()
            .dropped_files
            .push(std::sync::Arc::new(Dropped(small_dataset())));
        wait_until(&mut window, "the question", |window| {
            window.query_by_label(answer).is_some()
        });
        assert_eq!(
            state(&window).study,
            before,
            "what is open stays until the answer"
        );
        assert!(state(&window).unsaved);
        click(&mut window, answer);
        let opened = answer == "Don't save";
        assert_eq!(
            state(&window).dataset().conditions().len() == 2,
            opened,
            "{answer}"
        );
        assert_eq!(state(&window).unsaved, !opened, "{answer}");
    }
}

#[test]
fn decisions_are_saved_first_and_what_they_kept_waiting_is_opened_then() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.gdcm-study.json");
    let mut window = window();
    save_as(&mut window, &path);
    click(&mut window, "Keep physics model V+10kt");
    let decided = state(&window).study.choices.clone();
    open_by_path(&mut window, &small_dataset());
    click(&mut window, "Save study first");
    assert_eq!(
        state(&window).dataset().conditions().len(),
        2,
        "and it is open"
    );
    assert_eq!(open_study(&path).unwrap().study.choices, decided);
    // The postponed action is not carried out a second time.
    click(&mut window, "Keep physics model V+5kt");
    save_as(&mut window, &folder.path().join("other.gdcm-study.json"));
    assert_eq!(state(&window).study_name, "other.gdcm-study.json");
}

#[test]
fn a_study_whose_dataset_is_gone_loses_no_decision_before_the_dataset_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = folder.path().join("data.json");
    let study = folder.path().join("theirs.gdcm-study.json");
    std::fs::copy(small_dataset(), &dataset).unwrap();
    let mut theirs = window_with(
        load_any(&dataset, &Default::default()).unwrap(),
        Setup::default(),
    );
    save_as(&mut theirs, &study);
    drop(theirs);
    let moved = folder.path().join("moved.json");
    std::fs::rename(&dataset, &moved).unwrap();

    let mut window = window();
    click(&mut window, "Keep physics model V+10kt");
    open_by_path(&mut window, &study);
    assert!(
        window.query_by_label("Don't save").is_none(),
        "where its dataset is comes first"
    );
    fill(
        &mut window,
        "Path of the dataset",
        &folder.path().join("nowhere.json"),
    );
    click(&mut window, "Open with this dataset");
    assert!(state(&window).unsaved && state(&window).dataset().conditions().len() == 11);
    open_by_path(&mut window, &study);
    fill(&mut window, "Path of the dataset", &moved);
    click(&mut window, "Open with this dataset");
    click(&mut window, "Don't save");
    assert!(!state(&window).unsaved && state(&window).dataset().conditions().len() == 2);
}

/// Path to a dataset with two conditions.
pub(super) fn small_dataset() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json")
}

/// File dropped on the window.
#[derive(Debug)]
pub(super) struct Dropped(pub(super) std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dataset_dropped_on_the_window_is_opened() {
    let mut window = window();
    let path = small_dataset();
    window
        .input_mut()
        .dropped_files
        .push(std::sync::Arc::new(Dropped(path)));
    window.run_steps(1);
    settle(&mut window);
    assert_eq!(state(&window).dataset().conditions().len(), 2);
    assert_eq!(
        state(&window).notices.newest().map(|notice| notice.kind),
        Some(NoticeKind::Done)
    );
}

#[test]
fn a_study_is_saved_and_opens_with_the_same_result() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.gdcm-study.json");
    save_as(&mut window, &path);
    settle(&mut window);
    assert!(!state(&window).unsaved);
    let study = open_study(&path).unwrap().study;
    assert_eq!(study.choices, state(&window).study.choices);
    let gain = net_gain(&window, "Q", "LON");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert!(state(&window).unsaved);
    open_by_path(&mut window, &path);
    click(&mut window, "Don't save");
    click(&mut window, CONDITION_10);
    assert_eq!(net_gain(&window, "Q", "LON"), gain, "to the last digit");
}

#[test]
fn a_dataset_opened_again_is_analysed_again() {
    let mut window = window();
    let path = small_dataset();
    for _ in 0..2 {
        open_by_path(&mut window, &path);
        assert!(state(&window).analysis().is_some());
    }
}

#[test]
fn files_opened_of_late_are_in_the_menu_and_a_missing_one_cannot_be_chosen() {
    let directory = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let setup = Setup {
        directory: Some(directory.path().to_owned()),
        ..Setup::default()
    };
    let small = small_dataset();
    let mut window = window_with(example(), setup.clone());
    for name in ["first.json", "second.json"] {
        let path = folder.path().join(name);
        std::fs::copy(&small, &path).unwrap();
        open_by_path(&mut window, &path);
    }
    wait_until(&mut window, "both are listed", |window| {
        state(window).recent.len() == 2
    });
    std::fs::remove_file(folder.path().join("second.json")).unwrap();

    let mut window = window_with(example(), setup);
    wait_until(&mut window, "the list is read", |window| {
        state(window).recent.len() == 2
    });
    click(&mut window, "File");
    click(&mut window, "Open recent");
    let missing = window.get_by_label_contains("second.json");
    assert!(missing.accesskit_node().is_disabled());
    window.get_by_label_contains("first.json").click();
    settle(&mut window);
    assert_eq!(
        state(&window).dataset().conditions().len(),
        2,
        "the small dataset is open"
    );
}

#[test]
fn a_window_without_a_directory_of_its_own_lists_nothing() {
    let mut window = window();
    click(&mut window, "File");
    assert!(window.query_by_label("Open recent").is_none() && state(&window).recent.is_empty());
}
