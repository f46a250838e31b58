//! Labels of the columns in a field: names, units, and whether they are inputs or outputs, from the
//! fields beside it.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::folded_name;
use gdcm_sysid::records::RecordColumn;

use super::samples::named_columns;
use crate::import::recognise::labels::label_of;
use crate::import::recognise::record::Record;
use crate::import::recognise::values::texts_of;

/// Names of fields that hold the inputs, without case and underscores.
const INPUTS: [&str; 9] = [
    "u",
    "in",
    "inr",
    "input",
    "inputs",
    "udata",
    "inputdata",
    "controls",
    "uin",
];
/// Names of fields that hold the outputs, without case and underscores.
const OUTPUTS: [&str; 9] = [
    "y",
    "out",
    "outr",
    "output",
    "outputs",
    "ydata",
    "outputdata",
    "sensors",
    "yout",
];
const INPUT_NAMES: [&str; 6] = [
    "inputname",
    "inputnames",
    "inname",
    "unames",
    "inputlabels",
    "controlnames",
];
const OUTPUT_NAMES: [&str; 6] = [
    "outputname",
    "outputnames",
    "outname",
    "ynames",
    "outputlabels",
    "sensornames",
];
const INPUT_UNITS: [&str; 4] = ["inputunit", "inputunits", "inunit", "uunits"];
const OUTPUT_UNITS: [&str; 4] = ["outputunit", "outputunits", "outunit", "yunits"];
/// Names of fields that list the column names if a record has a single matrix.
const NAMES: [&str; 10] = [
    "names",
    "channels",
    "columns",
    "labels",
    "variables",
    "header",
    "columnnames",
    "channelnames",
    "colheaders",
    "varlab",
];
/// Names of fields that list the column units if a record has a single matrix.
const UNITS: [&str; 3] = ["units", "columnunits", "channelunits"];

/// Labels of the columns in a field.
pub(super) struct ColumnLabels {
    names: Option<Vec<String>>,
    units: Option<Vec<String>>,
    side: Option<ChannelSide>,
}

impl ColumnLabels {
    /// Finds the labels of a field with `count` columns, first in lists named after the field
    /// (`u_names`), then in lists of all inputs or all outputs, then in lists of the whole record.
    /// Lists with another length are ignored.
    pub(super) fn find(record: &Record<'_>, field: &str, count: usize) -> Self {
        let name = folded_name(field);
        // A single column called u may be a velocity component instead of an input.
        let may_be_side = count > 1 || name.len() > 1;
        let (side, names, units) = if may_be_side && INPUTS.contains(&name.as_str()) {
            (
                Some(ChannelSide::Input),
                list_beside(record, &INPUT_NAMES, count),
                list_beside(record, &INPUT_UNITS, count),
            )
        } else if may_be_side && OUTPUTS.contains(&name.as_str()) {
            (
                Some(ChannelSide::Output),
                list_beside(record, &OUTPUT_NAMES, count),
                list_beside(record, &OUTPUT_UNITS, count),
            )
        } else if count > 1 {
            (
                None,
                list_beside(record, &NAMES, count),
                list_beside(record, &UNITS, count),
            )
        } else {
            (None, None, None)
        };
        let own_names = [
            format!("{name}names"),
            format!("{name}labels"),
            format!("{name}channels"),
        ];
        let own_units = [format!("{name}units")];
        let names = list_beside(record, &own_names, count).or(names);
        Self {
            names: names.filter(|names| names.iter().all(|name| !name.is_empty())),
            units: list_beside(record, &own_units, count).or(units),
            side,
        }
    }

    /// Returns whether the file gives names of the columns.
    pub(super) fn has_names(&self) -> bool {
        self.names.is_some()
    }

    /// Creates the columns of a field and applies the labels to them.
    pub(super) fn label(self, field: &str, values: Vec<Vec<f64>>) -> Vec<RecordColumn> {
        let mut columns = named_columns(field, values);
        for (index, column) in columns.iter_mut().enumerate() {
            column.side = self.side;
            if let Some(names) = &self.names {
                let label = label_of(&names[index]);
                if let Some(name) = label.name {
                    column.name = name;
                }
                column.unit = label.unit;
            }
            if let Some(units) = &self.units
                && !units[index].is_empty()
            {
                column.unit = Some(units[index].clone());
            }
        }
        columns
    }
}

/// Returns the strings in the first field with one of these names (without case and underscores);
/// `None` unless there are `count`.
fn list_beside<K: AsRef<str>>(
    record: &Record<'_>,
    keys: &[K],
    count: usize,
) -> Option<Vec<String>> {
    let field = record.fields().find(|field| {
        let folded = folded_name(field.name);
        keys.iter().any(|key| key.as_ref() == folded)
    })?;
    let texts = texts_of(field.value)?;
    if texts.len() == count {
        Some(texts)
    } else {
        None
    }
}
