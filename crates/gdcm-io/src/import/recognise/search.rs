//! Searches for models or flight records through structs, objects, cells and arrays.
//!
//! ```text
//! 1  recognise the variables of the file together               (try_record)
//! 2  for each variable: descend into its value
//!      struct, object: for each element of the array
//!          recognise it, or each page of it                     (try_pages)
//!          if it is not recognised: descend into its fields
//!      cell: descend into each entry
//!      object that its format reader could not read: a fault
//!      deeper than DEEPEST, or after MOST_FOUND results: a fault
//! 3  list the unused fields beside what was found
//! 4  list what was not recognised: without any result, all variables;
//!      otherwise the arrays, unless step 1 was successful
//! ```
//!
//! The functions that search return whether they found anything, so that a field that holds a model
//! is not listed as unused.

use std::collections::BTreeSet;
use std::rc::Rc;

use gdcm_model::dataset::limits::MOST_PIECES;

use super::recognition_fault::{FoundFault, RecognitionFault};
use super::record::Record;
use super::{DEEPEST, MOST_FOUND, STEPS};
use crate::formats::variables::{StructArray, Value, Variable};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};

/// Maximum number of variables listed as not recognised.
const MOST_LISTED: usize = 20;
/// Memory for a complex number \[bytes\].
const COMPLEX_BYTES: u64 = 16;
/// Memory charged for a listed path, in addition to its characters \[bytes\].
const PATH_BYTES: u64 = 64;
/// Memory charged for a fault, in addition to its characters \[bytes\].
const FAULT_BYTES: u64 = 128;

/// Models or records found among variables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found<T> {
    /// Models or records; their provenance names only the variable.
    pub(crate) items: Vec<T>,
    /// Errors in models or records, with their place and the reason.
    pub(crate) faults: Vec<FoundFault>,
    /// Descriptions of variables in which nothing was recognised.
    pub(crate) ignored: Vec<String>,
    /// Unused variables beside and inside the models or records.
    pub(crate) unused: Vec<String>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            faults: Vec::new(),
            ignored: Vec::new(),
            unused: Vec::new(),
        }
    }
}

impl<T> Found<T> {
    /// Adds what was read from a variable; `variable` is empty for the whole file.
    pub(super) fn add(&mut self, variable: &str, items: Vec<Result<T, RecognitionFault>>) {
        for item in items {
            match item {
                Ok(item) => self.items.push(item),
                Err(fault) => self.faults.push(FoundFault::new(variable, fault)),
            }
        }
    }

    fn has_nothing(&self) -> bool {
        self.items.is_empty() && self.faults.is_empty()
    }
}

/// Function that reads the models (or the flight records) that a record's fields form, given the
/// variable name; `None` if they form none.
pub(super) type Recognise<'r, T> =
    &'r dyn Fn(&Record<'_>, &str) -> Option<Vec<Result<T, RecognitionFault>>>;

/// Finds all models or flight records among variables: first from all variables together, then in
/// each variable and its contents, from the outside in.
pub(crate) fn search<T>(
    variables: &[Variable],
    budget: &ReadingBudget<'_>,
    recognise: Recognise<'_, T>,
) -> Result<Found<T>, VariableFault> {
    let mut search = Search {
        found: Found::default(),
        recognise,
        budget,
    };
    // Step 1.
    let whole = Rc::new(Record::from_variables(variables));
    search.try_record(&whole, "")?;
    let is_file_recognised = !search.found.has_nothing();
    let mut without_results = BTreeSet::new();
    // Step 2.
    for variable in variables {
        if !search.descend(&variable.name, &variable.value, DEEPEST, &whole)? {
            without_results.insert(variable.name.as_str());
        }
    }
    // Step 3: the variables come first; fields inside them are already listed (`note_unused`).
    let mut found = search.found;
    found
        .unused
        .splice(0..0, unused_among(&whole, &without_results));
    // Step 4. Unless the variables together form a record, the file's arrays were not recognised
    // even if other variables were.
    let is_anything_found = !found.has_nothing();
    for variable in variables {
        let is_array = matches!(variable.value, Value::Array(_));
        let is_ignored = !is_anything_found || (is_array && !is_file_recognised);
        if is_ignored && found.ignored.len() < MOST_LISTED {
            found
                .ignored
                .push(format!("{}: {}", variable.name, variable.value.words()));
        }
    }
    Ok(found)
}

/// Returns a record's unused fields. A field in which something was found is not unused;
/// `without_results` lists the fields in which nothing was found. Paths into structs are always
/// kept.
fn unused_among(record: &Record<'_>, without_results: &BTreeSet<&str>) -> Vec<String> {
    let mut unused = record.unused();
    unused.retain(|name| without_results.contains(name.as_str()) || name.contains('.'));
    unused
}

struct Search<'r, T> {
    found: Found<T>,
    recognise: Recognise<'r, T>,
    budget: &'r ReadingBudget<'r>,
}

impl<T> Search<'_, T> {
    /// Adds the models or flight records formed by a record's fields; returns whether there are
    /// any, with or without faults.
    fn try_record(&mut self, record: &Record<'_>, variable: &str) -> Result<bool, VariableFault> {
        self.budget
            .work(STEPS * record.fields().count() as u64, variable)?;
        let Some(items) = (self.recognise)(record, variable) else {
            return Ok(false);
        };
        // Take the memory for all fields, because the results contain copies of their values.
        for field in record.fields() {
            if let Value::Array(array) = field.value {
                self.budget
                    .take(array.len() as u64, COMPLEX_BYTES, variable)?;
            }
        }
        self.found.add(variable, items);
        Ok(true)
    }

    /// Searches a value and its contents, down to `levels` levels; `outer` is the record that
    /// contains the value. Returns whether anything was found; a fault counts.
    fn descend<'v>(
        &mut self,
        name: &str,
        value: &'v Value,
        levels: usize,
        outer: &Rc<Record<'v>>,
    ) -> Result<bool, VariableFault> {
        self.budget.work(STEPS, name)?;
        if levels == 0 || self.found.items.len() >= MOST_FOUND {
            self.add_fault(FoundFault::new(name, RecognitionFault::SearchLimit))?;
            return Ok(true);
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, levels, outer),
            Value::Object(object) => {
                self.descend_records(name, &object.records, Some(&object.class), levels, outer)
            }
            Value::Cell(cell) => {
                let mut is_anything_found = false;
                for (index, value) in cell.values.iter().enumerate() {
                    let name = format!("{name}{{{}}}", index + 1);
                    is_anything_found |= self.descend(&name, value, levels - 1, outer)?;
                }
                Ok(is_anything_found)
            }
            Value::Opaque { class, why } => {
                self.add_fault(FoundFault {
                    class: Some(class.clone()),
                    ..FoundFault::new(name, RecognitionFault::Unread(why.clone()))
                })?;
                Ok(true)
            }
            Value::Array(_) | Value::Text(_) => Ok(false),
        }
    }

    /// Searches each element of a struct array or object array.
    fn descend_records<'v>(
        &mut self,
        name: &str,
        records: &'v StructArray,
        class: Option<&'v str>,
        levels: usize,
        outer: &Rc<Record<'v>>,
    ) -> Result<bool, VariableFault> {
        let mut is_anything_found = false;
        let count = if records.fields.is_empty() {
            0
        } else {
            records.shape.iter().product::<usize>()
        };
        for index in 0..count {
            let name = if count == 1 {
                name.to_owned()
            } else {
                format!("{name}({})", index + 1)
            };
            if self.try_pages(&name, records, index, class, outer)? {
                is_anything_found = true;
                continue;
            }
            let inner = Rc::new(Record::from_struct(records, index).inside(outer));
            let mut without_results = BTreeSet::new();
            for field in inner.fields() {
                let path = format!("{name}.{}", field.name);
                if !self.descend(&path, field.value, levels - 1, &inner)? {
                    without_results.insert(field.name);
                }
            }
            if without_results.len() < inner.fields().count() {
                is_anything_found = true;
                self.note_unused(&name, &unused_among(&inner, &without_results))?;
            }
        }
        Ok(is_anything_found)
    }

    /// Adds the models or flight records in element `index` of a struct array, which may itself be
    /// an array of models. Returns whether there are any.
    fn try_pages<'v>(
        &mut self,
        name: &str,
        records: &'v StructArray,
        index: usize,
        class: Option<&'v str>,
        outer: &Rc<Record<'v>>,
    ) -> Result<bool, VariableFault> {
        let pages = Record::page_count(records, index);
        let mut is_anything_found = false;
        for page in 0..pages {
            let name = if pages == 1 {
                name.to_owned()
            } else {
                format!("{name}(:,:,{})", page + 1)
            };
            let record = Record::from_object(records, index, class, page).inside(outer);
            if self.try_record(&record, &name)? {
                is_anything_found = true;
                self.note_unused(&name, &record.unused())?;
            }
        }
        Ok(is_anything_found)
    }

    /// Adds the paths to a variable's unused fields.
    fn note_unused(&mut self, variable: &str, names: &[String]) -> Result<(), VariableFault> {
        for name in names {
            let path = if variable.is_empty() {
                name.clone()
            } else {
                format!("{variable}.{name}")
            };
            self.budget
                .take(path.len() as u64 + PATH_BYTES, 1, NO_VARIABLE)?;
            if self.found.unused.len() < MOST_PIECES {
                self.found.unused.push(path);
            }
        }
        Ok(())
    }

    fn add_fault(&mut self, fault: FoundFault) -> Result<(), VariableFault> {
        let length = fault.to_string().len() as u64;
        self.budget.take(length + FAULT_BYTES, 1, NO_VARIABLE)?;
        self.found.faults.push(fault);
        Ok(())
    }
}
