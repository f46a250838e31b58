//! Files rejected before their content is examined.

use super::*;

#[test]
fn a_file_that_is_not_there_is_named() {
    let message = load_dataset(Path::new("no/such/file.json"))
        .unwrap_err()
        .to_string();
    assert_eq!(message, "no/such/file.json: there is no such file");
}

#[test]
fn a_directory_is_refused_as_one() {
    let directory = tempfile::tempdir().unwrap();
    let error = load_dataset(directory.path()).unwrap_err();
    assert!(
        matches!(&error, FileError::Directory { path } if path == directory.path()),
        "{error}"
    );
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read_is_refused() {
    // A link to itself cannot be read by any user, not even by the superuser.
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("loop.json");
    std::os::unix::fs::symlink(&path, &path).unwrap();
    let error = load_dataset(&path).unwrap_err();
    assert!(matches!(error, FileError::Unreadable { .. }), "{error}");
}

#[test]
fn text_that_is_not_json_is_refused_with_its_line() {
    for text in [
        "",
        "Omega, Re, Im\n0.5, 1, 2\n",
        "\0\0\0\0",
        "{'format': 1}",
        "\u{feff}\u{feff}{}",
    ] {
        let message = refusal(text.as_bytes());
        assert!(
            message.contains("JSON") && message.contains("line 1"),
            "{message}"
        );
    }
    assert_text_refused(
        "\"mass_kg\": 6600",
        "\"mass_kg\": 6600,,",
        &["condition 7", "this is not JSON", "line"],
    );
}

#[test]
fn a_file_that_is_cut_off_says_where() {
    let cut = SMALL.find("\"V+5kt\"").unwrap() + 120;
    let message = refusal(&SMALL.as_bytes()[..cut]);
    assert!(
        message.contains("condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)"),
        "{message}"
    );
    assert!(message.contains("ends too early"), "{message}");
}

#[test]
fn text_after_the_end_is_refused() {
    assert!(refusal(format!("{SMALL}{{}}").as_bytes()).contains("trailing characters"));
}

#[test]
fn a_broken_gzip_file_is_refused() {
    let mut packed = gzip(SMALL.as_bytes());
    let middle = packed.len() / 2;
    assert!(refusal(&packed[..middle]).contains("end too early"));
    packed[middle] ^= 0xff;
    assert!(refusal(&packed).contains("gzip data"));
    assert!(refusal(&[0x1f, 0x8b, 0, 0]).contains("gzip data"));
}

#[test]
fn a_small_file_that_unpacks_to_more_than_the_limit_is_refused() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    let blank = vec![b' '; 1 << 20];
    for _ in 0..=LARGEST_TEXT >> 20 {
        encoder.write_all(&blank).unwrap();
    }
    let message = refusal(&encoder.finish().unwrap());
    assert!(message.contains("exceeds 128 MiB"), "{message}");
}

#[test]
fn deep_nesting_is_refused_where_it_starts() {
    let deep = "[".repeat(100_000);
    assert_text_refused(
        "\"altitude_ft\": 500",
        &format!("\"altitude_ft\": {deep}"),
        &["condition 7", "altitude_ft"],
    );
    assert_text_refused(
        "\"A\": [",
        &format!("\"A\": [{deep}"),
        &["physics model \"nominal\"", "matrix A, row 1"],
    );
    assert!(refusal(deep.as_bytes()).contains("expected an object, found a list"));
    // The value of an unknown key is skipped without recursion, so the only error is the missing
    // end.
    assert_text_refused("\"version\": 1", &format!("\"x\": {deep}"), &["line"]);
}

#[test]
fn another_format_or_version_is_told_before_anything_else() {
    assert_refused(
        |file| file["format"] = json!("other"),
        &["expected \"format\": \"gdcm-dataset\", found \"other\""],
    );
    assert_refused(
        |file| file["version"] = json!(2),
        &["expected version 1 of gdcm-dataset, found 2", "newer gdcm"],
    );
    let future = |file: &mut Value| {
        file["version"] = json!(2);
        file["conditions"] = json!("elsewhere");
    };
    assert_refused(future, &["expected version 1"]);
    assert_refused(
        |file| drop(file.as_object_mut().unwrap().remove("format")),
        &["the key \"format\" is missing"],
    );
    assert_refused(
        |file| file["version"] = json!("one"),
        &["expected version 1 of gdcm-dataset, found \"one\""],
    );
}

#[test]
fn neither_a_dataset_nor_a_study_is_refused_as_such() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("file.json");
    std::fs::write(&path, r#"{"format": "gdcm-corrections", "version": 1}"#).unwrap();
    let message = load_any(&path, &Default::default())
        .unwrap_err()
        .to_string();
    assert!(
        message.ends_with(
            "expected \"format\": \"gdcm-dataset\" or \"gdcm-study\", found \"gdcm-corrections\""
        ),
        "{message}"
    );
}
