//! The documentation: the commands given on a page reproduce its figures, every page is in the
//! summary of the site, and every link leads to a file and a heading.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use roxmltree::Document;

use crate::commands::Desk;
use crate::structure::sources;

/// Permitted displacement of a text \[pt\]: on another processor, a digit may be rounded
/// differently.
const MOVED_PT: f64 = 0.5;

/// Returns the commands on the page, without the leading `gdcm`.
fn commands(page: &str) -> Vec<Vec<&str>> {
    let lines = page
        .lines()
        .filter_map(|line| line.strip_prefix("gdcm figure "));
    lines
        .map(|line| {
            std::iter::once("figure")
                .chain(line.split_whitespace())
                .collect()
        })
        .collect()
}

/// Returns the words in an SVG figure with their positions.
fn words(svg: &str) -> Vec<(String, [f64; 2])> {
    let document = Document::parse(svg).unwrap();
    let texts = document
        .descendants()
        .filter(|node| node.has_tag_name("text"));
    texts
        .map(|node| {
            let place = ["x", "y"].map(|name| node.attribute(name).unwrap().parse().unwrap());
            (node.text().unwrap_or_default().to_owned(), place)
        })
        .collect()
}

#[test]
#[ignore = "makes every figure of the page anew: 13 s"]
fn the_commands_of_the_page_make_its_pictures() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let page = fs::read_to_string(docs.join("figures.md")).unwrap();
    let commands = commands(&page);
    assert!(commands.len() >= 8, "{commands:?}");
    let desk = Desk::new();
    fs::create_dir_all(desk.path("docs/figures")).unwrap();
    for command in commands {
        let ended = desk.gdcm(&command);
        assert_eq!((ended.status, ended.error.as_str()), (0, ""), "{command:?}");
        let out = command[command.iter().position(|word| *word == "--out").unwrap() + 1];
        let made = fs::read_to_string(desk.path(out)).unwrap();
        let kept = fs::read_to_string(docs.parent().unwrap().join(out)).unwrap();
        assert!(kept.len() < 240_000, "{out}: {} bytes", kept.len());
        let made = words(&made);
        let kept = words(&kept);
        let same = made.iter().zip(&kept).all(|((a, at), (b, before))| {
            a == b && (at[0] - before[0]).abs() < MOVED_PT && (at[1] - before[1]).abs() < MOVED_PT
        });
        assert!(
            made.len() == kept.len() && same,
            "{out} is not what its command makes"
        );
    }
}

#[test]
fn every_figure_of_the_paper_has_a_picture_on_the_page() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let page = fs::read_to_string(docs.join("figures.md")).unwrap();
    let pictures: Vec<&str> = page
        .split("](figures/")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .collect();
    for picture in &pictures {
        assert!(docs.join("figures").join(picture).is_file(), "{picture}");
    }
    // For example, figure-08-12.svg shows figures 8 to 12.
    let mut shown: Vec<u32> = Vec::new();
    for picture in pictures {
        let numbers: Vec<u32> = picture
            .split(['-', '.'])
            .filter_map(|word| word.parse().ok())
            .collect();
        if let (Some(first), Some(last)) = (numbers.first(), numbers.last()) {
            shown.extend(*first..=*last);
        }
    }
    shown.sort_unstable();
    shown.dedup();
    assert_eq!(shown, (1..=19).collect::<Vec<u32>>());
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the pages in a folder of the repository and in its subfolders, relative to the
/// repository.
fn pages(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![PathBuf::from(folder)];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(root().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if root().join(&path).is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|end| end == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// A page without its blocks of code and its words in code type.
fn prose(text: &str) -> String {
    let mut prose = String::new();
    let mut is_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            for (place, part) in line.split('`').enumerate() {
                if place % 2 == 0 {
                    prose.push_str(part);
                }
            }
            prose.push('\n');
        }
    }
    prose
}

/// Returns the relative links and pictures on a page.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let mut found = Vec::new();
    for (start, end) in [("](", ')'), ("src=\"", '"'), ("srcset=\"", '"')] {
        for rest in prose.split(start).skip(1) {
            let link = rest.split(end).next().unwrap().trim();
            let is_external = ["http:", "https:", "mailto:"]
                .iter()
                .any(|scheme| link.starts_with(scheme));
            if !is_external {
                found.push(link.to_owned());
            }
        }
    }
    found
}

/// Returns the names by which links lead to the headings of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut is_code = false;
    for line in text.lines() {
        if line.starts_with("```") {
            is_code = !is_code;
        }
        let heading = line.trim_start_matches('#');
        if is_code || heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let mut anchor = String::new();
        for letter in heading.trim().to_lowercase().chars() {
            match letter {
                ' ' => anchor.push('-'),
                '-' | '_' => anchor.push(letter),
                letter if letter.is_alphanumeric() => anchor.push(letter),
                _ => {}
            }
        }
        found.insert(anchor);
    }
    found
}

/// Returns a path without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                normal.pop();
            }
            part => normal.push(part),
        }
    }
    normal
}

#[test]
fn every_page_is_in_the_summary_of_the_site_once() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let mut listed: Vec<PathBuf> = links(&summary)
        .iter()
        .map(|link| Path::new("docs").join(link))
        .collect();
    listed.sort();
    let mut expected = pages("docs");
    expected.retain(|page| page != Path::new("docs/SUMMARY.md"));
    assert_eq!(listed, expected);
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut all = pages("docs");
    all.extend(
        [
            "README.md",
            "CONTRIBUTING.md",
            "SECURITY.md",
            "CHANGELOG.md",
            "assets/README.md",
            "tests/data/README.md",
        ]
        .map(PathBuf::from),
    );
    let mut count = 0;
    for page in all {
        let text = fs::read_to_string(root().join(&page)).unwrap();
        for link in links(&text) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() {
                page.clone()
            } else {
                normal(&page.parent().unwrap().join(file))
            };
            let place = format!("{}: {link}", page.display());
            assert!(root().join(&target).exists(), "{place}");
            if !anchor.is_empty() {
                let target = fs::read_to_string(root().join(&target)).unwrap();
                assert!(anchors(&target).contains(anchor), "{place}");
            }
            // `docs/make-book` puts only these files of other folders beside the site.
            if page.starts_with("docs") && !target.starts_with("docs") {
                let is_copied = target.starts_with("assets/screenshots")
                    || target == Path::new("assets/gdcm-dataset.schema.json");
                assert!(is_copied, "not in the site: {place}");
            }
            count += 1;
        }
    }
    assert!(count > 200, "{count}");
}

#[test]
fn the_page_on_stability_lists_every_format() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut written = BTreeSet::new();
    for folder in ["crates", "src"] {
        for path in sources(&root.join(folder)) {
            let text = fs::read_to_string(&path).unwrap();
            // Only string literals that are a format's whole name.
            for part in text.split('"').filter(|part| part.starts_with("gdcm-")) {
                if part
                    .bytes()
                    .all(|byte| byte == b'-' || byte.is_ascii_lowercase())
                {
                    written.insert(part.to_owned());
                }
            }
        }
    }
    let page = fs::read_to_string(root.join("docs/reference/stability.md")).unwrap();
    let mut listed = BTreeSet::new();
    for row in page.lines().filter_map(|line| line.strip_prefix("| `")) {
        let name = row.split('`').next().unwrap_or_default();
        assert!(row[name.len()..].starts_with("` | 1 |"), "{row}");
        listed.insert(name.to_owned());
    }
    assert!(written.len() > 8, "{written:?}");
    assert_eq!(listed, written);
}
