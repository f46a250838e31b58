//! Import cycles between the files of a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::structure::{code_of, sources};

/// Number of files in each package that import one another in a cycle. The numbers may only fall: a
/// change that breaks a cycle must lower them.
const FILES_IN_CYCLES: &[(&str, usize)] = &[
    ("crates/gdcm-model", 0),
    ("crates/gdcm-method", 0),
    ("crates/gdcm-sysid", 0),
    ("crates/gdcm-study", 0),
    ("crates/gdcm-plot", 0),
    ("crates/gdcm-io", 0),
    (".", 0),
];

/// Module path, relative to the crate root.
type ModulePath = Vec<String>;

/// Returns the modules of a package with their code, without tests and comments.
fn modules(package: &str) -> BTreeMap<ModulePath, String> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(package)
        .join("src");
    let mut found = BTreeMap::new();
    for path in sources(&src) {
        let inside = path.strip_prefix(&src).unwrap().with_extension("");
        let mut module: ModulePath = inside
            .components()
            .map(|part| part.as_os_str().to_str().unwrap().to_owned())
            .collect();
        if module.last().is_some_and(|name| name == "mod") {
            module.pop();
        }
        let is_test = module.iter().any(|name| name.ends_with("tests"));
        if module != ["lib"] && module != ["main"] && !is_test {
            found.insert(module, code_of(&fs::read_to_string(&path).unwrap()));
        }
    }
    found
}

/// Returns the paths that a module names, relative to the crate root: `super::a::{B, c::D}` in
/// `x::y` gives `x::a::B` and `x::a::c`.
fn named_paths(module: &ModulePath, code: &str) -> Vec<ModulePath> {
    fn is_path(c: char) -> bool {
        c.is_ascii_alphanumeric() || c == '_' || c == ':'
    }

    let mut paths = Vec::new();
    for start in ["crate::", "super::"] {
        for (at, _) in code.match_indices(start) {
            let follows = code[..at].chars().next_back().is_some_and(is_path);
            if follows {
                continue;
            }
            let path: String = code[at..].chars().take_while(|c| is_path(*c)).collect();
            let rest = &code[at + path.len()..];
            let segments: Vec<&str> = path.split("::").filter(|name| !name.is_empty()).collect();
            let mut base = module.clone();
            if segments[0] == "crate" {
                base.clear();
            }
            for segment in segments {
                match segment {
                    "crate" => {}
                    "super" => {
                        base.pop();
                    }
                    name => base.push(name.to_owned()),
                }
            }
            if path.ends_with("::") && rest.starts_with('{') {
                let names = rest[1..].split('}').next().unwrap_or_default();
                for name in names.split(',') {
                    let first: String = name
                        .trim()
                        .chars()
                        .take_while(|c| *c != ':' && *c != ' ')
                        .collect();
                    let mut named = base.clone();
                    named.push(first);
                    paths.push(named);
                }
            }
            paths.push(base);
        }
    }
    paths
}

/// Returns the children of each folder, each with the siblings that it names.
fn imports_between_siblings(
    modules: &BTreeMap<ModulePath, String>,
) -> BTreeMap<ModulePath, BTreeMap<ModulePath, BTreeSet<ModulePath>>> {
    let mut folders: BTreeMap<ModulePath, BTreeMap<ModulePath, BTreeSet<ModulePath>>> =
        BTreeMap::new();
    for module in modules.keys() {
        let folder = module[..module.len() - 1].to_vec();
        folders
            .entry(folder)
            .or_default()
            .entry(module.clone())
            .or_default();
    }
    for (module, code) in modules {
        for path in named_paths(module, code) {
            for depth in 1..=module.len() {
                let folder = &module[..depth - 1];
                let is_sibling = path.len() >= depth
                    && path[..depth - 1] == *folder
                    && path[..depth] != module[..depth];
                if !is_sibling {
                    continue;
                }
                let siblings = folders.get_mut(folder).unwrap();
                if siblings.contains_key(&path[..depth]) {
                    siblings
                        .get_mut(&module[..depth])
                        .unwrap()
                        .insert(path[..depth].to_vec());
                }
            }
        }
    }
    folders
}

/// Returns all modules that a module reaches along imports.
fn reached(
    from: &ModulePath,
    imports: &BTreeMap<ModulePath, BTreeSet<ModulePath>>,
) -> BTreeSet<ModulePath> {
    let mut found = BTreeSet::new();
    let mut open = vec![from.clone()];
    while let Some(module) = open.pop() {
        for next in &imports[&module] {
            if found.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    found
}

#[test]
fn files_of_a_folder_import_one_another_in_fewer_and_fewer_circles() {
    let mut wrong = Vec::new();
    for (package, allowed) in FILES_IN_CYCLES {
        let modules = modules(package);
        let mut circular = Vec::new();
        for imports in imports_between_siblings(&modules).values() {
            for module in imports.keys() {
                if reached(module, imports).contains(module) {
                    circular.push(module.join("::"));
                }
            }
        }
        if circular.len() != *allowed {
            wrong.push(format!(
                "{package}: {} instead of {allowed}: {circular:?}",
                circular.len()
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn paths_in_braces_are_found() {
    let module = vec!["study".to_owned(), "engine".to_owned()];
    let paths = named_paths(
        &module,
        "use super::{Study, job::Job};\nuse crate::units::number;",
    );
    let joined: BTreeSet<String> = paths.iter().map(|path| path.join("::")).collect();
    for expected in ["study::Study", "study::job", "units::number"] {
        assert!(joined.contains(expected), "{expected}: {joined:?}");
    }
}
