//! Models in files of any format, and in folders.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::assembly::{ChannelLabel, FoundModel, Headings};
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::unchecked_dataset::{ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::dataset::{BundleKind, Condition, Dataset, Model};

use super::recognise::{Found, recognise};
use crate::file_error::FileError;
use crate::files::model_collection::{bare_draft, labels};
use crate::formats::text::{
    FrequencyColumns, RecognisedResponse, ResponsePoints, TextTable, Unrecognised, UnsaidUnit,
    read_matrices, read_matrix, read_table, split_complex,
};
use crate::formats::variables::{Value, Variable};
use crate::formats::{Contents, FolderProgress, ImportedFile, import, import_bytes, of_file};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Key for the headings of every table with the same number of columns, among the keys of single
/// files.
pub const EVERY_TABLE: &str = "*";

/// Models found in files.
#[derive(Clone, Debug, Default)]
pub struct FoundModels {
    /// In the order of their files.
    pub models: Vec<FoundModel>,
    /// Files, and apparent models in them, that could not be read, each with its place and the
    /// reason.
    pub faults: Vec<String>,
    /// Contents that are not models, in words.
    pub ignored: Vec<String>,
    /// The unused variables, by the file that contains them beside models.
    pub unused: BTreeMap<String, Vec<String>>,
    /// The tables of columns among the files, with the headings used.
    pub tables: Headings,
    /// The units needed before these tables are frequency responses.
    pub unsaid: BTreeMap<String, Vec<UnsaidUnit>>,
    /// Number of files read.
    pub files: usize,
}

impl FoundModels {
    /// Returns one line for each file with unused variables.
    pub fn unused_words(&self) -> Vec<String> {
        /// Maximum number of names listed per file.
        const NAMED: usize = 20;
        let words = |(file, names): (&String, &Vec<String>)| {
            let rest = names.len().saturating_sub(NAMED);
            let more = (rest > 0).then(|| format!("and {rest} more"));
            let names: Vec<String> = names.iter().take(NAMED).cloned().chain(more).collect();
            format!("{file}: not used: {}", names.join(", "))
        };
        self.unused.iter().map(words).collect()
    }
}

/// Reads the models in files and folders, including all subfolders; tables of columns by the given
/// headings. A file that cannot be read is a fault, and the rest is read.
pub fn read_models(
    paths: &[PathBuf],
    headings: &Headings,
    progress: &dyn FolderProgress,
) -> Result<FoundModels, FileError> {
    let mut reading = ModelReading {
        headings,
        found: FoundModels::default(),
        matrices: Vec::new(),
    };
    let (files, faults) = import(paths, progress, |file, budget| reading.take(file, budget))?;
    let mut found = reading.finish();
    found.faults = [faults, found.faults].concat();
    Ok(FoundModels { files, ..found })
}

/// Reads the models in the bytes of a file with this name, within a budget.
pub fn models_of_bytes(
    bytes: &[u8],
    name: &str,
    budget: &ReadingBudget<'_>,
) -> Result<FoundModels, FileError> {
    let none = Headings::new();
    let mut reading = ModelReading {
        headings: &none,
        found: FoundModels::default(),
        matrices: Vec::new(),
    };
    reading.take(import_bytes(bytes, Path::new(name), name, budget)?, budget)?;
    Ok(FoundModels {
        files: 1,
        ..reading.finish()
    })
}

/// Files of models being read.
struct ModelReading<'h> {
    headings: &'h Headings,
    found: FoundModels,
    /// Matrices in separate files.
    matrices: Vec<LooseMatrix>,
}

impl ModelReading<'_> {
    fn take(
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
        let wrong = |fault| FileError::variables(path, fault);
        let recognised = match contents {
            Contents::Variables {
                variables,
                notes,
                pages_first,
            } => self
                .of_variables(variables, notes, ((name, &sha256), pages_first), budget)
                .map_err(wrong)?,
            Contents::Text(text) => match models_text(&text, path, budget).map_err(wrong)? {
                TextContents::Variables { variables, notes } => self
                    .of_variables(variables, notes, ((name, &sha256), false), budget)
                    .map_err(wrong)?,
                TextContents::Table(mut table) => {
                    let of_all = self
                        .headings
                        .get(EVERY_TABLE)
                        .filter(|said| said.len() == table.columns.len());
                    if let Some(said) = self.headings.get(name).or(of_all) {
                        table = table.with_headings(said).map_err(wrong)?;
                    }
                    let (found, unsaid) = models_of_table(&table, name).map_err(wrong)?;
                    self.found
                        .unsaid
                        .extend((!unsaid.is_empty()).then(|| (name.to_owned(), unsaid)));
                    self.found.tables.insert(name.to_owned(), table.headings());
                    found
                }
            },
            Contents::Dataset(dataset, unknown) => Found {
                items: models_of_dataset(&dataset, name),
                unused: unknown,
                ..Found::default()
            },
            Contents::Logs(_) => Found {
                ignored: vec![format!(
                    "{name}: a log of an aircraft: records, not a model"
                )],
                ..Found::default()
            },
            Contents::Models(models, unknown) => Found {
                items: models,
                unused: unknown,
                ..Found::default()
            },
            Contents::Archive {
                variables,
                files,
                ignored,
            } => {
                for (inner, contents) in files {
                    let inner_name = format!("{name}/{inner}");
                    let inner_path = Path::new(&inner);
                    let taken = contents.and_then(|contents| {
                        let sha256 = sha256.clone();
                        self.take(
                            ImportedFile {
                                path: inner_path,
                                name: &inner_name,
                                sha256,
                                contents,
                            },
                            budget,
                        )
                    });
                    match taken {
                        Err(stopped) if stopped.is_stopped() => return Err(stopped),
                        taken => self
                            .found
                            .faults
                            .extend(taken.err().map(|error| format!("{name}: {error}"))),
                    }
                }
                self.found.ignored.extend(of_file(name, ignored));
                // Its arrays are NumPy arrays: pages come first.
                self.of_variables(variables, Vec::new(), ((name, &sha256), true), budget)
                    .map_err(wrong)?
            }
        };
        let Found {
            mut items,
            faults,
            ignored,
            unused,
        } = recognised;
        for (index, model) in items.iter_mut().enumerate() {
            let source = model.draft.source.get_or_insert_with(Provenance::default);
            if index == 0 {
                source.unused.clone_from(&unused);
            }
            source.file = Some(name.to_owned());
            source.sha256 = Some(sha256.clone());
            source.note = Some(model.notes.join("; ")).filter(|note| !note.is_empty());
        }
        self.found.models.append(&mut items);
        if !unused.is_empty() {
            self.found
                .unused
                .entry(name.to_owned())
                .or_default()
                .extend(unused);
        }
        self.found.faults.extend(of_file(name, faults));
        self.found.ignored.extend(of_file(name, ignored));
        Ok(())
    }

    fn of_variables(
        &mut self,
        variables: Vec<Variable>,
        notes: Vec<String>,
        ((name, sha256), pages_first): ((&str, &str), bool),
        budget: &ReadingBudget<'_>,
    ) -> Result<Found<FoundModel>, VariableFault> {
        if let Some(matrix) = LooseMatrix::of(&variables, name) {
            self.matrices.push(LooseMatrix {
                sha256: sha256.to_owned(),
                ..matrix
            });
            return Ok(Found::default());
        }
        let mut found = recognise(&variables, pages_first, budget)?;
        for model in &mut found.items {
            model.notes.extend(notes.iter().cloned());
        }
        Ok(found)
    }

    fn finish(mut self) -> FoundModels {
        let of_matrices = models_of_matrices(self.matrices);
        self.found.models.extend(of_matrices.items);
        self.found.faults.extend(of_matrices.faults);
        self.found
    }
}

/// Contents of a text in the search for models.
enum TextContents {
    Variables {
        variables: Vec<Variable>,
        notes: Vec<String>,
    },
    Table(TextTable),
}

/// Reads a matrix if the file is named as one, named matrices if there are some, otherwise a table.
fn models_text(
    text: &str,
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<TextContents, VariableFault> {
    if let Some((letter, _)) = matrix_letter(stem(path)) {
        let variable = read_matrix(text, &letter.to_string(), budget)?;
        return Ok(TextContents::Variables {
            variables: vec![variable],
            notes: Vec::new(),
        });
    }
    let looks_named = text.lines().take(50).any(|line| {
        let line = line.trim().trim_end_matches(['=', ':', '[']).trim_end();
        matches!(line, "A" | "B" | "C" | "D")
    });
    if looks_named && let Ok(matrices) = read_matrices(text, budget) {
        return Ok(TextContents::Variables {
            variables: matrices.variables,
            notes: matrices.notes,
        });
    }
    let split = split_complex(text, budget)?;
    read_table(split.as_deref().unwrap_or(text), budget).map(TextContents::Table)
}

fn stem(path: &Path) -> &str {
    path.file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default()
}

/// Returns every model, with the dataset's information on it and its condition; `name` is the name
/// of the dataset's file, relative to the requested path.
fn models_of_dataset(dataset: &Dataset, name: &str) -> Vec<FoundModel> {
    let mut models = Vec::new();
    for condition in dataset.conditions() {
        let facts = facts(condition, name);
        for kind in BundleKind::BOTH {
            let found = |model: &Model| found(dataset, facts.clone(), (condition, kind), model);
            models.extend(condition.bundle(kind).iter().map(found));
        }
    }
    models
}

/// Returns the information on the condition; the paths of its records, relative to the dataset's
/// folder, become relative to the requested path.
fn facts(condition: &Condition, name: &str) -> Facts {
    let state = condition.flight_state();
    let beside = |record: &ConditionRecord| {
        let file = match name.rsplit_once('/') {
            Some((folder, _)) if !Path::new(&record.file).is_absolute() => {
                format!("{folder}/{}", record.file)
            }
            _ => record.file.clone(),
        };
        ConditionRecord {
            file,
            ..record.clone()
        }
    };
    Facts {
        condition: Some(state.id.0),
        airspeed_kt: Some(state.airspeed_kt),
        altitude_ft: state.altitude_ft,
        mass_kg: state.mass_kg,
        name: None,
        is_of_dataset: true,
        records: condition.records().iter().map(beside).collect(),
    }
}

fn found(
    dataset: &Dataset,
    facts: Facts,
    (condition, kind): (&Condition, BundleKind),
    model: &Model,
) -> FoundModel {
    let state = condition.flight_state();
    let source = Provenance {
        variable: Some(format!("{}/{kind}/{}", state.id, model.name)),
        note: None,
        file: None,
        sha256: None,
        ..model.source.clone().unwrap_or_default()
    };
    FoundModel {
        draft: ModelDraft {
            source: Some(source),
            ..ModelDraft::from_model(model)
        },
        inputs: labels(dataset.inputs()),
        outputs: labels(dataset.outputs()),
        facts,
        notes: model
            .source
            .iter()
            .filter_map(|source| source.note.clone())
            .collect(),
    }
}

/// A matrix in a separate file.
struct LooseMatrix {
    /// The folder and the part of the name before the letter: matrices with the same group are one
    /// model.
    group: String,
    file: String,
    sha256: String,
    /// The matrix, named by its letter.
    variable: Variable,
}

/// Returns the letter of a file that is named as a matrix, and the part before it: "nominal_A" is A
/// of "nominal".
fn matrix_letter(stem: &str) -> Option<(char, &str)> {
    let letter = stem
        .chars()
        .last()
        .filter(|letter| matches!(letter, 'A' | 'B' | 'C' | 'D' | 'E'))?;
    let before = &stem[..stem.len() - 1];
    let is_apart = before.is_empty() || before.ends_with(['_', '-', '.', ' ']);
    is_apart.then(|| (letter, before.trim_end_matches(['_', '-', '.', ' '])))
}

impl LooseMatrix {
    /// Takes the only variable of a file that is named as a matrix.
    fn of(variables: &[Variable], file: &str) -> Option<Self> {
        let [variable] = variables else { return None };
        if !matches!(variable.value, Value::Array(_)) {
            return None;
        }
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let (letter, before) = matrix_letter(stem)?;
        Some(Self {
            group: [folder, before]
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join("/"),
            file: file.to_owned(),
            sha256: String::new(),
            variable: Variable {
                name: letter.to_string(),
                value: variable.value.clone(),
            },
        })
    }
}

/// Builds one model from each group of loose matrices; its file is the folder, or the part of the
/// name before the letters.
fn models_of_matrices(loose: Vec<LooseMatrix>) -> Found<FoundModel> {
    let mut groups: BTreeMap<String, Vec<LooseMatrix>> = BTreeMap::new();
    for matrix in loose {
        groups.entry(matrix.group.clone()).or_default().push(matrix);
    }
    let mut found = Found::default();
    for (group, matrices) in groups {
        let variables: Vec<Variable> = matrices
            .iter()
            .map(|matrix| matrix.variable.clone())
            .collect();
        // The files were within their budgets; their matrices are copied once.
        let mut of_group = recognise(&variables, true, &ReadingBudget::new(u64::MAX))
            .unwrap_or_else(|fault| Found {
                faults: vec![fault.to_string()],
                ..Found::default()
            });
        let is_model = !of_group.items.is_empty() || !of_group.faults.is_empty();
        for model in &mut of_group.items {
            let source = model.draft.source.get_or_insert_with(Provenance::default);
            source.file = Some(group.clone());
            let hashes = matrices
                .iter()
                .map(|matrix| format!("{} {}", matrix.file, matrix.sha256));
            source.note = Some(format!(
                "SHA-256 of its files: {}",
                hashes.collect::<Vec<_>>().join(", ")
            ));
        }
        found.items.append(&mut of_group.items);
        found.faults.extend(
            of_group
                .faults
                .into_iter()
                .map(|fault| format!("{group}: {fault}")),
        );
        if !is_model {
            let names: Vec<&str> = matrices.iter().map(|matrix| matrix.file.as_str()).collect();
            found
                .faults
                .push(format!("{}: a model needs A, B and C", names.join(", ")));
        }
    }
    found
}

// Frequency responses from tables of columns.

/// Returns the responses of a table, each a model with one input and one output; a table without
/// any is reported as ignored, with the units that would make it one.
fn models_of_table(
    table: &TextTable,
    file: &str,
) -> Result<(Found<FoundModel>, Vec<UnsaidUnit>), VariableFault> {
    let columns = match FrequencyColumns::recognise(table) {
        Ok(columns) => columns,
        Err(Unrecognised { fault, unsaid }) => {
            let words = format!(
                "{file}: {} columns of numbers; {fault}",
                table.columns.len()
            );
            return Ok((
                Found {
                    ignored: vec![words],
                    ..Found::default()
                },
                unsaid,
            ));
        }
    };
    let values = columns.values(table)?;
    let several = columns.responses.len() > 1;
    let models = columns
        .responses
        .iter()
        .zip(values)
        .map(|(response, points)| {
            let mut notes: Vec<String> =
                columns.notes.iter().chain(&table.notes).cloned().collect();
            if response.coherence.is_some() {
                notes.push("coherence taken as γ²".to_owned());
            }
            model(response, points, several, notes)
        });
    Ok((
        Found {
            items: models.collect(),
            unused: columns.unused.clone(),
            ..Found::default()
        },
        Vec::new(),
    ))
}

fn model(
    response: &RecognisedResponse,
    points: ResponsePoints,
    several: bool,
    notes: Vec<String>,
) -> FoundModel {
    let count = points.omega.len();
    let array = |values: Vec<f64>| ResponseArray {
        shape: [1, 1, count],
        values,
    };
    let output = response.output.clone();
    let input = response.input.clone();
    let variable = match (several, &output, &input) {
        (true, Some(output), Some(input)) => Some(format!("{output}/{input}")),
        (true, Some(output), None) => Some(output.clone()),
        (true, None, Some(input)) => Some(input.clone()),
        _ => None,
    };
    let label = |name: Option<String>| ChannelLabel { name, unit: None };
    let draft = ResponseDraft {
        omega: points.omega,
        re: array(points.re),
        im: array(points.im),
        // Points with missing coherence are not trusted.
        coherence: points.coherence.map(|values| {
            array(
                values
                    .iter()
                    .map(|of| if of.is_nan() { 0.0 } else { *of })
                    .collect(),
            )
        }),
        valid_bands: None,
        estimate: Estimate::default(),
    };
    FoundModel {
        draft: ModelDraft {
            response: Some(draft),
            source: Some(Provenance {
                variable: variable.clone(),
                ..Provenance::default()
            }),
            ..bare_draft(
                variable.unwrap_or_default(),
                Origin::Identified {
                    method: None,
                    order: None,
                },
            )
        },
        inputs: vec![label(input)],
        outputs: vec![label(output)],
        facts: Facts::default(),
        notes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::Array;

    fn matrix(file: &str, rows: usize, columns: usize) -> LooseMatrix {
        let value = Value::Array(Array::matrix(rows, columns, vec![-1.0; rows * columns]));
        LooseMatrix::of(
            &[Variable {
                name: "x".into(),
                value,
            }],
            file,
        )
        .unwrap()
    }

    #[test]
    fn matrices_of_a_folder_or_of_one_beginning_are_a_model() {
        let files = [
            "c1/A.csv",
            "c1/B.csv",
            "c1/C.csv",
            "c1/nom_A.csv",
            "c1/nom_B.csv",
            "c1/nom_C.csv",
            "c1/lone_A.csv",
        ];
        let found = models_of_matrices(files.iter().map(|file| matrix(file, 1, 1)).collect());
        let names: Vec<&str> = found.items.iter().map(|model| model.file()).collect();
        assert_eq!(names, ["c1", "c1/nom"]);
        assert_eq!(found.faults, ["c1/lone_A.csv: a model needs A, B and C"]);
    }

    #[test]
    fn a_word_that_ends_in_a_letter_is_no_matrix() {
        assert_eq!(matrix_letter("nominal_A"), Some(('A', "nominal")));
        assert_eq!(matrix_letter("B"), Some(('B', "")));
        assert_eq!(matrix_letter("DATA"), None);
        assert_eq!(matrix_letter("roll+5"), None);
    }
}
