//! Who may import whom.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// For each module of the crate, the modules it may name. The order is that of the crate's documentation.
const MAY_IMPORT: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("executor", &[]),
    ("dataset", &["units"]),
    ("assembly", &["units", "dataset"]),
    ("response", &["units", "dataset"]),
    ("fidelity", &["units", "dataset", "response"]),
    ("identification", &["units", "executor", "dataset", "response", "fidelity"]),
    ("records", &["units", "dataset", "assembly", "identification"]),
    ("correction", &["units", "dataset", "response", "fidelity"]),
    ("schedule", &["units", "dataset", "response", "fidelity", "correction"]),
    ("uncertainty", &["units", "dataset", "response", "fidelity", "correction", "schedule"]),
    (
        "study",
        &[
            "units",
            "executor",
            "dataset",
            "response",
            "fidelity",
            "identification",
            "correction",
            "schedule",
            "uncertainty",
        ],
    ),
    (
        "figure",
        &[
            "units",
            "executor",
            "dataset",
            "response",
            "fidelity",
            "identification",
            "correction",
            "schedule",
            "uncertainty",
            "study",
        ],
    ),
    (
        "io",
        &[
            "units",
            "executor",
            "dataset",
            "assembly",
            "response",
            "fidelity",
            "identification",
            "records",
            "correction",
            "schedule",
            "uncertainty",
            "study",
            "figure",
        ],
    ),
    (
        "view",
        &[
            "units",
            "executor",
            "dataset",
            "assembly",
            "response",
            "fidelity",
            "identification",
            "records",
            "correction",
            "schedule",
            "uncertainty",
            "study",
            "figure",
            "view",
        ],
    ),
    (
        "cli",
        &[
            "units",
            "executor",
            "dataset",
            "assembly",
            "response",
            "fidelity",
            "identification",
            "records",
            "correction",
            "schedule",
            "uncertainty",
            "study",
            "figure",
            "io",
            "app",
        ],
    ),
    (
        "app",
        &[
            "units",
            "executor",
            "dataset",
            "assembly",
            "response",
            "fidelity",
            "identification",
            "records",
            "correction",
            "schedule",
            "uncertainty",
            "study",
            "figure",
            "io",
            "view",
        ],
    ),
];

/// What only some modules may name, because the rest must stay free of windows, files and threads.
const ONLY_IN: &[(&str, &[&str])] = &[
    ("egui::", &["view", "app"]),
    ("egui_plot::", &["view"]),
    ("eframe::", &["app"]),
    ("rfd::", &["app"]),
    ("std::fs", &["io"]),
    ("fs::File", &["io"]),
    ("std::thread", &["app"]),
    ("rayon::", &["app"]),
    ("clap::", &["cli"]),
    // The known answers of its tests.
    ("serde_json::", &["io", "identification"]),
    ("skrifa::", &["figure", "io"]),
    ("vello_cpu::", &["io", "view"]),
    ("pdf_writer::", &["io"]),
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

/// Every source file under `src` with the module of the crate it belongs to and its code without tests and comments.
fn modules() -> Vec<(String, PathBuf, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
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
    for (module, path, code) in modules() {
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
fn windows_files_and_threads_are_named_only_at_the_edge() {
    let mut wrong = Vec::new();
    for (module, path, code) in modules() {
        for (name, only_in) in ONLY_IN {
            if !only_in.contains(&module.as_str()) && code.contains(name) {
                wrong.push(format!("{}: {module} names {name}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_module_map_of_the_documentation_names_every_module() {
    let lib = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    for (module, _) in MAY_IMPORT {
        assert!(lib.contains(&format!("[`{module}`]")), "{module} is not in the module map");
        assert!(lib.contains(&format!("pub mod {module};")), "{module} is not a module of the crate");
    }
}
