//! Fields under names, wherever they stand: in a struct, in an object, in a file.

use crate::variables::{StructArray, Value, Variable};

/// Parts in which objects of MATLAB and GNU Octave keep what other files have beside the rest.
const INNER_PARTS: [&str; 4] = ["data", "structure", "lti", RESPONSE_PART];
/// Where a model of this program has its measured response.
const RESPONSE_PART: &str = "frequencyresponse";
/// Deepest of these parts inside one another.
const DEEPEST_PART: usize = 3;

/// Fields that belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record<'v> {
    fields: Vec<(&'v str, &'v Value)>,
    /// The class, where it is an object.
    pub(crate) class: Option<&'v str>,
    /// Whether it is a struct or an object, and not the variables of a file.
    pub(crate) stands_alone: bool,
}

impl<'v> Record<'v> {
    /// The variables of a file.
    pub(crate) fn of_variables(variables: &'v [Variable]) -> Self {
        let fields = variables.iter().map(|variable| (variable.name.as_str(), &variable.value)).collect();
        Self { fields, class: None, stands_alone: false }
    }

    /// One record of a struct array. Of an object also what lies in its inner parts, the `page`-th where they are arrays: objects of
    /// MATLAB keep their numbers in `Data_`.
    pub(crate) fn of_struct(records: &'v StructArray, index: usize, class: Option<&'v str>, page: usize) -> Self {
        let mut fields = fields_of(records, index);
        let holds_response = fields.iter().any(|(name, _)| plain(name) == RESPONSE_PART);
        if class.is_some() || holds_response {
            add_inner(&mut fields, page, DEEPEST_PART);
        }
        Self { fields, class, stands_alone: true }
    }

    /// Number of models that an object is an array of: each has a record of numbers of its own.
    pub(crate) fn pages(records: &StructArray, index: usize) -> usize {
        let data = fields_of(records, index).into_iter().find(|(name, _)| plain(name) == "data");
        match data {
            Some((_, Value::Object(object))) => object.records.shape.iter().product(),
            _ => 1,
        }
    }

    /// The field of the first of these names that there is: as it is written, else without case and underscores.
    pub(crate) fn get(&self, names: &[&str]) -> Option<&'v Value> {
        let exact = names.iter().find_map(|name| self.exact(name));
        let loose = || names.iter().find_map(|name| self.fields.iter().find(|(field, _)| plain(field) == plain(name)));
        exact.or_else(|| loose().map(|(_, value)| *value))
    }

    /// The field of this very name.
    pub(crate) fn exact(&self, name: &str) -> Option<&'v Value> {
        self.fields.iter().find(|(field, _)| *field == name).map(|(_, value)| *value)
    }

    /// Names and values, in order.
    pub(crate) fn fields(&self) -> impl Iterator<Item = (&'v str, &'v Value)> + '_ {
        self.fields.iter().copied()
    }
}

fn fields_of(records: &StructArray, index: usize) -> Vec<(&str, &Value)> {
    let values = records.fields.iter();
    values.filter_map(|(name, values)| Some((name.as_str(), values.get(index)?))).collect()
}

/// Appends what lies in the inner parts of an object, and in theirs; what stands outside goes first.
fn add_inner<'v>(fields: &mut Vec<(&'v str, &'v Value)>, page: usize, deeper: usize) {
    if deeper == 0 {
        return;
    }
    let parts: Vec<&'v StructArray> = fields
        .iter()
        .filter(|(name, _)| INNER_PARTS.contains(&plain(name).as_str()))
        .filter_map(|(_, value)| match value {
            Value::Object(object) => Some(&object.records),
            Value::Struct(records) => Some(records),
            Value::Array(_) | Value::Text(_) | Value::Cell(_) | Value::Opaque { .. } => None,
        })
        .collect();
    for records in parts {
        let mut inner = fields_of(records, page);
        add_inner(&mut inner, 0, deeper - 1);
        fields.append(&mut inner);
    }
}

/// A name without case, underscores and blanks.
fn plain(name: &str) -> String {
    name.chars().filter(|letter| !matches!(letter, '_' | ' ')).flat_map(char::to_lowercase).collect()
}
