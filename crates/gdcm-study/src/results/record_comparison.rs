//! Compares simulated responses with a flight record, tolerance by tolerance (M17.2). A tolerance
//! row names a quantity, the output from which it is computed, and the permitted error.

use serde::Serialize;

use gdcm_method::requirements::tolerance_check::{ChannelTolerance, ToleranceError};
use gdcm_method::requirements::{Tolerance, ToleranceTable};
use gdcm_model::dataset::{Channel, Dataset, Pair, PairTable, StateSpace};
use gdcm_model::simulation::{Segment, ValidationSettings};
use gdcm_sysid::identification::Preparation;

/// Minimum length for a compared piece \[s\]: qualification tests are short steps and doublets.
const LEAST_PIECE_S: f64 = 2.0;

/// Returns the preparation before a comparison: it admits shorter pieces than identification does.
pub(crate) fn comparison_preparation(preparation: &Preparation) -> Preparation {
    Preparation {
        least_segment_s: LEAST_PIECE_S,
        ..preparation.clone()
    }
}

/// Returns the settings for simulating a condition's models with a record: unfiltered signals, and
/// the same windows for all models.
pub(crate) fn common_windows<'m>(
    models: impl IntoIterator<Item = &'m StateSpace>,
    segments: &[Segment],
) -> ValidationSettings {
    ValidationSettings::unfiltered().common_to(models, segments)
}

/// Trend of a simulated off-axis output relative to flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Trend {
    /// Simulated and measured output correlate positively.
    Correct,
    /// The correlation is not positive.
    Opposite,
}

impl Trend {
    /// Returns the trend from the correlation between simulated and measured output. `on_axis`
    /// refers to the input with the largest variation; `None` for an on-axis output, or if either
    /// argument is unknown.
    pub fn from_correlation(correlation: Option<f64>, on_axis: Option<bool>) -> Option<Self> {
        let correlation = correlation?;
        if on_axis != Some(false) {
            None
        } else if correlation > 0.0 {
            Some(Self::Correct)
        } else {
            Some(Self::Opposite)
        }
    }

    /// Returns the trend in a word: "correct" or "opposite".
    pub fn name(self) -> &'static str {
        match self {
            Self::Correct => "correct",
            Self::Opposite => "opposite",
        }
    }
}

/// A tolerance row, with its tolerance in the dataset's unit.
pub(crate) struct AppliedTolerance<'a> {
    pub(crate) tolerance: &'a Tolerance,
    pub(crate) channel: ChannelTolerance,
}

/// Data common to the comparisons with all records.
pub(crate) struct RecordComparison<'a> {
    pub(crate) inputs: &'a [Channel],
    pub(crate) outputs: &'a [Channel],
    on_axis: PairTable<bool>,
    /// The applicable tolerance rows.
    pub(crate) rows: Vec<AppliedTolerance<'a>>,
    /// Why other rows are not applicable.
    pub(crate) not_applied: Vec<ToleranceError>,
}

impl<'a> RecordComparison<'a> {
    pub(crate) fn new(dataset: &'a Dataset, tolerances: &'a ToleranceTable) -> Self {
        let mut rows = Vec::new();
        let mut not_applied = Vec::new();
        for tolerance in tolerances.rows() {
            match tolerance.in_output_units(dataset.outputs()) {
                Ok(channel) => rows.push(AppliedTolerance { tolerance, channel }),
                Err(why) => not_applied.push(why),
            }
        }
        Self {
            inputs: dataset.inputs(),
            outputs: dataset.outputs(),
            on_axis: dataset.measuring_pairs(),
            rows,
            not_applied,
        }
    }

    /// Returns the input with the largest variation over a record's segments; `None` where the
    /// inputs have different units.
    pub(crate) fn moved_input(&self, segments: &[Segment]) -> Option<usize> {
        let (first, others) = self.inputs.split_first()?;
        if others.iter().any(|input| input.unit != first.unit) {
            return None;
        }
        (0..self.inputs.len())
            .max_by(|a, b| variation(segments, *a).total_cmp(&variation(segments, *b)))
    }

    /// Returns whether an output is on-axis to the input `moved`; `None` where that input is not
    /// determined.
    pub(crate) fn is_on_axis(&self, output: usize, moved: Option<usize>) -> Option<bool> {
        moved.map(|input| self.on_axis[Pair::new(output, input)])
    }
}

/// Sums an input's squared deviations from its mean in each segment.
fn variation(segments: &[Segment], input: usize) -> f64 {
    segments
        .iter()
        .map(|segment| {
            let samples = segment.inputs.column(input);
            samples.variance() * samples.len() as f64
        })
        .sum()
}
