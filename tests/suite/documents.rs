//! Figures in the documentation: the commands given on the page reproduce them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

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
