//! What the engineer says about the files of a folder: all that the assembling depends on besides the files.

use std::collections::BTreeMap;

use super::pattern::{NamePattern, standard_patterns};
use super::row::{Row, RowRole};

/// A channel of the dataset, and what files that do not say call its unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelRule {
    /// Its name in the dataset.
    pub name: String,
    /// Its unit in the dataset; empty where it is still to be said.
    pub unit: String,
    /// Further names by which files call it.
    pub aliases: Vec<String>,
    /// The unit that it has in files that do not say; none where that is still to be said.
    pub unit_in_files: Option<String>,
}

impl ChannelRule {
    /// A channel whose unit is still to be said.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }
}

/// A conversion that units alone do not give, such as inches of a stick to percent of its travel.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitRule {
    /// The channel of the dataset.
    pub channel: String,
    /// The unit in files.
    pub from: String,
    /// How many of the dataset's units one of these is.
    pub factor: f64,
}

/// What the engineer says otherwise than names and contents propose, of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowRule {
    /// Whether it is left out.
    pub left_out: Option<bool>,
    /// Number of its condition.
    pub condition: Option<i64>,
    /// Its role.
    pub role: Option<RowRole>,
    /// Its name in its bundle.
    pub name: Option<String>,
    /// True airspeed of the condition \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude class.
    pub altitude: Option<String>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Weight class.
    pub weight: Option<String>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    /// Identification method.
    pub method: Option<String>,
    /// Offsets of the trim; all of them, where any is given.
    pub perturbation: Option<BTreeMap<String, f64>>,
    /// Names of its inputs in its own order, where the file has none or wrong ones.
    pub inputs: Option<Vec<String>>,
    /// Names of its outputs in its own order.
    pub outputs: Option<Vec<String>>,
}

impl RowRule {
    /// Puts what is said here in the place of what was proposed.
    pub fn apply(&self, row: &mut Row) {
        fn put<T: Clone>(said: &Option<T>, place: &mut Option<T>) {
            if said.is_some() {
                place.clone_from(said);
            }
        }
        row.left_out = self.left_out.unwrap_or(row.left_out);
        put(&self.condition, &mut row.condition);
        put(&self.role, &mut row.role);
        row.name = self.name.clone().unwrap_or_else(|| std::mem::take(&mut row.name));
        put(&self.airspeed_kt, &mut row.airspeed_kt);
        put(&self.altitude, &mut row.altitude);
        put(&self.altitude_ft, &mut row.altitude_ft);
        put(&self.weight, &mut row.weight);
        put(&self.mass_kg, &mut row.mass_kg);
        put(&self.method, &mut row.method);
        if let Some(perturbation) = &self.perturbation {
            row.perturbation.clone_from(perturbation);
        }
    }
}

/// Headings of the columns of tables, by file: "omega \[rad/s\]", "mag P/LAT \[dB\]".
pub type Headings = BTreeMap<String, Vec<String>>;

/// What the engineer says about the files of a folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// Name of the dataset.
    pub name: String,
    /// What it is and where it comes from.
    pub description: String,
    /// Inputs of the dataset, in its order.
    pub inputs: Vec<ChannelRule>,
    /// Outputs of the dataset, in its order.
    pub outputs: Vec<ChannelRule>,
    /// On-axis responses: output, input.
    pub on_axis: Vec<(String, String)>,
    /// Lower and upper end of the band of comparison \[rad/s\].
    pub band: (f64, f64),
    /// How names of folders, files and variables are read; what an earlier one finds stands.
    pub patterns: Vec<NamePattern>,
    /// Conversions that units alone do not give.
    pub units: Vec<UnitRule>,
    /// What the columns of tables hold, in place of their own headings: what a file of columns is read by.
    pub headings: Headings,
    /// What is said of single models, by [`super::FoundModel::key`].
    pub rows: BTreeMap<String, RowRule>,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            on_axis: Vec::new(),
            // Where the rigid-body responses of helicopters are compared.
            band: (0.5, 12.0),
            patterns: standard_patterns(),
            units: Vec::new(),
            headings: Headings::new(),
            rows: BTreeMap::new(),
        }
    }
}
