//! Who may import whom.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// For each module of `gdcm-core`, the modules it may name. Cargo forbids the rest: the numbers know neither files nor windows.
const MAY_IMPORT: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("message_text", &[]),
    ("executor", &[]),
    ("whole_number", &[]),
    ("dataset", &["units", "message_text", "whole_number"]),
    ("progress", &["dataset"]),
    ("assembly", &["units", "message_text", "whole_number", "dataset"]),
    ("response", &["units", "dataset"]),
    ("fidelity", &["units", "dataset", "response"]),
    ("identification", &["units", "executor", "progress", "dataset", "response", "fidelity"]),
    ("records", &["units", "executor", "dataset", "assembly", "response", "identification"]),
    ("correction", &["units", "dataset", "response", "fidelity"]),
    ("schedule", &["units", "whole_number", "dataset", "response", "fidelity", "correction"]),
    ("uncertainty", &["units", "dataset", "response", "fidelity", "correction", "schedule"]),
    (
        "couplings",
        &["units", "executor", "progress", "dataset", "response", "fidelity", "correction", "schedule", "uncertainty"],
    ),
    (
        "requirements",
        &[
            "units",
            "message_text",
            "executor",
            "dataset",
            "assembly",
            "response",
            "fidelity",
            "identification",
            "uncertainty",
        ],
    ),
    (
        "study",
        &[
            "units",
            "executor",
            "progress",
            "whole_number",
            "dataset",
            "response",
            "fidelity",
            "identification",
            "records",
            "correction",
            "schedule",
            "uncertainty",
            "couplings",
            "requirements",
        ],
    ),
];

/// What the modules of the program may not name: drawing knows no files, the commands no window.
const MAY_NOT_NAME: &[(&str, &[&str])] = &[
    ("view", &["crate::app", "crate::cli", "std::fs", "std::thread", "rayon::", "eframe::", "rfd::"]),
    ("cli", &["crate::view", "crate::app", "egui", "eframe::", "rfd::"]),
    ("app", &["crate::cli", "egui_plot::", "clap::"]),
    ("executor", &["crate::"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
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

/// Every source file under `src` of a package with the module it belongs to and its code without tests and comments.
fn modules(package: &str) -> Vec<(String, PathBuf, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(package).join("src");
    sources(&src)
        .into_iter()
        .map(|path| {
            let inside = path.strip_prefix(&src).unwrap();
            let first = inside.components().next().unwrap().as_os_str().to_str().unwrap();
            let module = first.trim_end_matches(".rs").to_owned();
            (module, inside.to_owned(), code_of(&fs::read_to_string(&path).unwrap()))
        })
        .filter(|(module, ..)| module != "main" && module != "lib")
        .collect()
}

fn code_of(text: &str) -> String {
    let before_tests = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = before_tests.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

fn named_modules(code: &str) -> Vec<String> {
    code.match_indices("crate::")
        .map(|(at, prefix)| {
            let rest = &code[at + prefix.len()..];
            rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect()
        })
        .collect()
}

#[test]
fn every_module_imports_only_what_lies_before_it() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_IMPORT.iter().copied().collect();
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (module, path, code) in modules("crates/gdcm-core") {
        let may = allowed.get(module.as_str()).unwrap_or_else(|| panic!("{module} is not in the table"));
        for named in named_modules(&code) {
            seen += 1;
            if named != module && !may.contains(&named.as_str()) {
                wrong.push(format!("{}: {module} imports {named}", path.display()));
            }
        }
    }
    assert!(seen > 100, "the imports were found: {seen}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn drawing_names_no_files_and_the_commands_no_window() {
    let mut wrong = Vec::new();
    for (module, path, code) in modules("") {
        for (of, names) in MAY_NOT_NAME {
            let named = names.iter().filter(|name| *of == module && code.contains(**name));
            wrong.extend(named.map(|name| format!("{}: {module} names {name}", path.display())));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_numbers_touch_no_files_and_start_no_threads() {
    let mut wrong = Vec::new();
    for (module, path, code) in modules("crates/gdcm-core") {
        for name in ["std::fs", "fs::File", "std::thread", "rayon::"] {
            if code.contains(name) {
                wrong.push(format!("{}: {module} names {name}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_module_map_of_the_documentation_names_every_module() {
    let lib = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/gdcm-core/src/lib.rs")).unwrap();
    for (module, _) in MAY_IMPORT {
        assert!(lib.contains(&format!("[`{module}`]")), "{module} is not in the module map");
        assert!(lib.contains(&format!("pub mod {module};")), "{module} is not a module of the crate");
    }
}
