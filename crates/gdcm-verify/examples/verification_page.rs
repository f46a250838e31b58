//! Makes `docs/verification.md` and its figures from the lines in a folder, or compares them:
//! `verification_page FOLDER [--check]`. Called by `docs/make-verification`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gdcm_verify::page::figures::Figures;
use gdcm_verify::page::page_text;

fn main() -> ExitCode {
    match make() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Makes the page, or compares its figures; returns whether the figures are those of the page.
fn make() -> Result<bool, Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("a folder is expected")?);
    let is_check = arguments.next().is_some_and(|option| option == "--check");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let figures_path = root.join("tests/data/verification.json");
    let fresh = Figures::read(&folder)?;
    let mut known = match std::fs::read_to_string(&figures_path) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(_) => Figures::default(),
    };
    if is_check {
        let differences = known.differences(&fresh);
        for difference in &differences {
            eprintln!("changed: {difference}");
        }
        println!(
            "{} figures of docs/verification.md compared, {} changed",
            known.deviations.len() + known.coverage.len(),
            differences.len()
        );
        return Ok(differences.is_empty());
    }
    known.update(&fresh);
    let page = page_text(&known)?;
    std::fs::write(
        &figures_path,
        format!("{}\n", serde_json::to_string_pretty(&known)?),
    )?;
    std::fs::write(root.join("docs/verification.md"), page)?;
    println!(
        "docs/verification.md is made of {} figures",
        known.deviations.len() + known.coverage.len()
    );
    Ok(true)
}
