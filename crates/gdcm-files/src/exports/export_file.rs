//! A study's corrections in a file for other tools.

use std::collections::BTreeSet;
use std::path::Path;

use crate::corrections_file::{Corrections, channel_table, write_corrections};
use crate::file_error::FileError;
use crate::mat;
use crate::models_file::add_models;
use crate::npy::write_npz;
use crate::output_set::OutputSet;
use crate::variables::{Variable, VariableFault};
use gdcm_core::dataset::ConditionId;
use gdcm_core::schedule::Schedule;
use gdcm_core::study::{Analysis, ExportFormat, ExportRequest};

use super::breakpoint_table::BreakpointTable;
use super::c_header::c_header;
use super::corrections_variable::corrections_variable;
use super::export_fault::ExportFault;
use super::exported_model::{ExportedModel, exported_models};
use super::found_models::found_models;
use super::gather::ExportSource;
use super::matlab_function::{check_function_name, matlab_function};
use super::model_variables::{model_arrays, models_variable};
use super::python_module::python_module;
use super::scheduled_correction::ScheduledCorrection;
use super::table_csv::table_csv;
use super::table_mat::table_variable;

/// What corrected models are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelsFormat {
    Mat,
    Json,
    Npz,
}

/// Refuses a name that does not fit what is to be exported: a question for before the work.
///
/// # Errors
/// [`FileError::Export`] where the end of the name says nothing that corrected models can be written as, or the name is none that
/// MATLAB can call.
pub fn check_export(format: ExportFormat, path: &Path) -> Result<(), FileError> {
    let checked = match format {
        ExportFormat::StateSpace => models_format(path).map(drop),
        ExportFormat::Matlab => check_function_name(&stem(path)),
        _ => Ok(()),
    };
    checked.map_err(|fault| FileError::export(path, fault))
}

/// Writes what a request asks for, and gives what is to be known of it, line by line.
pub fn write_export(
    analysis: &Analysis,
    source: &ExportSource,
    request: &ExportRequest,
    path: &Path,
    mut outputs: OutputSet,
) -> Result<Vec<String>, FileError> {
    check_export(request.format, path)?;
    let fault = |fault| FileError::export(path, fault);
    let all: BTreeSet<ConditionId> = analysis.conditions.keys().copied().collect();
    let mut remarks = Vec::new();
    match request.format {
        ExportFormat::Json => outputs.add(path, |file| write_corrections(analysis, &source.sha256, &all, file))?,
        ExportFormat::Csv => outputs.add(path, |file| channel_table(analysis, &all, file))?,
        ExportFormat::Mat => {
            let corrections = Corrections::of(analysis, &source.sha256, &all);
            let variable = corrections_variable(&corrections, &analysis.study.dataset);
            add_variables(&[variable], mat::write, path, &mut outputs)?;
        }
        ExportFormat::StateSpace => {
            let models = exported_models(analysis, request).map_err(fault)?;
            remarks.extend(models.iter().map(ExportedModel::words));
            add_exported_models(&models, analysis, path, &mut outputs)?;
        }
        ExportFormat::Matlab
        | ExportFormat::Python
        | ExportFormat::C
        | ExportFormat::TableCsv
        | ExportFormat::TableMat => remarks = add_schedule(analysis, source, request, path, &mut outputs)?,
    }
    outputs.persist()?;
    Ok(remarks)
}

/// Adds the scheduled correction as a program or a table, and gives what is to be known of it.
fn add_schedule(
    analysis: &Analysis,
    source: &ExportSource,
    request: &ExportRequest,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<Vec<String>, FileError> {
    let fault = |fault| FileError::export(path, fault);
    let schedule = analysis.schedule.as_ref().map_err(|error| fault(ExportFault::Schedule(*error)))?;
    let correction = ScheduledCorrection::of(schedule, &analysis.study.dataset, source);
    let points = request.breakpoints_kt.clone().unwrap_or_else(|| distinct_airspeeds(schedule));
    let mut remarks = correction.notes.clone();
    if matches!(request.format, ExportFormat::TableCsv | ExportFormat::TableMat) {
        remarks.extend(table_remarks(&correction, &points).map_err(fault)?);
    }
    let text = match request.format {
        ExportFormat::TableMat => {
            let variable = table_variable(&correction, &points).map_err(fault)?;
            add_variables(&[variable], mat::write, path, outputs)?;
            return Ok(remarks);
        }
        ExportFormat::Matlab => matlab_function(&correction, &stem(path)),
        ExportFormat::Python => python_module(&correction),
        ExportFormat::C => c_header(&correction),
        _ => table_csv(&correction, &points),
    };
    let text = text.map_err(fault)?;
    outputs.add(path, |file| file.write_all(text.as_bytes()))?;
    Ok(remarks)
}

fn add_exported_models(
    models: &[ExportedModel],
    analysis: &Analysis,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let dataset = &analysis.study.dataset;
    match models_format(path).map_err(|fault| FileError::export(path, fault))? {
        // Packed: the matrices of delayed models are mostly zeros.
        ModelsFormat::Mat => add_variables(&[models_variable(models, dataset)], mat::write_packed, path, outputs),
        ModelsFormat::Npz => add_variables(&model_arrays(models, dataset), write_npz, path, outputs),
        ModelsFormat::Json => add_models(&found_models(models, dataset), path, outputs),
    }
}

fn add_variables(
    variables: &[Variable],
    bytes: fn(&[Variable]) -> Result<Vec<u8>, VariableFault>,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let bytes = bytes(variables).map_err(|fault| FileError::Variables { path: path.to_owned(), fault })?;
    outputs.add(path, |file| file.write_all(&bytes))
}

/// How far the table lies from the curves at most, of those that it does not hold exactly.
fn table_remarks(correction: &ScheduledCorrection, points: &[f64]) -> Result<Vec<String>, ExportFault> {
    let table = BreakpointTable::of(correction, points)?;
    let columns = table.columns.iter().filter(|column| column.error.error > 0.0);
    Ok(columns
        .map(|column| format!("table of the {}: off by up to {}", column.of.words(), column.error_words()))
        .collect())
}

/// The distinct airspeeds of the scheduled conditions \[kt\], rising.
fn distinct_airspeeds(schedule: &Schedule) -> Vec<f64> {
    let mut airspeeds = schedule.airspeeds.values_kt.clone();
    airspeeds.sort_by(f64::total_cmp);
    airspeeds.dedup();
    airspeeds
}

fn models_format(path: &Path) -> Result<ModelsFormat, ExportFault> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
    match extension.as_str() {
        "mat" => Ok(ModelsFormat::Mat),
        "json" => Ok(ModelsFormat::Json),
        "npz" => Ok(ModelsFormat::Npz),
        _ => Err(ExportFault::ModelsFormat),
    }
}

/// The name of a file without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
