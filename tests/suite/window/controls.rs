//! Accessible names of all controls; start without a display.

use super::*;

#[test]
fn every_control_has_a_label_of_its_own() {
    let window = window();
    let mut labels: Vec<(Role, String)> = Vec::new();
    let controls = [
        Role::Button,
        Role::CheckBox,
        Role::Slider,
        Role::SpinButton,
        Role::ComboBox,
        Role::TextInput,
    ];
    for node in window.root().children_recursive() {
        let role = node.accesskit_node().role();
        if controls.contains(&role) {
            let label = node.accesskit_node().label().unwrap_or_default();
            assert!(!label.is_empty(), "a control without a label: {role:?}");
            labels.push((role, label));
        }
    }
    assert!(
        labels.len() > 80,
        "the controls were found: {}",
        labels.len()
    );
    labels.sort_by(|a, b| a.1.cmp(&b.1));
    let twice: Vec<_> = labels
        .windows(2)
        .filter(|pair| pair[0] == pair[1])
        .map(|pair| &pair[0])
        .collect();
    assert!(twice.is_empty(), "{twice:?}");
}

/// Starts the window without a display; returns exit status and message.
#[cfg(target_os = "linux")]
fn without_a_display(arguments: &[&Path]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gdcm"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .args(arguments)
        .output()
        .unwrap();
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_one_line_names_the_headless_command() {
    let (status, words) = without_a_display(&[]);
    assert_eq!(status, Some(1));
    assert_eq!(words.trim_end().lines().count(), 1, "{words}");
    assert!(
        words.contains("no display") && words.contains("gdcm analyze"),
        "{words}"
    );
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_a_file_that_is_wrong_is_told_on_the_terminal_with_its_own_status() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.json");
    std::fs::write(&path, "{\"format\": ").unwrap();
    let (status, words) = without_a_display(&[&path]);
    assert_eq!(status, Some(2), "{words}");
    assert_eq!(words.matches("error: ").count(), 1, "{words}");
    assert!(words.contains("broken.json"), "{words}");
}
