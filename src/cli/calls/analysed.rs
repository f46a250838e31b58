//! An analysed study in memory, and its results.

use std::ffi::OsString;
use std::path::Path;

use gdcm_io::export::figure_file::{write_as, write_figure};
use gdcm_io::export::{ExportRequest, ExportedRole, corrected_models_json, corrected_response};
use gdcm_io::files::corrections_file::{
    channel_correction, corrections, write_assessment_csv, write_corrections_csv, write_results,
};
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_method::correction::Pade;
use gdcm_model::progress::Progress;
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat};
use gdcm_study::AssessedCorrection;

use super::opened::OpenedData;
use super::options::parsed;
use super::{CallError, Called, Responses, called};
use crate::cli::analysis_summary::result_summary;
use crate::cli::dataset_lookup::condition_of;
use crate::cli::existing;
use crate::cli::failure::Failure;
use crate::cli::figure::{FigurePlace, drawn_figure};
use crate::cli::progress::ProgressReceiver;
use crate::cli::result_arguments::FigureArguments;
use crate::cli::study_analysis::{ErrorBars, StudyAnalysis, analyze_with_progress};
use crate::cli::study_arguments::StudyArguments;
use crate::cli::study_options::apply_options;

/// An analysed study, with the opened data on which it is based.
pub struct AnalysedStudy {
    analysed: StudyAnalysis,
    data: OpenedData,
}

/// A figure drawn from an analysed study.
pub struct DrawnFigure {
    figure: Figure,
    width: ColumnWidth,
}

/// A condition's physics model, and its correction.
#[derive(Clone, Debug)]
pub struct ModelChoice {
    pub condition: i64,
    /// "nominal", "representative", or the name of a physics model.
    pub model: String,
    /// Whether the schedule's correction is applied; otherwise the condition's own.
    pub is_scheduled: bool,
    /// Order of the Padé approximants by which delays become states.
    pub pade: usize,
}

/// Analyses a dataset or a study with those options of `gdcm analyze` that override its decisions.
///
/// # Errors
/// An option is wrong, no condition has a result, or the work was stopped.
pub fn analyze(
    data: &OpenedData,
    options: Vec<OsString>,
    progress: &dyn Progress,
) -> Result<Called<AnalysedStudy>, CallError> {
    called(|| {
        let arguments: StudyArguments = parsed(options)?;
        let mut study = data.study.clone();
        apply_options(&mut study, &arguments)?;
        let receiver = ProgressReceiver::Program(progress);
        let analysed = analyze_with_progress(study, &arguments, ErrorBars::Computed, receiver)?;
        let data = OpenedData {
            study: analysed.analysis.study.clone(),
            ..data.clone()
        };
        Ok(AnalysedStudy { analysed, data })
    })
}

impl AnalysedStudy {
    /// Returns the study with the decisions on which the analysis is based.
    pub fn data(&self) -> &OpenedData {
        &self.data
    }

    /// Returns all results as the text of `corrections.json`.
    pub fn corrections_json(&self) -> String {
        let analysis = &self.analysed.analysis;
        let chosen = analysis.study.dataset.ids().collect();
        corrections(analysis, &self.data.loaded.sha256, &chosen).to_string()
    }

    /// Returns the summary that `gdcm analyze` prints; its cautions are among the messages.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn summary(&self) -> Result<Called<String>, CallError> {
        called(|| Ok(result_summary(&self.analysed.analysis, &self.data.loaded)))
    }

    /// Returns the tables `corrections.csv` and `assessment.csv`.
    ///
    /// # Errors
    /// A table cannot be written.
    pub fn tables(&self) -> Result<[Vec<u8>; 2], CallError> {
        let analysis = &self.analysed.analysis;
        let chosen = analysis.study.dataset.ids().collect();
        let tables = called(|| {
            let mut channels = Vec::new();
            let mut responses = Vec::new();
            write_corrections_csv(analysis, &chosen, &mut channels)
                .and_then(|()| write_assessment_csv(analysis, &chosen, &mut responses))
                .map_err(|error| Failure::NoResult {
                    reason: error.to_string(),
                })?;
            Ok([channels, responses])
        });
        Ok(tables?.value)
    }

    /// Returns the schedule's correction at an airspeed \[kt\] and a second variable, as JSON:
    /// `gains`, `delays_s` and `lead`. If the second variable is not given, it is the middle of its
    /// range.
    ///
    /// # Errors
    /// There is no schedule.
    pub fn schedule_at(&self, airspeed_kt: f64, second: Option<f64>) -> Result<String, CallError> {
        let analysis = &self.analysed.analysis;
        let correction = called(|| match &analysis.schedule {
            Ok(schedule) => Ok(schedule.evaluate(airspeed_kt, second)),
            Err(error) => Err(Failure::Export((*error).into())),
        })?;
        Ok(channel_correction(analysis, &correction.value).to_string())
    }

    /// Returns a corrected model's response at the frequencies `omega` \[rad/s\], by output and
    /// input. Delays are exact.
    ///
    /// # Errors
    /// The analysis lacks the condition, the model or the correction, or the order of the Padé
    /// approximants is not from 1 to 8.
    pub fn response(&self, choice: &ModelChoice, omega: &[f64]) -> Result<Responses, CallError> {
        let analysis = &self.analysed.analysis;
        let response = called(|| {
            let condition = condition_of(&analysis.study.dataset, choice.condition)?;
            let request = choice.request()?;
            Ok(corrected_response(analysis, &request, condition, omega)?)
        });
        Ok(response?.value)
    }

    /// Returns a corrected model as state-space, as the text of a file `gdcm-models`.
    ///
    /// # Errors
    /// The analysis lacks the condition, the model or the correction, the model has no matrices, or
    /// the order of the Padé approximants is not from 1 to 8.
    pub fn model_json(&self, choice: &ModelChoice) -> Result<Vec<u8>, CallError> {
        let analysis = &self.analysed.analysis;
        let text = called(|| {
            let condition = condition_of(&analysis.study.dataset, choice.condition)?;
            let request = ExportRequest {
                conditions: Some([condition].into()),
                ..choice.request()?
            };
            Ok(corrected_models_json(analysis, &request)?)
        });
        Ok(text?.value)
    }

    /// Draws a figure with the options of `gdcm figure`.
    ///
    /// # Errors
    /// An option is wrong, there is nothing to draw, or the work was stopped.
    pub fn figure(
        &mut self,
        options: Vec<OsString>,
        progress: &dyn Progress,
    ) -> Result<Called<DrawnFigure>, CallError> {
        let analysed = &mut self.analysed;
        called(|| {
            let arguments: FigureArguments = parsed(options)?;
            let place = FigurePlace::requested(&analysed.analysis.study, &arguments)?;
            let receiver = ProgressReceiver::Program(progress);
            Ok(DrawnFigure {
                figure: drawn_figure(place, analysed, arguments.view, receiver)?,
                width: arguments.width,
            })
        })
    }

    /// Writes the same files as `gdcm analyze` into a folder.
    ///
    /// # Errors
    /// A file exists and is not to be replaced, or cannot be written.
    pub fn write_results(&self, folder: &Path, may_replace: bool) -> Result<(), CallError> {
        let analysis = &self.analysed.analysis;
        let loaded = &self.data.loaded;
        let inputs = if self.data.is_stored {
            loaded.origin.file().into_iter().collect()
        } else {
            Vec::new()
        };
        let chosen = analysis.study.dataset.ids().collect();
        called(|| {
            make_directory(folder)?;
            let outputs = OutputSet::new(existing(may_replace), inputs);
            write_results(analysis, &loaded.sha256, &chosen, folder, outputs)?;
            Ok(())
        })?;
        Ok(())
    }
}

impl ModelChoice {
    fn request(&self) -> Result<ExportRequest, Failure> {
        let Some(pade) = Pade::new(self.pade) else {
            let reason = format!("expected a whole number from 1 to 8, found {}", self.pade);
            return Err(Failure::option("--pade", reason));
        };
        Ok(ExportRequest {
            role: ExportedRole::from_name(&self.model),
            correction: if self.is_scheduled {
                AssessedCorrection::Scheduled
            } else {
                AssessedCorrection::Own
            },
            pade,
            ..ExportRequest::default()
        })
    }
}

impl DrawnFigure {
    pub fn title(&self) -> &str {
        &self.figure.title
    }

    /// Returns the contents of a file that shows the figure.
    ///
    /// # Errors
    /// The figure cannot be drawn in this format.
    pub fn bytes(&self, format: FigureFormat) -> Result<Vec<u8>, CallError> {
        let bytes = called(|| {
            let mut bytes = Vec::new();
            write_as(&self.figure, self.width, format, &mut bytes).map_err(|error| {
                Failure::NoResult {
                    reason: error.to_string(),
                }
            })?;
            Ok(bytes)
        });
        Ok(bytes?.value)
    }

    /// Writes the figure to a file; the extension selects the format: svg, png, pdf or csv.
    ///
    /// # Errors
    /// The extension is unknown, the file exists and is not to be replaced, or cannot be written.
    pub fn save(&self, path: &Path, may_replace: bool) -> Result<(), CallError> {
        let outputs = OutputSet::new(existing(may_replace), Vec::new());
        called(|| Ok(write_figure(&self.figure, self.width, path, outputs)?))?;
        Ok(())
    }
}

/// Returns the figure format with this extension; SVG for an unknown one.
pub fn figure_format_named(extension: &str) -> FigureFormat {
    for format in FigureFormat::ALL {
        if format.extension() == extension {
            return format;
        }
    }
    FigureFormat::Svg
}
