//! Files rejected before their content is examined.

use super::*;

#[test]
fn a_missing_file_is_named() {
    let error = load_dataset(Path::new("no/such/file.json")).unwrap_err();
    assert!(
        matches!(&error, FileError::Missing { path } if path == Path::new("no/such/file.json")),
        "{error}"
    );
    assert_eq!(error.code(), "missing-file");
}

#[test]
fn a_directory_is_refused_as_a_directory() {
    let directory = tempfile::tempdir().unwrap();
    let error = load_dataset(directory.path()).unwrap_err();
    assert!(
        matches!(&error, FileError::Directory { path } if path == directory.path()),
        "{error}"
    );
}

#[cfg(unix)]
#[test]
fn an_unreadable_file_is_refused() {
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
        let error = refusal(text.as_bytes());
        assert!(
            matches!(
                error,
                FileError::NotJson { line: 1, .. } | FileError::CutOff { line: 1, .. }
            ),
            "{error:?}"
        );
    }
    assert_text_refused(
        "\"mass_kg\": 6600",
        "\"mass_kg\": 6600,,",
        "not-json",
        "condition 7",
        &["line"],
    );
}

#[test]
fn a_truncated_file_is_refused_with_the_place_of_the_cut() {
    let cut = SMALL.find("\"V+5kt\"").unwrap() + 120;
    let place = "condition 7 (number 1 in the file), physics model \"V+5kt\" (number 2)";
    assert_error(
        &refusal(&SMALL.as_bytes()[..cut]),
        "json-cut-off",
        place,
        &[],
    );
}

#[test]
fn text_after_the_end_is_refused() {
    let error = refusal(format!("{SMALL}{{}}").as_bytes());
    let last_line = SMALL.lines().count();
    assert!(
        matches!(error, FileError::NotJson { line, .. } if line >= last_line),
        "{error:?}"
    );
}

#[test]
fn a_broken_gzip_file_is_refused() {
    let mut packed = gzip(SMALL.as_bytes());
    let middle = packed.len() / 2;
    assert_eq!(refusal_code(&packed[..middle]), "gzip-cut-off");
    packed[middle] ^= 0xff;
    assert!(matches!(
        refusal_code(&packed),
        "damaged-gzip" | "gzip-cut-off"
    ));
    assert_eq!(refusal_code(&[0x1f, 0x8b, 0, 0]), "gzip-cut-off");
}

#[test]
fn a_small_file_that_unpacks_to_more_than_the_limit_is_refused() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    let blank = vec![b' '; 1 << 20];
    for _ in 0..=LARGEST_TEXT >> 20 {
        encoder.write_all(&blank).unwrap();
    }
    let error = refusal(&encoder.finish().unwrap());
    assert!(
        matches!(error, FileError::TooLarge { most_mib: 128, .. }),
        "{error:?}"
    );
}

#[test]
fn deep_nesting_is_refused_where_it_starts() {
    let deep = "[".repeat(100_000);
    assert_text_refused(
        "\"altitude_ft\": 500",
        &format!("\"altitude_ft\": {deep}"),
        "wrong-type",
        "altitude_ft",
        &[],
    );
    assert_text_refused(
        "\"A\": [",
        &format!("\"A\": [{deep}"),
        "wrong-type",
        "physics model \"nominal\" (number 1), matrix A, row 1",
        &[],
    );
    assert_eq!(refusal_code(deep.as_bytes()), "wrong-type");
    // The value of an unknown key is skipped without recursion, so the only error is that the
    // brackets are not closed.
    let skipped = SMALL.replacen("\"version\": 1", &format!("\"x\": {deep}"), 1);
    assert!(matches!(
        refusal(skipped.as_bytes()),
        FileError::CutOff { .. } | FileError::NotJson { .. }
    ));
}

#[test]
fn another_format_or_version_is_reported_before_other_errors() {
    assert_refused(
        |file| file["format"] = json!("other"),
        "other-format",
        "",
        &["\"gdcm-dataset\"", "\"other\""],
    );
    assert_refused(
        |file| file["version"] = json!(2),
        "other-version",
        "",
        &["version 1 of gdcm-dataset", "found 2"],
    );
    let future = |file: &mut Value| {
        file["version"] = json!(2);
        file["conditions"] = json!("elsewhere");
    };
    assert_refused(future, "other-version", "", &[]);
    assert_refused(
        |file| drop(file.as_object_mut().unwrap().remove("format")),
        "missing-key",
        "",
        &["\"format\""],
    );
    assert_refused(
        |file| file["version"] = json!("one"),
        "other-version",
        "",
        &["found \"one\""],
    );
}

#[test]
fn a_file_that_is_neither_dataset_nor_study_is_refused_with_both_formats() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("file.json");
    std::fs::write(&path, r#"{"format": "gdcm-corrections", "version": 1}"#).unwrap();
    let error = load_any(&path, &Default::default()).unwrap_err();
    let FileError::Format {
        expected, found, ..
    } = error
    else {
        panic!("{error}")
    };
    assert_eq!(expected, "gdcm-dataset\" or \"gdcm-study");
    assert_eq!(found, "\"gdcm-corrections\"");
}
