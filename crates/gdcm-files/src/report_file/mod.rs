//! The report of a study: one file in HTML that needs nothing else and prints on A4 and letter. The same study makes the same bytes.

mod assessment;
mod conditions;
mod evidence;
mod extent;
mod left_out;
mod markup;
mod method;
mod models;
mod page;
mod plots;
mod responses;
mod schedule;
mod settings;
mod sources;
mod summary;

use std::path::Path;

use gdcm_core::study::{Analysis, Cancelled, Engine, Progress};

use super::dataset_file::LoadedDataset;
use super::file_error::FileError;
use super::output_set::OutputSet;
use gdcm_core::message_text::sanitized;

use page::Page;

/// What a report says of the files that a study is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportSource {
    /// The name of the study's file; none of a study that is not saved.
    pub study: Option<String>,
    /// The name of the dataset's file, or what stands for it.
    pub dataset: String,
    /// SHA-256 of that file, in hexadecimal.
    pub sha256: String,
    /// What is odd about it.
    pub cautions: Vec<String>,
}

impl ReportSource {
    /// The files of a study: its dataset, and its own where it has one. They are named without their folders, so that the report
    /// is the same wherever they are.
    pub fn of(loaded: &LoadedDataset, study: Option<&Path>) -> Self {
        let study = study.and_then(Path::file_name).map(|name| sanitized(&name.to_string_lossy()));
        let cautions = loaded.cautions.clone();
        Self { study, dataset: loaded.file_name(), sha256: loaded.sha256.clone(), cautions }
    }
}

/// The report of an analysis; `engine` has the responses that are drawn. Each condition is a step of the progress.
///
/// # Errors
/// [`Cancelled`] soon after `progress` says so.
pub fn report(
    analysis: &Analysis,
    source: &ReportSource,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<String, Cancelled> {
    let analysis = &evidence::with_bars(analysis, engine, progress)?;
    let mut page = Page::default();
    summary::add(&mut page, analysis);
    settings::add(&mut page, &analysis.study);
    sources::add_files(&mut page, &analysis.study, source);
    left_out::add(&mut page, analysis);
    conditions::add(&mut page, analysis, engine, progress)?;
    schedule::add(&mut page, analysis);
    evidence::add(&mut page, analysis);
    assessment::add(&mut page, analysis);
    method::add(&mut page);
    sources::add_models(&mut page, &analysis.study);
    let title = format!("Gain and delay corrections of {}", analysis.study.dataset.name());
    Ok(page.finish(&title, &sources::title_lines(source)))
}

/// Writes a report, whole or not at all.
pub fn save_report(report: &str, path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| file.write_all(report.as_bytes()))?;
    outputs.persist()
}
