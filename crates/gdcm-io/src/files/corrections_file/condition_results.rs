//! Results of a condition for CSV files (RFC 4180).

use std::collections::BTreeSet;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent};
use gdcm_model::dataset::{Condition, ConditionId};
use gdcm_study::{Analysis, ConditionAnalysis};

use crate::files::export_contents::ExportContents;

/// A condition of an analysis, with its scheduled correction.
pub(super) struct ConditionResults<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) condition: &'a Condition,
    /// Correction given by the schedule, if there is one.
    pub(super) scheduled: Option<ChannelCorrection>,
    /// Description of the parts of the correction in the file, and of the omitted parts.
    pub(super) contains: String,
}

/// Returns the results of the chosen conditions, in the order of the dataset.
pub(super) fn condition_results<'a>(
    analysis: &'a Analysis,
    chosen: &BTreeSet<ConditionId>,
) -> Vec<ConditionResults<'a>> {
    let dataset = &analysis.study.dataset;
    let contents = ExportContents::of_results(analysis);
    let mut contains = contents.words();
    for words in contents.left_out_words(dataset) {
        contains.push_str(&format!("; left out: {words}"));
    }
    let mut results = Vec::new();
    for condition in dataset.conditions() {
        if chosen.contains(&condition.id()) {
            let schedule = analysis.schedule.as_ref().ok();
            results.push(ConditionResults {
                analysis,
                condition,
                scheduled: schedule.map(|schedule| schedule.at_state(condition.flight_state())),
                contains: contains.clone(),
            });
        }
    }
    results
}

impl ConditionResults<'_> {
    pub(super) fn result(&self) -> Option<&ConditionAnalysis> {
        self.analysis.condition(self.condition.id())
    }

    /// Returns the condition's own correction; `None` if the condition has no result.
    pub(super) fn own(&self) -> Option<&ChannelCorrection> {
        self.result().map(|result| &result.correction)
    }

    /// Returns the error bar of a result; `None` if it was not computed.
    pub(super) fn bar(&self, scalar: Scalar) -> Option<&Bar> {
        self.analysis
            .uncertainty
            .as_ref()?
            .bar(self.condition.id(), scalar)
    }

    /// Formats the lower (`end` = 0) or upper (`end` = 1) bound of the total interval: a factor for
    /// a gain, seconds for a delay. Empty if there is no interval.
    pub(super) fn end(&self, scalar: Scalar, end: usize) -> String {
        let ends = match &self.analysis.uncertainty {
            Some(uncertainty) => self
                .bar(scalar)
                .and_then(|bar| bar.interval(uncertainty.level)),
            None => None,
        };
        match ends {
            Some(ends) if scalar.is_delay() => cell(Some(ends[end])),
            Some(ends) => cell(Some(ends[end].exp())),
            None => cell(None),
        }
    }

    /// Formats the standard deviation of a variance component; empty if it is missing.
    pub(super) fn deviation(
        &self,
        scalar: Scalar,
        component: fn(&Bar) -> Option<VarianceComponent>,
    ) -> String {
        let component = self.bar(scalar).and_then(component);
        cell(component.map(|component| component.variance.sqrt()))
    }
}

/// Formats a value at full precision; empty if it is missing or not finite.
pub(super) fn cell(value: Option<f64>) -> String {
    match value {
        // `Debug` writes very large and small values with an exponent, where `Display` would write
        // hundreds of zeros.
        Some(value) if value.is_finite() => format!("{value:?}"),
        _ => String::new(),
    }
}
