//! Attributes that MATLAB writes for groups and datasets.

use std::collections::HashMap;

use hdf5_pure::{AttrValue, Error};

use crate::formats::mat73::library_fault::library_fault;
use crate::reading_budget::VariableFault;

/// `MATLAB_object_decode` value for a function handle.
pub(super) const FUNCTION_HANDLE: u64 = 1;
/// `MATLAB_object_decode` value for an object of an old-style (`@` folder) class, stored as a
/// struct.
pub(super) const FOLDER_OBJECT: u64 = 2;
/// `MATLAB_object_decode` value for a `classdef` object, stored as a reference.
pub(super) const OBJECT: u64 = 3;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct MatlabAttributes {
    /// Class name (`MATLAB_class`); `None` for values from other programs, and for the references
    /// in MATLAB's struct arrays.
    pub(super) class: Option<String>,
    /// Whether the array is empty (`MATLAB_empty`, `OCTAVE_EMPTY_MATRIX`). A dataset then holds its
    /// shape. Octave instead marks the group, whose members may hold shapes.
    pub(super) is_empty: bool,
    /// Number of rows of a sparse matrix (`MATLAB_sparse`).
    pub(super) sparse_height: Option<u64>,
    /// A struct's field names, in order (`MATLAB_fields`).
    pub(super) fields: Vec<String>,
    /// Encoding (`MATLAB_object_decode`); 0 for a plain value.
    pub(super) encoding: u64,
}

impl MatlabAttributes {
    /// Reads MATLAB's attributes; `path` is the variable name in errors.
    pub(super) fn read(
        attributes: Result<HashMap<String, AttrValue>, Error>,
        path: &str,
    ) -> Result<Self, VariableFault> {
        let attributes = attributes.map_err(|error| library_fault(&error, path))?;
        let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str);
        let fields = attributes
            .get("MATLAB_fields")
            .and_then(AttrValue::as_strings);
        let is_empty = match integer(&attributes, "MATLAB_empty") {
            Some(empty) if empty != 0 => true,
            _ => attributes.contains_key("OCTAVE_EMPTY_MATRIX"),
        };
        Ok(Self {
            class: class.map(str::to_owned),
            is_empty,
            sparse_height: integer(&attributes, "MATLAB_sparse"),
            fields: fields.unwrap_or_default().to_vec(),
            encoding: integer(&attributes, "MATLAB_object_decode").unwrap_or(0),
        })
    }

    /// Returns the class name; empty if there is none.
    pub(super) fn class_name(&self) -> &str {
        self.class.as_deref().unwrap_or_default()
    }
}

fn integer(attributes: &HashMap<String, AttrValue>, name: &str) -> Option<u64> {
    attributes.get(name).and_then(AttrValue::as_u64)
}
