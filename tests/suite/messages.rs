//! Messages about unusual names, numbers and mistakes.

use std::io::Write;
use std::path::Path;

use proptest::prelude::*;
use serde_json::{Value, json};

use gdcm_io::files::study_file::open_study;
use gdcm_io::{DatasetOrigin, load_dataset, load_dataset_bytes, save_study};
use gdcm_method::correction::GainBounds;
use gdcm_model::dataset::Band;
use gdcm_model::dataset::band::{GREATEST_OMEGA, LEAST_OMEGA};
use gdcm_model::message_text::sanitized;
use gdcm_model::units::number;
use gdcm_study::Study;
use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::Kind;

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
    desk.gdcm(&["check", "id.json"])
        .assert_failed(2, &["expected a whole number, found 1e300"]);
    desk.write("negative.json", |file| {
        file["conditions"][0]["airspeed_kt"] = json!(-1e300)
    });
    desk.gdcm(&["check", "negative.json"])
        .assert_failed(2, &["airspeed [kt]", "found -1e300"]);
    desk.gdcm(&["analyze", "--out", "out", "--alpha", "1e300"])
        .assert_failed(2, &["--alpha: ", "a number from 0 to 1000000, found 1e300"]);
    desk.gdcm(&["analyze", "--out", "out", "--band", "1e-300", "1e300"])
        .assert_failed(2, &["--band: ", "found min 1e-300, max 1e300"]);
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
            let message = apply(value).unwrap_err().to_string();
            let words = format!(
                "from {} to {}, found {}",
                number(least),
                number(greatest),
                number(value)
            );
            assert!(message.ends_with(&words), "{message}");
        }
    }
    let bounds = |lower, upper| {
        study
            .clone()
            .apply(&setting::GAIN_BOUNDS.to(Some(GainBounds { lower, upper })))
    };
    assert_eq!(bounds(1e-6, 1e6), Ok(()));
    assert!(
        bounds(0.5, 0.4)
            .unwrap_err()
            .to_string()
            .ends_with("from 0.5 to 1000000, found 0.4")
    );
    assert!(Band::new(LEAST_OMEGA, GREATEST_OMEGA).is_ok());
    for (min, max) in [
        (LEAST_OMEGA.next_down(), 1.0),
        (1.0, GREATEST_OMEGA.next_up()),
    ] {
        let message = Band::new(min, max).unwrap_err().to_string();
        assert!(
            message.contains("0.0001 <= min < max <= 100000 (rad/s), found"),
            "{message}"
        );
    }
}

#[test]
fn a_number_on_the_command_line_is_refused_with_its_option_and_its_range() {
    let desk = Desk::new();
    for (options, message) in [
        (
            ["--degree", "-1"].as_slice(),
            "error: --degree: expected 0, 1, 2, 3 or table, found -1\n",
        ),
        (
            &["--degree", "2.5"],
            "error: --degree: expected 0, 1, 2, 3 or table, found 2.5\n",
        ),
        (
            &["--points", "-5"],
            "error: --points: expected a whole number from 2 to 5000, found -5\n",
        ),
        (
            &["--points", "1e3"],
            "error: --points: expected a whole number from 2 to 5000, found 1e3\n",
        ),
        (
            &["--alpha", "-1"],
            "error: --alpha: α of the gains: expected a number from 0 to 1000000, found -1\n",
        ),
        (
            &["--alpha", "one"],
            "error: --alpha: expected a number, found one\n",
        ),
        (
            &["--alpha-delay", "\u{202e}1"],
            "error: --alpha-delay: expected a number, found \\u{202e}1\n",
        ),
        (
            &["--band", "12", "x"],
            "error: --band: expected a number, found x\n",
        ),
        (
            &["--band", "12", "0.5"],
            "error: --band: the frequency band must be 0.0001 <= min < max <= 100000 (rad/s), found min 12, max 0.5\n",
        ),
        (
            &["--on", "P"],
            "error: --on: expected OUTPUT/INPUT, such as P/LAT; found \"P\"\n",
        ),
        (
            &["--reject", "x"],
            "error: --reject: expected ID:NAME, such as 10:nominal; found \"x\"\n",
        ),
    ] {
        let ended = desk.gdcm(
            &[
                ["analyze", "small.json", "--out", "out"].as_slice(),
                options,
            ]
            .concat(),
        );
        assert_eq!((ended.status, ended.error.as_str()), (2, message));
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
        let message = refused.map(|error| error.to_string()).unwrap_or_default();
        prop_assert!(is_plain(&message) && message.lines().count() <= 1, "{}", message);
        prop_assert!(message.chars().count() < 500, "{}", message);
        prop_assert!(!message.contains('`') && !message.contains("this is not JSON"), "{}", message);
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
    for (from, to, words) in [
        (
            "\"median\"",
            "\"mode\"",
            "settings, cost_average: expected \"median\" or \"mean\", found \"mode\"",
        ),
        (
            "\"median\"",
            "5",
            "settings, cost_average: expected text in quotation marks, found",
        ),
        (
            "\"points\": 200",
            "\"points\": -1",
            "settings, points: expected a whole number not below 0, found -1",
        ),
        (
            "0.5,\n      12.0",
            "0.5",
            "settings, band_rad_s: expected a list of 2 entries, found 1 entries",
        ),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let message = open_study(&path).unwrap_err().to_string();
        assert!(message.contains(words), "expected {words} in: {message}");
    }
}

fn dataset_refusal(text: &str) -> String {
    load_dataset_bytes(text.as_bytes(), DatasetOrigin::File("small.json".into()))
        .unwrap_err()
        .to_string()
}

#[test]
fn lists_beyond_their_limits_are_refused_with_their_place() {
    fn many(entry: &str, count: usize) -> String {
        vec![entry; count].join(",")
    }

    let small: Value = serde_json::from_str(SMALL).unwrap();
    let identified = "\"identified_models\": [";
    let numbers = many("0", 1001);
    for (from, to, words) in [
        (
            "\"conditions\": [",
            "\"conditions\": [{},".to_owned(),
            "condition number 1 in the file: the key \"id\"",
        ),
        (
            identified,
            format!("{identified}{},", many("{\"name\":\"\"}", 5000)),
            "condition 7 (number 1 in the file), identified_models: expected at most 5000 entries, found more",
        ),
        (
            "\"on_axis\": [",
            format!("\"on_axis\": [{},", many("[\"P\",\"LAT\"]", 1024)),
            "on_axis: expected at most 1024",
        ),
        (
            "\"outputs\": [",
            format!(
                "\"outputs\": [{},",
                many("{\"name\":\"\",\"unit\":\"\"}", 32)
            ),
            "outputs: expected at most 32",
        ),
        (
            "\"A\": [",
            format!("\"A\": [[{numbers}],"),
            "matrix A, row 1: expected at most 1000 entries, found more",
        ),
        (
            "\"omega_rad_s\": [",
            format!("\"omega_rad_s\": [{},", many("1", 100_000)),
            "omega_rad_s: expected at most 100000",
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
            "physics model \"nominal\" (number 1), perturbation: expected at most 50 entries, found more",
        ),
    ] {
        assert!(SMALL.contains(from), "{from}");
        let message = dataset_refusal(&SMALL.replacen(from, &to, 1));
        assert!(
            message.contains(words),
            "expected {words} in: {}",
            &message[..message.len().min(400)]
        );
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
    let message = dataset_refusal(&text.to_string());
    assert!(
        message.contains("conditions: expected at most 50000 models in total, found more"),
        "{message}"
    );
    let conditions = many(
        "{\"id\":1,\"name\":\"\",\"airspeed_kt\":1,\"physics_models\":[],\"identified_models\":[]}",
        5001,
    );
    let message = dataset_refusal(&SMALL.replacen(
        "\"conditions\": [",
        &format!("\"conditions\": [{conditions},"),
        1,
    ));
    assert!(
        message.contains("conditions: expected at most 5000 entries, found more"),
        "{message}"
    );
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
    ended.assert_failed(
        2,
        &[
            "condition 7",
            "identified_models: expected at most 5000 entries, found more",
        ],
    );
}
