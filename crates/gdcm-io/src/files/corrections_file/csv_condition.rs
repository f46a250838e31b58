//! A condition's results as cells for the CSV files.
//!
//! A *bar* is a scalar result with its uncertainty (M13); its variance has a component from the
//! choice of the physics model (trim) and one from the identification. The *price* of leads is
//! the gain that they add above the band, and the frequency above which the model is not valid
//! (M15.6).

use std::collections::BTreeSet;

use gdcm_method::correction::{ChannelCorrection, LeadPrice};
use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent};
use gdcm_model::dataset::{Condition, ConditionId};
use gdcm_model::number_format::full_precision;
use gdcm_study::{Analysis, ConditionAnalysis};

use crate::files::export_contents::ExportContents;

/// A condition in an analysis, with its scheduled correction.
pub(super) struct ConditionResults<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) condition: &'a Condition,
    /// Correction given by the schedule, if there is one.
    pub(super) scheduled: Option<ChannelCorrection>,
    /// Description of the correction parts that the file contains and omits.
    pub(super) contains: String,
}

/// Returns the results for the chosen conditions, in dataset order.
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

    /// Returns the price of the leads in the condition's own correction; `None` without leads.
    pub(super) fn price(&self) -> Option<LeadPrice> {
        LeadPrice::new(self.own()?.leads.as_ref()?)
    }

    /// Returns a scalar result's error bar; `None` if it was not computed.
    pub(super) fn bar(&self, scalar: Scalar) -> Option<&Bar> {
        self.analysis
            .uncertainty
            .as_ref()?
            .bar(self.condition.id(), scalar)
    }

    /// Formats the total interval's lower end: a factor for a gain, seconds for a delay. Empty if
    /// there is no interval.
    pub(super) fn lower_end(&self, scalar: Scalar) -> String {
        full_precision(self.interval(scalar).map(|[lower, _]| lower))
    }

    /// Formats the total interval's upper end, as [`Self::lower_end`].
    pub(super) fn upper_end(&self, scalar: Scalar) -> String {
        full_precision(self.interval(scalar).map(|[_, upper]| upper))
    }

    /// Returns the total interval: factors for a gain, whose bar is an interval for its natural
    /// logarithm; seconds for a delay.
    fn interval(&self, scalar: Scalar) -> Option<[f64; 2]> {
        let uncertainty = self.analysis.uncertainty.as_ref()?;
        let ends = self.bar(scalar)?.interval(uncertainty.level)?;
        if scalar.is_delay() {
            Some(ends)
        } else {
            Some(ends.map(f64::exp))
        }
    }

    /// Formats a variance component as a standard deviation: for a gain, of its natural logarithm;
    /// for a delay, in seconds. Empty if it is missing.
    pub(super) fn deviation(
        &self,
        scalar: Scalar,
        component: fn(&Bar) -> Option<VarianceComponent>,
    ) -> String {
        let component = self.bar(scalar).and_then(component);
        full_precision(component.map(|component| component.variance.sqrt()))
    }
}
