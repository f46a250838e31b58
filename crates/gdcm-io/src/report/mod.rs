//! Report on a study: a single HTML file without external resources, for printing on A4 or letter
//! paper. The same inputs give the same bytes: the report states neither the time nor any folder.
//!
//! The first page has the verdict, the corrections and the signatures. The contents follow, then
//! the sections that a reader needs, with figures four to a page, and appendices with the rest.
//!
//! ```text
//! 1  compute what the analysis lacks and several sections show: error bars, the assessments of
//!    couplings and physics parameters, the requirements
//! 2  write the page: first page, contents, sections, appendices
//! 3  title and origin; headings, counts and notes for the export dialog
//! ```

mod assessment;
mod condition_plots;
mod condition_tables;
mod conditions;
mod couplings;
mod first_page;
mod limits;
mod models_left_out;
mod noted_table;
mod page;
mod physics;
mod provenance;
mod report_notes;
mod requirements;
mod schedule;
mod settings;
mod shown_models;
mod uncertainty;
mod wording;

use std::path::Path;

use gdcm_model::message_text::sanitized;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::results::export_note::{ExportNote, FileSummary};
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::{Analysis, Engine};

use self::page::Page;
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::files::dataset_file::LoadedDataset;
use crate::output_set::OutputSet;
use crate::software::software;

pub use self::first_page::assessment_sentence;

/// A study's file names and dataset hash, as stated in the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportSource {
    /// Study file name; `None` if not saved.
    pub study: Option<String>,
    /// Dataset file name; without a file, the example's name in parentheses, such as "(embedded
    /// example)".
    pub dataset: String,
    /// SHA-256 of the dataset file, in hexadecimal.
    pub sha256: String,
    /// Irregularities found when the dataset file was read.
    pub cautions: Vec<FileCaution>,
}

impl ReportSource {
    /// Describes a study's files: its dataset, and the study file if it is saved. Folders are
    /// omitted, so that the report does not depend on their location.
    pub fn from_files(loaded: &LoadedDataset, study: Option<&Path>) -> Self {
        let study = study
            .and_then(Path::file_name)
            .map(|name| sanitized(&name.to_string_lossy()));
        Self {
            study,
            dataset: loaded.file_name(),
            sha256: loaded.sha256.clone(),
            cautions: loaded.cautions.clone(),
        }
    }
}

/// Results from which a report is made.
#[derive(Clone, Copy, Debug)]
pub struct ReportSubject<'a> {
    /// Analysis of the study; the report also evaluates its requirements.
    pub analysis: &'a Analysis,
    /// Model responses to flight records, if available.
    pub histories: Option<&'a TimeHistories>,
    /// Poles of the identified models with their uncertainty, which the dataset does not store.
    pub known: &'a IdentifiedPoles,
}

/// A report with facts about it, which the export dialog shows before the file is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub html: String,
    /// Headings of the sections and appendices.
    pub headings: Vec<String>,
    pub summary: FileSummary,
    /// Omissions of the report.
    pub notes: Vec<ExportNote>,
}

/// Returns the report on an analysis as HTML; see [`compose_report`].
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub fn report(
    subject: ReportSubject<'_>,
    source: &ReportSource,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<String, Cancelled> {
    Ok(compose_report(subject, source, engine, progress)?.html)
}

/// Returns the report on an analysis. Error bars and the assessments of couplings and physics
/// parameters are computed first if the analysis lacks them, because several sections show them;
/// `engine` also computes the responses that are plotted. Each condition is a progress step.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub fn compose_report(
    subject: ReportSubject<'_>,
    source: &ReportSource,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Report, Cancelled> {
    // Step 1.
    let with_bars = uncertainty::with_bars(subject.analysis, engine, progress)?;
    let with_couplings = couplings::with_couplings(with_bars, engine, progress)?;
    let analysis = &physics::with_physics(with_couplings, engine, progress)?;
    let mut page = Page::default();
    let subject = ReportSubject {
        analysis,
        ..subject
    };
    let requirements = requirements::evaluate(subject, engine, progress)?;
    // Step 2.
    first_page::add_first_page(&mut page, analysis);
    page.contents_here();
    schedule::add_schedule(&mut page, analysis);
    physics::add_physics(&mut page, analysis);
    couplings::add_couplings(&mut page, analysis);
    conditions::add_conditions(&mut page, analysis, engine, progress)?;
    assessment::add_assessment(&mut page, analysis);
    uncertainty::add_uncertainty(&mut page, analysis);
    requirements::add_requirements(&mut page, &requirements, subject);
    models_left_out::add_models_left_out(&mut page, analysis);
    settings::add_settings(&mut page, &analysis.study);
    provenance::add_files(&mut page, &analysis.study, source);
    conditions::add_condition_details(&mut page, analysis, engine, progress)?;
    schedule::add_channels_of_conditions(&mut page, analysis);
    assessment::add_assessment_details(&mut page, analysis);
    uncertainty::add_uncertainty_details(&mut page, analysis);
    requirements::add_requirement_details(&mut page, &requirements, subject);
    page.appendix("The method");
    page.fixed(include_str!("method.html"));
    provenance::add_models(&mut page, &analysis.study);
    // Step 3.
    let title = format!(
        "Gain and delay corrections of {}",
        analysis.study.dataset.name()
    );
    let study = match &source.study {
        Some(study) => format!("Study {study}. "),
        None => String::new(),
    };
    let origin = format!("{study}Dataset {}. Made by {}.", source.dataset, software());
    Ok(Report {
        headings: page.section_headings(),
        summary: FileSummary::Report {
            conditions: analysis.study.dataset.conditions().len(),
            figures: page.figure_count(),
            tables: page.table_count(),
        },
        notes: report_notes::report_notes(subject),
        html: page.finish(&title, &[origin]),
    })
}

/// Progress for computations within a report step: forwards cancellation, and does not show their
/// own steps.
struct CancellationOnly<'a>(&'a dyn Progress);

impl Progress for CancellationOnly<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

/// Writes a report to `path`, completely or not at all.
pub fn save_report(report: &str, path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| file.write_all(report.as_bytes()))?;
    outputs.persist()
}
