//! The attributes with which MATLAB says what a group or dataset is.

use std::collections::HashMap;

use hdf5_pure::AttrValue;

/// How the value of `MATLAB_object_decode` calls a function handle.
const FUNCTION_HANDLE: u64 = 1;
/// An object of a class made with `@` folders, stored as a struct.
const OLD_OBJECT: u64 = 2;
/// An object of a class made with `classdef`, stored as a reference.
const OBJECT: u64 = 3;

/// What stands for a value, by its attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decode {
    Plain,
    FunctionHandle,
    OldObject,
    Object,
}

/// MATLAB's attributes of a group or dataset.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MatlabAttributes {
    /// Name of the class (`MATLAB_class`); none for what MATLAB did not write.
    pub(super) class: Option<String>,
    /// The dataset holds the shape of an array without elements (`MATLAB_empty`).
    pub(super) empty: bool,
    /// Number of rows of a sparse matrix (`MATLAB_sparse`).
    pub(super) sparse: Option<u64>,
    /// Names of a struct's fields in their order (`MATLAB_fields`).
    pub(super) fields: Vec<String>,
    pub(super) decode: Decode,
}

impl MatlabAttributes {
    pub(super) fn new(attributes: &HashMap<String, AttrValue>) -> Self {
        let number = |name| attributes.get(name).and_then(AttrValue::as_u64);
        let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str);
        let fields = attributes.get("MATLAB_fields").and_then(AttrValue::as_strings);
        Self {
            class: class.map(str::to_owned),
            empty: number("MATLAB_empty").is_some_and(|empty| empty != 0),
            sparse: number("MATLAB_sparse"),
            fields: fields.unwrap_or_default().to_vec(),
            decode: match number("MATLAB_object_decode") {
                Some(FUNCTION_HANDLE) => Decode::FunctionHandle,
                Some(OLD_OBJECT) => Decode::OldObject,
                Some(OBJECT) => Decode::Object,
                _ => Decode::Plain,
            },
        }
    }

    /// The class, or nothing.
    pub(super) fn class(&self) -> &str {
        self.class.as_deref().unwrap_or_default()
    }
}
