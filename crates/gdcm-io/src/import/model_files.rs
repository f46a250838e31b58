//! Reads models from files in any format, and from folders.
//!
//! Models among variables are *recognised* by the names of their fields (`recognise`); a matrix
//! that is alone in its file is *loose*, and set aside until all files are read (`loose_matrices`);
//! a table of columns is read as frequency responses (`response_tables`).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gdcm_model::assembly::{FoundModel, Headings};
use gdcm_model::dataset::model::Provenance;

use super::dataset_models::models_of_dataset;
use super::loose_matrices::{
    FileIdentity, FileVariables, LooseMatrix, MATRIX_LETTERS, matrix_letter, models_of_matrices,
};
use super::recognise::{Found, recognise};
use super::response_tables::models_of_table;
use crate::file_error::FileError;
use crate::formats::reading_note::{ReadingNote, note_texts};
use crate::formats::text::{
    TextTable, UnitNotGiven, read_matrices, read_matrix, read_table, split_complex,
};
use crate::formats::variables::{PageIndex, Variable};
use crate::formats::{
    Contents, FolderProgress, ImportedFile, import, import_bytes, with_file_name,
};
use crate::import::recognise::recognition_fault::fault_messages;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Key in [`Headings`] for all tables with as many columns as there are headings; any other key is
/// a file.
pub const EVERY_TABLE: &str = "*";
/// Number of lines at the start of a text that are searched for a named matrix.
const HEADING_LINES: usize = 50;
/// Maximum number of unused variables listed for each file.
const MOST_LISTED: usize = 20;

/// Results of reading model files.
#[derive(Clone, Debug, Default)]
pub struct FoundModels {
    /// Models in file order; those whose matrices are in separate files come last.
    pub models: Vec<FoundModel>,
    /// Files that could not be read and invalid models, each with its place and the reason.
    pub faults: Vec<String>,
    /// Descriptions of contents that are not models.
    pub ignored: Vec<String>,
    /// Variables that no model uses, by file.
    pub unused: BTreeMap<String, Vec<String>>,
    /// Tables of columns, by file, with the headings that were used.
    pub tables: Headings,
    /// Missing units without which a table cannot be read as a frequency response, by file.
    pub missing_units: BTreeMap<String, Vec<UnitNotGiven>>,
    pub files: usize,
}

impl FoundModels {
    /// Returns a line for each file that has unused variables.
    pub fn unused_variable_lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for (file, names) in &self.unused {
            let mut listed: Vec<String> = names.iter().take(MOST_LISTED).cloned().collect();
            if names.len() > MOST_LISTED {
                listed.push(format!("and {} more", names.len() - MOST_LISTED));
            }
            lines.push(format!(
                "{file}: variables that no model uses: {}",
                listed.join(", ")
            ));
        }
        lines
    }
}

/// Reads the models in files, folders and subfolders; `headings` replace the column headings of
/// tables. A file that cannot be read is recorded in `faults`, and the others are read.
///
/// # Errors
/// [`FileError`] if a folder cannot be read, or if the only file cannot be read: then there are no
/// other models that the error would withhold.
pub fn read_models(
    paths: &[PathBuf],
    headings: &Headings,
    progress: &dyn FolderProgress,
) -> Result<FoundModels, FileError> {
    let mut reading = ModelReading::new(headings);
    let (files, mut faults) = import(paths, progress, |file, budget| {
        reading.add_file(file, budget)
    })?;
    let mut result = reading.finish();
    faults.append(&mut result.faults);
    Ok(FoundModels {
        files,
        faults,
        ..result
    })
}

/// Reads the models in a file whose bytes are in memory.
///
/// # Errors
/// [`FileError`] if the file cannot be read. Invalid models are recorded in `faults`.
pub fn models_of_bytes(
    bytes: &[u8],
    name: &str,
    budget: &ReadingBudget<'_>,
) -> Result<FoundModels, FileError> {
    let headings = Headings::new();
    let mut reading = ModelReading::new(&headings);
    reading.add_file(import_bytes(bytes, Path::new(name), name, budget)?, budget)?;
    Ok(FoundModels {
        files: 1,
        ..reading.finish()
    })
}

/// State while model files are read.
struct ModelReading<'h> {
    headings: &'h Headings,
    /// Results of the files read so far.
    result: FoundModels,
    /// Matrices in separate files, from which models are built at the end.
    matrices: Vec<LooseMatrix>,
}

impl<'h> ModelReading<'h> {
    fn new(headings: &'h Headings) -> Self {
        Self {
            headings,
            result: FoundModels::default(),
            matrices: Vec::new(),
        }
    }

    /// Adds the models in a file, by its contents:
    ///
    /// | contents | models |
    /// |---|---|
    /// | variables | recognised; a single matrix may be set aside as a [`LooseMatrix`] |
    /// | text | matrices like variables; a table as frequency responses |
    /// | dataset, models of this program | taken as they are |
    /// | log | none: the file is ignored |
    /// | archive | each file by itself; its NumPy arrays together, like variables |
    ///
    /// # Errors
    /// [`FileError`] if variables or a text cannot be read within the budget, a text has no
    /// readable matrix or table, or the reading is cancelled. Invalid models are recorded in
    /// `faults`.
    fn add_file(
        &mut self,
        file: ImportedFile<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), FileError> {
        let ImportedFile {
            path,
            name,
            sha256,
            contents,
        } = file;
        let identity = FileIdentity {
            path,
            name,
            sha256: &sha256,
        };
        let error = |fault| FileError::variables(path, fault);
        let in_file = match contents {
            Contents::Variables {
                variables,
                notes,
                page_index,
            } => {
                let read = FileVariables {
                    variables: &variables,
                    notes: &notes,
                    page_index,
                };
                self.recognise_or_set_aside(read, identity, budget)
                    .map_err(error)?
            }
            Contents::Text(text) => {
                let contents = read_text(&text, path, budget).map_err(error)?;
                self.models_of_text(contents, identity, budget)
                    .map_err(error)?
            }
            Contents::Dataset(dataset, unknown) => Found {
                items: models_of_dataset(&dataset, name),
                unused: unknown.iter().map(ToString::to_string).collect(),
                ..Found::default()
            },
            Contents::Logs(_) => Found {
                ignored: vec![format!("{name}: an aircraft log holds records, not models")],
                ..Found::default()
            },
            Contents::Models(models, unknown) => Found {
                items: models,
                unused: unknown.iter().map(ToString::to_string).collect(),
                ..Found::default()
            },
            Contents::Archive {
                variables,
                files,
                ignored,
            } => {
                for (inner, contents) in files {
                    self.add_archived_file(identity, &inner, contents, budget)?;
                }
                self.result.ignored.extend(with_file_name(name, ignored));
                let read = FileVariables {
                    variables: &variables,
                    notes: &[],
                    page_index: PageIndex::First,
                };
                self.recognise_or_set_aside(read, identity, budget)
                    .map_err(error)?
            }
        };
        self.add_found(in_file, identity);
        Ok(())
    }

    /// Adds the models in an archived file. A file that cannot be read is recorded in `faults`.
    ///
    /// # Errors
    /// Only a cancellation.
    fn add_archived_file(
        &mut self,
        archive: FileIdentity<'_>,
        inner: &str,
        contents: Result<Contents, FileError>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), FileError> {
        let name = format!("{}/{inner}", archive.name);
        let added = match contents {
            Ok(contents) => {
                let file = ImportedFile {
                    path: Path::new(inner),
                    name: &name,
                    sha256: archive.sha256.to_owned(),
                    contents,
                };
                self.add_file(file, budget)
            }
            Err(error) => Err(error),
        };
        match added {
            Err(stopped) if stopped.is_stopped() => Err(stopped),
            Err(error) => {
                self.result
                    .faults
                    .push(format!("{}: {error}", archive.name));
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    /// Recognises the models among a file's variables. A [`LooseMatrix`] is set aside, with its
    /// notes, until all files have been read; then the file by itself has no models.
    fn recognise_or_set_aside(
        &mut self,
        read: FileVariables<'_>,
        identity: FileIdentity<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Found<FoundModel>, VariableFault> {
        if let Some(matrix) = LooseMatrix::from_variables(read, identity) {
            self.matrices.push(matrix);
            return Ok(Found::default());
        }
        let mut recognised = recognise(read.variables, read.page_index, budget)?;
        for model in &mut recognised.items {
            model.notes.extend(note_texts(read.notes));
        }
        Ok(recognised)
    }

    /// Finds the models in a text: matrices like a file's variables, or a table of frequency
    /// responses.
    fn models_of_text(
        &mut self,
        contents: TextContents,
        identity: FileIdentity<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Found<FoundModel>, VariableFault> {
        match contents {
            TextContents::Variables { variables, notes } => {
                let read = FileVariables {
                    variables: &variables,
                    notes: &notes,
                    // Without effect: matrices in a text have two dimensions.
                    page_index: PageIndex::Last,
                };
                self.recognise_or_set_aside(read, identity, budget)
            }
            TextContents::Table(table) => self.read_table(table, identity.name),
        }
    }

    /// Reads the frequency responses in a table. Its headings are those given for this file; else
    /// those given for every table, if they are as many as the columns; else its own.
    fn read_table(
        &mut self,
        mut table: TextTable,
        name: &str,
    ) -> Result<Found<FoundModel>, VariableFault> {
        let for_every_table = self
            .headings
            .get(EVERY_TABLE)
            .filter(|headings| headings.len() == table.columns.len());
        if let Some(headings) = self.headings.get(name).or(for_every_table) {
            table = table.with_headings(headings)?;
        }
        let models = models_of_table(&table, name)?;
        if !models.missing_units.is_empty() {
            self.result
                .missing_units
                .insert(name.to_owned(), models.missing_units);
        }
        self.result.tables.insert(name.to_owned(), table.headings());
        Ok(models.found)
    }

    /// Adds a file's models with their provenance. Only the first lists the unused variables: they
    /// are a property of the file, and would otherwise be repeated for each model.
    fn add_found(&mut self, mut in_file: Found<FoundModel>, identity: FileIdentity<'_>) {
        let FileIdentity { name, sha256, .. } = identity;
        for (index, model) in in_file.items.iter_mut().enumerate() {
            let source = model.draft.source.get_or_insert_with(Provenance::default);
            if index == 0 {
                source.unused.clone_from(&in_file.unused);
            }
            source.file = Some(name.to_owned());
            source.sha256 = Some(sha256.to_owned());
            source.note = Some(model.notes.join("; ")).filter(|note| !note.is_empty());
        }
        self.result.models.append(&mut in_file.items);
        if !in_file.unused.is_empty() {
            self.result
                .unused
                .entry(name.to_owned())
                .or_default()
                .extend(in_file.unused);
        }
        self.result
            .faults
            .extend(with_file_name(name, fault_messages(in_file.faults)));
        self.result
            .ignored
            .extend(with_file_name(name, in_file.ignored));
    }

    /// Builds the models whose matrices are in separate files, and returns all models.
    fn finish(mut self) -> FoundModels {
        let separate = models_of_matrices(self.matrices);
        self.result.models.extend(separate.items);
        self.result.faults.extend(fault_messages(separate.faults));
        self.result
    }
}

/// Contents of a text file that is searched for models.
enum TextContents {
    Variables {
        variables: Vec<Variable>,
        notes: Vec<ReadingNote>,
    },
    Table(TextTable),
}

/// Reads the contents of a text:
///
/// 1. a single matrix, if the file name ends in a matrix letter;
/// 2. else named matrices, if one is headed in the first lines and all can be read;
/// 3. else a table; complex numbers are split into two columns first.
///
/// # Errors
/// [`VariableFault`] if the text cannot be read in the first form that applies. Step 1 does not
/// fall back on step 2: in a file `A.txt`, a second headed matrix is an error.
fn read_text(
    text: &str,
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<TextContents, VariableFault> {
    let stem = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default();
    // Step 1
    if let Some((letter, _)) = matrix_letter(stem) {
        let variable = read_matrix(text, &letter.to_string(), budget)?;
        return Ok(TextContents::Variables {
            variables: vec![variable],
            notes: Vec::new(),
        });
    }
    // Step 2
    if text.lines().take(HEADING_LINES).any(is_matrix_heading)
        && let Ok(matrices) = read_matrices(text, budget)
    {
        return Ok(TextContents::Variables {
            variables: matrices.variables,
            notes: matrices.notes,
        });
    }
    // Step 3
    let split = split_complex(text, budget)?;
    let table = read_table(split.as_deref().unwrap_or(text), budget)?;
    Ok(TextContents::Table(table))
}

/// Returns whether a line is a matrix heading, such as "A =", "B:" or "C=[".
fn is_matrix_heading(line: &str) -> bool {
    let name = line.trim().trim_end_matches(['=', ':', '[']).trim_end();
    MATRIX_LETTERS
        .iter()
        .any(|letter| name.strip_prefix(*letter) == Some(""))
}

#[cfg(test)]
mod tests {
    use super::is_matrix_heading;

    #[test]
    fn a_heading_names_a_matrix_of_a_model() {
        for line in ["A =", " B:", "C=[", "D", "E ="] {
            assert!(is_matrix_heading(line), "{line}");
        }
        for line in ["", "F =", "AB =", "A, B", "A = 1"] {
            assert!(!is_matrix_heading(line), "{line}");
        }
    }
}
