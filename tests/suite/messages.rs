//! Messages about unusual names, numbers and mistakes.

use std::io::Write;
use std::path::Path;

use proptest::prelude::*;
use serde_json::{Value, json};

use gdcm_io::files::study_file::open_study;
use gdcm_io::{DatasetOrigin, FileError, load_dataset, load_dataset_bytes, save_study};
use gdcm_method::correction::GainBounds;
use gdcm_model::dataset::Band;
use gdcm_model::dataset::band::{GREATEST_OMEGA, LEAST_OMEGA};
use gdcm_model::message_text::sanitized;
use gdcm_model::units::number;
use gdcm_study::Study;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::decisions::setting::Kind;
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_table::SETTINGS;

use crate::commands::{Desk, SMALL};

/// Characters that reverse the writing direction, split words, end a line or paragraph, and clear
/// the screen.
const NASTY: &str = "a\u{202e}b\u{200b}c\u{2028}d\u{2066}e\u{1b}[2Jf\ng";

fn is_plain(text: &str) -> bool {
    text.lines().all(|line| sanitized(line) == line)
}

#[test]
fn invisible_characters_of_file_names_are_spelt_out() {
    let message = load_dataset(Path::new(NASTY)).unwrap_err().to_string();
    assert!(
        is_plain(&message) && message.lines().count() == 1,
        "{message:?}"
    );
    assert!(
        message.starts_with("a\\u{202e}b\\u{200b}c\\u{2028}d\\u{2066}e\\u{1b}[2Jf\\ng: "),
        "{message}"
    );
    let desk = Desk::new();
    let name = NASTY.replace('\n', "");
    std::fs::write(desk.path(&name), SMALL).unwrap();
    let ended = desk.gdcm(&["check", &name]);
    ended.assert_done();
    assert!(
        is_plain(&ended.out) && ended.out.contains("\\u{202e}b"),
        "{:?}",
        ended.out
    );
}

#[test]
fn invisible_characters_of_what_a_file_says_are_spelt_out() {
    let desk = Desk::new();
    desk.write("nasty.json", |file| {
        file["name"] = json!(NASTY);
        file[NASTY] = json!(1);
        file["conditions"][0]["name"] = json!(NASTY);
        file["conditions"][0]["physics_models"][1]["name"] = json!(NASTY);
        file["conditions"][0]["identified_models"][0]["name"] = json!(NASTY);
        file["inputs"][0]["unit"] = json!(NASTY);
    });
    for arguments in [
        ["check", "nasty.json"].as_slice(),
        &["analyze", "nasty.json", "--out", "out"],
    ] {
        let ended = desk.gdcm(arguments);
        assert!(
            ended.status == 0 && is_plain(&ended.out) && is_plain(&ended.error),
            "{ended:?}"
        );
        assert!(ended.out.contains("a\\u{202e}b"), "{}", ended.out);
    }
}

#[test]
fn a_number_of_three_hundred_digits_is_written_with_an_exponent() {
    let desk = Desk::new();
    desk.write("large.json", |file| {
        file["conditions"][0]["airspeed_kt"] = json!(1e300);
        file["conditions"][0]["mass_kg"] = json!(1e-300);
    });
    let checked = desk.gdcm(&["check", "large.json"]);
    checked.assert_done();
    assert!(
        checked.out.contains("1e300 kt") && checked.out.contains("1e-300 kg"),
        "{}",
        checked.out
    );
    assert!(!checked.out.contains("00000000000"), "{}", checked.out);
    desk.write("id.json", |file| file["conditions"][0]["id"] = json!(1e300));
    desk.messages(&["check", "id.json"])
        .assert_code("wrong-type", &["1e300"]);
    desk.write("negative.json", |file| {
        file["conditions"][0]["airspeed_kt"] = json!(-1e300)
    });
    desk.messages(&["check", "negative.json"])
        .assert_code("flight-state", &["[kt]", "-1e300"]);
    desk.messages(&["analyze", "--out", "out", "--alpha", "1e300"])
        .assert_code("wrong-option", &["--alpha: ", "0", "1000000", "1e300"]);
    desk.messages(&["analyze", "--out", "out", "--band", "1e-300", "1e300"])
        .assert_code("wrong-option", &["--band: ", "1e-300", "1e300"]);
}

#[test]
fn the_bounds_that_a_message_names_are_those_that_are_refused() {
    let study = Study::new(gdcm_io::embedded_example().unwrap().dataset);
    for setting in SETTINGS {
        let (Kind::Number { range, .. } | Kind::Optional { range, .. }) = setting.kind else {
            continue;
        };
        let is_whole = matches!(setting.kind, Kind::Number { whole: true, .. });
        let apply = |value: f64| study.clone().apply(&setting.to(value));
        range
            .iter()
            .for_each(|value| assert_eq!(apply(*value), Ok(()), "{}", setting.name));
        let [least, greatest] = range;
        let beyond = if is_whole {
            [least - 1.0, greatest + 1.0]
        } else {
            [least.next_down(), greatest.next_up()]
        };
        for value in beyond {
            let refusal = apply(value).unwrap_err();
            assert_eq!(refusal.code(), "out-of-range");
            let message = refusal.to_string();
            for figure in [least, greatest, value] {
                assert!(message.contains(&number(figure)), "{figure} in {message}");
            }
        }
    }
    let bounds = |lower, upper| {
        study
            .clone()
            .apply(&setting_table::GAIN_BOUNDS.to(Some(GainBounds { lower, upper })))
    };
    assert_eq!(bounds(1e-6, 1e6), Ok(()));
    let refusal = bounds(0.5, 0.4).unwrap_err();
    assert!(
        matches!(refusal, EditRefusal::OutOfRange { found: 0.4, .. }),
        "{refusal}"
    );
    assert!(Band::new(LEAST_OMEGA, GREATEST_OMEGA).is_ok());
    for (min, max) in [
        (LEAST_OMEGA.next_down(), 1.0),
        (1.0, GREATEST_OMEGA.next_up()),
    ] {
        let message = Band::new(min, max).unwrap_err().to_string();
        assert!(
            message.contains(&number(LEAST_OMEGA)) && message.contains(&number(GREATEST_OMEGA)),
            "{message}"
        );
    }
}

#[test]
fn a_number_on_the_command_line_is_refused_with_its_option_and_its_range() {
    let desk = Desk::new();
    for (options, code, names) in [
        (
            ["--degree", "-1"].as_slice(),
            "wrong-option",
            ["--degree: ", "0, 1, 2, 3", "table", "-1"].as_slice(),
        ),
        (
            &["--degree", "2.5"],
            "wrong-option",
            &["--degree: ", "0, 1, 2, 3", "table", "2.5"],
        ),
        (
            &["--points", "-5"],
            "wrong-option",
            &["--points: ", "2", "5000", "-5"],
        ),
        (
            &["--points", "1e3"],
            "wrong-option",
            &["--points: ", "2", "5000", "1e3"],
        ),
        (
            &["--alpha", "-1"],
            "wrong-option",
            &["--alpha: ", "α", "0", "1000000", "-1"],
        ),
        (&["--alpha", "one"], "wrong-option", &["--alpha: ", "one"]),
        (
            &["--alpha-delay", "\u{202e}1"],
            "wrong-option",
            &["--alpha-delay: ", "\\u{202e}1"],
        ),
        (&["--band", "12", "x"], "wrong-option", &["--band: ", "x"]),
        (
            &["--band", "12", "0.5"],
            "wrong-option",
            &["--band: ", "0.0001", "100000", "rad/s", "12", "0.5"],
        ),
        (
            &["--on", "P"],
            "wrong-command-line",
            &["--on: ", "OUTPUT/INPUT", "P/LAT", "\"P\""],
        ),
        (
            &["--reject", "x"],
            "wrong-command-line",
            &["--reject: ", "ID:NAME", "10:nominal", "\"x\""],
        ),
    ] {
        let line = [
            ["analyze", "small.json", "--out", "out"].as_slice(),
            options,
        ]
        .concat();
        desk.messages(&line).assert_code(code, names);
    }
}

/// Collects the JSON pointers of all values.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Object(entries) => entries
            .iter()
            .for_each(|(key, value)| pointers(value, &format!("{at}/{key}"), found)),
        Value::Array(entries) => {
            entries
                .iter()
                .enumerate()
                .for_each(|(index, value)| pointers(value, &format!("{at}/{index}"), found));
        }
        _ => {}
    }
}

/// Generates values that are wrong in most places.
fn wrong_values() -> impl Strategy<Value = Value> {
    prop::sample::select(vec![
        json!(null),
        json!(true),
        json!(-1),
        json!(1.5),
        json!(1e300),
        json!(u64::MAX),
        json!("mode"),
        json!(NASTY),
        json!([]),
        json!([[[]]]),
        json!([1, 2, 3]),
        json!({}),
        json!({"deep": [{}]}),
    ])
}

proptest! {
    #[test]
    fn no_message_speaks_of_the_programs_own_workings(at in any::<prop::sample::Index>(), value in wrong_values(), in_study in any::<bool>()) {
        let desk = Desk::new();
        let path = desk.path("study.json");
        let loaded = load_dataset(&desk.path("small.json")).unwrap();
        save_study(&Study::new(loaded.dataset.clone()), &loaded, &path).unwrap();
        let text = if in_study { std::fs::read_to_string(&path).unwrap() } else { SMALL.to_owned() };
        let mut text: Value = serde_json::from_str(&text).unwrap();
        let mut places = Vec::new();
        pointers(&text, "", &mut places);
        *text.pointer_mut(&places[at.index(places.len())]).unwrap() = value;
        let refused = if in_study {
            std::fs::write(&path, text.to_string()).unwrap();
            open_study(&path).err()
        } else {
            load_dataset_bytes(text.to_string().as_bytes(), DatasetOrigin::File("small.json".into())).err()
        };
        prop_assert!(refused.as_ref().is_none_or(|error| error.code() != "not-json"));
        let message = refused.map(|error| error.to_string()).unwrap_or_default();
        prop_assert!(is_plain(&message) && message.lines().count() <= 1, "{}", message);
        prop_assert!(message.chars().count() < 500, "{}", message);
        prop_assert!(!message.contains('`'), "{}", message);
        let own = ["struct", "variant", "tuple", "usize", "u64", "i64", "f64", "ident", "invalid", "map", "sequence"];
        let mut words = message.split(|letter: char| !letter.is_ascii_alphanumeric());
        prop_assert!(!words.any(|word| own.contains(&word)), "{}", message);
    }
}

#[test]
fn a_choice_of_words_is_refused_with_the_words_that_may_stand_there() {
    let desk = Desk::new();
    let loaded = load_dataset(&desk.path("small.json")).unwrap();
    let path = desk.path("study.json");
    save_study(&Study::new(loaded.dataset.clone()), &loaded, &path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    for (from, to, code, names) in [
        (
            "\"median\"",
            "\"mode\"",
            "unknown-word",
            ["settings, cost_average: ", "\"mean\"", "\"mode\""].as_slice(),
        ),
        (
            "\"median\"",
            "5",
            "wrong-type",
            &["settings, cost_average: ", "5"],
        ),
        (
            "\"points\": 200",
            "\"points\": -1",
            "wrong-type",
            &["settings, points: ", "-1"],
        ),
        (
            "0.5,\n      12.0",
            "0.5",
            "wrong-type",
            &["settings, band_rad_s: ", "2", "1"],
        ),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        assert_refused(&open_study(&path).unwrap_err(), code, names);
    }
}

/// Asserts the code of an error, and that its message contains these places and numbers.
#[track_caller]
fn assert_refused(error: &FileError, code: &str, names: &[&str]) {
    let message = error.to_string();
    let beginning = &message[..message.len().min(400)];
    assert_eq!(error.code(), code, "{beginning}");
    for name in names {
        assert!(message.contains(name), "{name} in: {beginning}");
    }
}

/// Code of a list or an object with more entries than its limit.
const TOO_MANY: &str = "too-many-entries";

fn dataset_refusal(text: &str) -> FileError {
    load_dataset_bytes(text.as_bytes(), DatasetOrigin::File("small.json".into())).unwrap_err()
}

#[test]
fn lists_beyond_their_limits_are_refused_with_their_place() {
    fn many(entry: &str, count: usize) -> String {
        vec![entry; count].join(",")
    }

    let small: Value = serde_json::from_str(SMALL).unwrap();
    let identified = "\"identified_models\": [";
    let numbers = many("0", 1001);
    for (from, to, code, names) in [
        (
            "\"conditions\": [",
            "\"conditions\": [{},".to_owned(),
            "missing-key",
            ["condition at position 1 ", "\"id\""].as_slice(),
        ),
        (
            identified,
            format!("{identified}{},", many("{\"name\":\"\"}", 5000)),
            TOO_MANY,
            &["condition 7 (number 1 ", "identified_models: ", "5000"],
        ),
        (
            "\"on_axis\": [",
            format!("\"on_axis\": [{},", many("[\"P\",\"LAT\"]", 1024)),
            TOO_MANY,
            &["on_axis: ", "1024"],
        ),
        (
            "\"outputs\": [",
            format!(
                "\"outputs\": [{},",
                many("{\"name\":\"\",\"unit\":\"\"}", 32)
            ),
            TOO_MANY,
            &["outputs: ", "32"],
        ),
        (
            "\"A\": [",
            format!("\"A\": [[{numbers}],"),
            TOO_MANY,
            &["matrix A, row 1: ", "1000"],
        ),
        (
            "\"omega_rad_s\": [",
            format!("\"omega_rad_s\": [{},", many("1", 100_000)),
            TOO_MANY,
            &["omega_rad_s: ", "100000"],
        ),
        (
            "\"perturbation\": {",
            format!(
                "\"perturbation\": {{{},",
                (0..50)
                    .map(|at| format!("\"p{at}\":0"))
                    .collect::<Vec<_>>()
                    .join(",")
            ),
            TOO_MANY,
            &["\"nominal\" (number 1), perturbation: ", "50"],
        ),
    ] {
        assert!(SMALL.contains(from), "{from}");
        assert_refused(&dataset_refusal(&SMALL.replacen(from, &to, 1)), code, names);
    }
    // Each bundle is within its limit, but the total is not.
    let mut text = small;
    let condition = text["conditions"][0].clone();
    let models: Vec<Value> = (0..5000)
        .map(|index| json!({"name": index.to_string()}))
        .collect();
    text["conditions"] = (0..11)
        .map(|id| {
            let mut condition = condition.clone();
            condition["id"] = json!(id);
            condition["identified_models"] = json!(models);
            condition
        })
        .collect();
    assert_refused(
        &dataset_refusal(&text.to_string()),
        "invalid-entry",
        &["conditions: ", "50000"],
    );
    let conditions = many(
        "{\"id\":1,\"name\":\"\",\"airspeed_kt\":1,\"physics_models\":[],\"identified_models\":[]}",
        5001,
    );
    let refusal = dataset_refusal(&SMALL.replacen(
        "\"conditions\": [",
        &format!("\"conditions\": [{conditions},"),
        1,
    ));
    assert_refused(&refusal, TOO_MANY, &["conditions: ", "5000"]);
}

/// Three million empty models: 36 MB of text, much less when compressed, and about a gigabyte if
/// they were held in memory.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_is_refused_for_its_length_takes_memory_for_its_text_only() {
    let desk = Desk::new();
    let (before, after) = SMALL.split_once("\"identified_models\": [").unwrap();
    let file = std::fs::File::create(desk.path("bomb.json.gz")).unwrap();
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    write!(packed, "{before}\"identified_models\": [").unwrap();
    let some = b"{\"name\":\"\"},".repeat(10_000);
    (0..300).for_each(|_| packed.write_all(&some).unwrap());
    packed.write_all(after.as_bytes()).unwrap();
    packed.finish().unwrap();
    // Address space in KiB: enough for the program, the growing text and the models read so far.
    let line = "ulimit -v 400000; exec \"$0\" check bomb.json.gz";
    let mut command = std::process::Command::new("sh");
    command
        .args(["-c", line, env!("CARGO_BIN_EXE_gdcm")])
        .current_dir(desk.directory.path());
    let ended = crate::commands::Ended::from_output(&command.output().unwrap());
    ended.assert_failed(2, &["condition 7", "identified_models: ", "5000"]);
}
