//! Runs exported programs with the interpreters and compilers of their languages, and compares
//! their output with the schedule.

use std::process::Command;
use std::sync::Arc;

use nalgebra::DMatrix;
use proptest::prelude::*;

use gdcm_method::schedule::{
    DelayScheduling, ScheduleKind, ScheduleSettings, ScheduledQuantity, SecondVariable,
};
use gdcm_model::dataset::Dataset;
use gdcm_model::progress::Unobserved;
use gdcm_study::decisions::setting_table;
use gdcm_study::{
    Analysis, CouplingCorrection, Edit, Engine, PhaseCorrection, PhysicsCorrection, Study,
};
use gdcm_words::schedule::DELAYS_NOT_SCHEDULED;

use super::*;
use crate::export::{EXPORTERS, ExportRequest, ExportSource};
use crate::files::dataset_file::embedded_example;

/// Returns analyses of the example that cover every kind of schedule, scheduled quantity and
/// treatment of delays.
fn analyses() -> Vec<(String, Analysis)> {
    let mut engine = Engine::default();
    let mut analyses = Vec::new();
    for kind in [ScheduleKind::Polynomial { degree: 2 }, ScheduleKind::Table] {
        for quantity in [ScheduledQuantity::LnGain, ScheduledQuantity::Gain] {
            for delays in [false, true] {
                let mut study = Study::new(embedded_example().unwrap().dataset);
                let schedule = ScheduleSettings {
                    kind,
                    quantity,
                    delays,
                    ..ScheduleSettings::default()
                };
                study.settings.schedule = schedule;
                study.settings.set_delay_scheduling(delays.into());
                let analysis = engine.analyze(&study, &Unobserved).unwrap();
                analyses.push((format!("{kind:?}, {quantity:?}, delays {delays}"), analysis));
            }
        }
    }
    // Schedules with leads: one with a constant signed delay, one with a signed delay that varies
    // with airspeed.
    for tau_degree in [0, 2] {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        let schedule = ScheduleSettings {
            tau_degree,
            ..ScheduleSettings::default()
        };
        study
            .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
            .unwrap();
        study.settings.schedule = schedule;
        let analysis = engine.analyze(&study, &Unobserved).unwrap();
        analyses.push((format!("leads of degree {tau_degree}"), analysis));
    }
    // A schedule for physics models moved by their named parameters.
    let mut study = Study::new(embedded_example().unwrap().dataset);
    study
        .apply(&setting_table::PHYSICS.to(PhysicsCorrection::Named))
        .unwrap();
    analyses.push((
        "physics parameters".to_owned(),
        engine.analyze(&study, &Unobserved).unwrap(),
    ));
    // Conditions at a single airspeed, so that the airspeed range has zero width.
    let mut study = Study::new(embedded_example().unwrap().dataset);
    let dataset = study.dataset.clone();
    let airspeed_kt = dataset.conditions()[3].flight_state().airspeed_kt;
    for condition in dataset.conditions() {
        if condition.flight_state().airspeed_kt != airspeed_kt {
            study
                .apply(&Edit::SetScheduled {
                    condition: condition.id(),
                    scheduled: false,
                })
                .unwrap();
        }
    }
    analyses.push((
        "one airspeed".to_owned(),
        engine.analyze(&study, &Unobserved).unwrap(),
    ));
    analyses
}

/// Returns the schedule of an analysis as a program in the language with the extension `language`;
/// `name` is the stem of its file, by default "c".
fn program(language: &str, analysis: &Analysis, name: &str) -> String {
    let source = &ExportSource {
        name: NASTY[0].to_owned(),
        sha256: "ba78".to_owned(),
    };
    let path = format!("{}.{language}", if name.is_empty() { "c" } else { name });
    let export = Export {
        analysis,
        source,
        request: &ExportRequest::default(),
        path: Path::new(&path),
    };
    let exported = (ExportFormat::named(language).unwrap().export)(&export).unwrap();
    let mut text = Vec::new();
    (exported.write)(&mut text).unwrap();
    String::from_utf8(text).unwrap()
}

/// Names that would end a comment or a string literal if they were not escaped.
const NASTY: [&str; 3] = [
    "LAT \"x\" 'y' */ \\ %d\n%}\r*/ end",
    "δ_a ??/ /* \u{2028} ''' \"\"\" ${x}",
    "\\u{7f}\u{0}\\",
];

/// Returns fifty airspeeds \[kt\], from below the range of the example to above it, including both
/// ends of the range.
fn airspeeds() -> Vec<f64> {
    (0..48)
        .map(|index| 31.0 + f64::from(index) * 2.5)
        .chain([45.0, 140.0])
        .collect()
}

/// Returns the scheduled values, in the order in which the exported programs print them.
fn scheduled_values(analysis: &Analysis) -> Vec<f64> {
    let schedule = analysis.schedule.as_ref().unwrap();
    let mut values = Vec::new();
    for airspeed_kt in airspeeds() {
        let at = schedule.at(airspeed_kt);
        values.extend(at.input_gains);
        values.extend(at.output_gains);
        values.extend(at.input_delays_s);
        values.extend(at.output_delays_s);
    }
    values
}

/// Asserts agreement within the rounding of a few operations, which other languages may order
/// differently.
fn assert_values(words: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{words}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        // The absolute tolerance is needed where a delay is clipped at zero; it is far below a
        // femtosecond.
        assert!(
            (a - b).abs() <= 1e-12 * b.abs() + 1e-16,
            "{words}, value {index}: {a} instead of {b}"
        );
    }
}

/// Runs a program and compares its output with `expected`.
fn assert_run(
    words: &str,
    program: &str,
    arguments: &[&str],
    folder: &std::path::Path,
    expected: &[f64],
) {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{words}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    let found: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();
    assert_values(&format!("{program}, {words}"), &found, expected);
}

/// Compiles `source` as strict C99, where warnings are errors and `warnings` are enabled besides
/// the usual ones, and compares the output of the program with `expected`.
fn assert_c_run(words: &str, source: &str, warnings: &[&str], expected: &[f64]) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("main.c"), source).unwrap();
    let built = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(warnings)
        .args(["-o", "main", "main.c", "-lm"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{words}: {}",
        String::from_utf8_lossy(&built.stderr)
    );
    let program = folder.path().join("main").display().to_string();
    assert_run(words, &program, &[], folder.path(), expected);
}

/// Returns whether a program is installed; if not, the skipped check is reported on stderr.
fn is_installed(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        eprintln!(
            "SKIPPED: {program} is not installed, its programs are not run against the schedule"
        );
    }
    found
}

/// Returns [`airspeeds`] separated by commas, for a list in any of the languages.
fn airspeed_list() -> String {
    airspeeds()
        .iter()
        .map(|kt| format!("{kt:?}"))
        .collect::<Vec<_>>()
        .join(", ")
}

#[test]
fn programs_without_scheduled_delays_contain_a_note() {
    for (words, analysis) in analyses() {
        let settings = &analysis.study.settings;
        let has_delays = settings.schedule_delays == DelayScheduling::Always
            || settings.phase == PhaseCorrection::Lead;
        let text = program("py", &analysis, "");
        assert_eq!(
            text.contains(&format!("# Note: {DELAYS_NOT_SCHEDULED}")),
            !has_delays,
            "{words}"
        );
    }
}

/// Returns whether a line states the frequency limit of the leads, which is the upper band edge,
/// and the frequency above it at which their gain is given, ten times the limit.
fn has_limit(line: &str) -> bool {
    line.contains(" 12 rad/s") && line.contains(" 120 rad/s")
}

#[test]
fn exports_with_leads_state_their_frequency_limit_and_the_gain_above_it() {
    for (words, analysis) in analyses() {
        let price = analysis.schedule.as_ref().unwrap().lead_price();
        assert_eq!(
            price.is_some(),
            analysis.study.settings.phase == PhaseCorrection::Lead,
            "{words}"
        );
        for (language, limit) in [
            ("m", ""),
            ("py", "NOT_VALID_ABOVE_RAD_S = 1.2"),
            ("h", "GDCM_NOT_VALID_ABOVE_RAD_S 1.2"),
        ] {
            let text = program(language, &analysis, "k");
            assert!(text.is_ascii(), "{words}, {language}: {text}");
            assert_eq!(
                text.lines().any(has_limit),
                price.is_some(),
                "{words}, {language}: {text}"
            );
            // A MATLAB function has no constant for the limit.
            assert!(
                limit.is_empty() || text.contains(limit) == price.is_some(),
                "{words}, {language}: {text}"
            );
        }
        let source = ExportSource {
            name: "example".to_owned(),
            sha256: "ba78".to_owned(),
        };
        // The table of physics parameters contains no leads.
        for exporter in EXPORTERS.iter().filter(|format| format.name != "physics") {
            let path = Path::new("k").with_extension(exporter.extension);
            let request = ExportRequest::default();
            let export = Export {
                analysis: &analysis,
                source: &source,
                request: &request,
                path: &path,
            };
            let Ok(exported) = (exporter.export)(&export) else {
                continue;
            };
            assert_eq!(
                exported.remarks.iter().any(|remark| has_limit(remark)),
                price.is_some(),
                "{words}, {}: {:?}",
                exporter.name,
                exported.remarks
            );
        }
    }
}

#[test]
fn an_exported_python_module_computes_the_schedule() {
    if !is_installed("python3") {
        return;
    }
    for (words, analysis) in analyses() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("c.py"), program("py", &analysis, "")).unwrap();
        let program = format!(
            "import c\nfor a in [{}]:\n    mi, mo, ti, to = c.gdcm_correction(a)\n    \
             print(*[repr(m[k][k]) for m in (mi, mo) for k in range(len(m))], *map(repr, ti + to))",
            airspeed_list()
        );
        assert_run(
            &words,
            "python3",
            &["-c", &program],
            folder.path(),
            &scheduled_values(&analysis),
        );
    }
}

#[test]
fn an_exported_c_header_computes_the_schedule() {
    if !is_installed("cc") {
        return;
    }
    for (words, analysis) in analyses() {
        let header = program("h", &analysis, "");
        let main = format!(
            "{header}\n#include <stdio.h>\nint main(void) {{ static const double s[] = {{{}}};\n\
             double v[2 * (GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT)]; unsigned k, j;\n\
             for (k = 0; k < sizeof s / sizeof *s; k++) {{\n\
             gdcm_correction(s[k], v, v + GDCM_INPUT_COUNT, v + GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT,\n\
             v + 2 * GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT);\n\
             for (j = 0; j < sizeof v / sizeof *v; j++) printf(\"%.17g \", v[j]); }}\nreturn 0; }}\n",
            airspeed_list()
        );
        assert_c_run(&words, &main, &["-Wshadow"], &scheduled_values(&analysis));
    }
}

#[test]
fn an_exported_matlab_function_computes_the_schedule() {
    if !is_installed("octave-cli") {
        return;
    }
    for (words, analysis) in analyses() {
        let folder = tempfile::tempdir().unwrap();
        let function = program("m", &analysis, "my_study");
        std::fs::write(folder.path().join("my_study.m"), function).unwrap();
        let program = format!(
            "for s = [{}], [Mi, Mo, ti, to] = my_study(s); printf('%.17g ', [diag(Mi); diag(Mo); ti; to]); end",
            airspeed_list()
        );
        assert_run(
            &words,
            "octave-cli",
            &["--eval", &program],
            folder.path(),
            &scheduled_values(&analysis),
        );
    }
}

/// Returns the example with mixing and feedback and without a phase correction.
fn analysis_with_couplings() -> Analysis {
    let mut study = Study::new(embedded_example().unwrap().dataset);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::None))
        .unwrap();
    study
        .apply(&setting_table::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
        .unwrap();
    Engine::default().analyze(&study, &Unobserved).unwrap()
}

/// Returns a 6 x 4 feed-through matrix with values that every language formats identically.
fn feed_through() -> DMatrix<f64> {
    DMatrix::from_fn(6, 4, |output, input| {
        0.25 * (output as f64 - 2.0) * (input as f64 + 1.0) / 4.0
    })
}

/// Formats a matrix as a list of its rows, with the brackets of a language, such as
/// "[[1.0, 2.0], [3.0, 4.0]]".
fn nested_list(matrix: &DMatrix<f64>, [open, close]: [char; 2]) -> String {
    let mut rows = Vec::new();
    for row in matrix.row_iter() {
        let values: Vec<String> = row.iter().map(|value| format!("{value:?}")).collect();
        rows.push(format!("{open}{}{close}", values.join(", ")));
    }
    format!("{open}{}{close}", rows.join(", "))
}

/// Returns three matrices at each airspeed, row by row: the mixing, the feedback, and the feedback
/// with its loop closed through the feed-through matrix.
fn expected_couplings(analysis: &Analysis) -> Vec<f64> {
    let matrices = analysis.fitted_couplings().unwrap().matrices();
    let feedback = matrices.feedback();
    let closed = feedback
        * (DMatrix::identity(6, 6) - feed_through() * feedback)
            .try_inverse()
            .unwrap();
    let mut values = Vec::new();
    for airspeed_kt in airspeeds() {
        for matrix in [&matrices.normalised_mixing(airspeed_kt), feedback, &closed] {
            // nalgebra stores columns, so the transpose lists the rows.
            values.extend_from_slice(matrix.transpose().as_slice());
        }
    }
    values
}

#[test]
fn exported_couplings_are_those_of_the_analysis_and_close_through_a_feed_through() {
    let analysis = analysis_with_couplings();
    let expected = expected_couplings(&analysis);
    let folder = tempfile::tempdir().unwrap();
    if is_installed("python3") {
        std::fs::write(folder.path().join("c.py"), program("py", &analysis, "")).unwrap();
        let program = format!(
            "import c\nfor a in [{}]:\n    m, k = c.gdcm_couplings(a)\n    f = c.gdcm_closed_feedback(k, {})\n    \
             print(*[repr(x) for rows in (m, k, f) for row in rows for x in row])",
            airspeed_list(),
            nested_list(&feed_through(), ['[', ']'])
        );
        assert_run(
            "couplings",
            "python3",
            &["-c", &program],
            folder.path(),
            &expected,
        );
    }
    if is_installed("cc") {
        let main = format!(
            "{}\n#include <stdio.h>\nint main(void) {{ static const double s[] = {{{}}}; double d[6][4] = {};\n\
             double m[4][4], k[4][6]; unsigned n; int i, turn;\n\
             for (n = 0; n < sizeof s / sizeof *s; n++) {{ if (gdcm_couplings(s[n], m, k) < 0) return 1;\n\
             for (i = 0; i < 16; i++) printf(\"%.17g \", (&m[0][0])[i]);\n\
             for (turn = 0; turn < 2; turn++) {{ if (turn == 1 && gdcm_close_feedback(k, d)) return 2;\n\
             for (i = 0; i < 24; i++) printf(\"%.17g \", (&k[0][0])[i]); }} }}\nreturn 0; }}\n",
            program("h", &analysis, ""),
            airspeed_list(),
            nested_list(&feed_through(), ['{', '}'])
        );
        assert_c_run("couplings", &main, &["-Wshadow"], &expected);
    }
    if is_installed("octave-cli") {
        std::fs::write(
            folder.path().join("my_study.m"),
            program("m", &analysis, "my_study"),
        )
        .unwrap();
        let rows: Vec<String> = feed_through()
            .row_iter()
            .map(|row| format!("{:?}", row.iter().collect::<Vec<_>>()))
            .collect();
        let program = format!(
            "D = [{}]; for s = [{}], [~, ~, ~, ~, m, k] = my_study(s); [~, ~, ~, ~, ~, f] = my_study(s, D); \
             printf('%.17g ', m', k', f'); end",
            rows.join("; "),
            airspeed_list()
        );
        assert_run(
            "couplings",
            "octave-cli",
            &["--eval", &program],
            folder.path(),
            &expected,
        );
    }
}

#[test]
fn exports_without_couplings_mention_neither_mixing_nor_feedback() {
    let analysis = Engine::default()
        .analyze(
            &Study::new(embedded_example().unwrap().dataset),
            &Unobserved,
        )
        .unwrap();
    for language in ["m", "py", "h"] {
        let text = program(language, &analysis, "k").to_lowercase();
        assert!(
            !text.contains("mixing") && !text.contains("feedback"),
            "{language}: {text}"
        );
    }
}

/// Returns the example with altitude as second variable of the schedule, and the scheduled values
/// at fifty airspeeds and three altitudes.
fn analysis_over_altitude(kind: ScheduleKind) -> (Analysis, Vec<f64>) {
    let mut study = Study::new(embedded_example().unwrap().dataset);
    let schedule = ScheduleSettings {
        kind,
        second: Some(SecondVariable::Altitude),
        ..ScheduleSettings::default()
    };
    study.settings.schedule = schedule;
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    let schedule = analysis.schedule.clone().unwrap();
    let mut expected = Vec::new();
    for airspeed_kt in airspeeds() {
        for altitude_ft in ALTITUDES_FT {
            let at = schedule.evaluate(airspeed_kt, Some(altitude_ft));
            expected.extend(at.input_gains);
            expected.extend(at.output_gains);
            expected.extend(at.input_delays_s);
            expected.extend(at.output_delays_s);
        }
    }
    (analysis, expected)
}

/// Altitudes \[ft\] below, within and above the range of the example.
const ALTITUDES_FT: [f64; 3] = [0.0, 4321.0, 20_000.0];

#[test]
fn a_second_variable_is_the_second_argument_of_every_program() {
    for kind in [ScheduleKind::Polynomial { degree: 2 }, ScheduleKind::Table] {
        let (analysis, expected) = analysis_over_altitude(kind);
        let words = format!("{kind:?} and altitude");
        if is_installed("python3") {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("c.py"), program("py", &analysis, "")).unwrap();
            let program = format!(
                "import c\nfor a in [{}]:\n  for h in {ALTITUDES_FT:?}:\n    mi, mo, ti, to = c.gdcm_correction(a, h)\n    \
                 print(*[repr(m[k][k]) for m in (mi, mo) for k in range(len(m))], *map(repr, ti + to))",
                airspeed_list()
            );
            assert_run(
                &words,
                "python3",
                &["-c", &program],
                folder.path(),
                &expected,
            );
        }
        if is_installed("cc") {
            let header = program("h", &analysis, "");
            let main = format!(
                "{header}\n#include <stdio.h>\nint main(void) {{ static const double s[] = {{{}}}, h[] = {{0, 4321, 20000}};\n\
                 double v[2 * (GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT)]; unsigned k, l, j;\n\
                 for (k = 0; k < sizeof s / sizeof *s; k++) for (l = 0; l < 3; l++) {{\n\
                 gdcm_correction(s[k], h[l], v, v + GDCM_INPUT_COUNT, v + GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT,\n\
                 v + 2 * GDCM_INPUT_COUNT + GDCM_OUTPUT_COUNT);\n\
                 for (j = 0; j < sizeof v / sizeof *v; j++) printf(\"%.17g \", v[j]); }}\nreturn 0; }}\n",
                airspeed_list()
            );
            assert_c_run(&words, &main, &[], &expected);
        }
        let function = program("m", &analysis, "my_study");
        assert!(
            function.contains("my_study(airspeed_kt, altitude_ft)"),
            "{function}"
        );
    }
}

/// Returns an analysis with one input and two outputs of the example, with names that need
/// escaping.
fn analysis_with_nasty_names() -> Analysis {
    let example = embedded_example().unwrap().dataset;
    let mut header = example.header();
    header.inputs[0].name = NASTY[0].to_owned();
    header.outputs[0].name = NASTY[1].to_owned();
    header.outputs[1].name = NASTY[2].to_owned();
    let conditions = example
        .conditions()
        .iter()
        .map(|condition| condition.as_ref().clone())
        .collect();
    let study = Study::new(Arc::new(Dataset::new(header, conditions).unwrap()));
    Engine::default().analyze(&study, &Unobserved).unwrap()
}

#[test]
fn exported_channel_names_are_unchanged_byte_by_byte() {
    let analysis = analysis_with_nasty_names();
    let folder = tempfile::tempdir().unwrap();
    let expected: Vec<f64> = NASTY.concat().bytes().map(f64::from).collect();
    if is_installed("python3") {
        std::fs::write(folder.path().join("c.py"), program("py", &analysis, "")).unwrap();
        let lists =
            "import c\nfor name in c.INPUTS[:1] + c.OUTPUTS[:2]:\n    print(*list(name.encode()))";
        assert_run("names", "python3", &["-c", lists], folder.path(), &expected);
    }
    if is_installed("cc") {
        let main = format!(
            "{}\n#include <stdio.h>\nint main(void) {{\n\
             const char *n[] = {{GDCM_INPUT_NAME_0, GDCM_OUTPUT_NAME_0, GDCM_OUTPUT_NAME_1}};\n\
             const unsigned sizes[] = {{sizeof GDCM_INPUT_NAME_0, sizeof GDCM_OUTPUT_NAME_0, sizeof GDCM_OUTPUT_NAME_1}};\n\
             unsigned k, j; for (k = 0; k < 3; k++) for (j = 0; j + 1 < sizes[k]; j++) printf(\"%d \", (unsigned char)n[k][j]);\n\
             return 0; }}\n",
            program("h", &analysis, "")
        );
        assert_c_run("names", &main, &[], &expected);
    }
}

#[test]
fn an_exported_matlab_function_contains_only_code_and_comments() {
    let text = program("m", &analysis_with_nasty_names(), "k2_v");
    assert!(
        text.is_ascii() && text.starts_with("function [Mi, Mo, tau_i, tau_o] = k2_v("),
        "{text}"
    );
    let line_starts = ["function ", "  ", "end", "%"];
    for line in text.lines().filter(|line| !line.is_empty()) {
        let is_expected = line_starts.iter().any(|start| line.starts_with(start));
        assert!(is_expected, "neither code nor a comment: {line}");
        assert!(
            !matches!(line.trim(), "%{" | "%}"),
            "a block comment: {line}"
        );
    }
    assert_eq!(
        text.lines()
            .filter(|line| line.starts_with("% Input "))
            .count(),
        4
    );
}

#[test]
fn a_file_name_that_is_not_a_matlab_function_name_is_refused() {
    for name in [
        "2nd",
        "my-study",
        "gdcm_table",
        "end",
        "parfor",
        "endfunction",
        "\u{e9}t\u{e9}",
        &"x".repeat(64),
    ] {
        let refused = (MATLAB.check_path)(Path::new(&format!("folder/{name}.m")));
        assert_eq!(
            refused,
            Err(ExportFault::FunctionName {
                found: name.to_owned()
            })
        );
    }
    assert_eq!((MATLAB.check_path)(Path::new("k2_v.m")), Ok(()));
}

#[test]
fn comments_are_ascii_on_one_line_and_contain_no_end_mark() {
    assert_eq!(comment("a\n*/b"), "a<U+000A>* /b");
    assert_eq!(comment("δ\\"), "<U+03B4>\\.");
    assert_eq!(comment("−3 ± 2 dB"), "-3 +- 2 dB");
}

proptest! {
    #[test]
    fn no_text_ends_its_comment(text in "[*/\\\\?%{}\"'a\\n]{0,20}") {
        let plain = comment(&text);
        for mark in ["*/", "/*", "//", "??", "%{", "%}", "\n", "\"\"", "'''"] {
            prop_assert!(!plain.contains(mark), "{}", plain);
        }
    }

    #[test]
    fn a_number_is_parsed_back_exactly(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
        prop_assert_eq!(number(value).parse::<f64>().unwrap(), value);
    }
}
