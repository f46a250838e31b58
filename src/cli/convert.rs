//! `gdcm convert`: models in any supported format as JSON.

use gdcm_io::files::model_collection::add_models;
use gdcm_io::output_set::OutputSet;
use gdcm_model::assembly::FoundModel;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::number_format::counted;

use super::existing;
use super::failure::Failure;
use super::found_models::{found_models, given_headings};
use super::model_arguments::ConvertArguments;
use super::terminal::print;

/// Writes all models in the given files into one JSON file.
pub(super) fn convert(arguments: &ConvertArguments) -> Result<(), Failure> {
    let mut outputs = OutputSet::new(existing(arguments.force), arguments.files.clone());
    outputs.check(&[&arguments.out])?;
    let found = found_models(&arguments.files, &given_headings(&arguments.headings))?;
    if found.models.is_empty() {
        return Err(Failure::nothing_in(&arguments.files, "model"));
    }
    let models: Vec<FoundModel> = found
        .models
        .into_iter()
        .map(FoundModel::with_names_of_file)
        .collect();
    add_models(&models, &arguments.out, &mut outputs)?;
    outputs.persist()?;
    let mut text = String::new();
    for model in &models {
        text += &format!("{}: {}\n", sanitized(&model.key()), model.words());
    }
    text += &format!(
        "{}: {}\n",
        sanitized_path(&arguments.out),
        counted(models.len(), "model")
    );
    print(&text)
}
