//! Permitted imports between crates and modules.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of a crate, each with the modules of the same crate that it may name.
type ModuleTable = &'static [(&'static str, &'static [&'static str])];

/// The crates from the bottom up, each with its modules and, for each module, the modules of the
/// same crate that it may name. Cargo rules out imports of higher crates; none of these crates uses
/// files or windows.
const CRATES: &[(&str, ModuleTable)] = &[
    (
        "gdcm-model",
        &[
            ("number_format", &[]),
            ("units", &["number_format"]),
            ("message_text", &[]),
            ("executor", &[]),
            ("whole_number", &[]),
            ("statistics", &[]),
            (
                "dataset",
                &["number_format", "units", "message_text", "whole_number"],
            ),
            ("progress", &["dataset"]),
            (
                "assembly",
                &["number_format", "units", "whole_number", "dataset", "names"],
            ),
            ("names", &["units", "message_text", "dataset"]),
            ("response", &["units", "dataset", "statistics"]),
            ("simulation", &["executor", "dataset", "response"]),
        ],
    ),
    (
        "gdcm-method",
        &[
            ("fidelity", &[]),
            ("correction", &["fidelity"]),
            ("schedule", &["fidelity", "correction"]),
            ("uncertainty", &["fidelity", "correction", "schedule"]),
            (
                "couplings",
                &["fidelity", "correction", "schedule", "uncertainty"],
            ),
            ("physics", &["fidelity", "correction", "uncertainty"]),
            ("requirements", &["fidelity", "uncertainty"]),
        ],
    ),
    (
        "gdcm-sysid",
        &[
            ("spectra", &[]),
            ("records", &["spectra"]),
            ("identification_error", &["spectra"]),
            ("options", &["identification_error", "spectra"]),
            ("subspace", &[]),
            ("likelihood", &["spectra", "subspace"]),
            (
                "diagnostics",
                &["spectra", "subspace", "likelihood", "options"],
            ),
            (
                "planning",
                &["spectra", "subspace", "likelihood", "diagnostics"],
            ),
            (
                "identification",
                &[
                    "spectra",
                    "subspace",
                    "likelihood",
                    "diagnostics",
                    "planning",
                    "identification_error",
                    "options",
                ],
            ),
        ],
    ),
    (
        "gdcm-study",
        &[
            ("shared", &[]),
            ("execution", &[]),
            ("decisions", &[]),
            ("results", &["shared", "execution", "decisions"]),
            ("stages", &["execution", "decisions", "results"]),
            (
                "jobs",
                &["shared", "execution", "decisions", "results", "stages"],
            ),
        ],
    ),
    (
        "gdcm-words",
        &[
            ("table", &[]),
            ("caution", &[]),
            ("convention_doubt", &[]),
            ("channel_time_skew", &[]),
            ("missing_results", &[]),
            ("edit", &[]),
            ("dataset_differences", &["edit"]),
            ("decision_differences", &[]),
            ("setting_words", &[]),
            ("gain_source", &[]),
            ("schedule", &[]),
            ("conflict_text", &[]),
            ("sensitivity", &[]),
            ("solution_details", &["conflict_text", "sensitivity"]),
            ("coupling_error", &[]),
            ("coupled_model_error", &[]),
            ("coupling_remark", &["coupling_error"]),
            (
                "remark",
                &[
                    "caution",
                    "convention_doubt",
                    "schedule",
                    "conflict_text",
                    "coupling_remark",
                ],
            ),
            ("lead_price", &[]),
            ("leads", &["remark", "lead_price"]),
            ("export", &["coupling_error", "lead_price", "schedule"]),
            ("couplings", &["coupling_remark", "table"]),
            ("physics", &["couplings", "table"]),
            ("suggested_runs", &[]),
            ("identification_caution", &[]),
            ("input_limit_text", &[]),
            ("assessment", &["caution"]),
            ("uncertainty", &["table"]),
            ("verdict", &["caution", "table"]),
            ("flight_plan", &["table"]),
            ("time_histories", &["table"]),
            (
                "requirement_grid",
                &["missing_results", "table", "time_histories"],
            ),
            (
                "requirements",
                &[
                    "missing_results",
                    "table",
                    "time_histories",
                    "requirement_grid",
                ],
            ),
            (
                "derivation",
                &["assessment", "uncertainty", "leads", "solution_details"],
            ),
        ],
    ),
    ("gdcm-plot", &[("figure", &[]), ("paper", &["figure"])]),
];

/// Modules of gdcm-io, the only crate that accesses files. Each may name only the modules listed
/// before it.
const FILE_MODULES: &[&str] = &[
    "variable_fault",
    "reading_budget",
    "export_fault",
    "content_fault",
    "json_empty_members",
    "json_path",
    "json_outline",
    "json_location",
    "file_error",
    "file_caution",
    "json_lists",
    "json_arrays",
    "json_errors",
    "unknown_keys",
    "json_reading",
    "json_writing",
    "user_paths",
    "relative_folder",
    "gzip",
    "file_reading",
    "software",
    "output_set",
    "csv_text",
    "files",
    "formats",
    "import",
    "export",
    "report",
];

/// For each crate, the crates of this workspace that it may depend on.
const MAY_DEPEND: &[(&str, &[&str])] = &[
    ("gdcm-numerics", &[]),
    ("gdcm-model", &[]),
    ("gdcm-method", &["gdcm-numerics", "gdcm-model"]),
    ("gdcm-sysid", &["gdcm-numerics", "gdcm-model"]),
    ("gdcm-study", &["gdcm-model", "gdcm-method", "gdcm-sysid"]),
    (
        "gdcm-words",
        &["gdcm-model", "gdcm-method", "gdcm-sysid", "gdcm-study"],
    ),
    (
        "gdcm-plot",
        &[
            "gdcm-model",
            "gdcm-method",
            "gdcm-sysid",
            "gdcm-study",
            "gdcm-words",
        ],
    ),
    (
        "gdcm-io",
        &[
            "gdcm-model",
            "gdcm-method",
            "gdcm-sysid",
            "gdcm-study",
            "gdcm-words",
            "gdcm-plot",
        ],
    ),
    (
        "gdcm-verify",
        &[
            "gdcm-model",
            "gdcm-method",
            "gdcm-sysid",
            "gdcm-study",
            "gdcm-io",
        ],
    ),
];

/// Paths that drawing code may not name: files, threads, and the shell of the window.
const DRAWING_MAY_NOT_NAME: &[&str] = &[
    "crate::gui::app",
    "crate::cli",
    "std::fs",
    "std::thread",
    "rayon::",
    "eframe::",
    "rfd::",
];

/// Folders of the program, each with the paths that it may not name.
const MAY_NOT_NAME: &[(&str, &[&str])] = &[
    ("gui/commands", DRAWING_MAY_NOT_NAME),
    ("gui/panels", DRAWING_MAY_NOT_NAME),
    ("gui/plot", DRAWING_MAY_NOT_NAME),
    ("gui/state", DRAWING_MAY_NOT_NAME),
    ("gui/views", DRAWING_MAY_NOT_NAME),
    ("gui/widgets", DRAWING_MAY_NOT_NAME),
    ("gui/app", &["crate::cli", "egui_plot::", "clap::"]),
    ("cli", &["crate::gui", "egui", "eframe::", "rfd::"]),
    ("executor.rs", &["crate::"]),
];

/// Folders of the window. Each may name only the folders listed before it.
const GUI_FOLDERS: &[&str] = &[
    "widgets", "plot", "state", "commands", "views", "panels", "app",
];

pub(super) fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// Returns every source file under `src` of a package: its module, its path, and its code without
/// tests and comments.
fn modules(package: &str) -> Vec<(String, PathBuf, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(package)
        .join("src");
    sources(&src)
        .into_iter()
        .map(|path| {
            let inside = path.strip_prefix(&src).unwrap();
            let first = inside
                .components()
                .next()
                .unwrap()
                .as_os_str()
                .to_str()
                .unwrap();
            let module = first.trim_end_matches(".rs").to_owned();
            (
                module,
                inside.to_owned(),
                code_of(&fs::read_to_string(&path).unwrap()),
            )
        })
        .filter(|(module, path, _)| module != "main" && module != "lib" && !is_test_file(path))
        .collect()
}

/// Returns whether a file contains only tests.
fn is_test_file(path: &Path) -> bool {
    path.file_stem()
        .is_some_and(|name| name.to_string_lossy().ends_with("tests"))
}

/// Returns the text before the first inline test module.
fn without_tests(text: &str) -> &str {
    const START: &str = "#[cfg(test)]\nmod ";
    for (at, _) in text.match_indices(START) {
        let declaration = text[at + START.len()..].lines().next();
        if declaration.is_some_and(|line| line.ends_with('{')) {
            return &text[..at];
        }
    }
    text
}

pub(super) fn code_of(text: &str) -> String {
    let before_tests = without_tests(text);
    let lines = before_tests
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

fn named_modules(code: &str) -> Vec<String> {
    code.match_indices("crate::")
        .map(|(at, prefix)| {
            let rest = &code[at + prefix.len()..];
            rest.chars()
                .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                .collect()
        })
        .collect()
}

#[test]
fn every_module_imports_only_modules_below_it() {
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (package, table) in CRATES {
        let allowed: BTreeMap<&str, &[&str]> = table.iter().copied().collect();
        for (module, path, code) in modules(&format!("crates/{package}")) {
            let may = allowed
                .get(module.as_str())
                .unwrap_or_else(|| panic!("{package}: {module} is not in the table"));
            for named in named_modules(&code) {
                seen += 1;
                if named != module && !may.contains(&named.as_str()) {
                    wrong.push(format!(
                        "{package}/{}: {module} imports {named}",
                        path.display()
                    ));
                }
            }
        }
    }
    assert!(seen > 50, "the imports were found: {seen}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn file_modules_import_only_modules_below_them() {
    let mut wrong = Vec::new();
    for (module, path, code) in modules("crates/gdcm-io") {
        let place = FILE_MODULES
            .iter()
            .position(|name| *name == module)
            .unwrap_or_else(|| panic!("{module} is not in the list"));
        for named in named_modules(&code) {
            let is_above = FILE_MODULES[place + 1..].contains(&named.as_str());
            if is_above {
                wrong.push(format!("{}: {module} imports {named}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_crate_depends_only_on_crates_below_it() {
    for (package, may) in MAY_DEPEND {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("crates")
            .join(package)
            .join("Cargo.toml");
        let manifest = fs::read_to_string(path).unwrap();
        let dependencies = manifest
            .lines()
            .filter_map(|line| line.split(['.', ' ', '=']).next());
        for named in dependencies.filter(|name| name.starts_with("gdcm-")) {
            assert!(may.contains(&named), "{package} depends on {named}");
        }
    }
}

#[test]
fn drawing_names_no_files_and_the_commands_no_window() {
    let mut wrong = Vec::new();
    for (folder, names) in MAY_NOT_NAME {
        let mut files = 0;
        for (_, path, code) in modules("") {
            if !path.starts_with(folder) {
                continue;
            }
            files += 1;
            for name in *names {
                if code.contains(name) {
                    wrong.push(format!("{} names {name}", path.display()));
                }
            }
        }
        assert!(files > 0, "{folder} is there");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_folder_of_the_window_imports_only_folders_before_it() {
    fn rank(folder: &str) -> Option<usize> {
        GUI_FOLDERS.iter().position(|known| *known == folder)
    }

    let mut wrong = Vec::new();
    let mut seen = 0;
    for (_, path, code) in modules("") {
        let parts: Vec<&str> = path
            .iter()
            .map(|part| part.to_str().unwrap().trim_end_matches(".rs"))
            .collect();
        if parts[0] != "gui" || parts[1] == "mod" {
            continue;
        }
        let own = rank(parts[1]).unwrap_or_else(|| panic!("gui/{} is not listed", parts[1]));
        for (at, prefix) in code.match_indices("crate::gui::") {
            let named: String = code[at + prefix.len()..]
                .chars()
                .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                .collect();
            seen += 1;
            // Paths that name no folder, such as `crate::gui::{`, are not checked.
            if rank(&named).is_none_or(|place| place > own) {
                wrong.push(format!("{} names gui::{named}", path.display()));
            }
        }
    }
    assert!(seen > 300, "the imports were found: {seen}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_numbers_touch_no_files_and_start_no_threads() {
    let mut wrong = Vec::new();
    for (package, _) in CRATES {
        for (module, path, code) in modules(&format!("crates/{package}")) {
            for name in ["std::fs", "fs::File", "std::thread", "rayon::"] {
                if code.contains(name) {
                    wrong.push(format!(
                        "{package}/{}: {module} names {name}",
                        path.display()
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_front_page_of_a_crate_names_every_module() {
    for (package, table) in CRATES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("crates")
            .join(package)
            .join("src/lib.rs");
        let lib = fs::read_to_string(path).unwrap();
        for (module, _) in *table {
            assert!(
                lib.contains(&format!("[`{module}`]")),
                "{package}: {module} is not in its table of modules"
            );
            assert!(
                lib.contains(&format!("pub mod {module};")),
                "{module} is not a module of {package}"
            );
        }
    }
}

/// Returns every line of code in the workspace, with its location.
fn lines_of_code() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut lines = Vec::new();
    for folder in ["crates", "src"] {
        for path in sources(&root.join(folder)) {
            let inside = path.strip_prefix(root).unwrap().to_owned();
            let is_test = inside
                .file_stem()
                .is_some_and(|name| name.to_string_lossy().ends_with("tests"));
            if is_test || inside.components().any(|part| part.as_os_str() == "tests") {
                continue;
            }
            for line in code_of(&fs::read_to_string(&path).unwrap()).lines() {
                lines.push((inside.display().to_string(), line.to_owned()));
            }
        }
    }
    lines
}

#[test]
fn imports_are_explicit() {
    let mut wrong = Vec::new();
    for (path, line) in lines_of_code() {
        // Lines of inline test modules are indented, and therefore not checked.
        let code = line.as_str();
        let is_import =
            code.starts_with("use ") || (code.starts_with("pub") && code.contains(" use "));
        let is_own =
            code.contains("super::*") || code.contains("crate::") || code.starts_with("pub");
        if is_import && is_own && code.ends_with("::*;") {
            wrong.push(format!("{path}: {code}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn public_functions_and_types_of_the_library_crates_are_documented() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let mut wrong = Vec::new();
    let mut seen = 0;
    for path in sources(&root) {
        if path.components().any(|part| part.as_os_str() == "tests") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let mut is_documented = false;
        let mut is_in_attribute = false;
        for line in without_tests(&text).lines() {
            let code = line.trim_start();
            if code.starts_with("///") || code.starts_with("#[doc") {
                is_documented = true;
                continue;
            }
            if code.starts_with("#[") || is_in_attribute {
                is_in_attribute = !code.ends_with(']');
                continue;
            }
            if code.starts_with("//") {
                continue;
            }
            let item = [
                "pub fn ",
                "pub const fn ",
                "pub struct ",
                "pub enum ",
                "pub trait ",
                "pub type ",
            ];
            if item.iter().any(|start| code.starts_with(start)) {
                seen += 1;
                if !is_documented {
                    wrong.push(format!("{}: {code}", path.display()));
                }
            }
            is_documented = false;
        }
    }
    assert!(seen > 500, "the items were found: {seen}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}
