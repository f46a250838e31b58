//! Labels of the columns in a field: names, units, and whether they are inputs or outputs, from the
//! fields beside it.
//!
//! A [`Record`] is a group of fields, such as a struct, that may hold a flight record; it marks the
//! fields that are used. Names of fields are compared *folded*: without case, marks and blanks.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::folded_name;
use gdcm_sysid::records::RecordColumn;

use super::samples::named_columns;
use crate::import::recognise::labels::label_of;
use crate::import::recognise::record::Record;
use crate::import::recognise::values::texts_of;

/// Fields that hold the inputs, by folded name, as in all lists below.
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
/// Fields that hold the outputs.
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
/// Fields that list column names for a matrix that holds neither inputs nor outputs.
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
/// Fields that list column units for a matrix that holds neither inputs nor outputs.
const UNITS: [&str; 3] = ["units", "columnunits", "channelunits"];

/// Labels of the columns in a field.
pub(super) struct ColumnLabels {
    names: Option<Vec<String>>,
    units: Option<Vec<String>>,
    side: Option<ChannelSide>,
}

impl ColumnLabels {
    /// Finds the labels for a field with `count` columns, names and units separately:
    ///
    /// 1. in lists named after the field (`u_names`, `u_units`);
    /// 2. else, for inputs or outputs, in the lists for all inputs or all outputs;
    /// 3. else, for any other matrix, in the record's lists; a vector has none but its own.
    ///
    /// Lists with another length, and lists with an empty name, are ignored.
    pub(super) fn find(record: &Record<'_>, field: &str, count: usize) -> Self {
        let name = folded_name(field);
        let side = side_of(&name, count);
        let shared = match side {
            Some(ChannelSide::Input) => Some(SharedLists {
                names: &INPUT_NAMES,
                units: &INPUT_UNITS,
            }),
            Some(ChannelSide::Output) => Some(SharedLists {
                names: &OUTPUT_NAMES,
                units: &OUTPUT_UNITS,
            }),
            None if count > 1 => Some(SharedLists {
                names: &NAMES,
                units: &UNITS,
            }),
            None => None,
        };
        // Step 1.
        let own_names = [
            format!("{name}names"),
            format!("{name}labels"),
            format!("{name}channels"),
        ];
        let own_units = [format!("{name}units")];
        let mut names = list_beside(record, &own_names, count);
        let mut units = list_beside(record, &own_units, count);
        // Steps 2 and 3.
        if let Some(shared) = shared {
            names = names.or_else(|| list_beside(record, shared.names, count));
            units = units.or_else(|| list_beside(record, shared.units, count));
        }
        Self {
            names: names.filter(|names| names.iter().all(|name| !name.is_empty())),
            units,
            side,
        }
    }

    pub(super) fn has_names(&self) -> bool {
        self.names.is_some()
    }

    /// Creates a field's columns and labels them. A unit from a list of units has precedence over
    /// the unit in a name, such as "P [deg/s]".
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

/// Names of fields whose lists apply to several matrices in a record.
struct SharedLists {
    names: &'static [&'static str],
    units: &'static [&'static str],
}

/// Returns the side to which a field belongs, by its folded name and column count; `None` if it is
/// neither inputs nor outputs. A single column called u may be a velocity component instead of an
/// input.
fn side_of(name: &str, count: usize) -> Option<ChannelSide> {
    if count <= 1 && name.len() <= 1 {
        return None;
    }
    if INPUTS.contains(&name) {
        Some(ChannelSide::Input)
    } else if OUTPUTS.contains(&name) {
        Some(ChannelSide::Output)
    } else {
        None
    }
}

/// Returns the strings in the first field with one of these folded names; `None` unless there are
/// `count`.
fn list_beside<N: AsRef<str>>(
    record: &Record<'_>,
    names: &[N],
    count: usize,
) -> Option<Vec<String>> {
    let field = record.fields().find(|field| {
        let folded = folded_name(field.name);
        names.iter().any(|name| name.as_ref() == folded)
    })?;
    let texts = texts_of(field.value)?;
    if texts.len() == count {
        Some(texts)
    } else {
        None
    }
}
