//! Error bars for all conditions (M13.2, M13.3). A *scalar* is a condition's result with a bar: a
//! gain's logarithm or a delay, of a response or of a channel (`scalar`).
//!
//! ```text
//! 1  s_phys^2, s_own^2 <- mean square changes if other models are substituted     (`spread`)
//! 2  s_id^2 <- s_own^2 pooled with the other conditions              (`variance_component`)
//! 3  s_id^2 <- the reported s^2, if that is larger, or if there is no s_id^2
//! ```
//!
//! `s_phys` is the standard deviation due to the physics models' trim, `s_id` that due to the
//! identification; the reported `s` comes from the identified representative's own standard
//! deviations over frequency, or from its coherence.

use super::bar::{Bar, IdentificationSource};
use super::scalar::{Figures, Scalar, ScalarTable};
use super::spread::ConditionSpread;
use super::variance_component::{VarianceComponent, pooled};

/// A condition's data from which its bars are computed.
#[derive(Clone, Debug)]
pub struct BarSource<'a> {
    /// Values of the scalars with both representatives.
    pub figures: Figures,
    /// Changes in the scalars if other models are substituted.
    pub spread: &'a ConditionSpread,
    /// The identified representative's standard errors; `None` where unavailable.
    pub reported: ScalarTable<Option<ReportedUncertainty>>,
    /// Lower and upper bound on a channel delay \[s\].
    pub delay_bounds_s: [f64; 2],
}

/// Computes the bars by condition (M13.2, M13.3). Each scalar's identification part is pooled over
/// the conditions. A scalar that does not exist has no bar.
pub fn bars(conditions: &[BarSource<'_>], prior_degrees: f64) -> Vec<ScalarTable<Option<Bar>>> {
    let Some(first) = conditions.first() else {
        return Vec::new();
    };
    // Step 2: for each scalar, the pooled variance by condition.
    let pooled_variances = first.figures.map(|scalar, _| {
        let own: Vec<Option<VarianceComponent>> = conditions
            .iter()
            .map(|condition| condition.spread.changes[scalar].own)
            .collect();
        pooled(&own, prior_degrees)
    });
    let mut bars = Vec::with_capacity(conditions.len());
    for (index, condition) in conditions.iter().enumerate() {
        bars.push(condition.figures.map(|scalar, value| {
            let pooled_variance = pooled_variances[scalar][index];
            Some(condition.bar(scalar, (*value)?, pooled_variance))
        }));
    }
    bars
}

impl BarSource<'_> {
    /// Returns a scalar's bar with the identification variance `pooled` (step 3).
    fn bar(&self, scalar: Scalar, value: f64, pooled: Option<VarianceComponent>) -> Bar {
        let changes = self.spread.changes[scalar];
        let (identification, source) = match self.reported[scalar] {
            Some(reported) if reported.replaces(pooled) => (Some(reported.part), reported.source),
            _ => (pooled, IdentificationSource::Spread),
        };
        let range = match scalar {
            Scalar::ChannelDelay(_) => self.delay_bounds_s,
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        Bar {
            value,
            trim: changes.trim,
            identification,
            source,
            left_out: changes.left_out,
            range,
        }
    }
}

/// An identified representative's standard error, from the standard deviations that it carries over
/// frequency, or from its coherence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedUncertainty {
    pub part: VarianceComponent,
    /// Source of the standard error.
    pub source: IdentificationSource,
}

impl ReportedUncertainty {
    /// Returns whether the standard error replaces the pooled spread: if it is larger, or if there
    /// is no spread. The spread between leave-one-record-out models underestimates a single model's
    /// error by a factor of about the square root of the record count (Efron's jackknife); the
    /// standard error does not.
    fn replaces(&self, pooled: Option<VarianceComponent>) -> bool {
        pooled.is_none_or(|pooled| self.part.variance > pooled.variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn component(variance: f64) -> VarianceComponent {
        VarianceComponent {
            variance,
            degrees_of_freedom: 3.0,
        }
    }

    #[test]
    fn a_reported_error_replaces_a_smaller_spread() {
        for source in [
            IdentificationSource::ModelBand,
            IdentificationSource::Coherence,
        ] {
            let reported = ReportedUncertainty {
                part: component(0.04),
                source,
            };
            assert!(reported.replaces(None) && reported.replaces(Some(component(0.01))));
            assert!(!reported.replaces(Some(component(0.09))));
        }
    }
}
